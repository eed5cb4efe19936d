// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <tests.h>

// A hierarchy of n^dim cells on the unit cube, refined where a function of the
// level and the centre of a cell says so.
template <int dim>
using Where = std::function<bool(const unsigned int, const Point<dim> &)>;

template <int dim>
std::shared_ptr<const CellHierarchy<dim>>
hierarchy(const unsigned int n,
          const unsigned int n_levels,
          const unsigned int p,
          const Where<dim>  &where)
{
  CellEdges<dim> edges;
  for (unsigned int d = 0; d < dim; ++d)
    for (unsigned int k = 0; k <= n; ++k)
      edges[d].push_back(double(k) / n);
  return std::make_shared<const CellHierarchy<dim>>(
    edges, n_levels, p, [where](const unsigned int l, const CellBox<dim> &box) {
      return where(l, box.center);
    });
}



template <int dim>
struct RefinedBox
{
  DistributedTriangulation<dim> mesh;

  RefinedBox(const std::shared_ptr<const CellHierarchy<dim>> &levels)
    : mesh(MPI_COMM_WORLD,
           Triangulation<dim>::limit_level_difference_at_vertices,
           mesh_settings<dim>)
  {
    Point<dim> upper;
    for (unsigned int d = 0; d < dim; ++d)
      upper[d] = 1.;
    create_box_mesh<dim>(
      mesh, Point<dim>(), upper, levels->n_cells(0), {}, {}, levels);
  }
};
