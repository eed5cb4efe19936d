// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/parameters.h>
#include <greville/stiffness/tangent_parameters.h>

namespace greville
{
  using namespace dealii;

  TangentParameters::TangentParameters()
  {
    multigrid.coarsening            = Coarsening::lattice;
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
    add_choice<Method>(prm,
                       "Method",
                       method,
                       {{Method::automatic, "auto"},
                        {Method::cg, "cg"},
                        {Method::fgmres, "fgmres"}})(
      "Krylov method, preconditioned by p-multigrid: cg for symmetric "
      "tangents, fgmres for all tangents. auto: cg if all materials have "
      "symmetric tangents. Unit: none.");
    add_choice<Coarsening>(prm,
                           "Levels",
                           multigrid.coarsening,
                           {{Coarsening::lattice, "lattice"},
                            {Coarsening::hp, "hp"},
                            {Coarsening::direct, "orders"}})(
      "The levels of the cycle: splines of the order of the grid on lattices "
      "of 1, 2, 4, ... times the cell size (lattice), the same with order 1 on "
      "the coarsest lattice (hp), or the order of the grid and order 1 on the "
      "grid, and lattices of order 1 (orders). Unit: none.");
  }
} // namespace greville
