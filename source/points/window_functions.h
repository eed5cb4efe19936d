// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "domains.h"
#include "gather_scatter.h"
#include <optional>

/// Sums in explicit steps over the functions of points with domains. To be
/// included in sources.
namespace greville
{
  namespace internal
  {
    /// The functions of the windows of a body's points, cell by cell. In cells
    /// that reach their neighbours, they are means over domains; in other
    /// cells, values at the points. If values are not averaged, both kinds of
    /// cells have the same sums of values.
    template <int dim, int n>
    class WindowFunctions
    {
    public:
      WindowFunctions(const MaterialPoints<dim>   &points,
                      const SpacePolynomials<dim> &tables,
                      const CellWindows<dim>      *windows,
                      const bool                   with_slopes = true)
        : points(points)
        , tables(tables)
        , windows(windows)
        , has_domains(windows_of(points, windows) &&
                      (with_slopes || windows->averages_values()))
      {}

      __attribute__((noinline)) void
      begin(const CellGeometry<dim, n> &cell_geometry, const unsigned int cell)
      {
        geometry = &cell_geometry;
        if (has_domains && windows->reaches(cell))
          window.emplace(tables, *windows, cell);
        else
          window.reset();
        functions = windows->functions(cell);
      }

      /// Call internal::gather() for a group with @p count points at @p x.
      template <typename Kind>
      void
      gather(const double      *group,
             const unsigned int count,
             const Simd (&x)[dim],
             const double *u,
             Simd         *sums)
      {
        evaluate(group, x);
        internal::gather<Kind>(shapes, count, functions, u, sums);
      }

      template <typename Kind>
      void
      scatter(const double      *group,
              const unsigned int count,
              const Simd (&x)[dim],
              const Simd *sums,
              double     *u)
      {
        evaluate(group, x);
        internal::scatter<Kind>(shapes, count, functions, sums, u);
      }

    private:
      __attribute__((noinline)) void
      evaluate(const double *group, const Simd (&x)[dim])
      {
        if (window)
          {
            Simd s[dim];
            load_domains(points, group, *window, s);
            WindowShape<dim, n> shape;
            shape.evaluate(*window, x, s);
            shapes.read(shape);
          }
        else
          {
            ShapeValues<dim, n> shape;
            shape.template evaluate<true>(*geometry, x);
            shapes.read(shape);
          }
      }

      const MaterialPoints<dim>            &points;
      const SpacePolynomials<dim>          &tables;
      const CellWindows<dim>               *windows;
      const bool                            has_domains;
      const CellGeometry<dim, n>           *geometry = nullptr;
      std::optional<WindowGeometry<dim, n>> window;
      const unsigned int                   *functions = nullptr;
      LaneShapes<dim, n + 2>                shapes;
    };
  } // namespace internal
} // namespace greville
