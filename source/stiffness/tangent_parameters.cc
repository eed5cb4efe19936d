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
      "Krylov method, preconditioned by p-multigrid: cg for symmetric "
      "tangents, fgmres for all tangents. auto: cg if all materials have "
      "symmetric tangents. Unit: none.");
  }
} // namespace greville
