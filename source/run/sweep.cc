// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/base/signals.h>
#include <greville/run/check_materials.h>
#include <greville/run/run.h>
#include <greville/run/sweep.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>

namespace greville
{
  using namespace dealii;

  std::string
  folder_of_run(const SimulationParameters &parameters,
                const std::string          &file,
                const RunOptions           &options)
  {
    // What a run has left in its folder names another one if that has moved.
    const std::filesystem::path path(file);
    const std::string           given = parameters.output.directory.empty()
                                          ? "output/" + parameters.general.name
                                          : parameters.output.directory;
    if (!options.resumes || path.filename() != "parameters.prm")
      return given;
    const auto own = std::filesystem::absolute(path).parent_path();
    for (const std::string &setting : options.settings)
      {
        std::error_code error;
        AssertThrow(setting.rfind("Output/Directory", 0) != 0 ||
                      std::filesystem::equivalent(given, own, error),
                    ExcMessage("The option --set <" + setting +
                               ">: a run goes on in its folder, <" +
                               own.string() +
                               ">. Move that, and go on from there."));
      }
    return own.string();
  }



  EarlierResults
  what_of_earlier(const SimulationParameters &parameters,
                  const RunOptions           &options)
  {
    const std::string &word = parameters.output.earlier_results;
    return options.resumes        ? EarlierResults::keep
           : word == "move aside" ? EarlierResults::move_aside
           : word == "refuse"     ? EarlierResults::refuse
                                  : EarlierResults::remove;
  }



  void
  check_other_folder(const RunOptions  &options,
                     const std::string &folder,
                     const MPI_Comm     comm)
  {
    if (options.from.empty())
      return;
    run_on_first(
      [&]() {
        std::error_code error;
        AssertThrow(!std::filesystem::equivalent(options.from, folder, error),
                    ExcMessage("--from names the folder <" + options.from +
                               "> of this run itself: give the new run "
                               "another 'Output/Directory'."));
      },
      comm);
  }



  namespace
  {
    /**
     * What the run in a folder goes on with, and what others read of it.
     */
    void
    write_parameters(const SimulationParameters &parameters,
                     const std::string          &folder,
                     const MPI_Comm              comm)
    {
      run_on_first(
        [&]() {
          write_atomically(folder + "/parameters.prm", parameters.used());
        },
        comm);
    }



    bool
    same_kind(const SimulationParameters &a, const SimulationParameters &b)
    {
      return a.grid.degree == b.grid.degree &&
             a.scheme.formulation == b.scheme.formulation &&
             a.scheme.mass == b.scheme.mass;
    }



    /**
     * sweep.csv: what each run has been, and the last row of its statistics.
     */
    void
    write_results(const std::vector<SweepRow> &rows,
                  const SweepParameters       &sweep,
                  const std::string           &directory,
                  const MPI_Comm               comm)
    {
      std::vector<std::string> columns;
      for (const SweepRow &row : rows)
        for (const auto &result : row.results)
          if (std::find(columns.begin(), columns.end(), result.first) ==
              columns.end())
            columns.push_back(result.first);
      std::ostringstream csv;
      csv << "run,value,formulation,mass,p,cells,failed";
      for (const std::string &column : columns)
        csv << "," << column;
      csv << '\n' << std::setprecision(10);
      for (const SweepRow &row : rows)
        {
          const SchemeParameters &scheme = row.parameters.scheme;
          std::string             value  = row.value;
          std::replace(value.begin(), value.end(), ',', ' ');
          csv << row.folder(sweep) << "," << value << "," << scheme.formulation
              << "," << scheme.mass << "," << row.parameters.grid.degree << ","
              << row.cells << "," << !row.failure.empty();
          for (const std::string &column : columns)
            {
              csv << ",";
              for (const auto &[name, number] : row.results)
                if (name == column)
                  csv << number;
            }
          csv << '\n';
        }
      run_on_first(
        [&]() { write_atomically(directory + "/sweep.csv", csv.str()); }, comm);
    }



