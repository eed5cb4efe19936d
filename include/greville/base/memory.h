// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_memory_h
#define greville_base_memory_h

#include <deal.II/base/mpi.h>

#include <optional>
#include <string>

namespace greville
{
  /**
   * Collective. Throw dealii::ExcMessage, which names the @p parameter, where
   * a box of @p n_cells cells in @p dim dimensions does not fit into the memory
   * that its machine has left for this program. Grids take some hundred bytes
   * per cell before they have any points: only what cannot work is refused.
   */
  void
  check_memory_of_cells(const double       n_cells,
                        const unsigned int dim,
                        const std::string &parameter,
                        const MPI_Comm     comm);

  /**
   * Bytes that this process has allocated, empty where the system does not say.
   */
  std::optional<unsigned long>
  allocated_memory();
} // namespace greville

#endif
