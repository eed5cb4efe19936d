// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/mass/density_weights.h>

#include <memory>

namespace greville
{
  /**
   * The cross matrix
   * @f[
   *   P_{ij} = \sum_q w_q N_i^\text{rows}(x_q) N_j^\text{columns}(x_q)
   * @f]
   * of two orders on one mesh, applied matrix-free, cell by cell, by sum
   * factorization (the coefficients of a cell are interpolated to the points
   * direction by direction, weighted, and integrated). Per cell it reads the
   * weights and costs @f$ 2 \, \text{dim} \, (p + 1)^{\text{dim} + 1} @f$
   * multiplications or fewer.
   */
  template <int dim>
  class CrossMassOperator
  {
  public:
    CrossMassOperator() = default;

    /// The spaces and the weights are kept by reference.
    CrossMassOperator(const SplineSpace<dim>    &rows,
                      const SplineSpace<dim>    &columns,
                      const DensityWeights<dim> &weights);

    /// @p dst = P @p src. Vectors are made by SplineSpace::initialize_vector().
    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      apply(*rows, *columns, dst, src);
    }

    /// @p dst = @f$ P^T @f$ @p src.
    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      apply(*columns, *rows, dst, src);
    }

    /// Compute @f$ \sum_q w_q N_i^\text{rows}(x_q) @f$, the row sums by the
    /// partition of unity.
    void
    row_sums(VectorType &dst) const
    {
      integrate(dst, dealii::Functions::ConstantFunction<dim>(1.));
    }

    /// Compute @f$ \sum_q w_q N_i^\text{rows}(x_q)^2 @f$, the diagonal for
    /// equal spaces.
    void
    diagonal(VectorType &dst) const;

    /// Compute @f$ \sum_q w_q f(x_q) N_i^\text{rows}(x_q) @f$ for a function
    /// @p f.
    void
    integrate(VectorType &dst, const dealii::Function<dim> &f) const;

    /// Return the square roots of @f$ \sum_q w_q (u(x_q) - f(x_q))^2 @f$ and
    /// @f$ \sum_q w_q f(x_q)^2 @f$, where u is the spline of the rows' space
    /// with these @p coefficients.
    std::pair<double, double>
    difference(const VectorType            &coefficients,
               const dealii::Function<dim> &f) const;

  private:
    struct Side;

    void
    apply(const Side       &out,
          const Side       &in,
          VectorType       &dst,
          const VectorType &src) const;

    const DensityWeights<dim> *weights = nullptr;
    std::shared_ptr<Side>      rows, columns; // the same for equal spaces
  };



  /// The consistent mass matrix @f$ M_{ij} = \sum_q w_q N_i(x_q) N_j(x_q) @f$,
  /// matrix-free (see CrossMassOperator). Coefficients whose functions have no
  /// mass in their support are *inactive*: instead of a zero row and column, M
  /// has its largest diagonal entry there, so that a right-hand side of zero
  /// gives zero.
  template <int dim>
  class MassOperator
  {
  public:
    MassOperator() = default;

    /// Collective. Space and weights are kept by reference.
    MassOperator(const SplineSpace<dim>    &space,
                 const DensityWeights<dim> &weights);

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /// Return M itself.
    const CrossMassOperator<dim> &
    cross_mass() const
    {
      return cross;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const;

    /// Return the diagonal, including inactive coefficients.
    const VectorType &
    diagonal() const
    {
      return matrix_diagonal;
    }

    /// Return the local numbers of the inactive coefficients of this process.
    const std::vector<unsigned int> &
    inactive() const
    {
      return inactive_functions;
    }

  private:
    const SplineSpace<dim>   *spline_space = nullptr;
    CrossMassOperator<dim>    cross;
    VectorType                matrix_diagonal;
    double                    inactive_diagonal = 1.;
    std::vector<unsigned int> inactive_functions;
  };



  /// Collective. Replace entries of @p diagonal that are zero up to the
  /// round-off of weights of both signs by its largest entry. Returns this
  /// entry and the local numbers of the replaced entries.
  std::pair<double, std::vector<unsigned int>>
  fill_inactive(VectorType &diagonal);
} // namespace greville
