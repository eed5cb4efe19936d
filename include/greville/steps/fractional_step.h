// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>
#include <greville/water/pore_water.h>

namespace greville
{
  /**
   * The pressure of pore water in explicit steps with lumped mass M, by a
   * fractional step. With the acceleration a of effective stresses and loads,
   * the pressure p at the end of the step solves
   * @f{align*}{
   *   M a' &= M a - f(p), & v' &= v + dt' a', \\
   *   r(dt \, v', p) &= 0,
   * @f}
   * with the force f and the balance of water r of WaterPoints: the decrease of
   * the pore volume by v' is balanced by compression of the water and outflow.
   * The pressure is fully implicit, so that neither the stiffness of water nor
   * its flow limits the step, and steps may be arbitrarily short. Only waves of
   * the soil have a critical step. The method is of first order in time, like
   * @ref Zienkiewicz1980 "Zienkiewicz, Chang and Bettess, 1980".
   *
   * Friction walls are included, since they affect the water. After M a' = M a
   * - f(p), each coefficient of v' that moves into a wall loses its normal
   * part. It also loses at most mu times N of its tangential part. N is the
   * normal part that M a, less the weight of the same volume of water, would
   * cause. For water at rest, friction therefore corresponds to the effective
   * stress at the centre of the function's gradient, a third of a cell above
   * the wall for degree 2, plus the submerged weight below it, with the mean
   * density of all bodies.
   *
   * Newton's method solves for p, with the Schur complement C + dt dt' B^T M^-1
   * B, where B is the derivative of f and C the derivative of r by p, by FGMRES
   * with the cycle of PoreWater for soil with inertia only.
   */
  template <int dim>
  class FractionalStep
  {
  public:
    /// Collective. All arguments are kept by reference.
    FractionalStep(Discretization<dim>        &discretization,
                   const SimulationParameters &parameters);

    /// Collective. Add the effect of the pressure to the acceleration and the
    /// momentum of walls of the field. @p step and @p velocity_step are dt and
    /// dt'. Returns the number of linear iterations. Throws StepFailed if
    /// Newton's method or a linear solver does not converge.
    unsigned int
    add_pressure(const State<dim>             &state,
                 const dealii::Tensor<1, dim> &gravity,
                 const double                  step,
                 const double                  velocity_step,
                 GridField<dim>               &field);

    /// Return f(p) of the last pressure, N (2D: N / m). In axisymmetric grids,
    /// its sum along r is not zero.
    const VectorField<dim> &
    forces() const
    {
      return sum_of_forces;
    }

    /// Collective. Store the pressure in the points, in contact surfaces for
    /// the friction of the next step, and the volumes of water in the state. To
    /// be called before points move.
    void
    advance(State<dim> &state) const;

  private:
    /// Set the displacement in @p step without the pressure. @p kick is dt dt'.
    void
    begin(const State<dim>             &state,
          const dealii::Tensor<1, dim> &gravity,
          const double                  step,
          const double                  kick,
          GridField<dim>               &field);

    /// Compute the member `moved` from `displacement` by friction walls. Also
    /// apply its derivative to a @p direction of displacement.
    void
    slide(VectorField<dim> *direction = nullptr);

    /// Add the impulses of friction walls in the last slide() to the field.
    void
    take_impulses(const double    step,
                  const double    velocity_step,
                  GridField<dim> &field);

    /// Compute change = M^-1 force, with zeros at constrained coefficients.
    void
    accelerate(GridField<dim> &field, const VectorField<dim> &force);

    const Discretization<dim>  &discretization;
    const SimulationParameters &parameters;
    PoreWater<dim>              water;
    std::uint64_t               points_version = 0; // of the points in water

    // The displacement before friction walls act, the displacement without the
    // pressure, and the final one.
    VectorField<dim> displacement, without_water, moved;
    VectorField<dim> force, sum_of_forces, change;
    VectorType       pressure, residual, correction;
    double           friction_work = 0.;
  };
} // namespace greville
