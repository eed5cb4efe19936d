// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/names.h>
#include <greville/parameters/stage_parameters.h>
#include <greville/points/trial_step.h>

#include <string>

namespace greville
{
  /**
   * The coefficients of an implicit scheme. The displacement u of the grid in a
   * step, and its velocity v and acceleration a at the start, give the
   * acceleration and velocity at the end,
   * @f{align*}{
   *   a' &= (\alpha_u u / dt - \alpha_v v) / dt - \alpha_a a, \\
   *   v' &= v + dt ((1 - \gamma) a + \gamma a'),
   * @f}
   * and u solves
   * @f[
   *   M ((1 - \alpha_m) a' + \alpha_m a) + (1 - \alpha_f) (f(u) - F') +
   *   \alpha_f (f - F) = 0
   * @f]
   * with the internal forces f and the loads F at the start and F' at the end.
   * The acceleration at the start satisfies M a = F - f, unless the scheme
   * keeps the a' of the previous step. If both alphas are not zero, a' belongs
   * to the time (alpha_f - alpha_m) dt before the end of its step; second order
   * depends on this.
   *
   * If a included contact forces @f$f_c@f$ that appear or vanish in a step,
   * energy would grow. In schemes that contain a, the accelerations a and a'
   * therefore include only the other forces, and contacts act as impulses at
   * the end of the step (@ref Kane1999 "Kane et al., 1999"; @ref Chen2013 "Chen
   * et al., 2013"). They add @f$dt M^{-1} f_c@f$ to v', and half of this times
   * dt to u. The equation for u then contains @f$f_c@f$ times contact_weight().
   * These steps keep a body at rest on another one, dissipate energy in
   * impacts, and are of first order if contact forces change.
   */
  struct ImplicitScheme
  {
    double alpha_u = 0., alpha_v = 0., alpha_a = 0., gamma = 1.;
    double alpha_m = 0., alpha_f = 0.;
    /// True if a is the a' of the previous step.
    bool keeps_acceleration = false;
    /// True without inertia: alpha_u = 0, and velocities remain zero.
    bool       is_static = false;
    StepStress stress    = StepStress::end;
    /// Loads belong to the time t + load_time dt.
    double load_time = 1.;
    /// True if points keep momentum that the constrained velocity does not
    /// represent. Removing it would also dissipate energy.
    bool keeps_constrained_momentum = false;

    /// Return whether the acceleration a occurs in the equations.
    bool
    needs_acceleration() const
    {
      return alpha_a != 0. || alpha_m != 0. || gamma != 1.;
    }

    /// Return the weight of contact forces in the equation, divided by 1 -
    /// alpha_f.
    double
    contact_weight() const
    {
      return needs_acceleration()
               ? 0.5 * (1. - alpha_m) * alpha_u / (1. - alpha_f)
               : 1.;
    }
  };

  /**
   * Return the scheme of a name:
   * - "quasi-static": no inertia,
   * - "backward-euler": of first order, damps,
   * - "newmark": with beta and gamma; 1/4, 1/2 is the trapezoidal rule
   *   (@ref Newmark1959 "Newmark, 1959"),
   * - "generalized-alpha": with the spectral radius rho of the highest modes
   *   (@ref Chung1993 "Chung and Hulbert, 1993"),
   * - "implicit-midpoint": with the energy-consistent stress of TrialStep.
   */
  ImplicitScheme
  make_implicit_scheme(const std::string        &name,
                       const ImplicitParameters &parameters);
} // namespace greville
