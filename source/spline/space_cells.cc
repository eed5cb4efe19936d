// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/spline/cell_owner.h>
#include <greville/spline/coarse_cells.h>
#include <greville/spline/space_cells.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  SpaceCells<dim>::reinit(DistributedTriangulation<dim> &triangulation,
                          const bool                     on_parents)
  {
    tria         = &triangulation;
    comm         = get_communicator(triangulation);
    has_parents  = on_parents;
    children     = Lattice<dim>(triangulation);
    mesh_lattice = on_parents ? children.parents() : children;

    std::vector<std::pair<std::uint64_t, unsigned int>> found;
    for (const auto &cell : tria->active_cell_iterators())
      if (cell->is_locally_owned())
        found.emplace_back(lexicographic<dim>(mesh_lattice.find_cell(
                                                cell->center()),
                                              mesh_lattice.n_cells()),
                           cell->active_cell_index());
    std::sort(found.begin(), found.end());
    cells.clear();
    cell_numbers.assign(tria->n_active_cells(), numbers::invalid_unsigned_int);
    for (const auto &entry : found)
      {
        if (cells.empty() || cells.back() != entry.first)
          cells.push_back(entry.first);
        cell_numbers[entry.second] = cells.size() - 1;
      }
    const unsigned int n_children =
      has_parents ? GeometryInfo<dim>::max_children_per_cell : 1;
    run_on_all(comm, [&]() {
      Require(found.size() == cells.size() * n_children,
              "The children of a cell of the once coarser mesh are on "
              "several processes.");
    });
  }



  template <int dim>
  unsigned int
  SpaceCells<dim>::n_used_levels() const
  {
    if (!hierarchy())
      return 1;
    return tria->n_global_levels() -
           CoarseCells<dim>(hierarchy()->n_cells(0)).n_refinements;
  }



  template <int dim>
  bool
  SpaceCells<dim>::contains(const unsigned int cell, const Point<dim> &x) const
  {
    const CellBox<dim> at = box(cell);
    for (unsigned int d = 0; d < dim; ++d)
      {
        const bool   last  = mesh_lattice.is_last(d, at.index[d]);
        const double upper = last ? mesh_lattice.upper()[d]
                                  : mesh_lattice.edge(d, at.index[d] + 1);
        if (!(x[d] >= at.lower[d] && (x[d] < upper || (last && x[d] == upper))))
          return false;
      }
    return true;
  }



  template <int dim>
  unsigned int
  SpaceCells<dim>::find(const std::uint64_t position) const
  {
    const auto found = std::lower_bound(cells.begin(), cells.end(), position);
    return found != cells.end() && *found == position
             ? found - cells.begin()
             : numbers::invalid_unsigned_int;
  }



  template <int dim>
  unsigned int
  SpaceCells<dim>::owner(const std::uint64_t position) const
  {
    if (find(position) != numbers::invalid_unsigned_int)
      return Utilities::MPI::this_mpi_process(comm);
    MultiIndex<dim> cell = multi_index<dim>(position, mesh_lattice.n_cells());
    // A parent is where its first child is.
    for (unsigned int d = 0; d < dim && has_parents; ++d)
      cell[d] *= 2;
    return cell_owner<dim>(*tria, children, cell);
  }



  template <int dim>
  unsigned int
  SpaceCells<dim>::cell_number(const CellIterator &cell) const
  {
    Require(cell->is_locally_owned(), "Only owned cells have a place here.");
    return cell_numbers[cell->active_cell_index()];
  }



  GREVILLE_INSTANTIATE_CLASS(SpaceCells);
} // namespace greville
