// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/multigrid/mg_base.h>

#include <greville/base/parameters.h>
#include <greville/mass/mass_operator.h>
#include <greville/multigrid/level_operator.h>

#include <functional>
#include <string>

namespace greville
{
  /// A function that makes an approximate inverse of a level's mass matrix, to
  /// be applied in place. The mass has the weight of the level, or 1 if
  /// @p unit_weight.
  template <int dim>
  using MakeInverseMass = std::function<std::unique_ptr<Preconditioner>(
    const LevelOperator<dim> &level, const bool unit_weight)>;

  /// Add a name to the lists of OrderTransfer, for both dimensions, before
  /// parameters are read.
  template <int dim>
  void
  add_inverse_mass(const std::string &name, const MakeInverseMass<dim> &make);



  /// The weight of the L2 products of a transfer.
  enum class TransferWeight
  {
    density, // LevelOperator::transfer_weights()
    unit
  };

  inline const Choices<TransferWeight> transfer_weights = {
    {TransferWeight::density, "density"}, {TransferWeight::unit, "unit"}};



  /**
   * Transfer between consecutive orders k > l on one mesh, in the form of
   * deal.II's transfer classes (level 0 is the coarsest). With the cross matrix
   * @f[ P_{ij} = \int w \, N_i^k N_j^l \, dx, @f]
   * applied matrix-free, the prolongation is
   * - "lumped-l2": @f$ D_k^{-1} P @f$, with the row sums
   *   @f$ D_k = \text{diag}(P 1) @f$
   *   (@ref Tielen2019 "Tielen, Moeller and Vuik, 2019"),
   * - "ic0-l2": @f$ M_k^{-1} E_k^T P @f$ with IC(0) in place of the inverse
   *   (LevelOperator::apply_inverse_mass()),
   * - @f$ M_k^{-1} P @f$ with another approximation of the inverse, a name of
   *   add_inverse_mass().
   *
   * The restriction is
   * - "lumped-l2": @f$ D_l^{-1} P^T @f$ with
   *   @f$ D_l = \text{diag}(P^T 1) @f$, as in the paper,
   * - @f$ M_l^{-1} P^T @f$ with a name of add_inverse_mass(),
   * - "transpose": the transpose of the prolongation, which makes a cycle with
   *   a symmetric smoother symmetric.
   *
   * The weight w is a TransferWeight. Inactive coefficients do not take part.
   * All components of an operator have the same transfer.
   *
   * With extended B-splines, P acts on all coefficients of a spline. The matrix
   * @f$ E_l @f$ of LevelOperator::distribute() computes them. The coefficients
   * of extended functions are dropped from the result of P. The prolongation is
   * then @f$ D_k^{-1} P E_l @f$, its transpose @f$ E_l^T P^T D_k^{-1} @f$, and
   * the restriction @f$ D_l^{-1} P^T E_k @f$. Constants are therefore
   * preserved.
   */
  template <int dim>
  class OrderTransfer : public dealii::MGTransferBase<VectorType>
  {
  public:
    static std::string
    prolongations();

    static std::string
    restrictions();

    /// Collective. @p levels are kept by reference.
    OrderTransfer(const std::vector<const LevelOperator<dim> *> &levels,
                  const std::string                             &prolongation,
                  const std::string                             &restriction,
                  const TransferWeight                           weight);

    /// Return whether the restriction is the transpose of the prolongation.
    bool
    is_symmetric() const
    {
      return restriction == Kind::transpose;
    }

    void
    prolongate(const unsigned int to_level,
               VectorType        &dst,
               const VectorType  &src) const override;

    void
    prolongate_and_add(const unsigned int to_level,
                       VectorType        &dst,
                       const VectorType  &src) const override
    {
      VectorType &correction = steps[to_level - 1].fine_sum;
      prolongate(to_level, correction, src);
      dst += correction;
    }

    void
    restrict_and_add(const unsigned int from_level,
                     VectorType        &dst,
                     const VectorType  &src) const override;

  private:
    void
    prolongate_component(const unsigned int to_level,
                         VectorType        &dst,
                         const VectorType  &src,
                         const unsigned int component) const;

    void
    restrict_component(const unsigned int from_level,
                       VectorType        &dst,
                       const VectorType  &src,
                       const unsigned int component) const;

    /// The transfer between a level and the next coarser one.
    struct Step
    {
      const LevelOperator<dim>            *fine_level;
      const LevelOperator<dim>            *coarse_level;
      std::unique_ptr<DensityWeights<dim>> unit_weights;
      CrossMassOperator<dim>               cross;
      VectorType                           inverse_row_sums;
      VectorType                           inverse_column_sums;
      mutable VectorType fine, coarse; // vectors of one component
      mutable VectorType from_fine, from_coarse;
      mutable VectorType fine_sum, coarse_sum; // vectors of all components
    };

    enum class Kind
    {
      lumped,
      ic0,       // prolongation
      transpose, // restriction
      inverse    // of add_inverse_mass()
    };

    static Kind
    kind_of(const std::string &name);

    std::vector<Step> steps; // [level - 1]
    Kind              prolongation, restriction;

    // Approximate inverses of add_inverse_mass(), on the levels that use them.
    std::vector<std::unique_ptr<Preconditioner>> inverses;
  };
} // namespace greville
