// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_lattice_cycle_h
#define greville_multigrid_lattice_cycle_h

#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/extended_level.h>
#include <greville/multigrid/lattice_matrix.h>
#include <greville/multigrid/smoother.h>

namespace greville
{
  /**
   * A V-cycle on lattices that are coarsened by two in each direction at the
   * same order of the splines, down to a matrix that is factorized on each
   * process. Vectors and matrices have single precision. The smoother is a
   * Chebyshev polynomial over IC(0) of the mean diagonal block, or of each
   * block.
   */
  template <int dim>
  class LatticeCycle : public Preconditioner
  {
  public:
    /// Collective. The @p finest level is kept by reference.
    LatticeCycle(const ExtendedLevel<dim> &finest,
                 const SmootherParameters &parameters,
                 const bool                by_components);

    /// Apply one cycle with the initial guess zero.
    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    struct Level
    {
      const LatticeLevel<dim>         *matrix;
      std::vector<OverlappingCholesky> factors;
      std::vector<unsigned char>       constrained; // owned unknowns, if any
      double                           largest_eigenvalue = 1.;
      mutable SingleVector             x, b, step, product;
    };

    const LatticeLevel<dim> &
    matrix(const unsigned int l) const
    {
      return *levels[l].matrix;
    }

    /// Collective. Factorize all but the last level.
    void
    make_smoother(Level &level, const bool by_components);

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

    void
    factorize_coarsest();

    void
    solve_coarsest(const Level &level) const;

    const ExtendedLevel<dim>                        &finest;
    const SmootherParameters                         parameters;
    std::vector<std::unique_ptr<LatticeMatrix<dim>>> coarse;
    std::vector<Level>                               levels;     // finest first
    std::vector<double>                              factors;    // of the last
    unsigned int                                     n_last = 0; // rows
    mutable std::vector<double>                      right_hand_side;
    mutable std::vector<float>                       work;
  };
} // namespace greville

#endif
