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

    /**
     * Collective. Give the points the pressure, and the state what has become
     * of the water. Before they move.
     */
    void
    advance(State<dim> &state) const;

  private:
    /// change = M^-1 force, with what is held zero.
    void
    accelerate(GridField<dim> &field, const VectorField<dim> &force);

    const Discretization<dim>  &discretization;
    const SimulationParameters &parameters;
    PoreWater<dim>              water;
    std::uint64_t               stamp = 0; // of points that water knows

    VectorField<dim> displacement, force, sum_of_forces, change;
    VectorType       pressure, residual, correction;
  };
} // namespace greville

#endif
