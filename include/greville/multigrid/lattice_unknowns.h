// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/lattice_box.h>
#include <greville/multigrid/lattice_level.h>

#include <memory>

namespace greville
{
  /// The unknowns on the lattice of twice the size below a level, and the knot
  /// insertion P from them to the level, which is multilinear for order 1. In a
  /// refined grid, they are the unknowns without the last level of cells. The
  /// unknowns are all coarse functions that are needed to interpolate a
  /// component of an unknown of the finer level. A coarse component is
  /// constrained if it is needed to interpolate a constrained one.
  template <int dim>
  class LatticeUnknowns
  {
  public:
    using Lattice  = typename LatticeLevel<dim>::Lattice;
    using Position = typename LatticeLevel<dim>::Position;

    /// Collective. @p fine is used by this call only. Without @p coarsen, the
    /// lattice is the same, and P = E.
    LatticeUnknowns(const LatticeLevel<dim> &fine, const bool coarsen);

    const Lattice &
    lattice() const
    {
      return knots;
    }

    const std::shared_ptr<const InterleavedLayout> &
    layout() const
    {
      return unknowns;
    }

    unsigned int
    n_components() const
    {
      return components;
    }

    /// Return the positions of the local unknowns, owned ones first.
    const std::vector<Position> &
    positions() const
    {
      return local_positions;
    }

    /// Return the constrained components (bits) of the local unknowns.
    const std::vector<unsigned char> &
    constrained() const
    {
      return constrained_components;
    }

    bool
    is_constrained(const unsigned int u, const unsigned int c) const
    {
      return (constrained_components[u] >> c) & 1;
    }

    /// Return whether a function of the finer level exists; @p i may be any
    /// integer in periodic directions.
    bool
    has_insertion(const unsigned int d, const int i) const
    {
      const int k = i + margin();
      return k >= 0 && k < int(insertions[d].size()) &&
             !insertions[d][k].weights.empty();
    }

    const NestedKnots::Row &
    insertion(const unsigned int d, const int i) const
    {
      return insertions[d][i + margin()];
    }

    /// Return the first coarse functions, direction by direction, of a function
    /// of the finer level.
    Position
    first_coarse(const Position &i) const
    {
      return {{insertion(0, i[0]).first,
               insertion(1, i[1]).first,
               insertion(2, i[2]).first}};
    }

    /// Call visit(I, weight) for the coarse functions I that interpolate a
    /// function of the finer level. I is not wrapped.
    template <typename Visit>
    void
    for_each_coarse(const Position &i, const Visit &visit) const
    {
      const NestedKnots::Row &x = insertion(0, i[0]), &y = insertion(1, i[1]),
                             &z = insertion(2, i[2]);
      for (unsigned int kz = 0; kz < z.weights.size(); ++kz)
        for (unsigned int ky = 0; ky < y.weights.size(); ++ky)
          for (unsigned int kx = 0; kx < x.weights.size(); ++kx)
            visit(Position{{x.first + int(kx),
                            y.first + int(ky),
                            z.first + int(kz)}},
                  x.weights[kx] * y.weights[ky] * z.weights[kz]);
    }

    Position
    wrapped(const Position &i) const
    {
      return {{wrap(0, i[0]), wrap(1, i[1]), wrap(2, i[2])}};
    }

    /// Return the level of cells of a function of the coarse lattice.
    unsigned int
    level(const Position &i) const
    {
      return knots[0].level(i[0]);
    }

    /// Return the local unknown at a position, -1 if there is none.
    int
    find(const Position &i) const
    {
      const std::size_t at = boxes.place(i);
      return at < unknown_at.size() ? unknown_at[at] : -1;
    }

    /// Return the local unknown in another line at the distance @p x from u, -1
    /// if there is none; see distance().
    int
    unknown_in_line(const unsigned int u, const int line, const int x) const
    {
      return unknown_at[unknown_places[u] + distance(unknown_levels[u], line) +
                        x];
    }

    /// Return the distance from a place to the same x in another line of a
    /// level of cells; lines are counted from the own line as in HalfStencil.
    std::ptrdiff_t
    distance(const unsigned int level, const int line) const
    {
      return distances[level][line + int(distances[level].size() / 2)];
    }

    /// Return the levels of cells of the local unknowns.
    const std::vector<unsigned char> &
    levels() const
    {
      return unknown_levels;
    }

    /// Return the places of the local unknowns in boxes with margins.
    const std::vector<unsigned int> &
    places() const
    {
      return unknown_places;
    }

    std::size_t
    n_places() const
    {
      return boxes.size();
    }

    /// Return the periodic images: places and their unknowns.
    const std::vector<std::pair<unsigned int, unsigned int>> &
    images() const
    {
      return image_places;
    }

    /// Call visit(f, u, weight) for the entries of P: owned unknowns f of the
    /// finer level and local unknowns u.
    template <typename Visit>
    void
    for_each_weight(const Visit &visit) const
    {
      for (std::size_t f = 0; f + 1 < transfer_begin.size(); ++f)
        for (std::size_t e = transfer_begin[f]; e < transfer_begin[f + 1]; ++e)
          visit(unsigned(f), transfer[e].unknown, transfer[e].weight);
    }

    /// Compute fine += P coarse; the ghost entries of @p coarse are zero
    /// afterwards.
    void
    prolongate_and_add(SingleVector &fine, SingleVector &coarse) const;

    /// Compute coarse = P^T fine.
    void restrict(SingleVector &coarse, const SingleVector &fine) const;

  private:
    /// The coarse functions of a process. For each one, the components (bits)
    /// that finer unknowns need, and whether rows refer to it.
    struct Wanted
    {
      LatticeBoxes               boxes;
      std::vector<unsigned char> needed, is_listed;
    };

    /// Return the number of stored insertions beyond each end.
    int
    margin() const
    {
      return 4 * knots[0].degree() + 2;
    }

    int
    wrap(const unsigned int d, const int i) const
    {
      const int n = knots[d].n_functions();
      return knots[d].is_periodic() ? (i % n + n) % n : i;
    }

    Wanted
    find_wanted(const LatticeLevel<dim> &fine) const;

    /// Collective. Choose the unknowns.
    void
    number_unknowns(const LatticeLevel<dim> &fine);

    /// Return, for each place, whether component c is needed or interpolates a
    /// constrained one on this process.
    std::vector<double>
    states_of_component(const unsigned int       c,
                        const Wanted            &wanted,
                        const LatticeLevel<dim> &fine) const;

    void
    make_places();

    void
    make_transfer(const LatticeLevel<dim> &fine);

    const unsigned int                           components;
    Lattice                                      knots;
    std::array<std::vector<NestedKnots::Row>, 3> insertions;
    std::shared_ptr<const InterleavedLayout>     unknowns;
    std::vector<Position>                        local_positions;
    std::vector<unsigned char>                   constrained_components;

    LatticeBoxes                                       boxes;
    std::vector<unsigned char>                         unknown_levels;
    std::vector<unsigned int>                          unknown_places;
    std::vector<std::pair<unsigned int, unsigned int>> image_places;
    std::vector<int>                                   unknown_at; // by place
    std::vector<std::vector<std::ptrdiff_t>>           distances;  // by level

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
