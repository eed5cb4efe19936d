// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>
#include <greville/points/water_points.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// Return the constants of the pore water in a body from its material.
  template <int dim>
  WaterConstants
  water_constants(const Body<dim> &body, const WaterParameters &water);



  /// The walls and surfaces that water can pass, as integration points of
  /// WaterPoints: Gauss points of the cells at walls, whose area is weighted by
  /// the filling of the cell, and the points of surfaces.
  template <int dim>
  class DrainedBoundaries
  {
  public:
    /// The @p displacements and @p parameters are kept by reference. The
    /// @p penalty is the factor of Nitsche's method times the cell size. Throws
    /// dealii::ExcMessage for invalid formulas.
    DrainedBoundaries(const SplineSpace<dim>     &displacements,
                      const SimulationParameters &parameters,
                      const double                penalty);

    bool
    has_seepage_face() const;

    /// Return whether water can pass the surface with this number.
    bool
    has_surface(const unsigned int k) const
    {
      return of_surfaces.count(k) > 0;
    }

    /// Add the points of drained walls or surfaces, with their conditions at a
    /// @p time, to @p points. @p filled contains the filled fraction of each
    /// cell of the displacement. Throws dealii::ExcMessage if a formula has no
    /// value.
    void
    add_walls(const std::vector<Body<dim>> &bodies,
              const std::vector<double>    &filled,
              const double                  time,
              WaterPoints<dim>             &points) const;

    void
    add_surfaces(const std::vector<Body<dim>>    &bodies,
                 const std::vector<Surface<dim>> &all_surfaces,
                 const double                     time,
                 WaterPoints<dim>                &points) const;

  private:
    using DrainedPoint = typename WaterTerms<dim>::Drained;
    using Kind         = typename DrainedPoint::Kind;

    /// The condition at a wall or a surface: a pressure, or a flow.
    struct Given
    {
      Expression formula;
      Kind       kind;
    };

    /// Set the condition at a point whose mobility at saturation is known.
    void
    set(DrainedPoint                          &point,
        const Given                           &given,
        const dealii::ArrayView<const double> &arguments) const;

    /// Set the properties of the soil in a cell at a wall to the mean of all
    /// bodies, weighted by volume. Returns whether there is any soil.
    bool
    set_soil(DrainedPoint                 &point,
             const std::vector<Body<dim>> &bodies,
             const unsigned int            cell) const;

    const SplineSpace<dim>       &displacements;
    const SimulationParameters   &parameters;
    double                        penalty;
    std::map<unsigned int, Given> of_walls, of_surfaces;
  };
} // namespace greville
