// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_contact_friction_law_h
#define greville_contact_friction_law_h

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * What two surfaces resist sliding with: they stick where the shear stress is
   * below the strength, a function of the pressure p (Pa; that of contact less
   * the pressure of pore water) and of the speed v at which they slide (m / s),
   * and slide under a shear stress of this size.
   *
   * A new law is a class that derives from this one, and one line in the list
   * of source/contact/friction_law.cc; or a call of add_friction_law() in a
   * program.
   */
  class FrictionLaw
  {
  public:
    virtual ~FrictionLaw() = default;

    /**
     * The strength, Pa, which is not negative and may be infinite.
     */
    virtual double
    strength(const double pressure, const double speed) const = 0;

    /**
     * The derivatives of a finite strength by pressure and speed, for the
     * tangents of implicit steps. By default they are differences.
     */
    struct Slopes
    {
      double by_pressure, by_speed;
    };
    virtual Slopes
    slopes(const double pressure, const double speed) const;

    /**
     * Whether the strength does not depend on pressure and speed, as that of
     * smooth and of rough surfaces: tangents are symmetric then.
     */
    virtual bool
    is_symmetric() const
    {
      return false;
    }
  };



  /**
   * The law of Coulomb, mu p.
   */
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



  /**
   * Makes a law from the numbers in the parentheses behind its name. Throws
   * dealii::ExcMessage where they are wrong.
   */
  using MakeFrictionLaw = std::function<std::unique_ptr<const FrictionLaw>(
    const std::vector<double> &numbers)>;

  /**
   * Let parameter files say @p name, or name(number, ...), for `Friction`. To
   * be called before simulations are made. Returns true, so that it may be the
   * value of a static variable.
   */
  bool
  add_friction_law(const std::string &name, const MakeFrictionLaw &make);

  /**
   * The law that a @p parameter `Friction` has as its @p text: the coefficient
   * mu as a number, or as a formula mu(p, v), whose negative values count as
   * zero; or the name of a law. Throws dealii::ExcMessage where it is wrong,
   * and for a formula that is negative at p = 1 Pa without sliding.
   */
  std::unique_ptr<const FrictionLaw>
  make_friction_law(const std::string &text, const std::string &parameter);
} // namespace greville

#endif
