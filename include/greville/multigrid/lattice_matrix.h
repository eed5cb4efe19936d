// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/petsc.h>
#include <greville/multigrid/lattice_unknowns.h>

namespace greville
{
  /// The Galerkin product @f$ P^T A P @f$ of a level on the lattice of twice
  /// the size, or of a refined grid without its last level of cells. Splines
  /// are nested, so rows keep the size of a HalfStencil. Extended functions of
  /// the finer level add a few blocks beyond it, also between levels of cells,
  /// which are listed separately.
  template <int dim>
  class LatticeMatrix : public LatticeLevel<dim>
  {
  public:
    using Lattice  = typename LatticeLevel<dim>::Lattice;
    using Position = typename LatticeLevel<dim>::Position;
    using FarBlock = typename LatticeLevel<dim>::FarBlock;

    /// Collective. @p fine is used by this call only. Without @p coarsen, the
    /// lattice stays the same, and the product is E^T B E.
    explicit LatticeMatrix(const LatticeLevel<dim> &fine,
                           const bool               coarsen = true);

    /// Return whether any direction is coarser than on the finer level.
    static bool
    can_coarsen(const LatticeLevel<dim> &fine);

    /// Return the unknowns with P.
    const LatticeUnknowns<dim> &
    unknowns() const
    {
      return places;
    }

    /// Collective. Return @f$ Q^T A Q @f$, row by row. Q has @p n columns;
    /// rows_of_Q(u, c, add) calls add(j, w) for the entries w in the row of the
    /// unconstrained component c of local unknown u.
    using AddEntry = std::function<void(unsigned int column, double weight)>;
    using Rows     = std::function<void(const unsigned int unknown,
                                    const unsigned int component,
                                    const AddEntry    &add)>;
    std::vector<double>
    reduced_entries(const unsigned int n, const Rows &rows_of_Q) const;

    /// Collective. Return @p unit times the entries; constrained components
    /// have the diagonal entry @p unit.
    PetscMatrix
    petsc_matrix(const double unit) const;

    Lattice
    lattice() const override
    {
      return places.lattice();
    }

    unsigned int
    n_components() const override
    {
      return places.n_components();
    }

    const InterleavedLayout &
    layout() const override
    {
      return *places.layout();
    }

    std::vector<Position>
    unknown_positions() const override
    {
      const auto begin = places.positions().begin();
      return {begin, begin + layout().n_owned()};
    }

    std::vector<unsigned char>
    constrained_unknowns() const override
    {
      const auto begin = places.constrained().begin();
      return {begin, begin + layout().n_owned()};
    }

    std::vector<std::pair<Position, unsigned char>>
    constrained_functions() const override;

    void
    for_each_row(const std::function<void(const Position &, const float *)>
                   &visit) const override;

    void
    for_each_far_block(
      const std::function<void(const FarBlock &)> &visit) const override
    {
      for (const FarBlock &block : far_blocks)
        visit(block);
    }

    double
    unit() const override
    {
      return 1.;
    }

    void
    multiply(SingleVector &y, SingleVector &x) const override;

    std::vector<UpperTriangle>
    diagonal_blocks(const bool by_components) const override;

  private:
    /// Call an action with two constants: the numbers of components, and of
    /// functions of a cell per direction.
    template <typename Action>
    void
    with_sizes(const Action &action) const;

    /// Call visit(u, v, block, stride) for the blocks of the half rows, entry
    /// (c, d) at block[c * stride + d].
    template <typename Visit>
    void
    for_each_block(const Visit &visit) const;

    /// Return the upper triangle of the diagonal block of a component, or of
    /// the mean of all diagonal blocks (-1).
    UpperTriangle
    diagonal_block(const int component) const;

    const LatticeUnknowns<dim> places;
    std::size_t                row_size = 0;
    std::vector<float>         rows;

    // The distances to the first number of each line of a row, by level.
    std::vector<std::ptrdiff_t> line_begins;

    std::vector<FarBlock>                              far_blocks;
    std::vector<std::pair<unsigned int, unsigned int>> far_unknowns;

    mutable std::vector<float> place_x, place_y;
  };
} // namespace greville
