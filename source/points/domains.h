// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "window_shape.h"

/**
 * B-splines averaged over the domains of points. To be included in sources.
 *
 * The domain of a point is a box around it with edges 2 s_d along the axes. It
 * has the same second moments as the stress-free box deformed by F, s_i^2 =
 * sum_j F_ij^2 s0_j^2. So a rotated cube keeps its domain, and boxes that fill
 * a body still fill it after a stretch along the axes. The domain is not larger
 * than the smallest of its cell and the neighbours, and it is cut at the edges
 * of the grid.
 */
namespace greville::internal
{
  /// Return the windows if points have domains, otherwise null.
  template <int dim>
  inline const CellWindows<dim> *
  windows_of(const MaterialPoints<dim> &points, const CellWindows<dim> *windows)
  {
    return points.layout().domain == 0 ? nullptr : windows;
  }



  /// Load the half edges s_d of the domains of a group in the cell of the
  /// window.
  template <int dim, int n>
  inline void
  load_domains(const MaterialPoints<dim>    &points,
               const double                 *group,
               const WindowGeometry<dim, n> &window,
               Simd (&s)[dim])
  {
    using std::min;
    using std::sqrt;
    Simd initial[dim];
    load_numbers<dim>(group, points.layout().domain, initial);
    for (int i = 0; i < dim; ++i)
      {
        s[i] = 0.;
        for (int j = 0; j < dim; ++j)
          {
            const Simd edge =
              initial[j] *
              load(group + (PointLayout<dim>::F + i * dim + j) * simd_width);
            s[i] += edge * edge;
          }
        s[i] = min(Simd(sqrt(s[i])), Simd(window.largest_domain[i]));
      }
  }



  /// Read the coefficients of the functions of a window, [function][field].
  template <int dim, int n>
  inline void
  read_window(const WindowGeometry<dim, n> &cell,
              const double                 *buffer,
              double                       *u,
              const int                     n_fields = dim)
  {
    for (int a = 0; a < WindowShape<dim, n>::n_functions; ++a)
      for (int k = 0; k < n_fields; ++k)
        u[a * n_fields + k] =
          buffer[std::size_t(cell.functions[a]) * n_fields + k];
  }
} // namespace greville::internal
