// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/signals.h>
#include <greville/run/begin_run.h>
#include <greville/run/check_materials.h>
#include <greville/run/run.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>

namespace greville
{
  using namespace dealii;

  std::string
  folder_of_run(const SimulationParameters &parameters,
                const std::string          &file,
                const RunOptions           &options)
  {
    // If the folder has been moved, the files of the run name the old one.
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
        Require(setting.rfind("Output/Directory", 0) != 0 ||
                  std::filesystem::equivalent(given, own, error),
                "The option --set <" + setting +
                  ">: a run resumes in its own folder, <" + own.string() +
                  ">. To use another folder, move this one and resume there.");
      }
    return own.string();
  }



  RunFolder
  take_folder(const SimulationParameters &parameters,
              const std::string          &directory,
              const RunOptions           &options,
              const MPI_Comm              comm)
  {
    return {directory,
            parameters.output.directory.empty() ? "Simulation/Name"
                                                : "Output/Directory",
            options.resumes ? EarlierResults::keep
                            : parameters.output.earlier_results,
            comm};
  }



  void
  check_other_folder(const RunOptions  &options,
                     const std::string &folder,
                     const MPI_Comm     comm)
  {
    if (options.from.empty())
      return;
    run_on_first(comm, [&]() {
      std::error_code error;
      Require(!std::filesystem::equivalent(options.from, folder, error),
              "--from names the folder <" + options.from +
                "> of this run itself: give the new run another "
                "'Output/Directory'.");
    });
  }



  namespace
  {
    /// Write the parameters, for a resumed run and for other programs.
    void
    write_parameters(const SimulationParameters &parameters,
                     const std::string          &folder,
                     const MPI_Comm              comm)
    {
      run_on_first(comm, [&]() {
        write_atomically(folder + "/parameters.prm", parameters.used());
      });
    }
  } // namespace



  template <int dim>
  void
  adapt_at_start(SimulationParameters &parameters, const MPI_Comm comm)
  {
    for (unsigned int k = 0; k < parameters.grid.adapt_at_start; ++k)
      {
        std::set<std::uint64_t> marks;
        try
          {
            CoupledSimulations<dim> trial(parameters, comm);
            trial.step();
            for (unsigned int part = 0; part < trial.n_parts(); ++part)
              for (const auto position : trial.part(part).marked_cells())
                marks.insert(position);
          }
        catch (const std::exception &error)
          {
            // Each process has thrown it.
            AssertThrow(false,
                        ErrorOnAll("Trial " + std::to_string(k + 1) +
                                   " of the first step ('Grid/Adapt at "
                                   "start'): " +
                                   message_of(error)));
          }
        std::vector<std::uint64_t> all(marks.begin(), marks.end());
        if (all == parameters.grid.marked_at_start)
          return;
        parameters.grid.marked_at_start = std::move(all);
      }
  }



  void
  refuse_sweep(const SimulationParameters &parameters, const std::string &file)
  {
    Require(parameters.sweep.is_empty(),
            "<" + file +
              "> has a 'Sweep', but this program makes one run. All runs are "
              "made by scripts/run, scripts/sweep (greville-sweep of an "
              "installation), or greville.sweep() in Python.");
  }



  void
  run_simulations(const std::string &file,
                  const MPI_Comm     comm,
                  const RunOptions  &options)
  {
    SimulationParameters parameters(file, options.settings);
    const bool           is_first = Utilities::MPI::this_mpi_process(comm) == 0;
    std::ostream         nowhere(nullptr);
    std::ostream        &out = is_first ? std::cout : nowhere;

    refuse_sweep(parameters, file);
    const std::string directory = folder_of_run(parameters, file, options);
    check_other_folder(options, directory, comm);
    if (options.resumes)
      check_folder_of_checkpoints(directory, comm);
    const SignalCatcher signals;
    RunFolder  folder = take_folder(parameters, directory, options, comm);
    RunOptions options_of_run     = options;
    options_of_run.prepare_folder = [&]() {
      folder.make_room();
      write_parameters(parameters, directory, comm);
    };
    for (const std::string &note : repeated_parameters(file))
      out << "Note: " << note << std::endl;
    const auto run = [&](const auto dimension) {
      if (!options.resumes)
        {
          Require(options.from.empty() || parameters.grid.adapt_at_start == 0,
                  "--from begins with bodies for which 'Grid/Adapt at start' "
                  "tries no step: take 'Grid/Adapt every'.");
          adapt_at_start<dimension>(parameters, comm);
        }
      SimulationRun<dimension>(parameters, directory, out, comm, options_of_run)
        .run();
    };
    if (parameters.general.dimension == 2)
      run(std::integral_constant<int, 2>());
    else
      run(std::integral_constant<int, 3>());
  }



  void
  prepare_sweep(const std::string &file,
                const std::string &runs,
                const MPI_Comm     comm,
                const RunOptions  &options,
                const bool         makes_room)
  {
    const SimulationParameters         parameters(file, options.settings);
    std::vector<std::filesystem::path> files;
    for (const auto &entry : std::filesystem::directory_iterator(runs))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto &path : files)
      try
        {
          const SimulationParameters own(path.string());
          std::cout << "Run " << path.stem().string() << ": "
                    << own.scheme.formulation << ", " << own.scheme.mass
                    << '\n';
        }
      catch (const std::exception &error)
        {
          Require(false,
                  "Run " + path.stem().string() + ": " + message_of(error));
        }
    if (!makes_room)
      return;
    const std::string directory = folder_of_run(parameters, file, options);
    check_other_folder(options, directory, comm);
    RunFolder folder = take_folder(parameters, directory, options, comm);
    folder.make_room();
    write_parameters(parameters, directory, comm);
    for (const std::string &note : repeated_parameters(file))
      std::cout << "Note: " << note << std::endl;
  }



  GREVILLE_INSTANTIATE(adapt_at_start);
} // namespace greville
