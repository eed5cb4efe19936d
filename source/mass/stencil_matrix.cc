// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/mass/stencil_matrix.h>

#include <algorithm>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Kernels may access this many numbers after the entries of a cell.
    constexpr unsigned int max_padding = 64;
  } // namespace



  template <int dim>
  void
  StencilMatrix<dim>::reinit(const SplineSpace<dim> &space)
  {
    StencilPlaces<dim>::reinit(space);
    decoupled_places.clear();
    decoupled_entries.clear();
    is_decoupled  = ZeroedArray<unsigned char>(n_places);
    values        = {};
    single_values = {};
    set_rows({});
  }



  template <int dim>
  void
  StencilMatrix<dim>::set_rows(const std::vector<unsigned int> &functions)
  {
    StencilPlaces<dim>::set_rows(functions);
    line_rows.assign(line_begin.size(), LineRows());
    for (const Segment &segment : segments)
      {
        LineRows &line = line_rows[segment.line];
        if (line.size == 0)
          line.begin = segment.begin;
        line.size = segment.end - line.begin;
      }
    const unsigned int n_entries =
      Utilities::fixed_power<dim>(spline_space->degree() + 1);
    std::size_t n = 1;
    for (LineRows &line : line_rows)
      {
        line.entry = n;
        n += std::size_t(line.size) * n_entries;
      }
    values.resize(n + max_padding);
    clear();
  }



  template <int dim>
  void
  StencilMatrix<dim>::clear()
  {
    std::fill(values.begin(), values.end(), 0.);
    for (const unsigned int place : decoupled_places)
      is_decoupled[place] = 0;
    decoupled_places.clear();
    decoupled_entries.clear();
  }



  template <int dim>
  void
  StencilMatrix<dim>::add_cell(const unsigned int cell, const double *sums)
  {
    with_order(spline_space->degree(), [&](const auto order) {
      constexpr int n   = decltype(order)::value;
      constexpr int n_z = dim == 3 ? n : 1;
      CellLine      lines[n_z * n];
      find_lines<n>(cell, lines);
      for (int a_z = 0; a_z < n_z; ++a_z)
        for (int b_z = a_z; b_z < n_z; ++b_z)
          for (int a_y = 0; a_y < n; ++a_y)
            for (int b_y = a_y; b_y < n; ++b_y)
              {
                const CellLine &line = lines[a_z * n + a_y];
                double         *to =
                  line.begin + ((b_z - a_z) * n + b_y - a_y) * line.stride;
                for (int a_x = 0; a_x < n; ++a_x)
                  for (int dx = 0; dx < n - a_x; ++dx)
                    to[a_x * n + dx] += *sums++;
              }
    });
  }



  template <int dim>
  unsigned int
  StencilMatrix<dim>::n_equal(unsigned int distance) const
  {
    unsigned int result = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        result *= distance % (spline_space->degree() + 1) != 0 ? 2 : 1;
        distance /= spline_space->degree() + 1;
      }
    return std::max(1u, result / 2);
  }



  template <int dim>
  void
  StencilMatrix<dim>::add_cell(const unsigned int        cell,
                               const FullMatrix<double> &matrix)
  {
    const unsigned int n        = spline_space->degree() + 1;
    const unsigned int n_in_all = matrix.m();
    AssertThrow(n_in_all == spline_space->n_dofs_per_cell(),
                ExcDimensionMismatch(n_in_all,
                                     spline_space->n_dofs_per_cell()));
    MultiIndex<dim> extents;
    extents.fill(n);
    std::vector<CellLine> lines(n_in_all / n);
    with_order(n - 1, [&](const auto order) {
      find_lines<decltype(order)::value>(cell, lines.data());
    });
    for (unsigned int a = 0; a < n_in_all; ++a)
      for (unsigned int b = a; b < n_in_all; ++b)
        {
          const auto   i     = multi_index<dim>(a, extents);
          const auto   j     = multi_index<dim>(b, extents);
          unsigned int lower = 0, distance = 0;
          for (int d = dim - 1; d >= 0; --d)
            {
              lower = lower * n + std::min(i[d], j[d]);
              distance =
                distance * n + std::max(i[d], j[d]) - std::min(i[d], j[d]);
            }
          const CellLine &line = lines[lower / n];
          line
            .begin[distance / n * line.stride + lower % n * n + distance % n] +=
            matrix(a, b) / n_equal(distance);
        }
  }



  template <int dim>
  void
  StencilMatrix<dim>::decouple(const unsigned int i)
  {
    for_each_entry(i, [&](const unsigned int j, const double value) {
      if (j == i)
        return;
      values[first_entry(i)] += value;
      values[first_entry(j)] += value;
      decoupled_entries.push_back({i, j, value});
    });
    is_decoupled[i] = 1;
    decoupled_places.push_back(i);
  }



  template <int dim>
  void
  StencilMatrix<dim>::lump()
  {
    std::vector<std::pair<unsigned int, double>> sums;
    this->for_each_row([&](const unsigned int i) {
      double sum = 0.;
      for_each_entry(i, [&](const unsigned int, const double value) {
        sum += value;
      });
      sums.emplace_back(i, sum);
    });
    clear();
    for (const auto &[i, sum] : sums)
      values[first_entry(i)] = sum;
  }



  template <int dim>
  void
  StencilMatrix<dim>::raise_diagonal(const unsigned int place,
                                     const double       smallest)
  {
    double &entry = values[first_entry(place)];
    entry         = std::max(entry, smallest);
  }



  template <int dim>
  void
  StencilMatrix<dim>::get_row(const unsigned int i, double *stencil) const
  {
    visit_places<false>(i,
                        spline_space->degree(),
                        [&](const unsigned int j, const std::size_t e) {
                          *stencil++ = is_coupled(i, j) ? values[e] : 0.;
                        });
  }



  template <int dim>
  void
  StencilMatrix<dim>::add_row(const unsigned int i, const double *stencil)
  {
    const int p  = spline_space->degree();
    int       dx = -p, dy = -p, dz = dim == 3 ? -p : 0;
    visit_places<false>(i,
                        spline_space->degree(),
                        [&](const unsigned int j, const std::size_t e) {
                          if (j >= i && e != 0)
                            values[e] +=
                              *stencil /
                              n_equal((std::abs(dz) * (p + 1) + std::abs(dy)) *
                                        (p + 1) +
                                      std::abs(dx));
                          ++stencil;
                          if (++dx > p)
                            {
                              dx = -p;
                              if (++dy > p)
                                {
                                  dy = -p;
                                  ++dz;
                                }
                            }
                        });
  }



  template <int dim>
  void
  StencilMatrix<dim>::vmult(double            *y,
                            const double      *x,
                            const unsigned int width) const
  {
    with_order(spline_space->degree(), [&](const auto n) {
      with_width(width, [&](const auto w) {
        multiply<decltype(n)::value, decltype(w)::value>(y,
                                                         x,
                                                         values.data(),
                                                         1.);
      });
    });
  }



  template <int dim>
  void
  StencilMatrix<dim>::make_single(const double unit)
  {
    single_values.resize(values.size());
    single_unit = unit;
    for (std::size_t e = 0; e < values.size(); ++e)
      single_values[e] = values[e] / unit;
  }



  template <int dim>
  void
  StencilMatrix<dim>::vmult(float             *y,
                            const float       *x,
                            const unsigned int width) const
  {
    with_order(spline_space->degree(), [&](const auto n) {
      with_one_of<2, 4, 8>(width, [&](const auto w) {
        multiply<decltype(n)::value, decltype(w)::value>(y,
                                                         x,
                                                         single_values.data(),
                                                         single_unit);
      });
    });
  }



  namespace
  {
    /// The numbers at a place. Three numbers are loaded and stored as four; the
    /// last one is zero.
    template <int width, typename Number>
    struct Place
    {
      static constexpr int size = width == 3 ? 4 : width;
      using Vector              = FixedSimd<Number, size>;

      static Vector
      load(const Number *address)
      {
        Vector value = greville::load<Vector>(address);
        if constexpr (width < size)
          value[width] = Number(0.);
        return value;
      }

      static void
      add(const Vector &value, Number *address)
      {
        store(greville::load<Vector>(address) + value, address);
      }
    };



    /// For the entries U[x * n + dx] between lines and lines at a distance,
    /// compute y_l += U x_m and y_l += U^T x_m for the pairs l + m = n_lines -
    /// 1 of lines. A window of n places moves along the lines.
    template <int n, int width, int n_lines, typename Number>
    inline void
    multiply_lines(Number *const       *y,
                   const Number *const *x,
                   const Number        *U,
                   const unsigned int   size)
    {
      using At     = Place<width, Number>;
      using Values = typename At::Vector;
      Values from[n_lines][n], sums[n_lines][n];
#pragma GCC unroll 4
      for (int l = 0; l < n_lines; ++l)
#pragma GCC unroll 6
        for (int k = 0; k < n; ++k)
          {
            sums[l][k] = Number(0.);
            if (k + 1 < n)
              from[l][k + 1] = At::load(x[l] + k * width);
          }
      for (unsigned int i = 0; i < size; ++i, U += n)
        {
#pragma GCC unroll 4
          for (int l = 0; l < n_lines; ++l)
            {
#pragma GCC unroll 6
              for (int k = 0; k + 1 < n; ++k)
                from[l][k] = from[l][k + 1];
              from[l][n - 1] = At::load(x[l] + std::size_t(i + n - 1) * width);
            }
#pragma GCC unroll 6
          for (int dx = 0; dx < n; ++dx)
            {
              const Values entry = U[dx];
#pragma GCC unroll 4
              for (int l = 0; l < n_lines; ++l)
                {
                  const auto &values = from[n_lines - 1 - l];
                  sums[l][0] += entry * values[dx];
                  if (dx > 0)
                    sums[l][dx] += entry * values[0];
                }
            }
#pragma GCC unroll 4
          for (int l = 0; l < n_lines; ++l)
            {
              At::add(sums[l][0], y[l] + std::size_t(i) * width);
#pragma GCC unroll 6
              for (int k = 0; k + 1 < n; ++k)
                sums[l][k] = sums[l][k + 1];
              sums[l][n - 1] = Number(0.);
            }
        }
#pragma GCC unroll 4
      for (int l = 0; l < n_lines; ++l)
#pragma GCC unroll 6
        for (int k = 0; k + 1 < n; ++k)
          At::add(sums[l][k], y[l] + std::size_t(size + k) * width);
    }
  } // namespace



  template <int dim>
  template <int n, int width, typename Number>
  void
  StencilMatrix<dim>::multiply(Number       *y,
                               const Number *x,
                               const Number *entries,
                               const double  unit) const
  {
    for (const Segment &segment : segments)
      std::fill(y + std::size_t(segment.begin) * width,
                y + std::size_t(segment.end) * width,
                Number(0.));
    // The number of places at a time. Their numbers stay in the cache.
    constexpr unsigned int n_at_once = 64;
    for (const Segment &segment : segments)
      for (unsigned int i = segment.begin; i < segment.end; i += n_at_once)
        {
          const unsigned int size = std::min(n_at_once, segment.end - i);
          const Number      *row  = entries + first_entry(i);
          const std::size_t  stride =
            std::size_t(line_rows[segment.line].size) * n;
          for (int dz = 0; dz < (dim == 3 ? n : 1); ++dz)
            for (int dy = 0; dy < n; ++dy, row += stride)
              {
                Number       *to[4];
                const Number *from[4];
                const int     n_y     = dy > 0 ? 2 : 1;
                const int     n_lines = dz > 0 ? 2 * n_y : n_y;
                for (int l = 0; l < n_lines; ++l)
                  {
                    const std::ptrdiff_t place =
                      std::ptrdiff_t(i) - line_begin[segment.line] +
                      line_begin[segment.line + l % n_y * dy +
                                 l / n_y * dz * n_lines_y];
                    to[l]   = y + place * width;
                    from[l] = x + place * width;
                  }
                if (n_lines == 4)
                  multiply_lines<n, width, 4>(to, from, row, size);
                else if (n_lines == 2)
                  multiply_lines<n, width, 2>(to, from, row, size);
                else
                  multiply_lines<n, width, 1>(to, from, row, size);
              }
        }
    for (const auto &[i, j, value] : decoupled_entries)
      for (unsigned int c = 0; c < width; ++c)
        {
          const std::size_t i_c = std::size_t(i) * width + c,
                            j_c = std::size_t(j) * width + c;
          y[i_c] -= Number(value / unit) * x[j_c];
          y[j_c] -= Number(value / unit) * x[i_c];
        }
  }



  GREVILLE_INSTANTIATE_CLASS(StencilMatrix);
} // namespace greville
