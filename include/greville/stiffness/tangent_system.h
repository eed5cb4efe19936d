// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/extended_mass_solver.h>
#include <greville/stiffness/set_up_reuse.h>
#include <greville/stiffness/tangent_bodies.h>
#include <greville/stiffness/tangent_level.h>
#include <greville/stiffness/tangent_parameters.h>
#include <greville/stiffness/tangent_surfaces.h>

namespace greville
{
  /**
   * The linear systems of implicit steps on extended B-splines,
   * @f[ E^T (c \tilde M + K) E \, x = E^T b, @f]
   * with the stiffness K of TangentBodies. K is applied point by point, with
   * the part that TangentBodies keeps apart from it. Only symmetric tangents of
   * order 1 are assembled, which costs less than a few products; the cycle
   * copies them. Krylov methods are preconditioned by a LatticeCycle, or, for
   * 'Levels' = orders, by PMultigrid on one TangentLevel for each order. Both
   * are assembled in single precision from the same points. The set-up of a
   * preconditioner (entries, factorizations, eigenvalues, coarse levels) is
   * reused for subsequent systems as long as it pays.
   *
   * Fields have a coefficient for each function of the space. The coefficients
   * of constrained functions are given, and the coefficients of extended
   * functions follow from the others.
   */
  template <int dim>
  class TangentSystem
  {
  public:
    /// A function that returns the constrained components (bits) of the local
    /// functions of a space. An empty function constrains nothing.
    using ConstrainedFunctions =
      std::function<std::vector<unsigned char>(const SplineSpace<dim> &space)>;

    /// Collective. Orders, parameters, the @p projection and the @p windows are
    /// kept by reference; the last two may be null. Cells are well-filled from
    /// the fraction @p filling on, see CellFilling. With @p lump, the row sums
    /// of the mass are used.
    TangentSystem(const OrderHierarchy<dim>  &orders,
                  const ConstrainedFunctions &constrained,
                  const TangentParameters    &parameters,
                  const double                filling,
                  const bool                  lump,
                  VolumeProjection<dim>      *projection = nullptr,
                  CellWindows<dim>           *windows    = nullptr);

    TangentSystem(const TangentSystem &) = delete;
    TangentSystem &
    operator=(const TangentSystem &) = delete;

    const SplineSpace<dim> &
    space() const
    {
      return orders.finest();
    }

    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /// Return the level of the finest order.
    const TangentLevel<dim> &
    finest() const
    {
      return *levels.back();
    }

    /// Collective. Update the extension and the mass after the points have
    /// moved. With @p is_static, the outer hosts of CellFilling are used.
    /// Functions are also extended to cells that contain only points of loaded
    /// @p surfaces.
    void
    set_points(const std::vector<TrialBody<dim>> &bodies,
               const std::vector<Surface<dim>>   &surfaces  = {},
               const bool                         is_static = false);

    /// Collective. Compute the internal force for the displacement @p u in a
    /// step of length @p dt (s), and the stiffness if @p with_stiffness.
    /// Returns a message about a failed point of this process, or an empty
    /// text.
    std::string
    evaluate(const std::vector<TrialBody<dim>> &bodies,
             const VectorField<dim>            &u,
             const double                       dt,
             const StepStress                   stress,
             const bool                         with_stiffness,
             VectorField<dim>                  &force);

    /// Return the surface forces and their stiffness, which adds to the
    /// stiffness of the last evaluate().
    TangentSurfaces<dim> &
    surfaces()
    {
      return of_surfaces;
    }

    const TangentSurfaces<dim> &
    surfaces() const
    {
      return of_surfaces;
    }

    /// Return the internal forces and their stiffness.
    const TangentBodies<dim> &
    bodies() const
    {
      return of_bodies;
    }

    /// Collective. Build the operator with a mass factor (1/s^2), and its
    /// preconditioner, from the stiffness of the last evaluate(). Throws
    /// ErrorOnAll if no preconditioner can be built.
    void
    set_operator(const double mass_factor, const bool is_symmetric);

    /// Collective. Build the operators of all levels, from the coarsest to the
    /// finest, from the stiffness of the last evaluate() and a mass factor
    /// (1/s^2). A custom preconditioner needs them instead of set_operator()
    /// and solve().
    typename PMultigrid<dim>::Levels
    make_levels(const double mass_factor);

    /// Let smoothers that are chosen automatically treat components separately.
    void
    smooth_components()
    {
      by_components = true;
    }

    /// The system as a part of a LatticeCycle of several systems. The cycle
    /// @p coarsens if coarse levels pay.
    struct LatticePart
    {
      std::unique_ptr<ExtendedLattice<dim>> finest;
      LatticeCycleParameters                parameters;
      bool                                  coarsens;
    };
    LatticePart
    lattice_part() const;

    /// Omit the preconditioner in set-ups, for coupled systems that have a
    /// LatticeCycle.
    void
    set_coupled(const bool is);

