// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/overlapping_cholesky.h>
#include <greville/mass/extended_mass.h>
#include <greville/multigrid/extended_lattice.h>
#include <greville/multigrid/level_operator.h>

#include <functional>

namespace greville
{
  /**
   * Base class of levels of p-multigrid on extended B-splines: an operator E^T
   * B E with the Extension E of a space of one order, for fields with one or
   * more components. Coefficients can be constrained, component by component.
   * Rows and columns of constrained, inactive and extended coefficients are
   * zero except for the diagonal.
   *
   * The mass matrix of the space stores the unknowns and is used in the
   * transfer between orders.
   */
  template <int dim>
  class ExtendedLevel : public LevelOperator<dim>
  {
  public:
    /// Collective. The space is kept by reference. Bit c of @p constrained[f]
    /// constrains component c of local function f; an empty vector constrains
    /// nothing. The transfer uses weights at @p n_weights Gauss points per
    /// direction.
    ExtendedLevel(const SplineSpace<dim>           &space,
                  const unsigned int                n_components,
                  const std::vector<unsigned char> &constrained,
                  const unsigned int                n_weights);

    /// Return the mass with the extension of the space and its constraints.
    const ExtendedMass<dim> &
    extended() const
    {
      return extended_mass;
    }

    const Extension<dim> &
    extension() const
    {
      return spline_extension;
    }

    /// Return the constrained components (bits) of local functions.
    const std::vector<unsigned char> &
    constrained_components() const
    {
      return constrained;
    }

    const SplineSpace<dim> &
    space() const override
    {
      return spline_space;
    }

    unsigned int
    n_components() const override
    {
      return components;
    }

    const VectorType &
    diagonal() const override
    {
      return all_diagonal;
    }

    /// Return the largest diagonal entry on all processes.
    double
    largest_diagonal() const
    {
      return largest;
    }

    const std::vector<unsigned int> &
    inactive() const override
    {
      return inactive_functions;
    }

    void
    distribute(VectorType &x, const unsigned int component = 0) const override
    {
      extended_mass.unknowns().distribute(x, component);
    }

    void
    condense(VectorType &x, const unsigned int component = 0) const override
    {
      extended_mass.unknowns().condense(x, component);
    }

    std::unique_ptr<Preconditioner>
    factorization(const CholeskyParameters &parameters,
                  const bool                by_components) const override;

    void
    apply_inverse_mass(VectorType &x) const override;

    std::unique_ptr<Preconditioner>
    petsc_preconditioner(const std::string &options) const override;

    std::unique_ptr<Preconditioner>
    lattice_preconditioner(
      const LatticeCycleParameters &parameters) const override;

    /// Return A as the finest level of a LatticeCycle, which refers to this
    /// object.
    virtual std::unique_ptr<ExtendedLattice<dim>>
    make_lattice() const = 0;

    /// See LatticeLevel.
    std::vector<UpperTriangle>
    diagonal_blocks(const bool by_components) const;

    /// Collective. Factorize the mean of the diagonal blocks of all components,
    /// or each block.
    std::vector<OverlappingCholesky>
    factorize(const CholeskyParameters &parameters,
              const bool                by_components) const;

    const DensityWeights<dim> *
    transfer_weights() const override
    {
      return &mass_weights;
    }

  protected:
    /// Collective. Begin with points at new positions. Their @p filling is kept
    /// by reference; @p changed says whether it differs from the last call. The
    /// mass and its weights must then be filled.
    void
    begin_level(const CellFilling<dim> &filling, const bool changed);

    /// Collective. Compute the diagonal from the contributions of the unknowns
    /// of this process, in the layout of result.
    void
    set_diagonal();

    /// Collective. Compute dst = A src with a @p product(result, source) of
    /// vectors of unknowns.
    void
    multiply_unknowns(VectorType                  &dst,
                      const VectorType            &src,
                      const std::function<void()> &product) const;

    /// Return a scalar matrix with the unknowns of the mass, whose factors
    /// represent the given components (bits).
    virtual const ExtendedMass<dim> &
    diagonal_block(const unsigned int components) const = 0;

    const SplineSpace<dim>          &spline_space;
    const unsigned int               components;
    const std::vector<unsigned char> constrained;
    Extension<dim>                   spline_extension;
    DensityWeights<dim>              mass_weights;
    ExtendedMass<dim>                extended_mass;
    VectorType                       all_diagonal;
    mutable VectorType               source, result; // of unknowns

  private:
    /// Return the entries of this process that represent the components number
    /// c, or all components.
    UpperTriangle
    local_block(const unsigned int c, const bool by_components) const;

    /// Collective. Factorize a matrix with the unknowns of the mass.
    void
    factorize(const UpperTriangle      &matrix,
              const CholeskyParameters &parameters,
              OverlappingCholesky      &factors) const;

    const OverlappingCholesky &
    factors_of_mass() const;

    /// Solve for @p n components from the given one on; @p dst may be @p src.
    void
    solve(const OverlappingCholesky &factors,
          VectorType                &dst,
          const VectorType          &src,
          const unsigned int         component,
          const unsigned int         n) const;

    // The factors of the mass, made by the first apply_inverse_mass() after a
    // change.
    mutable std::unique_ptr<OverlappingCholesky> mass_factors;

    double                      largest = 0.;
    std::vector<unsigned int>   inactive_functions;
    mutable std::vector<double> work;
  };
} // namespace greville
