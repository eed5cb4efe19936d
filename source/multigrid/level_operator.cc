// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/level_operator.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  initialize_vector(VectorType &vector, const LevelOperator<dim> &level)
  {
    const SplineSpace<dim> &space = level.space();
    const unsigned int      n     = level.n_components();
    if (n == 1)
      {
        space.initialize_vector(vector);
        return;
      }
    const auto range = space.partitioner()->local_range();
    IndexSet   owned(n * space.n_dofs());
    owned.add_range(n * range.first, n * range.second);
    vector.reinit(owned, space.communicator());
  }



  template void
  initialize_vector<2>(VectorType &, const LevelOperator<2> &);
  template void
  initialize_vector<3>(VectorType &, const LevelOperator<3> &);
} // namespace greville
