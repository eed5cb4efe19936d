// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/distributed/p4est_wrappers.h>

#include <greville/spline/cell_owner.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  unsigned int
  cell_owner(const DistributedTriangulation<dim> &triangulation,
             const Lattice<dim>                  &lattice,
             const MultiIndex<dim>               &index)
  {
    // All active cells have the same level. The position of a cell is the
    // position of its coarse cell and the position in the coarse cell.
    const unsigned int level = triangulation.n_global_levels() - 1;
    MultiIndex<dim>    coarse_index, n_coarse;
    for (unsigned int d = 0; d < dim; ++d)
      {
        coarse_index[d] = index[d] >> level;
        n_coarse[d]     = lattice.n_cells()[d] >> level;
      }

    const auto is_it = [&](const unsigned int coarse) {
      const typename Triangulation<dim>::cell_iterator cell(&triangulation,
                                                            0,
                                                            coarse);
      const auto place = lattice.find_cell(cell->center());
      for (unsigned int d = 0; d < dim; ++d)
        if (place[d] >> level != coarse_index[d])
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
