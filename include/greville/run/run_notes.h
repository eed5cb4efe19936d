// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_run_notes_h
#define greville_run_run_notes_h

#include <greville/base/csv.h>
#include <greville/steps/step_log.h>

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Files of a run besides sums and fields:
   * - messages.log, warnings, the error that has ended the run, and where it
   *   goes on after that, a line each;
   * - newton.csv, the iterations of Newton's method of all steps that it has
   *   solved or given up;
   * - units.csv, the units of all columns and fields of the other files.
   *
   * All functions are collective, and throw dealii::ExcMessage where a file
   * cannot be written; but for messages.log, as a warning may be that of a full
   * disk, on which the run goes on.
   */
  class RunNotes
  {
  public:
    /**
     * Warnings go to the first process's @p out, too.
     */
    RunNotes(const std::string &directory,
             std::ostream      &out,
             const MPI_Comm     comm);

    /**
     * Begin a run, without notes of an earlier one.
     */
    void
    begin();

    /**
     * Go on with a run after its step @p n_steps: what newton.csv has of later
     * steps is removed.
     */
    void
    resume(const unsigned int n_steps);

    void
    warn(const std::string &warning);

    /**
     * Print a note about input that may not be intended.
     */
    void
    note(const std::string &text);

    /**
     * The run ends with this error, which the program prints.
     */
    void
    note_error(const std::string &error);

    void
    write(const std::vector<NewtonRecord> &records);

    /**
     * Units of the @p columns of statistics.csv, of those of probes.csv, and of
     * the @p fields of points; @p history has those that laws know.
     */
    void
    write_units(const unsigned int                        dim,
                const bool                                is_axisymmetric,
                const std::vector<std::string>           &columns,
                const std::vector<std::string>           &probes,
                const std::vector<std::string>           &fields,
                const std::map<std::string, std::string> &history);

  private:
    void
    append(const std::string &kind, const std::string &text);

    const std::string directory;
    std::ostream     &out;
    MPI_Comm          comm;
    CsvWriter         newton;
    bool              newton_is_open = false;
    // The last step of newton.csv that stays when a run goes on.
    int last_step = -1;
  };



  /**
   * The unit of a column of statistics.csv, probes.csv or newton.csv, or of a
   * field of points, grid, surface or rigid; "1" where it has none, and
   * empty where it is not known, as that of the history of a material of a
   * program's own. In 2D sums are per metre of thickness, or per radian.
   */
  std::string
  unit_of(const std::string &file,
          const std::string &column,
          const unsigned int dim,
          const bool         is_axisymmetric = false);
} // namespace greville

#endif
