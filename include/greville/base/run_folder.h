// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace greville
{
  /// The treatment of the results of an earlier run in the folder of a new one.
  enum class EarlierResults
  {
    /// Move the earlier results to the first of the subfolders earlier_1,
    /// earlier_2, ... that does not exist.
    move_aside,
    /// End the new run with a message.
    refuse,
    remove,
    /// Continue the earlier results.
    keep
  };



  /**
   * The folder of the results of a run, which no other run may use at the same
   * time: the first process holds a lock on its file `lock` until the object is
   * destroyed or the process ends in any way. The file names the host and the
   * process.
   *
   * Results are files with the names that the programs and scripts use, and the
   * folders of the runs of a sweep with their content; other files in the
   * folder are not touched.
   */
  class RunFolder
  {
  public:
    /// Collective. Make the folder and lock it. Throws dealii::ExcMessage with
    /// the name of the @p parameter of the folder if it is not writable, if
    /// another run has locked it, or if it contains results and @p earlier is
    /// EarlierResults::refuse. Earlier results remain until make_room().
    RunFolder(const std::string   &path,
              const std::string   &parameter,
              const EarlierResults earlier,
              const MPI_Comm       comm);

    RunFolder(const RunFolder &) = delete;
    RunFolder &
    operator=(const RunFolder &) = delete;

    ~RunFolder();

    /// Collective. Treat earlier results as requested: to be called when the
    /// new run has been fully checked, before it writes its first file. Throws
    /// dealii::ExcMessage if they cannot be moved or removed.
    void
    make_room();

    const std::string &
    path() const
    {
      return folder;
    }

  private:
    void
    lock();

    void
    release();

    const std::string    folder, parameter;
    const EarlierResults earlier;
    const MPI_Comm       comm;
    int                  lock_descriptor = -1;
  };
} // namespace greville
