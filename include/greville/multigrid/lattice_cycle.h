// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/coarsest_solver.h>
#include <greville/multigrid/extended_lattice.h>

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
   * same order of the splines, with Galerkin products. A refined grid first
   * loses its levels of cells, one by one. The cycle has one or several
   * *parts*, which a LatticeCoupling can couple. Vectors and matrices have
   * single precision. The smoother is a Chebyshev polynomial over IC(0) of the
   * mean diagonal block, or of each block. Its unknowns are the unknowns of all
   * parts together, in domains of processes that overlap by a layer, or by two
   * on the finest lattice of order 3. Couplings within a process are included.
   * A part that has few functions and one level of cells, or cannot be
   * coarsened, stays the same while other parts become coarser.
   *
   * The last level is a CoarsestSolver.
   */
  template <int dim>
  class LatticeCycle : public Preconditioner
  {
  public:
    using Parts  = std::vector<std::unique_ptr<ExtendedLattice<dim>>>;
    using Blocks = std::vector<SingleVector>;

    /// Collective. The @p coupling of the parts, unless null, is kept by
    /// reference; coarser levels are added to it. Without @p coarsens, the
    /// cycle consists of smoothing steps only. Vectors have coefficients of all
    /// functions, or of the unknowns if @p of_unknowns.
    LatticeCycle(Parts                         parts,
                 const LatticeCycleParameters &parameters,
                 LatticeCoupling<dim>         *coupling    = nullptr,
                 const bool                    coarsens    = true,
                 const bool                    of_unknowns = false);

    /// The cycle of one part.
    LatticeCycle(std::unique_ptr<ExtendedLattice<dim>> finest,
                 const LatticeCycleParameters         &parameters);

    /// Apply one cycle with the initial guess zero.
    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      vmult({&dst}, {&src});
    }

    /// Apply one cycle to the vectors of all parts.
    void
    vmult(const std::vector<VectorType *>       &dst,
          const std::vector<const VectorType *> &src) const;

  private:
    /// A part of a level.
    struct Block
    {
      const LatticeLevel<dim>   *matrix;
      std::vector<unsigned char> constrained; // owned unknowns, if any
      /// The unknowns of the next level; null if they are the same.
      const LatticeUnknowns<dim> *coarser = nullptr;
    };

    struct Level
    {
      std::vector<Block> blocks;
      /// The factors for the unknowns of all parts, one part after another.
      std::vector<OverlappingCholesky> factors;
      bool                             is_smoothed        = true;
      double                           largest_eigenvalue = 1.;
      mutable Blocks                   x, b, step, product;

      /// Return the divisor of the matrices, the same for all parts.
      double
      unit() const
      {
        return blocks.front().matrix->unit();
      }
    };

    /// Collective. Make the lattices.
    void
    coarsen(const bool coarsens);

    /// Collective. Factorize the matrices of level l.
    void
    make_smoother(const unsigned int l);

    /// Collective. Estimate the largest eigenvalue of the preconditioned
    /// matrix, in most cases from above.
    void
    estimate_eigenvalue(const unsigned int l);

    /// Compute dst = B^-1 src with the factors B.
    void
    precondition(const Level &level, Blocks &dst, const Blocks &src) const;

    /// Compute y = A x on level l. A is not divided by the unit of the level.
    void
    multiply(const unsigned int l, Blocks &y, Blocks &x) const;

    /// Subtract A x from b on level l.
    void
    subtract_product(const unsigned int l, Blocks &x) const;

    /// Add the smoother's correction for the residual b to x. All steps except
    /// the last one update b.
    void
    smooth(const unsigned int l) const;

    void
    cycle(const unsigned int l) const;

    /// Add the correction of level l + 1 for the residual b to x.
    void
    add_coarse_correction(const unsigned int l) const;

    const Parts                  parts;
    const LatticeCycleParameters parameters;
    LatticeCoupling<dim> *const  coupling;
    const bool                   of_unknowns;
    double                       unit = 1.; // divisor of the finest matrices
    std::vector<std::unique_ptr<LatticeMatrix<dim>>> coarse;
    std::vector<Level>                               levels; // finest first
    CoarsestSolver<dim>                              coarsest;
    mutable std::vector<float>                       work;
  };
} // namespace greville
