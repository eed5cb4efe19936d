// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <greville/materials/material_point.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  // See material_lanes.h.
  struct MaterialLanes;
  struct EnergyLanes;



  /// Bulk and shear modulus (Pa), and the largest dynamic viscosities of shear
  /// and of volume changes (Pa s).
  struct Moduli
  {
    double bulk           = 0.;
    double shear          = 0.;
    double viscosity      = 0.;
    double bulk_viscosity = 0.;
  };



  /// The derivative D_ijkl = d sigma_ij / d l_kl of the Cauchy stress at the
  /// end of a step by l = df f^-1, where f is the increment F_(n+1) F_n^-1. It
  /// is a derivative by all nine l_kl, not only by the symmetric part. If the
  /// law is objective, a spin w changes the stress by w sigma - sigma w.
  using MaterialTangent = dealii::Tensor<4, 3>;



  /**
   * Base class of constitutive laws, which compute Cauchy stresses from the
   * deformation of points. A material does not depend on the grid, and updates
   * many points in each call.
   *
   * A new material is one header with a class that derives from MaterialLaw,
   * and one line in the list of source/materials/material.cc; or a call of
   * add_material() in a program.
   */
  class Material
  {
  public:
    virtual ~Material() = default;

    /// Declare the density and the parameters of the law in the current section
    /// of @p prm, which writes the values that it reads into this object.
    virtual void
    declare(dealii::ParameterHandler &prm);

    /// Compute derived constants, to be called after reading and before any
    /// other function. Throws dealii::ExcMessage with the @p section if
    /// parameters contradict each other.
    virtual void
    reinit(const std::string & /*section*/)
    {}

    /// Return the names of history variables, after reinit(), in the order of
    /// MaterialPoint::state.
    virtual std::vector<std::string>
    state_names() const
    {
      return {};
    }

    /// Return the unit of a history variable that run_notes.cc does not list.
    virtual std::string
    state_unit(const std::string & /*name*/) const
    {
      return "";
    }

    /// Initialize a point at rest with the Cauchy stress @p stress: fill
    /// stress, state, F (a symmetric stretch from the stress-free state), J and
    /// wave_modulus of @p point. Throws dealii::ExcMessage if the law does not
    /// allow this stress (a fluid with shear stress, a stress outside the yield
    /// surface).
    virtual void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const = 0;

    /// Compute stress, state and wave_modulus of @p points at the end of a
    /// step. Results of impossible deformations (J <= 0) are not finite. May
    /// throw dealii::ExcMessage if a step is too long for the law: implicit
    /// steps are then repeated with a shorter step, explicit steps end the run.
    virtual void
    update(const dealii::ArrayView<MaterialPoint> &points) const = 0;

    /// Return whether update_lanes() is implemented, see LanesMaterial.
    virtual bool
    has_lanes() const
    {
      return false;
    }

    /// Update several points. The result must not depend on the stress at the
    /// beginning of the step.
    virtual void
    update_lanes(MaterialLanes & /*points*/) const
    {
      AssertThrow(false, dealii::ExcPureFunctionCalled());
    }

    /**
     * Compute the derivatives of the stresses that update() returns for
     * @p points. The points have the input of update(): stress and state at the
     * beginning of the step, increment, F and J at the end. A change l dt of
     * the velocity's gradient changes the last three to (1 + l) f, (1 + l) F,
     * (1 + tr(l)) J. If @p dim is 2, the columns with k = 2 or l = 2, which
     * plane strain does not need, are zero. At a kink (for instance the onset
     * of yield), the derivative is one-sided or a mean of both sides. Throws
     * nothing.
     *
     * The default uses central differences of update(), which take 2 dim^2
     * calls per point and have an error of about 1e-8.
     */
    virtual void
    tangents(const dealii::ArrayView<const MaterialPoint> &points,
             const dealii::ArrayView<MaterialTangent>     &result,
             const unsigned int                            dim) const;

    /// Return whether J (D_ijkl + sigma_ij delta_kl - sigma_il delta_jk), the
    /// derivative of the first Piola-Kirchhoff stress, is symmetric under ij
    /// <-> kl in all states, as for hyperelastic and associated laws.
    virtual bool
    has_symmetric_tangent() const
    {
      return false;
    }

    /// Return the elastic energy per stress-free volume, J / m^3.
    virtual double
    strain_energy(const MaterialPoint &point) const = 0;

    /// Return the heat of inelastic flow per stress-free volume, J / m^3.
    virtual double
    dissipation(const MaterialPoint &) const
    {
      return 0.;
    }

    /// Return strain_energy() and dissipation() of several points at once, up
    /// to round-off, for sums over all points. The default calls both functions
    /// point by point.
    virtual EnergyLanes
    energies(const MaterialLanes &points) const;

    /// Return the divisor of the material's strength at a given time, which is
    /// MaterialPoint::strength_reduction in a step that ends at this time.
    /// Throws dealii::ExcMessage with the name of the parameter, on all
    /// processes alike, if the parameters give no value.
    virtual double
    strength_reduction(const double /*time*/) const
    {
      return 1.;
    }

    /// Return whether neighboring points share their changes of volume
    /// (PointTransfer::share_volume()). Laws whose pressure depends only on J
    /// need this: nothing else couples J to the positions of points, so errors
    /// of J accumulate.
    virtual bool
    shares_volume() const
    {
      return false;
    }

    /// Return the moduli in the stress-free state and bounds of the viscosity
    /// in any state. They determine the critical time step.
    virtual Moduli
    moduli() const = 0;

    /// Return whether bodies of this material spread into layers thinner than a
    /// cell, or break up into drops and grains. The exact mass matrix is not
    /// worth its cost for these bodies.
    virtual bool
    spreads() const
    {
      return false;
    }

    /// The density in the stress-free state, kg / m^3.
    double density = 1000.;

    /// With pore water: the porosity and the hydraulic conductivity, m / s, in
    /// the stress-free state; 0 if not given. The conductivity is constant, or
    /// follows Kozeny and Carman.
    double porosity          = 0.;
    double conductivity      = 0.;
    bool   has_kozeny_carman = false;
  };



  /**
   * A Material made from a class Law with
   *   void update_point(MaterialPoint &point) const,
   * which the loop over points calls without virtual dispatch.
   */
  template <typename Law>
  class MaterialLaw : public Material
  {
  public:
    void
    update(const dealii::ArrayView<MaterialPoint> &points) const final
    {
      const Law &law = static_cast<const Law &>(*this);
      for (MaterialPoint &point : points)
        law.update_point(point);
    }
  };



  using MakeMaterial = std::unique_ptr<Material> (*)();

  template <typename Law>
  std::unique_ptr<Material>
  new_material()
  {
    return std::make_unique<Law>();
  }

  /// Add a material to the list, before parameters are read. Not thread-safe.
  void
  add_material(const std::string &name, const MakeMaterial make);

  /// Add a class with a default constructor and a static name to the list.
  template <typename Law>
  void
  add_material()
  {
    add_material(Law::name, new_material<Law>);
  }

  /// Return the names of all materials, separated by '|'.
  std::string
  material_names();

  /// Return a new material. Throws dealii::ExcMessage with material_names() and
  /// the name of the @p parameter if @p name is unknown.
  std::unique_ptr<Material>
  make_material(const std::string &name, const std::string &parameter);
} // namespace greville
