// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_stiffness_tangent_level_h
#define greville_stiffness_tangent_level_h

#include <greville/linear_algebra/partitioned_cholesky.h>
#include <greville/mass/extended_mass.h>
#include <greville/multigrid/level_operator.h>
#include <greville/stiffness/block_stencil.h>

#include <functional>

namespace greville
{
  /**
   * The tangent of an implicit step on the space of one order,
   * @f[ A = E^T (c \tilde M + K) E, @f]
   * for vector fields of dim components, with the stiffness K of the points,
   * their mass M~ (see ExtendedMass), a factor c (1/s^2) and the Extension E of
   * the space. Coefficients can be held, component by component: rows and
   * columns of A are then zero but for the diagonal, as are those of functions
   * that are inactive or extended.
   *
   * The level has the entries of the symmetric part in single precision, for
   * smoothers, cycles and factorizations. The products of vmult() are those of
   * set_product() where there is one.
   */
  template <int dim>
  class TangentLevel : public LevelOperator<dim>
  {
  public:
    /**
     * Collective. The space is kept by reference. Bit c of @p held[f] holds
     * component c of local function f; an empty one holds nothing.
     */
    TangentLevel(const SplineSpace<dim>           &space,
                 const std::vector<unsigned char> &held = {});

    /**
     * Collective. The filling, which is kept by reference, is that of points at
     * new places; @p changed tells whether it differs from that of the last
     * call. Then mass() is to be filled, and finish_mass() to be called.
     */
    void
    begin(const CellFilling<dim> &filling, const bool changed);

    StencilMatrix<dim> &
    mass()
    {
      return extended_mass.matrix();
    }

    /**
     * Weights of the transfer to lower orders.
     */
    DensityWeights<dim> &
    weights()
    {
      return mass_weights;
    }

    /**
     * Collective. @p lump keeps the row sums of the mass only.
     */
    void
    finish_mass(const bool lump);

    /**
     * Collective. Set the tangent to zero; stiffness() is to be filled.
     */
    void
    begin_tangent();

    BlockStencil<dim, float> &
    stiffness()
    {
      return blocks;
    }

    /**
     * Collective. Add @p mass_factor (1/s^2) times the mass; the tangent is
     * complete.
     */
    void
    finish_tangent(const double mass_factor);

    /**
     * The mass with the extension of the space, and what is held.
     */
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

    /**
     * The components (bits) that are held of local functions.
     */
    const std::vector<unsigned char> &
    held_components() const
    {
      return held;
    }

    const SplineSpace<dim> &
    space() const override
    {
      return spline_space;
    }

    unsigned int
    n_components() const override
    {
      return dim;
    }

    /**
     * Let vmult() be E^T B E in double precision with the products y = B x of
     * vectors on the places of mass().
     */
    void
    set_product(const std::function<void(double *y, const double *x)> &product)
    {
      exact_product = product;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      if (exact_product)
        multiply(dst, src, exact_product);
      else
        vmult_in_cycle(dst, src);
    }

    void
    vmult_in_cycle(VectorType &dst, const VectorType &src) const override
    {
      multiply(dst, src, [&](double *y, const double *x) {
        blocks.vmult(y, x);
      });
    }

    /**
     * y = M~_e x.
     */
    void
    multiply_mass(VectorType &dst, const VectorType &src) const;

    const VectorType &
    diagonal() const override
    {
      return all_diagonal;
    }

    /**
     * The largest entry of the diagonal of all processes.
     */
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
      return &mass_weights;
    }

  private:
    /**
     * Collective. A for PETSc.
     */
    PetscMatrix
    petsc_matrix() const;

    void
    multiply(
      VectorType                                            &dst,
      const VectorType                                      &src,
      const std::function<void(double *y, const double *x)> &product) const;

    /**
     * A solve for @p n_components from the given one on; @p dst may be @p src.
     */
    void
    solve(const PartitionedCholesky &factors,
          VectorType                &dst,
          const VectorType          &src,
          const unsigned int         component    = 0,
          const unsigned int         n_components = dim) const;

    /**
     * Collective. Factorize a matrix that stands for @p components (bits).
     */
    void
    factorize(const ExtendedMass<dim> &matrix,
              const double             shift,
              const unsigned int       components,
              PartitionedCholesky     &factors) const;

    const SplineSpace<dim>                       &spline_space;
    const std::vector<unsigned char>              held;
    Extension<dim>                                spline_extension;
    DensityWeights<dim>                           mass_weights;
    ExtendedMass<dim>                             extended_mass;
    BlockStencil<dim, float>                      blocks;
    std::function<void(double *, const double *)> exact_product;

    // A diagonal block of A or their mean, with the unknowns of the mass.
    mutable ExtendedMass<dim> block;
    // Made by the first call of apply_inverse_mass() for a mass.
    mutable std::unique_ptr<PartitionedCholesky> mass_factors;

    double                      largest = 0.;
    VectorType                  all_diagonal;
    std::vector<unsigned int>   inactive_functions;
    mutable VectorType          source, result;
    mutable std::vector<double> work;
  };
} // namespace greville

#endif
