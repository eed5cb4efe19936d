// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/steps/ensemble.h>

#include <algorithm>
#include <sstream>

namespace greville
{
  using namespace dealii;

  template <int dim>
  EndOfStep<dim>::EndOfStep(Ensemble<dim> &ensemble)
    : EndOfStep()
  {
    ensemble.find_contact();
    for (unsigned int k = 0; k < ensemble.n_parts(); ++k)
      add(ensemble.part(k), "output");
  }



  template <int dim>
  EndOfStep<dim>::EndOfStep(Simulation<dim>   &simulation,
                            const std::string &part)
    : EndOfStep()
  {
    add(simulation, part);
  }



  template <int dim>
  EndOfStep<dim>::~EndOfStep()
  {
    for (auto &[simulation, state] : before)
      {
        simulation->current = std::move(state);
        // The next step sums up mass, momentum and force together, as without
        // this: other kernels may round in another way.
        simulation->current.points_have_changed();
      }
  }



  template <int dim>
  void
  EndOfStep<dim>::add(Simulation<dim> &simulation, const std::string &part)
  {
    State<dim> &state = simulation.current;
    StepLog    &log   = simulation.log;
    if (!simulation.rows_lag())
      return;
    const PartTimer timer(log, part);
    const auto      seconds = log.seconds;
    before.emplace_back(&simulation, state);
    auto &fields = simulation.discretization.fields();
    for (GridField<dim> &field : fields)
      field.mass->begin_trial();
    const auto end_trial = [&]() {
      for (GridField<dim> &field : fields)
        field.mass->end_trial();
    };
    std::string problem;
    try
      {
        simulation.integrator->finish(state);
      }
    catch (const StepFailed &failure)
      {
        problem = without_stop(failure.what());
      }
    catch (const ExcMessage &)
      {
        end_trial();
        throw;
      }
    end_trial();
    // Of these tasks, steps have not taken more.
    for (auto &[task, sum] : log.seconds)
      {
        const auto until = seconds.find(task);
        sum              = until == seconds.end() ? 0. : until->second;
      }
    if (problem.empty())
      return;
    state = std::move(before.back().second);
    before.pop_back();
    std::ostringstream message;
    message << "Velocities at t = " << state.time
            << " s are those of t = " << state.velocity_time
            << " s, since the kick to the end of the step has failed: "
            << problem << ".";
    // The guard and files may ask for the same state.
    if (std::count(log.warnings.begin(), log.warnings.end(), message.str()) ==
        0)
      log.warnings.push_back(message.str());
  }



  template class EndOfStep<2>;
  template class EndOfStep<3>;
} // namespace greville
