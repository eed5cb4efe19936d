// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_stiffness_tangent_parameters_h
#define greville_stiffness_tangent_parameters_h

#include <greville/multigrid/p_multigrid.h>

#include <string>

namespace greville
{
  /**
   * How linear systems of implicit steps are solved.
   */
  struct TangentParameters
  {
    TangentParameters();

    void
    declare(dealii::ParameterHandler &prm);

    std::string          method         = "auto";
    std::string          preconditioner = "auto";
    unsigned int         max_iterations = 200;
    unsigned int         reuse          = 10;
    PMultigridParameters multigrid;
    SmootherParameters   smoother;
  };
} // namespace greville

#endif
