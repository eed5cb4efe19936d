// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/base/index_set.h>
#include <deal.II/base/partitioner.h>
#include <deal.II/base/types.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe.h>

#include <greville/spline/knot_vector.h>
#include <greville/spline/space_cells.h>

#include <memory>

namespace greville
{
  /**
   * Tensor-product B-splines of order p on open knot vectors, whose inner knots
   * are the edges between the cells of a distributed box mesh,
   * @f[ u(x) = \sum_i c_i \prod_d N_{i_d}(x_d), @f]
   * with one function per Greville point: n + p in a direction of n cells. In a
   * periodic direction of the mesh, knots are uniform, the n functions are
   * translates of one another, and function i of the knots is function i mod n
   * of the space. The interface resembles a DoFHandler; a *dof* is a
   * coefficient c_i.
   *
   * **Ownership.** A coefficient belongs to the process that owns the cell of
   * its Greville point (the upper one if the point lies between two cells). The
   * rule needs no communication for the coefficients of owned cells; the owners
   * of others are obtained from p4est and their numbers from the owners. No
   * array has the size of the whole mesh, only of a single direction (n
   * numbers).
   *
   * **Numbering.** Contiguous per process, lexicographic (x fastest) among the
   * coefficients of a process; incomplete factorizations depend on that order.
   *
   * **Refined grids.** On a mesh with a CellHierarchy, the space has the
   * functions of the lattices of all levels, each restricted to the active
   * cells of its own level. On the active cells of level l, a spline of the
   * space is thus a spline of level l. Splines that are continuous between
   * levels are a subspace, which Extension finds. A function that has no active
   * cell does not exist. If the cell of a Greville point is not active, the
   * coefficient belongs to the nearest active cell of the function.
   *
   * The triangulation must have the settings ::mesh_settings and must outlive
   * the space. Call reinit() after each repartitioning.
   */
  template <int dim>
  class SplineSpace : public SpaceCells<dim>
  {
  public:
    using CellIterator = typename SpaceCells<dim>::CellIterator;

    SplineSpace() = default;

    /// Construct and call reinit().
    SplineSpace(DistributedTriangulation<dim> &triangulation,
                const unsigned int             degree,
                const bool                     on_parents = false);

    /// Collective. Throws dealii::ExcMessage for an order outside 1...5, a mesh
    /// that is not a Lattice, less than p + 1 cells in a periodic direction, or
    /// parents of an odd number of cells.
    void
    reinit(DistributedTriangulation<dim> &triangulation,
           const unsigned int             degree,
           const bool                     on_parents = false);

    /// The largest order for which kernels are compiled.
    static constexpr unsigned int max_degree = 5;

    unsigned int
    degree() const
    {
      return p;
    }

    const KnotVector &
    knots(const unsigned int d) const
    {
      return knot_vectors[d];
    }

    /// Return the numbers of functions in each direction; in refined grids,
    /// the extents of their positions.
    const MultiIndex<dim> &
    n_functions() const
    {
      return extents;
    }

    /// Return the Bezier elements: FE_Bernstein of order p.
    const dealii::FiniteElement<dim> &
    fe() const
    {
      return *element;
    }

    // Numbers of dofs, as in a DoFHandler.

    dealii::types::global_dof_index
    n_dofs() const
    {
      return n_all;
    }

    unsigned int
    n_locally_owned_dofs() const
    {
      return owned.size();
    }

    const dealii::IndexSet &
    locally_owned_dofs() const
    {
      return partition->locally_owned_range();
    }

    /// Return the layout of vectors whose ghost entries are the relevant dofs.
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
    partitioner() const
    {
      return partition;
    }

    void
    initialize_vector(VectorType &vector) const
    {
      vector.reinit(partition);
    }

    unsigned int
    n_dofs_per_cell() const
    {
      return functions_per_cell;
    }

    /// Return the global numbers of the dofs of a locally owned cell, in
    /// lexicographic order.
    void
    cell_dof_indices(
      const CellIterator                           &cell,
      std::vector<dealii::types::global_dof_index> &indices) const;

    // Bezier extraction.

    /// Return the matrix with @f$ N_a = \sum_b C_{ab} B_b @f$ on a cell, for
    /// functions and Bernstein polynomials in lexicographic order: the
    /// Kronecker product of KnotVector::extraction_matrix() of the directions.
    dealii::FullMatrix<double>
    extraction(const CellIterator &cell) const;

