// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/extended_level.h>

namespace greville
{
  /**
   * The Schur complement of the pressure of pore water on the space of one
   * order,
   * @f[ E^T \hat S E, @f]
   * with its entries (WaterPoints::add_schur_complement()) and the Extension E
   * of the space. The mass of the level is the volume. No function is
   * constrained, since drained boundaries impose the pressure weakly.
   */
  template <int dim>
  class PressureLevel : public ExtendedLevel<dim>
  {
  public:
    /// Collective. The space is kept by reference.
    PressureLevel(const SplineSpace<dim> &space);

    /// Collective. See ExtendedLevel::begin_level(). @p parts are the filled
    /// fractions of cells in the transfer between orders.
    void
    begin(const CellFilling<dim>    &filling,
          const std::vector<double> &parts,
          const bool                 changed);

    /// Set the matrix to zero and return it to be filled.
    StencilMatrix<dim> &
    begin_matrix();

    /// Collective. Finish the matrix after it has been filled.
    void
    finish_matrix();

    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    const ExtendedMass<dim> &
    diagonal_block(const unsigned int) const override
    {
      return matrix;
    }

    std::unique_ptr<ExtendedLattice<dim>>
    make_lattice() const override
    {
      return std::make_unique<ExtendedLattice<dim>>(matrix,
                                                    this->spline_extension,
                                                    this->constrained,
                                                    this->largest_diagonal());
    }

    ExtendedMass<dim> matrix; // with the unknowns of the mass
    UpperTriangle     entries;
  };
} // namespace greville
