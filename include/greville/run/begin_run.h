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

  /// Throw dealii::ExcMessage if a run with these parameters cannot resume from
  /// a checkpoint with other parameters.
  void
  check_changes(const TablesFile           &checkpoint,
                const SimulationParameters &parameters);

  /// Throw dealii::ExcMessage if 'End' of a stage has changed that is finished
  /// at the checkpoint, or if the @p stage of the checkpoint would end before
  /// its @p time.
  void
  check_stages(const TablesFile           &checkpoint,
               const SimulationParameters &parameters,
               const unsigned int          stage,
               const double                time);

  /// Collective. Begin simulations with the points of another run. Throws
  /// dealii::ExcMessage, which names the checkpoint, if they do not fit.
  template <int dim>
  void
  begin_with(CoupledSimulations<dim>    &simulations,
             const Checkpoint           &checkpoint,
             const SimulationParameters &parameters);
} // namespace greville
