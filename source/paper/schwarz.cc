// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/largest_eigenvalue.h>
#include <greville/paper/schwarz.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Largest allowed eigenvalue of the product with the matrix: two smoothing
    // steps stay positive definite, with a margin for the lower estimate.
    constexpr double largest_allowed = 1.9;



    IS
    make_indices(const std::vector<PetscInt> &numbers)
    {
      IS is;
      check_petsc(ISCreateGeneral(PETSC_COMM_SELF,
                                  numbers.size(),
                                  numbers.data(),
                                  PETSC_COPY_VALUES,
                                  &is));
      return is;
    }



    std::vector<PetscInt>
    take_indices(IS is)
    {
      PetscInt        n;
      const PetscInt *indices;
      check_petsc(ISGetLocalSize(is, &n));
      check_petsc(ISGetIndices(is, &indices));
      const std::vector<PetscInt> result(indices, indices + n);
      check_petsc(ISRestoreIndices(is, &indices));
      check_petsc(ISDestroy(&is));
      return result;
    }



    /// Collective. Return the numbers in the domain, ascending, and set its
    /// matrix, which @p copy owns if it is not a part of @p matrix.
    std::vector<PetscInt>
    domain_of_process(const Mat                            matrix,
                      const std::pair<PetscInt, PetscInt> &range,
                      const unsigned int                   overlap,
                      const MPI_Comm                       comm,
                      Mat                                 &local_matrix,
                      PetscMatrix                         &copy)
    {
      std::vector<PetscInt> numbers(range.second - range.first);
      std::iota(numbers.begin(), numbers.end(), range.first);
      if (Utilities::MPI::n_mpi_processes(comm) == 1)
        {
          check_petsc(
            MatMPIAIJGetSeqAIJ(matrix, &local_matrix, nullptr, nullptr));
          return numbers;
        }
      IS is = make_indices(numbers);
      check_petsc(MatIncreaseOverlap(matrix, 1, &is, overlap));
      check_petsc(ISSort(is));
      Mat *matrices;
      check_petsc(MatCreateSubMatrices(
        matrix, 1, &is, &is, MAT_INITIAL_MATRIX, &matrices));
      check_petsc(
        PetscObjectReference(reinterpret_cast<PetscObject>(matrices[0])));
      copy.reset(matrices[0]);
      local_matrix = copy.get();
      check_petsc(MatDestroySubMatrices(1, &matrices));
      return take_indices(is);
    }



    /// Return the ordering of rows with the given @p positions in the grid.
    std::vector<PetscInt>
    permutation_of(const Mat                         local_matrix,
                   const std::string                &ordering,
                   const std::vector<std::uint64_t> &positions)
    {
      std::vector<PetscInt> permutation(positions.size());
      std::iota(permutation.begin(), permutation.end(), 0);
      if (ordering == "lexicographic")
        std::sort(permutation.begin(),
                  permutation.end(),
                  [&](const PetscInt a, const PetscInt b) {
                    return positions[a] < positions[b];
                  });
      else if (!permutation.empty())
        {
          IS rows, columns;
          check_petsc(
            MatGetOrdering(local_matrix, ordering.c_str(), &rows, &columns));
          permutation = take_indices(rows);
          check_petsc(ISDestroy(&columns));
        }
      return permutation;
    }
  } // namespace



  template <int dim>
  AdditiveSchwarz<dim>::AdditiveSchwarz(
    const LevelOperator<dim>                    &level,
    const unsigned int                           overlap,
    const bool                                   symmetric,
    const std::string                           &ordering,
    const std::function<LocalSolver(const Mat)> &make)
    : is_symmetric(symmetric)
    , n_owned(level.space().owned_functions().size())
  {
    const MPI_Comm                comm      = level.space().communicator();
    const Mat                     matrix    = level.matrix();
    const auto                   &positions = level.space().owned_functions();
    PetscInt                      n_all;
    std::pair<PetscInt, PetscInt> range;
    check_petsc(MatGetOwnershipRange(matrix, &range.first, &range.second));
    check_petsc(MatGetSize(matrix, &n_all, nullptr));
    AssertThrow(PetscInt(n_owned) == range.second - range.first,
                ExcDimensionMismatch(n_owned, range.second - range.first));

    Mat                         local_matrix;
    PetscMatrix                 local_copy;
    const std::vector<PetscInt> domain_numbers =
      domain_of_process(matrix, range, overlap, comm, local_matrix, local_copy);
    IndexSet ghosts(n_all);
    for (const PetscInt number : domain_numbers)
      if (number < range.first || number >= range.second)
        ghosts.add_index(number);
    IndexSet owned(n_all);
    owned.add_range(range.first, range.second);
    values.reinit(owned, ghosts, comm);
    for (const PetscInt number : domain_numbers)
      order.push_back(values.get_partitioner()->global_to_local(number));

    // Doubles represent the positions exactly.
    for (unsigned int i = 0; i < n_owned; ++i)
      values.local_element(i) = positions[i];
    values.update_ghost_values();
    std::vector<std::uint64_t> function_positions;
    for (const unsigned int i : order)
      function_positions.push_back(values.local_element(i));
    values.zero_out_ghost_values();

    const std::vector<PetscInt> permutation =
      permutation_of(local_matrix, ordering, function_positions);
    if (!std::is_sorted(permutation.begin(), permutation.end()))
      {
        IS is = make_indices(permutation);
        check_petsc(ISSetPermutation(is));
        Mat permuted;
        check_petsc(MatPermute(local_matrix, is, is, &permuted));
        check_petsc(ISDestroy(&is));
        local_copy.reset(permuted);
        local_matrix = permuted;

        const auto old_order = order;
        for (unsigned int i = 0; i < order.size(); ++i)
          order[i] = old_order[permutation[i]];
      }

    if (is_symmetric)
      {
        // Count the domains that hold an entry.
        values = 0.;
        for (const unsigned int i : order)
          values.local_element(i) = 1.;
        values.compress(VectorOperation::add);
        values.update_ghost_values();
        for (const unsigned int i : order)
          weights.push_back(1. / std::sqrt(values.local_element(i)));
        values.zero_out_ghost_values();
      }
    run_on_all(comm, [&]() {
      if (!order.empty())
        solver = make(local_matrix);
    });
    if (is_symmetric && Utilities::MPI::n_mpi_processes(comm) > 1)
      scale = std::min(1., largest_allowed / largest_eigenvalue_with(level));
  }



  template <int dim>
  double
  AdditiveSchwarz<dim>::largest_eigenvalue_with(
    const LevelOperator<dim> &level) const
  {
    const SplineSpace<dim> &space  = level.space();
    const Mat               matrix = level.matrix();
    const MPI_Comm          comm   = space.communicator();
    const PetscVectorView   in(comm, n_owned), out(comm, n_owned);
    VectorType              x, y;
    space.initialize_vector(x);
    space.initialize_vector(y);
    const auto multiply = [&](std::vector<double>       &result,
                              const std::vector<double> &from) {
      result.resize(n_owned);
      in.with(from.data(), [&](Vec petsc_from) {
        out.with(result.data(), [&](Vec petsc_result) {
          check_petsc(MatMult(matrix, petsc_from, petsc_result));
        });
      });
    };
    const auto precondition = [&](std::vector<double>       &result,
                                  const std::vector<double> &from) {
      std::copy(from.begin(), from.end(), x.begin());
      apply(y, x, false);
      result.assign(y.begin(), y.begin() + n_owned);
    };
    // The start vector has signs that depend only on positions, in the norm of
    // the diagonal. It is zero for inactive functions, whose eigenvalue is 1.
    std::vector<double> start(n_owned);
    out.with(start.data(), [&](Vec diagonal) {
      check_petsc(MatGetDiagonal(matrix, diagonal));
    });
    const auto &positions = space.owned_functions();
    for (unsigned int i = 0; i < n_owned; ++i)
      start[i] = std::copysign(std::sqrt(start[i]),
                               std::sin(12.9898 * (positions[i] % 104729)));
    for (const unsigned int i : level.inactive())
      start[i] = 0.;
    return largest_eigenvalue(multiply, precondition, start, 0.02, 40, comm)
      .value;
  }



  UpperTriangle
  upper_triangle(const Mat matrix)
  {
    PetscInt           n;
    const PetscInt    *begin, *columns;
    const PetscScalar *values;
    PetscBool          is_done;
    check_petsc(MatGetRowIJ(
      matrix, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &is_done));
    AssertThrow(is_done, ExcInternalError());
    check_petsc(MatSeqAIJGetArrayRead(matrix, &values));
    UpperTriangle result;
    result.row_begin.reserve(n + 1);
    for (PetscInt i = 0; i < n; ++i)
      {
        for (PetscInt e = begin[i]; e < begin[i + 1]; ++e)
          if (columns[e] >= i)
            {
              result.columns.push_back(columns[e]);
              result.values.push_back(values[e]);
            }
        result.row_begin.push_back(result.columns.size());
      }
    check_petsc(MatSeqAIJRestoreArrayRead(matrix, &values));
    check_petsc(MatRestoreRowIJ(
      matrix, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &is_done));
    return result;
  }



  template <int dim>
  void
  AdditiveSchwarz<dim>::apply(VectorType       &dst,
                              const VectorType &src,
                              const bool        transpose) const
  {
    // Restrict to the domain.
    std::copy_n(src.begin(), n_owned, values.begin());
    values.update_ghost_values();
    local.resize(order.size());
    for (unsigned int i = 0; i < order.size(); ++i)
      local[i] = values.local_element(order[i]) *
                 (is_symmetric                       ? weights[i]
                  : transpose && order[i] >= n_owned ? 0.
                                                     : 1.);
    values.zero_out_ghost_values();
    if (solver)
      solver(local.data(), transpose);

    // Prolongate from the domains.
    if (!is_symmetric && !transpose)
      {
        for (unsigned int i = 0; i < order.size(); ++i)
          if (order[i] < n_owned)
            dst.local_element(order[i]) = local[i];
        return;
      }
    values = 0.;
    for (unsigned int i = 0; i < order.size(); ++i)
      values.local_element(order[i]) =
        is_symmetric ? weights[i] * local[i] : local[i];
    values.compress(VectorOperation::add);
    std::copy_n(values.begin(), n_owned, dst.begin());
    if (scale != 1.)
      dst *= scale;
  }



  GREVILLE_INSTANTIATE_CLASS(AdditiveSchwarz);
} // namespace greville
