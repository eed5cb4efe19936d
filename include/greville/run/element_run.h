// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_element_run_h
#define greville_run_element_run_h

#include <deal.II/base/mpi.h>

#include <greville/run/run_options.h>

#include <string>

namespace greville
{
  /**
   * Collective. Lead the material @p name of a parameter file (empty: the only
   * one) through an element test, see run_element_test(), with the section
   * 'Element test'; write element_test.csv to the folder of the file's run, and
   * show where it begins and ends and its largest q on std::cout. Earlier
   * results become what 'Output/Earlier results' says. Throws
   * dealii::ExcMessage for wrong names and files, and for what the test throws.
   */
  void
  run_element_test_of_file(const std::string &file,
                           const std::string &test,
                           const std::string &name,
                           const MPI_Comm     comm,
                           const RunOptions  &options = RunOptions());
} // namespace greville

#endif
