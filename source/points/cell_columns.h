// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "point_kernels.h"

/**
 * Loops over the cells of a body along lines in x. A cell has n columns of
 * functions; a column has one index along x. From one cell to the next, n - 1
 * columns remain. To be included in sources.
 */
namespace greville
{
  namespace internal
  {
    /// The geometry of the current cell of a loop.
    template <int dim, int n>
    class MovingCell : public CellGeometry<dim, n>
    {
    public:
      MovingCell(const SpacePolynomials<dim> &tables)
        : tables(tables)
        , lower(tables.space->lower_corner()[0])
        , h(tables.space->cell_size(0))
        , edges(tables.space->lattice().edges(0).data())
      {}

      /// Move to a cell. Returns whether it is the next cell along x. It then
      /// shares the functions of the previous cell without their first column,
      /// and adds a new last column.
      inline __attribute__((always_inline)) bool
      go_to(const unsigned int cell)
      {
        const std::uint64_t at      = tables.space->owned_cells()[cell];
        const bool          is_next = at == position + 1 && index + 1 < n_cells;
        position                    = at;
        if (!is_next)
          {
            begin_line(cell);
            return false;
          }
        ++index;
        if (edges)
          {
            this->center[0]    = 0.5 * (edges[index] + edges[index + 1]);
            this->inverse_h[0] = 1. / (edges[index + 1] - edges[index]);
          }
        else
          this->center[0] = lower + h * (index + 0.5);
        this->polynomials[0] += n * n;
        this->offsets[0] += n;
        this->functions = tables.space->cell_functions(cell).data();
        return true;
      }

    private:
      __attribute__((noinline)) void
      begin_line(const unsigned int cell)
      {
        static_cast<CellGeometry<dim, n> &>(*this) =
          CellGeometry<dim, n>(tables, cell);
        n_cells = tables.space->cells_per_direction()[0];
        index   = position % n_cells;
      }

      const SpacePolynomials<dim> &tables;
      const double                 lower, h;
      const double                *edges; // null if cells are equal
      std::uint64_t                position = -1;
      unsigned int                 index = 0, n_cells = 0; // along x
    };



    /// Prefetches groups some iterations ahead of a loop over all groups, cell
    /// by cell. Kernels read only some numbers of a group, in a pattern that
    /// processors do not predict.
    template <int dim>
    class PrefetchedGroups
    {
    public:
      PrefetchedGroups(const MaterialPoints<dim> &points,
                       const unsigned int         last)
        : points(points)
        , n_bytes(last * simd_width * sizeof(double))
        , cell(points.cells().begin())
        , end(points.cells().end())
      {
        begin_cell();
        for (unsigned int k = 0; k < n_ahead; ++k)
          advance();
      }

      /// Prefetch the numbers [0, last) of the next group.
      inline __attribute__((always_inline)) void
      advance()
      {
        if (g == MaterialPoints<dim>::none)
          return;
        const char *group = reinterpret_cast<const char *>(points.group(g));
#pragma GCC unroll 1
        for (std::size_t k = 0; k < n_bytes; k += 64)
          __builtin_prefetch(group + k);
        g = points.next_group(g);
        if (g == MaterialPoints<dim>::none)
          {
            ++cell;
            begin_cell();
          }
      }

    private:
      static constexpr unsigned int n_ahead = 8;

      void
      begin_cell()
      {
        g = cell == end ? MaterialPoints<dim>::none : points.first_group(*cell);
      }

      const MaterialPoints<dim>                &points;
      const std::size_t                         n_bytes;
      std::vector<unsigned int>::const_iterator cell, end;
      unsigned int                              g;
    };



    /// @p size numbers for each column of functions of a cell.
    template <int n, int size, typename Number>
    class CellColumns
    {
    public:
      CellColumns()
      {
        for (int a = 0; a < n; ++a)
          columns[a] = numbers[a];
      }

      CellColumns(const CellColumns &) = delete;

      inline __attribute__((always_inline)) Number *
      operator[](const int a) const
      {
        return columns[a];
      }

      /// Move to the next cell along x: the first column becomes the last one.
      inline __attribute__((always_inline)) void
      rotate()
      {
        Number *first = columns[0];
        for (int a = 1; a < n; ++a)
          columns[a - 1] = columns[a];
        columns[n - 1] = first;
      }

    private:
      Number *columns[n];
      Number  numbers[n][size];
    };



    /// The sums over points for functions, with n_fields numbers per function,
    /// split over the lanes. When the loop leaves a column, the column is added
    /// to a buffer.
    template <int dim, int n, int n_fields>
    class ColumnSums
    {
    public:
      explicit ColumnSums(double *buffer)
        : buffer(buffer)
      {}

      /// Begin a cell with the given functions, see MovingCell::go_to().
      inline __attribute__((always_inline)) void
      begin(const unsigned int *cell_functions, const bool is_next)
      {
        if (is_next)
          {
            write(0);
            columns.rotate();
            clear(n - 1);
          }
        else
          {
            end();
            for (int a = 0; a < n; ++a)
              clear(a);
          }
        functions = cell_functions;
      }

      /// Return the sums of function @p a of a row along x.
      Simd *
      operator()(const int a, const int row) const
      {
        return columns[a] + row * n_fields;
      }

      /// End the last cell.
      void
      end()
      {
        if (functions)
          for (int a = 0; a < n; ++a)
            write(a);
      }

    private:
      static constexpr int n_rows = power(n, dim - 1);
      static constexpr int size   = (n_rows * n_fields + 3) / 4 * 4;

      inline __attribute__((always_inline)) void
      clear(const int a)
      {
        for (int k = 0; k < size; ++k)
          columns[a][k] = 0.;
      }

      inline __attribute__((always_inline)) void
      write(const int a) const
      {
        double totals[size];
        for (int k = 0; k < size; k += simd_width)
          store(reduce_four(columns[a] + k), totals + k);
        for (int row = 0; row < n_rows; ++row)
          for (int k = 0; k < n_fields; ++k)
            buffer[std::size_t(functions[row * n + a]) * n_fields + k] +=
              totals[row * n_fields + k];
      }

      double                    *buffer;
      const unsigned int        *functions = nullptr;
      CellColumns<n, size, Simd> columns;
    };
  } // namespace internal
} // namespace greville
