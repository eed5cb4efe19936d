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
   * z = B r with a preconditioner B, for the first @p n_columns columns of
   * vectors of unknowns with @p width of them.
   */
  using ColumnPreconditioner =
    std::function<void(VectorType        &z,
                       const VectorType  &r,
                       const unsigned int width,
                       const unsigned int n_columns)>;



  /**
   * Conjugate gradients for A x = b with an ExtendedMass, for all components of
   * one or two vector fields together: one pass over matrix and factors serves
   * all of them. The preconditioner is PartitionedCholesky in lexicographic
   * order, one factorization for all components that have the same E, or
   * another one, which need not be linear nor know what is held.
   *
   * A factorization serves the matrices of following steps, too, until the
   * iterations that their solves need more than the first one add up to
   * SmootherParameters::reuse: until it has cost what a new one costs. It
   * outlives changes of as many unknowns; new ones are divided by their
   * diagonal entry.
   *
   * The residual of the solution is orthogonal to constants in columns without
   * held functions, so that momentum does not depend on the tolerance.
   */
  template <int dim>
  class ExtendedMassSolver
  {
  public:
    /**
     * Parameters and mass are kept by reference. Without another
     * @p preconditioner this class factorizes.
     */
    ExtendedMassSolver(ExtendedMass<dim>          &mass,
                       const SolverParameters     &parameters,
                       const SmootherParameters   &smoother_parameters,
                       const ColumnPreconditioner &preconditioner = {});

    /**
     * Collective. The mass has changed, and with it the set of unknowns if
     * @p unknowns_changed. Factorizes where it is due.
     */
    void
    update(const bool unknowns_changed, const double total_mass);

    /**
     * Collective. Solve A x = E^T b for pairs (x, b) of fields. On entry the
     * x hold initial guesses and the values of held coefficients. Iterations
     * end when the residual of each field k has fallen to the tolerance times
     * its right-hand side, or times @p shares[k] times the first right-hand
     * side, where that is larger.
     */
    SolveResult
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {});

    /**
     * Let the next update() factorize.
     */
    void
    forget()
    {
      is_due = true;
    }

    /**
     * Factorizations so far.
     */
    unsigned int
    n_factorizations() const
    {
      return factorizations;
    }

  private:
    /**
     * For the components @p alike.
     */
    struct Factors
    {
      std::vector<unsigned int> alike;
      PartitionedCholesky       cholesky;
    };

    void
    factorize();

    /**
     * The unknowns have changed: find those that have been factorized. Too many
     * changes make a new factorization due.
     */
    void
    match_unknowns();

    void
    hold();

    /**
     * z = the preconditioner times r, of @p width columns in blocks of dim.
     */
    void
    precondition(VectorType        &z,
                 const VectorType  &r,
                 const unsigned int width,
                 const unsigned int n_columns) const;

    /**
     * The columns of z that have these factors, those numbers of the @p width
     * columns that are listed.
     */
    void
    precondition(const Factors                   &part,
                 VectorType                      &z,
                 const VectorType                &r,
                 const unsigned int               width,
                 const std::vector<unsigned int> &columns) const;

    /**
     * Iterations after which a solve had better begin again with new factors.
     */
    unsigned int
    most_iterations_with_old_factors() const
    {
      // One solve that needs so many more makes a new factorization due.
      return fresh_iterations + 1 +
             static_cast<unsigned int>(smoother_parameters.reuse);
    }

    /**
     * Is it time for a new factorization?
     */
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

    unsigned int n_holds = 0; // of the mass, that factors know

    std::vector<Factors>      factors;
    std::vector<unsigned int> factor_alike;
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
