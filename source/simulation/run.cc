// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/json.h>
#include <greville/base/parameters.h>
#include <greville/simulation/implicit_scheme.h>
#include <greville/simulation/run.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    double
    seconds_since(const std::chrono::steady_clock::time_point &begin)
    {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                           begin)
        .count();
    }



    std::string
    cells_text(const std::vector<unsigned int> &cells)
    {
      std::string result;
      for (const unsigned int n : cells)
        result += (result.empty() ? "" : " x ") + std::to_string(n);
      return result;
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
                                    const MPI_Comm              comm)
    : parameters(parameters)
    , directory(directory)
    , out(out)
    , comm(comm)
    , is_first(Utilities::MPI::this_mpi_process(comm) == 0)
    , simulation(parameters, comm)
    , exact(parameters.exact)
    , measured(parameters.reference)
    , fields(directory, parameters.output)
    , probes(parameters.output.probes,
             simulation.bodies(),
             directory + "/probes.csv",
             comm)
    , next_fields(simulation.state().time)
    , next_statistics(simulation.state().time)
    , is_terminal(isatty(STDOUT_FILENO) == 1)
  {
    for (const Body<dim> &body : simulation.bodies())
      n_points += body.n_points;
    auto columns = Statistics<dim>::names(parameters.general.surface_loads);
    reactions    = reactions_of<dim>(parameters);
    for (const auto &[wall, component] : reactions)
      columns.push_back(reaction_name(wall, component));
    if (!parameters.stages.empty())
      columns.push_back("stage");
    statistics_file.open(directory + "/statistics.csv", columns, 14, comm);
    // A formula that fails is better found now than at the end.
    const double end = parameters.end_of_run();
    exact.errors(simulation.bodies(), end, end, comm);
  }



  template <int dim>
  RunSummary
  SimulationRun<dim>::run()
  {
    print_header();
    begin = last_shown = std::chrono::steady_clock::now();
    if (parameters.output.grid_fields)
      simulation.fill_grid();
    write_due(false);
    while (!simulation.is_finished())
      {
        try
          {
            simulation.step();
          }
        catch (const std::exception &)
          {
            if (is_terminal && parameters.output.print_times)
              out << "\r\033[K" << std::flush;
            // The fields of the grid are those of the step that failed.
            fields.write_points(simulation.state().time,
                                simulation.bodies(),
                                comm);
            throw;
          }
        if (simulation.state().stage != last_stage)
          {
            last_stage = simulation.state().stage;
            out << '\n';
            print_stage();
          }
        for (const std::string &warning : simulation.take_warnings())
          out << "Warning: " << warning << std::endl;
        const bool is_last = simulation.is_finished();
        write_due(is_last);
        print_progress(is_last);
      }

    RunSummary summary;
    summary.wall_time = seconds_since(begin);
    summary.errors    = exact.errors(simulation.bodies(),
                                  simulation.state().time,
                                  simulation.state().velocity_time,
                                  comm);
    summary.front     = largest_front;
    if (measured.has_surface())
      summary.surface =
        measured.surface_distance(simulation.bodies(),
                                  simulation.space().lattice().cell_size(0),
                                  simulation.space().lattice().lower(1),
                                  comm);
    if (measured.has_series())
      summary.series = measured.series_distance();
    print_summary(summary);
    write_summary(summary);
    return summary;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_due(const bool is_last)
  {
    const OutputParameters &output = parameters.output;
    const double            time   = simulation.state().time;
    const double            now =
      time + 1e-12 * std::max({std::abs(time),
                               std::abs(parameters.time.start),
                               std::abs(parameters.end_of_run())});
    // The last state of a stage is the first one of the next.
    const auto next_multiple = [&](const double every, const double t) {
      const double start = parameters.time.start;
      return every > 0. ? start + every * (std::floor((t - start) / every) + 1.)
                        : t;
    };
    const bool is_stage_end = is_last || simulation.is_stage_finished();
    if (is_stage_end || now >= next_statistics)
      {
        write_statistics();
        next_statistics = next_multiple(output.statistics_every, now);
      }
    if (is_stage_end || now >= next_fields)
      {
        fields.write(simulation.state().time,
                     simulation.bodies(),
                     simulation.space(),
                     simulation.state().velocity,
                     simulation.mass().lumped(),
                     simulation.state().acceleration);
        next_fields = output.fields_every > 0.
                        ? next_multiple(output.fields_every, now)
                        : std::numeric_limits<double>::infinity();
      }
  }



  template <int dim>
  void
  SimulationRun<dim>::write_statistics()
  {
    const Statistics<dim> row = simulation.statistics();
    largest_front             = std::max(largest_front, row.front);
    measured.add(row);
    probes.write(simulation.state().time, simulation.bodies());
    auto values = row.values();
    for (const auto &[wall, component] : reactions)
      values.push_back(row.reactions[wall][component]);
    if (!parameters.stages.empty())
      values.push_back(simulation.state().stage + 1);
    statistics_file.write(values);
  }



  template <int dim>
  void
  SimulationRun<dim>::print_header()
  {
    out << "Greville, " << dim << "D, " << Utilities::MPI::n_mpi_processes(comm)
        << " process(es)\n\n"
        << "  body             material         points\n";
    for (const Body<dim> &body : simulation.bodies())
      out << "  " << std::left << std::setw(16) << body.name << " "
          << std::setw(16) << body.parameters->material << std::right
          << std::setw(7) << body.n_points << '\n';
    out << "\n  grid: " << cells_text(parameters.grid.cells) << " cells, order "
        << parameters.grid.degree << '\n';
    print_stage();
  }



  template <int dim>
  void
  SimulationRun<dim>::print_stage()
  {
    const SchemeParameters &scheme = simulation.stage_parameters().scheme;
    const TimeParameters   &time   = simulation.stage_parameters().time;
    if (!parameters.stages.empty())
      out << "  " << parameters.stage_text(last_stage) << "t = " << time.start
          << " to " << time.end << " s\n";
    out << "  mass: " << scheme.mass;
    if (simulation.mass().solver() != scheme.mass)
      out << " (" << simulation.mass().solver() << ")";
    out << ", " << scheme.stress_update << ", " << scheme.transfer
        << ", quadrature by " << scheme.quadrature << "\n\n";

    const std::vector<SolverLevel> levels = simulation.solver_levels();
    if (!levels.empty())
      {
        out << "  level  order       unknowns   used\n";
        for (unsigned int l = levels.size(); l-- > 0;)
          out << std::setw(7) << l << std::setw(7) << levels[l].degree
              << std::setw(15) << levels[l].n_unknowns << "   "
              << levels[l].method << '\n';
        out << std::endl;
        return;
      }
    const auto &hierarchy = simulation.mass().hierarchy();
    const bool  all =
      MassSolver<dim>::uses_multigrid(simulation.mass().solver());
    out << "  level  order   coefficients   used\n";
    for (unsigned int l = hierarchy.n_levels(); l-- > 0;)
      if (all || l + 1 == hierarchy.n_levels())
        out << std::setw(7) << l << std::setw(7) << hierarchy[l].degree()
            << std::setw(15) << hierarchy[l].n_dofs() << "   "
            << (l == 0 && all && hierarchy.n_levels() > 1
                  ? "conjugate gradients"
                : all ? parameters.multigrid.smoother
                      : simulation.mass().solver())
            << '\n';
    out << std::endl;
  }



  template <int dim>
  void
  SimulationRun<dim>::print_progress(const bool is_last)
  {
    if (!parameters.output.print_times)
      return;
    const double start   = parameters.time.start;
    const double end     = parameters.end_of_run();
    const double elapsed = seconds_since(begin);
    const double part    = (simulation.state().time - start) / (end - start);
    // A terminal is refreshed five times a second, a file gets ten lines.
    if (!is_last && (is_terminal ? seconds_since(last_shown) < 0.2
                                 : part < last_shown_time + 0.1))
      return;
    last_shown      = std::chrono::steady_clock::now();
    last_shown_time = std::floor(10. * part) / 10.;
    std::ostringstream line;
    line << std::setprecision(4) << parameters.stage_text(last_stage) << "step "
         << simulation.state().n_steps << ", t = " << simulation.state().time
         << " of " << end << " s, dt = " << simulation.state().step << " s";
    if (simulation.state().n_iterations > 0)
      line << ", " << simulation.state().n_iterations << " iterations";
    line << ", " << std::setprecision(3)
         << 1e-6 * n_points * simulation.state().n_steps / elapsed
         << " M points/s, " << std::ceil(elapsed / part * (1. - part))
         << " s left";
    if (is_terminal)
      out << "\r\033[K" << line.str() << (is_last ? "\n" : "") << std::flush;
    else
      out << line.str() << std::endl;
  }



  namespace
  {
    void
    print_errors(std::ostream                &out,
                 const std::string           &what,
                 const std::optional<Errors> &errors)
    {
      if (errors)
        out << "  relative error of " << what << ": L2 " << std::setprecision(4)
            << errors->l2 << ", largest " << errors->max << '\n';
    }
  } // namespace



  template <int dim>
  void
  SimulationRun<dim>::print_summary(const RunSummary &summary)
  {
    const State<dim> &state = simulation.state();
    out << "\n  " << state.n_steps << " steps to t = " << std::setprecision(6)
        << state.time << " s, " << n_points << " points";
    if (state.n_removed > 0)
      out << ", of which " << state.n_removed << " have left the grid";
    out << '\n';
    const ConsistentMass<dim> *const mass = simulation.consistent_mass();
    if (mass && state.n_steps > 0)
      {
        const auto functions   = mass->extension().counts();
        const bool is_implicit = !simulation.solver_levels().empty();
        out << (is_implicit ? "  linear systems of Newton's method: "
                            : "  mass: ")
            << std::setprecision(3)
            << double(state.n_all_iterations) / state.n_steps
            << " iterations per step";
        if (!is_implicit)
          out << ", " << mass->n_factorizations() << " factorizations";
        out << "; at the end " << functions.stable << " stable, "
            << functions.extended << " extended, " << functions.lumped
            << " lumped functions, " << mass->n_fragments()
            << " cells of fragments\n";
      }
    if (parameters.output.print_times)
      {
        const double bytes = bytes_per_point();
        out << std::setprecision(3) << "  " << summary.wall_time << " s, "
            << 1e-6 * n_points * state.n_steps / summary.wall_time
            << " million points and steps per second, " << bytes
            << " bytes per point\n";
        const auto print = [&](const std::string &part, const double seconds) {
          out << "    " << std::left << std::setw(16) << part << std::right
              << std::fixed << std::setprecision(2) << std::setw(9) << seconds
              << " s" << std::setprecision(1) << std::setw(7)
              << 100. * seconds / summary.wall_time << " %\n"
              << std::defaultfloat;
        };
        double rest = summary.wall_time;
        for (const auto &part : simulation.part_times())
          {
            print(part.first, part.second);
            rest -= part.second;
          }
        print("output, other", rest);
      }
    print_errors(out, "displacement", summary.errors.displacement);
    print_errors(out, "velocity", summary.errors.velocity);
    print_errors(out, "stress", summary.errors.stress);
    if (summary.surface)
      out << std::setprecision(3) << "  distance to the measured surface: mean "
          << 1e3 * summary.surface->mean << " mm, largest "
          << 1e3 * summary.surface->largest << " mm; run-out " << summary.front
          << " m\n";
    if (summary.series)
      out << std::setprecision(3) << "  distance to the measured "
          << parameters.reference.series_quantity << ": mean "
          << 100. * summary.series->relative << " %, " << summary.series->n
          << " values\n";
    out << "  results: " << directory << std::endl;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_summary(const RunSummary &summary)
  {
    const State<dim> &state    = simulation.state();
    const double      critical = state.estimates.critical;
    double            n_cells  = 1.;
    for (const unsigned int n : parameters.grid.cells)
      n_cells *= n;
    JsonWriter json;
    json.add("dimension", dim)
      .add("points", n_points)
      .add("removed_points", state.n_removed)
      .add("cells", n_cells)
      .add("p", parameters.grid.degree)
      .add("mass", parameters.scheme.mass)
      .add("quadrature", parameters.scheme.quadrature)
      .add("processes", Utilities::MPI::n_mpi_processes(comm))
      .add("steps", state.n_steps)
      .add("time", state.time)
      .add("wall_time", summary.wall_time)
      .add("point_steps_per_second",
           double(n_points) * state.n_steps / summary.wall_time)
      .add("bytes_per_point", bytes_per_point())
      .add("points_sent", Utilities::MPI::sum(state.n_sent, comm));
    if (std::isfinite(critical) && critical > 0.)
      json.add("critical_step", critical);
    json.add("front", summary.front).begin("parts");
    for (const auto &part : simulation.part_times())
      json.add(part.first, part.second);
    json.end().begin("errors");
    const auto errors = [&](const std::string           &name,
                            const std::optional<Errors> &value) {
      if (value)
        json.begin(name).add("l2", value->l2).add("max", value->max).end();
    };
    errors("displacement", summary.errors.displacement);
    errors("velocity", summary.errors.velocity);
    errors("stress", summary.errors.stress);
    json.end().begin("reference");
    const auto distance = [&](const std::string             &name,
                              const std::optional<Distance> &value) {
      if (value)
        json.begin(name)
          .add("mean", value->mean)
          .add("largest", value->largest)
          .add("relative", value->relative)
          .add("values", value->n)
          .end();
    };
    distance("surface", summary.surface);
    distance("series", summary.series);
    json.end();
    run_on_first(
      [&]() { write_atomically(directory + "/summary.json", json.text()); },
      comm);
  }



  template <int dim>
  double
  SimulationRun<dim>::bytes_per_point() const
  {
    return Utilities::MPI::sum(double(simulation.points_memory()), comm) /
           n_points;
  }



  template class SimulationRun<2>;
  template class SimulationRun<3>;
} // namespace greville
