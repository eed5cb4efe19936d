// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_run_folder_h
#define greville_base_run_folder_h

#include <deal.II/base/mpi.h>

#include <string>

namespace greville
{
  /**
   * What becomes of the results of an earlier run in the folder of a new one.
   */
  enum class EarlierResults
  {
    /// They go to the first of the folders earlier_1, earlier_2, ... in it
    /// that does not exist.
    move_aside,
    /// The new run ends with a message.
    refuse,
    remove,
    /// The new run goes on with them.
    keep
  };



  /**
   * The folder of the results of a run, which no other run may use at the same
   * time: the first process holds a lock on its file `lock` until the object is
   * destroyed or the process ends, however it does. The file says on which
   * host and by which process.
   *
   * Results are files with the names that the programs and scripts give them,
   * and the folders of the runs of a sweep with all that is in them; other
   * files in the folder stay as they are.
   */
  class RunFolder
  {
  public:
    /**
     * Collective. Make the folder and take it. Throws dealii::ExcMessage, which
     * names the @p parameter that gives the folder, where it cannot be written
     * to, another run holds it, or it has results and @p earlier is to refuse.
     * Earlier results stay until make_room().
     */
    RunFolder(const std::string   &path,
              const std::string   &parameter,
              const EarlierResults earlier,
              const MPI_Comm       comm);

    RunFolder(const RunFolder &) = delete;
    RunFolder &
    operator=(const RunFolder &) = delete;

    ~RunFolder();

    /**
     * Collective. Treat earlier results as it was asked for: to be called when
     * nothing can be wrong with the new run any more, before it writes its
     * first file. Throws dealii::ExcMessage where they cannot be moved or
     * removed.
     */
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

#endif
