// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/free_surface.h>
#include <greville/water/drained_boundaries.h>
#include <greville/water/pressure_level.h>

#include <functional>
#include <memory>
#include <vector>

namespace greville
{
  /**
   * The pressure of pore water in implicit steps, see WaterPoints for the
   * equations. Stresses of points are effective stresses; the total stress is
   * the effective stress less the pressure.
   *
   * The pressure is a spline of the same degree p as the displacement on the
   * mesh coarsened once, whose cells are the parents of the displacement's
   * cells, and is extended by the filling of these cells. The inf-sup constant
   * of this pair does not depend on the cell size or on how the body's surface
   * cuts cells; on a single mesh, the pair p, p - 1 has no such constant
   * (without cut cells, for incompressible flow: @ref Bressan2013 "Bressan and
   * Sangalli, 2013").
   *
   * With the tangent A of the points, the coupling B and the block C of the
   * pressure, a step of Newton's method solves
   * @f[
   *   \begin{pmatrix} A & -B \\ B^T & C \end{pmatrix}
   *   \begin{pmatrix} du \\ dp \end{pmatrix} = \begin{pmatrix} b_u \\ b_p
   *   \end{pmatrix}.
   * @f]
   * The preconditioner is upper block-triangular: dp = S^-1 b_p, du = A^-1 (b_u
   * + B dp), with one cycle of p-multigrid each for A and for S. S is C plus
   * the sum over points of V / M q q, with the modulus M of pressure waves of
   * each point (close to that of @ref White2011 "White and Borja, 2011", with a
   * single weight). In dynamic steps, A includes the mass, and S^-1 is the sum
   * of two inverses: the one above, for soil without inertia, and one for soil
   * with inertia only (as for fluids, @ref Cahouet1988 "Cahouet and Chabard,
   * 1988").
   *
   * Rows of the pressure are volumes times scale(), which are forces that
   * Newton's method can compare with the other rows.
   */
  template <int dim>
  class PoreWater
  {
  public:
    /// The field of points that stores the pressure, Pa.
    static constexpr const char *field = "pore_pressure";
    /// The field for BDF2: WaterPoints::Numbers::change.
    static constexpr const char *field_of_change = "water_change";

    /// Collective. The space of the displacement and the parameters are kept by
    /// reference. Throws dealii::ExcMessage for invalid parameters.
    PoreWater(const SplineSpace<dim>        &displacements,
              DistributedTriangulation<dim> &triangulation,
              const SimulationParameters    &parameters);

    const SplineSpace<dim> &
    space() const
    {
      return orders.finest();
    }

    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /// Collective. Update after the points have moved.
    void
    set_points(const std::vector<Body<dim>>    &bodies,
               const std::vector<Surface<dim>> &surfaces);

    /// Collective. Begin a step of length @p dt (s) that ends at @p time with
    /// the acceleration @p gravity. The previous step had the length
    /// @p last_dt, or 0 if BDF2 cannot use a previous step. Throws
    /// dealii::ExcMessage if a formula has no value.
    void
    begin_step(const std::vector<Body<dim>>    &bodies,
               const std::vector<Surface<dim>> &surfaces,
               const double                     time,
               const double                     dt,
               const dealii::Tensor<1, dim>    &gravity,
               const double                     last_dt);

    /// Make a vector of coefficients, one for each function of the space.
    void
    initialize(VectorType &vector) const
    {
      space().initialize_vector(vector);
    }

    /// Collective. Set the initial pressure of a trial step: zero, or the
    /// pressure of the points at the start if flow or friction depend on it.
    void
    guess(VectorType &x);

    /// Collective. Evaluate the force of the pressure x on the grid, which is
    /// overwritten, and the residual of the balance of water.
    void
    evaluate(const VectorField<dim> &u,
             const VectorType       &x,
             VectorField<dim>       &force,
             VectorType             &residual);

    /// Collective. Apply the derivatives of the last evaluate(), without A.
    void
    multiply(const VectorField<dim> &du,
             const VectorType       &dx,
             VectorField<dim>       &force,
             VectorType             &rows) const;

