// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_lattice_matrix_h
#define greville_multigrid_lattice_matrix_h

#include <greville/multigrid/lattice_level.h>

#include <memory>

namespace greville
{
  /**
   * The Galerkin product @f$ P^T A P @f$ of a level on the lattice of twice the
   * size, and the knot insertion P between the unknowns, which is multilinear
   * for order 1. The unknowns are all coarse functions from which a component
   * of an unknown of the finer level is interpolated, except for components
   * from which a constrained one is interpolated. Splines are nested, so that
   * rows keep the size of a HalfStencil; extended functions of the finer level
   * add a few blocks beyond it, which are listed.
   */
  template <int dim>
  class LatticeMatrix : public LatticeLevel<dim>
  {
  public:
    using Lattice  = typename LatticeLevel<dim>::Lattice;
    using Position = typename LatticeLevel<dim>::Position;

    /**
     * Collective. @p fine is used by this call only.
     */
    explicit LatticeMatrix(const LatticeLevel<dim> &fine);

    /// Return whether any direction is coarser than on the finer level.
    static bool
    can_coarsen(const LatticeLevel<dim> &fine);

    /// Compute fine += P coarse; the ghost entries of @p coarse are zero
    /// afterwards.
    void
    prolongate_and_add(SingleVector &fine, SingleVector &coarse) const;

    /// Compute coarse = P^T fine.
    void restrict(SingleVector &coarse, const SingleVector &fine) const;

    /// Collective. Return all entries, row by row, with a unit diagonal of
    /// constrained components.
    std::vector<double>
    all_entries() const;

    Lattice
    lattice() const override
    {
      return knots;
    }

    unsigned int
    n_components() const override
    {
      return components;
    }

    const InterleavedLayout &
    layout() const override
    {
      return *unknowns;
    }

    std::vector<Position>
    unknown_positions() const override
    {
      return {positions.begin(), positions.begin() + unknowns->n_owned()};
    }

    std::vector<unsigned char>
    constrained_unknowns() const override
    {
      return {constrained.begin(), constrained.begin() + unknowns->n_owned()};
    }

    std::vector<std::pair<Position, unsigned char>>
    constrained_functions() const override;

    void
    for_each_extended(
      const std::function<void(const Position &,
                               const typename LatticeLevel<dim>::Terms &)> &)
      const override
    {}

    void
    for_each_row(const std::function<void(const Position &, const double *)>
                   &visit) const override;

    /// Free the rows of double precision, after coarser() and factorize().
    void
    finish();

    void
    for_each_far_block(
      const std::function<void(const typename LatticeLevel<dim>::FarBlock &)>
        &visit) const override
    {
      for (const Beyond &entry : beyond)
        visit(entry);
    }

    double
    unit() const override
    {
      return 1.;
    }

    void
    multiply(SingleVector &y, SingleVector &x) const override;

    std::vector<OverlappingCholesky>
    factorize(const CholeskyParameters &parameters,
              const bool                by_components) const override;

  private:
    template <int nc, int n>
    class Product;

    /// Call an action with the numbers of components and of functions per
    /// direction of a cell as constants.
    template <typename Action>
    void
    with_sizes(const Action &action) const;

    /// Collective. Choose the unknowns, given the rows of insertions.
    void
    number_unknowns(const LatticeLevel<dim> &fine);

    /// Set the places of the unknowns in a box around them, with a margin of p.
    void
    make_places();

    void
    make_transfer(const LatticeLevel<dim> &fine);

    /// Return the number of functions beyond each end with an insertion.
    int
    margin() const
    {
      return 4 * knots[0].degree() + 2;
    }

    /// Return the insertion of a fine function in a direction.
    const NestedKnots::Row &
    insertion(const unsigned int d, const int i) const
    {
      return insertions[d][i + margin()];
    }

    /// Call visit(position, weight) for the coarse functions of a fine one,
    /// wrapped.
    template <typename Visit>
    void
    for_each_coarse(const Position &fine, const Visit &visit) const;

    int
    wrap(const unsigned int d, const int i) const
    {
      const int n = knots[d].n_functions();
      return knots[d].is_periodic() ? (i % n + n) % n : i;
    }

    std::uint64_t
    key(const Position &position) const
    {
      std::uint64_t result = 0;
      for (int d = dim - 1; d >= 0; --d)
        result = result * knots[d].n_functions() + position[d];
      return result;
    }

    std::size_t
    place(const Position &position) const
    {
      std::size_t result = 0;
      for (int d = dim - 1; d >= 0; --d)
        result = result * extents[d] + (position[d] - lowest[d]);
      return result;
    }

    /// Return the local unknown at a position, -1 if there is none.
    int
    find(const Position &position) const;

    /// Return the upper triangle of the diagonal block of a component, or of
    /// the mean of all blocks (-1).
    UpperTriangle
    diagonal_block(const int component) const;

    /// Call visit(u, v, block, stride) for the blocks of the half rows, entry
    /// (c, d) at block[c * stride + d].
    template <typename Visit>
    void
    for_each_block(const Visit &visit) const;

    const unsigned int                                 components;
    Lattice                                            knots;
    std::array<std::vector<NestedKnots::Row>, dim>     insertions;
    std::shared_ptr<const InterleavedLayout>           unknowns;
    std::vector<Position>                              positions; // local
    std::vector<unsigned char>                         constrained;
    std::array<int, dim>                               lowest{}, extents{};
    std::vector<unsigned int>                          places; // local
    std::vector<std::pair<unsigned int, unsigned int>> images; // place, unknown
    std::vector<int>                                   unknown_at; // place
    std::vector<std::ptrdiff_t>                        distances;  // of lines
    std::size_t                                        row_size = 0;
    std::vector<double>                                rows;
    std::vector<float>                                 single_rows;
    mutable std::vector<float>                         place_x, place_y;

    /// A far block of two local unknowns.
    struct Beyond : public LatticeLevel<dim>::FarBlock
    {
      unsigned int u, v;
    };
    std::vector<Beyond> beyond;

    // The rows of P for the owned unknowns of the finer level.
    struct Weight
    {
      unsigned int unknown;
      float        weight;
    };
    std::vector<std::size_t> transfer_begin = {0};
    std::vector<Weight>      transfer;
  };
} // namespace greville

#endif
