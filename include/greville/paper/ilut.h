// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/petsc.h>

namespace greville
{
  /**
   * Incomplete LU factorization with dual threshold, ILUT(tau, fill)
   * (@ref Saad1994 "Saad, 1994"), of a sequential
   * PETSc matrix. In row i, entries below tau times the norm of the row are
   * dropped, and the largest f n_i are kept in L and in U, where f is the fill
   * factor and n_i the number of entries of the row in that triangle, but at
   * least half of the row.
   *
   * PETSc 3.18 has no such factorization of its own, only interfaces to SuperLU
   * and hypre. According to doc/results/mass_solvers.md, SuperLU diverges on
   * small meshes with the paper's fill factor, and hypre for p >= 4 with its
   * defaults.
   */
  class ILUT
  {
  public:
    /// Factorize. Throws dealii::ExcMessage with the row if a pivot vanishes.
    ILUT(const Mat    matrix,
         const double drop_tolerance,
         const double fill_factor);

    /// x = (L U)^-1 x.
    void
    solve(double *x) const;

    /// x = (L U)^-T x.
    void
    solve_transpose(double *x) const;

  private:
    struct Triangle
    {
      std::vector<std::size_t>  begin{0};
      std::vector<unsigned int> columns;
      std::vector<double>       values;
    };

    struct Row;

    Triangle            lower; // unit diagonal not stored
    Triangle            upper; // diagonal not stored
    std::vector<double> inverse_diagonal;
  };

  /**
   * Register ILUT with drop tolerance 1e-12, fill factor 1 and PETSc's AMD
   * ordering as the PETSc preconditioner "ilut". It supports sequential
   * matrices, and the blocks of others, as in "-pc_type asm -pc_asm_overlap 1
   * -sub_pc_type ilut". May be called several times.
   */
  void
  register_petsc_ilut();
} // namespace greville
