// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_step_size_h
#define greville_steps_step_size_h

#include <greville/steps/critical_step.h>
#include <greville/steps/discretization.h>

#include <functional>
#include <optional>

namespace greville
{
  /**
   * What critical steps depend on, for messages.
   */
  template <int dim>
  std::string
  describe_materials(const std::vector<Body<dim>> &bodies);



  /**
   * The step of the @p formula 'Time/Step' of the edge @p h of a cell (m) and
   * the order, s. Throws dealii::ExcMessage where it is not positive.
   */
  double
  evaluate_step(const Expression     &formula,
                const TimeParameters &parameters,
                const double          h,
                const unsigned int    degree);

  /**
   * Throw dealii::ExcMessage, which ends with the @p reason of the step, where
   * there would be too many steps in the time @p left (s), or they would be
   * lost to rounding.
   */
  void
  check_step(const double                        step,
             const double                        left,
             const TimeParameters               &parameters,
             const std::function<std::string()> &reason);



  /**
   * The length of explicit steps: that of 'Time/Step', or the smallest of the
   * CFL number times h / (c + |v|), of the safety factor times the critical
   * step, and, with consistent mass, of what lets points cross 0.6 / p cells.
   *
   * The critical step is estimated in the first step, then every so often,
   * where the stiffest point has got stiffer, and again for a step that has
   * been rejected. With consistent mass the smallest of three estimates counts:
   * the highest frequency depends on how the surface cuts the cells, and a
   * moving body meets the same cuts again and again.
   */
  template <int dim>
  class StepSize
  {
  public:
    /**
     * Parameters, discretization and log are kept by reference. Throws
     * dealii::ExcMessage for a wrong formula. What contacts hold is released
     * for estimates, as they may let go before the next one.
     */
    StepSize(const TimeParameters &parameters,
             Discretization<dim>  &discretization,
             StepLog              &log);

    /**
     * Collective. The next step, s: not beyond the end. Throws
     * dealii::ExcMessage where it is above the critical one and that is
     * refused, where there would be too many steps, and where an automatic one
     * is below 'Time/Smallest step' of the first one.
     */
    double
    propose(State<dim> &state, const StepScheme &scheme);

    /**
     * Collective. Whether the acceleration of a field and those of the two
     * steps before it, which the field has @p kept, show a mode that the step
     * @p dt is too long for. Undamped, a'' = -M^-1 K a, so their second
     * difference is a step of the power method, which sees an unstable mode
     * from its first steps on. Accelerations that change speeds by less than
     * 1e-8 of c + |v| in a step are noise and show nothing.
     */
    bool
    shows_faster_mode(const State<dim>      &state,
                      const FieldState<dim> &kept,
                      const GridField<dim>  &field,
                      const double           dt) const;

    /**
     * Keep @p acceleration for the next steps.
     */
    void
    remember(AccelerationHistory<dim> &history,
             const VectorField<dim>   &acceleration,
             const double              dt) const;

  private:
    bool
    is_estimate_due(const State<dim> &state) const;

    void
    estimate(State<dim> &state, const StepScheme &scheme);

    /**
     * The step of the formula, and the automatic one.
     */
    double
    given_step(const State<dim> &state, const bool has_estimate);

    double
    automatic_step(State<dim> &state) const;

    /**
     * The numbers that the step is made of, and describe_materials().
     */
    std::string
    what_sets_the_step(const State<dim> &state) const;

    const TimeParameters     &parameters;
    Discretization<dim>      &discretization;
    StepLog                  &log;
    std::optional<Expression> formula;
    CriticalStep<dim>         critical_step;
  };
} // namespace greville

#endif
