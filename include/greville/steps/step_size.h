// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/critical_step.h>
#include <greville/steps/discretization.h>

#include <functional>
#include <optional>

namespace greville
{
  /// Return the material data on which critical steps depend, for messages.
  template <int dim>
  std::string
  describe_materials(const std::vector<Body<dim>> &bodies);



  /// Return the step by the @p formula 'Time/Step' for the cell size @p h (m)
  /// and the order, s. Throws dealii::ExcMessage if it is not positive.
  double
  evaluate_step(const Expression     &formula,
                const TimeParameters &parameters,
                const double          h,
                const unsigned int    degree);

  /// Throw dealii::ExcMessage, which ends with the @p reason of the step, if
  /// the time @p left (s) would take too many steps, or if steps would be lost
  /// to rounding.
  void
  check_step(const double                        step,
             const double                        left,
             const TimeParameters               &parameters,
             const std::function<std::string()> &reason);



  /**
   * The length of explicit steps: the value of 'Time/Step', or automatically
   * the smallest of the CFL number times h / (c + |v|), the safety factor times
   * the critical step, and, with consistent mass, the step in which points
   * cross 0.6 / p cells.
   *
   * The critical step is estimated in the first step, then at intervals, if the
   * stiffest point has become stiffer, and again for a rejected step. With
   * consistent mass, the smallest of the last three estimates is used: the
   * highest frequency depends on how the surface cuts the cells, and a moving
   * body repeats similar cuts.
   */
  template <int dim>
  class StepSize
  {
  public:
    /// Parameters, discretization and log are kept by reference. Throws
    /// dealii::ExcMessage for an invalid formula. Constraints of contacts are
    /// released for estimates, since contacts may open before the next one.
    StepSize(const TimeParameters &parameters,
             Discretization<dim>  &discretization,
             StepLog              &log);

    /// Collective. Return the next step, s, not beyond the end. Throws
    /// dealii::ExcMessage if it is above the critical step and this is refused,
    /// if there would be too many steps, and if an automatic step is below
    /// TimeParameters::smallest_step times the first one.
    double
    propose(State<dim> &state, const StepScheme &scheme);

    /// Collective. Return whether the acceleration of a field and the
    /// accelerations of the two previous steps, which are in @p kept, show a
    /// mode for which the step @p dt is too long. Undamped, a'' = -M^-1 K a, so
    /// their second difference is a step of the power method. It detects an
    /// unstable mode from its first steps on. Accelerations that change speeds
    /// by less than 1e-8 of c + |v| in a step are ignored as noise.
    bool
    has_unstable_mode(const State<dim>      &state,
                      const FieldState<dim> &kept,
                      const GridField<dim>  &field,
                      const double           dt) const;

    /// Store @p acceleration for the next steps.
    void
    remember(AccelerationHistory<dim> &history,
             const VectorField<dim>   &acceleration,
             const double              dt) const;

  private:
    bool
    is_estimate_due(const State<dim> &state) const;

    void
    estimate(State<dim> &state, const StepScheme &scheme);

    /// Return the step of the formula, and the automatic one.
    double
    given_step(const State<dim> &state, const bool has_estimate);

    double
    automatic_step(State<dim> &state) const;

    /// Return the numbers that determine the step, and describe_materials().
    std::string
    describe_step(const State<dim> &state) const;

    const TimeParameters     &parameters;
    Discretization<dim>      &discretization;
    StepLog                  &log;
    std::optional<Expression> formula;
  };
} // namespace greville
