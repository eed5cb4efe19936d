// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/mass/stencil_matrix.h>

#include <algorithm>
#include <cstdlib>

namespace greville
{
  template <int dim>
  template <int n>
  void
  StencilMatrix<dim>::find_lines(const unsigned int cell, CellLine *lines) const
  {
    const unsigned int place = this->first_place(cell);
    const unsigned int first = line_of[place];
    for (unsigned int z = 0; z < (dim == 3 ? n : 1); ++z)
      for (unsigned int y = 0; y < n; ++y)
        {
          const unsigned int line  = first + y + z * n_lines_y;
          const std::size_t  begin = line_places[line];
          const std::size_t  x =
            int(place) - line_begin[first] + line_begin[line] - int(begin);
          *lines++ = {values.data() + begin * n_entries + x * n,
                      std::size_t(line_size[line]) * n};
        }
  }



  template <int dim>
  template <bool upper, typename Visit>
  void
  StencilMatrix<dim>::visit_places(const unsigned int i,
                                   const int          reach,
                                   const Visit       &visit) const
  {
    const int p = spline_space->degree();
    this->template for_each_line<upper>(
      i,
      reach,
      [&](const unsigned int j,
          const unsigned int line,
          const std::size_t  low,
          const std::size_t  k) {
        const std::size_t begin = line_places[line];
        const std::size_t e =
          begin * n_entries + (k * line_size[line] + low - begin) * (p + 1);
        for (int dx = upper && j == i ? 0 : -reach; dx <= reach; ++dx)
          visit(j + dx, dx < 0 ? e + dx * p : e + dx);
      });
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
