// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/overlapping_cholesky.h>
#include <greville/linear_algebra/solve_result.h>
#include <greville/mass/extended_mass.h>
#include <greville/multigrid/smoother.h>

#include <functional>

namespace greville
{
  /// A function z = B r with a preconditioner B, for the first @p n_columns
  /// columns of vectors of unknowns with @p width columns.
  using ColumnPreconditioner =
    std::function<void(VectorType        &z,
                       const VectorType  &r,
                       const unsigned int width,
                       const unsigned int n_columns)>;



  /**
   * Conjugate gradients for A x = b with an ExtendedMass. All components of one
   * or two vector fields are solved together, with one pass over matrix and
   * factors. The preconditioner is OverlappingCholesky with a drop tolerance:
   * one factorization of the matrix without constraints for all components.
   * Constrained entries of its result are set to zero. A given preconditioner
   * may be nonlinear and may ignore constraints.
   *
   * A factorization is kept until the unknowns change, or until the additional
   * iterations due to its age cost more than a new one. It is made only when a
   * solve needs a preconditioner: bodies in free flight need none.
   *
   * Iterations are in single precision, with one sum over the processes each
   * (@ref Chronopoulos1989 "Chronopoulos and Gear, 1989"). They correct a
   * residual that is computed in double precision; a tolerance below 1e-5 needs
   * several corrections. After one correction of a good guess, the residual of
   * the iteration is accepted if double precision has confirmed it in one of
   * the last solves.
   *
   * The residual of the solution is orthogonal to constants in columns without
   * constrained functions, so that momentum does not depend on the tolerance.
   */
  template <int dim>
  class ExtendedMassSolver
  {
  public:
    /// Parameters and mass are kept by reference. The @p first_tolerance
    /// applies to solves without a guess, since their errors would remain in
    /// the guesses of a uniform motion. If no @p preconditioner is given, this
    /// class factorizes the matrix.
    ExtendedMassSolver(ExtendedMass<dim>          &mass,
                       const SolverParameters     &parameters,
                       const ColumnPreconditioner &preconditioner  = {},
                       const double                first_tolerance = 1.);

    /// Collective. Update after a change of the mass. If the lumped mass, which
    /// is kept by reference, is given, some solves end without a residual in
    /// double precision.
    void
    update(const double total_mass, const VectorType *lumped_mass = nullptr);

    /// Collective. Solve A x = E^T b for pairs (x, b) of fields. On entry, x
    /// contains initial guesses and the values of constrained coefficients.
    /// Iterations end when the residual of each field k is below the tolerance
    /// times the larger of its right-hand side and @p shares[k] times the first
    /// right-hand side.
    SolveResult
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {});

    /// Require a new factorization, and a check of the next residual.
    void
    forget()
    {
      factorized = nullptr;
      n_trusted  = 0;
    }

    /// Return the number of factorizations so far.
    unsigned int
    n_factorizations() const
    {
      return factorizations;
    }

  private:
    void
    factorize() const;

    /// Set the matrix in single precision.
    void
    prepare();

    /// Compute z = the preconditioner of A / unit times r, for @p width columns
    /// in blocks of dim.
    void
    precondition(VectorOf<float>       &z,
                 const VectorOf<float> &r,
                 const unsigned int     width,
                 const unsigned int     n_columns) const;

    /// Squared norms of fields.
    using FieldNorms = std::array<double, 8>;

    /// The squares of the columns of r, b and x, and the sums of the columns of
    /// r = b - A x.
    template <int width>
    using ResidualSums = std::array<std::array<double, width>, 4>;

    /// Set r = b - A x. If the product has single precision, the sums of r are
    /// computed from the row sums.
    template <int width>
    ResidualSums<width>
    residual(VectorType       &r,
             VectorType       &x,
             const VectorType &b,
             const bool        in_single) const;

    template <int width>
    SolveResult
    iterate(VectorType                &x,
            const VectorType          &b,
            const unsigned int         n_fields,
            const std::vector<double> &shares,
            const unsigned int         max_iterations) const;

    /// Add to @p x a solution of A e = @p residual in single precision, such
    /// that the norm of each field is below @p goal times its @p target.
    /// @p sums belong to the residual; the sums of its columns are updated.
    /// Counts the iterations in @p k. Returns the largest ratio of a norm to
    /// its target at the end.
    template <int width>
    double
    correct(VectorType          &x,
            const VectorType    &residual,
            ResidualSums<width> &sums,
            const FieldNorms    &target,
            const unsigned int   n_fields,
            const double         goal,
            const unsigned int   max_iterations,
            unsigned int        &k) const;

    ExtendedMass<dim>         &mass;
    const SolverParameters    &parameters;
    const ColumnPreconditioner other_preconditioner;
    const double               first_tolerance;

    double            total_mass = 0., unit = 1.;
    const VectorType *lumped_mass = nullptr;
    VectorType        row_sums; // of A, by function, without constraints

    /// The largest number of solves between two checks of the residual.
    static constexpr unsigned int max_trusted = 7;
    mutable unsigned int          n_trusted   = 0; // solves to come

    /// The factor by which single precision can reduce a residual.
    static constexpr double reduction = 1e-5;

    bool is_old = true; // unit and the matrix in single precision

    // Vectors of the last solve; later solves use their memory again.
    VectorType         unknowns, rows;
    mutable VectorType residual_rows;

    // Vectors of an iteration: correction, residual, direction and its product,
    // preconditioned residual and its product.
    mutable VectorOf<float> e, r, p, s, u, w;

    /// The cost of a factorization, in iterations.
    static constexpr unsigned int iterations_of_factorization = 8;

    mutable OverlappingCholesky factors;
    // The unknowns of the factors; null if new factors are required.
    mutable std::shared_ptr<const InterleavedLayout> factorized;
    mutable bool                                     is_fresh       = false;
    mutable unsigned int                             factorizations = 0;
    mutable unsigned int fresh_iterations  = 0; // of a solve with new factors
    mutable unsigned int excess_iterations = 0; // of all solves since
  };
} // namespace greville
