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
  StencilMatrix<dim>::find_lines(const unsigned int cell, CellLine *lines)
  {
    const unsigned int place = this->first_place(cell);
    const unsigned int first = line_of[place];
    for (unsigned int z = 0; z < (dim == 3 ? n : 1); ++z)
      for (unsigned int y = 0; y < n; ++y)
        {
          const unsigned int line = first + y + z * n_lines_y;
          const LineRows    &rows = line_rows[line];
          const std::size_t  x =
            place + line_begin[line] - line_begin[first] - rows.begin;
          Assert(x + n <= rows.size, dealii::ExcInternalError());
          *lines++ = {values.data() + rows.entry + x * n,
                      std::size_t(rows.size) * n};
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
          const unsigned int low,
          const std::size_t  k) {
        const LineRows &rows = line_rows[line];
        const int       x    = int(low) - int(rows.begin);
        const int       size = rows.size;
        const auto      e =
          std::ptrdiff_t(rows.entry) + (std::ptrdiff_t(k) * size + x) * (p + 1);
        for (int dx = upper && j == i ? 0 : -reach; dx <= reach; ++dx)
          {
            const int row = x + std::min(dx, 0);
            visit(j + dx,
                  row < 0 || row >= size ? 0 : e + (dx < 0 ? dx * p : dx));
          }
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
