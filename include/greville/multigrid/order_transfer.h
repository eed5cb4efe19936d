// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_order_transfer_h
#define greville_multigrid_order_transfer_h

#include <deal.II/multigrid/mg_base.h>

#include <greville/mass/mass_operator.h>
#include <greville/multigrid/level_operator.h>
#include <greville/multigrid/tensor_product_solver.h>

#include <string>

namespace greville
{
  /**
   * Transfer between consecutive orders k > l on one mesh, in the form of
   * deal.II's transfer classes (level 0 is the coarsest). With the cross matrix
   * P_ij = int w phi_i^k phi_j^l, applied matrix-free:
   * - prolongation "lumped-l2": D_k^-1 P, with the row sums D_k = diag(P 1)
   *   (R. Tielen, M. Moeller, C. Vuik, 2019);
   *   "exact-l2": M_k^-1 P with the tensor-product inverse, exact for a
   *   constant weight (see TensorProductPreconditioner for others).
   *   "ic0-l2": M_k^-1 E_k^T P with IC(0) in place of the inverse
   *   (LevelOperator::apply_inverse_mass()).
   * - restriction "lumped-l2": D_l^-1 P^T with D_l = diag(P^T 1), the paper's;
   *   "exact-l2": M_l^-1 P^T; "transpose": the transpose of the prolongation,
   *   which makes a cycle with a symmetric smoother symmetric.
   * The weight w is the density of LevelOperator::transfer_weights()
   * ("density") or 1 ("unit"). Inactive coefficients neither give nor take.
   * Operators of several components have the same transfer for each.
   *
   * With extended B-splines, P acts on all coefficients of a spline, E_l e with
   * the matrix E_l of LevelOperator::distribute(), and what it gives to
   * coefficients that are not extended is taken: prolongation D_k^-1 P E_l, the
   * transpose E_l^T P^T D_k^-1, restriction D_l^-1 P^T E_k. So constants stay
   * constants.
   */
  template <int dim>
  class OrderTransfer : public dealii::MGTransferBase<VectorType>
  {
  public:
    static std::string
    prolongations()
    {
      return "lumped-l2|exact-l2|ic0-l2";
    }

    static std::string
    restrictions()
    {
      return "lumped-l2|exact-l2|transpose";
    }

    static std::string
    weightings()
    {
      return "density|unit";
    }

    /**
     * Collective. @p levels are kept by reference.
     */
    OrderTransfer(const std::vector<const LevelOperator<dim> *> &levels,
                  const std::string                             &prolongation,
                  const std::string                             &restriction,
                  const std::string                             &weighting);

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

    /**
     * Between a level and the next coarser one.
     */
    struct Step
    {
      const LevelOperator<dim>            *fine_level;
      const LevelOperator<dim>            *coarse_level;
      std::unique_ptr<DensityWeights<dim>> unit_weights;
      CrossMassOperator<dim>               cross;
      VectorType                           inverse_row_sums;
      VectorType                           inverse_column_sums;
      mutable VectorType                   fine, coarse; // one component
      mutable VectorType                   from_fine, from_coarse;
      mutable VectorType                   fine_sum, coarse_sum; // all of them
    };

    std::vector<Step> steps; // [level - 1]
    std::string       prolongation, restriction;

    // On the levels where it is used.
    std::vector<std::unique_ptr<TensorProductPreconditioner<dim>>> inverses;
  };
} // namespace greville

#endif
