// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <greville/run/run_options.h>

#include <string>

namespace greville
{
  /// Collective. Run the simulation that a parameter file describes.
  /// 'Output/Earlier results' decides on earlier results in its folder. Throws
  /// dealii::ExcMessage if the file is wrong, the run fails, or the file has a
  /// 'Sweep'.
  void
  run_simulations(const std::string &file,
                  const MPI_Comm     comm,
                  const RunOptions  &options = RunOptions());

  /// Collective. Set up a run as run_simulations() does, take some steps in
  /// memory, and write the estimated cost of the run to std::cout: sizes, time
  /// step, number of steps, time and memory. Writes no file but the initial
  /// points, to the folder @p drawing if it is not empty. Throws like the same
  /// part of run_simulations().
  void
  check_simulations(const std::string &file,
                    const MPI_Comm     comm,
                    const RunOptions  &options = RunOptions(),
                    const std::string &drawing = "");

  /// Read the parameter files of a sweep from the folder @p runs, and write
  /// formulation and mass of each run to std::cout. Then, if @p makes_room,
  /// treat earlier results in the folder of the sweep @p file as
  /// run_simulations() does, and write parameters.prm there. Throws
  /// dealii::ExcMessage with the number of a run that is refused.
  void
  prepare_sweep(const std::string &file,
                const std::string &runs,
                const MPI_Comm     comm,
                const RunOptions  &options,
                const bool         makes_room);

  /// Collective. Run an element test, see run_element_test(), of the material
  /// @p name of a parameter file (empty: the only one) with the section
  /// 'Element test'. Writes element_test.csv to the folder of the file's run,
  /// and the first and last state and the largest q to std::cout.
  /// 'Output/Earlier results' decides on earlier results. Throws
  /// dealii::ExcMessage for wrong names and files, and errors of the test.
  void
  run_element_test_of_file(const std::string &file,
                           const std::string &test,
                           const std::string &name,
                           const MPI_Comm     comm,
                           const RunOptions  &options = RunOptions());
} // namespace greville
