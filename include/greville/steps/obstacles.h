// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_obstacles_h
#define greville_steps_obstacles_h

#include <greville/points/body.h>
#include <greville/points/point_transfer.h>
#include <greville/steps/grid_mass.h>

namespace greville
{
  /**
   * Bodies with an imposed velocity, as the others meet them. They add neither
   * mass nor force to the grid. Functions N_i of which they fill a share
   *   s_i = sum_p V_p N_i(x_p) / int N_i dx
   * that is not negligible have the normal n_i = sum_p V_p grad N_i(x_p), out
   * of the obstacle. The other bodies, with mass m_i, momentum P_i and force
   * f_i there, touch it where the velocity V of the obstacle would be an
   * impulse away from it, (m_i V - P_i - dt' f_i) . n_i >= 0, and where n_i is
   * negligible: inside of it. Coefficients that touch are held at V, of all
   * components, by GridMass::hold(). So the law of contact is: inelastic,
   * without slip, and no tension.
   *
   * (@ref Bardenhagen2000 "Bardenhagen, Brackbill and Sulsky, 2000", has
   * the condition and the normals.)
   */
  template <int dim>
  class Obstacles
  {
  public:
    /**
     * The space is kept by reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Collective. The bodies as they are, for a step of the velocity from
     * @p begin to @p end.
     */
    void
    update(const std::vector<Body<dim>> &bodies,
           PointTransfer<dim>           &transfer,
           const double                  begin,
           const double                  end);

    /**
     * Collective. Hold what touches: @p mass, @p momentum and @p force are
     * those of the other bodies; the force may be left out.
     */
    void
    touch(GridMass<dim>                &grid_mass,
          const VectorType             &mass,
          const VectorField<dim>       &momentum,
          const VectorField<dim>       *force,
          const dealii::Tensor<1, dim> &gravity);

    /**
     * Set coefficients that touch, where walls do not hold them: to the
     * velocity of the obstacle at the start or the end of the step.
     */
    void
    set_velocity(VectorField<dim> &velocity, const bool at_end) const;

    /**
     * The acceleration that leads from @p velocity to that of the end.
     */
    void
    set_acceleration(VectorField<dim>       &acceleration,
                     const VectorField<dim> &velocity) const;

  private:
    const SplineSpace<dim> *spline_space = nullptr;
    double                  step         = 0.;

    // By owned function: integral over the support, share, normal times its
    // size, and velocities.
    std::vector<double>                                integrals, share;
    std::array<std::vector<double>, dim>               normal;
    std::array<std::vector<dealii::Tensor<1, dim>>, 2> velocities;
    std::vector<unsigned char>                         touching;
    MaterialPoints<dim>                                points;
    VectorType                                         volume;
    VectorField<dim>                                   momentum, gradient;
  };
} // namespace greville

#endif
