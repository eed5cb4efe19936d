// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_smoother_h
#define greville_multigrid_smoother_h

#include <deal.II/base/parameter_handler.h>

#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/level_operator.h>

#include <functional>
#include <memory>
#include <string>

namespace greville
{
  /**
   * Parameters of all smoothers; each reads its own.
   */
  struct SmootherParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /**
     * Those of smoothers that need no matrix of one component, see
     * LevelOperator::matrix().
     */
    void
    declare_for_operators(dealii::ParameterHandler &prm);

    /**
     * Throw dealii::ExcMessage where patterns cannot tell that a parameter is
     * wrong.
     */
    void
    check() const;

    // Incomplete factorizations and Schwarz methods
    double       drop_tolerance = 1e-12;
    double       fill_factor    = 1.;
    double       shift          = 0.;
    unsigned int reuse          = 10;
    unsigned int overlap        = 1;
    std::string  ordering       = "lexicographic";
    std::string  combination    = "automatic";

    // Point smoothers
    double       damping          = 1.;
    unsigned int chebyshev_degree = 4;
    double       chebyshev_range  = 20.;

    std::string petsc_options = "-pc_type bjacobi -sub_pc_type icc";
  };

  /**
   * The names of smoothers, separated by '|':
   * - "ilut": ILUT on overlapping domains, one per process,
   * - "ilu0", "ic0": ILU(0) and IC(0) of the diagonally scaled matrix,
   * likewise,
   * - "jacobi": @f$ \omega D^{-1} @f$ with @f$ \omega @f$ = damping /
   *   @f$ \lambda_\text{max}(D^{-1} A) @f$,
   * - "gauss-seidel": forward before and backward after the coarse correction
   *   of a symmetric cycle, "symmetric-gauss-seidel": forward and backward;
   *   both process by process (PETSc's SOR),
   * - "chebyshev": deal.II's polynomial smoother on @f$ D^{-1} A @f$,
   * - "chebyshev-ic0": the same on @f$ B^{-1} A @f$ with one IC(0)
   * factorization B for all components (LevelOperator::factorization(), or
   * "ic0"),
   * - "chebyshev-component-ic0": with one for each of them,
   * - "tensor-product": TensorProductPreconditioner,
   * - "petsc": the PETSc preconditioner that the options describe.
   * Those that work on LevelOperator::matrix() or on the space do so component
   * by component.
   */
  std::string
  smoother_names();

  /**
   * Makes a smoother, as make_smoother() does.
   */
  template <int dim>
  using MakeSmoother =
    std::function<std::unique_ptr<Preconditioner>(const SmootherParameters &,
                                                  const LevelOperator<dim> &,
                                                  const bool symmetric)>;

  /**
   * Add a smoother to the list, before parameters are read: it @p needs_matrix
   * if it works on LevelOperator::matrix(), and is applied @p by_components if
   * it knows vectors of one component only. Both dimensions have to have it.
   */
  template <int dim>
  void
  add_smoother(const std::string       &name,
               const bool               needs_matrix,
               const bool               by_components,
               const MakeSmoother<dim> &make);

  bool
  smoother_needs_matrix(const std::string &name);

  /**
   * Make a smoother for @p level, which is kept by reference. Collective.
   * @p symmetric asks for a symmetric one where the combination of Schwarz
   * domains is "automatic". Throws dealii::ExcMessage for an unknown name or
   * a factorization that fails.
   */
  template <int dim>
  std::unique_ptr<Preconditioner>
  make_smoother(const std::string        &name,
                const SmootherParameters &parameters,
                const LevelOperator<dim> &level,
                const bool                symmetric);
} // namespace greville

#endif