    /// Return the number of the last set-up, which is unique on this process.
    std::uint64_t
    set_up_number() const
    {
      return reuse.number();
    }

    /// Require a new set-up for the next operator.
    void
    forget();

    /// Return the number of set-ups so far.
    unsigned int
    n_set_ups() const
    {
      return reuse.n_set_ups();
    }

    /// Collective. Compute rows = E^T (force + M~ field), with zeros at
    /// constrained functions; @p field may be null. Vectors are vectors of
    /// unknowns, see initialize().
    void restrict(VectorType             &rows,
                  const VectorField<dim> &force,
                  const VectorField<dim> *field) const;

    /// Collective. Set field = E x, keeping its constrained coefficients.
    void
    extend(VectorField<dim> &field, const VectorType &x) const;

    /// Read the coefficients of the unknowns from a field, with zeros at
    /// constrained ones.
    void
    read(VectorType &x, const VectorField<dim> &field) const;

    /// Collective. Compute dst = A src for the A of the last set_operator().
    void
    multiply(VectorType &dst, const VectorType &src);

    /// Collective. Solve A x = b until the residual is @p tolerance times the
    /// residual of x = 0. Throws ErrorOnAll like set_operator().
    SolveResult
    solve(VectorType &x, const VectorType &b, const double tolerance);

    /// Collective. Solve coupled systems by a method @p run(n), which takes at
    /// most n iterations. Set-ups are reused as long as they pay.
    static SolveResult
    solve_together(
      const std::vector<TangentSystem *> &systems,
      const double                        tolerance,
      const std::function<SolveResult(const unsigned int iterations)> &run);

    /// Compute dst = S src for the preconditioner S.
    void
    precondition(VectorType &dst, const VectorType &src) const
    {
      multigrid->vmult(dst, src);
    }

    /// Return whether conjugate gradients solve the last system.
    bool
    takes_cg() const;

    /// Return the number of basis vectors of FGMRES between two restarts; 0 for
    /// conjugate gradients.
    unsigned int
    n_basis_vectors() const;

    /// Collective. Compute the velocity with M~ v = momentum; @p velocity
    /// supplies the constrained coefficients.
    SolveResult
    solve_mass(VectorField<dim> &velocity, const VectorField<dim> &momentum);

    /// Initialize a vector of the unknowns of the last set_points().
    void
    initialize(VectorType &vector) const;

  private:
    /// Return whether coarse levels pay for an operator with this mass factor.
    bool
    needs_levels(const double mass_factor) const;

    /// Collective. Assemble the entries of a level for the mass factor.
    void
    assemble(const unsigned int level);

    /// Return whether products use the entries of c M~ + K.
    bool
    has_entries() const
    {
      return space().degree() == 1 && of_bodies.tangents().is_symmetric();
    }

    /// Set the mass factor of the operator.
    void
    set_mass_factor(const double new_mass_factor);

    /// Compute y = (c M~ + K) x for vectors on the places of the finest level's
    /// StencilMatrix.
    void
    multiply_at_places(double *y, const double *x);

    /// Collective. Build the preconditioner of the operator. It is only the
    /// smoother if coarse levels cannot be built or do not pay.
    void
    set_up();

    /// Collective. Build the cycle, without a second attempt.
    void
    make_multigrid();

    /// Choose the smoother, if it is 'auto', and its parameters.
    void
    choose_smoother(PMultigridParameters &cycle,
                    SmootherParameters   &smoother) const;

    const TangentParameters                        &parameters;
    const double                                    filling_threshold;
    const bool                                      lump;
    const OrderHierarchy<dim>                      &orders;
    CellFilling<dim>                                filling;
    std::vector<PointTransfer<dim>>                 transfers;
    std::vector<std::unique_ptr<TangentLevel<dim>>> levels;
    std::vector<SpacePolynomials<dim>>              tables; // by level
    TangentBodies<dim>                              of_bodies;
    BlockStencil<dim, double>                       entries; // of order 1
    TangentSurfaces<dim>                            of_surfaces;
    std::unique_ptr<ExtendedMassSolver<dim>>        mass_solver;
    double                                          total_mass  = 0.;
    bool                                            mass_is_new = true;
    std::unique_ptr<Preconditioner>                 multigrid;
    CellWindows<dim>                               *windows;
    bool                                            symmetric     = true;
    bool                                            by_components = false;

    SetUpReuse reuse;
    bool       has_levels      = false; // in the last set-up
    bool       levels_fail     = false; // coarse levels fail for these unknowns
    bool       is_coupled      = false;
    double     mass_factor     = 0.; // of the operator
    double     mass_of_entries = 0.; // the mass factor that they contain

    std::vector<double> filled_part;
    mutable VectorType  unknowns;
    bool                is_first = true;
  };
} // namespace greville
