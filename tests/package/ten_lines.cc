// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/spline_space.h>

#include <iostream>

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  greville::DistributedTriangulation<2>    mesh(MPI_COMM_WORLD,
                                             dealii::Triangulation<2>::none,
                                             greville::mesh_settings<2>);
  greville::create_box_mesh<2>(mesh, {0, 0}, {2, 1}, {{8, 4}});
  std::cout << greville::SplineSpace<2>(mesh, 3).n_dofs() << std::endl;
}
