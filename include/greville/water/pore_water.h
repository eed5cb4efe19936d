// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_water_pore_water_h
#define greville_water_pore_water_h

#include <greville/multigrid/p_multigrid.h>
#include <greville/points/free_surface.h>
#include <greville/points/point_transfer.h>
#include <greville/water/drained_boundaries.h>
#include <greville/water/pressure_level.h>

#include <functional>
#include <memory>
#include <vector>

namespace greville
{
  /**
   * The pressure of pore water in implicit steps, see WaterPoints for the
   * equations. Stresses of points are effective ones; the total stress is that
   * less the pressure.
   *
   * The pressure is a spline of the degree p of the displacement on the once
   * coarser mesh, whose cells are the parents of those of the displacement, and
   * is extended by the filling of these cells. This pair has a constant of
   * inf-sup that does not depend on the cell size or on where the body's
   * surface cuts cells; on one mesh the pair p, p - 1 has none (uncut, for
   * incompressible flow: @ref Bressan2013 "Bressan and Sangalli, 2013").
   *
   * With the tangent A of the points, the coupling B and the block C of the
   * pressure, a step of Newton's method solves
   * @f[
   *   \begin{pmatrix} A & -B \\ B^T & C \end{pmatrix}
   *   \begin{pmatrix} du \\ dp \end{pmatrix} = \begin{pmatrix} b_u \\ b_p
   *   \end{pmatrix}.
   * @f]
   * The preconditioner is upper block-triangular: dp = S^-1 b_p, du = A^-1 (b_u
   * + B dp), with one cycle of p-multigrid each for A and for S, which is C and
   * the sum over points of V / M q q, with the modulus M of pressure waves of
   * each point (close to that of @ref White2011 "White and Borja, 2011", whose
   * weights are one number). In dynamic steps A has the mass, too, and S^-1 is
   * the sum of two inverses: that one, for soil without inertia, and one for
   * soil that has nothing but inertia (as for fluids, @ref Cahouet1988 "Cahouet
   * and Chabard, 1988").
   *
   * Rows of the pressure are volumes times scale(), so that they are forces
   * that Newton's method can compare with those of the other rows.
   */
  template <int dim>
  class PoreWater
  {
  public:
    /// The field of points that keeps the pressure, Pa.
    static constexpr const char *field = "pore_pressure";
    /// For BDF2: WaterPoints::Numbers::change.
    static constexpr const char *field_of_change = "water_change";

    /**
     * Collective. The space of the displacement and the parameters are kept by
     * reference. Throws dealii::ExcMessage where these are wrong.
     */
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

    /**
     * Collective. Points are at new places.
     */
    void
    set_points(const std::vector<Body<dim>>    &bodies,
               const std::vector<Surface<dim>> &surfaces);

    /**
     * Collective. Begin a step of length @p dt (s) that ends at @p time with
     * the acceleration @p gravity. The one before had the length @p last_dt; 0:
     * there is none that BDF2 can go on from. Throws dealii::ExcMessage where a
     * formula has no value.
     */
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

    /**
     * Collective. The pressure that a trial step begins with: zero, or where
     * flow or friction depend on it, that of the points at the start.
     */
    void
    guess(VectorType &x);

    /**
     * Collective. The pressure x, the force on the grid, which is overwritten,
     * and the residual of the balance of water.
     */
    void
    evaluate(const VectorField<dim> &u,
             const VectorType       &x,
             VectorField<dim>       &force,
             VectorType             &residual);

    /**
     * Collective. The derivatives of the last evaluate(), without A.
     */
    void
    multiply(const VectorField<dim> &du,
             const VectorType       &dx,
             VectorField<dim>       &force,
             VectorType             &rows) const;

    /**
     * Collective. The derivative of the force by the pressure.
     */
    void
    spread(const VectorType &dx, VectorField<dim> &force) const;

    /**
     * Collective. The force at the start of the step, with the pressures that
     * points keep.
     */
    void
    begin_force(VectorField<dim> &force) const;

    /**
     * The part of the force that depends on no pressure of the pores, that of
     * the water around the bodies; null where there is none.
     */
    const VectorField<dim> *
    outer_force() const
    {
      return free_surface ? &free_surface->force() : nullptr;
    }

    /**
     * What makes the u of M u = b in the second argument out of the b in the
     * first one.
     */
    using SolveMass =
      std::function<void(const VectorField<dim> &, VectorField<dim> &)>;

    /**
     * Collective. Make the cycles of the Schur complement of the last
     * evaluate(), unless there are any of this step and the flow is linear,
     * where A has the mass M times @p mass_factor (1 / s^2), and
     * nothing else in explicit steps. Throws ErrorOnAll where none can be made.
     */
    void
    set_up(const double mass_factor, const SolveMass &solve_mass);

    /**
     * Collective. dx = S^-1 rows.
     */
    void
    precondition(VectorType &dx, const VectorType &rows) const;

    /**
     * Collective. The pressure with the coefficients @p x at the points of each
     * of the @p surfaces, see values_at_surfaces().
     */
    std::vector<std::vector<double>>
    at_surfaces(const VectorType                               &x,
                const std::vector<const MaterialPoints<dim> *> &surfaces) const;

    /**
     * Collective. The norm of the forces, and what round-off makes of the
     * residual, of the last evaluate().
     */
    double
    force_scale() const;

    double
    round_off() const;

    /**
     * Collective. Give the points the pressure of the last evaluate(). Returns
     * the share of this process of the water that has come to the pores, of
     * that which has left through all boundaries in the step, and through each
     * wall, each surface, and the free surface, m^3 (2D: m^2). The @p last
     * numbers are those of the step before.
     */
    std::vector<double>
    advance(std::vector<Body<dim>>    &bodies,
            const std::vector<double> &last) const;

    /// The mean density of soil and water at the start of the step, kg / m^3.
    double
    density() const
    {
      return mean_density;
    }

    /// WaterPoints::work(), and that of outer_force() in the last evaluate().
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

    /// WaterPoints::add_schur_complement(), and the cycle.
    std::unique_ptr<PMultigrid<dim>>
    make_cycle(const Levels &levels, const double mobility) const;

    /**
     * Collective. WaterPoints::set_free_motion().
     */
    void
    find_free_motion(const SolveMass &solve_mass);

    const SplineSpace<dim>     &displacements;
    const SimulationParameters &parameters;
    OrderHierarchy<dim>         orders;
    std::vector<unsigned int>   parents; // of owned cells
    PointTransfer<dim>          transfer;
    CellFilling<dim>            filling;
    std::vector<double>         filled; // parts of the displacement's cells
    WaterPoints<dim>            points;
    DrainedBoundaries<dim>      drained;

    std::unique_ptr<FreeSurface<dim>> free_surface; // null: none
    double                            outer_work = 0.;

    bool flow_is_linear = true;

    // Without inertia; and with nothing but it, in dynamic steps.
    Levels                             levels, levels_of_mass;
    std::vector<SpacePolynomials<dim>> tables; // by level
    std::unique_ptr<PMultigrid<dim>>   multigrid, multigrid_of_mass;
    TangentParameters                  of_cycle;
    bool                               is_first = true, is_explicit = false;

    // Of what water did in the last step, in BDF2.
    double part_of_earlier = 0.;

    double             scale        = 0.; // N / m^3 (2D: N / m^3)
    double             speed        = 0.; // of pressure waves, m / s
    double             mean_density = 1.;
    mutable VectorType pressure, rows;
  };
} // namespace greville

#endif
