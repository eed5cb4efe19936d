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



  namespace
  {
    /**
     * Let @p action see the numbers of points that a kick may change: all
     * behind the position where the scheme @p deforms points before it.
     */
    template <typename Points, typename Action>
    void
    for_each_kicked(Points &points, const bool deforms, const Action &action)
    {
      const auto        &layout   = points.layout();
      const unsigned int velocity = layout.velocity,
                         end      = deforms ? layout.size : layout.mass,
                         others   = deforms ? layout.size
                                            : layout.n_fixed + layout.n_state;
      points.for_each([&](const unsigned int, auto p) {
        for (unsigned int k = velocity; k < end; ++k)
          action(p[k]);
        for (unsigned int k = others; k < layout.size; ++k)
          action(p[k]);
      });
    }
  } // namespace



  template <int dim>
  EndOfStep<dim>::Before::Before(Simulation<dim> &simulation)
    : simulation(&simulation)
    , deforms(simulation.stage_parameters().scheme.stress_update == "USF")
    , rest(simulation.current)
    , surfaces(simulation.current.surfaces)
  {
    for (const Body<dim> &body : simulation.current.bodies)
      {
        std::vector<double> &kept = numbers.emplace_back();
        std::size_t          n    = 0;
        for_each_kicked(body.points, deforms, [&](const double) { ++n; });
        kept.reserve(n);
        for_each_kicked(body.points, deforms, [&](const double number) {
          kept.push_back(number);
        });
      }
  }



  template <int dim>
  void
  EndOfStep<dim>::Before::restore()
  {
    State<dim> &state                             = simulation->current;
    static_cast<StateWithoutBodies<dim> &>(state) = std::move(rest);
    state.surfaces                                = std::move(surfaces);
    for (unsigned int b = 0; b < numbers.size(); ++b)
      {
        const double *from = numbers[b].data();
        for_each_kicked(state.bodies[b].points, deforms, [&](double &number) {
          number = *from++;
        });
      }
    // The next step sums up mass, momentum and force together, as without
    // this: other kernels may round in another way.
    state.points_have_changed();
  }



  template <int dim>
  EndOfStep<dim>::~EndOfStep()
  {
    for (Before &state : before)
      state.restore();
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
    before.emplace_back(simulation);
    GridMass<dim> &mass = *simulation.discretization.field().mass;
    mass.begin_trial();
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
        mass.end_trial();
        throw;
      }
    mass.end_trial();
    // Of these tasks, steps have not taken more.
    for (auto &[task, sum] : log.seconds)
      {
        const auto until = seconds.find(task);
        sum              = until == seconds.end() ? 0. : until->second;
      }
    if (problem.empty())
      return;
    before.back().restore();
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
