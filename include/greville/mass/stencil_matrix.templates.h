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
                                   const int          reach,
                                   const Visit       &visit) const
  {
    const int          n       = spline_space->degree() + 1;
    const int          reach_z = dim == 3 ? reach : 0;
    const unsigned int line    = line_of[i];
    for (int dz = upper ? 0 : -reach_z; dz <= reach_z; ++dz)
      for (int dy = upper && dz == 0 ? 0 : -reach; dy <= reach; ++dy)
        {
          const unsigned int other = line + dz * int(n_lines_y) + dy;
          const unsigned int lower =
            line + std::min(dz, 0) * int(n_lines_y) + std::min(dy, 0);
          const unsigned int k = std::abs(dz) * n + std::abs(dy);
          const unsigned int j = int(i) + line_begin[other] - line_begin[line];
          const std::size_t  x =
            int(i) + line_begin[lower] - line_begin[line] - line_places[lower];
          const std::size_t e =
            entries_begin[lower] + (k * line_size[lower] + x) * n;
          for (int dx = upper && dz == 0 && dy == 0 ? 0 : -reach; dx <= reach;
               ++dx)
            visit(j + dx, dx < 0 ? e + dx * (n - 1) : e + dx);
        }
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_place(const unsigned int i,
                                     const Visit       &visit) const
  {
    visit_places<false>(i, spline_space->degree(), visit);
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_entry(const unsigned int i,
                                     const Visit       &visit,
                                     const int          reach) const
  {
    visit_places<false>(i,
                        reach,
                        [&](const unsigned int j, const std::size_t e) {
                          if (values[e] != 0. && is_coupled(i, j))
                            visit(j, values[e]);
                        });
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_entry(const unsigned int i,
                                     const Visit       &visit) const
  {
    for_each_entry(i, visit, spline_space->degree());
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_upper_entry(const unsigned int i,
                                           const Visit       &visit,
                                           const int          reach) const
  {
    visit_places<true>(i,
                       reach,
                       [&](const unsigned int j, const std::size_t e) {
                         if (values[e] != 0. && is_coupled(i, j))
                           visit(j, values[e]);
                       });
  }
} // namespace greville

#endif
