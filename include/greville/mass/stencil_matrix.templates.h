// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_stencil_matrix_templates_h
#define greville_mass_stencil_matrix_templates_h

#include <greville/mass/stencil_matrix.h>

#include <algorithm>
#include <cstdlib>

namespace greville
{
  template <int dim>
  template <bool upper, typename Visit>
  void
  StencilMatrix<dim>::visit_places(const unsigned int i,
                                   const Visit       &visit) const
  {
    const int          p    = spline_space->degree();
    const int          p_z  = dim == 3 ? p : 0;
    const unsigned int line = line_of[i];
    for (int dz = upper ? 0 : -p_z; dz <= p_z; ++dz)
      for (int dy = upper && dz == 0 ? 0 : -p; dy <= p; ++dy)
        {
          const unsigned int other = line + dz * int(n_lines_y) + dy;
          const unsigned int lower =
            line + std::min(dz, 0) * int(n_lines_y) + std::min(dy, 0);
          const unsigned int k = std::abs(dz) * (p + 1) + std::abs(dy);
          const unsigned int j = int(i) + line_begin[other] - line_begin[line];
          const std::size_t  x =
            int(i) + line_begin[lower] - line_begin[line] - line_places[lower];
          const std::size_t e =
            entries_begin[lower] + (k * line_size[lower] + x) * (p + 1);
          for (int dx = upper && dz == 0 && dy == 0 ? 0 : -p; dx <= p; ++dx)
            visit(j + dx, dx < 0 ? e + dx * p : e + dx);
        }
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_place(const unsigned int i,
                                     const Visit       &visit) const
  {
    visit_places<false>(i, visit);
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_entry(const unsigned int i,
                                     const Visit       &visit) const
  {
    visit_places<false>(i, [&](const unsigned int j, const std::size_t e) {
      if (values[e] != 0. && is_coupled(i, j))
        visit(j, values[e]);
    });
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_upper_entry(const unsigned int i,
                                           const Visit       &visit) const
  {
    visit_places<true>(i, [&](const unsigned int j, const std::size_t e) {
      if (values[e] != 0. && is_coupled(i, j))
        visit(j, values[e]);
    });
  }
} // namespace greville

#endif
