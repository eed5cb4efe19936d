// SPDX-License-Identifier: LGPL-2.1-or-later

// Estimates the cost of a run from its first steps in memory.

#include <deal.II/base/utilities.h>

#include <greville/base/memory.h>
#include <greville/run/begin_run.h>
#include <greville/run/check_materials.h>
#include <greville/run/run.h>
#include <greville/run/run_header.h>
#include <greville/run/state_output.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Limits of the trial steps: their number and their time, s.
    constexpr unsigned int most_trial_steps = 20;
    constexpr double       longest_trial    = 2.;



    using Clock = std::chrono::steady_clock;

    /// Collective. Return the maximum over all processes.
    double
    seconds_since(const Clock::time_point &begin, const MPI_Comm comm)
    {
      return Utilities::MPI::max(greville::seconds_since(begin), comm);
    }



    std::string
    duration(const double seconds)
    {
      return seconds < 120.     ? rounded(seconds, 2) + " s"
             : seconds < 7200.  ? rounded(seconds / 60., 2) + " min"
             : seconds < 172800 ? rounded(seconds / 3600., 2) + " h"
                                : rounded(seconds / 86400., 3) + " days";
    }



    std::string
    megabytes(const double bytes)
    {
      return bytes < 1e9 ? rounded(std::ceil(bytes * 1e-5) * 0.1, 3) + " MB"
                         : rounded(bytes * 1e-9, 3) + " GB";
    }



    template <int dim>
    class Trial
    {
    public:
      Trial(const SimulationParameters &parameters,
            const std::string          &directory,
            std::ostream               &out,
            const MPI_Comm              comm,
            const RunOptions           &options)
        : parameters(parameters)
        , out(out)
        , comm(comm)
        , memory_before(allocated_memory())
        , begin(Clock::now())
        , simulations(parameters, comm)
      {
        // Files and formulas that the run needs later.
        const double end = parameters.end_of_run();
        ExactSolution<dim>(parameters.exact)
          .errors(simulations.bodies(), end, end, comm);
        check_reference<dim>(parameters.reference);
        if (options.resumes)
          {
            const Checkpoint checkpoint = read_checkpoint(directory, comm);
            resume_from(simulations, checkpoint, parameters);
            out << "It would resume from <" << checkpoint.file << ">, step "
                << common().n_steps << ", t = " << common().time << " s.\n\n";
          }
        else if (!options.from.empty())
          {
            const Checkpoint other = read_checkpoint(options.from, comm);
            begin_with(simulations, other, parameters);
            out << "It would begin with <" << other.file << ">.\n\n";
          }
        const auto        all = simulations.bodies_of_all_stages();
        const Probes<dim> probes(parameters.output.probes,
                                 parameters.output.fields,
                                 all.list,
                                 comm);
        EndOfRun(parameters,
                 SimulationRun<dim>::columns_of(parameters, probes));
        set_up = seconds_since(begin, comm);
        print_header(out, simulations, parameters, comm);
        const std::string imbalance =
          print_imbalance(out, simulations, parameters, comm);
        print_materials(out, all.list);
        print_tangents(out, all.list, comm);
        print_bodies(all.list);
        print_surface_loads();
        auto notes = input_notes(simulations.bodies(), parameters, comm);
        if (!imbalance.empty())
          notes.insert(notes.begin(), imbalance);
        for (const std::string &note : simulations.notes())
          notes.push_back(note);
        for (const std::string &note : notes)
          out << "  Note: " << note << '\n';
        print_warnings(simulations);
      }

      /// Write the initial points to the folder @p drawing unless it is empty,
      /// take trial steps of all stages, and write the results.
      void
      report(const std::string &drawing)
      {
        if (!drawing.empty())
          draw(drawing);
        std::uint64_t cells = 0, functions = 0, points = 0;
        for (unsigned int k = 0; k < simulations.n_parts(); ++k)
          {
            const SplineSpace<dim> &space = simulations.part(k).space();
            cells += space.triangulation().n_global_active_cells();
            functions += space.n_dofs();
          }
        for (const Body<dim> &body : simulations.bodies())
          points += body.n_points;
        out << "  cells: " << cells << ", B-splines: " << functions
            << " for each component, points: " << points << '\n';
        print_levels();

        const unsigned int stage    = common().stage;
        const unsigned int n_stages = parameters.n_stages();
        double             total    = report_stage(simulations, stage, set_up);
        for (unsigned int k = stage + 1; k < n_stages; ++k)
          total += report_later_stage(k);
        if (n_stages > stage + 1)
          out << "  estimated time of all stages: " << duration(total) << '\n';
        print_memory();
      }

    private:
      /// Write how many cells of a refined grid are halved how often.
      void
      print_levels()
      {
        if (!parameters.grid.is_refined())
          return;
        for (unsigned int k = 0; k < simulations.n_parts(); ++k)
          {
            Simulation<dim>          &part   = simulations.part(k);
            const SplineSpace<dim>   &space  = part.space();
            const CellHierarchy<dim> &levels = *space.hierarchy();
            std::vector<unsigned int> counts(levels.n_levels(), 0);
            for (unsigned int cell = 0; cell < space.owned_cells().size();
                 ++cell)
              ++counts[levels.level(space.box(cell).index)];
            Utilities::MPI::sum(counts, comm, counts);
            out << "  cells" << part.step_log().of
                << " that are halved 0, 1, ... times: ";
            for (unsigned int l = 0; l < counts.size(); ++l)
              out << (l > 0 ? ", " : "") << counts[l];
            out << '\n';
          }
      }

      void
      draw(const std::string &folder)
      {
        run_on_first(comm, [&]() {
          Require(!std::filesystem::exists(folder) ||
                    (std::filesystem::is_directory(folder) &&
                     std::filesystem::is_empty(folder)),
                  "The folder <" + folder +
                    "> of --draw is not empty: name a new one.");
          create_folder(folder, "--draw");
          write_atomically(folder + "/parameters.prm", parameters.used());
        });
        OutputParameters drawn = parameters.output;
        if (parameters.grid.is_refined() && !contains(drawn.fields, "level"))
          drawn.fields.push_back("level");
        FieldOutput<dim> output(folder, drawn);
        output.hold();
        for (unsigned int k = 0; k < simulations.n_parts(); ++k)
          {
            simulations.part(k).loaded_surfaces();
            write_bodies(output, simulations, k, parameters, comm);
          }
        // Pictures of refined grids take the cells from this file.
        if (parameters.grid.is_refined())
          {
            const Simulation<dim> &part = simulations.part(0);
            simulations.fill_grid();
            GridFields<dim> grid;
            grid.velocity = part.state().field.velocity;
            grid.mass     = part.mass().lumped();
            output.write_grid(part.state().time, part.space(), grid);
          }
        output.write_held(comm);
        out << "  initial points: " << folder << '/'
            << FieldOutput<dim>::series_name << '\n';
      }

      const State<dim> &
      common() const
      {
        return simulations.first().state();
      }

      /// Return the text for 3D, axisymmetry or plane strain.
      const char *
      in_geometry(const char *in_3d,
                  const char *in_axisymmetry,
                  const char *in_plane_strain) const
      {
        return dim == 3                            ? in_3d
               : parameters.grid.is_axisymmetric() ? in_axisymmetry
                                                   : in_plane_strain;
      }

      /// Write mass and volume, which reveal wrong shapes and units.
      void
      print_bodies(const BodyList<dim> &bodies)
      {
        out << "  body             " << std::right << std::setw(12)
            << in_geometry("mass, kg", "mass, kg/rad", "mass, kg/m")
            << std::setw(14)
            << in_geometry("volume, m^3", "vol., m^3/rad", "area, m^2") << '\n';
        for (const Body<dim> &body : bodies)
          {
            // A body without a name is another material of a stage.
            if (body.name.empty())
              continue;
            double mass = 0., volume = 0.;
            body.points.for_each([&](ConstPointRef<dim> p) {
              mass += p.mass();
              volume += p.volume();
            });
            out << "  " << std::left << std::setw(16) << body.name << std::right
                << std::setw(13) << rounded(Utilities::MPI::sum(mass, comm), 6)
                << std::setw(14)
                << rounded(Utilities::MPI::sum(volume, comm), 6) << '\n';
          }
      }

      /// Write the initial areas of loaded surfaces, and the forces on them at
      /// the start and the end of the run.
      void
      print_surface_loads()
      {
        if (parameters.general.surface_loads.empty())
          return;
        out << "  surface load     " << std::right << std::setw(12)
            << in_geometry("area, m^2", "area, m^2/rad", "length, m")
            << in_geometry("   force, N", "   force, N/rad", "   force, N/m")
            << '\n';
        for (unsigned int k = 0; k < simulations.n_parts(); ++k)
          {
            const Simulation<dim>  &part = simulations.part(k);
            const SurfaceLoads<dim> loads(part.stage_parameters());
            const auto             &surfaces = part.state().surfaces;
            const double            t        = common().time;
            const double            end      = parameters.end_of_run();
            const auto              first = loads.resultants(surfaces, t, comm);
            const auto last = loads.resultants(surfaces, end, comm);
            for (unsigned int s = 0; s < first.size(); ++s)
              {
                double area = 0.;
                surfaces[s].points.for_each(
                  [&](ConstPointRef<dim> p) { area += p.mass(); });
                const auto text = [](const Tensor<1, dim> &force) {
                  std::string result;
                  for (unsigned int d = 0; d < dim; ++d)
                    result += (d > 0 ? ", " : "(") + rounded(force[d], 4);
                  return result + ")";
                };
                out << "  " << std::left << std::setw(16) << first[s].first
                    << std::right << std::setw(13)
                    << rounded(Utilities::MPI::sum(area, comm), 6) << "   "
                    << text(first[s].second) << " at t = " << rounded(t, 3)
                    << " s, " << text(last[s].second)
                    << " at t = " << rounded(end, 3) << " s\n";
              }
          }
      }

      void
      print_warnings(CoupledSimulations<dim> &trial)
      {
        for (const std::string &warning : trial.take_warnings())
          out << "Warning: " << warning << std::endl;
      }

      /// Take steps in the stage of @p trial, and write the results. Returns
      /// the estimated time of the stage, s, including @p set_up.
      double
      report_stage(CoupledSimulations<dim> &trial,
                   const unsigned int       stage,
                   const double             set_up)
      {
        const auto state = [&]() -> const State<dim> & {
          return trial.first().state();
        };
        const TimeParameters &times = trial.first().stage_parameters().time;
        const double          begin_of_trial = state().time, end = times.end;
        const unsigned int    first       = state().n_steps;
        const bool            is_explicit = !trial.first().is_implicit();
        double                first_step = 0., steps = 0.;
        unsigned int          n     = 0;
        const auto            start = Clock::now();
        while (!trial.is_finished() && n < most_trial_steps &&
               (n == 0 || seconds_since(start, comm) < longest_trial) &&
               !(n > 0 && trial.first().is_stage_finished()))
          {
            const auto before = Clock::now();
            trial.step();
            (n == 0 ? first_step : steps) += seconds_since(before, comm);
            ++n;
          }
        print_warnings(trial);
        if (n == 0)
          {
            out << "  The run is at its end: there is no step to take.\n";
            return set_up;
          }
        if (parameters.n_stages() > 1)
          out << "  " << Utilities::trim(parameters.stage_text(stage)) << '\n';
        if (is_explicit)
          print_critical_step(trial);
        const double dt      = (state().time - begin_of_trial) / n;
        double       n_steps = std::ceil((end - begin_of_trial) / dt - 1e-6);
        const unsigned int limit  = parameters.time.max_steps;
        const bool         is_cut = limit > 0 && n_steps > limit - first;
        if (is_cut)
          n_steps = limit - first;
        const double each  = n > 1 ? steps / (n - 1) : first_step;
        const double total = set_up + first_step + each * (n_steps - 1.);
        out << "  step: " << rounded(dt, 4) << " s, the mean of " << n
            << " trial step(s) from t = " << rounded(begin_of_trial, 3)
            << " s\n"
            << "  number of steps: " << (is_cut ? "" : "about ")
            << std::uint64_t(n_steps)
            << (is_cut ? ", as 'Time/Maximum steps' says"
                       : " to t = " + rounded(end, 3) + " s")
            << (!is_cut && is_explicit && times.step.empty()
                  ? ", if later ones are as long"
                  : "")
            << '\n'
            << "  estimated time: " << duration(total)
            << (is_explicit ? ""
                            : ", or more if later steps need more iterations")
            << ": " << rounded(set_up, 2) << " s to set up, then "
            << rounded(each, 2) << " s for each step, the mean of "
            << (n > 1 ? std::to_string(n - 1) + " trial step(s) after the first"
                      : "the first trial step")
            << ", without output files\n";
        return total;
      }

      /// Try a later stage as if it began with the initial bodies.
      double
      report_later_stage(const unsigned int stage)
      {
        SimulationParameters later = parameters;
        later.stages.erase(later.stages.begin(), later.stages.begin() + stage);
        later.stages[0].time.start = parameters.stages[stage - 1].time.end;
        later.time.start           = later.stages[0].time.start;
        try
          {
            const auto              start = Clock::now();
            CoupledSimulations<dim> trial(later, comm);
            return report_stage(trial, stage, seconds_since(start, comm));
          }
        catch (const std::exception &error)
          {
            // The stage may need the state after the stages before it.
            out << "  " << Utilities::trim(parameters.stage_text(stage))
                << "\n  its steps cannot be tried from the initial state: "
                << message_of(error) << '\n';
            return 0.;
          }
      }

      void
      print_critical_step(const CoupledSimulations<dim> &trial)
      {
        double critical = 0.;
        for (unsigned int k = 0; k < trial.n_parts(); ++k)
          {
            const double own = trial.part(k).state().estimates.critical;
            critical         = k == 0 ? own : std::min(critical, own);
          }
        if (critical > 0. && std::isfinite(critical))
          out << "  critical step: " << rounded(critical, 4) << " s\n";
        else
          out << "  critical step: not estimated, as 'Time/Too large step' is "
                 "ignore or nothing is stiff or viscous\n";
      }

      void
      print_memory()
      {
        const double points =
          Utilities::MPI::sum(double(simulations.points_memory()), comm);
        Utilities::System::MemoryStats process;
        Utilities::System::get_memory_stats(process);
        const double resident =
          Utilities::MPI::sum(1024. * process.VmHWM, comm);
        out << "  memory: at most " << megabytes(resident)
            << " of all processes with their libraries";
        const auto now = allocated_memory();
        if (memory_before && now)
          {
            const double own = std::max(
              points,
              Utilities::MPI::sum(double(*now) - double(*memory_before), comm));
            const double rest = own - points;
            out << "; of it the simulation holds " << megabytes(own) << ":\n"
                << "    points, with a copy to go back to: "
                << megabytes(points)
                << ", grid, mass and solvers: " << megabytes(rest) << "; "
                << (points > rest ? "points dominate: fewer 'Points per "
                                    "direction' or cells"
                                  : "the grid dominates: fewer cells, a lower "
                                    "order or a simpler mass")
                << " would take less";
          }
        out << "\n" << std::endl;
      }

      const SimulationParameters         parameters;
      std::ostream                      &out;
      MPI_Comm                           comm;
      const std::optional<unsigned long> memory_before;
      const Clock::time_point            begin;
      CoupledSimulations<dim>            simulations;
      double                             set_up = 0.; // s
    };

  } // namespace



  void
  check_simulations(const std::string &file,
                    const MPI_Comm     comm,
                    const RunOptions  &options,
                    const std::string &drawing)
  {
    SimulationParameters parameters(file, options.settings);
    refuse_sweep(parameters, file);
    if (parameters.general.dimension == 2)
      adapt_at_start<2>(parameters, comm);
    else
      adapt_at_start<3>(parameters, comm);
    const bool        is_first = Utilities::MPI::this_mpi_process(comm) == 0;
    std::ostream      nowhere(nullptr);
    std::ostream     &out       = is_first ? std::cout : nowhere;
    const std::string directory = folder_of_run(parameters, file, options);
    check_other_folder(options, directory, comm);
    out << "Check of " << file
        << ": the steps below are tried in memory, no results are written.\n\n";
    for (const std::string &note : repeated_parameters(file))
      out << "  Note: " << note << '\n';
    if (parameters.general.dimension == 2)
      Trial<2>(parameters, directory, out, comm, options).report(drawing);
    else
      Trial<3>(parameters, directory, out, comm, options).report(drawing);
    out << "  results of a run: " << directory << std::endl;
  }
} // namespace greville
