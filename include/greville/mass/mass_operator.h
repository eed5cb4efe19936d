// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_mass_operator_h
#define greville_mass_mass_operator_h

#include <greville/mass/density_weights.h>

#include <memory>

namespace greville
{
  /**
   * The cross matrix
   * @f[
   *   P_{ij} = \sum_q w_q N_i^\text{rows}(x_q) N_j^\text{columns}(x_q)
   * @f]
   * of two orders on one mesh, applied without being stored: cell by cell, by
   * sum factorization (the coefficients of a cell are interpolated to the
   * points direction by direction, weighted, and integrated). Per cell it reads
   * the weights and costs @f$ 2 \, \text{dim} \, (p + 1)^{\text{dim} + 1} @f$
   * multiplications or fewer.
   */
  template <int dim>
  class CrossMassOperator
  {
  public:
    CrossMassOperator() = default;

    /**
     * The spaces and the weights are kept by reference.
     */
    CrossMassOperator(const SplineSpace<dim>    &rows,
                      const SplineSpace<dim>    &columns,
                      const DensityWeights<dim> &weights);

    /**
     * @p dst = P @p src. Vectors are made by SplineSpace::initialize_vector().
     */
    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      apply(*rows, *columns, dst, src);
    }

    /**
     * @p dst = @f$ P^T @f$ @p src.
     */
    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      apply(*columns, *rows, dst, src);
    }

    /**
     * @f$ \sum_q w_q N_i^\text{rows}(x_q) @f$: by the partition of unity, the
     * row sums.
     */
    void
    row_sums(VectorType &dst) const
    {
      integrate(dst, dealii::Functions::ConstantFunction<dim>(1.));
    }

    /**
     * @f$ \sum_q w_q N_i^\text{rows}(x_q)^2 @f$: the diagonal, for equal
     * spaces.
     */
    void
    diagonal(VectorType &dst) const;

    /**
     * @f$ \sum_q w_q f(x_q) N_i^\text{rows}(x_q) @f$ for a function @p f.
     */
    void
    integrate(VectorType &dst, const dealii::Function<dim> &f) const;

    /**
     * The square roots of @f$ \sum_q w_q (u(x_q) - f(x_q))^2 @f$ and
     * @f$ \sum_q w_q f(x_q)^2 @f$ for the spline u of the rows' space with
     * @p coefficients.
     */
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



  /**
   * The consistent mass matrix
   * @f$ M_{ij} = \sum_q w_q N_i(x_q) N_j(x_q) @f$, matrix-free (see
   * CrossMassOperator). Coefficients whose functions meet no mass are
   * *inactive*: their row and column would be zero; M has the largest diagonal
   * entry there, so that a right-hand side of zero gives zero.
   */
  template <int dim>
  class MassOperator
  {
  public:
    MassOperator() = default;

    /**
     * Collective. Space and weights are kept by reference.
     */
    MassOperator(const SplineSpace<dim>    &space,
                 const DensityWeights<dim> &weights);

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /**
     * M itself.
     */
    const CrossMassOperator<dim> &
    cross_mass() const
    {
      return cross;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const;

    /**
     * The diagonal, with that of inactive coefficients.
     */
    const VectorType &
    diagonal() const
    {
      return matrix_diagonal;
    }

    /**
     * Local numbers of the inactive coefficients of this process.
     */
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



  /**
   * Give @p diagonal the value of its largest entry where it is zero, up to the
   * round-off of weights of both signs. Returns this value and the local
   * numbers of those entries. Collective.
   */
  std::pair<double, std::vector<unsigned int>>
  fill_inactive(VectorType &diagonal);
} // namespace greville

#endif
