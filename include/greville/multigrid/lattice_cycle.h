// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/lapack_full_matrix.h>

#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/extended_lattice.h>
#include <greville/multigrid/lattice_matrix.h>

namespace greville
{
  struct LatticeCycleParameters
  {
    double       shift = 0.; // of the factors, see SmootherParameters
    unsigned int chebyshev_degree = 3;
    double       chebyshev_range  = 8.;
    bool         by_components    = false; // a factor for each component
    bool         lowers_order     = false; // to 1 on the coarsest lattice
  };



  /**
   * A V-cycle on lattices that are coarsened by two in each direction at the
   * same order of the splines, with Galerkin products. Vectors and matrices
   * have single precision. The smoother is a Chebyshev polynomial over IC(0) of
   * the mean diagonal block, or of each block.
   *
   * The last level is a matrix of few rows, which is factorized: that of the
   * coarsest lattice, or if @p lowers_order, a matrix of order 1 on the
   * coarsest lattice. A function of order 1 is then interpolated by a spline
   * whose coefficients are its values at the Greville points, which has all
   * linear functions.
   */
  template <int dim>
  class LatticeCycle : public Preconditioner
  {
  public:
    /// Collective.
    LatticeCycle(std::unique_ptr<ExtendedLattice<dim>> finest,
                 const LatticeCycleParameters         &parameters);

    /// Apply one cycle with the initial guess zero, to vectors with
    /// coefficients of all functions.
    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    struct Level
    {
      const LatticeLevel<dim>         *matrix;
      std::vector<OverlappingCholesky> factors;     // none: solved directly
      std::vector<unsigned char>       constrained; // owned unknowns, if any
      double                           largest_eigenvalue = 1.;
      mutable SingleVector             x, b, step, product;
    };

    /// Collective. Make the lattices.
    void
    coarsen();

    /// Collective. Factorize the matrix of a level.
    void
    make_smoother(Level &level);

    /// Collective. Compute an upper bound of the eigenvalues of the
    /// preconditioned matrix, as a rule.
    void
    estimate_eigenvalue(Level &level) const;

    /// Compute dst = B^-1 src with the factors B.
    void
    precondition(const Level        &level,
                 SingleVector       &dst,
                 const SingleVector &src) const;

    /// Subtract A times a vector from b.
    void
    subtract_product(const Level &level, SingleVector &x) const;

    /// Add the smoother's correction for the residual b to x; b keeps the
    /// residual but for the last step.
    void
    smooth(const Level &level) const;

    void
    cycle(const unsigned int l) const;

    /// Collective. Let the rows be components of the last lattice, or of its
    /// functions of order 1.
    void
    make_direct_matrix();

    void
    factorize_direct_matrix(std::vector<double> entries);

    /// Add the direct solution for b to x, vectors of the last lattice.
    void
    add_direct_solution(SingleVector &x, const SingleVector &b) const;

    const std::unique_ptr<ExtendedLattice<dim>>      finest;
    const LatticeCycleParameters                     parameters;
    std::vector<std::unique_ptr<LatticeMatrix<dim>>> coarse;
    std::vector<Level>                               levels; // finest first
    mutable std::vector<float>                       work;

    // The factorized matrix, and by row of the last lattice its columns and
    // their weights.
    dealii::LAPACKFullMatrix<double>             direct_matrix;
    std::vector<std::size_t>                     direct_begin;
    std::vector<std::pair<unsigned int, double>> direct_columns;
    mutable dealii::Vector<double>               direct_values;
  };
} // namespace greville
