// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/run_folder.h>
#include <greville/run/simulation_run.h>

namespace greville
{
  /// Throw dealii::ExcMessage if a file asks for several runs.
  void
  refuse_sweep(const SimulationParameters &parameters, const std::string &file);

  std::string
  folder_of_run(const SimulationParameters &parameters,
                const std::string          &file,
                const RunOptions           &options);

  /// Collective. Take the @p directory as the folder of a run. Throws like the
  /// constructor of RunFolder.
  RunFolder
  take_folder(const SimulationParameters &parameters,
              const std::string          &directory,
              const RunOptions           &options,
              const MPI_Comm              comm);

  /// Collective. Throw if a run is to begin with results in its own folder,
  /// because it would move them away.
  void
  check_other_folder(const RunOptions  &options,
                     const std::string &folder,
                     const MPI_Comm     comm);

  /// Collective. Try the first step as often as 'Grid/Adapt at start' says, and
  /// set GridParameters::marked_at_start from the results.
  template <int dim>
  void
  adapt_at_start(SimulationParameters &parameters, const MPI_Comm comm);

  /// Collective. Set the state of simulations at a checkpoint, and then call
  /// @p resume_files. Throws dealii::ExcMessage, which names the checkpoint, if
  /// this fails, or if the parameters differ in a way that prevents a run from
  /// resuming.
  template <int dim>
  void
  resume_from(CoupledSimulations<dim>     &simulations,
              const Checkpoint            &checkpoint,
              const SimulationParameters  &parameters,
              const std::function<void()> &resume_files = {});

  /// Collective. Begin simulations with the points of another run. Throws
  /// dealii::ExcMessage, which names the checkpoint, if they do not fit.
  template <int dim>
  void
  begin_with(CoupledSimulations<dim>    &simulations,
             const Checkpoint           &checkpoint,
             const SimulationParameters &parameters);
} // namespace greville
