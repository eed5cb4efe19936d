// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/point_load.h>
#include <greville/boundary/surface_loads.h>

namespace greville
{
  /// All loads: gravity g(t), which acts on the mass of the grid; loads on
  /// points, whose sum is stored in the points as an acceleration, the field
  /// "load"; and loads on surfaces.
  template <int dim>
  class Loads
  {
  public:
    /// Throws dealii::ExcMessage for invalid formulas.
    Loads(const SimulationParameters &parameters);

    /// Add the field "load" and the fields of the point loads, if there are
    /// any.
    void
    add_fields(PointLayout<dim> &layout) const;

    /// Collective. Let the point loads find their points at their initial
    /// positions; throws dealii::ExcMessage if a load has no points.
    void
    find_points(std::vector<Body<dim>> &bodies, const MPI_Comm comm) const;

    /// Precompute data that depend only on the initial positions of points. To
    /// be called after initial positions have changed.
    void
    precompute(std::vector<Body<dim>> &bodies) const;

    /// Return whether points carry an acceleration.
    bool
    act_on_points() const
    {
      return !point_loads.empty();
    }

    const SurfaceLoads<dim> &
    surfaces() const
    {
      return surface_loads;
    }

    /// Set the accelerations of points at time @p t, s, by all loads or,
    /// without @p with_following, by loads that are not in following().
    void
    set(std::vector<Body<dim>> &bodies,
        const double            t,
        const bool              with_following = true);

    /// Return the bodies with the sum of the point loads at time @p t that
    /// depend on the current positions of points, for TangentSystem; empty if
    /// there are none. The result refers to the bodies and to this object.
    std::vector<LoadedSurface<dim>>
    following(const std::vector<Body<dim>> &bodies, const double t) const;

    /// Set the accelerations to zero.
    void
    clear(std::vector<Body<dim>> &bodies) const;

    /// Collective. Return a sentence with the names of the parameters if
    /// gravity and the loads of the last set() alone move a point by more than
    /// a tenth of @p h, the smallest edge of a cell, in a step @p dt; otherwise
    /// an empty text.
    std::string
    describe_large_loads(const double   t,
                         const double   dt,
                         const double   h,
                         const MPI_Comm comm) const;

    /// Return gravity, m / s^2. Throws ErrorOnAll if a formula fails on any
    /// process.
    dealii::Tensor<1, dim>
    gravity(const double t) const;

  private:
    /// Return the parameters of the loads that are present.
    std::string
    names(const bool with_gravity) const;

    VectorExpression<dim> gravity_formulas;
    PointLoads<dim>       point_loads;
    SurfaceLoads<dim>     surface_loads;
    /// The largest acceleration of the points of a process, m / s^2.
    double largest = 0.;
  };
} // namespace greville
