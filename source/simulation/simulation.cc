// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/initial_state.h>
#include <greville/simulation/move_points.h>
#include <greville/simulation/simulation.h>
#include <greville/simulation/step_size.h>

#include <algorithm>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two snapshots.
    constexpr unsigned int remember_every = 50;

    // Times that a step is rejected.
    constexpr unsigned int most_rejections = 20;



    std::string
    without_stop(std::string text)
    {
      while (!text.empty() && text.back() == '.')
        text.pop_back();
      return text;
    }
  } // namespace



  template <int dim>
  Simulation<dim>::Simulation(const SimulationParameters &given,
                              const MPI_Comm              comm)
    : parameters(given) // what others refer to
    , comm(comm)
    , loads(parameters)
    , discretization(parameters, loads, log, comm)
    , damping(parameters.loads, discretization)
    , energy_guard(parameters.scheme, discretization, log)
    , current(make_initial_state(parameters, loads, discretization))
    , integrator(make_time_integrator<dim>(
        parameters.scheme.stress_update,
        {parameters, discretization, loads, current, log}))
  {
    loads.find_points(current.bodies, comm);
    energy_guard.start(current);
    good.take(current);
  }



  template <int dim>
  bool
  Simulation<dim>::is_finished() const
  {
    return current.time >= parameters.time.end * (1. - 1e-12) ||
           current.n_free == 0 ||
           (parameters.time.max_steps > 0 &&
            current.n_steps >= parameters.time.max_steps);
  }



  template <int dim>
  void
  Simulation<dim>::set_state(const State<dim> &state)
  {
    AssertDimension(state.bodies.size(), current.bodies.size());
    current = state;
    discretization.mass().forget();
    integrator->forget();
    // It may be that of another simulation, which is gone before this one.
    for (Body<dim> &body : current.bodies)
      {
        body.parameters = &parameters.bodies.at(body.name);
        body.material =
          parameters.materials.at(body.parameters->material).get();
      }
    good.take(current);
  }



  template <int dim>
  void
  Simulation<dim>::fill_grid()
  {
    discretization.sum(current);
    discretization.walls().hold_velocity(current.velocity,
                                         current.velocity_time);
    try
      {
        const unsigned int n =
          discretization.solve({&current.velocity},
                               {&discretization.momentum()});
        current.n_iterations = std::max(current.n_iterations, n);
        current.n_all_iterations += n;
      }
    catch (const StepFailed &failure)
      {
        go_back(failure, current.step);
      }
  }



  template <int dim>
  void
  Simulation<dim>::advance(double &dt)
  {
    for (current.n_rejections = 0;; ++current.n_rejections)
      try
        {
          dt = integrator->propose_step(current);
          integrator->advance(current, dt);
          return;
        }
      catch (const StepRejected &rejection)
        {
          if (current.n_rejections == most_rejections)
            throw StepFailed("the step has been shortened " +
                             std::to_string(most_rejections) +
                             " times, and still " + rejection.what());
        }
  }



  template <int dim>
  void
  Simulation<dim>::step()
  {
    if (current.n_steps > 0 && current.n_steps % remember_every == 0)
      good.take(current);
    // Programs may have changed them.
    current.points_have_changed();
    double dt = current.step;
    try
      {
        advance(dt);
        {
          const PartTimer timer(log, "volume of fluids");
          share_volume(current,
                       discretization.transfer(),
                       discretization.cell_size());
        }
        if (current.n_steps == 1)
          check_fragments();
        energy_guard.check(current, is_finished());
      }
    catch (const StepFailed &failure)
      {
        go_back(failure, dt);
      }
    catch (...)
      {
        good.restore(current);
        throw;
      }
    if (current.n_free == 0)
      log.warnings.push_back("The last point has left the grid at t = " +
                             std::to_string(current.time) +
                             " s: the run ends.");
    damping.damp_kinetically(current);
  }



  template <int dim>
  void
  Simulation<dim>::go_back(const StepFailed &failure, const double dt)
  {
    std::ostringstream message;
    message << "Step " << current.n_steps + 1 << " at t = " << current.time
            << " s, dt = " << dt << " s: " << without_stop(failure.what())
            << ". ";
    if (failure.by_materials)
      message << describe_materials(current.bodies) << " "
              << loads.what_is_large(current.time,
                                     dt,
                                     discretization.cell_size(),
                                     comm);
    good.restore(current);
    message << "The state of step " << current.n_steps
            << ", t = " << current.time
            << " s, is the last good one that was kept.";
    AssertThrow(false, ExcMessage(message.str()));
    // Not reached.
    throw failure;
  }



  template <int dim>
  void
  Simulation<dim>::check_fragments()
  {
    constexpr double most_fragments = 0.05;
    if (!consistent_mass())
      return;
    const double fraction = consistent_mass()->fragment_fraction();
    if (fraction <= most_fragments)
      return;
    std::ostringstream message;
    message << 100. * fraction
            << " % of the cells with points have lumped mass: the bodies are "
               "too thin there for the exact mass. Take more cells.";
    log.warnings.push_back(message.str());
  }



  template <int dim>
  Statistics<dim>
  Simulation<dim>::statistics() const
  {
    Statistics<dim> result =
      compute_statistics<dim>(current.bodies,
                              discretization.transfer(),
                              loads.gravity(current.time),
                              comm);
    result.time       = current.time;
    result.step       = current.step;
    result.iterations = current.n_iterations;
    result.active     = mass().n_active();
    result.fragments  = mass().n_fragments();
    return result;
  }



  template <int dim>
  std::vector<std::string>
  Simulation<dim>::take_warnings()
  {
    std::vector<std::string> result;
    result.swap(log.warnings);
    return result;
  }



  template <int dim>
  std::size_t
  Simulation<dim>::points_memory() const
  {
    std::size_t n = good.memory_consumption();
    for (const Body<dim> &body : current.bodies)
      n += body.points.memory_consumption();
    return n;
  }



  template class Simulation<2>;
  template class Simulation<3>;
} // namespace greville
