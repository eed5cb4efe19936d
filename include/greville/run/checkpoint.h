// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_checkpoint_h
#define greville_run_checkpoint_h

#include <greville/base/tables.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * The differences between two sets of parameters, as
   * SimulationParameters::used() writes them, that a run cannot go on with: all
   * but those of the sections 'Output', 'Checkpoints' and 'Load balance', and
   * the parameters 'End' and 'Maximum steps' of 'Time'. Returns one line for
   * each, with the parameter, and its value there and here; empty if there is
   * none.
   */
  std::string
  describe_changes(const std::string &before, const std::string &now);



  /**
   * Throw dealii::ExcMessage if the points of a run with the parameters
   * @p before have no meaning in a run that begins with them and has those of
   * @p now: in another dimension or geometry, or dry below a water table.
   */
  void
  check_points_fit(const std::string &before, const std::string &now);



  /**
   * Collective. Write @p content to the file checkpoint_NNNNNNNNNN.h5 of
   * @p folder with the number of steps in its name, with the format and the
   * version of the program; then remove all older checkpoints but one. At any
   * moment there is a complete checkpoint if there has been one before. Returns
   * the file. Throws dealii::ExcMessage where it cannot be written; older
   * checkpoints are still there.
   */
  std::string
  write_checkpoint(const std::string &folder,
                   const unsigned int n_steps,
                   TablesFile         content,
                   const MPI_Comm     comm);



  /**
   * Collective. Throw dealii::ExcMessage if @p folder is none.
   */
  void
  check_folder_of_checkpoints(const std::string &folder, const MPI_Comm comm);

  /**
   * A checkpoint that has been read.
   */
  struct Checkpoint
  {
    std::string file;
    TablesFile  content;
    /// Newer ones that have not been taken, and why.
    std::vector<std::pair<std::string, std::string>> refused;
  };



  /**
   * Collective. Read the newest checkpoint of @p folder that is complete and of
   * this format; files that are not are reported. Throws dealii::ExcMessage
   * where there is none.
   */
  Checkpoint
  read_checkpoint(const std::string &folder, const MPI_Comm comm);
} // namespace greville

#endif
