// SPDX-License-Identifier: LGPL-2.1-or-later

#include "point_kernels.h"
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  std::string
  describe_place(const SplineSpace<dim> &space,
                 const unsigned int      cell,
                 const Point<dim>       &x,
                 const std::string      &word)
  {
    std::ostringstream text;
    text << "at (";
    for (unsigned int d = 0; d < dim; ++d)
      text << (d > 0 ? ", " : "") << x[d];
    text << ") m, " << word << " the cell (";
    const auto index =
      multi_index<dim>(space.owned_cells()[cell], space.lattice().n_cells());
    for (unsigned int d = 0; d < dim; ++d)
      text << (d > 0 ? ", " : "") << index[d];
    return text.str() + ")";
  }



  template <int dim>
  void
  PointTransfer<dim>::reinit(const SplineSpace<dim> &space,
                             const CellWindows<dim> *given)
  {
    tables.reinit(space);
    windows = given;
  }



  template <int dim>
  void
  PointTransfer<dim>::resize_numbers(const unsigned int stride)
  {
    const SplineSpace<dim> &space = *tables.space;
    numbers_stride                = stride;
    numbers.resize_fast((windows ? windows->n_places()
                                 : space.owned_functions().size() +
                                     space.ghost_functions().size()) *
                        stride);
  }



  template <int dim>
  void
  PointTransfer<dim>::read_number(const VectorType  &vector,
                                  const unsigned int k)
  {
    if (windows)
      windows->read(vector, numbers.data() + k, numbers_stride);
    else
      put_into_buffer(vector, numbers_stride, k, numbers);
  }



  template <int dim>
  void
  PointTransfer<dim>::write_number(const unsigned int k, VectorType &vector)
  {
    if (!windows)
      return take_from_buffer(numbers, numbers_stride, k, vector);
    vector = 0.;
    windows->add_to(vector, numbers.data() + k, numbers_stride);
  }



  template <int dim>
  void
  PointTransfer<dim>::filling(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    std::vector<double>                            &result) const
  {
    constexpr double largest_expansion = 1.5;
    result.assign(tables.space->owned_cells().size(), 0.);
    for (const MaterialPoints<dim> *points : bodies)
      for (std::size_t c = 0; c < points->cells().size(); ++c)
        {
          const unsigned int cell = points->cells()[c];
          Simd               sum  = 0.;
          for (unsigned int g = points->first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points->next_group(g))
            {
              prefetch_next(*points,
                            c,
                            g,
                            PointLayout<dim>::J + 1,
                            PointLayout<dim>::volume0);
              const double *group = points->group(g);
              Simd          volume =
                load(group + PointLayout<dim>::volume0 * simd_width);
              if (!points->layout().is_total_lagrangian())
                volume *=
                  min(max(load(group + PointLayout<dim>::J * simd_width),
                          Simd(1.)),
                      Simd(largest_expansion));
              sum += volume;
            }
          result[cell] +=
            reduce(sum) /
            cell_volume<dim>(*tables.space, cell, points->layout());
        }
  }



  template <int dim>
  Tensor<1, dim>
  PointTransfer<dim>::spread(const unsigned int cell, const Point<dim> &x) const
  {
    const SplineSpace<dim> &space   = *tables.space;
    const auto             &lattice = space.lattice();
    const unsigned int      n       = space.degree() + 1;
    const auto              index =
      multi_index<dim>(space.owned_cells()[cell], lattice.n_cells());
    const Point<dim> center = lattice.cell_center(index);
    Tensor<1, dim>   result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double *c       = tables.directions[d].coefficients(index[d]);
        const double *offsets = tables.directions[d].greville_offsets(index[d]);
        const double  t       = (x[d] - center[d]) / lattice.cell_size(d);
        for (unsigned int a = 0; a < n; ++a)
          {
            double N = 0.;
            for (int k = n - 1; k >= 0; --k)
              N = N * t + c[a * n + k];
            result[d] += N * std::pow(center[d] + offsets[a] - x[d], 2);
          }
      }
    return result;
  }



  template decltype(describe_place<2>) describe_place<2>;
  template decltype(describe_place<3>) describe_place<3>;
  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville
