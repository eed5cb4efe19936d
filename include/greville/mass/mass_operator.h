// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_mass_operator_h
#define greville_mass_mass_operator_h

#include <greville/mass/density_weights.h>

#include <memory>

namespace greville
{
  /**
   * The cross matrix P_ij = sum_q w_q N_i^rows(x_q) N_j^columns(x_q) of two
   * orders on one mesh, applied without being stored: cell by cell, by sum
   * factorization (the coefficients of a cell are interpolated to the points
   * direction by direction, weighted, and integrated). Per cell it reads the
   * weights and costs 2 dim (p + 1)^(dim + 1) multiplications or fewer.
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
     * dst = P src. Vectors are made by SplineSpace::initialize_vector().
     */
    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      apply(*rows, *columns, dst, src);
    }

    /**
     * dst = P^T src.
     */
    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      apply(*columns, *rows, dst, src);
    }

    /**
     * dst_i = sum_q w_q N_i^rows(x_q): by the partition of unity, the row sums.
     */
    void
    row_sums(VectorType &dst) const
    {
      integrate(dst, dealii::Functions::ConstantFunction<dim>(1.));
    }

    /**
     * dst_i = sum_q w_q N_i^rows(x_q)^2: the diagonal, for equal spaces.
     */
    void
    diagonal(VectorType &dst) const;

    /**
     * dst_i = sum_q w_q f(x_q) N_i^rows(x_q) for a function @p f.
     */
    void
    integrate(VectorType &dst, const dealii::Function<dim> &f) const;

    /**
     * The square roots of sum_q w_q (u(x_q) - f(x_q))^2 and sum_q w_q f(x_q)^2
     * for the spline u of the rows' space with @p coefficients.
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
   * The consistent mass matrix M_ij = sum_q w_q N_i(x_q) N_j(x_q), matrix-free
   * (see CrossMassOperator). Coefficients whose functions meet no mass are
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
