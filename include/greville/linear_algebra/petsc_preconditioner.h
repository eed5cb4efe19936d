// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/petsc.h>
#include <greville/linear_algebra/preconditioner.h>

#include <petscpc.h>

#include <functional>
#include <string>

namespace greville
{
  /// Any preconditioner of PETSc, described by PETSc's options without prefix,
  /// as in "-pc_type asm -pc_asm_overlap 1 -sub_pc_type ilu"; also ILUT, see
  /// register_petsc_ilut().
  class PetscPreconditioner : public Preconditioner
  {
  public:
    /// Collective. Throws dealii::ExcMessage if PETSc does not use one of the
    /// options or cannot make the preconditioner.
    PetscPreconditioner(const Mat matrix, const std::string &options);

    void
    vmult(VectorType &dst, const VectorType &src) const override;

    void
    Tvmult(VectorType &dst, const VectorType &src) const override;

  private:
    PetscHandle<PC, PCDestroy> pc;
    PetscVectorView            view_dst, view_src;
  };
} // namespace greville