    /**
     * A line for each run: of a ramp the factor, else the last time.
     */
    void
    print_rows(const std::vector<SweepRow> &rows,
               const SweepParameters       &sweep,
               const std::string           &directory,
               std::ostream                &out)
    {
      for (const SweepRow &row : rows)
        {
          out << "  " << std::left << std::setw(32) << row.folder(sweep)
              << std::right;
          if (!row.failure.empty())
            out << "  failed";
          for (const auto &[name, number] : row.results)
            if (name == "time" || name == "failure_factor")
              out << "  " << (name == "time" ? "t" : "factor") << " = "
                  << std::setprecision(5) << number;
          out << '\n';
        }
      out << "  table: " << directory << "/sweep.csv" << std::endl;
    }



    void
    write_table(const std::vector<SweepRow> &rows,
                const std::string           &directory,
                std::ostream                &out,
                const MPI_Comm               comm)
    {
      std::ostringstream csv;
      csv << "formulation,mass,p,cells,error_l2,error_max,order\n";
      csv.precision(10);
      out << "  relative error of displacement\n"
          << "  formulation         mass               p  cells         L2"
          << "    largest  order\n";
      for (const SweepRow &row : rows)
        {
          if (!row.failure.empty())
            continue;
          const SchemeParameters &scheme = row.parameters.scheme;
          const unsigned int      degree = row.parameters.grid.degree;
          csv << scheme.formulation << "," << scheme.mass << "," << degree
              << "," << row.cells << "," << row.errors.l2 << ","
              << row.errors.max << ",";
          out << "  " << std::left << std::setw(19) << scheme.formulation << " "
              << std::setw(16) << scheme.mass << std::right << std::setw(4)
              << degree << std::setw(7) << row.cells << std::scientific
              << std::setprecision(3) << std::setw(11) << row.errors.l2
              << std::setw(11) << row.errors.max << std::defaultfloat;
          if (std::isfinite(row.order))
            {
              csv << row.order;
              out << std::fixed << std::setprecision(2) << std::setw(7)
                  << row.order << std::defaultfloat;
            }
          csv << '\n';
          out << '\n';
        }
      out << "  results: " << directory << std::endl;
      run_on_first(
        [&]() { write_atomically(directory + "/convergence.csv", csv.str()); },
        comm);
    }



    /**
     * Collective. One run of a sweep in its folder. Throws RunStopped; other
     * errors become the failure of the row.
     */
    template <int dim>
    void
    run_row(SweepRow          &row,
            const std::string &folder,
            std::ostream      &out,
            const MPI_Comm     comm,
            const RunOptions  &options,
            const bool         is_side_by_side)
    {
      check_other_folder(options, folder, comm);
      // A new run takes its folder when that of an earlier sweep has made room.
      std::optional<RunFolder> own;
      const auto               take_folder = [&]() {
        own.emplace(folder,
                    "Output/Directory",
                    what_of_earlier(row.parameters, options),
                    comm);
      };
      if (options.resumes)
        take_folder();
      // Those that had not begun begin now.
      RunOptions own_options = options;
      own_options.resumes    = options.resumes && has_checkpoints(folder, comm);
      own_options.prepare_folder = [&]() {
        if (options.prepare_folder)
          options.prepare_folder();
        if (!own)
          take_folder();
        own->make_room();
        write_parameters(row.parameters.with(
                           "subsection Output\n  set Directory = " + folder +
                           "\nend\n"),
                         folder,
                         comm);
      };
      const auto run = [&](std::ostream &text) {
        SimulationRun<dim> simulation(
          row.parameters, folder, text, comm, own_options);
        const auto keep_going = [&](const auto &action) {
          try
            {
              action();
            }
          catch (const RunStopped &)
            {
              throw;
            }
          catch (const std::exception &error)
            {
              // Others may hold what this one does not.
              row.failure = message_of(error);
              text << "  failed: " << row.failure << std::endl;
            }
        };
        keep_going([&]() {
          const RunSummary summary = simulation.run();
          row.results              = {{"wall_time", summary.wall_time}};
          if (summary.ramp)
            row.results.insert(row.results.end(),
                               {{"failure_factor", summary.ramp->factor()},
                                {"failure_from", summary.ramp->from},
                                {"failure_to", summary.ramp->to}});
          row.results.insert(row.results.end(),
                             summary.last_row.begin(),
                             summary.last_row.end());
          if (summary.errors.displacement)
            row.errors = *summary.errors.displacement;
        });
        text << std::endl;
      };
      if (!is_side_by_side)
        {
          run(out);
          return;
        }
      std::ostringstream text;
      const auto         write = [&]() {
        run_on_first(
          [&]() { write_atomically(folder + "/output.txt", text.str()); },
          comm);
      };
      std::ostream nowhere(nullptr);
      try
        {
          run(Utilities::MPI::this_mpi_process(comm) == 0 ? text : nowhere);
        }
      catch (const RunStopped &)
        {
          write();
          throw;
        }
      catch (const std::exception &error)
        {
          row.failure = message_of(error);
        }
      write();
    }



