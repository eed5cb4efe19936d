// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/simulation_run.h>
#include <greville/run/state_output.h>
#include <greville/steps/load_balance.h>

#include <algorithm>
#include <cmath>

// Writes the rows of statistics.csv and probes.csv, and field files.
namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the share of this process in outflow number @p k, see
    /// State::water. A part numbers only the loads on its own bodies.
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
  } // namespace



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
    const bool stage_continues = !simulations.first().is_stage_finished() ||
                                 common().stage + 1 == parameters.n_stages();
    if (is_last && stage_continues && simulations.rows_are_late())
      {
        before_last                 = make_mark();
        before_last->row_is_due     = now >= next_statistics;
        before_last->fields_are_due = now >= next_fields;
      }
    const bool is_late        = !is_stage_end && simulations.rows_are_late();
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
    // Solvers begin anew at the start of a stage and the end of the run.
    simulations.show_finished([&]() {
      // The run may have gone back to a state whose row exists.
      if (is_row_due && !(ends && last_written_statistics == common().n_steps))
        write_statistics();
      // A row may end the run.
      if ((are_fields_due || ends) &&
          !(ends && last_written_fields == common().n_steps))
        write_fields();
    });
  }



  template <int dim>
  GridFields<dim>
  SimulationRun<dim>::grid_fields(Simulation<dim> &part) const
  {
    GridFields<dim> grid;
    grid.velocity = part.state().field.velocity;
    // In refined grids, tied functions have the mass of their cells, too.
    VectorField<dim> mass;
    part.grid().initialize(mass);
    mass[0] = part.mass().lumped();
    part.mass().distribute_levels(mass);
    grid.mass = mass[0];
    if (wants("acceleration"))
      grid.acceleration = part.state().field.acceleration;
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
    late_fields.reset();
    fields.drop_held();
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        simulations.part(k).loaded_surfaces();
        hold_fields(k);
      }
    fields.write_held(comm);
    last_written_fields = common().n_steps;
  }



  template <int dim>
  void
  SimulationRun<dim>::hold_fields(const unsigned int k)
  {
    Simulation<dim> &part = simulations.part(k);
    fields.hold();
    if (parameters.output.grid_fields)
      fields.write_grid(part.state().time,
                        part.space(),
                        grid_fields(part),
                        name_of_part(simulations, k));
    write_bodies(fields, simulations, k, parameters, comm);
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
        // The work of all parts, which take common steps.
        const double work = simulations.sum([](const Simulation<dim> &part) {
          return work_of_process(part.state(), part.space());
        });
        row.more.push_back(Utilities::MPI::max(work, comm));
        row.more.push_back(imbalance(work, comm));
        row.more.push_back(simulations.sum(&State<dim>::n_partitions));
      }
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
    // A late row is summed up in the step after it, which may have adapted the
    // grid first and has not yet ended: the next adaptation follows.
    if (parameters.grid.has_changing_cells())
      {
        values.push_back(simulations.sum([](const Simulation<dim> &part) {
          return double(part.space().triangulation().n_global_active_cells());
        }));
        values.push_back(simulations.sum(&State<dim>::n_adaptations));
        values.push_back(simulations.sum(&State<dim>::n_divided));
      }
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
    largest_runout.add(statistics.runout);
    largest_runout_99.add(statistics.runout_99);
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
    const Row row = begin_row();
    simulations.set_contact_intervals({});
    write_row(row, simulations.statistics());
  }



  template <int dim>
  void
  SimulationRun<dim>::ask_for_late(const bool for_row, const bool for_fields)
  {
    if (for_row)
      {
        late_row = begin_row();
        simulations.set_contact_intervals({});
        probes.forget();
      }
    late_fields.reset();
    fields.drop_held();
    if (for_fields)
      late_fields = common().n_steps;
    std::function<void(unsigned int, double, bool)> watch_part;
    std::function<void(unsigned int)>               show_part;
    if (late_row && !probes.empty())
      watch_part = [this](const unsigned int part,
                          const double       weight,
                          const bool         is_kicked) {
        probes.take(first_body_of_part(simulations, part),
                    simulations.part(part).state().bodies,
                    weight,
                    is_kicked);
      };
    if (for_fields)
      show_part = [this](const unsigned int part) { hold_fields(part); };
    simulations.ask_for_row(watch_part, show_part);
  }



  template <int dim>
  void
  SimulationRun<dim>::write_late()
  {
    if (late_row)
      write_row(*late_row, simulations.late_statistics());
    late_row.reset();
    if (!late_fields)
      return;
    fields.write_held(comm);
    last_written_fields = *late_fields;
    late_fields.reset();
  }



  GREVILLE_INSTANTIATE_CLASS(SimulationRun);
} // namespace greville
