// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_run_h
#define greville_run_run_h

#include <deal.II/base/mpi.h>

#include <greville/run/run_options.h>

#include <string>

namespace greville
{
  /**
   * Collective. Run the simulation that a parameter file describes. Results of
   * an earlier run in its folder become what 'Output/Earlier results' says.
   * Throws dealii::ExcMessage if file or run go wrong, or the file has a
   * 'Sweep'.
   */
  void
  run_simulations(const std::string &file,
                  const MPI_Comm     comm,
                  const RunOptions  &options = RunOptions());

  /**
   * Collective. Make all that run_simulations() would begin with, go some steps
   * in memory, and write to std::cout what a run would take: sizes, the step
   * and the number of steps, time, and memory. Writes no file, except for the
   * initial points, which go to the folder @p drawing if that is not empty.
   * Throws what run_simulations() would throw so far.
   */
  void
  check_simulations(const std::string &file,
                    const MPI_Comm     comm,
                    const RunOptions  &options = RunOptions(),
                    const std::string &drawing = "");

  /**
   * Read the parameter files of the runs of a sweep, which are in the folder @p
   * runs, and write formulation and mass of each to std::cout. Then, if @p
   * makes_room is true, treat earlier results in the folder of the sweep @p
   * file as run_simulations() does, and write parameters.prm there. Throws
   * dealii::ExcMessage with the number of a run that is not accepted.
   */
  void
  prepare_sweep(const std::string &file,
                const std::string &runs,
                const MPI_Comm     comm,
                const RunOptions  &options,
                const bool         makes_room);
} // namespace greville

#endif
