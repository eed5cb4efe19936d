// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/stiffness/block_stencil.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Lines of entries are as long as a multiple of this.
    constexpr int vector_width = 4;
    using Vector               = FixedSimd<double, vector_width>;

    constexpr int
    padded(const int n)
    {
      return (n + vector_width - 1) / vector_width * vector_width;
    }
  } // namespace



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::reinit(const StencilMatrix<dim> &stencil)
  {
    places    = &stencil;
    length    = 2 * stencil.space().degree() + 1;
    n_lines   = Utilities::fixed_power<dim - 1>(length);
    line_size = padded(length * dim);
    row_size  = std::size_t(n_lines) * dim * line_size;
    n_rows    = 0;
    row_of    = ZeroedArray<std::size_t>(stencil.size());
    values.clear();
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::clear()
  {
    n_rows = 0;
    places->for_each_row([&](const unsigned int i) { row_of[i] = n_rows++; });
    values.assign(n_rows * row_size, 0.);
  }



  template <int dim, typename Number>
  template <typename OtherNumber>
  void
  BlockStencil<dim, Number>::copy(const BlockStencil<dim, OtherNumber> &other)
  {
    Assert(places == other.places, ExcInternalError());
    n_rows = other.n_rows;
    places->for_each_row(
      [&](const unsigned int i) { row_of[i] = other.row_of[i]; });
    values.assign(other.values.begin(), other.values.end());
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::add_cell(const unsigned int cell,
                                      const double      *cell_values)
  {
    with_order(places->space().degree(), [&](const auto n) {
      add_cell_of_order<decltype(n)::value>(cell, cell_values);
    });
  }



  template <int dim, typename Number>
  template <int n>
  void
  BlockStencil<dim, Number>::add_cell_of_order(const unsigned int cell,
                                               const double      *from)
  {
    constexpr int length = 2 * n - 1;
    constexpr int n_z    = dim == 3 ? n : 1;
    constexpr int n_all  = n * n * n_z;

    for (int a_z = 0, a = 0; a_z < n_z; ++a_z)
      for (int a_y = 0; a_y < n; ++a_y)
        for (int a_x = 0; a_x < n; ++a_x, ++a)
          {
            Number *entries = row(places->cell_place(cell, a_x, a_z * n + a_y));
            for (int i = 0; i < dim; ++i)
              for (int k = 0; k < dim; ++k)
                for (int b_z = 0, b = 0; b_z < n_z; ++b_z)
                  for (int b_y = 0; b_y < n; ++b_y, b += n)
                    {
                      const int number =
                        (dim == 3 ? b_z - a_z + n - 1 : 0) * length + b_y -
                        a_y + n - 1;
                      Number *to =
                        entries + line(number, i) + (n - 1 - a_x) * dim + k;
                      const double *values =
                        from + ((a * dim + i) * dim + k) * n_all + b;
                      for (int b_x = 0; b_x < n; ++b_x)
                        to[b_x * dim] += values[b_x];
                    }
          }
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::add(const double              factor,
                                 const StencilMatrix<dim> &scalar)
  {
    std::vector<double> stencil(n_lines * length);
    places->for_each_row([&](const unsigned int i) {
      scalar.get_row(i, stencil.data());
      Number *entries = row(i);
      for (unsigned int k = 0; k < n_lines; ++k)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int x = 0; x < length; ++x)
            entries[line(k, c) + x * dim + c] +=
              factor * stencil[k * length + x];
    });
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::diagonal_block(StencilMatrix<dim> &scalar,
                                            const unsigned int components) const
  {
    std::vector<double> stencil(n_lines * length);
    unsigned int        n = 0;
    for (unsigned int c = 0; c < dim; ++c)
      n += (components >> c) & 1;
    places->for_each_row([&](const unsigned int i) {
      const Number *entries = row(i);
      for (unsigned int k = 0; k < n_lines; ++k)
        for (unsigned int x = 0; x < length; ++x)
          {
            double sum = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              if ((components >> c) & 1)
                sum += entries[line(k, c) + x * dim + c];
            stencil[k * length + x] = sum / n;
          }
      scalar.set_row(i, stencil.data());
    });
  }



  template <int dim, typename Number>
  double
  BlockStencil<dim, Number>::diagonal(const unsigned int place,
                                      const unsigned int c) const
  {
    return row(place)[line(n_lines / 2, c) + length / 2 * dim + c];
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::vmult(double *y, const double *x) const
  {
    with_order(places->space().degree(),
               [&](const auto n) { multiply<decltype(n)::value>(y, x); });
  }



  template <int dim, typename Number>
  template <int n>
  void
  BlockStencil<dim, Number>::multiply(double *y, const double *x) const
  {
    constexpr int p         = n - 1;
    constexpr int lines     = dim == 3 ? (2 * p + 1) * (2 * p + 1) : 2 * p + 1;
    constexpr int n_vectors = padded((2 * p + 1) * dim) / vector_width;
    std::size_t   number    = 0;
    places->for_each_segment([&](const unsigned int begin,
                                 const unsigned int end,
                                 const auto        &distance) {
      std::ptrdiff_t distances[lines];
      for (int k = 0; k < lines; ++k)
        distances[k] = std::ptrdiff_t(distance(k) - p) * dim;
      for (unsigned int i = begin; i < end; ++i, ++number)
        {
          const Number *entries = values.data() + number * row_size;
          const double *x_i     = x + std::size_t(i) * dim;
          Vector        sums[dim];
          for (int c = 0; c < dim; ++c)
            sums[c] = 0.;
          for (int k = 0; k < lines; ++k)
            {
              const double *x_k = x_i + distances[k];
              Vector        from[n_vectors];
#pragma GCC unroll 8
              for (int v = 0; v < n_vectors; ++v)
                from[v] = load<Vector>(x_k + v * vector_width);
#pragma GCC unroll 3
              for (int c = 0; c < dim; ++c)
#pragma GCC unroll 8
                for (int v = 0; v < n_vectors; ++v, entries += vector_width)
                  sums[c] += load<Vector>(entries) * from[v];
            }
          for (int c = 0; c < dim; ++c)
            y[std::size_t(i) * dim + c] = reduce(sums[c]);
        }
    });
  }



  template class BlockStencil<2>;
  template class BlockStencil<3>;
  template class BlockStencil<2, float>;
  template class BlockStencil<3, float>;
  template void
  BlockStencil<2, float>::copy(const BlockStencil<2> &);
  template void
  BlockStencil<3, float>::copy(const BlockStencil<3> &);
} // namespace greville
