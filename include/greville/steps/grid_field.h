// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_grid_field_h
#define greville_steps_grid_field_h

#include <greville/steps/grid_mass.h>

namespace greville
{
  /**
   * The velocity field of a grid: the bodies on it move together if they touch.
   * FieldState has the values that steps hand on.
   *
   * The sums are those of Discretization::sum() over the points of the bodies,
   * with the functions N_i of the grid: mass sum_p m_p N_i, momentum sum_p m_p
   * v_p N_i, and force, see PointTransfer. Explicit steps then solve
   * M v = P and M a = F with the mass M and its constraints, and find the new
   * velocity v' = v + dt' a, which contact may change.
   */
  template <int dim>
  struct GridField
  {
    /// The points of the bodies.
    std::vector<const MaterialPoints<dim> *> points;

    std::unique_ptr<GridMass<dim>> mass;
    /// What contacts constrain in the step at hand.
    Constraints<dim> constraints;

    /// kg (2D: kg / m), kg m / s, N.
    VectorType       lumped_mass;
    VectorField<dim> momentum, force;
    /// The force of the load on each of State::surfaces, N.
    std::vector<VectorField<dim>> surface_forces;

    /// Of explicit steps, with room for them after CentralDifferences has been
    /// made: v and a, and v', m / s.
    VectorField<dim> velocity, acceleration, new_velocity;
    /// The momentum that walls give to the bodies in the step, the share of
    /// this process, kg m / s.
    WallSums<dim> momentum_of_walls;
  };
} // namespace greville

#endif
