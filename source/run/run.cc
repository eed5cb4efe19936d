// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/json.h>
#include <greville/base/parameters.h>
#include <greville/run/check_materials.h>
#include <greville/run/run_header.h>
#include <greville/run/simulation_run.h>
#include <greville/run/state_output.h>
#include <greville/steps/load_balance.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * Whether a line can be written again. mpirun gives processes a terminal
     * even where its own output goes to a file, so that TERM = dumb says no.
     */
    bool
    is_terminal_with_lines()
    {
      const char *const name = std::getenv("TERM");
      return isatty(STDOUT_FILENO) == 1 &&
             !(name && std::string(name) == "dumb");
    }



    /**
     * The walls whose forces are known in some stage, and their components.
     */
    template <int dim>
    std::vector<std::pair<unsigned int, unsigned int>>
    reactions_of(const SimulationParameters &parameters)
    {
      std::array<unsigned char, 2 * dim> components{};
      for (unsigned int k = 0;
           k < std::max<unsigned int>(1, parameters.stages.size());
           ++k)
        {
          SimulationParameters stage = parameters;
          stage.enter_stage(k);
          const Walls<dim> walls(stage.walls);
          for (unsigned int w = 0; w < 2 * dim; ++w)
            components[w] |= walls.components_with_force(w);
        }
      std::vector<std::pair<unsigned int, unsigned int>> result;
      for (unsigned int w = 0; w < 2 * dim; ++w)
        for (unsigned int c = 0; c < dim; ++c)
          if ((components[w] >> c) & 1)
            result.emplace_back(w, c);
      return result;
    }



    /**
     * The walls and surfaces, and the free surface, through which water passes
     * in some stage, as their numbers in State::water, and their columns; none
     * where there is one.
     */
    template <int dim>
    std::vector<std::pair<unsigned int, std::string>>
    outflows_of(const SimulationParameters &parameters)
    {
      std::vector<std::pair<unsigned int, std::string>> result;
      for (unsigned int w = 0; w < 2 * dim; ++w)
        {
          bool is_open = false;
          for (unsigned int k = 0; k < parameters.n_stages(); ++k)
            {
              SimulationParameters stage = parameters;
              stage.enter_stage(k);
              is_open = is_open || stage.walls.passes_water(w);
            }
          std::string name = WallParameters::names[w];
          name[0] += 'a' - 'A';
          if (is_open)
            result.emplace_back(2 + w, "water_outflow_wall_" + name);
        }
      const auto &names = parameters.general.surface_loads;
      for (unsigned int k = 0; k < names.size(); ++k)
        if (parameters.surface_loads.at(names[k]).passes_water())
          result.emplace_back(2 + 2 * dim + k, "water_outflow_" + names[k]);
      if (!parameters.water.free_surface_pressure.empty())
        result.emplace_back(2 + 2 * dim + names.size(),
                            "water_outflow_free_surface");
      if (result.size() == 1)
        result.clear();
      return result;
    }



    /**
     * What this process has of the number @p k of outflows_of() in a part,
     * which numbers the loads on its own bodies only.
     */
    template <int dim>
    double
    water_of(const Simulation<dim>          &part,
             const std::vector<std::string> &all_loads,
             const unsigned int              k)
    {
      constexpr unsigned int first = 2 + 2 * dim;
      const auto            &water = part.state().water;
      if (k < first)
        return water[k];
      const auto &loads = part.stage_parameters().general.surface_loads;
      if (k == first + all_loads.size())
        return water.back();
      const auto found =
        std::find(loads.begin(), loads.end(), all_loads[k - first]);
      return found == loads.end() ? 0. : water[first + (found - loads.begin())];
    }



    std::string
    reaction_name(const unsigned int wall, const unsigned int component)
    {
      std::string name = WallParameters::names[wall];
      name[0] += 'a' - 'A';
      return "reaction_" + name + "_" + "xyz"[component];
    }
  } // namespace



  template <int dim>
  SimulationRun<dim>::SimulationRun(const SimulationParameters &parameters,
                                    const std::string          &directory,
                                    std::ostream               &out,
                                    const MPI_Comm              comm,
                                    const RunOptions           &options)
    : parameters(parameters)
    , directory(directory)
    , out(out)
    , comm(comm)
    , is_first(Utilities::MPI::this_mpi_process(comm) == 0)
    , simulations(parameters, comm)
    , exact(parameters.exact)
    , fields(directory, parameters.output)
    , probes(parameters.output.probes,
             parameters.output.fields,
             simulations.bodies_of_all_stages().list,
             comm)
    , notes(directory, out, comm)
    , reactions(reactions_of<dim>(parameters))
    , outflows(outflows_of<dim>(parameters))
    , end_of_run(parameters, columns_of(parameters, probes))
    , is_terminal(is_terminal_with_lines())
  {
    // A formula that fails is better found now than at the end.
    const double end = parameters.end_of_run();
    exact.errors(simulations.bodies(), end, end, comm);
    check_reference<dim>(parameters.reference);
    begin_run(options);
  }



  template <int dim>
  std::vector<std::string>
  SimulationRun<dim>::columns_of(const SimulationParameters &parameters)
  {
    auto columns = Statistics<dim>::names(parameters.general.surface_loads,
                                          parameters.general.bodies,
                                          parameters.general.contacts,
                                          parameters.general.rigid_bodies);
    for (const auto &[wall, component] : reactions_of<dim>(parameters))
      columns.push_back(reaction_name(wall, component));
    if (!parameters.stages.empty())
      columns.push_back("stage");
    if (parameters.has_ramp())
      columns.push_back("factor");
    for (const std::string &name : parameters.general.contacts)
      {
        for (unsigned int d = 0; d < dim; ++d)
          columns.push_back("contact_" + name + "_mean_" + "xyz"[d]);
        columns.push_back("contact_" + name + "_peak");
      }
    if (parameters.general.pore_water)
      {
        columns.insert(columns.end(), {"water_stored", "water_outflow"});
        for (const auto &outflow : outflows_of<dim>(parameters))
          columns.push_back(outflow.second);
      }
    if (parameters.output.load)
      columns.insert(columns.end(),
                     {"largest_load", "imbalance", "partitions"});
    return columns;
  }



  template <int dim>
  std::vector<std::string>
  SimulationRun<dim>::columns_of(const SimulationParameters &parameters,
                                 const Probes<dim>          &probes)
  {
    auto       all  = columns_of(parameters);
    const auto more = probes.columns();
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }



  template <int dim>
  RunSummary
  SimulationRun<dim>::run()
  {
    try
      {
        return run_to_end();
      }
    catch (const std::exception &error)
      {
        notes.note_error(message_of(error));
        throw;
      }
  }



  template <int dim>
  RunSummary
  SimulationRun<dim>::run_to_end()
  {
    print_header(out, simulations, parameters, comm);
    if (!is_resumed)
      {
        const std::string imbalance =
          print_imbalance(out, simulations, parameters, comm);
        if (!imbalance.empty())
          notes.note(imbalance);
        for (const std::string &note :
             input_notes(simulations.bodies(), parameters, comm))
          notes.note(note);
        for (const std::string &note : simulations.notes())
          notes.note(note);
      }
    begin = last_shown = last_checkpoint = std::chrono::steady_clock::now();
    if (!is_resumed)
      {
        if (parameters.output.grid_fields)
          simulations.fill_grid();
        write_due(false);
      }
    if (simulations.is_finished() || ends)
      at_end_of_step([&]() {
        if (late_row)
          write_statistics();
        if (!late_fields.empty())
          write_fields();
      });
    while (!simulations.is_finished() && !ends)
      {
        if (simulations.first().keeps_state())
          mark = make_mark();
        bool is_taken = true;
        try
          {
            is_taken = take_step();
          }
        catch (const StepGivenUp &error)
          {
            late_row.reset();
            late_fields.clear();
            notes.write(simulations.take_newton());
            if (is_terminal && parameters.output.print_times)
              out << "\r\033[K" << std::flush;
            AssertThrow(false,
                        ErrorOnAll(message_of(error) + " " +
                                   write_last_good_state()));
          }
        if (common().stage != last_stage)
          {
            last_stage = common().stage;
            out << '\n';
            print_stage(out, simulations, parameters);
          }
        notes.write(simulations.take_newton());
        if (!is_taken)
          continue;
        write_late();
        write_due(simulations.is_finished() || ends);
        const bool is_last = simulations.is_finished() || ends;
        for (const std::string &warning : simulations.take_warnings())
          notes.warn(warning);
        print_progress(is_last);
        look_for_checkpoint(is_last);
      }
    if (!ends && end_of_run.has_ramp())
      {
        const auto factor = [&](const double time) {
          return end_of_run.factor(common().stage, time);
        };
        ramp_result.emplace();
        ramp_result->from = factor(common().time);
        if (simulations.exceeds_displacement())
          ramp_result = {factor(common().time - common().step),
                         factor(common().time)};
      }
    const RunSummary summary = summarize();
    print_summary(summary);
    // One that was at its end has the summary of its steps.
    if (!is_resumed || common().n_steps > first_step)
      write_summary(summary);
    return summary;
  }



  template <int dim>
  RunSummary
  SimulationRun<dim>::summarize()
  {
    RunSummary summary;
    summary.wall_time     = seconds_since(begin);
    summary.contact_gains = simulations.contact_gains();
    simulations.finish();
    double largest = 0.;
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        const EnergyTotals   now     = simulations.part(k).energy_totals();
        const EnergyBalance &balance = simulations.part(k).state().energy;
        summary.numerical_loss += balance.loss(now);
        largest += balance.largest_with(now);
      }
    if (largest > 0.)
      summary.relative_loss = summary.numerical_loss / largest;
    summary.errors   = exact.errors(simulations.bodies(),
                                  common().time,
                                  common().velocity_time,
                                  comm);
    summary.ramp     = ramp_result;
    summary.front    = largest_front;
    summary.front_99 = largest_front_99;
    return summary;
  }



  template <int dim>
  double
  SimulationRun<dim>::rounded_up_time() const
  {
    const double time = common().time;
    return time + 1e-12 * std::max({std::abs(time),
                                    std::abs(parameters.time.start),
                                    std::abs(parameters.end_of_run())});
  }



  template <int dim>
  double
  SimulationRun<dim>::next_time(const double every, const double t) const
  {
    const double start = parameters.time.start;
    return every > 0. ? start + every * (std::floor((t - start) / every) + 1.)
                      : t;
  }



  template <int dim>
  double
  SimulationRun<dim>::next_time_of_fields(const double t) const
  {
    const double every = parameters.output.fields_every;
    return every > 0. ? next_time(every, t)
                      : std::numeric_limits<double>::infinity();
  }



  template <int dim>
  void
  SimulationRun<dim>::write_due(const bool is_last)
  {
    // The last state of a stage is the first one of the next.
    const double now = rounded_up_time();
    const bool   is_stage_end =
      is_last || simulations.first().is_stage_finished();
    const bool is_row_due =
      is_stage_end || now >= next_statistics || is_in_ramp();
    // The next stage may have other bodies.
    const bool goes_on_in_stage = !simulations.first().is_stage_finished() ||
                                  common().stage + 1 == parameters.n_stages();
    if (is_last && goes_on_in_stage && simulations.rows_lag())
      {
        before_last                 = make_mark();
        before_last->row_is_due     = now >= next_statistics;
        before_last->fields_are_due = now >= next_fields;
      }
    const bool is_late        = !is_stage_end && simulations.rows_lag();
    const bool are_fields_due = is_stage_end || now >= next_fields;
    if (are_fields_due)
      next_fields = next_time_of_fields(now);
    if (is_row_due)
      next_statistics =
        next_time(parameters.output.rows_every(parameters.end_of_run() -
                                               parameters.time.start),
                  now);
    if (!is_row_due && !are_fields_due)
      return;
    if (is_late)
      {
        ask_for_late(is_row_due, are_fields_due);
        return;
      }
    at_end_of_step([&]() {
      // The run may have gone back to a state whose row is there.
      if (is_row_due && !(ends && last_written_statistics == common().n_steps))
        write_statistics();
      // A row may end the run.
      if ((are_fields_due || ends) &&
          !(ends && last_written_fields == common().n_steps))
        write_fields();
    });
  }



  template <int dim>
  void
  SimulationRun<dim>::at_end_of_step(const std::function<void()> &write)
  {
    std::vector<State<dim>> kept;
    if (simulations.rows_lag())
      kept = simulations.state();
    simulations.finish();
    write();
    if (!kept.empty())
      simulations.set_state(kept);
  }



  template <int dim>
  bool
  SimulationRun<dim>::wants(const std::string &field) const
  {
    const auto &names = parameters.output.fields;
    return std::find(names.begin(), names.end(), field) != names.end();
  }



  template <int dim>
  GridFields<dim>
  SimulationRun<dim>::grid_fields(Simulation<dim> &part) const
  {
    GridFields<dim> grid;
    if (!parameters.output.grid_fields)
      return grid;
    grid.mass = part.mass().lumped();
    if (wants("force"))
      grid.force = part.grid_force();
    if (wants("cell_class"))
      grid.cell_classes =
        part.grid().cell_classes(part.state(), part.is_implicit());
    return grid;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_fields()
  {
    std::vector<GridFields<dim>> grids;
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      grids.push_back(grid_fields(simulations.part(k)));
    write_fields(loaded_states(simulations), grids);
    late_fields.clear();
  }



  template <int dim>
  void
  SimulationRun<dim>::write_fields(
    const std::vector<const State<dim> *> &states,
    std::vector<GridFields<dim>>          &grids)
  {
    last_written_fields = states[0]->n_steps;
    write_bodies(fields, simulations, states, parameters, comm);
    for (unsigned int k = 0; parameters.output.grid_fields && k < states.size();
         ++k)
      {
        grids[k].velocity = states[k]->field.velocity;
        if (wants("acceleration"))
          grids[k].acceleration = states[k]->field.acceleration;
        fields.write_grid(states[k]->time,
                          simulations.part(k).space(),
                          grids[k],
                          name_of_part(simulations, k));
      }
  }



  template <int dim>
  typename SimulationRun<dim>::Row
  SimulationRun<dim>::begin_row()
  {
    Row row{common().n_steps,
            common().time,
            {},
            common().stage,
            simulations.contact_intervals()};
    if (!parameters.stages.empty())
      row.more.push_back(common().stage + 1);
    if (end_of_run.has_ramp())
      row.more.push_back(end_of_run.factor(common().stage, common().time));
    for (const ContactInterval<dim> &interval : row.intervals)
      {
        for (unsigned int d = 0; d < dim; ++d)
          row.more.push_back(
            interval.time > 0. ? interval.impulse[d] / interval.time : 0.);
        row.more.push_back(interval.largest_force);
      }
    if (parameters.general.pore_water)
      {
        std::vector<unsigned int> numbers{0, 1};
        for (const auto &outflow : outflows)
          numbers.push_back(outflow.first);
        for (const unsigned int k : numbers)
          row.more.push_back(Utilities::MPI::sum(
            simulations.sum([&](const Simulation<dim> &part) {
              return water_of(part, parameters.general.surface_loads, k);
            }),
            comm));
      }
    if (parameters.output.load)
      {
        // Of all parts, which go in common steps.
        const double work = simulations.sum(
          [](const Simulation<dim> &part) { return part.work(); });
        row.more.push_back(Utilities::MPI::max(work, comm));
        row.more.push_back(imbalance(work, comm));
        row.more.push_back(simulations.sum([](const Simulation<dim> &part) {
          return part.state().n_partitions;
        }));
      }
    return row;
  }



  template <int dim>
  typename SimulationRun<dim>::Row
  SimulationRun<dim>::begin_row_to_write()
  {
    Row row = begin_row();
    simulations.set_contact_intervals({});
    return row;
  }



  template <int dim>
  std::vector<double>
  SimulationRun<dim>::values_of(const Row             &row,
                                const Statistics<dim> &statistics) const
  {
    auto values = statistics.values();
    for (const auto &[wall, component] : reactions)
      values.push_back(statistics.reactions[wall][component]);
    values.insert(values.end(), row.more.begin(), row.more.end());
    return values;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_row(const Row             &row,
                                const Statistics<dim> &statistics)
  {
    AssertThrow(std::isfinite(statistics.strain + statistics.dissipation),
                ErrorOnAll("At t = " + text_of(row.time) +
                           " s the strain energy or the dissipation of the "
                           "bodies is infinite or NaN, but not their stress: a "
                           "material law gives such a value."));
    largest_front.add(statistics.front);
    largest_front_99.add(statistics.front_99);
    const double last_time = last_row.empty() ? row.time : last_row[0];
    last_row               = values_of(row, statistics);
    statistics_file.write(last_row);
    const auto &more = probes.finish(row.time);
    probes.write();
    last_written_statistics = row.n_steps;
    if (ends || is_in_ramp())
      return;
    auto all = last_row;
    all.insert(all.end(), more.begin(), more.end());
    ends = criterion_holds(row.stage, all);
    if (ends && end_of_run.is_ramp(row.stage))
      ramp_result = {end_of_run.factor(row.stage, last_time),
                     end_of_run.factor(row.stage, row.time)};
  }



  template <int dim>
  void
  SimulationRun<dim>::write_statistics()
  {
    late_row.reset();
    probes.forget();
    probes.take(0, simulations.bodies());
    write_row(begin_row_to_write(), simulations.statistics());
  }



  template <int dim>
  void
  SimulationRun<dim>::ask_for_late(const bool for_row, const bool for_fields)
  {
    if (for_row)
      {
        late_row = begin_row_to_write();
        probes.forget();
      }
    late_fields.resize(for_fields ? simulations.n_parts() : 0);
    if (for_fields || !probes.empty())
      simulations.ask_for_row(
        [this](const unsigned int part,
               const double       weight,
               const bool is_kicked) { watch(part, weight, is_kicked); });
    else
      simulations.ask_for_row();
  }



  template <int dim>
  void
  SimulationRun<dim>::watch(const unsigned int k,
                            const double       weight,
                            const bool         is_kicked)
  {
    Simulation<dim>  &part  = simulations.part(k);
    const State<dim> &state = part.state();
    if (late_row)
      {
        unsigned int first_body = 0;
        for (unsigned int j = 0; j < k; ++j)
          first_body += simulations.part(j).state().bodies.size();
        probes.take(first_body, state.bodies, weight, is_kicked);
      }
    if (late_fields.empty())
      return;
    auto &[late, grid] = late_fields[k];
    if (!is_kicked)
      grid = grid_fields(part);
    late.take(state, part.grid().field(), weight, is_kicked);
  }



  template <int dim>
  void
  SimulationRun<dim>::write_late()
  {
    if (late_row)
      write_row(*late_row, simulations.late_statistics());
    late_row.reset();
    if (late_fields.empty())
      return;
    std::vector<const State<dim> *> states;
    std::vector<GridFields<dim>>    grids;
    for (const auto &[late, grid] : late_fields)
      {
        states.push_back(&late.state);
        grids.push_back(grid);
      }
    write_fields(states, grids);
    late_fields.clear();
  }



  template class SimulationRun<2>;
  template class SimulationRun<3>;
} // namespace greville
