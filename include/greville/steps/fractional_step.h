// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_fractional_step_h
#define greville_steps_fractional_step_h

#include <greville/steps/discretization.h>
#include <greville/water/pore_water.h>

namespace greville
{
  /**
   * The pressure of pore water in explicit steps with lumped mass M: a
   * fractional step. With the acceleration a of effective stresses and loads,
   * the pressure p at the end of the step is that for which
   * @f{align*}{
   *   M a' &= M a - f(p), & v' &= v + dt' a', \\
   *   r(dt \, v', p) &= 0,
   * @f}
   * with the force f and the balance of water r of WaterPoints: the volume that
   * v' takes from the pores is compressed or flows away. All of the pressure is
   * implicit, so that neither the stiffness of water nor its flow bounds the
   * step, and no step is too short; waves of the soil alone have a critical
   * one. Of first order in time, like
   * @ref Zienkiewicz1980 "Zienkiewicz, Chang and Bettess, 1980".
   *
   * Friction walls belong to it, as the water feels what they stop: after M a'
   * = M a - f(p), each coefficient of v' at a wall that goes into it loses its
   * normal part, and of that along the wall at most mu times the normal part
   * that M a less the weight of as much water would have given. So friction is
   * that of the effective stress where the gradient of the function has its
   * weight, a third of a cell above the wall for degree 2, and of the weight
   * below that, for water at rest; the density is the mean one of all bodies.
   *
   * Newton's method solves for p, with the Schur complement C + dt dt' B^T M^-1
   * B, where B is the derivative of f and C that of r by p, by FGMRES with the
   * cycle of PoreWater for soil that has nothing but inertia.
   */
  template <int dim>
  class FractionalStep
  {
  public:
    /**
     * Collective. All are kept by reference.
     */
    FractionalStep(Discretization<dim>        &discretization,
                   const SimulationParameters &parameters);

    /**
     * Collective. The acceleration and the momentum of walls of the field get
     * what the pressure gives. @p step and @p velocity_step are dt and dt'.
     * Returns the linear iterations. Throws StepFailed where Newton's method or
     * a linear solver does not converge.
     */
    unsigned int
    add_pressure(const State<dim>             &state,
                 const dealii::Tensor<1, dim> &gravity,
                 const double                  step,
                 const double                  velocity_step,
                 GridField<dim>               &field);

    /// f(p) of the last pressure, N (2D: N / m); along r its sum is not zero.
    const VectorField<dim> &
    forces() const
    {
      return sum_of_forces;
    }

    /**
     * Collective. Give the points the pressure, surfaces in contact that at
     * their points, for the friction of the next step, and the state what has
     * become of the water. Before they move.
     */
    void
    advance(State<dim> &state) const;

  private:
    /**
     * Let friction walls make moved out of displacement, and a direction of
     * the latter one of the former.
     */
    void
    slide(VectorField<dim> *direction = nullptr);

    /**
     * Give the field what friction walls did in the last slide().
     */
    void
    take_impulses(const double    step,
                  const double    velocity_step,
                  GridField<dim> &field);

    /// change = M^-1 force, with what is held zero.
    void
    accelerate(GridField<dim> &field, const VectorField<dim> &force);

    const Discretization<dim>  &discretization;
    const SimulationParameters &parameters;
    PoreWater<dim>              water;
    std::uint64_t               stamp = 0; // of points that water knows

    // The displacement before friction walls act, that without the pressure,
    // and that after all.
    VectorField<dim> displacement, without_water, moved;
    VectorField<dim> force, sum_of_forces, change;
    VectorType       pressure, residual, correction;
    double           friction_work = 0.;
  };
} // namespace greville

#endif
