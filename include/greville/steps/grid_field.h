// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_grid_field_h
#define greville_steps_grid_field_h

#include <greville/steps/consistent_mass.h>

namespace greville
{
  /**
   * A velocity field of the grid: that of some bodies, which move together
   * where they touch. Bodies of other fields do not see it, but for a Contact.
   * What steps hand on of it is a FieldState.
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
    /// Numbers of the bodies in State::bodies, and of their surfaces in
    /// State::surfaces.
    std::vector<unsigned int> bodies, surfaces;
    /// Points of the bodies at the last sums.
    std::vector<const MaterialPoints<dim> *> points;

    std::unique_ptr<GridMass<dim>> mass;
    /// The mass as what it is; null with other masses.
    ConsistentMass<dim> *consistent = nullptr;
    /// What contacts constrain in the step at hand.
    Constraints<dim> constraints;

    /// kg (2D: kg / m), kg m / s, N.
    VectorType       lumped_mass;
    VectorField<dim> momentum, force;
    /// What the load on each of the surfaces gave to the force, N.
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