    /// Collective. Apply the derivative of the force by the pressure.
    void
    spread(const VectorType &dx, VectorField<dim> &force) const;

    /// Collective. Compute the force at the start of the step from the
    /// pressures stored in the points.
    void
    begin_force(VectorField<dim> &force) const;

    /// Return the part of the force that does not depend on the pore pressure,
    /// due to the water around the bodies; null if there is none.
    const VectorField<dim> *
    outer_force() const
    {
      return free_surface ? &free_surface->force() : nullptr;
    }

    /// A function that solves M u = b for u (the second argument) with b the
    /// first one.
    using SolveMass =
      std::function<void(const VectorField<dim> &, VectorField<dim> &)>;

    /// Collective. Build the cycles of the Schur complement of the last
    /// evaluate(), unless they exist for this step and the flow is linear. A
    /// includes the mass M times @p mass_factor (1 / s^2), and nothing else in
    /// explicit steps. Throws ErrorOnAll if a cycle cannot be built.
    void
    set_up(const double mass_factor, const SolveMass &solve_mass);

    /// Collective. Compute dx = S^-1 rows.
    void
    precondition(VectorType &dx, const VectorType &rows) const;

    /// Collective. Return the pressure with the coefficients @p x at the points
    /// of each of the @p surfaces, see values_at_surfaces().
    std::vector<std::vector<double>>
    at_surfaces(const VectorType                               &x,
                const std::vector<const MaterialPoints<dim> *> &surfaces) const;

    /// Collective. Return the norm of the forces and the round-off of the
    /// residual in the last evaluate().
    double
    force_scale() const;

    double
    round_off() const;

    /// Collective. Store the pressure of the last evaluate() in the points.
    /// Returns this process' share of volumes of water, m^3 (2D: m^2): the
    /// water that entered the pores, and the water that left in the step
    /// through all boundaries and through each wall, each surface, and the free
    /// surface. @p last contains these numbers for the previous step.
    std::vector<double>
    advance(std::vector<Body<dim>>    &bodies,
            const std::vector<double> &last) const;

    /// Return the mean density of soil and water at the start of the step, kg /
    /// m^3.
    double
    density() const
    {
      return mean_density;
    }

    /// Return the sum of WaterPoints::work() and the work of outer_force() in
    /// the last evaluate().
    double
    work() const
    {
      return points.work() + outer_work;
    }

  private:
    /// The levels of a Schur complement.
    using Levels = std::vector<std::unique_ptr<PressureLevel<dim>>>;

    typename WaterPoints<dim>::Numbers
    numbers_of(const Body<dim> &body) const;

    /// Call WaterPoints::add_schur_complement() and build the cycle.
    std::unique_ptr<PMultigrid<dim>>
    make_cycle(const Levels &levels, const double mobility) const;

    /// Collective. Call WaterPoints::set_free_motion().
    void
    find_free_motion(const SolveMass &solve_mass);

    const SplineSpace<dim>     &displacements;
    const SimulationParameters &parameters;
    OrderHierarchy<dim>         orders;
    std::vector<unsigned int>   parents; // by owned cell
    PointTransfer<dim>          transfer;
    CellFilling<dim>            filling;
    std::vector<double>         filled; // fractions of the displacement's cells
    WaterPoints<dim>            points;
    DrainedBoundaries<dim>      drained;

    std::unique_ptr<FreeSurface<dim>> free_surface; // null if there is none
    double                            outer_work = 0.;

    bool flow_is_linear = true;

    // The levels without inertia and, in dynamic steps, with inertia only.
    Levels                             levels, levels_of_mass;
    std::vector<SpacePolynomials<dim>> tables; // by level
    std::unique_ptr<PMultigrid<dim>>   multigrid, multigrid_of_mass;
    TangentParameters                  of_cycle;
    bool                               is_first = true, is_explicit = false;

    // The weight in BDF2 of the previous step's change of water.
    double part_of_earlier = 0.;

    double             scale        = 0.; // N / m^3 (2D: N / m^3)
    double             speed        = 0.; // of pressure waves, m / s
    double             mean_density = 1.;
    mutable VectorType pressure, rows;
  };
} // namespace greville
