// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/json.h>
#include <greville/run/check_materials.h>
#include <greville/run/run_header.h>
#include <greville/run/simulation_run.h>
#include <greville/run/state_output.h>

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return whether the terminal can rewrite a line. mpirun gives processes a
    /// terminal even if its own output goes to a file; TERM = dumb then
    /// disables rewriting.
    bool
    is_terminal_with_lines()
    {
      const char *const name = std::getenv("TERM");
      return isatty(STDOUT_FILENO) == 1 &&
             !(name && std::string(name) == "dumb");
    }



    /// Return the name of a wall in columns: "left" for "Left".
    std::string
    name_of_wall(const unsigned int wall)
    {
      return boost::algorithm::to_lower_copy(WallParameters::names[wall]);
    }



    /// Return the walls and components whose forces are known in any stage.
    template <int dim>
    std::vector<std::pair<unsigned int, unsigned int>>
    reactions_of(const SimulationParameters &parameters)
    {
      std::array<unsigned char, 2 * dim> components{};
      for (unsigned int k = 0; k < parameters.n_stages(); ++k)
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



    /// Return the walls and surfaces, including the free surface, through which
    /// water flows in some stage: numbers in State::water and columns. Empty if
    /// there is only one.
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
          if (is_open)
            result.emplace_back(2 + w, "water_outflow_wall_" + name_of_wall(w));
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
    // Find a formula that fails now, not at the end.
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
      columns.push_back("reaction_" + name_of_wall(wall) + "_" +
                        "xyz"[component]);
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
    if (parameters.grid.has_changing_cells())
      columns.insert(columns.end(), {"cells", "adaptations", "divided"});
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
      simulations.show_finished([&]() {
        if (late_row)
          write_statistics();
        if (late_fields)
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
            late_fields.reset();
            fields.drop_held();
            notes.write(simulations.take_newton());
            if (is_terminal)
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
        for (const std::string &cut : simulations.take_cuts())
          {
            if (is_terminal)
              out << "\r\033[K";
            notes.note(cut, "Cut");
          }
        if (!is_taken)
          continue;
        write_late();
        write_due(simulations.is_finished() || ends);
        const bool is_last = simulations.is_finished() || ends;
        for (const std::string &warning : simulations.take_warnings())
          notes.note(warning, "Warning");
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
    // A run that was already at its end keeps the summary of its steps.
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
    summary.errors    = exact.errors(simulations.bodies(),
                                  common().time,
                                  common().velocity_time,
                                  comm);
    summary.ramp      = ramp_result;
    summary.runout    = largest_runout;
    summary.runout_99 = largest_runout_99;
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



  GREVILLE_INSTANTIATE_CLASS(SimulationRun);
} // namespace greville
