// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/tables.h>

#include <string>
#include <vector>

namespace greville
{
  /// Return the differences between two sets of parameters, as
  /// SimulationParameters::used() writes them, that prevent a run from
  /// resuming: all except in the sections 'Output', 'Checkpoints' and 'Load
  /// balance', and in 'End' and 'Maximum steps' of 'Time'. Each line has the
  /// parameter, its value before and its value now.
  std::string
  describe_changes(const std::string &before, const std::string &now);



  /// Throw dealii::ExcMessage if a run with the parameters @p now cannot begin
  /// with the points of a run with the parameters @p before: if dimension or
  /// geometry differ, or the points are dry below a water table.
  void
  check_points_fit(const std::string &before, const std::string &now);



  /// Collective. Write @p content, the format and the version of the program to
  /// the file checkpoint_NNNNNNNNNN.h5 of @p folder, named after the number of
  /// steps; then remove all older checkpoints but one. Thus, one complete
  /// checkpoint exists at any time. Returns the file. Throws dealii::ExcMessage
  /// if it cannot be written; older checkpoints then remain.
  std::string
  write_checkpoint(const std::string &folder,
                   const unsigned int n_steps,
                   TablesFile         content,
                   const MPI_Comm     comm);



  /// Collective. Throw dealii::ExcMessage if @p folder is no folder.
  void
  check_folder_of_checkpoints(const std::string &folder, const MPI_Comm comm);

  struct Checkpoint
  {
    std::string file;
    TablesFile  content;
    /// Newer checkpoints that were refused, and the reasons.
    std::vector<std::pair<std::string, std::string>> refused;
  };



  /// Collective. Read the newest checkpoint of @p folder that is complete and
  /// has this format; other files are reported. Throws dealii::ExcMessage if
  /// there is none.
  Checkpoint
  read_checkpoint(const std::string &folder, const MPI_Comm comm);
} // namespace greville
