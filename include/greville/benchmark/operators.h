// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/paper/assembled_mass_level.h>

namespace greville
{
  /// The throughput of the operators in degrees of freedom per second, the
  /// bytes that all processes send to others in one tensor-product solve, and
  /// the bytes of the assembled matrix.
  struct OperatorRecord
  {
    unsigned int  dim = 0, cells = 0, p = 0, processes = 0;
    unsigned long unknowns    = 0;
    double        matrix_free = 0., assembled = 0., tensor_product = 0.;
    unsigned long bytes_sent = 0, matrix_bytes = 0;
  };

  /// Collective. Make, measure and free the operators of a level. Returns the
  /// record without the number of cells.
  template <int dim>
  OperatorRecord
  measure_operators(AssembledMassLevel<dim> &level);

  /// Return the memory bandwidth of all processes together in bytes per second:
  /// the best of some sweeps a_i = b_i + s c_i over arrays larger than the
  /// cache, with three numbers per i (J. McCalpin's STREAM triad).
  double
  measure_bandwidth(const MPI_Comm comm);
} // namespace greville
