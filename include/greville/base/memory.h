// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <optional>
#include <string>

namespace greville
{
  /// Collective. Throw dealii::ExcMessage with the name of the @p parameter if
  /// a box of @p n_cells cells in @p dim dimensions does not fit into the
  /// available memory of its machine. Only impossible grids are rejected: a
  /// grid takes some hundred bytes per cell even without points.
  void
  check_memory_of_cells(const double       n_cells,
                        const unsigned int dim,
                        const std::string &parameter,
                        const MPI_Comm     comm);

  /// Return the bytes that this process has allocated, empty if the system does
  /// not tell.
  std::optional<unsigned long>
  allocated_memory();

  /// Let the C library give free memory back to the system, which SuperLU_DIST
  /// forbids for the whole program when it is loaded.
  void
  return_free_memory();
} // namespace greville
