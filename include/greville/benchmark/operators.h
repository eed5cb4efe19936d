// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_benchmark_operators_h
#define greville_benchmark_operators_h

#include <greville/paper/assembled_mass_level.h>

namespace greville
{
  /**
   * The throughput of the operators in degrees of freedom per second, the bytes
   * that the tensor-product solver sends to other processes in one solve (all
   * of them), and the bytes of the assembled matrix.
   */
  struct OperatorRecord
  {
    unsigned int  dim = 0, cells = 0, p = 0, processes = 0;
    unsigned long unknowns    = 0;
    double        matrix_free = 0., assembled = 0., tensor_product = 0.;
    unsigned long bytes_sent = 0, matrix_bytes = 0;
  };

  /**
   * Collective. Measure the operators of a level, whose operators are made and
   * freed; all but the number of cells is filled in.
   */
  template <int dim>
  OperatorRecord
  measure_operators(AssembledMassLevel<dim> &level);

  /**
   * The memory bandwidth of all processes together in bytes per second: the
   * best of some sweeps a_i = b_i + s c_i over arrays that fit no cache, three
   * numbers counted for each i (J. McCalpin's STREAM triad).
   */
  double
  measure_bandwidth(const MPI_Comm comm);
} // namespace greville

#endif
