// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi_noncontiguous_partitioner.templates.h>

#include <greville/base/errors.h>
#include <greville/base/simd.h>
#include <greville/paper/tensor_product_solver.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TensorProductSolver<dim>::TensorProductSolver(const SplineSpace<dim> &s)
    : space(&s)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        Require(!s.is_periodic(d),
                "Periodic walls do not support 'Prolongation' or 'Restriction' "
                "= exact-l2, nor tensor-product as 'Smoother' or 'Coarse "
                "preconditioner': all of them need open knot vectors.");
        factors[d] = factorize(s.knots(d));
      }

    const MPI_Comm     comm        = s.communicator();
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    if (n_processes == 1)
      return;
    const unsigned int me = Utilities::MPI::this_mpi_process(comm);

    // Lexicographic positions of the entries, in the order of memory.
    using Positions = std::vector<types::global_dof_index>;
    const auto &own = s.owned_functions();
    Positions   from(own.begin(), own.end());
    const auto  move_to = [&](const Positions &to) {
      moves.emplace_back(from, to, comm);
      std::sort(from.begin(), from.end());
      n_sent += from.size();
      for (const auto position : to)
        n_sent -= std::binary_search(from.begin(), from.end(), position);
      from = to;
    };

    // Pencils of direction d are numbered lexicographically and dealt out in
    // equal runs. Entries are stored with the pencil as the faster index.
    const auto &extents = s.n_functions();
    for (unsigned int d = 0; d < dim; ++d)
      {
        const std::uint64_t n     = s.n_dofs() / extents[d];
        const std::uint64_t begin = n * me / n_processes;
        n_pencils[d]              = n * (me + 1) / n_processes - begin;
        MultiIndex<dim> others    = extents;
        others[d]                 = 1;
        Positions to;
        for (unsigned int i = 0; i < extents[d]; ++i)
          for (unsigned int l = 0; l < n_pencils[d]; ++l)
            {
              auto index = multi_index<dim>(begin + l, others);
              index[d]   = i;
              to.push_back(lexicographic<dim>(index, extents));
            }
        pencils[d].resize(to.size());
        move_to(to);
      }
    move_to(Positions(own.begin(), own.end()));
  }



  template <int dim>
  typename TensorProductSolver<dim>::Factor
  TensorProductSolver<dim>::factorize(const KnotVector &knots)
  {
    const BandedMatrix mass = cross_matrix(knots, knots);
    Factor             factor;
    factor.n             = knots.n_functions();
    factor.p             = knots.degree();
    const unsigned int p = factor.p;
    factor.rows.assign(factor.n * (p + 1), 0.);

    const auto row = [&](const unsigned int i) {
      return factor.rows.data() + i * (p + 1);
    };
    for (unsigned int i = 0; i < factor.n; ++i)
      {
        factor.diagonal.push_back(mass(i, i));
        for (unsigned int j = i - std::min(i, p); j <= i; ++j)
          {
            double sum = mass(i, j);
            for (unsigned int k = i - std::min(i, p); k < j; ++k)
              sum -= row(i)[k + p - i] * (k + p >= j ? row(j)[k + p - j] : 0.);
            row(i)[j + p - i] = i == j ? 1. / std::sqrt(sum) : sum * row(j)[p];
          }
      }
    return factor;
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve_lines(const Factor      &factor,
                                        double            *x,
                                        const std::size_t  stride,
                                        const unsigned int n_lines)
  {
    const unsigned int n = factor.n, p = factor.p;

    // Solve some lines at a time, so that they stay in the cache and their
    // recurrences hide the latency.
    unsigned int line       = 0;
    const auto   solve_some = [&](const auto lane_type, const auto n_simd) {
      using Vector                     = std::decay_t<decltype(lane_type)>;
      constexpr unsigned int n_vectors = decltype(n_simd)::value;
      constexpr unsigned int width     = Vector::size();
      const auto at = [&](const unsigned int i, const unsigned int v) {
        return x + i * stride + line + v * width;
      };
      const auto entries = [&](const unsigned int i, const unsigned int v) {
        return load<Vector>(at(i, v));
      };
      // x_i = (x_i - sum_(begin <= j < end) L_ij x_j) / L_ii, or with L_ji.
      const auto eliminate = [&](const unsigned int i,
                                 const unsigned int begin,
                                 const unsigned int end,
                                 const auto        &factor_of) {
        Vector values[n_vectors];
        for (unsigned int v = 0; v < n_vectors; ++v)
          values[v] = entries(i, v);
        for (unsigned int j = begin; j < end; ++j)
          for (unsigned int v = 0; v < n_vectors; ++v)
            values[v] -= factor_of(j) * entries(j, v);
        for (unsigned int v = 0; v < n_vectors; ++v)
          store(values[v] * factor.rows[i * (p + 1) + p], at(i, v));
      };
      for (; line + n_vectors * width <= n_lines; line += n_vectors * width)
        {
          for (unsigned int i = 0; i < n; ++i)
            eliminate(i, i - std::min(i, p), i, [&](const unsigned int j) {
              return factor.rows[i * (p + 1) + p - (i - j)];
            });
          for (unsigned int i = n; i-- > 0;)
            eliminate(i,
                      i + 1,
                      std::min(i + p + 1, n),
                      [&](const unsigned int j) {
                        return factor.rows[j * (p + 1) + p - (j - i)];
                      });
        }
    };
    using One = std::integral_constant<unsigned int, 1>;
    solve_some(NativeSimd(), std::integral_constant<unsigned int, 4>());
    solve_some(NativeSimd(), One());
    solve_some(
      std::experimental::simd<double, std::experimental::simd_abi::scalar>(),
      One());
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve_on_one_process(double *x) const
  {
    const auto       &extents = space->n_functions();
    const std::size_t n_x     = extents[0];
    const std::size_t n_rows  = space->n_dofs() / n_x;

    // Lines in x are contiguous: transpose some at a time.
    constexpr unsigned int n_at_once = 4 * native_simd_width;
    std::vector<double>    buffer(n_x * n_at_once);
    for (std::size_t row = 0; row < n_rows; row += n_at_once)
      {
        const unsigned int n = std::min<std::size_t>(n_at_once, n_rows - row);
        for (unsigned int l = 0; l < n; ++l)
          for (unsigned int i = 0; i < n_x; ++i)
            buffer[i * n_at_once + l] = x[(row + l) * n_x + i];
        solve_lines(factors[0], buffer.data(), n_at_once, n);
        for (unsigned int l = 0; l < n; ++l)
          for (unsigned int i = 0; i < n_x; ++i)
            x[(row + l) * n_x + i] = buffer[i * n_at_once + l];
      }

    const std::size_t n_xy = n_x * extents[1];
    for (std::size_t plane = 0; plane < space->n_dofs() / n_xy; ++plane)
      solve_lines(factors[1], x + plane * n_xy, n_x, n_x);
    if (dim == 3)
      solve_lines(factors[dim - 1], x, n_xy, n_xy);
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve(VectorType &x) const
  {
    if (Utilities::MPI::n_mpi_processes(space->communicator()) == 1)
      {
        solve_on_one_process(x.begin());
        return;
      }
    const ArrayView<double> own(x.begin(), n_unknowns());
    ArrayView<const double> source = own;
    for (unsigned int d = 0; d < dim; ++d)
      {
        moves[d].export_to_ghosted_array(source, make_array_view(pencils[d]));
        solve_lines(factors[d], pencils[d].data(), n_pencils[d], n_pencils[d]);
        source = make_array_view(pencils[d]);
      }
    moves[dim].export_to_ghosted_array(source, own);
  }



  template <int dim>
  TensorProductPreconditioner<dim>::TensorProductPreconditioner(
    TensorProductSolver<dim>         s,
    const VectorType                &all_diagonals,
    const std::vector<unsigned int> &inactive_functions)
    : solver(std::move(s))
    , inactive(&inactive_functions)
  {
    const unsigned int n = solver.n_unknowns();
    const unsigned int n_components =
      n > 0 ? all_diagonals.locally_owned_size() / n : 1;
    for (unsigned int i = 0; i < n; ++i)
      {
        diagonal.push_back(all_diagonals.local_element(i * n_components));
        scaling.push_back(std::sqrt(solver.diagonal(i) / diagonal[i]));
      }
    for (const unsigned int i : *inactive)
      scaling[i] = 0.;
  }



  template <int dim>
  void
  TensorProductPreconditioner<dim>::vmult(VectorType       &dst,
                                          const VectorType &src) const
  {
    for (unsigned int i = 0; i < scaling.size(); ++i)
      dst.local_element(i) = scaling[i] * src.local_element(i);
    solver.solve(dst);
    for (unsigned int i = 0; i < scaling.size(); ++i)
      dst.local_element(i) *= scaling[i];
    for (const unsigned int i : *inactive)
      dst.local_element(i) = src.local_element(i) / diagonal[i];
  }



  GREVILLE_INSTANTIATE_CLASS(TensorProductSolver);
  GREVILLE_INSTANTIATE_CLASS(TensorProductPreconditioner);
} // namespace greville
