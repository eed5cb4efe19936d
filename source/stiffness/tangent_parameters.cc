// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/stiffness/tangent_parameters.h>

namespace greville
{
  using namespace dealii;

  TangentParameters::TangentParameters()
  {
    multigrid.coarsening            = "direct";
    multigrid.prolongation          = "ic0-l2";
    multigrid.restriction           = "transpose";
    multigrid.smoother              = "auto";
    multigrid.coarse_tolerance      = 1.;
    multigrid.coarse_preconditioner = "lattice";
    smoother.chebyshev_degree       = 3;
    smoother.chebyshev_range        = 8.;
  }



  void
  TangentParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Method",
                      method,
                      "The Krylov method, preconditioned by p-multigrid: cg is "
                      "for symmetric tangents, fgmres for all; auto takes cg "
                      "where all materials have symmetric ones.",
                      Patterns::Selection("auto|cg|fgmres"));
    prm.add_parameter(
      "Preconditioner",
      preconditioner,
      "p-multigrid: the cycle of 'Implicit p-multigrid'; smoother: its "
      "smoother "
      "alone; auto: the smoother alone where mass outweighs stiffness (up to a "
      "Courant number of about 3) and in strips one cell wide, else "
      "p-multigrid.",
      Patterns::Selection("auto|p-multigrid|smoother"));
    prm.add_parameter("Maximum iterations",
                      max_iterations,
                      "A step whose linear systems need more is cut. Unit: "
                      "iterations.",
                      Patterns::Integer(1));
    prm.add_parameter(
      "Reuse",
      reuse,
      "The set-up of a preconditioner serves following systems, too, until the "
      "iterations that they need beyond those of the first one add up to this "
      "number. 0: each system has its own. Unit: iterations.",
      Patterns::Integer(0));
  }
} // namespace greville
