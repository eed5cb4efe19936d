// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/csv.h>
#include <greville/steps/step_log.h>

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Writes the files of a run besides sums and fields:
   * - messages.log, a line for each warning, the error that ended the run, and
   *   the step from which the run resumed;
   * - newton.csv, the Newton iterations of all steps, solved or abandoned;
   * - units.csv, the units of all columns and fields of the other files.
   *
   * All functions are collective, and throw dealii::ExcMessage if a file cannot
   * be written. They do not throw for messages.log, because the run continues
   * on a full disk.
   */
  class RunNotes
  {
  public:
    /// Write warnings to the first process's @p out, too.
    RunNotes(const std::string &directory,
             std::ostream      &out,
             const MPI_Comm     comm);

    /// Begin a run, and discard the notes of an earlier one.
    void
    begin();

    /// Resume a run after its step @p n_steps: later steps are removed from
    /// newton.csv.
    void
    resume(const unsigned int n_steps);

    /// Print and note a text of a kind: "Note" (about input that may not be
    /// intended), "Warning", or "Cut" (a step is repeated with a shorter
    /// length).
    void
    note(const std::string &text, const std::string &kind = "Note");

    /// Note the error that ends the run. The program prints it.
    void
    note_error(const std::string &error)
    {
      append("Error", error);
    }

    void
    write(const std::vector<NewtonRecord> &records);

    /// Write the units of the @p columns of statistics.csv, the columns
    /// @p probes of probes.csv and the @p fields of points. @p history has the
    /// units that laws define.
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
    // Last step of newton.csv that a resumed run keeps.
    int last_step = -1;
  };



  /// Return the unit of a column of statistics.csv, probes.csv or newton.csv,
  /// or of a field of points, grid, surface or rigid; "1" without unit, and
  /// empty if the unit is unknown, as for a history variable of a program's own
  /// material. In 2D, sums are per metre of thickness, or per radian.
  std::string
  unit_of(const std::string &file,
          const std::string &column,
          const unsigned int dim,
          const bool         is_axisymmetric = false);
} // namespace greville