    /**
     * Collective. Share the runs among groups of processes, and what they have
     * found among all. Throws RunStopped where a group has been stopped.
     */
    template <int dim>
    void
    run_side_by_side(std::vector<SweepRow>      &rows,
                     const SimulationParameters &parameters,
                     const std::string          &directory,
                     std::ostream               &out,
                     const MPI_Comm              comm,
                     RunOptions                  options)
    {
      const unsigned int n = Utilities::MPI::n_mpi_processes(comm);
      const unsigned int n_of_run =
        std::min(n, std::max(1u, parameters.sweep.processes));
      const unsigned int n_groups = n / n_of_run;
      const unsigned int me       = Utilities::MPI::this_mpi_process(comm);
      const unsigned int group    = me / n_of_run;
      out << rows.size() << " runs, "
          << std::min<std::size_t>(n_groups, rows.size()) << " side by side on "
          << n_of_run
          << " process(es) each; what a run prints is in its folder, "
             "output.txt\n"
          << std::endl;
      options.prepare_folder();
      options.prepare_folder = {};
      MPI_Comm own;
      MPI_Comm_split(comm,
                     group < n_groups ? int(group) : MPI_UNDEFINED,
                     int(me),
                     &own);
      std::string stopped;
      for (unsigned int k = group; group < n_groups && k < rows.size();
           k += n_groups)
        try
          {
            run_row<dim>(rows[k],
                         directory + "/" + rows[k].folder(parameters.sweep),
                         out,
                         own,
                         options,
                         true);
          }
        catch (const RunStopped &error)
          {
            stopped = message_of(error);
            break;
          }
      if (own != MPI_COMM_NULL)
        MPI_Comm_free(&own);
      // The first process of a group speaks for it.
      std::map<unsigned int, std::pair<std::string, std::vector<double>>> found;
      std::map<unsigned int, std::vector<std::string>>                    names;
      if (group < n_groups && me % n_of_run == 0)
        for (unsigned int k = group; k < rows.size(); k += n_groups)
          {
            found[k] = {rows[k].failure,
                        {rows[k].errors.l2, rows[k].errors.max}};
            for (const auto &[name, number] : rows[k].results)
              {
                names[k].push_back(name);
                found[k].second.push_back(number);
              }
          }
      for (const auto &of_process : Utilities::MPI::all_gather(comm, found))
        for (const auto &[k, result] : of_process)
          {
            rows[k].failure    = result.first;
            rows[k].errors.l2  = result.second[0];
            rows[k].errors.max = result.second[1];
            rows[k].results.clear();
            for (unsigned int c = 2; c < result.second.size(); ++c)
              rows[k].results.emplace_back("", result.second[c]);
          }
      for (const auto &of_process : Utilities::MPI::all_gather(comm, names))
        for (const auto &[k, list] : of_process)
          for (unsigned int c = 0; c < list.size(); ++c)
            rows[k].results[c].first = list[c];
      for (const std::string &text : Utilities::MPI::all_gather(comm, stopped))
        AssertThrow(text.empty(), RunStopped(text));
    }



