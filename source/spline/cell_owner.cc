// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/distributed/p4est_wrappers.h>

#include <greville/spline/cell_owner.h>
#include <greville/spline/coarse_cells.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  unsigned int
  cell_owner(const DistributedTriangulation<dim> &triangulation,
             const Lattice<dim>                  &lattice,
             const MultiIndex<dim>               &lattice_index)
  {
    // The position of a cell is the position of its coarse cell and the
    // position in the coarse cell.
    unsigned int    level = triangulation.n_global_levels() - 1;
    MultiIndex<dim> index = lattice_index, n_cells = lattice.n_cells();
    if (const CellHierarchy<dim> *levels = lattice.hierarchy())
      {
        const unsigned int l = levels->level(index);
        for (unsigned int d = 0; d < dim; ++d)
          index[d] -= levels->offset(l)[d];
        n_cells = levels->n_cells(l);
        level   = l + CoarseCells<dim>(levels->n_cells(0)).n_refinements;
      }
    MultiIndex<dim> coarse_index, n_coarse;
    for (unsigned int d = 0; d < dim; ++d)
      {
        coarse_index[d] = index[d] >> level;
        n_coarse[d]     = n_cells[d] >> level;
      }

    const auto is_it = [&](const unsigned int coarse) {
      const typename Triangulation<dim>::cell_iterator cell(&triangulation,
                                                            0,
                                                            coarse);
      const CellBox<dim> box = lattice.box(lattice_index);
      for (unsigned int d = 0; d < dim; ++d)
        if (!(cell->vertex(0)[d] < box.center[d] &&
              box.center[d] <
                cell->vertex(GeometryInfo<dim>::vertices_per_cell - 1)[d]))
          return false;
      return true;
    };
    // Coarse cells of create_box_mesh() are in lexicographic order.
    unsigned int coarse = lexicographic<dim>(coarse_index, n_coarse);
    if (!is_it(coarse))
      for (coarse = 0; !is_it(coarse);)
        {
          ++coarse;
          AssertThrow(coarse < triangulation.n_cells(0), ExcInternalError());
        }

    using P4est = internal::p4est::functions<dim>;
    typename internal::p4est::types<dim>::quadrant quadrant{};
    quadrant.level           = level;
    const unsigned int shift = P4est::max_level - level;
    const auto         place = [&](const unsigned int d) {
      return (index[d] - (coarse_index[d] << level)) << shift;
    };
    quadrant.x = place(0);
    quadrant.y = place(1);
    if constexpr (dim == 3)
      quadrant.z = place(2);
    // p4est's function takes a forest that is not const, but does not change
    // it.
    return P4est::comm_find_owner(
      const_cast<typename internal::p4est::types<dim>::forest *>(
        triangulation.get_p4est()),
      triangulation.get_coarse_cell_to_p4est_tree_permutation()[coarse],
      &quadrant,
      Utilities::MPI::this_mpi_process(get_communicator(triangulation)));
  }



  GREVILLE_INSTANTIATE(cell_owner);
} // namespace greville
