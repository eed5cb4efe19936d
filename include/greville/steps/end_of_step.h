// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_end_of_step_h
#define greville_steps_end_of_step_h

#include <greville/steps/state.h>

namespace greville
{
  template <int dim>
  class Ensemble;

  template <int dim>
  class Simulation;

  /**
   * As long as it lives, the states of an ensemble, or of a simulation, are
   * those that files of fields show, and the last row of a stage: all of a
   * state belongs to State::time. With velocities at half steps, points have
   * the second half of their kick by then, with the forces of this time.
   *
   * When it ends, all is as it was, to the bit, so that the following steps do
   * not depend on what has been written: it keeps a copy of the states. No step
   * and no checkpoint may be taken meanwhile.
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

    ~EndOfStep();

  private:
    // That others delegate to: where one of them throws, the states are given
    // back.
    EndOfStep() = default;

    /**
     * Collective.
     */
    void
    add(Simulation<dim> &simulation, const std::string &part);

    /**
     * What a kick may change of a state: of points in bodies their velocity and
     * the numbers behind those of the material, and with USF, which deforms
     * them before it finds forces, those of the material, too.
     */
    struct Before
    {
      explicit Before(Simulation<dim> &simulation);

      void
      restore();

      Simulation<dim>                 *simulation;
      bool                             deforms;
      StateWithoutBodies<dim>          rest;
      std::vector<Surface<dim>>        surfaces;
      std::vector<std::vector<double>> numbers; // for each body
    };

    std::vector<Before> before;
  };
} // namespace greville

#endif
