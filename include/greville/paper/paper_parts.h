// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/p_multigrid.h>

namespace greville
{
  /**
   * Add the smoothers and transfers that only the tables of the paper use to
   * the lists. Call it before parameters are read; further calls do nothing.
   * The smoothers:
   * - "ilut": ILUT on overlapping domains, one per process,
   * - "ilu0", "ic0": ILU(0) and IC(0) of the diagonally scaled matrix, on the
   *   same domains; "ic0" for operators without LevelOperator::factorization(),
   * - "gauss-seidel": forward, but backward after the coarse correction of a
   *   symmetric cycle, process by process (PETSc's SOR),
   * - "symmetric-gauss-seidel": the same, first forward, then backward,
   * - "tensor-product": TensorProductPreconditioner.
   *
   * They use LevelOperator::matrix() or the space, component by component.
   * SmootherParameters::combination = "automatic" means symmetric in symmetric
   * cycles.
   *
   * The transfer "exact-l2" inverts mass matrices with the
   * TensorProductPreconditioner, exactly for a constant weight. The PETSc
   * preconditioner type is "ilut".
   */
  void
  add_paper_parts();



  /// The parameters of the cycle with all variants in the tables.
  struct PaperMultigridParameters : PMultigridParameters
  {
    PaperMultigridParameters()
    {
      smoother = "ilut";
    }

    void
    declare(dealii::ParameterHandler &prm);
  };

  /// Declare the orders of the levels, the type of the cycle and the transfers
  /// of a cycle, and its smoothing steps and coarse solver.
  void
  declare_levels(dealii::ParameterHandler &prm,
                 PMultigridParameters     &parameters);

  /// The parameters of all smoothers of the list.
  struct PaperSmootherParameters : SmootherParameters
  {
    void
    declare(dealii::ParameterHandler &prm);
  };
} // namespace greville
