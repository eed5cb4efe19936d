// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/p_multigrid.h>

namespace greville
{
  /// Parameters of the linear solver of implicit steps.
  struct TangentParameters
  {
    enum class Method
    {
      automatic, // cg for symmetric systems, otherwise fgmres
      cg,
      fgmres
    };

    /// The use of coarse levels by the cycle. Parameter files do not set it.
    enum class UseOfLevels
    {
      automatic, // if they save time
      always,
      never
    };

    TangentParameters();

    void
    declare(dealii::ParameterHandler &prm);

    /// Return whether conjugate gradients solve systems of this kind.
    bool
    takes_cg(const bool is_symmetric) const
    {
      return method == Method::cg ||
             (method == Method::automatic && is_symmetric);
    }

    Method               method         = Method::automatic;
    UseOfLevels          use_of_levels  = UseOfLevels::automatic;
    unsigned int         max_iterations = 200;
    unsigned int         reuse          = 10;
    PMultigridParameters multigrid;
    SmootherParameters   smoother;
  };
} // namespace greville
