// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/extended_level.h>
#include <greville/stiffness/block_stencil.h>

namespace greville
{
  /**
   * The tangent of an implicit step on the space of one order,
   * @f[ A = E^T (c \tilde M + K) E, @f]
   * for vector fields of dim components. K is the stiffness of the points, M~
   * their mass (see ExtendedMass), c a factor (1/s^2), and E the Extension of
   * the space.
   *
   * The level stores symmetric entries (see PointTangents) in single precision,
   * for smoothers, cycles and factorizations. vmult() uses the product given by
   * set_product(), if any.
   */
  template <int dim>
  class TangentLevel : public ExtendedLevel<dim>
  {
  public:
    /// Collective. See ExtendedLevel. Without @p has_transfer to other
    /// orders there are no weights.
    TangentLevel(const SplineSpace<dim>           &space,
                 const std::vector<unsigned char> &constrained  = {},
                 const bool                        has_transfer = true);

    /// Collective. See ExtendedLevel::begin_level(). Afterwards, fill mass()
    /// and call finish_mass().
    void
    begin(const CellFilling<dim> &filling, const bool changed);

    using ExtendedLevel<dim>::extended;
    ExtendedMass<dim> &
    extended()
    {
      return this->extended_mass;
    }

    StencilMatrix<dim> &
    mass()
    {
      return this->extended_mass.matrix();
    }

    /// Return the weights of the transfer to lower orders.
    DensityWeights<dim> &
    weights()
    {
      return this->mass_weights;
    }

    /// Collective. With @p lump, the mass is replaced by its row sums.
    void
    finish_mass(const bool lump);

    /// Collective. Set the tangent to zero; stiffness() must then be filled.
    void
    begin_tangent();

    BlockStencil<dim, float> &
    stiffness()
    {
      return blocks;
    }

    /// Collective. Add @p mass_factor (1/s^2) times the mass, which completes
    /// the tangent.
    void
    finish_tangent(const double mass_factor);

    /// Let vmult() compute E^T B E in double precision with the products y = B
    /// x of vectors on the places of mass().
    void
    set_product(const std::function<void(double *y, const double *x)> &product)
    {
      exact_product = product;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      if (exact_product)
        multiply_at_places(dst, src, exact_product);
      else
        vmult_in_cycle(dst, src);
    }

    void
    vmult_in_cycle(VectorType &dst, const VectorType &src) const override
    {
      multiply_at_places(dst, src, [&](double *y, const double *x) {
        blocks.vmult(y, x);
      });
    }

    /// Compute dst = A src for vectors of unknowns, see
    /// ExtendedUnknowns::initialize_vector().
    void
    multiply_of_unknowns(VectorType &dst, const VectorType &src) const;

    std::unique_ptr<ExtendedLattice<dim>>
    make_lattice() const override;

  private:
    const ExtendedMass<dim> &
    diagonal_block(const unsigned int components) const override;

    void
    multiply_at_places(
      VectorType                                            &dst,
      const VectorType                                      &src,
      const std::function<void(double *y, const double *x)> &product) const;

    BlockStencil<dim, float>                      blocks;
    std::function<void(double *, const double *)> exact_product;

    // A diagonal block of A or the mean of the blocks, with the unknowns of the
    // mass.
    mutable ExtendedMass<dim> block;
  };
} // namespace greville
