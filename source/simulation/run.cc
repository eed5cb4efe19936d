// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/json.h>
#include <greville/base/parameters.h>
#include <greville/simulation/run.h>

#include <algorithm>
#include <cerrno>
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
    , fields(directory, parameters.output.grid_fields)
    , probes(parameters.output.probes,
             simulation.bodies(),
             directory + "/probes.csv",
             comm)
    , is_terminal(isatty(STDOUT_FILENO) == 1)
  {
    run_on_all(
      [&]() {
        if (!is_first)
          return;
        const std::string file = directory + "/statistics.csv";
        errno                  = 0;
        statistics_file.open(file);
        const auto names = Statistics<dim>::names();
        for (std::size_t k = 0; k < names.size(); ++k)
          statistics_file << (k > 0 ? "," : "") << names[k];
        statistics_file << std::endl;
        statistics_file.precision(14);
        AssertThrow(statistics_file, ExcMessage(write_error(file)));
      },
      comm);
    // A formula that fails is better found now than at the end.
    const double end = parameters.time.end;
    exact.displacement(simulation.bodies(), end, comm);
    exact.velocity(simulation.bodies(), end, comm);
    exact.stress(simulation.bodies(), end, comm);
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
            fields.write_points(simulation.time(), simulation.bodies(), comm);
            throw;
          }
        for (const std::string &warning : simulation.take_warnings())
          out << "Warning: " << warning << std::endl;
        const bool is_last = simulation.is_finished();
        write_due(is_last);
        print_progress(is_last);
      }

    RunSummary summary;
    summary.wall_time  = seconds_since(begin);
    summary.n_removed  = simulation.n_removed();
    summary.n_sent     = simulation.n_sent();
    summary.n_steps    = simulation.n_steps();
    summary.time       = simulation.time();
    summary.critical   = simulation.critical();
    summary.part_times = simulation.part_times();
    summary.front      = largest_front;
    for (const Body<dim> &body : simulation.bodies())
      summary.n_points += body.n_points;
    summary.bytes_per_point =
      Utilities::MPI::sum(double(simulation.points_memory()), comm) /
      summary.n_points;

    const double t       = simulation.time();
    summary.displacement = exact.displacement(simulation.bodies(), t, comm);
    // Velocities at half steps are those of the middle of the last step.
    const double half = parameters.time.velocities == "half steps"
                          ? 0.5 * simulation.last_step()
                          : 0.;
    summary.velocity  = exact.velocity(simulation.bodies(), t - half, comm);
    summary.stress    = exact.stress(simulation.bodies(), t, comm);
    if (measured.has_surface())
      summary.surface =
        measured.surface_distance(simulation.bodies(),
                                  simulation.space().lattice().cell_size(0),
                                  simulation.space().lattice().lower(1),
                                  comm);
    if (measured.has_series())
      summary.series = measured.series_distance();
    print_summary(summary);
    run_on_all(
      [&]() {
        if (is_first)
          write_summary(summary);
      },
      comm);
    return summary;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_due(const bool is_last)
  {
    const OutputParameters &output = parameters.output;
    const double            now    = simulation.time() * (1. + 1e-12);
    if (is_last || now >= next_statistics)
      {
        write_statistics();
        next_statistics += output.statistics_every;
      }
    if (is_last || now >= next_fields)
      {
        write_fields();
        next_fields = output.fields_every > 0.
                        ? next_fields + output.fields_every
                        : std::numeric_limits<double>::infinity();
      }
  }



  template <int dim>
  void
  SimulationRun<dim>::write_fields()
  {
    fields.write(simulation.time(),
                 simulation.bodies(),
                 simulation.space(),
                 simulation.grid_velocity(),
                 simulation.mass().lumped());
  }



  template <int dim>
  void
  SimulationRun<dim>::write_statistics()
  {
    const Statistics<dim> row = simulation.statistics();
    largest_front             = std::max(largest_front, row.front);
    measured.add(row);
    probes.write(simulation.time(), simulation.bodies());
    run_on_all(
      [&]() {
        if (!is_first)
          return;
        errno             = 0;
        const auto values = row.values();
        for (std::size_t k = 0; k < values.size(); ++k)
          statistics_file << (k > 0 ? "," : "") << values[k];
        statistics_file << std::endl;
        AssertThrow(statistics_file,
                    ExcMessage(write_error(directory + "/statistics.csv")));
      },
      comm);
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
        << parameters.grid.degree << "\n  mass: " << parameters.scheme.mass;
    if (simulation.mass().solver() != parameters.scheme.mass)
      out << " (" << simulation.mass().solver() << ")";
    out << ", " << parameters.scheme.stress_update << ", "
        << parameters.scheme.transfer << ", quadrature by "
        << parameters.scheme.quadrature << "\n\n";

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
    const double end     = parameters.time.end;
    const double elapsed = seconds_since(begin);
    const double part    = simulation.time() / end;
    // A terminal is refreshed five times a second, a file gets ten lines.
    if (!is_last && (is_terminal ? seconds_since(last_shown) < 0.2
                                 : part < last_shown_time + 0.1))
      return;
    last_shown             = std::chrono::steady_clock::now();
    last_shown_time        = std::floor(10. * part) / 10.;
    std::uint64_t n_points = 0;
    for (const Body<dim> &body : simulation.bodies())
      n_points += body.n_points;
    std::ostringstream line;
    line << std::setprecision(4) << "step " << simulation.n_steps()
         << ", t = " << simulation.time() << " of " << end
         << " s, dt = " << simulation.last_step() << " s";
    if (simulation.n_iterations() > 0)
      line << ", " << simulation.n_iterations() << " iterations";
    line << ", " << std::setprecision(3)
         << double(n_points) * simulation.n_steps() / elapsed * 1e-6
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
    out << "\n  " << summary.n_steps << " steps to t = " << std::setprecision(6)
        << summary.time << " s, " << summary.n_points << " points";
    if (summary.n_removed > 0)
      out << ", of which " << summary.n_removed << " have left the grid";
    out << '\n';
    const ConsistentMass<dim> *const mass = simulation.consistent_mass();
    if (mass && simulation.n_steps() > 0)
      {
        const auto functions = mass->extension().counts();
        const auto fragments = mass->n_fragments();
        out << "  mass: " << std::setprecision(3)
            << double(simulation.n_all_iterations()) /
                 std::max(1u, simulation.n_steps())
            << " iterations per step, " << mass->n_factorizations()
            << " factorizations; at the end " << functions.stable << " stable, "
            << functions.extended << " extended, " << functions.lumped
            << " lumped functions, " << fragments << " cells of fragments\n";
      }
    if (parameters.output.print_times)
      {
        out << std::setprecision(3) << "  " << summary.wall_time << " s, "
            << summary.point_steps_per_second() * 1e-6
            << " million points and steps per second, "
            << summary.bytes_per_point << " bytes per point\n";
        double sum = 0.;
        for (const auto &part : summary.part_times)
          sum += part.second;
        for (const auto &part : summary.part_times)
          out << "    " << std::left << std::setw(16) << part.first
              << std::right << std::fixed << std::setprecision(2)
              << std::setw(9) << part.second << " s" << std::setprecision(1)
              << std::setw(7) << 100. * part.second / summary.wall_time
              << " %\n"
              << std::defaultfloat;
        out << "    " << std::left << std::setw(16) << "output, other"
            << std::right << std::fixed << std::setprecision(2) << std::setw(9)
            << summary.wall_time - sum << " s" << std::setprecision(1)
            << std::setw(7)
            << 100. * (summary.wall_time - sum) / summary.wall_time << " %\n"
            << std::defaultfloat;
      }
    print_errors(out, "displacement", summary.displacement);
    print_errors(out, "velocity", summary.velocity);
    print_errors(out, "stress", summary.stress);
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
    double n_cells = 1.;
    for (const unsigned int n : parameters.grid.cells)
      n_cells *= n;
    JsonWriter json;
    json.add("dimension", dim)
      .add("points", summary.n_points)
      .add("removed_points", summary.n_removed)
      .add("cells", n_cells)
      .add("p", parameters.grid.degree)
      .add("mass", parameters.scheme.mass)
      .add("quadrature", parameters.scheme.quadrature)
      .add("processes", Utilities::MPI::n_mpi_processes(comm))
      .add("steps", summary.n_steps)
      .add("time", summary.time)
      .add("wall_time", summary.wall_time)
      .add("point_steps_per_second", summary.point_steps_per_second())
      .add("bytes_per_point", summary.bytes_per_point)
      .add("points_sent", summary.n_sent);
    if (std::isfinite(summary.critical) && summary.critical > 0.)
      json.add("critical_step", summary.critical);
    json.add("front", summary.front).begin("parts");
    for (const auto &part : summary.part_times)
      json.add(part.first, part.second);
    json.end().begin("errors");
    const auto errors = [&](const std::string           &name,
                            const std::optional<Errors> &value) {
      if (value)
        json.begin(name).add("l2", value->l2).add("max", value->max).end();
    };
    errors("displacement", summary.displacement);
    errors("velocity", summary.velocity);
    errors("stress", summary.stress);
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
    write_atomically(directory + "/summary.json", json.text());
  }



  template class SimulationRun<2>;
  template class SimulationRun<3>;
} // namespace greville
