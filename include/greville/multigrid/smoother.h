// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/level_operator.h>

#include <functional>
#include <memory>
#include <string>

namespace greville
{
  /// Parameters of all smoothers; each smoother uses only some.
  struct SmootherParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Throw dealii::ExcMessage for invalid parameters that patterns cannot
    /// detect.
    void
    check() const;

    // Incomplete factorizations
    double shift = 0.;

    // Parameters of Schwarz methods, which add_paper_parts() adds to the list
    double       drop_tolerance = 1e-12;
    double       fill_factor    = 1.;
    unsigned int overlap        = 1;
    std::string  ordering       = "lexicographic";
    std::string  combination    = "automatic";

    // Parameters of point smoothers
    double       damping          = 1.;
    unsigned int chebyshev_degree = 4;
    double       chebyshev_range  = 20.;

    std::string petsc_options = "-pc_type bjacobi -sub_pc_type icc";
  };

  /**
   * Return the names of smoothers, separated by '|':
   * - "ict": ICT by LevelOperator::factorization(), one for all components,
   *   with ict_parameters() and at least the given shift,
   * - "ic0": the same with IC(0),
   * - "jacobi": @f$ \omega D^{-1} @f$ with @f$ \omega @f$ = damping /
   *   @f$ \lambda_\text{max}(D^{-1} A) @f$,
   * - "chebyshev": deal.II's polynomial smoother on @f$ D^{-1} A @f$,
   * - "chebyshev-ic0": the same on @f$ B^{-1} A @f$ with B of "ic0",
   * - "chebyshev-component-ic0": with one factorization for each component,
   * - "petsc": the PETSc preconditioner that the options describe, of the
   *   entries of all components.
   *
   * add_paper_parts() adds more.
   */
  std::string
  smoother_names();

  /// A function that makes a smoother, like make_smoother().
  template <int dim>
  using MakeSmoother =
    std::function<std::unique_ptr<Preconditioner>(const SmootherParameters &,
                                                  const LevelOperator<dim> &,
                                                  const bool symmetric)>;

  /// Add a smoother to the list, for both dimensions, in place of one with the
  /// same name, before parameters are read. @p needs_matrix says that the
  /// smoother uses LevelOperator::matrix(); @p by_components says that it takes
  /// vectors of one component only.
  template <int dim>
  void
  add_smoother(const std::string       &name,
               const bool               needs_matrix,
               const bool               by_components,
               const MakeSmoother<dim> &make);

  /// Return a preconditioner that applies a @p smoother of one component to all
  /// components, one by one.
  template <int dim>
  std::unique_ptr<Preconditioner>
  make_by_components(std::unique_ptr<Preconditioner> smoother,
                     const LevelOperator<dim>       &level);

  bool
  smoother_needs_matrix(const std::string &name);

  /// Collective. Return LevelOperator::factorization() for all components; null
  /// if there is none. It is scaled so that two smoothing steps are positive
  /// definite, also on several processes.
  template <int dim>
  std::unique_ptr<Preconditioner>
  make_factorization(const LevelOperator<dim> &level,
                     const CholeskyParameters &parameters);

  /// Collective. Make a smoother for @p level, which is kept by reference. With
  /// @p symmetric, it is symmetric if there is a choice. Throws
  /// dealii::ExcMessage for an unknown name or a factorization that fails.
  template <int dim>
  std::unique_ptr<Preconditioner>
  make_smoother(const std::string        &name,
                const SmootherParameters &parameters,
                const LevelOperator<dim> &level,
                const bool                symmetric);
} // namespace greville
