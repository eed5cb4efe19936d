// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <greville/run/run_options.h>

#include <string>

namespace greville
{
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
