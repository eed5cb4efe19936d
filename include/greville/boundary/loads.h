// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_boundary_loads_h
#define greville_boundary_loads_h

#include <greville/boundary/point_load.h>
#include <greville/boundary/surface_loads.h>

namespace greville
{
  /**
   * Gravity g(t), which acts on the mass of the grid, and all loads on points,
   * whose sum points carry as an acceleration, the field "load"; and those on
   * surfaces.
   */
  template <int dim>
  class Loads
  {
  public:
    /**
     * Throws dealii::ExcMessage for wrong formulas.
     */
    Loads(const SimulationParameters &parameters);

    /**
     * Add "load" and what point loads keep, if there are any.
     */
    void
    add_fields(PointLayout<dim> &layout) const;

    /**
     * Collective. Let the point loads find their points at their initial
     * positions; throws dealii::ExcMessage where there are none.
     */
    void
    find_points(std::vector<Body<dim>> &bodies, const MPI_Comm comm) const;

    /**
     * Precompute what depends on the initial positions of points alone, after
     * these have changed.
     */
    void
    precompute(std::vector<Body<dim>> &bodies) const;

    /**
     * Whether points carry an acceleration.
     */
    bool
    act_on_points() const
    {
      return !point_loads.empty();
    }

    /**
     * The loads on surfaces.
     */
    const SurfaceLoads<dim> &
    surfaces() const
    {
      return surface_loads;
    }

    /**
     * Set the accelerations of points at time @p t, s.
     */
    void
    set(std::vector<Body<dim>> &bodies, const double t)
    {
      set(bodies, t, true);
    }

    /**
     * Likewise by loads that following() leaves out.
     */
    void
    set_others(std::vector<Body<dim>> &bodies, const double t)
    {
      set(bodies, t, false);
    }

    /**
     * The bodies with the sum of those point loads at time @p t that depend on
     * where the points are, for TangentSystem; none where there is no such
     * load. What it returns refers to both.
     */
    std::vector<LoadedSurface<dim>>
    following(const std::vector<Body<dim>> &bodies, const double t) const;

    /**
     * Set them to zero.
     */
    void
    clear(std::vector<Body<dim>> &bodies) const;

    /**
     * Collective. Where the loads that were last @ref set, and gravity, alone
     * move a point by more than a tenth of @p h, the smallest edge of a cell,
     * in a step @p dt: a sentence that says so and names their parameters.
     * Otherwise nothing.
     */
    std::string
    what_is_large(const double   t,
                  const double   dt,
                  const double   h,
                  const MPI_Comm comm) const;

    /**
     * Unit: m / s^2. A formula that fails does so on all processes: throws
     * ErrorOnAll.
     */
    dealii::Tensor<1, dim>
    gravity(const double t) const;

  private:
    void
    set(std::vector<Body<dim>> &bodies,
        const double            t,
        const bool              with_following);

    /**
     * The parameters of the loads that there are.
     */
    std::string
    names(const bool with_gravity) const;

    VectorExpression<dim> gravity_formulas;
    PointLoads<dim>       point_loads;
    SurfaceLoads<dim>     surface_loads;
    /// Of the points of a process, m / s^2.
    double largest = 0.;
  };
} // namespace greville

#endif
