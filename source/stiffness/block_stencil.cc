// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/with_width.h>
#include <greville/stiffness/block_stencil.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  BlockStencil<dim>::reinit(const StencilMatrix<dim> &stencil)
  {
    places   = &stencil;
    n_blocks = Utilities::fixed_power<dim>(2 * stencil.space().degree() + 1);
    row_size = std::size_t(n_blocks) * dim * dim;
    n_rows   = 0;
    row_of   = ZeroedArray<std::size_t>(stencil.size());
    values.clear();
  }



  template <int dim>
  void
  BlockStencil<dim>::clear()
  {
    n_rows = 0;
    places->for_each_row([&](const unsigned int i) { row_of[i] = n_rows++; });
    values.assign(n_rows * row_size, 0.);
  }



  template <int dim>
  void
  BlockStencil<dim>::add_cell(const unsigned int cell,
                              const double      *cell_values)
  {
    with_order(places->space().degree(), [&](const auto n) {
      add_cell_of_order<decltype(n)::value>(cell, cell_values);
    });
  }



  template <int dim>
  template <int n>
  void
  BlockStencil<dim>::add_cell_of_order(const unsigned int cell,
                                       const double      *from)
  {
    constexpr int length = 2 * n - 1;
    constexpr int n_z    = dim == 3 ? n : 1;
    constexpr int n_all  = n * n * n_z;

    const auto functions = places->space().cell_functions(cell);
    for (int a_z = 0, a = 0; a_z < n_z; ++a_z)
      for (int a_y = 0; a_y < n; ++a_y)
        for (int a_x = 0; a_x < n; ++a_x, ++a)
          {
            double *entries = row(places->place(functions[a]));
            for (int i = 0; i < dim; ++i)
              for (int k = 0; k < dim; ++k)
                for (int b_z = 0, b = 0; b_z < n_z; ++b_z)
                  for (int b_y = 0; b_y < n; ++b_y, b += n)
                    {
                      const int first =
                        ((dim == 3 ? b_z - a_z + n - 1 : 0) * length + b_y -
                         a_y + n - 1) *
                          length -
                        a_x + n - 1;
                      double       *to = entries + index(first, i, k);
                      const double *line =
                        from + ((a * dim + i) * dim + k) * n_all + b;
                      for (int b_x = 0; b_x < n; ++b_x)
                        to[b_x * dim] += line[b_x];
                    }
          }
  }



  template <int dim>
  void
  BlockStencil<dim>::add(const double factor, const StencilMatrix<dim> &scalar)
  {
    std::vector<double> stencil(n_blocks);
    places->for_each_row([&](const unsigned int i) {
      scalar.get_row(i, stencil.data());
      double *entries = row(i);
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int k = 0; k < n_blocks; ++k)
          entries[index(k, c, c)] += factor * stencil[k];
    });
  }



  template <int dim>
  void
  BlockStencil<dim>::mean(StencilMatrix<dim> &scalar) const
  {
    std::vector<double> stencil(n_blocks);
    places->for_each_row([&](const unsigned int i) {
      const double *entries = row(i);
      for (unsigned int k = 0; k < n_blocks; ++k)
        {
          double sum = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            sum += entries[index(k, c, c)];
          stencil[k] = sum / dim;
        }
      scalar.set_row(i, stencil.data());
    });
  }



  template <int dim>
  double
  BlockStencil<dim>::diagonal(const unsigned int place,
                              const unsigned int c) const
  {
    return row(place)[index(n_blocks / 2, c, c)];
  }



  template <int dim>
  void
  BlockStencil<dim>::vmult(double *y, const double *x) const
  {
    with_order(places->space().degree(),
               [&](const auto n) { multiply<decltype(n)::value>(y, x); });
  }



  template <int dim>
  template <int n>
  void
  BlockStencil<dim>::multiply(double *y, const double *x) const
  {
    constexpr int p      = n - 1;
    constexpr int length = (2 * p + 1) * dim;
    constexpr int lines  = dim == 3 ? (2 * p + 1) * (2 * p + 1) : 2 * p + 1;
    std::size_t   number = 0;
    places->for_each_segment([&](const unsigned int begin,
                                 const unsigned int end,
                                 const auto        &distance) {
      std::ptrdiff_t distances[lines];
      for (int k = 0; k < lines; ++k)
        distances[k] = std::ptrdiff_t(distance(k) - p) * dim;
      for (unsigned int i = begin; i < end; ++i, ++number)
        {
          const double *entries = values.data() + number * row_size;
          const double *x_i     = x + std::size_t(i) * dim;
          for (int c = 0; c < dim; ++c)
            {
              double sums[length] = {};
              for (int k = 0; k < lines; ++k, entries += length)
                {
                  const double *x_k = x_i + distances[k];
                  for (int m = 0; m < length; ++m)
                    sums[m] += entries[m] * x_k[m];
                }
              double sum = 0.;
              for (int m = 0; m < length; ++m)
                sum += sums[m];
              y[std::size_t(i) * dim + c] = sum;
            }
        }
    });
  }



  template class BlockStencil<2>;
  template class BlockStencil<3>;
} // namespace greville
