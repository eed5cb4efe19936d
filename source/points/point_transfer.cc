// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/stencil_matrix.h>

#include "cell_columns.h"
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
    const MultiIndex<dim> index = space.box(cell).index;
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
    numbers.resize_fast(
      (windows ? windows->n_places() : n_local_functions(space)) * stride);
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
              sum += filling_volume(points->layout(), points->group(g));
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
    const unsigned int n   = tables.space->degree() + 1;
    const CellBox<dim> box = tables.space->box(cell);
    Tensor<1, dim>     result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const auto   &table   = tables.directions[d];
        const double *c       = table.coefficients(box.index[d]);
        const double *offsets = table.greville_offsets(box.index[d]);
        const double  t       = (x[d] - box.center[d]) / box.size[d];
        for (unsigned int a = 0; a < n; ++a)
          {
            double N = 0.;
            for (int k = n - 1; k >= 0; --k)
              N = N * t + c[a * n + k];
            result[d] += N * std::pow(box.center[d] + offsets[a] - x[d], 2);
          }
      }
    return result;
  }



  namespace
  {
    /// Prefetch the numbers that a group changes, mostly in two cache lines.
    inline void
    prefetch_sums(const double *sums)
    {
      __builtin_prefetch(sums, 1);
      __builtin_prefetch(sums + 8, 1);
    }



    /// Add the products of two tables to sums: sums[k] += sum_p factors[k][p]
    /// x[p], for vectors x[p] at a distance @p stride.
    template <int n, int stride>
    inline void
    add_products(double *const (&sums)[n],
                 const double (&factors)[n][simd_width],
                 const double *x)
    {
      // Keep as many sums at a time as registers allow.
      constexpr int n_sums = n % 7 == 0   ? 7
                             : n % 6 == 0 ? 6
                             : n % 5 == 0 ? 5
                                          : n;
#pragma GCC unroll 4
      for (int first = 0; first < n; first += n_sums)
        {
          Simd part[n_sums];
#pragma GCC unroll 7
          for (int k = 0; k < n_sums; ++k)
            part[k] = load(sums[first + k]);
#pragma GCC unroll 8
          for (unsigned int p = 0; p < simd_width; ++p)
            {
              const Simd x_p = load(x + p * stride);
#pragma GCC unroll 7
              for (int k = 0; k < n_sums; ++k)
                part[k] += factors[first + k][p] * x_p;
            }
#pragma GCC unroll 7
          for (int k = 0; k < n_sums; ++k)
            store(part[k], sums[first + k]);
        }
    }



    /// Add the mass matrices of the cells, sum_p m_p N_a N_b for all pairs of
    /// functions. Shape functions are evaluated with one point per lane. The
    /// sums have one entry of a matrix row per lane, like the stored matrix, so
    /// that no sum over lanes is needed.
    template <int dim, int n>
    void
    add_cells(const MaterialPoints<dim>   &points,
              const SpacePolynomials<dim> &tables,
              StencilMatrix<dim>          &matrix)
    {
      using Layout          = PointLayout<dim>;
      constexpr int n_pairs = n * (n + 1) / 2;
      constexpr int n_z     = dim == 3 ? n : 1;
      constexpr int width   = simd_width;
      constexpr int stride  = ((n - 1) * n + width) / width * width;

      double factors[n_pairs][width];                     // m N_y N_y N_z N_z
      double pairs_x[width][stride]               = {{}}; // N_x N_x of a point
      const std::vector<unsigned int>      &cells = points.cells();
      typename StencilMatrix<dim>::CellLine lines[2][n_z * n];
      for (auto &all : lines)
        if (!cells.empty())
          matrix.template find_lines<n>(cells[0], all);
      MovingCell<dim, n>    geometry(tables);
      PrefetchedGroups<dim> groups_ahead(points, Layout::volume0);
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int cell = cells[c];
          geometry.go_to(cell);
          const auto &here  = lines[c % 2];
          const auto &ahead = lines[(c + 1) % 2];
          if (c + 1 < cells.size())
            matrix.template find_lines<n>(cells[c + 1], lines[(c + 1) % 2]);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              groups_ahead.advance();
              const double *group = points.group(g);
              Simd          x[dim];
              load_basis_positions(points, group, x);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              const Simd m = load(group + Layout::mass * simd_width);

#pragma GCC unroll 6
              for (int a = 0; a < n; ++a)
#pragma GCC unroll 6
                for (int dx = 0; dx < n - a; ++dx)
                  {
                    const Simd pair = shape.N[0][a] * shape.N[0][a + dx];
                    for (int point = 0; point < width; ++point)
                      pairs_x[point][a * n + dx] = pair[point];
                  }
              for (int a_z = 0; a_z < n_z; ++a_z)
                for (int b_z = a_z; b_z < n_z; ++b_z)
                  {
                    const Simd m_z = dim == 3 ? m * shape.N[dim - 1][a_z] *
                                                  shape.N[dim - 1][b_z]
                                              : m;
                    double    *sums[n_pairs];
                    int        k = 0;
#pragma GCC unroll 6
                    for (int a = 0; a < n; ++a)
#pragma GCC unroll 6
                      for (int b = a; b < n; ++b, ++k)
                        {
                          store(m_z * shape.N[1][a] * shape.N[1][b],
                                factors[k]);
                          const int         line = a_z * n + a;
                          const std::size_t at   = (b_z - a_z) * n + b - a;
                          sums[k] = here[line].begin + at * here[line].stride;
                          prefetch_sums(ahead[line].begin +
                                        at * ahead[line].stride);
                        }
                    for (int block = 0; block < stride; block += width)
                      {
                        add_products<n_pairs, stride>(sums,
                                                      factors,
                                                      pairs_x[0] + block);
                        for (double *&sum : sums)
                          sum += width;
                      }
                  }
            }
        }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::add_mass_matrix(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    StencilMatrix<dim>                             &matrix) const
  {
    for (const MaterialPoints<dim> *points : bodies)
      with_order(tables.space->degree(), [&](const auto n) {
        add_cells<dim, decltype(n)::value>(*points, tables, matrix);
      });
  }



  namespace
  {
    /// Call action(group, N) for all groups of points, where N(a) is the value
    /// of function a of their cell; then call finish(functions) for the cell.
    template <int dim, int n, typename Points, typename Action, typename Finish>
    void
    for_each_group(Points                      &points,
                   const SpacePolynomials<dim> &tables,
                   const Action                &action,
                   const Finish                &finish)
    {
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(tables, cell);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              Simd x[dim];
              load_basis_positions(points, points.group(g), x);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              Simd N[power(n, dim)];
              shape.multiply(N);
              action(points.group(g), N, geometry.functions);
            }
          finish(geometry.functions);
        }
    }



    /// Sum V0, V0 (J - 1) and V0 |J - 1| of the points to functions.
    template <int dim, int n>
    void
    add_volumes(const MaterialPoints<dim>   &points,
                const SpacePolynomials<dim> &tables,
                std::array<VectorType, 3>   &sums)
    {
      constexpr int n_functions = power(n, dim);
      Simd          cell_sums[n_functions][3];
      for (auto &three : cell_sums)
        for (Simd &sum : three)
          sum = 0.;
      for_each_group<dim, n>(
        points,
        tables,
        [&](const double *group, const Simd *N, const unsigned int *) {
          const Simd V = load(group + PointLayout<dim>::volume0 * simd_width);
          const Simd change =
            V * (load(group + PointLayout<dim>::J * simd_width) - 1.);
          const Simd size = abs(change);
          for (int a = 0; a < n_functions; ++a)
            {
              cell_sums[a][0] += V * N[a];
              cell_sums[a][1] += change * N[a];
              cell_sums[a][2] += size * N[a];
            }
        },
        [&](const unsigned int *functions) {
          for (int a = 0; a < n_functions; ++a)
            for (unsigned int k = 0; k < 3; ++k)
              {
                sums[k].local_element(functions[a]) += reduce(cell_sums[a][k]);
                cell_sums[a][k] = 0.;
              }
        });
    }



    /// J += part (sum_a N_a w_a (J_a - 1) - (J - 1) sum_a N_a w_a).
    template <int dim, int n>
    void
    mix(MaterialPoints<dim>         &points,
        const SpacePolynomials<dim> &tables,
        const VectorType            &changes,
        const VectorType            &weights,
        const double                 part)
    {
      for_each_group<dim, n>(
        points,
        tables,
        [&](double *group, const Simd *N, const unsigned int *functions) {
          Simd change = 0., weight = 0.;
          for (int a = 0; a < power(n, dim); ++a)
            {
              change += N[a] * changes.local_element(functions[a]);
              weight += N[a] * weights.local_element(functions[a]);
            }
          double    *address = group + PointLayout<dim>::J * simd_width;
          const Simd V = load(group + PointLayout<dim>::volume0 * simd_width);
          Simd       J = load(address);
          // Empty lanes keep J = 1.
          where(V > 0., J) = J + part * (change - (J - 1.) * weight);
          store(J, address);
        },
        [](const unsigned int *) {});
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::share_volume(MaterialPoints<dim> &points,
                                   const double         part)
  {
    const SplineSpace<dim>   &space = *tables.space;
    std::array<VectorType, 3> sums;
    for (VectorType &sum : sums)
      space.initialize_vector(sum);
    with_order(space.degree(), [&](const auto size) {
      add_volumes<dim, decltype(size)::value>(points, tables, sums);
    });
    for (VectorType &sum : sums)
      sum.compress(VectorOperation::add);
    const VectorType &volumes = sums[0];
    VectorType       &changes = sums[1], &sizes = sums[2];
    for (unsigned int i = 0; i < volumes.locally_owned_size(); ++i)
      if (sizes.local_element(i) > 0.)
        {
          double      &change = changes.local_element(i);
          double      &size   = sizes.local_element(i);
          const double weight = 0.5 * (1. + change / size);
          change *= weight / volumes.local_element(i);
          size = weight;
        }
    changes.update_ghost_values();
    sizes.update_ghost_values();
    with_order(space.degree(), [&](const auto size) {
      mix<dim, decltype(size)::value>(points, tables, changes, sizes, part);
    });
  }



  GREVILLE_INSTANTIATE(describe_place);
  GREVILLE_INSTANTIATE_CLASS(PointTransfer);
} // namespace greville
