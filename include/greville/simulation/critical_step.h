#ifndef greville_simulation_critical_step_h
#define greville_simulation_critical_step_h

#include <greville/simulation/grid_mass.h>

namespace greville
{
  /**
   * The largest step of central differences that is stable: 2 / omega with the
   * largest eigenvalue omega^2 of B K, where K is the stiffness matrix of the
   * bodies with the moduli of their materials. With the exact mass, B = M^-1.
   * Otherwise velocities that live on the points and come to the grid by an
   * approximate inverse A of M (lumped, FMPM) make a step of the grid's
   * velocity v <- v + dt A M a out of v <- v + dt a, and the characteristic
   * polynomials z^2 - (2 - k) z + 1 - k (1 - s) = 0   (USL: deformed by v + dt
   * a), z^2 - (2 - k s) z + 1 = 0             (USF, MUSL) of a mode with the
   * eigenvalues k of dt^2 A K and s <= 1 of A M are stable for k (2 - s) <= 4
   * and k s <= 4. So B = (2 - A M) A (USL),   B = A M A (USF, MUSL). Lumped
   * USL, with s near 0 for the highest frequency, has a step that is shorter by
   * up to the root of 2 than that of A K, lumped MUSL a longer one.
   *
   * With a viscosity mu, the damping ratio of the mode is xi = omega mu' / (2
   * (K
   * + 4 G / 3)) with mu' = 4 mu / 3, and the step 2 / omega (sqrt(1 + xi^2) -
   * xi) (T. Belytschko, W. K. Liu, B. Moran, Nonlinear finite elements for
   * continua and structures, section 6.2).
   *
   * The eigenvalue is that of a Lanczos method (at most @p max_iterations
   * steps, until it changes by less than 1 %). It comes from below, so a safety
   * factor belongs to the result. A linear B-spline at the rim of a body has a
   * mass that vanishes with the distance of the outermost point, but not so its
   * stiffness; for p = 1 functions with less than 1 % of the largest mass are
   * left out.
   *
   * Collective. Infinite where nothing is stiff. @p mass is that of the current
   * positions of @p bodies, with the product prepared unless it is consistent.
   * @p stress_update is USL, USF or MUSL; anything else asks for B = A.
   */
  template <int dim>
  double
  critical_step(GridMass<dim>                        &mass,
                PointTransfer<dim>                   &transfer,
                const std::vector<const Body<dim> *> &bodies,
                const Walls<dim>                     &walls,
                const std::string                    &stress_update,
                const unsigned int                    max_iterations = 30);
} // namespace greville

#endif
