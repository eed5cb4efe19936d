// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_tangents.h>

#include "cell_moments.h"
#include "gradients.h"
#include "group_gradients.h"
#include "polar_factor.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Return the number of entry (r, s), r <= s if @p symmetric, of a matrix
    /// of n pairs.
    template <int n, bool symmetric>
    constexpr int
    entry_of(const int r, const int s)
    {
      return symmetric ? r * n - r * (r - 1) / 2 + s - r : r * n + s;
    }
  } // namespace



  template <int dim>
  void
  PointTangents<dim>::reinit(const SplineSpace<dim> &space)
  {
    tables.reinit(space);
    clear(true, false);
  }



  template <int dim>
  void
  PointTangents<dim>::clear(const bool are_symmetric,
                            const bool are_axisymmetric)
  {
    symmetric    = are_symmetric;
    axisymmetric = are_axisymmetric;
    cells.clear();
    n_used       = 0;
    sum_cell     = nullptr;
    keeps_points = true;
  }



  template <int dim>
  void
  PointTangents<dim>::reserve(const std::size_t n_groups)
  {
    if (n_groups * group_size() <= numbers.size())
      return;
    // An array that grows would reserve more than its size.
    numbers.clear();
    numbers.resize_fast(n_groups * group_size());
  }



  template <int dim>
  double *
  PointTangents<dim>::add_cell(const unsigned int cell,
                               const unsigned int n_points)
  {
    const std::size_t first = n_used;
    cells.push_back({cell, n_points, first});
    n_used += (n_points + simd_width - 1) / simd_width * group_size();
    AssertThrow(n_used <= numbers.size(), ExcInternalError());
    return numbers.data() + first;
  }



  namespace
  {
    /// Compute T = C H.
    template <int n, bool symmetric>
    inline __attribute__((always_inline)) void
    apply(const double *C, const Simd *H, Simd *T)
    {
      // Keep these in registers: stores to T cannot change them.
      Simd of_pairs[n], sums[n];
      std::copy_n(H, n, of_pairs);
      for (Simd &sum : sums)
        sum = 0.;
#pragma GCC unroll 9
      for (int r = 0; r < n; ++r)
#pragma GCC unroll 9
        for (int s = symmetric ? r : 0; s < n; ++s)
          {
            const Simd entry =
              load(C + entry_of<n, symmetric>(r, s) * int(simd_width));
            sums[r] += entry * of_pairs[s];
            if (symmetric && s > r)
              sums[s] += entry * of_pairs[r];
          }
      std::copy_n(sums, n, T);
    }
  } // namespace



  template <int dim>
  void
  PointTangents<dim>::multiply(const double *C, const Lanes *H, Lanes *T) const
  {
    const auto apply_to = [&](const auto n) {
      if (symmetric)
        apply<decltype(n)::value, true>(C, H, T);
      else
        apply<decltype(n)::value, false>(C, H, T);
    };
    if (dim == 2 && axisymmetric)
      apply_to(std::integral_constant<int, 5>());
    else
      apply_to(std::integral_constant<int, dim * dim>());
  }



  template <int dim>
  template <int n, bool with_hoop>
  void
  PointTangents<dim>::add_product_of_order(
    double *y, const double *x, const StencilMatrix<dim> &stencil) const
  {
    constexpr int     n_lines  = dim == 3 ? n * n : n;
    constexpr int     n_values = n_lines * n * dim;
    constexpr int     n_padded = (n_values + 3) / 4 * 4;
    const std::size_t size     = group_size();
    for (const CellPoints &points : cells)
      {
        const CellGeometry<dim, n> geometry(tables, points.cell);
        double                     u[n_values];
        std::size_t                lines[n_lines];
        for (int line = 0; line < n_lines; ++line)
          {
            lines[line] =
              std::size_t(stencil.cell_place(points.cell, 0, line)) * dim;
            std::copy_n(x + lines[line], n * dim, u + line * n * dim);
          }
        Simd sums[n_padded];
        for (Simd &sum : sums)
          sum = 0.;
        const double *group = numbers.data() + points.first;
        for (unsigned int q = 0; q < points.n_points; q += simd_width)
          {
            using Shape = GroupGradients<dim, n, dim, with_hoop>;
            Simd position[dim], H[Shape::n_pairs], T[Shape::n_pairs];
            load_numbers<dim>(group, 0, position);
            Shape shape;
            shape.template evaluate<true>(geometry, position);
            shape.gradient(u, H);
            if (symmetric)
              apply<Shape::n_pairs, true>(group + dim * simd_width, H, T);
            else
              apply<Shape::n_pairs, false>(group + dim * simd_width, H, T);
            shape.add_divergence(T, sums);
            group += size;
          }
        double force[n_padded];
        for (int k = 0; k < n_padded; k += 4)
          store(reduce_four(sums + k), force + k);
        for (int line = 0; line < n_lines; ++line)
          for (int k = 0; k < n * dim; ++k)
            y[lines[line] + k] += force[line * n * dim + k];
      }
  }



  template <int dim>
  void
  PointTangents<dim>::add_product(double                   *y,
                                  const double             *x,
                                  const StencilMatrix<dim> &stencil) const
  {
    with_order_and_hoop<dim>(
      tables.space->degree(),
      axisymmetric,
      [&](const auto order, const auto hoop) {
        add_product_of_order<decltype(order)::value, decltype(hoop)::value>(
          y, x, stencil);
      });
  }



  namespace
  {
    /// Store the upper half of the polar factors of the matrices C of a group.
    template <int n>
    void
    symmetrize(const double *C, double *upper_half)
    {
      Simd matrix[n][n];
      for (int r = 0; r < n; ++r)
        for (int s = 0; s < n; ++s)
          matrix[r][s] = load(C + entry_of<n, false>(r, s) * int(simd_width));
      replace_by_polar_factor(matrix);
      for (int r = 0; r < n; ++r)
        for (int s = r; s < n; ++s)
          store(matrix[r][s],
                upper_half + entry_of<n, true>(r, s) * int(simd_width));
    }



    /// The matrix of a cell with symmetric C, block by block of components i <=
    /// k, on vectors of functions.
    template <int dim, int n, typename Number, bool with_hoop>
    class CellStiffness
    {
    public:
      static constexpr int n_functions = power(n, dim);
      static constexpr int width =
        std::min<int>(std::experimental::native_simd<Number>::size(),
                      n_functions < 8    ? 4
                      : n_functions == 8 ? 8
                                         : 16);
      static constexpr int stride = (n_functions + width - 1) / width * width;
      static constexpr int size   = dim * (dim + 1) / 2 * n_functions * stride;

      /// Sum over points, with C_iJkL at [lane] = C[iJ][kL][lane] of groups.
      void
      sum_up(const CellGeometry<dim, n> &geometry,
             const double               *group,
             const unsigned int          n_points,
             const std::size_t           group_size,
             const bool                  symmetric,
             Number                     *matrix)
      {
        std::fill_n(matrix, size, Number(0.));
        for (unsigned int first = 0; first < n_points; first += n_together)
          {
            for (int q = 0; q < n_together; ++q)
              load(geometry, group + q, q);
            const double *C     = group + dim * n_together;
            Number       *block = matrix;
            if (!symmetric)
              {
                symmetrize<n_pairs>(C, polar_factors[0]);
                C = polar_factors[0];
              }
            for (int i = 0; i < dim; ++i)
              for (int k = i; k < dim; ++k)
                {
                  for (int q = 0; q < n_together; ++q)
                    contract(C + q, i, k, q);
                  // Symmetric blocks use only entries with b >= a.
                  add(block, i == k);
                  block += n_functions * stride;
                }
            group += group_size;
          }
      }

      /// Cells with at least this number of points use moments, if supported.
      static constexpr bool         has_moments = n == 2 && !with_hoop;
      static constexpr unsigned int many        = 24;

      /// Compute the same sum by moments of C.
      void
      sum_moments(const CellGeometry<dim, n> &geometry,
                  const double               *group,
                  const unsigned int          n_points,
                  const std::size_t           group_size,
                  const bool                  symmetric,
                  Number                     *matrix)
      {
        using Moments = CellMoments<dim, n>;
        moments.clear();
        for (unsigned int first = 0; first < n_points;
             first += Moments::most_groups * n_together)
          {
            const double *positions[Moments::most_groups],
              *C[Moments::most_groups];
            // The sums read entry by entry, which processors do not predict.
            for (std::size_t k = 0; k < Moments::most_groups * group_size;
                 k += 8)
              __builtin_prefetch(group + Moments::most_groups * group_size + k);
            int n_groups = 0;
            for (; n_groups < Moments::most_groups &&
                   first + n_groups * n_together < n_points;
                 ++n_groups, group += group_size)
              {
                positions[n_groups] = group;
                C[n_groups]         = group + dim * n_together;
                if (!symmetric)
                  {
                    symmetrize<n_pairs>(C[n_groups], polar_factors[n_groups]);
                    C[n_groups] = polar_factors[n_groups];
                  }
              }
            moments.add(geometry, positions, C, n_groups, [](int r, int s) {
              return entry_of<n_pairs, true>(r, s);
            });
          }
        moments.write(geometry, stride, matrix);
      }

    private:
      // The number of points that are summed before adding to the matrix.
      static constexpr int n_together = simd_width;
      // The derivatives, and the values for f_zz.
      static constexpr int n_directions = dim + (with_hoop ? 1 : 0);
      static constexpr int n_pairs      = dim * dim + (with_hoop ? 1 : 0);

      using Vector = FixedSimd<Number, width>;

      void
      load(const CellGeometry<dim, n> &geometry,
           const double               *numbers,
           const int                   q)
      {
        Point<dim> x;
        for (int d = 0; d < dim; ++d)
          x[d] = numbers[d * n_together];
        const ValuesAndGradients<dim, n> at(geometry, x);
        for (int l = 0; l < dim; ++l)
          for (int a = 0; a < n_functions; ++a)
            gradients[q][l][a] = at.gradients.values[l][a];
        for (int a = 0; a < n_functions && with_hoop; ++a)
          gradients[q][n_directions - 1][a] = at.values[a];
      }

      /// Compute C_iJkL d_J N_a.
      void
      contract(const double *C, const int i, const int k, const int q)
      {
        // Only component r has the additional pair of f_zz.
        const auto pair_of = [](const int component, const int direction) {
          return direction < dim  ? component * dim + direction
                 : component == 0 ? dim * dim
                                  : -1;
        };
        const auto entry = [&](const int r, const int s) {
          if (r < 0 || s < 0)
            return 0.;
          return C[entry_of<n_pairs, true>(std::min(r, s), std::max(r, s)) *
                   n_together];
        };
        for (int L = 0; L < n_directions; ++L)
          {
            Number of_pair[n_directions];
            for (int J = 0; J < n_directions; ++J)
              of_pair[J] = entry(pair_of(i, J), pair_of(k, L));
            for (int a = 0; a < stride; ++a)
              {
                Number sum = 0.;
                for (int J = 0; J < n_directions; ++J)
                  sum += of_pair[J] * gradients[q][J][a];
                factors[q][L][a] = sum;
              }
          }
      }

      void
      add(Number *block, const bool upper_half) const
      {
        for (int first = 0; first < stride; first += width)
          {
            Vector at[n_together][n_directions];
            for (int q = 0; q < n_together; ++q)
              for (int l = 0; l < n_directions; ++l)
                at[q][l] = greville::load<Vector>(&gradients[q][l][first]);
            Number   *row = block + first;
            const int last =
              upper_half ? std::min(n_functions, first + width) : n_functions;
            for (int a = 0; a < last; ++a, row += stride)
              {
                Vector sum = greville::load<Vector>(row);
#pragma GCC unroll 4
                for (int q = 0; q < n_together; ++q)
#pragma GCC unroll 3
                  for (int l = 0; l < n_directions; ++l)
                    sum += factors[q][l][a] * at[q][l];
                store(sum, row);
              }
          }
      }

      std::conditional_t<has_moments, CellMoments<dim, n>, char> moments;

      double polar_factors[has_moments ? CellMoments<dim, 2>::most_groups : 1]
                          [n_pairs * (n_pairs + 1) / 2 * n_together];

      // [point][direction][function], padded with zeros.
      Number gradients[n_together][n_directions][stride] = {};
      Number factors[n_together][n_directions][stride]   = {};
    };
  } // namespace



  template <int dim>
  template <typename Number>
  std::function<void(const typename PointTangents<dim>::CellPoints &)>
  PointTangents<dim>::cell_sums(const SpacePolynomials<dim> &of_space,
                                const CellAction<Number>    &action) const
  {
    std::function<void(const CellPoints &)> result;
    with_order_and_hoop<dim>(
      of_space.space->degree(),
      axisymmetric,
      [&](const auto order, const auto hoop) {
        constexpr int n = decltype(order)::value;
        using Stiffness = CellStiffness<dim, n, Number, decltype(hoop)::value>;
        const auto                      sums = std::make_shared<Stiffness>();
        const std::shared_ptr<Number[]> matrix(new Number[Stiffness::size]);
        result =
          [this, &of_space, action, sums, matrix](const CellPoints &points) {
            const CellGeometry<dim, n> geometry(of_space, points.cell);
            const double              *group = numbers.data() + points.first;
            bool                       done  = false;
            if constexpr (Stiffness::has_moments)
              if (points.n_points >= Stiffness::many)
                {
                  sums->sum_moments(geometry,
                                    group,
                                    points.n_points,
                                    group_size(),
                                    symmetric,
                                    matrix.get());
                  done = true;
                }
            if (!done)
              sums->sum_up(geometry,
                           group,
                           points.n_points,
                           group_size(),
                           symmetric,
                           matrix.get());
            action(points.cell, matrix.get(), Stiffness::stride);
          };
      });
    return result;
  }



  template <int dim>
  template <typename Number>
  void
  PointTangents<dim>::for_each_cell(const SpacePolynomials<dim> &of_space,
                                    const CellAction<Number>    &action) const
  {
    const auto sum_up = cell_sums(of_space, action);
    for (const CellPoints &points : cells)
      sum_up(points);
  }



  template <int dim>
  void
  PointTangents<dim>::sum_at_once(const CellAction<double> &action,
                                  const bool                keep)
  {
    sum_cell     = cell_sums(tables, action);
    keeps_points = keep;
  }



  template <int dim>
  void
  PointTangents<dim>::finish_cell()
  {
    if (!sum_cell)
      return;
    sum_cell(cells.back());
    if (keeps_points)
      return;
    cells.clear();
    n_used = 0;
  }



  GREVILLE_INSTANTIATE_CLASS(PointTangents);
  template void
  PointTangents<2>::for_each_cell(const SpacePolynomials<2> &,
                                  const CellAction<float> &) const;
  template void
  PointTangents<3>::for_each_cell(const SpacePolynomials<3> &,
                                  const CellAction<float> &) const;
} // namespace greville
