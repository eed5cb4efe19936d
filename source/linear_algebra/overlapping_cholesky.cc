// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/with_width.h>
#include <greville/linear_algebra/overlapping_cholesky.h>

#include "lattice_distances.h"
#include "overlapping_domain.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  void
  OverlappingCholesky::factorize(
    const UpperTriangle                   &matrix,
    const InterleavedLayout               &layout,
    const std::vector<std::array<int, 3>> &positions,
    const int                              reach,
    const unsigned int                     n_layers,
    const CholeskyParameters              &parameters,
    const RowVariants                     &variants)
  {
    AssertThrow(matrix.size() == layout.n_local(),
                ExcDimensionMismatch(matrix.size(), layout.n_local()));
    AssertThrow(positions.size() == layout.n_owned(),
                ExcDimensionMismatch(positions.size(), layout.n_owned()));
    n_owned              = layout.n_owned();
    variant_of_component = variants.of_component;
    last_rows.clear();
    last_rows.resize(variants.matrices.empty() ? 0
                                               : variants.matrices.size() + 1);
    is_parallel = Utilities::MPI::n_mpi_processes(layout.communicator()) > 1;
    has_domain  = is_parallel || !last_rows.empty();
    if (!has_domain)
      {
        run_on_all(layout.communicator(),
                   [&]() { factors.factorize(matrix, parameters); });
        return;
      }
    internal::OverlappingDomain rows(
      matrix, layout, positions, n_layers, variants);
    order  = rows.order;
    domain = InterleavedLayout(n_owned > 0 ? layout.global_number(0) : 0,
                               n_owned,
                               rows.ghosts(),
                               layout.communicator());
    for (auto &vector : doubles)
      vector.reinit(0);
    for (auto &vector : floats)
      vector.reinit(0);
    factorize_domain(rows, parameters);
    find_weights(rows, reach * n_layers);
  }



  void
  OverlappingCholesky::factorize_domain(internal::OverlappingDomain &rows,
                                        const CholeskyParameters    &parameters)
  {
    const UpperTriangle matrix = rows.domain_matrix();
    const unsigned int  n_common =
      last_rows.empty() ? matrix.size() : rows.n_common();
    run_on_all(domain.communicator(),
               [&]() { factors.factorize(matrix, parameters, n_common); });
    const UpperTriangle last_of_matrix = rows.last_rows(matrix);
    for (unsigned int v = 0; v < last_rows.size(); ++v)
      {
        const UpperTriangle last =
          v == 0 ? last_of_matrix : rows.last_rows(rows.domain_matrix(v));
        if (!is_used(v))
          continue;
        const auto is_fixed = rows.is_fixed(v);
        LastRows  &variant  = last_rows[v];
        run_on_all(domain.communicator(), [&]() {
          // Do not shift again: the complement contains the shift.
          variant.factors.factorize(factors.complement(last, is_fixed),
                                    {0., parameters.drop_tolerance});
        });
        for (unsigned int k = 0; k < is_fixed.size(); ++k)
          if (is_fixed[k])
            {
              variant.fixed.push_back(k);
              variant.inverse_fixed.push_back(factors.unit() /
                                              last_of_matrix.diagonal(k));
            }
      }
  }



  void
  OverlappingCholesky::find_weights(const internal::OverlappingDomain &rows,
                                    const int                          reach)
  {
    // In the overlap, the depth of ghosts falls from reach to 1 with the
    // distance from the owned unknowns, which are deeper.
    const auto distances = internal::distances_to_other_part(
      rows.local_positions(), rows.lexicographic, n_owned, reach);
    using Vector = LinearAlgebra::distributed::Vector<double>;
    Vector depth(domain.partitioner(1)), sum(domain.partitioner(1));
    for (unsigned int u = 0; u < order.size(); ++u)
      depth.local_element(u) =
        u < n_owned ? reach + distances[u] : reach + 1 - distances[u];
    for (unsigned int u = 0; u < order.size(); ++u)
      sum.local_element(u) = depth.local_element(u);
    sum.compress(VectorOperation::add);
    sum.update_ghost_values();
    weights.resize(order.size());
    for (unsigned int k = 0; k < order.size(); ++k)
      weights[k] =
        std::sqrt(depth.local_element(order[k]) / sum.local_element(order[k]));
  }



  void
  OverlappingCholesky::solve_domain(float *x, const unsigned int width) const
  {
    if (last_rows.empty())
      {
        factors.solve(x, width);
        return;
      }
    float            *end      = x + std::size_t(factors.size()) * width;
    const std::size_t n        = (order.size() - factors.size()) * width;
    const auto for_each_column = [&](const unsigned int v, const auto &visit) {
      for (unsigned int c = 0; c < width; ++c)
        if (variant_of_component[c % variant_of_component.size()] == v)
          visit(c);
    };
    given.assign(end, end + n);
    factors.eliminate(x, width);
    eliminated.assign(end, end + n);
    for (unsigned int v = 0; v < last_rows.size(); ++v)
      {
        if (!is_used(v))
          continue;
        const LastRows &variant = last_rows[v];
        const float     factor  = factors.unit() / variant.factors.unit();
        solution                = eliminated;
        for (const unsigned int k : variant.fixed)
          std::fill_n(solution.begin() + k * width, width, 0.f);
        variant.factors.solve(solution.data(), width);
        for_each_column(v, [&](const unsigned int c) {
          for (std::size_t i = c; i < n; i += width)
            end[i] = factor * solution[i];
        });
      }
    factors.substitute(x, width);
    for (unsigned int v = 0; v < last_rows.size(); ++v)
      for_each_column(v, [&](const unsigned int c) {
        const LastRows &variant = last_rows[v];
        for (unsigned int k = 0; k < variant.fixed.size(); ++k)
          {
            const std::size_t i = variant.fixed[k] * width + c;
            end[i]              = variant.inverse_fixed[k] * given[i];
          }
      });
  }



  void
  OverlappingCholesky::solve(double *x, const unsigned int width) const
  {
    if (has_domain)
      solve(x, width, 1., doubles);
    else
      factors.solve(x, width);
  }



  void
  OverlappingCholesky::solve(float             *x,
                             const unsigned int width,
                             const double       unit) const
  {
    if (has_domain)
      solve(x, width, unit, floats);
    else
      {
        factors.solve(x, width);
        const float factor = unit / factors.unit();
        for (std::size_t k = 0; k < std::size_t(n_owned) * width; ++k)
          x[k] *= factor;
      }
  }



  template <typename Number>
  void
  OverlappingCholesky::solve(Number            *x,
                             const unsigned int width,
                             const double       unit,
                             Vectors<Number>   &vectors) const
  {
    auto   &values = vectors[width];
    Number *local  = x; // by local unknown
    if (is_parallel)
      {
        const auto &partitioner = domain.partitioner(width);
        if (values.get_partitioner() != partitioner)
          values.reinit(partitioner);
        std::copy_n(x, n_owned * width, values.begin());
        values.update_ghost_values();
        local = values.begin();
      }
    double largest = 1.;
    if constexpr (std::is_same_v<Number, double>)
      {
        largest = 0.;
        for (unsigned int i = 0; i < order.size() * width; ++i)
          largest = std::max(largest, std::abs(local[i]));
      }
    const auto for_each_row = [&](const auto &visit) {
      with_width(width, [&](const auto w) {
        constexpr unsigned int n = decltype(w)::value;
        for (unsigned int k = 0; k < order.size(); ++k)
          for (unsigned int c = 0; c < n; ++c)
            visit(weights[k], rows[k * n + c], local[order[k] * n + c]);
      });
    };
    const Number scale = largest > 0. ? 1. / largest : 0.;
    rows.resize(order.size() * width);
    for_each_row([&](const float weight, float &row, const Number value) {
      row = weight * (scale * value);
    });
    solve_domain(rows.data(), width);
    if (is_parallel)
      values.zero_out_ghost_values();
    const Number unscale = largest * (unit / factors.unit());
    for_each_row([&](const float weight, const float row, Number &value) {
      value = unscale * weight * row;
    });
    if (is_parallel)
      {
        values.compress(VectorOperation::add);
        std::copy_n(values.begin(), n_owned * width, x);
      }
  }
} // namespace greville
