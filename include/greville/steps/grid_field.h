// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/grid_mass.h>

namespace greville
{
  /**
   * The velocity field of a grid. Bodies on a grid move together if they touch.
   * FieldState contains the values that steps pass on.
   *
   * The sums are computed by Discretization::sum() over the points of the
   * bodies, with the functions N_i of the grid: mass sum_p m_p N_i, momentum
   * sum_p m_p v_p N_i, and force, see PointTransfer. Explicit steps then solve
   * M v = P and M a = F with the mass M and its constraints, and find the new
   * velocity v' = v + dt' a, which contact may change.
   */
  template <int dim>
  struct GridField
  {
    /// The points of the bodies.
    std::vector<const MaterialPoints<dim> *> points;

    std::unique_ptr<GridMass<dim>> mass;
    /// The constraints of contacts in the current step.
    Constraints<dim> constraints;

    /// The sums of mass, kg (2D: kg / m), momentum, kg m / s, and force, N.
    VectorType       lumped_mass;
    VectorField<dim> momentum, force;
    /// For each surface of State::surfaces, the force of its load, N.
    std::vector<VectorField<dim>> surface_forces;

    /// The velocity v, the acceleration a, and v' of explicit steps, m / s,
    /// allocated by CentralDifferences.
    VectorField<dim> velocity, acceleration, new_velocity;
    /// The momentum that walls give to the bodies in the step, the share of
    /// this process, kg m / s.
    WallSums<dim> momentum_of_walls;
  };
} // namespace greville
