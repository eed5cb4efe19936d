// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_water_pressure_level_h
#define greville_water_pressure_level_h

#include <greville/linear_algebra/partitioned_cholesky.h>
#include <greville/mass/extended_mass.h>
#include <greville/multigrid/level_operator.h>

namespace greville
{
  /**
   * The Schur complement of the pressure of pore water on the space of one
   * order,
   * @f[ E^T \hat S E, @f]
   * with its entries (WaterPoints::add_schur_complement()) and the Extension E
   * of the space: a level of p-multigrid. All functions are free, as drained
   * boundaries hold none.
   */
  template <int dim>
  class PressureLevel : public LevelOperator<dim>
  {
  public:
    /**
     * Collective. The space is kept by reference.
     */
    PressureLevel(const SplineSpace<dim> &space);

    /**
     * Collective. The filling, which is kept by reference, is that of points at
     * new places; @p changed tells whether it differs from that of the last
     * call. Cells count as filled by @p parts in the transfer between orders.
     */
    void
    begin(const CellFilling<dim>    &filling,
          const std::vector<double> &parts,
          const bool                 changed);

    /**
     * Set the matrix to zero, which is to be filled.
     */
    StencilMatrix<dim> &
    begin_matrix();

    /**
     * Collective. The matrix is complete.
     */
    void
    finish_matrix();

    const SplineSpace<dim> &
    space() const override
    {
      return spline_space;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override;

    const VectorType &
    diagonal() const override
    {
      return all_diagonal;
    }

    const std::vector<unsigned int> &
    inactive() const override
    {
      return inactive_functions;
    }

    void
    distribute(VectorType &x, const unsigned int component = 0) const override
    {
      matrix.unknowns().distribute(x, component);
    }

    void
    condense(VectorType &x, const unsigned int component = 0) const override
    {
      matrix.unknowns().condense(x, component);
    }

    std::unique_ptr<Preconditioner>
    factorization(const double shift, const bool by_components) const override;

    void
    apply_inverse_mass(VectorType &x) const override;

    std::unique_ptr<Preconditioner>
    petsc_preconditioner(const std::string &options) const override;

    std::unique_ptr<Preconditioner>
    lattice_preconditioner(const std::string &options) const override;

    const DensityWeights<dim> *
    transfer_weights() const override
    {
      return &weights;
    }

  private:
    /**
     * Collective. Factors of a matrix with the unknowns of this level.
     */
    void
    factorize(const LowerTriangle &entries,
              const double         shift,
              PartitionedCholesky &factors) const;

    /// dst = the solution with factors, for functions that are unknowns.
    void
    solve(const PartitionedCholesky &factors,
          VectorType                &dst,
          const VectorType          &src) const;

    /**
     * Collective. The matrix of the unknowns for PETSc.
     */
    PetscMatrix
    petsc_matrix() const;

    const SplineSpace<dim>                      &spline_space;
    Extension<dim>                               extension;
    DensityWeights<dim>                          weights; // volumes
    ExtendedMass<dim>                            matrix, volume;
    LowerTriangle                                entries;
    VectorType                                   all_diagonal;
    std::vector<unsigned int>                    inactive_functions;
    mutable std::unique_ptr<PartitionedCholesky> volume_factors;
    mutable VectorType                           source, result;
  };
} // namespace greville

#endif
