// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/stiffness/block_stencil.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::reinit(const StencilMatrix<dim> &stencil)
  {
    const unsigned int p = stencil.space().degree();
    matrix               = &stencil;
    length               = 2 * p + 1;
    n_lines              = Utilities::fixed_power<dim - 1>(length) / 2 + 1;
    with_order(p, [&](const auto n) {
      line_size = HalfStencil<dim, dim, decltype(n)::value, Number>::line_size;
    });
    first_of_line = p * dim;
    row_size      = std::size_t(n_lines) * dim * line_size;
    row_of        = ZeroedArray<unsigned int>(stencil.size());
    if (std::is_same_v<Number, float>)
      for (ZeroedArray<Number> *array : {&single_x, &single_y})
        *array = ZeroedArray<Number>(stencil.size() * dim + line_size);
    values.clear();
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::clear()
  {
    unsigned int n_rows = 0;
    matrix->for_each_row([&](const unsigned int i) { row_of[i] = n_rows++; });
    values.assign(std::size_t(n_rows) * row_size, 0.);
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::add_cell(const unsigned int cell,
                                      const Number      *cell_values,
                                      const unsigned int stride)
  {
    with_order(matrix->space().degree(), [&](const auto n) {
      add_cell_of_order<decltype(n)::value>(cell, cell_values, stride);
    });
  }



  template <int dim, typename Number>
  template <int n>
  void
  BlockStencil<dim, Number>::add_cell_of_order(const unsigned int cell,
                                               const Number      *from,
                                               const unsigned int stride)
  {
    constexpr int length      = 2 * n - 1;
    constexpr int size        = HalfStencil<dim, dim, n, Number>::line_size;
    constexpr int n_z         = dim == 3 ? n : 1;
    constexpr int n_functions = n * n * n_z;

    // The block (i, k), and whether the transpose of a stored block is used.
    const Number *blocks[dim][dim];
    for (int i = 0, block = 0; i < dim; ++i)
      for (int k = i; k < dim; ++k, ++block)
        blocks[i][k] = blocks[k][i] =
          from + std::size_t(block) * n_functions * stride;

    for (int a_z = 0, a = 0; a_z < n_z; ++a_z)
      for (int a_y = 0; a_y < n; ++a_y)
        for (int a_x = 0; a_x < n; ++a_x, ++a)
          {
            Number *entries = row(matrix->cell_place(cell, a_x, a_z * n + a_y));
            for (int b_z = a_z, b_line = (a / n) * n; b_z < n_z; ++b_z)
              for (int b_y = b_z == a_z ? a_y : 0; b_y < n; ++b_y, b_line += n)
                {
                  const int k_line = (b_z - a_z) * length + b_y - a_y;
                  const int first  = k_line == 0 ? a_x : 0;
                  Number   *to =
                    entries + k_line * dim * size + (n - 1 - a_x) * dim;
                  for (int b_x = first; b_x < n; ++b_x)
                    {
                      const int         b     = b_line + b_x;
                      const std::size_t there = a * stride + b,
                                        back  = b * stride + a;
                      const Number factor     = b == a ? 0.5 : 1.;
#pragma GCC unroll 3
                      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 3
                        for (int k = 0; k < dim; ++k)
                          to[i * size + b_x * dim + k] +=
                            factor * blocks[i][k][i <= k ? there : back];
                    }
                }
          }
  }



  template <int dim, typename Number>
  template <typename Other>
  void
  BlockStencil<dim, Number>::copy(const BlockStencil<dim, Other> &other)
  {
    clear();
    matrix->for_each_row([&](const unsigned int i) {
      Number      *to   = row(i);
      const Other *from = other.row(i);
      for (unsigned int k = 0; k < n_lines * dim; ++k)
        std::copy_n(from + k * other.line_size,
                    length * dim,
                    to + k * line_size);
    });
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::add(const double              factor,
                                 const StencilMatrix<dim> &scalar)
  {
    std::vector<double> stencil((2 * n_lines - 1) * length);
    const double       *half = stencil.data() + (n_lines - 1) * length;
    matrix->for_each_row([&](const unsigned int i) {
      scalar.get_row(i, stencil.data());
      Number *entries = row(i);
      for (unsigned int k = 0; k < n_lines; ++k)
        for (unsigned int x = k == 0 ? length / 2 : 0; x < length; ++x)
          for (unsigned int c = 0; c < dim; ++c)
            entries[line(k, c) + x * dim + c] +=
              (k == 0 && x == length / 2 ? 0.5 : 1.) * factor *
              half[k * length + x];
    });
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::diagonal_block(StencilMatrix<dim> &scalar,
                                            const unsigned int components) const
  {
    std::vector<double> stencil((2 * n_lines - 1) * length);
    double             *half = stencil.data() + (n_lines - 1) * length;
    unsigned int        n    = 0;
    for (unsigned int c = 0; c < dim; ++c)
      n += (components >> c) & 1;
    scalar.clear();
    matrix->for_each_row([&](const unsigned int i) {
      const Number *entries = row(i);
      for (unsigned int k = 0; k < n_lines; ++k)
        for (unsigned int x = 0; x < length; ++x)
          {
            double sum = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              if ((components >> c) & 1)
                sum += entries[line(k, c) + x * dim + c];
            half[k * length + x] =
              (k == 0 && x == length / 2 ? 2. : 1.) * sum / n;
          }
      scalar.add_row(i, stencil.data());
    });
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::vmult(double *y, const double *x) const
  {
    if constexpr (std::is_same_v<Number, double>)
      multiply(y, x);
    else
      {
        const auto for_each_range = [&](const auto &action) {
          matrix->for_each_segment([&](const unsigned int begin,
                                       const unsigned int end,
                                       const auto &) {
            action(std::size_t(begin) * dim, std::size_t(end) * dim);
          });
        };
        double largest = 0.;
        for_each_range([&](const std::size_t begin, const std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            largest = std::max(largest, std::abs(x[k]));
        });
        constexpr double smallest = 1e-280;
        int              exponent = 0;
        if (largest > smallest && std::isfinite(largest))
          std::frexp(largest, &exponent);
        const double down = std::ldexp(1., -exponent),
                     up   = std::ldexp(1., exponent);
        for_each_range([&](const std::size_t begin, const std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            single_x[k] = Number(down * x[k]);
        });
        multiply(single_y.data(), single_x.data());
        for_each_range([&](const std::size_t begin, const std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            y[k] = up * single_y[k];
        });
      }
  }



  template <int dim, typename Number>
  void
  BlockStencil<dim, Number>::multiply(Number *y, const Number *x) const
  {
    with_order(matrix->space().degree(),
               [&](const auto n) { multiply_rows<decltype(n)::value>(y, x); });
  }



  template <int dim, typename Number>
  template <int n>
  void
  BlockStencil<dim, Number>::multiply_rows(Number *y, const Number *x) const
  {
    using Half = HalfStencil<dim, dim, n, Number>;
    matrix->for_each_segment(
      [&](const unsigned int begin, const unsigned int end, const auto &) {
        std::fill(y + std::size_t(begin) * dim,
                  y + std::size_t(end) * dim,
                  Number(0.));
      });
    const Number *entries = values.data();
    matrix->for_each_segment([&](const unsigned int begin,
                                 const unsigned int end,
                                 const auto        &distance) {
      std::ptrdiff_t distances[Half::n_lines];
      for (int k = 0; k < Half::n_lines; ++k)
        distances[k] =
          std::ptrdiff_t(distance(Half::n_lines - 1 + k) - (n - 1)) * dim;
      for (unsigned int i = begin; i < end; ++i, entries += Half::row_size)
        Half::multiply(entries,
                       x + std::size_t(i) * dim,
                       y + std::size_t(i) * dim,
                       distances);
    });
  }



  template class BlockStencil<2, double>;
  template class BlockStencil<3, double>;
  template class BlockStencil<2, float>;
  template class BlockStencil<3, float>;
  template void
  BlockStencil<2, float>::copy(const BlockStencil<2, double> &);
  template void
  BlockStencil<3, float>::copy(const BlockStencil<3, double> &);
} // namespace greville
