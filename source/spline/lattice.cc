// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <greville/base/errors.h>
#include <greville/spline/coarse_cells.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Lattice<dim>::Lattice(const DistributedTriangulation<dim> &triangulation)
  {
    const MPI_Comm comm = get_communicator(triangulation);

    // Smallest and largest corners and cell sizes, with signs such that one
    // reduction suffices.
    const double        infinity = std::numeric_limits<double>::max();
    std::vector<double> local(4 * dim, infinity), global(4 * dim);
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double a = cell->vertex(0)[d];
            const double b =
              cell->vertex(GeometryInfo<dim>::vertices_per_cell - 1)[d];
            local[d]           = std::min(local[d], a);
            local[dim + d]     = std::min(local[dim + d], -b);
            local[2 * dim + d] = std::min(local[2 * dim + d], b - a);
            local[3 * dim + d] = std::min(local[3 * dim + d], a - b);
          }
    Utilities::MPI::min(local, comm, global);

    double product = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower_corner[d]   = global[d];
        upper_corner[d]   = -global[dim + d];
        const double size = global[2 * dim + d];
        Require(size > 0 && -global[3 * dim + d] - size <= 1e-6 * size,
                "A spline space needs a mesh whose cells are all boxes of the "
                "same size.");
        cells[d] = std::lround((upper_corner[d] - lower_corner[d]) / size);
        product *= cells[d];
      }
    Require(product ==
              static_cast<double>(triangulation.n_global_active_cells()),
            "A spline space needs a mesh whose cells fill a box.");
    set_sizes();

    // The faces of coarse cells are known on all processes.
    for (const auto &pair : triangulation.get_periodic_face_map())
      periodic[pair.first.second / 2] = true;
  }



  template <int dim>
  void
  Lattice<dim>::set_sizes()
  {
    for (unsigned int d = 0; d < dim; ++d)
      sizes[d] = (upper_corner[d] - lower_corner[d]) / cells[d];
  }



  template <int dim>
  Lattice<dim>
  Lattice<dim>::parents() const
  {
    Lattice result = *this;
    for (unsigned int d = 0; d < dim; ++d)
      {
        Require(cells[d] % 2 == 0,
                "Cells join in pairs only if their number is even in all "
                "directions; it is " +
                  std::to_string(cells[d]) + " in " + std::string(1, "xyz"[d]) +
                  ".");
        result.cells[d] /= 2;
      }
    result.set_sizes();
    return result;
  }



  template <int dim>
  MultiIndex<dim>
  Lattice<dim>::find_cell(const Point<dim> &point) const
  {
    MultiIndex<dim> index;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double h        = cell_size(d);
        const double position = (point[d] - lower_corner[d]) / h;
        index[d] = std::min<double>(std::max(position, 0.), cells[d] - 1);

        // The cell follows from the corners of cells, not from the rounded
        // quotient.
        if (index[d] > 0 && point[d] < lower_corner[d] + index[d] * h)
          --index[d];
        else if (index[d] + 1 < cells[d] &&
                 point[d] >= lower_corner[d] + (index[d] + 1) * h)
          ++index[d];
      }
    return index;
  }



  template <int dim>
  void
  create_box_mesh(DistributedTriangulation<dim> &triangulation,
                  const Point<dim>              &lower,
                  const Point<dim>              &upper,
                  const MultiIndex<dim>         &n_cells,
                  const std::array<bool, dim>   &periodic)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        Require(n_cells[d] > 0,
                "A box mesh needs at least one cell in each direction.");
        Require(lower[d] < upper[d],
                "The lower corner of a box has to be below its upper corner in "
                "each direction.");
      }

    const CoarseCells<dim> trees(n_cells);
    GridGenerator::subdivided_hyper_rectangle(
      triangulation,
      std::vector<unsigned int>(trees.n.begin(), trees.n.end()),
      lower,
      upper,
      true);
    std::vector<GridTools::PeriodicFacePair<
      typename DistributedTriangulation<dim>::cell_iterator>>
      pairs;
    for (unsigned int d = 0; d < dim; ++d)
      if (periodic[d])
        GridTools::collect_periodic_faces(
          triangulation, 2 * d, 2 * d + 1, d, pairs);
    if (!pairs.empty())
      triangulation.add_periodicity(pairs);
    triangulation.refine_global(trees.n_refinements);
  }



  GREVILLE_INSTANTIATE_CLASS(Lattice);
  GREVILLE_INSTANTIATE(create_box_mesh);
} // namespace greville