    template <int dim>
    void
    run_sweep(const SimulationParameters &parameters,
              const std::string          &directory,
              std::ostream               &out,
              const MPI_Comm              comm,
              RunOptions                  options)
    {
      const bool has_exact = !parameters.exact.displacement.empty();
      auto       rows      = make_sweep_rows(parameters);
      // The table names the folders from the start.
      options.prepare_folder = [&, prepare = options.prepare_folder]() {
        prepare();
        if (options.resumes)
          return;
        auto begun = rows;
        for (SweepRow &row : begun)
          row.failure = "not at its end";
        write_results(begun, parameters.sweep, directory, comm);
      };
      if (parameters.sweep.processes > 0)
        run_side_by_side<dim>(rows, parameters, directory, out, comm, options);
      else
        for (std::size_t k = 0; k < rows.size(); ++k)
          {
            RunOptions own_options = options;
            if (k > 0)
              own_options.prepare_folder = {};
            run_row<dim>(rows[k],
                         directory + "/" + rows[k].folder(parameters.sweep),
                         out,
                         comm,
                         own_options,
                         false);
          }
      for (std::size_t k = 1; k < rows.size(); ++k)
        {
          SweepRow       &row  = rows[k];
          const SweepRow &last = rows[k - 1];
          if (has_exact && row.failure.empty() && last.failure.empty() &&
              same_kind(row.parameters, last.parameters) &&
              row.value == last.value && row.cells != last.cells)
            row.order = std::log(last.errors.l2 / row.errors.l2) /
                        std::log(double(row.cells) / last.cells);
        }
      write_results(rows, parameters.sweep, directory, comm);
      if (has_exact)
        write_table(rows, directory, out, comm);
      else
        print_rows(rows, parameters.sweep, directory, out);
      std::string failures;
      for (const SweepRow &row : rows)
        if (!row.failure.empty())
          failures += "\n  " + row.parameters.scheme.formulation + ", " +
                      row.parameters.scheme.mass + ", order " +
                      std::to_string(row.parameters.grid.degree) + ", " +
                      std::to_string(row.cells) + " cells" +
                      (row.value.empty() ? "" : ", " + row.value) + ": " +
                      row.failure;
      AssertThrow(failures.empty(),
                  ExcMessage("Runs of 'Sweep' failed:" + failures));
    }



    template <int dim>
    void
    run_all(const SimulationParameters &parameters,
            const std::string          &directory,
            std::ostream               &out,
            const MPI_Comm              comm,
            const RunOptions           &options)
    {
      if (parameters.sweep.is_empty())
        SimulationRun<dim>(parameters, directory, out, comm, options).run();
      else
        run_sweep<dim>(parameters, directory, out, comm, options);
    }
  } // namespace



  void
  run_simulations(const std::string &file,
                  const MPI_Comm     comm,
                  const RunOptions  &options)
  {
    const SimulationParameters parameters(file, options.settings);
    const bool    is_first = Utilities::MPI::this_mpi_process(comm) == 0;
    std::ostream  nowhere(nullptr);
    std::ostream &out = is_first ? std::cout : nowhere;

    const std::string directory = folder_of_run(parameters, file, options);
    check_other_folder(options, directory, comm);
    if (options.resumes)
      check_folder_of_checkpoints(directory, comm);
    const SignalCatcher signals;
    RunFolder           folder(directory,
                     parameters.output.directory.empty() ? "Simulation/Name"
                                                                   : "Output/Directory",
                     what_of_earlier(parameters, options),
                     comm);
    RunOptions          options_of_run = options;
    options_of_run.prepare_folder      = [&]() {
      folder.make_room();
      write_parameters(parameters, directory, comm);
    };
    for (const std::string &note : repeated_parameters(file))
      out << "Note: " << note << std::endl;
    if (parameters.general.dimension == 2)
      run_all<2>(parameters, directory, out, comm, options_of_run);
    else
      run_all<3>(parameters, directory, out, comm, options_of_run);
  }
} // namespace greville
