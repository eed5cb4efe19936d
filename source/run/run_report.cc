// SPDX-License-Identifier: LGPL-2.1-or-later

// Prints the report of a SimulationRun, and writes summary.json.

#include <greville/base/json.h>
#include <greville/parameters/unit_of_sums.h>
#include <greville/run/simulation_run.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Spurious energy of a contact that the summary reports, as a fraction of
    // the largest energy or work.
    constexpr double noted_gain = 0.01;



    /// Return the microseconds of a process per point and step.
    double
    cost_of_point(const double       wall_time,
                  const double       n_points,
                  const unsigned int n_steps,
                  const MPI_Comm     comm)
    {
      return 1e6 * wall_time * Utilities::MPI::n_mpi_processes(comm) /
             (n_points * n_steps);
    }



    /// Return a judgement of an energy loss, relative to the largest energy or
    /// work, with the remedy.
    std::string
    judgement_of_loss(const double loss, const SchemeParameters &scheme)
    {
      if (loss < -0.01)
        return "gained, less with shorter steps";
      if (loss < 0.02)
        return "low";
      std::string remedy = "shorter steps";
      if (scheme.is_backward_euler())
        remedy += ", or 'Scheme/Stress update' = implicit-midpoint";
      else if (is_explicit_scheme(scheme.stress_update))
        {
          remedy = "smaller cells";
          if (scheme.is_flip() && scheme.flip < 1.)
            remedy += ", a 'Scheme/FLIP share' (" + text_of(scheme.flip) +
                      ") closer to 1, or 'Scheme/Transfer' = APIC";
          else if (scheme.is_pic())
            remedy += ", or 'Scheme/Transfer' = APIC or FLIP";
          else if (scheme.has_lumped_mass())
            remedy += ", or 'Scheme/Mass' = consistent";
        }
      return (loss < 0.1 ? "moderate, less with " : "high, less with ") +
             remedy;
    }
  } // namespace



  template <int dim>
  void
  SimulationRun<dim>::print_progress(const bool is_last)
  {
    const double start   = parameters.time.start;
    const double end     = parameters.end_of_run();
    const double elapsed = seconds_since(begin);
    const double part    = (common().time - start) / (end - start);
    const double begun   = (first_time - start) / (end - start);
    const double dt      = common().step;
    if (common().n_steps == first_step + 1 && parameters.time.step.empty() &&
        is_explicit_scheme(parameters.scheme.stress_update) && dt > 0.)
      {
        out << "automatic steps: the first one is " << std::setprecision(3)
            << dt << " s";
        if (parameters.scheme.is_total_lagrangian())
          out << "; they become shorter if cells are crushed";
        out << std::endl;
      }
    // Refresh a terminal five times a second; write a line to a file for each
    // tenth of the time, and after ten seconds.
    const double waited = seconds_since(last_shown);
    if (!is_last &&
        (is_terminal ? waited < 0.2
                     : part < last_shown_time + 0.1 && waited < 10.))
      return;
    last_shown      = std::chrono::steady_clock::now();
    last_shown_time = std::floor(10. * part) / 10.;
    std::ostringstream line;
    line << std::setprecision(4) << parameters.stage_text(last_stage) << "step "
         << common().n_steps << ", t = " << common().time << " of " << end
         << " s, dt = " << common().step << " s";
    const double n_iterations = iterations_per_step();
    line << std::setprecision(3);
    if (n_iterations > 0.)
      line << ", " << n_iterations << " iterations per step";
    line << ", "
         << cost_of_point(elapsed,
                          n_points,
                          common().n_steps - first_step,
                          comm)
         << " us per point and step, "
         << std::ceil(elapsed / (part - begun) * (1. - part)) << " s left";
    if (is_terminal)
      out << "\r\033[K" << line.str() << (is_last ? "\n" : "") << std::flush;
    else
      out << line.str() << std::endl;
  }



  template <int dim>
  void
  SimulationRun<dim>::print_systems()
  {
    typename Extension<dim>::Counts functions;
    std::uint64_t                   n_factorizations = 0, n_fragments = 0;
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        const GridMass<dim> &mass   = simulations.part(k).mass();
        const auto           counts = mass.counts();
        functions.stable += counts.stable;
        functions.extended += counts.extended;
        functions.lumped += counts.lumped;
        n_factorizations += mass.n_factorizations();
        n_fragments += mass.n_fragments();
      }
    const bool is_implicit = simulations.first().is_implicit();
    out << (is_implicit ? "  linear systems of Newton's method: " : "  mass: ")
        << std::setprecision(3) << iterations_per_step()
        << " iterations per step";
    if (!is_implicit)
      out << ", " << n_factorizations << " factorizations";
    out << "; at the end " << functions.stable << " stable, "
        << functions.extended << " extended, " << functions.lumped
        << " lumped functions, " << n_fragments << " cells of fragments\n";
  }



  template <int dim>
  void
  SimulationRun<dim>::print_times(const double wall_time)
  {
    const double bytes = bytes_per_point();
    out << std::setprecision(3) << "  " << wall_time << " s";
    if (common().n_steps > first_step)
      out << ", "
          << cost_of_point(wall_time,
                           n_points,
                           common().n_steps - first_step,
                           comm)
          << " us per point, step and process";
    out << "; memory of points " << 1e-6 * bytes * n_points << " MB, " << bytes
        << " bytes each\n";
    const auto print = [&](const std::string &part, const double seconds) {
      out << "    " << std::left << std::setw(16) << part << std::right
          << std::fixed << std::setprecision(2) << std::setw(9) << seconds
          << " s" << std::setprecision(1) << std::setw(7)
          << 100. * seconds / wall_time << " %\n"
          << std::defaultfloat;
    };
    double rest = wall_time;
    for (const auto &part : simulations.part_times())
      {
        print(part.first, part.second);
        rest -= part.second;
      }
    print("output, other", rest);
  }



  template <int dim>
  void
  SimulationRun<dim>::print_summary(const RunSummary &summary)
  {
    const State<dim>   &state     = common();
    const std::uint64_t n_removed = simulations.sum(&State<dim>::n_removed);
    out << "\n  " << state.n_steps << " steps to t = " << std::setprecision(6)
        << state.time << " s, " << n_points << " points";
    if (n_removed > 0)
      out << ", of which " << n_removed << " have left the grid";
    const auto n_redone = simulations.sum(&State<dim>::n_all_rejections);
    if (n_redone > 0)
      out << "; " << n_redone << (n_redone == 1 ? " step was" : " steps were")
          << " done again with a shorter length";
    out << '\n';
    if (summary.ramp && std::isfinite(summary.ramp->to))
      out << "  factor at failure: " << std::setprecision(5)
          << summary.ramp->factor() << " (equilibrium at " << summary.ramp->from
          << ", failure at " << summary.ramp->to << ")\n";
    else if (summary.ramp)
      out << "  no failure up to a factor of " << std::setprecision(5)
          << summary.ramp->from << '\n';
    else if (ends)
      out << "  ended early: 'Time/End when' holds\n";
    if (simulations.exceeds_displacement())
      out << "  ended early: a point has moved further than 'Time/Largest "
             "displacement'\n";
    // A resumed run that is already at its end has no mass matrix.
    if (simulations.first().mass().is_exact() && state.n_steps > first_step)
      print_systems();
    print_times(summary.wall_time);
    if (state.n_steps > 0)
      out << std::setprecision(3)
          << "  numerical loss of energy: " << 100. * summary.relative_loss
          << " % of the largest energy or work (" << summary.numerical_loss
          << ' ' << unit_of_sums("J", dim, parameters.grid) << "): "
          << judgement_of_loss(summary.relative_loss,
                               simulations.first().stage_parameters().scheme)
          << '\n';
    for (const auto &[name, gain] : summary.contact_gains)
      if (gain > noted_gain)
        out << std::setprecision(3) << "  'Contact " << name << "' has given "
            << 100. * gain
            << " % of the largest energy or work to the bodies from nothing: "
               "less with shorter steps or a smaller 'Contact "
            << name << "/Penalty'\n";
    for (const auto &[name, errors] :
         {std::make_pair("displacement", summary.errors.displacement),
          std::make_pair("velocity", summary.errors.velocity),
          std::make_pair("stress", summary.errors.stress)})
      if (errors)
        out << "  relative error of " << name << ": L2 " << std::setprecision(4)
            << errors->l2 << ", largest " << errors->max << '\n';
    out << "  results: " << directory << std::endl;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_summary(const RunSummary &summary)
  {
    const State<dim> &state    = common();
    double            critical = state.estimates.critical, n_cells = 0.;
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        const Simulation<dim> &part = simulations.part(k);
        critical         = std::min(critical, part.state().estimates.critical);
        double n_of_part = 1.;
        for (const unsigned int n : part.stage_parameters().grid.cells)
          n_of_part *= n;
        n_cells += n_of_part;
      }
    JsonWriter json;
    json.add("dimension", dim)
      .add("points", n_points)
      .add("removed_points", simulations.sum(&State<dim>::n_removed))
      .add("cells", n_cells)
      .add("p", parameters.grid.degree)
      .add("mass", parameters.scheme.mass)
      .add("processes", Utilities::MPI::n_mpi_processes(comm))
      .add("steps", state.n_steps)
      .add("redone_steps", simulations.sum(&State<dim>::n_all_rejections))
      .add("time", state.time)
      .add("wall_time", summary.wall_time)
      .add("point_steps_per_second",
           double(n_points) * (state.n_steps - first_step) / summary.wall_time)
      .add("bytes_per_point", bytes_per_point())
      .add("points_sent",
           Utilities::MPI::sum(simulations.sum(&State<dim>::n_sent), comm));
    if (std::isfinite(critical) && critical > 0.)
      json.add("critical_step", critical);
    if (!parameters.stages.empty())
      {
        json.begin("stages");
        for (const StageParameters &stage : parameters.stages)
          json.add(stage.name, stage.scheme.mass);
        json.end();
      }
    if (summary.ramp)
      {
        json.begin("ramp")
          .add("factor", summary.ramp->factor())
          .add("from", summary.ramp->from);
        if (std::isfinite(summary.ramp->to))
          json.add("to", summary.ramp->to);
        json.end();
      }
    json.add("front", summary.runout)
      .add("front_99", summary.runout_99)
      .begin("energy")
      .add("numerical_loss", summary.numerical_loss)
      .add("relative_loss", summary.relative_loss)
      .add("judgement",
           judgement_of_loss(summary.relative_loss,
                             simulations.first().stage_parameters().scheme));
    if (!summary.contact_gains.empty())
      {
        json.begin("contact_gains");
        for (const auto &[name, gain] : summary.contact_gains)
          json.add(name, gain);
        json.end();
      }
    json.end().begin("parts");
    for (const auto &part : simulations.part_times())
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
    json.end();
    run_on_first(comm, [&]() {
      write_atomically(directory + "/summary.json", json.text());
    });
  }



  GREVILLE_INSTANTIATE_CLASS(SimulationRun);
} // namespace greville
