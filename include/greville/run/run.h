// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_run_h
#define greville_run_run_h

#include <deal.II/base/mpi.h>

#include <greville/run/run_options.h>

#include <string>

namespace greville
{
  /**
   * Collective. Run what a parameter file describes: one simulation, or a sweep
   * over meshes, orders and masses, which ends with a table and
   * convergence.csv. Results of an earlier run in its folder become what
   * 'Output/Earlier results' says. Throws dealii::ExcMessage where file or run
   * go wrong.
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
} // namespace greville

#endif
