// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/function.h>

#include <greville/spline/cell_batches.h>

namespace greville
{
  /**
   * The point set of a mass matrix
   * @f[ M_{ij} = \sum_q w_q N_i(x_q) N_j(x_q): @f]
   * the tensor-product Gauss points of each cell with weights in units of mass.
   * Points and basis values are the same in every cell, so only the weights are
   * stored. They are computed from a density, or from material points of mass
   * @f$ m_p @f$,
   * @f[
   *   w_q = \rho(x_q) \, |J| \, w_q^\text{Gauss} \qquad \text{or} \qquad
   *   w_q = \sum_p m_p L_q(x_p),
   * @f]
   * with the Lagrange polynomials @f$ L_q @f$ of the Gauss points. Products
   * @f$ N_i N_j @f$ of order p have the degree 2 p in each direction. With 2 p
   * + 1 Gauss points per direction, these weights therefore give *exactly* the
   * matrix of the material points. Such weights can be negative.
   */
  template <int dim>
  class DensityWeights
  {
  public:
    DensityWeights() = default;

    /// Collective. Evaluate @p density at @p n_points_1d Gauss points per
    /// direction in the owned cells of @p space. Throws dealii::ExcMessage with
    /// the point and the value if the density is negative or not finite, and if
    /// it is zero everywhere.
    DensityWeights(const SplineSpace<dim>      &space,
                   const unsigned int           n_points_1d,
                   const dealii::Function<dim> &density);

    /// Set all weights to zero, to be filled through at_cell().
    DensityWeights(const SplineSpace<dim> &space,
                   const unsigned int      n_points_1d);

    /// Return the weights of owned cell number @p cell: the weight of point q
    /// is at q * CellBatches::width().
    double *
    at_cell(const unsigned int cell)
    {
      return values.data() + cell_begin[cell];
    }

    const double *
    at_cell(const unsigned int cell) const
    {
      return values.data() + cell_begin[cell];
    }

    void
    clear()
    {
      values.fill(0.);
    }

    unsigned int
    n_points_1d() const
    {
      return n_q;
    }

    unsigned int
    n_points() const
    {
      return dealii::Utilities::fixed_power<dim>(n_q);
    }

    using Batch = typename CellBatches<dim>::Batch;

    const std::vector<Batch> &
    batches() const
    {
      return cell_batches;
    }

    /// Return the weights of a batch, n_points() x CellBatches::width(), with
    /// points in lexicographic order. Lanes without a cell of their own have
    /// zero weights.
    const double *
    operator[](const std::size_t batch) const
    {
      return values.data() + batch * n_points() * CellBatches<dim>::width();
    }

    /// Return the points of a cell in the order of the weights.
    std::vector<dealii::Point<dim>>
    points(const CellBox<dim> &box) const;

  private:
    unsigned int                  n_q = 0;
    std::vector<std::size_t>      cell_begin;
    std::vector<Batch>            cell_batches;
    dealii::AlignedVector<double> values;
  };
} // namespace greville
