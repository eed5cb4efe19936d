// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/mass/stencil_matrix.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  StencilMatrix<dim>::reinit(const SplineSpace<dim> &space)
  {
    spline_space         = &space;
    const int          p = space.degree();
    const unsigned int n =
      space.owned_functions().size() + space.ghost_functions().size();
    const unsigned int n_entries = Utilities::fixed_power<dim>(2 * p + 1);
    half                         = (n_entries + 1) / 2;

    // A function or an image, numbered without periodicity.
    struct Entry
    {
      unsigned int         function;
      std::array<int, dim> index;
    };
    std::vector<Entry> entries;
    entries.reserve(n);
    for (unsigned int f = 0; f < n; ++f)
      {
        const auto i =
          multi_index<dim>(space.function_position(f), space.n_functions());
        Entry entry{f, {}};
        for (unsigned int d = 0; d < dim; ++d)
          entry.index[d] = i[d];
        entries.push_back(entry);
      }
    for (unsigned int d = 0; d < dim; ++d)
      if (space.is_periodic(d))
        {
          const std::size_t n_entries = entries.size();
          for (std::size_t k = 0; k < n_entries; ++k)
            if (entries[k].index[d] < p)
              {
                entries.push_back(entries[k]);
                entries.back().index[d] += space.n_functions()[d];
              }
        }

    // The box of lines around the functions, extended by p.
    std::array<int, dim> low, high;
    low.fill(std::numeric_limits<int>::max());
    high.fill(std::numeric_limits<int>::min());
    for (const Entry &entry : entries)
      for (unsigned int d = 0; d < dim; ++d)
        {
          low[d]  = std::min(low[d], entry.index[d] - p);
          high[d] = std::max(high[d], entry.index[d] + p);
        }
    const int n_y = n == 0 ? 0 : high[1] - low[1] + 1;
    const int n_z = dim == 2 || n == 0 ? 1 : high[dim - 1] - low[dim - 1] + 1;
    n_lines_y     = n_y;

    neighbor_lines.clear();
    for (int dz = (dim == 3 ? -p : 0); dz <= (dim == 3 ? p : 0); ++dz)
      for (int dy = -p; dy <= p; ++dy)
        neighbor_lines.push_back(dz * n_y + dy);

    // The range of x in each line, and the range that the rows of neighbouring
    // lines reach.
    std::vector<std::array<int, 2>> own(n_y * n_z,
                                        {{std::numeric_limits<int>::max(),
                                          std::numeric_limits<int>::min()}});
    const auto                      line_number = [&](const Entry &entry) {
      return unsigned(
        entry.index[1] - low[1] +
        (dim == 3 ? (entry.index[dim - 1] - low[dim - 1]) * n_y : 0));
    };
    for (const Entry &entry : entries)
      {
        auto &range = own[line_number(entry)];
        range[0]    = std::min(range[0], entry.index[0]);
        range[1]    = std::max(range[1], entry.index[0]);
      }
    auto reached = own;
    for (unsigned int line = 0; line < own.size(); ++line)
      if (own[line][0] <= own[line][1])
        for (const int offset : neighbor_lines)
          {
            auto &range = reached[line + offset];
            range[0]    = std::min(range[0], own[line][0] - p);
            range[1]    = std::max(range[1], own[line][1] + p);
          }
    line_begin.assign(own.size(), 0);
    n_places = 0;
    for (unsigned int line = 0; line < own.size(); ++line)
      if (reached[line][0] <= reached[line][1])
        {
          line_begin[line] = int(n_places) - reached[line][0];
          n_places += reached[line][1] - reached[line][0] + 1;
          AssertThrow(n_places < std::size_t(std::numeric_limits<int>::max()),
                      ExcMessage("A process has more coefficients than an "
                                 "integer can count."));
        }

    place_of.resize(n);
    lines.resize(n);
    image_places.clear();
    image_lines.clear();
    for (std::size_t k = 0; k < entries.size(); ++k)
      {
        const unsigned int line  = line_number(entries[k]);
        const unsigned int place = line_begin[line] + entries[k].index[0];
        if (k < n)
          {
            place_of[k] = place;
            lines[k]    = line;
          }
        else
          {
            image_places.emplace_back(entries[k].function, place);
            image_lines.push_back(line);
          }
      }
    segments.clear();
    values  = ZeroedArray<double>(n_places * half);
    line_of = ZeroedArray<unsigned int>(n_places);
  }



  template <int dim>
  void
  StencilMatrix<dim>::set_rows(const std::vector<unsigned int> &functions)
  {
    clear();
    std::vector<std::pair<unsigned int, unsigned int>> rows;
    rows.reserve(functions.size());
    for (const unsigned int f : functions)
      rows.emplace_back(place_of[f], lines[f]);
    if (!image_places.empty())
      {
        std::vector<bool> has_row(place_of.size(), false);
        for (const unsigned int f : functions)
          has_row[f] = true;
        for (unsigned int k = 0; k < image_places.size(); ++k)
          if (has_row[image_places[k].first])
            rows.emplace_back(image_places[k].second, image_lines[k]);
      }
    if (!std::is_sorted(rows.begin(), rows.end()))
      std::sort(rows.begin(), rows.end());
    segments.clear();
    for (const auto &row : rows)
      {
        if (segments.empty() || segments.back().end != row.first)
          segments.push_back({row.first, row.first, row.second});
        ++segments.back().end;
        line_of[row.first] = row.second;
      }
  }



  template <int dim>
  void
  StencilMatrix<dim>::clear()
  {
    for (const Segment &segment : segments)
      std::fill(values.data() + std::size_t(segment.begin) * half,
                values.data() + std::size_t(segment.end) * half,
                0.);
  }



  template <int dim>
  void
  StencilMatrix<dim>::add_cell(const unsigned int cell,
                               const double      *sums,
                               const unsigned int stride)
  {
    with_order(spline_space->degree(), [&](const auto n) {
      add_cell_of_order<decltype(n)::value>(cell, sums, stride);
    });
  }



  namespace
  {
    /**
     * Return the number of the pair (a, b), in any order, among the pairs of n
     * functions.
     */
    template <int n>
    constexpr int
    pair_number(const int a, const int b)
    {
      return a <= b ? a * n - a * (a - 1) / 2 + (b - a) : pair_number<n>(b, a);
    }
  } // namespace



  template <int dim>
  template <int n>
  void
  StencilMatrix<dim>::add_cell_of_order(const unsigned int cell,
                                        const double      *sums,
                                        const unsigned int stride)
  {
    constexpr int p       = n - 1;
    constexpr int length  = 2 * p + 1;
    constexpr int n_pairs = n * (n + 1) / 2;
    constexpr int n_z     = dim == 3 ? n : 1;

    for (int a_z = 0; a_z < n_z; ++a_z)
      for (int a_y = 0; a_y < n; ++a_y)
        {
          // Functions of a line have consecutive places.
          const std::size_t row = cell_place(cell, 0, a_z * n + a_y);
          for (int b_z = a_z; b_z < n_z; ++b_z)
            for (int b_y = b_z == a_z ? a_y : 0; b_y < n; ++b_y)
              {
                const double *from =
                  sums +
                  stride *
                    (pair_number<n>(a_y, b_y) +
                     (dim == 3 ? pair_number<n>(a_z, b_z) * n_pairs : 0));
                const bool same = b_z == a_z && b_y == a_y;
                const int entry = ((b_z - a_z) * length + (b_y - a_y)) * length;
#pragma GCC unroll 6
                for (int a_x = 0; a_x < n; ++a_x)
                  {
                    double *to =
                      values.data() + (row + a_x) * half + entry - a_x;
                    if (same)
                      {
#pragma GCC unroll 6
                        for (int b_x = a_x; b_x < n; ++b_x)
                          to[b_x] += from[pair_number<n>(a_x, b_x)];
                      }
                    else
                      {
#pragma GCC unroll 6
                        for (int b_x = 0; b_x < n; ++b_x)
                          to[b_x] += from[pair_number<n>(a_x, b_x)];
                      }
                  }
              }
        }
  }



  template <int dim>
  void
  StencilMatrix<dim>::add_cell(const unsigned int        cell,
                               const FullMatrix<double> &matrix)
  {
    const int          n        = spline_space->degree() + 1;
    const int          length   = 2 * n - 1;
    const unsigned int n_in_all = matrix.m();
    AssertThrow(n_in_all == spline_space->n_dofs_per_cell(),
                ExcDimensionMismatch(n_in_all,
                                     spline_space->n_dofs_per_cell()));
    for (unsigned int a = 0; a < n_in_all; ++a)
      {
        double *row =
          values.data() + std::size_t(cell_place(cell, a % n, a / n)) * half;
        for (unsigned int b = a; b < n_in_all; ++b)
          {
            const int line_a = a / n, line_b = b / n;
            const int lines =
              (line_b / n - line_a / n) * length + (line_b % n - line_a % n);
            row[lines * length + int(b % n) - int(a % n)] += matrix(a, b);
          }
      }
  }



  template <int dim>
  void
  StencilMatrix<dim>::decouple(const unsigned int i)
  {
    for_each_place(i, [&](const unsigned int j, const std::size_t e) {
      if (j == i || values[e] == 0.)
        return;
      values[std::size_t(i) * half] += values[e];
      values[std::size_t(j) * half] += values[e];
      values[e] = 0.;
    });
  }



  template <int dim>
  void
  StencilMatrix<dim>::lump()
  {
    for_each_row([&](const unsigned int i) { decouple(i); });
  }



  template <int dim>
  void
  StencilMatrix<dim>::raise_diagonal(const unsigned int place,
                                     const double       smallest)
  {
    double &entry = values[std::size_t(place) * half];
    entry         = std::max(entry, smallest);
  }



  template <int dim>
  void
  StencilMatrix<dim>::get_row(const unsigned int i, double *stencil) const
  {
    for_each_place(i, [&](const unsigned int, const std::size_t entry) {
      *stencil++ = values[entry];
    });
  }



  template <int dim>
  void
  StencilMatrix<dim>::set_row(const unsigned int i, const double *stencil)
  {
    std::copy_n(stencil + half - 1,
                half,
                values.data() + std::size_t(i) * half);
  }



  template <int dim>
  void
  StencilMatrix<dim>::vmult(double            *y,
                            const double      *x,
                            const unsigned int width) const
  {
    with_order(spline_space->degree(), [&](const auto n) {
      with_width(width, [&](const auto w) {
        multiply<decltype(n)::value, decltype(w)::value>(y, x);
      });
    });
  }



  namespace
  {
    /**
     * The products of a row and of its column, line by line, with the entry x_i
     * of the row and the sum of its products.
     */
    template <int width>
    class LineOfEntries
    {
    public:
      LineOfEntries(const double *x_i)
        : own(load<Vector>(x_i))
        , sum(0.)
      {}

      /// Compute sum += m x and y += m^T x_i for @p size consecutive entries.
      template <int size>
      inline __attribute__((always_inline)) void
      multiply(const double *entries, const double *x, double *y)
      {
#pragma GCC unroll 11
        for (int k = 0; k < size; ++k)
          {
            const Vector entry = entries[k];
            sum += entry * load<Vector>(x + k * width);
            store(load<Vector>(y + k * width) + entry * own, y + k * width);
          }
      }

      void
      add_to(double *y_i, const double diagonal) const
      {
        store(load<Vector>(y_i) + sum + diagonal * own, y_i);
      }

    private:
      using Vector = FixedSimd<double, width>;

      const Vector own;
      Vector       sum;
    };



    /**
     * Vectors with three numbers per place are processed in vectors of four
     * numbers without gaps, so that each line is loaded and stored once. Lanes
     * beyond the line get zero.
     */
    template <>
    class LineOfEntries<3>
    {
    public:
      LineOfEntries(const double *x_i)
      {
        for (int r = 0; r < 3; ++r)
          {
            sums[r] = Vector{};
            own[r] = Vector{x_i[r], x_i[(r + 1) % 3], x_i[(r + 2) % 3], x_i[r]};
          }
      }

      template <int size>
      inline __attribute__((always_inline)) void
      multiply(const double *entries, const double *x, double *y)
      {
        multiply<size, 0>(entries, x, y);
      }

      void
      add_to(double *y_i, const double diagonal) const
      {
        double sum[3] = {};
        for (int r = 0; r < 3; ++r)
          for (int lane = 0; lane < 4; ++lane)
            sum[(r + lane) % 3] += sums[r][lane];
        for (int c = 0; c < 3; ++c)
          y_i[c] += sum[c] + diagonal * own[0][c];
      }

    private:
      typedef double Vector __attribute__((vector_size(32)));

      template <int size, int first>
      inline __attribute__((always_inline)) void
      multiply(const double *entries, const double *x, double *y)
      {
        if constexpr (first < 3 * size)
          {
            constexpr int r = first % 3, k = first / 3;
            const double  next = k + 1 < size ? entries[k + 1] : 0.;
            const Vector  here = {entries[k], entries[k], entries[k], 0.},
                         ahead = {0., next, next, next},
                         m     = __builtin_shufflevector(
                           here, ahead, 0, r < 2 ? 1 : 5, r < 1 ? 2 : 6, 7);
            Vector from, to;
            std::memcpy(&from, x + first, sizeof(Vector));
            std::memcpy(&to, y + first, sizeof(Vector));
            sums[r] += m * from;
            to += m * own[r];
            std::memcpy(y + first, &to, sizeof(Vector));
            multiply<size, first + 4>(entries, x, y);
          }
      }

      // Vectors that begin with component r.
      Vector own[3], sums[3];
    };
  } // namespace



  template <int dim>
  template <int n, int width>
  void
  StencilMatrix<dim>::multiply(double *y, const double *x) const
  {
    using Line           = LineOfEntries<width>;
    constexpr int p      = n - 1;
    constexpr int length = 2 * p + 1;

    for (const Segment &segment : segments)
      std::fill(y + std::size_t(segment.begin) * width,
                y + std::size_t(segment.end) * width,
                0.);
    const unsigned int n_lines = neighbor_lines.size();
    int                distances[length * length];
    for (const Segment &segment : segments)
      {
        unsigned int n_ahead = 0;
        for (unsigned int k = n_lines / 2 + 1; k < n_lines; ++k)
          distances[n_ahead++] = (distance(segment.line, k) - p) * width;
        for (unsigned int i = segment.begin; i < segment.end; ++i)
          {
            const double *row = values.data() + std::size_t(i) * half;
            const double *x_i = x + std::size_t(i) * width;
            double       *y_i = y + std::size_t(i) * width;
            Line          line(x_i);
            line.template multiply<p>(row + 1, x_i + width, y_i + width);
            const double *entries = row + n;
            for (unsigned int k = 0; k < n_ahead; ++k, entries += length)
              line.template multiply<length>(entries,
                                             x_i + distances[k],
                                             y_i + distances[k]);
            line.add_to(y_i, row[0]);
          }
      }
  }



  template class StencilMatrix<2>;
  template class StencilMatrix<3>;
} // namespace greville
