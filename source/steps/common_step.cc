// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/common_step.h>
#include <greville/steps/coupled_steps.h>
#include <greville/steps/trial_contacts.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int most_rejections = 20;
  } // namespace



  template <int dim>
  CommonStep<dim>::CommonStep(const std::vector<Simulation<dim> *> &simulations,
                              BodyContacts<dim>                    *contacts)
    : simulations(simulations)
    , contacts(contacts)
    , proposed(simulations.size())
  {}



  template <int dim>
  CommonStep<dim>::~CommonStep() = default;



  template <int dim>
  template <typename Action>
  void
  CommonStep<dim>::for_each(const Action &action)
  {
    for (current_simulation = 0; current_simulation < simulations.size();
         ++current_simulation)
      action(*simulations[current_simulation]);
    current_simulation = simulations.size() - 1;
  }



  template <int dim>
  void
  CommonStep<dim>::remember()
  {
    bool is_shared = false;
    for_each([&](Simulation<dim> &simulation) {
      is_shared = simulation.change_cells() || is_shared;
    });
    for_each([&](Simulation<dim> &simulation) {
      simulation.remember();
      // Redistribution of one simulation's cells has replaced its stored
      // state: store all states, so that they belong to the same step.
      if (is_shared)
        simulation.last_good.take(simulation.current);
    });
  }



  template <int dim>
  void
  CommonStep<dim>::begin()
  {
    // Contact forces are also needed at the end of a stage.
    if (contacts)
      contacts->act();
    const bool enters_stage = simulations.front()->is_stage_finished();
    for_each([&](Simulation<dim> &simulation) {
      simulation.begin_step();
      propose();
    });
    // Store the states of all simulations, so that they can only return to the
    // start of the stage together.
    if (enters_stage)
      for_each([](Simulation<dim> &simulation) {
        simulation.last_good.take(simulation.current);
      });
  }



  template <int dim>
  void
  CommonStep<dim>::propose()
  {
    Simulation<dim> &simulation = *simulations[current_simulation];
    // The proposed step depends only on data that are equal on all processes.
    try
      {
        proposed[current_simulation] =
          simulation.integrator->propose_step(simulation.current);
      }
    catch (const ExcMessage &error)
      {
        AssertThrow(false, ErrorOnAll(message_of(error)));
      }
  }



  template <int dim>
  void
  CommonStep<dim>::propose_again(const StepRejected &rejection)
  {
    State<dim> &state = simulations[current_simulation]->current;
    ++state.n_all_rejections;
    if (state.n_rejections == most_rejections)
      throw StepFailed("the step has been shortened " +
                       std::to_string(most_rejections) + " times, and still " +
                       rejection.what());
    ++state.n_rejections;
    propose();
    simulations[current_simulation]->log.cuts.push_back(
      "step " + std::to_string(state.n_steps + 1) +
      " from t = " + text_of(state.time) + " s is cut from " + text_of(dt) +
      " to " + text_of(*std::min_element(proposed.begin(), proposed.end())) +
      " s: " + rejection.what());
  }



  template <int dim>
  void
  CommonStep<dim>::try_steps()
  {
    for (bool is_rejected = true; is_rejected;)
      {
        dt = *std::min_element(proposed.begin(), proposed.end());
        if (contacts && !simulations.front()->is_implicit() &&
            simulations.front()->parameters.time.step.empty())
          dt = contacts->bounded_step(dt);
        try
          {
            current_simulation = 0;
            if (contacts && simulations.front()->is_implicit())
              try_implicit();
            else
              for_each([&](Simulation<dim> &simulation) {
                simulation.integrator->try_step(simulation.current, dt);
              });
            is_rejected = false;
          }
        catch (const StepRejected &rejection)
          {
            propose_again(rejection);
          }
      }
  }



  template <int dim>
  void
  CommonStep<dim>::try_implicit()
  {
    std::vector<typename CoupledSteps<dim>::Part> coupled;
    std::vector<ImplicitSteps<dim> *>             steps;
    for (Simulation<dim> *simulation : simulations)
      {
        steps.push_back(simulation->integrator->implicit_steps());
        if (!steps.back())
          throw StepFailed(
            "'Scheme/Stress update' = " +
              simulation->parameters.scheme.stress_update +
              " does not support 'Simulation/Contacts': contacts act in "
              "explicit steps and in ImplicitSteps",
            false);
        coupled.push_back({steps.back(), &simulation->current});
      }
    auto tried = std::make_unique<TrialContacts<dim>>(*contacts, steps, dt);
    CoupledSteps<dim>(coupled, tried.get(), dt).try_step();
    trial = std::move(tried);
  }



  template <int dim>
  void
  CommonStep<dim>::take()
  {
    dt                 = simulations.front()->current.step;
    current_simulation = 0;
    try
      {
        remember();
        begin();
        try_steps();
        if (trial)
          trial->accept();
        else if (contacts)
          contacts->begin_step(dt);
        for_each(
          [&](Simulation<dim> &simulation) { simulation.take_step(dt); });
        if (trial)
          contacts->end_step();
        else if (contacts)
          contacts->check_gains();
      }
    catch (const StepFailed &failure)
      {
        Simulation<dim> *const failed = simulations[current_simulation];
        restore_others(failed);
        failed->go_back(failure, dt);
      }
    catch (const ExcMessage &)
      {
        restore_others(nullptr);
        throw;
      }
    for_each([](Simulation<dim> &simulation) { simulation.end_step(); });
  }



  GREVILLE_INSTANTIATE_CLASS(CommonStep);
} // namespace greville
