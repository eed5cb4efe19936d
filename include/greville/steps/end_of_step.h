// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_end_of_step_h
#define greville_steps_end_of_step_h

#include <greville/steps/time_integrator.h>

#include <map>

namespace greville
{
  template <int dim>
  class Ensemble;

  template <int dim>
  class Simulation;

  /**
   * What TimeIntegrator::finish() changes of a state, to the bit.
   */
  template <int dim>
  class UnfinishedState
  {
  public:
    void
    take(const State<dim> &state, const Lag lag);

    void
    give_back(State<dim> &state);

  private:
    /**
     * What a kick changes of points, one after the other.
     */
    static void
    add_kicked(const MaterialPoints<dim> &points, std::vector<double> &values);

    static const double *
    set_kicked(MaterialPoints<dim> &points, const double *values);

    StateWithoutBodies<dim>          rest;
    std::uint64_t                    points_stamp = 0;
    std::vector<double>              kicked;
    std::vector<MaterialPoints<dim>> points; // of Lag::all
  };



  /**
   * As long as it lives, the states of an ensemble, or of a simulation, are
   * those that output shows: all of a state belongs to State::time. With
   * velocities at half steps, points have the second half of their kick by
   * then, with the forces of this time. The next step takes over the sums over
   * points that this needs.
   *
   * When it ends, all is as it was, to the bit, so that the following steps do
   * not depend on what has been written. No step and no checkpoint may be taken
   * meanwhile.
   *
   * Where the kick fails, as the next step will do as well, velocities stay
   * those of State::velocity_time, with a warning.
   */
  template <int dim>
  class EndOfStep
  {
  public:
    /**
     * Collective.
     */
    EndOfStep(Ensemble<dim> &ensemble);

    /**
     * The time that this takes is that of @p part, see StepLog.
     */
    EndOfStep(Simulation<dim> &simulation, const std::string &part = "output");

    EndOfStep(const EndOfStep &) = delete;
    EndOfStep &
    operator=(const EndOfStep &) = delete;

    /**
     * Collective.
     */
    ~EndOfStep();

  private:
    // That others delegate to: where one of them throws, the states are given
    // back.
    EndOfStep() = default;

    std::vector<Simulation<dim> *> simulations;
  };
} // namespace greville

#endif
