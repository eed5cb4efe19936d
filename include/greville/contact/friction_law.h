// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Base class of friction laws: two surfaces stick if the shear stress is
   * below the strength, a function of the effective pressure p (Pa; the contact
   * pressure less the pore water pressure) and of the sliding speed v (m / s);
   * they slide under a shear stress equal to the strength.
   *
   * A new law is a class that derives from this one, and one line in the list
   * of source/contact/friction_law.cc; or a call of add_friction_law() in a
   * program.
   */
  class FrictionLaw
  {
  public:
    virtual ~FrictionLaw() = default;

    /// Return the strength, Pa, which is not negative and may be infinite.
    virtual double
    strength(const double pressure, const double speed) const = 0;

    /// Return the derivatives of a finite strength by pressure and speed, for
    /// the tangents of implicit steps; finite differences by default.
    struct Slopes
    {
      double by_pressure, by_speed;
    };
    virtual Slopes
    slopes(const double pressure, const double speed) const;

    /// Return whether the strength is independent of pressure and speed, as for
    /// smooth and rough surfaces: tangents are then symmetric.
    virtual bool
    is_symmetric() const
    {
      return false;
    }
  };



  /// The law of Coulomb, mu p.
  class CoulombFriction : public FrictionLaw
  {
  public:
    explicit CoulombFriction(const double mu)
      : mu(mu)
    {}

    double
    strength(const double pressure, const double) const override
    {
      return mu * pressure;
    }

    Slopes
    slopes(const double, const double) const override
    {
      return {mu, 0.};
    }

    bool
    is_symmetric() const override
    {
      return mu == 0.;
    }

  private:
    double mu;
  };



  /// A function that makes a law from the numbers in parentheses after its
  /// name. Throws dealii::ExcMessage if they are invalid.
  using MakeFrictionLaw = std::function<std::unique_ptr<const FrictionLaw>(
    const std::vector<double> &numbers)>;

  /// Add a law, so that parameter files can contain @p name or name(number,
  /// ...) for `Friction`. To be called before simulations are made. Returns
  /// true, so that it can initialize a static variable.
  bool
  add_friction_law(const std::string &name, const MakeFrictionLaw &make);

  /// Return the law with the @p text of a @p parameter `Friction`: the
  /// coefficient mu as a number or a formula mu(p, v), whose negative values
  /// count as zero, or the name of a law. Throws dealii::ExcMessage if the text
  /// is invalid, and for a formula that is negative at p = 1 Pa without
  /// sliding.
  std::unique_ptr<const FrictionLaw>
  make_friction_law(const std::string &text, const std::string &parameter);
} // namespace greville
