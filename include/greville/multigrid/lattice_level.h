// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/overlapping_cholesky.h>
#include <greville/multigrid/half_stencil.h>
#include <greville/multigrid/nested_knots.h>

#include <functional>

namespace greville
{
  /// A vector of unknowns in single precision, with interleaved components.
  using SingleVector = VectorOf<float>;

  /// A symmetric operator on splines, as a level of LatticeCycle. Some
  /// functions of the splines are *unknowns*. Functions have positions in a
  /// lattice, which are wrapped in periodic directions. The operator is the sum
  /// of the rows of all processes.
  template <int dim>
  class LatticeLevel
  {
  public:
    using Lattice  = std::array<NestedKnots, 3>; // a cell of order 0 beyond dim
    using Position = std::array<int, 3>;         // zero beyond dim
    using Terms    = std::vector<std::pair<Position, float>>;

    virtual ~LatticeLevel() = default;

    virtual Lattice
    lattice() const = 0;

    virtual unsigned int
    n_components() const = 0;

    /// Return the layout of the unknowns.
    virtual const InterleavedLayout &
    layout() const = 0;

    /// Return the positions of the owned unknowns.
    virtual std::vector<Position>
    unknown_positions() const = 0;

    /// Return the constrained components (bits) of the owned unknowns.
    virtual std::vector<unsigned char>
    constrained_unknowns() const = 0;

    /// Return the constrained functions with stored rows on this process, and
    /// their constrained components (bits).
    virtual std::vector<std::pair<Position, unsigned char>>
    constrained_functions() const = 0;

    /// Call visit(position, terms) for the extended functions with rows; the
    /// terms are positions and weights of the unknowns.
    virtual void
    for_each_extended(const std::function<void(const Position &, const Terms &)>
                        & /*visit*/) const
    {}

    /// Call visit(position, row) for the rows of this process, in the memory of
    /// a HalfStencil.
    virtual void
    for_each_row(const std::function<void(const Position &, const float *)>
                   &visit) const = 0;

    /// A block of functions i, j that does not fit into a HalfStencil. Its
    /// transpose belongs to j, i. Positions are not wrapped.
    struct FarBlock
    {
      Position i, j;
      float    block[dim * dim];
    };

    /// Call visit(block) for the far blocks of this process.
    virtual void
    for_each_far_block(
      const std::function<void(const FarBlock &)> & /*visit*/) const
    {}

    /// Return the divisor of the matrix in multiply() and for_each_row().
    virtual double
    unit() const = 0;

    /// Collective. Compute y = A x. The ghost entries of x are zero afterwards.
    virtual void
    multiply(SingleVector &y, SingleVector &x) const = 0;

    /// Return this process' part, between local unknowns, of the mean of the
    /// diagonal blocks of all components, or of each block.
    virtual std::vector<UpperTriangle>
    diagonal_blocks(const bool by_components) const = 0;
  };
} // namespace greville
