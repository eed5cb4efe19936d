// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_common_step_h
#define greville_steps_common_step_h

#include <greville/steps/simulation.h>

namespace greville
{
  /**
   * One step of several simulations of the same times and stages, as long as
   * the shortest that one of them proposes. Where one rejects it, all try a
   * shorter one; where one fails, all go back.
   */
  template <int dim>
  class CommonStep
  {
  public:
    /**
     * The contacts act at the start of the step, or in implicit steps while it
     * is tried: they and the simulations are kept by reference.
     */
    explicit CommonStep(const std::vector<Simulation<dim> *> &simulations,
                        BodyContacts<dim> *contacts = nullptr);

    ~CommonStep();

    /**
     * Collective. Take the step, see Simulation::step().
     */
    void
    take();

  private:
    /// Load balance, and copies to go back to.
    void
    remember();

    /// Contacts act, and a stage may begin.
    void
    begin();

    /// Try steps until none is rejected.
    void
    try_steps();

    /// All parts at once, which contacts couple.
    void
    try_implicit();

    /// The length that the simulation at hand asks for; after a step of it has
    /// been rejected, once more.
    void
    propose();
    void
    propose_again(const StepRejected &rejection);

    /// All but the one that has @p failed, which may be null.
    void
    restore_others(const Simulation<dim> *failed);

    /// One after another is at hand.
    template <typename Action>
    void
    for_each(const Action &action);

    const std::vector<Simulation<dim> *> simulations;
    BodyContacts<dim> *const             contacts;
    std::unique_ptr<TrialContacts<dim>>  trial;

    unsigned int        at_hand = 0; // whose turn it is
    std::vector<double> proposed;    // s
    double              dt = 0.;     // of the step that is being tried, s
  };
} // namespace greville

#endif
