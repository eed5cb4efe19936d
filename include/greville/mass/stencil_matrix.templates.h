// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_stencil_matrix_templates_h
#define greville_mass_stencil_matrix_templates_h

#include <greville/mass/stencil_matrix.h>

#include <algorithm>

namespace greville
{
  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_place(const unsigned int i,
                                     const Visit       &visit) const
  {
    const int          p      = spline_space->degree();
    const int          length = 2 * p + 1;
    const int          center = half - 1;
    const unsigned int line   = line_of[i];
    int                full   = 0;
    for (unsigned int k = 0; k < neighbor_lines.size(); ++k)
      {
        const int first = int(i) + distance(line, k) - p;
        for (int dx = 0; dx < length; ++dx, ++full)
          {
            const unsigned int j = first + dx;
            visit(j,
                  full >= center ? std::size_t(i) * half + (full - center)
                                 : std::size_t(j) * half + (center - full));
          }
      }
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_entry(const unsigned int i,
                                     const Visit       &visit) const
  {
    for_each_place(i, [&](const unsigned int j, const std::size_t e) {
      const double value = values[e];
      if (value != 0.)
        visit(j, value);
    });
  }



  template <int dim>
  template <typename Visit>
  void
  StencilMatrix<dim>::for_each_upper_entry(const unsigned int i,
                                           const Visit       &visit) const
  {
    const int          p      = spline_space->degree();
    const unsigned int line   = line_of[i];
    const double      *entry  = values.data() + std::size_t(i) * half;
    const unsigned int center = neighbor_lines.size() / 2;
    for (unsigned int k = center; k < neighbor_lines.size(); ++k)
      {
        const unsigned int first = int(i) + distance(line, k) - p;
        for (unsigned int j = k == center ? i : first; j <= first + 2 * p;
             ++j, ++entry)
          if (*entry != 0.)
            visit(j, *entry);
      }
  }
} // namespace greville

#endif
