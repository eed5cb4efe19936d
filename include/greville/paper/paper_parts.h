// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_paper_paper_parts_h
#define greville_paper_paper_parts_h

#include <greville/multigrid/p_multigrid.h>

namespace greville
{
  /**
   * Add what only the tables of the paper use to the lists of smoothers and
   * transfers; to be called before parameters are read. Further calls do
   * nothing. The smoothers:
   * - "ilut": ILUT on overlapping domains, one per process,
   * - "ilu0", "ic0": ILU(0) and IC(0) of the diagonally scaled matrix,
   *   likewise; "ic0" of operators without LevelOperator::factorization(),
   * - "gauss-seidel": forward before and backward after the coarse correction
   *   of a symmetric cycle, "symmetric-gauss-seidel": forward and backward;
   *   both process by process (PETSc's SOR),
   * - "tensor-product": TensorProductPreconditioner.
   *
   * They work on LevelOperator::matrix() or on the space, component by
   * component. SmootherParameters::combination = "automatic" is symmetric in
   * symmetric cycles.
   *
   * The inverse of mass matrices in transfers: "exact-l2", the
   * TensorProductPreconditioner, exact for a constant weight. The type of
   * preconditioners of PETSc: "ilut".
   */
  void
  add_paper_parts();



  /**
   * The parameters of the cycle with all that tables compare.
   */
  struct PaperMultigridParameters : PMultigridParameters
  {
    PaperMultigridParameters()
    {
      smoother = "ilut";
    }

    void
    declare(dealii::ParameterHandler &prm);
  };

  /**
   * Declare the orders of the levels, the type of the cycle and the transfers
   * of a cycle, and its smoothing steps and coarse solver.
   */
  void
  declare_levels(dealii::ParameterHandler &prm,
                 PMultigridParameters     &parameters);

  /**
   * The parameters of all smoothers of the list.
   */
  struct PaperSmootherParameters : SmootherParameters
  {
    void
    declare(dealii::ParameterHandler &prm);
  };
} // namespace greville

#endif
