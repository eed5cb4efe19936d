// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_implicit_scheme_h
#define greville_steps_implicit_scheme_h

#include <greville/parameters/names.h>
#include <greville/parameters/stage_parameters.h>
#include <greville/points/trial_step.h>

#include <string>

namespace greville
{
  /**
   * A row of the table of implicit schemes. From the displacement u of the grid
   * in a step, and from its velocity v and acceleration a at the start, follow
   * those at the end,
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
   * keeps the a' of the step before: where both alphas are not zero, that one
   * belongs to the time (alpha_f - alpha_m) dt before the end of its step, and
   * order 2 rests on it.
   *
   * Forces of contacts @f$f_c@f$ that come and go in a step would gain energy
   * if a had them. Where a occurs, a and a' are those of the other forces, and
   * contacts give impulses that belong to the end of the step
   * (@ref Kane1999 "Kane et al., 1999"; @ref Chen2013 "Chen et al., 2013"): to
   * v' they add @f$dt M^{-1} f_c@f$, and to u half of that times dt. In the
   * equation for u this is @f$f_c@f$ times contact_weight(). Such steps keep a
   * body at rest on another one, take energy from impacts, and are of order 1
   * where the force of a contact changes.
   */
  struct ImplicitScheme
  {
    double alpha_u = 0., alpha_v = 0., alpha_a = 0., gamma = 1.;
    double alpha_m = 0., alpha_f = 0.;
    /// Whether a is the a' of the step before.
    bool keeps_acceleration = false;
    /// No inertia: alpha_u = 0, and velocities stay zero.
    bool       is_static = false;
    StepStress stress    = StepStress::end;
    /// Loads are those at t + load_time dt.
    double load_time = 1.;
    /// What the velocity, which is held at walls, leaves out of the momentum of
    /// the points stays there: to take it would take energy, too.
    bool keeps_held_momentum = false;

    /**
     * Whether a occurs in the equations.
     */
    bool
    needs_acceleration() const
    {
      return alpha_a != 0. || alpha_m != 0. || gamma != 1.;
    }

    /**
     * Of forces of contacts in the equation over 1 - alpha_f.
     */
    double
    contact_weight() const
    {
      return needs_acceleration()
               ? 0.5 * (1. - alpha_m) * alpha_u / (1. - alpha_f)
               : 1.;
    }
  };

  /**
   * The scheme of a name:
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

#endif