    /// Collective. Write the spline with @p coefficients (ghost entries are not
    /// needed) as a field of @p dof_handler, which has the element fe(), into
    /// @p bernstein, a vector with (at least) the locally owned dofs of
    /// @p dof_handler.
    void
    extract(const VectorType              &coefficients,
            const dealii::DoFHandler<dim> &dof_handler,
            VectorType                    &bernstein) const;

    // The functions of this process, for loops over arrays. Numbers begin with
    // 0; owned functions come first.

    /// Lexicographic positions (in n_functions()) of the owned functions,
    /// ascending; the local number of a function is its place here.
    const std::vector<std::uint64_t> &
    owned_functions() const
    {
      return owned;
    }

    /// Return the lexicographic positions of the functions of owned cells that
    /// other processes own. Their local numbers follow the owned functions.
    const std::vector<std::uint64_t> &
    ghost_functions() const
    {
      return ghosts;
    }

    /// Return the local numbers of the (p + 1)^dim functions of owned cell
    /// number @p cell, in lexicographic order.
    dealii::ArrayView<const unsigned int>
    cell_functions(const unsigned int cell) const
    {
      return {cell_function_numbers.data() +
                std::size_t(cell) * functions_per_cell,
              functions_per_cell};
    }

    /// Return whether the function at a position exists: in refined grids,
    /// whether it has an active cell of its level.
    bool
    exists(const std::uint64_t position) const;

    /// Collective. Return the global numbers of functions at lexicographic
    /// @p positions, anywhere in the mesh. All of them must exist.
    std::vector<dealii::types::global_dof_index>
    global_numbers(const std::vector<std::uint64_t> &positions) const;

    /// Return the processes that own functions at lexicographic @p positions.
    std::vector<unsigned int>
    owners_of_functions(const std::vector<std::uint64_t> &positions) const;

    /// Return the lexicographic position of a function with a local number.
    std::uint64_t
    function_position(const unsigned int function) const
    {
      return function < owned.size() ? owned[function]
                                     : ghosts[function - owned.size()];
    }

    dealii::Point<dim>
    greville_point(const unsigned int function) const;

    /// Return the size of the smallest cell in the support of function @p i of
    /// the knots in a direction.
    double
    smallest_cell_of(const unsigned int i, const unsigned int d) const;

    /// Return whether the function with a local number does not vanish on a
    /// side of the grid: 2 d at the lower and 2 d + 1 at the upper end of
    /// direction d. Periodic directions have no sides.
    bool
    on_side(const unsigned int function, const unsigned int side) const;

  private:
    using SpaceCells<dim>::cells;
    using SpaceCells<dim>::comm;
    using SpaceCells<dim>::mesh_lattice;

    /// Set the knots of a direction, and the cells of Greville points.
    void
    make_knots(const unsigned int d);

    /// Set the number of functions of a grid without levels.
    void
    count_functions();

    /// Return the cell whose owner owns a function.
    MultiIndex<dim>
    anchor_cell(const MultiIndex<dim> &function) const;

    void
    find_owned_functions();

    /// Append the functions whose anchor_cell() is the cell.
    void
    append_functions_of(const MultiIndex<dim> &cell);

    void
    number_functions();

    void
    make_partitioner();

    unsigned int                                p                  = 0;
    unsigned int                                functions_per_cell = 0;
    std::array<KnotVector, dim>                 knot_vectors;
    MultiIndex<dim>                             extents{};
    std::unique_ptr<dealii::FiniteElement<dim>> element;

    /// Return the number in the space of function @p i of the knots in a
    /// direction.
    unsigned int
    wrapped(const unsigned int i, const unsigned int d) const
    {
      return i < extents[d] ? i : i - extents[d];
    }

    // The cell of the Greville point of each function, per direction. It
    // increases with the function, except for the first p / 2 of a periodic
    // direction.
    std::array<std::vector<unsigned int>, dim> anchor_cells;

    std::vector<std::uint64_t>                   owned;
    std::vector<std::uint64_t>                   ghosts;
    std::vector<dealii::types::global_dof_index> ghost_numbers;
    std::vector<unsigned int>                    cell_function_numbers;
    dealii::types::global_dof_index              first_owned = 0, n_all = 0;

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;
  };
} // namespace greville
