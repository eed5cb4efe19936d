// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/parameters.h>
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
    add_parameter(prm, "Method", method, Patterns::Selection("auto|cg|fgmres"))(
      "The Krylov method, preconditioned by p-multigrid: cg is for symmetric "
      "tangents, fgmres for all; auto takes cg where all materials have "
      "symmetric ones.");
    add_parameter(prm,
                  "Preconditioner",
                  preconditioner,
                  Patterns::Selection("auto|p-multigrid|smoother"))(
      "p-multigrid: the cycle of 'Implicit p-multigrid'; smoother: its "
      "smoother alone; auto: the smoother alone where mass outweighs stiffness "
      "(up to a Courant number of about 3) and in strips one cell wide, else "
      "p-multigrid.");
    add_parameter(prm,
                  "Maximum iterations",
                  max_iterations,
                  Patterns::Integer(1))(
      "A step whose linear systems need more is cut. Unit: iterations.");
    add_parameter(prm, "Reuse", reuse, Patterns::Integer(0))(
      "The set-up of a preconditioner serves following systems, too, until the "
      "iterations that they need beyond those of the first one add up to this "
      "number. 0: each system has its own. Unit: iterations.");
  }
} // namespace greville
