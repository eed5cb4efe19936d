// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/in_stage.h>
#include <greville/steps/body_surfaces.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/load_balance.h>
#include <greville/steps/refinement_marks.h>
#include <greville/steps/simulation.h>
#include <greville/steps/stage_bodies.h>
#include <greville/steps/state_tables.h>
#include <greville/steps/stress_jumps.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    SimulationParameters
    first_stage_of(SimulationParameters parameters)
    {
      const bool has_groups = parameters.body_groups().size() > 1;
      Require(
        !parameters.has_body_grids() && !has_groups,
        "Bodies have grids of their own ('Grid/Per body' or a section 'Grid' "
        "of a body) or 'Contacts': they are simulations of their own, and "
        "greville::CoupledSimulations takes their common steps.");
      parameters.enter_stage(0);
      return parameters;
    }
  } // namespace



  template <int dim>
  Simulation<dim>::Simulation(const SimulationParameters &given,
                              const MPI_Comm              comm)
    : parameters(first_stage_of(given)) // others refer to it
    , comm(comm)
    , loads(in_stage(parameters, 0, [&]() { return Loads<dim>(parameters); }))
    , discretization(parameters, loads, log, comm)
    , cells(parameters,
            discretization,
            log,
            [this]() {
              integrator.reset();
              last_good = Snapshot<dim>();
            })
    , guard(parameters, discretization, log)
    , current(make_initial_state(parameters, loads, discretization))
    , integrator(in_stage(parameters, 0, [&]() { return make_integrator(); }))
  {
    make_later_bodies(current.bodies, parameters, discretization);
    // Enter all stages, the first one last, to find their errors now.
    for (unsigned int k = parameters.n_stages(); k-- > 0;)
      {
        if (parameters.n_stages() > 1)
          enter_stage(k);
        loads.find_points(current.bodies, comm);
      }
    check_closed_box(current.bodies, parameters, discretization.space());
    if (!parameters.stages.empty())
      start_stage();
    guard.start(current);
    current.imbalance = imbalance(work_of_process(current, space()), comm);
    last_good.take(current);
  }



  template <int dim>
  std::unique_ptr<TimeIntegrator<dim>>
  Simulation<dim>::make_integrator()
  {
    return make_time_integrator<dim>(
      parameters.scheme.stress_update,
      {parameters, discretization, loads, current, log, guard, requested_row});
  }



  template <int dim>
  bool
  Simulation<dim>::is_finished() const
  {
    return (is_stage_finished() &&
            current.stage + 1 == parameters.n_stages()) ||
           current.n_points == 0 || exceeds_displacement() ||
           (parameters.time.max_steps > 0 &&
            current.n_steps >= parameters.time.max_steps);
  }



  template <int dim>
  bool
  Simulation<dim>::exceeds_displacement() const
  {
    const double limit = parameters.time.largest_displacement;
    return limit > 0. && current.displacement > limit;
  }



  template <int dim>
  bool
  Simulation<dim>::is_end(const double t) const
  {
    const TimeParameters &time = parameters.time;
    return t >= time.end -
                  1e-12 * std::max(std::abs(time.start), std::abs(time.end));
  }



  template <int dim>
  void
  Simulation<dim>::set_state(const State<dim> &state)
  {
    AssertThrow(state.bodies.size() == current.bodies.size(),
                ExcDimensionMismatch(state.bodies.size(),
                                     current.bodies.size()));
    const bool is_here =
      !state.partition || state.partition->is_same(*current.partition);
    const bool keeps_integrator =
      is_here && integrator && state.stage == entered_stage;
    if (!is_here)
      {
        integrator.reset();
        discretization.repartition(state.partition);
      }
    current           = state;
    current.partition = discretization.partition();
    // The state may refer to another simulation, which may be destroyed first.
    for (Body<dim> &body : current.bodies)
      {
        body.parameters = &parameters.bodies.at(body.name);
        body.material =
          parameters.materials.at(body.parameters->material).get();
      }
    // enter_stage() makes new spaces and gives them to points.
    if (keeps_integrator)
      for_all_points(current, [&](MaterialPoints<dim> &points) {
        points.set_space(discretization.space());
      });
    else
      enter_stage(state.stage);
    begin_anew();
  }



  template <int dim>
  void
  Simulation<dim>::begin_anew()
  {
    requested_row = {};
    discretization.field().mass->forget();
    integrator->forget();
    guard.weigh(current);
    last_good.take(current);
  }



  template <int dim>
  void
  Simulation<dim>::begin_with(const TablesFile &content)
  {
    set_points_from_tables(current, content, discretization);
    share_cells();
    enter_stage(0);
    loads.find_points(current.bodies, comm);
    start_stage();
    guard.start(current);
    last_good.take(current);
  }



  template <int dim>
  void
  Simulation<dim>::share_cells()
  {
    cells.share(current);
    if (integrator)
      return;
    integrator = make_integrator();
    last_good.take(current);
  }



  template <int dim>
  std::vector<std::uint64_t>
  Simulation<dim>::marked_cells()
  {
    return mark_cells(current,
                      discretization,
                      parameters,
                      find_surfaces(parameters,
                                    space(),
                                    current.bodies,
                                    current.rigid_bodies,
                                    false))
      .cells;
  }



  template <int dim>
  std::vector<double>
  Simulation<dim>::stress_jumps()
  {
    return greville::stress_jumps(current, discretization, parameters)
      .of_points;
  }



  template <int dim>
  bool
  Simulation<dim>::change_cells()
  {
    bool has_changed = false;
    try
      {
        has_changed = cells.take(current);
      }
    catch (...)
      {
        // The copy of the old cells is lost: the run ends in this state.
        if (!integrator)
          last_good.take(current);
        throw;
      }
    if (!integrator)
      integrator = make_integrator();
    return has_changed;
  }



  template <int dim>
  void
  Simulation<dim>::fill_grid()
  {
    discretization.sum(current);
    try
      {
        VectorField<dim> &velocity = current.field.velocity;
        discretization.walls().impose_velocity(velocity,
                                               {current.velocity_time,
                                                current.time - current.step,
                                                current.time});
        const unsigned int n =
          discretization.solve({&velocity}, {&discretization.field().momentum});
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
  Simulation<dim>::finish()
  {
    try
      {
        integrator->finish(current);
      }
    catch (const StepFailed &failure)
      {
        log.warnings.push_back(
          "Velocities at t = " + text_of(current.time) +
          " s are those of t = " + text_of(current.velocity_time) +
          " s, since the kick to the end of the step has failed: " +
          without_stop(failure.what()) + ".");
      }
  }



  template <int dim>
  void
  Simulation<dim>::show_finished(const std::function<void()> &show)
  {
    if (!rows_are_late())
      {
        show();
        return;
      }
    // Until begin_anew() takes another copy, no state can be restored.
    last_good = Snapshot<dim>();
    {
      // Keep the mode, which only estimates of the critical step change.
      HighestMode<dim>                mode     = std::move(current.field.mode);
      const StateWithoutBodies<dim>   rest     = current;
      const std::vector<Surface<dim>> surfaces = current.surfaces;
      const KickedNumbers<dim>        numbers(current.bodies);
      finish();
      show();
      static_cast<StateWithoutBodies<dim> &>(current) = rest;
      current.field.mode                              = std::move(mode);
      current.surfaces                                = surfaces;
      numbers.restore(current.bodies);
      current.points_have_changed();
    }
    begin_anew();
  }



  template <int dim>
  EnergyTotals
  Simulation<dim>::energy_totals()
  {
    const PartTimer timer(log, "energy");
    return current.energy.totals(
      energy_of_bodies<dim>(current.bodies, discretization.transfer(), comm),
      comm);
  }



  template <int dim>
  LateRow<dim>
  Simulation<dim>::begin_row(const double outer_mass) const
  {
    LateRow<dim>     result;
    Statistics<dim> &row = result.row;
    row.time             = current.time;
    row.step             = current.step;
    row.iterations       = current.n_iterations;
    row.redone           = current.n_all_rejections;
    row.reactions        = current.reactions;
    row.loads =
      loads.surfaces().resultants(current.surfaces, current.time, comm);
    // If the formula fails at this time, the row has no potential energy. The
    // next step then fails with a message and writes a last state.
    try
      {
        result.gravity = loads.gravity(current.time);
      }
    catch (const ExcMessage &)
      {
        for (unsigned int d = 0; d < dim; ++d)
          result.gravity[d] = std::numeric_limits<double>::quiet_NaN();
      }
    for (const Body<dim> &body : current.bodies)
      result.sums.emplace_back(body.material,
                               parameters.output.runout_above,
                               outer_mass);
    return result;
  }



  template <int dim>
  void
  Simulation<dim>::ask_for_row(const double                         outer_mass,
                               const decltype(LateRow<dim>::watch) &watch,
                               const std::function<void()>         &show)
  {
    requested_row           = begin_row(outer_mass);
    requested_row.is_wanted = true;
    requested_row.watch     = watch;
    requested_row.show      = show;
  }



  template <int dim>
  Statistics<dim>
  Simulation<dim>::statistics() const
  {
    LateRow<dim> now = begin_row(std::numeric_limits<double>::max());
    now.energy       = current.energy;
    for (unsigned int b = 0; b < now.sums.size(); ++b)
      now.sums[b].add(current.bodies[b].points, &discretization.transfer());
    return complete(now);
  }



  template <int dim>
  Statistics<dim>
  Simulation<dim>::complete(const LateRow<dim> &late) const
  {
    Statistics<dim> result = late.row;
    add_sums(result, current.bodies, late.sums, late.gravity, comm);
    result.active    = discretization.field().mass->n_active();
    result.fragments = discretization.field().mass->n_fragments();
    // Send all sums over processes in one message.
    EnergyBalance         energy = late.energy;
    std::vector<double *> sums;
    EnergyBalance::visit_numbers(
      energy,
      EnergyBalance::surfaces + current.surfaces.size(),
      [](const std::string &, const double) {},
      [&](const std::string &, double &sum) { sums.push_back(&sum); });
    for (Tensor<1, dim> &reaction : result.reactions)
      for (unsigned int d = 0; d < dim; ++d)
        sums.push_back(&reaction[d]);
    std::vector<double> values;
    for (const double *sum : sums)
      values.push_back(*sum);
    Utilities::MPI::sum(values, comm, values);
    for (unsigned int i = 0; i < sums.size(); ++i)
      *sums[i] = values[i];
    const auto work = [&](const unsigned int source) {
      return energy.work(source, MPI_COMM_SELF);
    };
    const EnergyTotals totals = energy.totals(0., MPI_COMM_SELF);
    result.work.gravity       = work(EnergyBalance::gravity);
    result.work.loads         = work(EnergyBalance::loads);
    result.work.walls         = work(EnergyBalance::walls);
    result.work.friction      = totals.friction;
    result.work.damping       = totals.damping;
    for (unsigned int k = 0; k < current.surfaces.size(); ++k)
      {
        const double of_surface = work(EnergyBalance::surfaces + k);
        if (!current.surfaces[k].contact.empty())
          result.work.contacts[current.surfaces[k].contact] += of_surface;
        else
          result.work.surfaces.push_back(of_surface);
      }
    return result;
  }



  namespace
  {
    /// Swap the normal stresses with @p others. If @p others is empty, first
    /// set it to the total stresses: the effective ones less the pore pressure.
    template <int dim>
    void
    exchange_with_total_stress(std::vector<Body<dim>> &bodies,
                               std::vector<double>    &others)
    {
      const bool  is_first = others.empty();
      std::size_t k        = 0;
      for (Body<dim> &body : bodies)
        if (const PointField *p = body.points.layout().find("pore_pressure"))
          body.points.for_each([&](PointRef<dim> point) {
            for (unsigned int d = 0; d < 3; ++d)
              {
                double &sigma =
                  point.stress(PointLayout<dim>::stress_index(d, d));
                if (is_first)
                  others.push_back(sigma - point[p->first]);
                std::swap(sigma, others[k++]);
              }
          });
    }
  } // namespace



  template <int dim>
  VectorField<dim>
  Simulation<dim>::grid_force()
  {
    run_on_all(comm, [&]() { loads.set(current.bodies, current.time); });
    loaded_surfaces();
    VectorField<dim> force;
    discretization.initialize(force);
    // Compute the force of total stresses. The second swap restores effective
    // stresses exactly.
    std::vector<double> stresses;
    exchange_with_total_stress(current.bodies, stresses);
    discretization.find_force(current, loads.gravity(current.time), force);
    exchange_with_total_stress(current.bodies, stresses);
    return force;
  }



  template <int dim>
  const std::vector<Surface<dim>> &
  Simulation<dim>::loaded_surfaces()
  {
    run_on_all(comm,
               [&]() { loads.surfaces().set(current.surfaces, current.time); });
    return current.surfaces;
  }



  template <int dim>
  std::vector<Body<dim>> &
  Simulation<dim>::bodies()
  {
    programs_have_points = true;
    current.points_have_changed();
    return current.bodies;
  }



  template <int dim>
  std::size_t
  Simulation<dim>::points_memory() const
  {
    std::size_t n = last_good.memory_consumption();
    for_all_points(current, [&](const MaterialPoints<dim> &points) {
      n += points.memory_consumption();
    });
    return n;
  }



  GREVILLE_INSTANTIATE_CLASS(Simulation);
} // namespace greville
