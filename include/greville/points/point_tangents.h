// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/aligned_vector.h>

#include <greville/mass/stencil_matrix.h>
#include <greville/materials/lanes.h>
#include <greville/points/point_transfer.h>

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
   * It is applied point by point. Cell matrices are computed from it, for
   * spaces of any order on the same mesh. Points are stored in groups of four,
   * cell by cell: position, and C as a matrix of pairs (iJ) and (kL). Symmetric
   * matrices are stored as their upper half, 45 numbers in 3D. Axisymmetric
   * points have a fifth pair for f_zz = 1 + u_r / r. It multiplies N instead of
   * a derivative, and C contains its factor 1 / r.
   *
   * Cell matrices are used in preconditioners, which must be symmetric positive
   * semidefinite. If C is not symmetric, its symmetric part can be indefinite,
   * for instance in plastic flow without dilatancy. Cell matrices therefore
   * contain the factor H = (C^T C)^(1/2) of the polar decomposition C = Q H. It
   * has the null space of C (the direction of plastic flow), and equals C if C
   * is symmetric positive semidefinite.
   */
  template <int dim>
  class PointTangents
  {
  public:
    /// Set the space of products, which is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// Remove all points. The points added afterwards are all @p symmetric or
    /// all stored in full, and all @p axisymmetric or none.
    void
    clear(const bool symmetric, const bool axisymmetric);

    /// Reserve memory for the groups that are added afterwards, of one cell if
    /// points are not kept.
    void
    reserve(const std::size_t n_groups);

    bool
    is_symmetric() const
    {
      return symmetric;
    }

    /// Return the number of pairs (iJ), with the pair of f_zz.
    int
    n_pairs() const
    {
      return dim * dim + (axisymmetric ? 1 : 0);
    }

    /// Return the number of doubles of a group of points.
    std::size_t
    group_size() const
    {
      const unsigned int n = n_pairs();
      return (dim + (symmetric ? n * (n + 1) / 2 : n * n)) * n_lanes;
    }

    /// Add the points of an owned cell. Returns the numbers of its first group,
    /// [number][lane], which the caller must set to x and C. Empty lanes have
    /// zero C and a position in the cell.
    double *
    add_cell(const unsigned int cell, const unsigned int n_points);

    /// End the last add_cell(): its numbers are set.
    void
    finish_cell();

    /// Compute T = C H for the pairs of a group with this @p C.
    void
    multiply(const double *C, const Lanes *H, Lanes *T) const;

    /// Compute y += K x for vectors of dim components on the StencilPlaces of
    /// @p stencil.
    void
    add_product(double                   *y,
                const double             *x,
                const StencilMatrix<dim> &stencil) const;

    /// A function called by for_each_cell() with a cell's matrix, in the layout
    /// of BlockStencil::add_cell().
    template <typename Number>
    using CellAction = std::function<void(const unsigned int cell,
                                          const Number      *values,
                                          const unsigned int stride)>;

    /// Call @p action for all cells, for some of them several times, with a
    /// matrix on the space of the @p tables, in double or single precision. The
    /// matrices of one cell add up.
    template <typename Number>
    void
    for_each_cell(const SpacePolynomials<dim> &tables,
                  const CellAction<Number>    &action) const;

    /// From now on until clear(), call @p action as in for_each_cell() at the
    /// end of each cell, while its numbers are in the cache. Afterwards its
    /// points are removed unless @p keep.
    void
    sum_at_once(const CellAction<double> &action, const bool keep);

  private:
    struct CellPoints
    {
      unsigned int cell;
      unsigned int n_points;
      std::size_t  first; // number
    };

    /// Return a function that passes the matrix of a cell to @p action.
    template <typename Number>
    std::function<void(const CellPoints &)>
    cell_sums(const SpacePolynomials<dim> &tables,
              const CellAction<Number>    &action) const;

    template <int n, bool with_hoop>
    void
    add_product_of_order(double                   *y,
                         const double             *x,
                         const StencilMatrix<dim> &stencil) const;

    SpacePolynomials<dim>   tables;
    bool                    symmetric = true, axisymmetric = false;
    std::vector<CellPoints> cells;
    std::size_t             n_used = 0;
    // Empty without sum_at_once().
    std::function<void(const CellPoints &)> sum_cell;
    bool                                    keeps_points = true;
    // [cell][group][number][lane]
    dealii::AlignedVector<double> numbers;
  };
} // namespace greville
