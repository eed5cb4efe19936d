// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// The results of stress_jumps() for each point of the bodies of a state, in
  /// their order, Pa.
  struct StressJumps
  {
    std::vector<double> of_points;
    std::vector<double> developed;
  };



  /**
   * Collective. Return the differences between stresses and a spline. Those of
   * points are @f$ |\sigma_p - P\sigma(x_p)| @f$, where P is the projection by
   * the mass matrix without walls, @f$ M c = \sum_p m_p N \sigma_p @f$.
   *
   * The parts of a divided point begin with equal stresses, which are jumps
   * that smaller cells do not reduce. For a part of a point, the developed
   * difference is
   * @f[ |\bar\sigma - \overline{P\sigma} + s (\sigma_p - \bar\sigma -
   * P\sigma(x_p) + \overline{P\sigma})| @f]
   * with means over all parts of the point. s is the root mean square of
   * @f$ \sigma_p - \bar\sigma @f$ over that of @f$ P\sigma(x_p) -
   * \overline{P\sigma} @f$, and at most 1: 0 for equal stresses, 1 if parts
   * differ as much as the spline. If parts have been divided again, the means
   * over their parts take the place of their values.
   *
   * Throws StepFailed if the solver of the mass does not converge.
   */
  template <int dim>
  StressJumps
  stress_jumps(State<dim>                 &state,
               Discretization<dim>        &discretization,
               const SimulationParameters &parameters);
} // namespace greville
