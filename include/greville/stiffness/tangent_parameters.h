// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/p_multigrid.h>

#include <string>

namespace greville
{
  /// Parameters of the linear solver of implicit steps.
  struct TangentParameters
  {
    TangentParameters();

    void
    declare(dealii::ParameterHandler &prm);

    /// Return whether conjugate gradients solve systems of this kind.
    bool
    takes_cg(const bool is_symmetric) const
    {
      return always_takes_cg() || (method == "auto" && is_symmetric);
    }

    bool
    always_takes_cg() const
    {
      return method == "cg";
    }

    /// Return whether the cycle never uses coarse levels. If it may, it uses
    /// them always, or only where they pay.
    bool
    never_takes_levels() const
    {
      return preconditioner == "smoother";
    }

    bool
    always_takes_levels() const
    {
      return preconditioner == "p-multigrid";
    }

    std::string          method         = "auto";
    std::string          preconditioner = "auto";
    unsigned int         max_iterations = 200;
    unsigned int         reuse          = 10;
    PMultigridParameters multigrid;
    SmootherParameters   smoother;
  };
} // namespace greville
