// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/mass/extended_mass.h>
#include <greville/multigrid/level_operator.h>
#include <greville/paper/mass_matrix.h>

namespace greville
{
  /// Add int grad N_i . grad N_j dx over all owned cells. All functions must
  /// have a row.
  template <int dim>
  void
  add_laplace_matrix(StencilMatrix<dim> &matrix);

  /// The Laplacian of one order on a box by Gauss quadrature, as an assembled
  /// matrix. Constrained functions have the coefficient zero.
  template <int dim>
  class LaplaceLevel : public LevelOperator<dim>
  {
  public:
    /// Collective. The space is kept by reference. Local functions with a
    /// nonzero entry in @p constrained are constrained.
    LaplaceLevel(const SplineSpace<dim>           &space,
                 const std::vector<unsigned char> &constrained);

    const SplineSpace<dim> &
    space() const override
    {
      return spline_space;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      entries->vmult(dst, src);
    }

    const VectorType &
    diagonal() const override
    {
      return matrix_diagonal;
    }

    const std::vector<unsigned int> &
    inactive() const override
    {
      return constrained_functions;
    }

    Mat
    matrix() const override
    {
      return entries->petsc();
    }

    std::unique_ptr<Preconditioner>
    petsc_preconditioner(const std::string &options) const override;

    std::unique_ptr<Preconditioner>
    lattice_preconditioner(
      const LatticeCycleParameters &parameters) const override;

  private:
    const SplineSpace<dim>          &spline_space;
    const std::vector<unsigned char> constrained;
    Extension<dim>                   extension; // of no function
    ExtendedMass<dim>                stencil;
    std::unique_ptr<MassMatrix<dim>> entries;
    VectorType                       matrix_diagonal;
    std::vector<unsigned int>        constrained_functions; // owned ones
  };
} // namespace greville
