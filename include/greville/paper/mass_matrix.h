// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/petsc.h>
#include <greville/mass/extended_mass.h>

namespace greville
{
  /// The entries of an ExtendedMass as a PETSc matrix (MPIAIJ), with the
  /// numbers of the space. Inactive functions have a diagonal entry only.
  template <int dim>
  class MassMatrix
  {
  public:
    /// Collective. @p entries is the result of ExtendedMass::local_entries() on
    /// this process. @p inactive lists the owned functions that are not
    /// unknowns; they have the diagonal entry @p inactive_diagonal.
    MassMatrix(const ExtendedMass<dim>         &mass,
               const UpperTriangle             &entries,
               const std::vector<unsigned int> &inactive,
               const double                     inactive_diagonal);

    Mat
    petsc() const
    {
      return matrix.get();
    }

    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      view_src.with(src.begin(), [&](Vec x) {
        view_dst.with(dst.begin(),
                      [&](Vec y) { check_petsc(MatMult(petsc(), x, y)); });
      });
    }

    /// Return the bytes of entries and column numbers on this process.
    std::size_t
    memory_consumption() const
    {
      MatInfo info;
      check_petsc(MatGetInfo(petsc(), MAT_LOCAL, &info));
      return info.nz_used * (sizeof(PetscScalar) + sizeof(PetscInt));
    }

  private:
    PetscMatrix     matrix;
    PetscVectorView view_dst, view_src;
  };
} // namespace greville
