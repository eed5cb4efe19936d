// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/ilut.h>
#include <greville/multigrid/schwarz.h>

#include <petscpc.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  OverlappingDomain<dim>::OverlappingDomain(const LevelOperator<dim> &level,
                                            const unsigned int        overlap,
                                            const SchwarzCombination  c,
                                            const std::string        &ordering)
    : combination(c)
    , comm(level.space().communicator())
    , n_owned(level.space().owned_functions().size())
  {
    const Mat                     matrix    = level.matrix();
    const auto                   &positions = level.space().owned_functions();
    PetscInt                      n_all;
    std::pair<PetscInt, PetscInt> range;
    check_petsc(MatGetOwnershipRange(matrix, &range.first, &range.second));
    check_petsc(MatGetSize(matrix, &n_all, nullptr));
    AssertDimension(n_owned, range.second - range.first);

    // The numbers in the domain, ascending.
    std::vector<PetscInt> domain_numbers(n_owned);
    std::iota(domain_numbers.begin(), domain_numbers.end(), range.first);
    if (Utilities::MPI::n_mpi_processes(comm) == 1)
      check_petsc(MatMPIAIJGetSeqAIJ(matrix, &local_matrix, nullptr, nullptr));
    else
      {
        IS is;
        check_petsc(ISCreateGeneral(PETSC_COMM_SELF,
                                    n_owned,
                                    domain_numbers.data(),
                                    PETSC_COPY_VALUES,
                                    &is));
        check_petsc(MatIncreaseOverlap(matrix, 1, &is, overlap));
        check_petsc(ISSort(is));
        Mat *matrices;
        check_petsc(MatCreateSubMatrices(
          matrix, 1, &is, &is, MAT_INITIAL_MATRIX, &matrices));
        check_petsc(
          PetscObjectReference(reinterpret_cast<PetscObject>(matrices[0])));
        local_copy.reset(matrices[0]);
        local_matrix = local_copy.get();
        check_petsc(MatDestroySubMatrices(1, &matrices));

        PetscInt        n;
        const PetscInt *indices;
        check_petsc(ISGetLocalSize(is, &n));
        check_petsc(ISGetIndices(is, &indices));
        domain_numbers.assign(indices, indices + n);
        check_petsc(ISRestoreIndices(is, &indices));
        check_petsc(ISDestroy(&is));
      }

    IndexSet ghosts(n_all);
    for (const PetscInt number : domain_numbers)
      if (number < range.first || number >= range.second)
        ghosts.add_index(number);
    IndexSet owned(n_all);
    owned.add_range(range.first, range.second);
    values.reinit(owned, ghosts, comm);
    for (const PetscInt number : domain_numbers)
      order.push_back(values.get_partitioner()->global_to_local(number));

    // Positions travel as doubles, exactly.
    for (unsigned int i = 0; i < n_owned; ++i)
      values.local_element(i) = positions[i];
    values.update_ghost_values();
    std::vector<std::uint64_t> function_positions;
    for (const unsigned int i : order)
      function_positions.push_back(values.local_element(i));
    values.zero_out_ghost_values();

    // The ordering.
    std::vector<PetscInt> permutation(order.size());
    std::iota(permutation.begin(), permutation.end(), 0);
    if (ordering == "lexicographic")
      std::sort(permutation.begin(),
                permutation.end(),
                [&](const PetscInt a, const PetscInt b) {
                  return function_positions[a] < function_positions[b];
                });
    else if (!permutation.empty())
      {
        IS rows, columns;
        check_petsc(
          MatGetOrdering(local_matrix, ordering.c_str(), &rows, &columns));
        const PetscInt *indices;
        check_petsc(ISGetIndices(rows, &indices));
        permutation.assign(indices, indices + order.size());
        check_petsc(ISRestoreIndices(rows, &indices));
        check_petsc(ISDestroy(&rows));
        check_petsc(ISDestroy(&columns));
      }
    if (!std::is_sorted(permutation.begin(), permutation.end()))
      {
        IS is;
        check_petsc(ISCreateGeneral(PETSC_COMM_SELF,
                                    permutation.size(),
                                    permutation.data(),
                                    PETSC_COPY_VALUES,
                                    &is));
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

    if (combination == SchwarzCombination::symmetric)
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
  }



  template <int dim>
  void
  OverlappingDomain<dim>::restrict_to(std::vector<double> &local,
                                      const VectorType    &src,
                                      const bool           transpose) const
  {
    std::copy_n(src.begin(), n_owned, values.begin());
    values.update_ghost_values();
    local.resize(order.size());
    for (unsigned int i = 0; i < order.size(); ++i)
      local[i] = values.local_element(order[i]) *
                 (combination == SchwarzCombination::symmetric ? weights[i]
                  : transpose && !owns(i)                      ? 0.
                                                               : 1.);
    values.zero_out_ghost_values();
  }



  template <int dim>
  void
  OverlappingDomain<dim>::prolongate_from(const std::vector<double> &local,
                                          VectorType                &dst,
                                          const bool transpose) const
  {
    if (combination == SchwarzCombination::restricted && !transpose)
      {
        for (unsigned int i = 0; i < order.size(); ++i)
          if (owns(i))
            dst.local_element(order[i]) = local[i];
        return;
      }
    values = 0.;
    for (unsigned int i = 0; i < order.size(); ++i)
      values.local_element(order[i]) =
        combination == SchwarzCombination::symmetric ? weights[i] * local[i]
                                                     : local[i];
    values.compress(VectorOperation::add);
    std::copy_n(values.begin(), n_owned, dst.begin());
  }



  namespace
  {
    class IlutSolver : public LocalSolver
    {
    public:
      template <typename... Arguments>
      IlutSolver(const Arguments &...arguments)
        : ilut(arguments...)
      {}

      void
      solve(double *x, const bool transpose) const override
      {
        transpose ? ilut.solve_transpose(x) : ilut.solve(x);
      }

    private:
      ILUT ilut;
    };



    class IC0Solver : public LocalSolver
    {
    public:
      IC0Solver(const Mat matrix, const double shift)
      {
        factors.factorize(lower_triangle(matrix), shift);
      }

      void
      solve(double *x, const bool) const override
      {
        factors.solve(x, 1);
      }

    private:
      IncompleteCholesky factors;
    };



    class ILU0Solver : public LocalSolver
    {
    public:
      ILU0Solver(const Mat matrix, const double shift)
      {
        Mat scaled;
        check_petsc(MatDuplicate(matrix, MAT_COPY_VALUES, &scaled));
        PetscMatrix owner(scaled);
        Vec         diagonal;
        check_petsc(MatCreateVecs(scaled, &diagonal, nullptr));
        PetscVector vector_owner(diagonal);
        check_petsc(MatGetDiagonal(scaled, diagonal));
        check_petsc(VecSqrtAbs(diagonal));
        check_petsc(VecReciprocal(diagonal));
        check_petsc(MatDiagonalScale(scaled, diagonal, diagonal));
        if (shift != 0.)
          check_petsc(MatShift(scaled, shift));

        PetscInt           n;
        const PetscScalar *values;
        check_petsc(VecGetLocalSize(diagonal, &n));
        check_petsc(VecGetArrayRead(diagonal, &values));
        scaling.assign(values, values + n);
        check_petsc(VecRestoreArrayRead(diagonal, &values));

        PC handle;
        check_petsc(PCCreate(PETSC_COMM_SELF, &handle));
        pc.reset(handle);
        check_petsc(PCSetOperators(handle, scaled, scaled));
        check_petsc(PCSetType(handle, PCILU));
        check_petsc(PCFactorSetMatOrderingType(handle, MATORDERINGNATURAL));
        check_petsc(PCFactorSetLevels(handle, 0));
        check_petsc(PCFactorSetShiftType(handle, MAT_SHIFT_NONE));
        check_petsc(PCFactorSetZeroPivot(handle, 1e-14));
        check_petsc(PCSetErrorIfFailure(handle, PETSC_FALSE));
        check_petsc(PCSetUp(handle));
        PCFailedReason reason;
        check_petsc(PCGetFailedReason(handle, &reason));
        AssertThrow(reason == PC_NOERROR,
                    ExcMessage("ILU(0) found a pivot that is zero: the matrix "
                               "needs a shift (parameter 'Shift', try "
                               "1e-3)."));
        view_in  = PetscVectorView(PETSC_COMM_SELF, n);
        view_out = PetscVectorView(PETSC_COMM_SELF, n);
        scratch.resize(n);
      }

      void
      solve(double *x, const bool transpose) const override
      {
        for (std::size_t i = 0; i < scaling.size(); ++i)
          x[i] *= scaling[i];
        view_in.with(x, [&](Vec in) {
          view_out.with(scratch.data(), [&](Vec out) {
            check_petsc(transpose ? PCApplyTranspose(pc.get(), in, out)
                                  : PCApply(pc.get(), in, out));
          });
        });
        for (std::size_t i = 0; i < scaling.size(); ++i)
          x[i] = scaling[i] * scratch[i];
      }

    private:
      PetscHandle<PC, PCDestroy>  pc;
      std::vector<double>         scaling;
      mutable std::vector<double> scratch;
      PetscVectorView             view_in, view_out;
    };
  } // namespace



  std::unique_ptr<LocalSolver>
  make_ilut(const Mat    matrix,
            const double drop_tolerance,
            const double fill_factor)
  {
    return std::make_unique<IlutSolver>(matrix, drop_tolerance, fill_factor);
  }



  std::unique_ptr<LocalSolver>
  make_ilu0(const Mat matrix, const double shift)
  {
    return std::make_unique<ILU0Solver>(matrix, shift);
  }



  std::unique_ptr<LocalSolver>
  make_ic0(const Mat matrix, const double shift)
  {
    return std::make_unique<IC0Solver>(matrix, shift);
  }



  LowerTriangle
  lower_triangle(const Mat matrix)
  {
    PetscInt           n;
    const PetscInt    *begin, *columns;
    const PetscScalar *values;
    PetscBool          is_done;
    check_petsc(MatGetRowIJ(
      matrix, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &is_done));
    AssertThrow(is_done, ExcInternalError());
    check_petsc(MatSeqAIJGetArrayRead(matrix, &values));
    LowerTriangle result;
    result.row_begin.reserve(n + 1);
    for (PetscInt i = 0; i < n; ++i)
      {
        for (PetscInt e = begin[i]; e < begin[i + 1] && columns[e] <= i; ++e)
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
  AdditiveSchwarz<dim>::AdditiveSchwarz(
    std::unique_ptr<const OverlappingDomain<dim>>                 d,
    const std::function<std::unique_ptr<LocalSolver>(const Mat)> &make)
    : domain(std::move(d))
  {
    run_on_all(
      [&]() {
        if (domain->size() > 0)
          solver = make(domain->matrix());
      },
      domain->communicator());
  }



  template <int dim>
  void
  AdditiveSchwarz<dim>::apply(VectorType       &dst,
                              const VectorType &src,
                              const bool        transpose) const
  {
    domain->restrict_to(local, src, transpose);
    if (solver)
      solver->solve(local.data(), transpose);
    domain->prolongate_from(local, dst, transpose);
  }



  template <int dim>
  void
  AdditiveSchwarz<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    apply(dst, src, false);
  }



  template <int dim>
  void
  AdditiveSchwarz<dim>::Tvmult(VectorType &dst, const VectorType &src) const
  {
    apply(dst, src, true);
  }



  template class OverlappingDomain<2>;
  template class OverlappingDomain<3>;
  template class AdditiveSchwarz<2>;
  template class AdditiveSchwarz<3>;
} // namespace greville
