// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/simulation.h>

namespace greville
{
  /// A common step of several simulations with the same times and stages. Its
  /// length is the shortest step that any simulation proposes. If one rejects
  /// the step, all try a shorter step; if one fails, all are restored.
  template <int dim>
  class CommonStep
  {
  public:
    /// Contacts act at the start of an explicit step, or in the trials of an
    /// implicit one. They and the simulations are kept by reference.
    explicit CommonStep(const std::vector<Simulation<dim> *> &simulations,
                        BodyContacts<dim> *contacts = nullptr);

    ~CommonStep();

    /// Collective. Take the step, see Simulation::step().
    void
    take();

  private:
    /// Balance the load, and copy the states for restoring them.
    void
    remember();

    /// Let contacts act, and begin a stage if due.
    void
    begin();

    /// Try steps until none is rejected.
    void
    try_steps();

    /// Try an implicit step of all parts together, coupled by contacts.
    void
    try_implicit();

    /// Find the proposed step, also after a rejection.
    void
    propose();
    void
    propose_again(const StepRejected &rejection);

    /// Restore all simulations except @p failed, which may be null.
    void
    restore_others(const Simulation<dim> *failed)
    {
      for (Simulation<dim> *simulation : simulations)
        if (simulation != failed)
          simulation->restore();
    }

    /// Call an action for each simulation as the current one.
    template <typename Action>
    void
    for_each(const Action &action);

    const std::vector<Simulation<dim> *> simulations;
    BodyContacts<dim> *const             contacts;
    std::unique_ptr<TrialContacts<dim>>  trial;

    unsigned int current_simulation = 0; // number of the current simulation
    std::vector<double> proposed;        // s
    double              dt = 0.;         // of the trial, s
  };
} // namespace greville
