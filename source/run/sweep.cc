// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/base/signals.h>
#include <greville/run/check_materials.h>
#include <greville/run/sweep.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace greville
{
  using namespace dealii;

  std::string
  SweepRow::folder(const SweepParameters &sweep) const
  {
    const std::string &formulation = parameters.scheme.formulation;
    return (sweep.formulations.empty()
              ? ""
              : formulation.substr(0, formulation.find(' ')) + "_") +
           parameters.scheme.mass + "_" + parameters.scheme.quadrature + "_p" +
           std::to_string(parameters.grid.degree) + "_" + std::to_string(cells);
  }



  std::string
  folder_of_run(const SimulationParameters &parameters,
                const std::string          &file,
                const RunOptions           &options)
  {
    // What a run has left in its folder names another one if that has moved.
    const std::filesystem::path path(file);
    return options.resumes && path.filename() == "parameters.prm"
             ? std::filesystem::absolute(path).parent_path().string()
           : parameters.output.directory.empty()
             ? "output/" + parameters.general.name
             : parameters.output.directory;
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



  std::vector<SweepRow>
  make_sweep_rows(const SimulationParameters &parameters)
  {
    const SweepParameters &sweep  = parameters.sweep;
    const auto             or_one = [](const auto &list, const auto &one) {
      return list.empty() ? std::decay_t<decltype(list)>{one} : list;
    };
    const auto &scheme         = parameters.scheme;
    const auto  degrees        = or_one(sweep.degrees, parameters.grid.degree);
    const auto  masses         = or_one(sweep.masses, scheme.mass);
    const auto  quadratures    = or_one(sweep.quadratures, scheme.quadrature);
    const auto  formulations   = or_one(sweep.formulations, scheme.formulation);
    const auto &base           = parameters.grid.cells;
    const unsigned int    most = *std::max_element(base.begin(), base.end());
    const auto            cells = or_one(sweep.cells, most);
    std::vector<SweepRow> rows;
    const auto            add = [&](const std::string &formulation,
                         const std::string &mass,
                         const std::string &quadrature,
                         const unsigned int degree,
                         const unsigned int n) {
      SweepRow    row;
      std::string changes;
      const auto  set = [&](const std::string &section,
                           const std::string &name,
                           const std::string &value) {
        std::string end;
        for (const std::string &part :
             Utilities::split_string_list(section, '/'))
          {
            changes += "subsection " + part + "\n";
            end += "end\n";
          }
        changes += "set " + name + " = " + value + "\n" + end;
      };
      // Lists that are empty leave stages what they have.
      const auto set_scheme = [&](const std::string &section, const bool all) {
        if (all || !sweep.formulations.empty())
          set(section, "Formulation", formulation);
        if (all || !sweep.masses.empty())
          set(section, "Mass", mass);
        if (all || !sweep.quadratures.empty())
          set(section, "Quadrature", quadrature);
      };
      set_scheme("Scheme", true);
      for (const StageParameters &stage : parameters.stages)
        set_scheme("Stage " + stage.name + "/Scheme", false);
      const auto scale = [&](const std::vector<unsigned int> &all,
                             const std::string               &section) {
        std::string text;
        for (const unsigned int cells : all)
          {
            const std::uint64_t product = std::uint64_t(cells) * n;
            AssertThrow(cells == 1 || (product % most == 0 &&
                                       product / most < (1ull << 31)),
                        ExcMessage(
                          "The parameter 'Sweep/Cells' has the entry " +
                          std::to_string(n) + ", with which '" + section +
                          "/Cells' cannot keep their ratio, or are too many."));
            text += (text.empty() ? "" : ", ") +
                    std::to_string(cells > 1 ? product / most : cells);
          }
        if (!all.empty())
          set(section, "Cells", text);
      };
      scale(parameters.grid.cells, "Grid");
      for (const auto &[name, grid] : parameters.body_grids)
        scale(grid.cells, "Body " + name + "/Grid");
      set("Grid", "Order", std::to_string(degree));
      for (const std::string list :
           {"Cells", "Orders", "Formulations", "Masses", "Quadratures"})
        set("Sweep", list, "");
      row.parameters       = parameters.with(changes);
      row.parameters.sweep = sweep;
      row.cells            = n;
      rows.push_back(row);
    };
    for (const std::string &formulation : formulations)
      for (const std::string &mass : masses)
        for (const std::string &quadrature : quadratures)
          for (const unsigned int degree : degrees)
            for (const unsigned int n : cells)
              add(formulation, mass, quadrature, degree, n);
    return rows;
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
             a.scheme.mass == b.scheme.mass &&
             a.scheme.quadrature == b.scheme.quadrature;
    }



    void
    write_table(const std::vector<SweepRow> &rows,
                const std::string           &directory,
                std::ostream                &out,
                const MPI_Comm               comm)
    {
      std::ostringstream csv;
      csv << "formulation,mass,quadrature,p,cells,error_l2,error_max,order\n";
      csv.precision(10);
      out << "  relative error of displacement\n"
          << "  formulation         mass             quadrature      p  cells  "
             "       L2"
          << "    largest  order\n";
      for (const SweepRow &row : rows)
        {
          if (!row.failure.empty())
            continue;
          const SchemeParameters &scheme = row.parameters.scheme;
          const unsigned int      degree = row.parameters.grid.degree;
          csv << scheme.formulation << "," << scheme.mass << ","
              << scheme.quadrature << "," << degree << "," << row.cells << ","
              << row.errors.l2 << "," << row.errors.max << ",";
          out << "  " << std::left << std::setw(19) << scheme.formulation << " "
              << std::setw(16) << scheme.mass << " " << std::setw(14)
              << scheme.quadrature << std::right << std::setw(3) << degree
              << std::setw(7) << row.cells << std::scientific
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



    template <int dim>
    void
    run_sweep(const SimulationParameters &parameters,
              const std::string          &directory,
              std::ostream               &out,
              const MPI_Comm              comm,
              const RunOptions           &options)
    {
      const bool has_exact = !parameters.exact.displacement.empty();
      auto       rows      = make_sweep_rows(parameters);
      for (std::size_t k = 0; k < rows.size(); ++k)
        {
          SweepRow         &row = rows[k];
          const std::string folder =
            directory + "/" + row.folder(parameters.sweep);
          check_other_folder(options, folder, comm);
          RunFolder own(folder,
                        "Output/Directory",
                        what_of_earlier(parameters, options),
                        comm);
          // Those that had not begun begin now.
          RunOptions own_options = options;
          own_options.resumes =
            options.resumes && has_checkpoints(folder, comm);
          own_options.prepare_folder = [&]() {
            if (k == 0)
              options.prepare_folder();
            own.make_room();
            write_parameters(row.parameters.with(
                               "subsection Output\n  set Directory = " +
                               folder + "\nend\n"),
                             folder,
                             comm);
          };
          SimulationRun<dim> run(
            row.parameters, folder, out, comm, own_options);
          try
            {
              const RunSummary summary = run.run();
              if (has_exact)
                row.errors = *summary.errors.displacement;
            }
          catch (const RunStopped &)
            {
              throw;
            }
          catch (const std::exception &error)
            {
              // Others may hold what this one does not.
              row.failure = message_of(error);
              out << "  failed: " << row.failure << std::endl;
            }
          if (has_exact && row.failure.empty() && k > 0 &&
              rows[k - 1].failure.empty() &&
              same_kind(row.parameters, rows[k - 1].parameters) &&
              row.cells != rows[k - 1].cells)
            row.order = std::log(rows[k - 1].errors.l2 / row.errors.l2) /
                        std::log(double(row.cells) / rows[k - 1].cells);
          out << std::endl;
        }
      if (has_exact)
        write_table(rows, directory, out, comm);
      std::string failures;
      for (const SweepRow &row : rows)
        if (!row.failure.empty())
          failures += "\n  " + row.parameters.scheme.formulation + ", " +
                      row.parameters.scheme.mass + ", " +
                      row.parameters.scheme.quadrature + ", order " +
                      std::to_string(row.parameters.grid.degree) + ", " +
                      std::to_string(row.cells) + " cells: " + row.failure;
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
