// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_extended_mass_solver_h
#define greville_multigrid_extended_mass_solver_h

#include <greville/linear_algebra/partitioned_cholesky.h>
#include <greville/linear_algebra/solve_result.h>
#include <greville/mass/extended_mass.h>
#include <greville/multigrid/smoother.h>

#include <functional>

namespace greville
{
  /**
   * A function z = B r with a preconditioner B, for the first @p n_columns
   * columns of vectors of unknowns with @p width columns.
   */
  using ColumnPreconditioner =
    std::function<void(VectorType        &z,
                       const VectorType  &r,
                       const unsigned int width,
                       const unsigned int n_columns)>;



  /**
   * Conjugate gradients for A x = b with an ExtendedMass, for all components of
   * one or two vector fields together, with one pass over matrix and factors.
   * The preconditioner is PartitionedCholesky in lexicographic order, with one
   * factorization for all components with the same E, or a given one, which may
   * be nonlinear and need not treat constraints.
   *
   * A factorization is reused in subsequent steps until the iterations in
   * excess of the first solve add up to SmootherParameters::reuse, that is,
   * until they cost as much as a new factorization. It remains in use if
   * unknowns change; new unknowns are divided by their diagonal entry.
   *
   * The residual of the solution is orthogonal to constants in columns without
   * constrained functions, so that momentum does not depend on the tolerance.
   */
  template <int dim>
  class ExtendedMassSolver
  {
  public:
    /**
     * Parameters and mass are kept by reference. If no @p preconditioner is
     * given, this class factorizes the matrix.
     */
    ExtendedMassSolver(ExtendedMass<dim>          &mass,
                       const SolverParameters     &parameters,
                       const SmootherParameters   &smoother_parameters,
                       const ColumnPreconditioner &preconditioner = {});

    /**
     * Collective. Update after a change of the mass, and of the set of unknowns
     * if @p unknowns_changed. Factorizes if a factorization is due.
     */
    void
    update(const bool unknowns_changed, const double total_mass);

    /**
     * Collective. Solve A x = E^T b for pairs (x, b) of fields. On entry, x
     * contains initial guesses and the values of constrained coefficients.
     * Iterations end when the residual of each field k is below the tolerance
     * times the larger of its right-hand side and @p shares[k] times the first
     * right-hand side.
     */
    SolveResult
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {});

    /// Require a factorization in the next update().
    void
    forget()
    {
      is_due = true;
    }

    /// Return the number of factorizations so far.
    unsigned int
    n_factorizations() const
    {
      return factorizations;
    }

  private:
    /**
     * Factors of the matrix of @p components.
     */
    struct Factors
    {
      std::vector<unsigned int> components;
      PartitionedCholesky       cholesky;
    };

    void
    factorize();

    /**
     * Match changed unknowns with the factorized ones. Too many changes make a
     * new factorization due.
     */
    void
    match_unknowns();

    void
    constrain();

    /**
     * Compute z = the preconditioner times r, for @p width columns in blocks of
     * dim.
     */
    void
    precondition(VectorType        &z,
                 const VectorType  &r,
                 const unsigned int width,
                 const unsigned int n_columns) const;

    /**
     * Compute the columns of z that use these factors, given by their numbers
     * among the @p width columns.
     */
    void
    precondition(const Factors                   &part,
                 VectorType                      &z,
                 const VectorType                &r,
                 const unsigned int               width,
                 const std::vector<unsigned int> &columns) const;

    /**
     * Return the number of iterations after which a solve should restart with
     * new factors.
     */
    unsigned int
    most_iterations_with_old_factors() const
    {
      // A single solve with this many more iterations makes a new factorization
      // due.
      return fresh_iterations + 1 +
             static_cast<unsigned int>(smoother_parameters.reuse);
    }

    /// Decide whether a new factorization is due.
    void
    judge_factorization(const unsigned int n_iterations)
    {
      if (is_fresh)
        {
          fresh_iterations  = n_iterations;
          excess_iterations = 0;
        }
      else if (n_iterations > fresh_iterations)
        excess_iterations += n_iterations - fresh_iterations;
      is_fresh = false;
      is_due   = excess_iterations > smoother_parameters.reuse;
    }

    template <int width>
    SolveResult
    iterate(VectorType                &x,
            VectorType                &r,
            const unsigned int         n_fields,
            const std::vector<double> &shares,
            const unsigned int         max_iterations);

    ExtendedMass<dim>         &mass;
    const SolverParameters    &parameters;
    const SmootherParameters  &smoother_parameters;
    const ColumnPreconditioner other_preconditioner;

    double                      total_mass = 0.;
    mutable std::vector<double> work;

    unsigned int n_constrain_calls = 0; // of the mass, that factors know

    std::vector<Factors>      factors;
    std::vector<unsigned int> factor_components;
    std::vector<unsigned int> factor_places; // owned, that were factorized
    std::vector<int>
               factor_rows; // of owned unknowns, -1: none; empty: the same
    VectorType diagonal;    // of A, for those with none

    unsigned int factorizations    = 0;
    bool         is_due            = true;  // to factorize
    bool         is_fresh          = false; // factorized and not yet used
    unsigned int fresh_iterations  = 0;     // of the first solve
    unsigned int excess_iterations = 0;     // beyond them, of the others
  };
} // namespace greville

#endif
