// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_point_tangents_h
#define greville_points_point_tangents_h

#include <greville/mass/stencil_matrix.h>
#include <greville/points/trial_step.h>

#include <functional>
#include <vector>

namespace greville
{
  /**
   * The derivative of the internal force of a TrialStep, stored at the points:
   * @f[
   *   C_{iJkL} = V_n \frac{\partial P_{iJ}}{\partial f_{kL}}, \qquad
   *   (K u)_{ai} = \sum_p \partial_J N_a \, C_{iJkL} \, \partial_L u_k .
   * @f]
   * It is applied point by point, and cell matrices are computed from it, for
   * spaces of any order on the same mesh. Points are stored in groups of four,
   * cell by cell: position, and C as a matrix of pairs (iJ) and (kL). Symmetric
   * matrices are stored as their upper half, 45 numbers in 3D. Axisymmetric
   * points have a fifth pair for f_zz = 1 + u_r / r, which multiplies N in
   * place of a derivative: C contains the factor 1 / r for it.
   *
   * Cell matrices serve preconditioners, which need to be symmetric positive
   * semidefinite. If C is not symmetric, the symmetric part can be indefinite:
   * without dilatancy, flow makes it so. Cell matrices therefore contain the
   * factor H = (C^T C)^(1/2) of the polar decomposition C = Q H, which has the
   * null space of C (the direction of plastic flow), and is C if C is symmetric
   * positive semidefinite.
   */
  template <int dim>
  class PointTangents
  {
  public:
    /// Set the space of products, which is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Remove all points. The points added afterwards are all @p symmetric or
     * all stored in full, and all @p axisymmetric or none.
     */
    void
    clear(const bool symmetric, const bool axisymmetric);

    /// Reserve memory for exactly this number of groups of points.
    void
    reserve(const std::size_t n_groups);

    bool
    is_symmetric() const
    {
      return symmetric;
    }

    /**
     * Add points of an owned cell with their derivatives.
     */
    void
    add(const unsigned int cell, const std::vector<TrialPoint<dim>> &points);

    /**
     * Compute y += K x for vectors on the places of a matrix on the space, with
     * dim components each.
     */
    void
    add_product(double                   *y,
                const double             *x,
                const StencilMatrix<dim> &stencil) const;

    /**
     * A function called by for_each_cell() with a cell's matrix, in the layout
     * of BlockStencil::add_cell().
     */
    template <typename Number>
    using CellAction = std::function<void(const unsigned int cell,
                                          const Number      *values,
                                          const unsigned int stride)>;

    /**
     * Call @p action for all cells, some of them several times, with a matrix
     * on the space of the @p tables, in double or single precision.
     */
    template <typename Number>
    void
    for_each_cell(const SpacePolynomials<dim> &tables,
                  const CellAction<Number>    &action) const;

  private:
    struct CellPoints
    {
      unsigned int cell;
      unsigned int n_points;
      std::size_t  first; // number
    };

    unsigned int
    n_numbers() const
    {
      const unsigned int n = dim * dim + (axisymmetric ? 1 : 0);
      return dim + (symmetric ? n * (n + 1) / 2 : n * n);
    }

    template <int n, bool with_hoop>
    void
    multiply(double                   *y,
             const double             *x,
             const StencilMatrix<dim> &stencil) const;

    SpacePolynomials<dim>   tables;
    bool                    symmetric = true, axisymmetric = false;
    std::vector<CellPoints> cells;
    std::vector<double>     numbers; // [cell][group][number][lane]
  };
} // namespace greville

#endif
