// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_material_h
#define greville_materials_material_h

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



  /**
   * Bulk and shear modulus (Pa), and the largest dynamic viscosities (Pa s) of
   * shear and of changes of volume.
   */
  struct Moduli
  {
    double bulk           = 0.;
    double shear          = 0.;
    double viscosity      = 0.;
    double bulk_viscosity = 0.;
  };



  /**
   * The derivative D_ijkl = d sigma_ij / d l_kl of the Cauchy stress at the end
   * of a step by l = df f^-1, where f is the increment F_(n+1) F_n^-1: by all
   * nine l_kl, not only the symmetric ones. Where the law is objective, a spin
   * w gives w sigma - sigma w.
   */
  using MaterialTangent = dealii::Tensor<4, 3>;



  /**
   * A constitutive law: from the deformation of points to their Cauchy stress.
   * A material knows nothing of grids and acts on many points per call.
   *
   * A new material is one header with a class that derives from MaterialLaw,
   * and one line in the list of source/materials/material.cc; or a call of
   * add_material() in a program.
   */
  class Material
  {
  public:
    virtual ~Material() = default;

    /**
     * Declare the density and the parameters of the law in the section that
     * @p prm is in. What is read into @p prm goes to this object.
     */
    virtual void
    declare(dealii::ParameterHandler &prm);

    /**
     * Compute derived constants; to be called after reading and before
     * anything else. Throws dealii::ExcMessage, which names the @p section,
     * where parameters contradict each other.
     */
    virtual void
    reinit(const std::string & /*section*/)
    {}

    /**
     * The names of history variables, after reinit(); MaterialPoint::state
     * holds them in this order.
     */
    virtual std::vector<std::string>
    state_names() const
    {
      return {};
    }

    /**
     * The unit of one of them where the list of run_notes.cc has none.
     */
    virtual std::string
    state_unit(const std::string & /*name*/) const
    {
      return "";
    }

    /**
     * The state of a point with Cauchy stress @p stress at rest: fill
     * stress, state, F (a symmetric stretch from the stress-free state), J
     * and wave_modulus of @p point. Throws dealii::ExcMessage where the law
     * cannot have this stress (a fluid with shear stress, a stress outside of
     * the yield surface).
     */
    virtual void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const = 0;

    /**
     * Compute stress, state and wave_modulus of @p points at the end of a
     * step. Results of impossible deformations (J <= 0) are not finite. May
     * throw dealii::ExcMessage where a step is too long for the law: implicit
     * steps are then tried again with a shorter one, explicit ones end the run.
     */
    virtual void
    update(const dealii::ArrayView<MaterialPoint> &points) const = 0;

    /**
     * Whether update_lanes() does the same for several points at once. See
     * LanesMaterial.
     */
    virtual bool
    has_lanes() const
    {
      return false;
    }

    /**
     * Does not see the stress of the beginning of the step.
     */
    virtual void
    update_lanes(MaterialLanes & /*points*/) const
    {
      AssertThrow(false, dealii::ExcPureFunctionCalled());
    }

    /**
     * The derivatives of the stresses that update() gives for @p points, which
     * are as update() takes them: stress and state of the beginning of the
     * step, increment, F and J at the end. A change l dt of the velocity's
     * gradient changes all three: (1 + l) f, (1 + l) F, (1 + tr(l)) J. For @p
     * dim 2 the columns with k = 2 or l = 2 are zero, which are not needed in
     * plane strain. On a kink (at the onset of yield, for instance) the
     * derivative is that of one side or a mean of both. Throws nothing.
     *
     * The default takes central differences of update(), which costs 2 dim^2
     * calls of it per point and is exact to about 1e-8.
     */
    virtual void
    tangents(const dealii::ArrayView<const MaterialPoint> &points,
             const dealii::ArrayView<MaterialTangent>     &result,
             const unsigned int                            dim) const;

    /**
     * Whether J (D_ijkl + sigma_ij delta_kl - sigma_il delta_jk), which is the
     * derivative of the first Piola-Kirchhoff stress, is symmetric under ij <->
     * kl in all states: of hyperelastic and of associated laws.
     */
    virtual bool
    has_symmetric_tangent() const
    {
      return false;
    }

    /**
     * Stored elastic energy per volume of the stress-free state, J / m^3.
     */
    virtual double
    strain_energy(const MaterialPoint &point) const = 0;

    /**
     * Energy per volume of the stress-free state that plastic and viscous flow
     * have turned into heat, J / m^3.
     */
    virtual double
    dissipation(const MaterialPoint &) const
    {
      return 0.;
    }

    /**
     * strain_energy() and dissipation() of several points at once, to
     * round-off: sums over all points ask for them. The default calls the two
     * for one point after the other.
     */
    virtual EnergyLanes
    energies(const MaterialLanes &points) const;

    /**
     * What the strength of the material is divided by at a time: the value of
     * MaterialPoint::strength_reduction for the points of a step that ends
     * then. Throws dealii::ExcMessage, which names the parameter, on all
     * processes alike, where the parameters give none.
     */
    virtual double
    strength_reduction(const double /*time*/) const
    {
      return 1.;
    }

    /**
     * Whether points next to one another are to share their changes of volume
     * (PointTransfer::share_volume()): where only J makes the pressure and
     * nothing else couples J to the place that a point has, so that errors of
     * J add up.
     */
    virtual bool
    shares_volume() const
    {
      return false;
    }

    /**
     * In the stress-free state, viscosities in any. They set the critical time
     * step.
     */
    virtual Moduli
    moduli() const = 0;

    /**
     * Whether bodies of this material spread into layers that are thinner than
     * a cell or break up into drops and grains, where the exact mass matrix is
     * dearer than it is worth.
     */
    virtual bool
    spreads() const
    {
      return false;
    }

    /**
     * In the stress-free state, kg / m^3.
     */
    double density = 1000.;

    /// With pore water: the fraction of the volume that it fills in the
    /// stress-free state, and the hydraulic conductivity there, m / s. 0: not
    /// given. The law is constant or kozeny-carman.
    double porosity          = 0.;
    double conductivity      = 0.;
    bool   has_kozeny_carman = false;
  };



  /**
   * A Material from a class Law with
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

  /**
   * Add a material to the list, before parameters are read. Not from several
   * threads.
   */
  void
  add_material(const std::string &name, const MakeMaterial make);

  /**
   * The same for a class with a default constructor and a static name.
   */
  template <typename Law>
  void
  add_material()
  {
    add_material(Law::name, new_material<Law>);
  }

  /**
   * The names of all materials, separated by '|'.
   */
  std::string
  material_names();

  /**
   * A material by name. Throws dealii::ExcMessage with material_names() for an
   * unknown @p name, where @p parameter is the parameter that the message
   * names.
   */
  std::unique_ptr<Material>
  make_material(const std::string &name, const std::string &parameter);
} // namespace greville

#endif
