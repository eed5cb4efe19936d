// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_water_drained_boundaries_h
#define greville_water_drained_boundaries_h

#include <greville/base/expression.h>
#include <greville/parameters/simulation_parameters.h>
#include <greville/points/surface.h>
#include <greville/points/water_points.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * What the material of a body says of the water in it.
   */
  template <int dim>
  WaterConstants
  water_constants(const Body<dim> &body, const WaterParameters &water);



  /**
   * The walls and surfaces that water passes, as the points of their integrals
   * in WaterPoints: Gauss points of the cells at walls, of which as much of the
   * area counts as the cell is filled, and the points of surfaces.
   */
  template <int dim>
  class DrainedBoundaries
  {
  public:
    /**
     * The @p displacements and @p parameters are kept by reference. The
     * @p penalty is that of Nitsche's method times the size of a cell. Throws
     * dealii::ExcMessage for wrong formulas.
     */
    DrainedBoundaries(const SplineSpace<dim>     &displacements,
                      const SimulationParameters &parameters,
                      const double                penalty);

    bool
    has_seepage_face() const;

    /// Whether water passes the surface with this number.
    bool
    has_surface(const unsigned int k) const
    {
      return of_surfaces.count(k) > 0;
    }

    /**
     * Add the points at a @p time to @p points. Cells of the displacement are
     * @p filled with bodies, as fractions. Throws dealii::ExcMessage where a
     * formula has no value.
     */
    void
    add_points(const std::vector<Body<dim>>    &bodies,
               const std::vector<Surface<dim>> &all_surfaces,
               const std::vector<double>       &filled,
               const double                     time,
               WaterPoints<dim>                &points) const;

  private:
    using Kind = typename DrainedPoint<dim>::Kind;

    /**
     * What is given at a wall or a surface: a pressure, or a flow.
     */
    struct Given
    {
      Expression formula;
      Kind       kind;
    };

    static Given
    make_given(const std::string              &pressure,
               const std::string              &flux,
               const bool                      is_seepage_face,
               const std::string              &pressure_name,
               const std::string              &flux_name,
               const std::vector<std::string> &variables);

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

    /**
     * Set what is given at a point whose mobility in full pores is known.
     */
    void
    set(DrainedPoint<dim>                     &point,
        const Given                           &given,
        const dealii::ArrayView<const double> &arguments) const;

    /**
     * Set what the soil in a cell at a wall is to the water: the mean of all
     * bodies by volume. Returns whether there is any.
     */
    bool
    set_soil(DrainedPoint<dim>            &point,
             const std::vector<Body<dim>> &bodies,
             const unsigned int            cell) const;

    const SplineSpace<dim>       &displacements;
    const SimulationParameters   &parameters;
    double                        penalty;
    std::map<unsigned int, Given> of_walls, of_surfaces;
  };
} // namespace greville

#endif
