// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/mass/extended_mass.h>
#include <greville/multigrid/lattice_level.h>

namespace greville
{
  /// The finest level of a LatticeCycle: a scalar matrix E^T B E. Derived
  /// classes have several components with the same unknowns.
  template <int dim>
  class ExtendedLattice : public LatticeLevel<dim>
  {
  public:
    using typename LatticeLevel<dim>::Lattice;
    using typename LatticeLevel<dim>::Position;
    using typename LatticeLevel<dim>::Terms;

    /// The arguments are kept by reference. Bit c of @p constrained[f]
    /// constrains component c of local function f. The entries are of the order
    /// of @p unit.
    ExtendedLattice(const ExtendedMass<dim>          &matrix,
                    const Extension<dim>             &extension,
                    const std::vector<unsigned char> &constrained,
                    const double                      unit);

    /// Return the local numbers of the functions of the owned unknowns.
    const std::vector<unsigned int> &
    unknown_functions() const
    {
      return matrix.unknowns().unknown_functions();
    }

    Lattice
    lattice() const override;

    unsigned int
    n_components() const override
    {
      return 1;
    }

    const InterleavedLayout &
    layout() const override
    {
      return *matrix.unknowns().unknown_layout();
    }

    std::vector<Position>
    unknown_positions() const override
    {
      return matrix.unknowns().unknown_positions();
    }

    std::vector<unsigned char>
    constrained_unknowns() const override
    {
      return matrix.unknowns().constrained_unknowns();
    }

    std::vector<std::pair<Position, unsigned char>>
    constrained_functions() const override;

    void
    for_each_extended(const std::function<void(const Position &, const Terms &)>
                        &visit) const override;

    void
    for_each_row(const std::function<void(const Position &, const float *)>
                   &visit) const override;

    double
    unit() const override
    {
      return matrix_unit;
    }

    void
    set_unit(const double unit)
    {
      matrix_unit = unit;
    }

    void
    multiply(SingleVector &y, SingleVector &x) const override;

    std::vector<UpperTriangle>
    diagonal_blocks(const bool by_components) const override;

  protected:
    /// Call visit(position, place) for the functions of this process with rows.
    template <typename Visit>
    void
    for_each_place(const Visit &visit) const
    {
      const StencilMatrix<dim> &places = matrix.matrix();
      for (unsigned int f = 0; f < constrained.size(); ++f)
        if (extension[f] != Extension<dim>::inactive)
          visit(position(places.space().function_position(f)), places.place(f));
      for (const auto &[f, place] : places.images())
        if (extension[f] != Extension<dim>::inactive)
          visit(position(places.space().function_position(f)), place);
    }

    const ExtendedMass<dim> &matrix;

  private:
    /// Return the position that has a lexicographic number.
    Position
    position(const std::uint64_t number) const;

    const Extension<dim>             &extension;
    const std::vector<unsigned char> &constrained;
    double                            matrix_unit;
    mutable VectorType                source, result;
  };
} // namespace greville
