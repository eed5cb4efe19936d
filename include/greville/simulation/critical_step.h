#ifndef greville_simulation_critical_step_h
#define greville_simulation_critical_step_h

#include <greville/simulation/grid_mass.h>

namespace greville
{
  /**
   * The largest step of central differences that is stable: 2 / omega with the
   * largest eigenvalue omega^2 of M^-1 K, the mass matrix of the simulation and
   * the stiffness matrix of its bodies with the moduli K and G of their
   * materials. With a viscosity mu, the damping ratio of that mode is
   * xi = omega mu' / (2 (K + 4 G / 3)) with mu' = 4 mu / 3, and the step
   *   dt = 2 / omega (sqrt(1 + xi^2) - xi)
   * (T. Belytschko, W. K. Liu, B. Moran, Nonlinear finite elements for continua
   * and structures, section 6.2).
   *
   * The eigenvalue is that of a Lanczos method in the inner product of M (at
   * most @p max_iterations steps, until it changes by less than 1 %). It comes
   * from below, so a safety factor belongs to the result. A linear B-spline at
   * the rim of a body has a mass that vanishes with the distance of the
   * outermost point, but not so its stiffness; for p = 1 functions with less
   * than 1 % of the largest mass are left out.
   *
   * Collective. Infinite where nothing is stiff. @p mass is that of the
   * current positions of @p bodies.
   */
  template <int dim>
  double
  critical_step(GridMass<dim>                        &mass,
                PointTransfer<dim>                   &transfer,
                const std::vector<const Body<dim> *> &bodies,
                const Walls<dim>                     &walls,
                const unsigned int                    max_iterations = 30);
} // namespace greville

#endif
