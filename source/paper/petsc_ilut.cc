// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/paper/ilut.h>

#include <petscpc.h>

#include <memory>

namespace greville
{
  namespace
  {
    using PetscIndexSet = PetscHandle<IS, ISDestroy>;

    struct Factors
    {
      std::unique_ptr<ILUT> ilut;
      PetscIndexSet         ordering;
      std::vector<double>   work;
    };



    Factors &
    factors_of(const PC pc)
    {
      void *context;
      check_petsc(PCShellGetContext(pc, &context));
      return *static_cast<Factors *>(context);
    }



    /// Turn exceptions into PETSc errors: they must not pass through PETSc.
    template <typename Action>
    PetscErrorCode
    without_exceptions(const Action &action)
    {
      try
        {
          action();
        }
      catch (const std::exception &)
        {
          return PetscErrorCode(PETSC_ERR_MAT_LU_ZRPVT);
        }
      return PetscErrorCode(0);
    }



    PetscErrorCode
    set_up(PC pc)
    {
      return without_exceptions([&]() {
        Factors &factors = factors_of(pc);
        Mat      matrix, permuted;
        IS       rows, columns;
        check_petsc(PCGetOperators(pc, nullptr, &matrix));
        check_petsc(MatGetOrdering(matrix, MATORDERINGAMD, &rows, &columns));
        factors.ordering.reset(rows);
        const PetscIndexSet owner(columns);
        check_petsc(MatPermute(matrix, rows, rows, &permuted));
        const PetscMatrix permuted_owner(permuted);
        factors.ilut = std::make_unique<ILUT>(permuted, 1e-12, 1.);
      });
    }



    template <bool transpose>
    PetscErrorCode
    apply(PC pc, Vec x, Vec y)
    {
      return without_exceptions([&]() {
        Factors           &factors = factors_of(pc);
        const PetscInt    *order;
        const PetscScalar *from;
        PetscScalar       *to;
        PetscInt           n;
        check_petsc(VecGetLocalSize(x, &n));
        check_petsc(ISGetIndices(factors.ordering.get(), &order));
        check_petsc(VecGetArrayRead(x, &from));
        factors.work.resize(n);
        for (PetscInt i = 0; i < n; ++i)
          factors.work[i] = from[order[i]];
        check_petsc(VecRestoreArrayRead(x, &from));
        transpose ? factors.ilut->solve_transpose(factors.work.data())
                  : factors.ilut->solve(factors.work.data());
        check_petsc(VecGetArray(y, &to));
        for (PetscInt i = 0; i < n; ++i)
          to[order[i]] = factors.work[i];
        check_petsc(VecRestoreArray(y, &to));
        check_petsc(ISRestoreIndices(factors.ordering.get(), &order));
      });
    }



    PetscErrorCode
    destroy(PC pc)
    {
      return without_exceptions([&]() { delete &factors_of(pc); });
    }



    PetscErrorCode
    create(PC pc)
    {
      return without_exceptions([&]() {
        check_petsc(PCSetType(pc, PCSHELL));
        check_petsc(PCShellSetContext(pc, new Factors));
        check_petsc(PCShellSetSetUp(pc, set_up));
        check_petsc(PCShellSetApply(pc, apply<false>));
        check_petsc(PCShellSetApplyTranspose(pc, apply<true>));
        check_petsc(PCShellSetDestroy(pc, destroy));
      });
    }
  } // namespace



  void
  register_petsc_ilut()
  {
    static bool is_registered = false;
    if (!is_registered)
      check_petsc(PCRegister("ilut", create));
    is_registered = true;
  }
} // namespace greville
