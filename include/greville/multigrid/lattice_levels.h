// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_lattice_levels_h
#define greville_multigrid_lattice_levels_h

#include <greville/base/petsc.h>
#include <greville/spline/spline_space.h>

#include <petscpc.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Geometric levels below a matrix of order 1, for PETSc's PCMG: the lattice
   * of functions is coarsened by two in each direction again and again, with
   * multilinear interpolation, which has all rigid body modes, and Galerkin
   * products. A level has the unknowns from which unknowns of the next finer
   * level are interpolated, so bodies may end anywhere in the lattice. Stencils
   * have the same size on all levels, so all coarse levels together have about
   * @f$ 1 / (2^\text{dim} - 1) @f$ of the entries of the matrix. A matrix of
   * few rows has no coarse levels: it is factorized.
   *
   * Unknowns are numbered and interpolated component by component: constrained
   * and inactive components have no coarse unknown.
   */
  template <int dim>
  class LatticeLevels
  {
  public:
    /**
     * Collective. @p matrix is symmetric; its row i * n_components + c on this
     * process belongs to component c of the local function functions[i]. If bit
     * c of constrained[i] is set, this row is constrained and contains the
     * diagonal only.
     */
    LatticeLevels(const Mat                         matrix,
                  const SplineSpace<dim>           &space,
                  const std::vector<unsigned int>  &functions,
                  const unsigned int                n_components,
                  const std::vector<unsigned char> &constrained);

    /**
     * Return options of PETSc for a preconditioner of the matrix: one that
     * apply_to() has set up, or a factorization if there are no levels.
     */
    std::string
    options() const;

    /**
     * Collective. Let @p pc, whose operator is the matrix, be PCMG on these
     * levels, if there are any.
     */
    void
    apply_to(PC pc) const;

  private:
    /// An unknown: one component of a function of a lattice.
    struct Unknown
    {
      MultiIndex<dim> position;
      unsigned int    component;
      bool            is_constrained;
    };

    /**
     * Collective. Return the interpolation from the next coarser lattice to the
     * owned @p unknowns, as a matrix of the PETSc @p type. On return, @p
     * unknowns and @p size describe the coarse lattice.
     */
    PetscMatrix
    coarsen(std::vector<Unknown>        &unknowns,
            MultiIndex<dim>             &size,
            const std::array<bool, dim> &periodic,
            const unsigned int           n_components,
            const MatType                type,
            const MPI_Comm               comm) const;

    std::vector<PetscMatrix> interpolations; // to the finest level first
    std::vector<PetscMatrix> matrices;       // without the finest one
  };
} // namespace greville

#endif
