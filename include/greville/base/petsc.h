// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/exceptions.h>

#include <greville/base/compatibility.h>

#include <petscmat.h>
#include <petscvec.h>

#include <memory>

namespace greville
{
  /// Throw dealii::LACExceptions::ExcPETScError if a PETSc call failed.
  inline void
  check_petsc(const PetscErrorCode error)
  {
    AssertThrow(error == 0, dealii::LACExceptions::ExcPETScError(error));
  }

  namespace internal
  {
    template <typename Handle, PetscErrorCode (*destroy)(Handle *)>
    struct PetscDeleter
    {
      using pointer = Handle;

      void
      operator()(Handle handle) const
      {
        destroy(&handle);
      }
    };
  } // namespace internal

  /// An owned PETSc object: PetscHandle<Mat, MatDestroy>.
  template <typename Handle, PetscErrorCode (*destroy)(Handle *)>
  using PetscHandle = std::unique_ptr<std::remove_pointer_t<Handle>,
                                      internal::PetscDeleter<Handle, destroy>>;

  using PetscMatrix = PetscHandle<Mat, MatDestroy>;
  using PetscVector = PetscHandle<Vec, VecDestroy>;

  /// A PETSc vector without memory of its own: PETSc works on the owned entries
  /// of a VectorType in place.
  class PetscVectorView
  {
  public:
    PetscVectorView() = default;

    PetscVectorView(const MPI_Comm comm, const PetscInt n_local)
    {
      Vec vec;
      check_petsc(VecCreateMPIWithArray(
        comm, 1, n_local, PETSC_DETERMINE, nullptr, &vec));
      vector.reset(vec);
    }

    /// Call @p function with a PETSc vector of the entries at @p values.
    template <typename Function>
    void
    with(const double *values, const Function &function) const
    {
      check_petsc(VecPlaceArray(vector.get(), const_cast<double *>(values)));
      function(vector.get());
      check_petsc(VecResetArray(vector.get()));
    }

  private:
    PetscVector vector;
  };
} // namespace greville
