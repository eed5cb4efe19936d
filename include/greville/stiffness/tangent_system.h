// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_stiffness_tangent_system_h
#define greville_stiffness_tangent_system_h

#include <greville/linear_algebra/solve_result.h>
#include <greville/points/point_tangents.h>
#include <greville/points/volume_projection.h>
#include <greville/stiffness/tangent_level.h>
#include <greville/stiffness/tangent_parameters.h>
#include <greville/stiffness/tangent_surfaces.h>
#include <greville/stiffness/trial_body.h>

#include <string>

namespace greville
{
  /**
   * The linear systems of implicit steps on extended B-splines,
   * @f[ E^T (c \tilde M + K) E \, x = E^T b, @f]
   * with the stiffness K of points in a TrialStep. K is applied as the points
   * have it (PointTangents), but for symmetric tangents of order 1, whose
   * entries are assembled: there they cost less than a few products. Krylov
   * methods are preconditioned by p-multigrid: PMultigrid on one TangentLevel
   * for each order, assembled in single precision from the same points. The
   * set-up of a preconditioner (entries, factorizations, eigenvalues, coarse
   * levels) serves following systems, too, as long as it pays; after a system
   * with more iterations than expected the next one has new entries.
   *
   * A VolumeProjection couples functions beyond their stencils. K then resists
   * changes of volume not much more than shear, and serves the preconditioner;
   * multiply() adds what J hat does, from point to point. So the volumes that
   * the projection sees are much stiffer than in K, and all others are alike:
   * iterations hardly depend on the bulk modulus. Likewise where gradients are
   * averaged over domains: K has those at points, and multiply() adds the rest.
   *
   * Fields have a coefficient for each function of the space. Those of
   * functions that are held are given, and those of extended functions follow
   * from the others.
   */
  template <int dim>
  class TangentSystem
  {
  public:
    /**
     * Bits of the components of the local functions of a space that are held.
     * An empty function of this type holds nothing.
     */
    using HeldFunctions =
      std::function<std::vector<unsigned char>(const SplineSpace<dim> &space)>;

    /**
     * Collective. Orders and parameters are kept by reference, and so are the
     * @p projection and the @p windows, which may be null. Cells are
     * well-filled from the fraction @p filling on, see CellFilling. @p lump
     * takes the row sums of the mass.
     */
    TangentSystem(const OrderHierarchy<dim> &orders,
                  const HeldFunctions       &held,
                  const TangentParameters   &parameters,
                  const double               filling,
                  const bool                 lump,
                  VolumeProjection<dim>     *projection = nullptr,
                  CellWindows<dim>          *windows    = nullptr);

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

    /// The level of the finest order.
    const TangentLevel<dim> &
    finest() const
    {
      return *levels.back();
    }

    /**
     * Collective. Points are at new places: find the extension, with the outer
     * hosts of CellFilling where the system is to be @p is_static, and sum up
     * the mass. Functions are extended to cells, too, which hold points of
     * loaded @p surfaces only.
     */
    void
    set_points(const std::vector<TrialBody<dim>> &bodies,
               const std::vector<Surface<dim>>   &surfaces  = {},
               const bool                         is_static = false);

    /**
     * Collective. The internal force for the displacement @p u in a step of
     * length @p dt (s), and the stiffness if @p with_stiffness. Returns what is
     * wrong with a point of this process, empty if nothing is.
     */
    std::string
    evaluate(const std::vector<TrialBody<dim>> &bodies,
             const VectorField<dim>            &u,
             const double                       dt,
             const StepStress                   stress,
             const bool                         with_stiffness,
             VectorField<dim>                  &force);

    /// Forces on surfaces, and their stiffness, which adds to that of the last
    /// evaluate().
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

    /**
     * Collective. The Euclidean norm of the forces that the cells give to the
     * last internal force, which balance each other for the most part.
     */
    double
    force_scale() const;

    /**
     * The like for a gradient of displacement of one, by the moduli of the last
     * evaluate() with stiffness: the unit of round-off of internal forces.
     */
    double
    stiffness_scale() const
    {
      return force_of_strain;
    }

    /**
     * Collective. Make the operator with a mass factor (1/s^2), and its
     * preconditioner, from the stiffness of the last evaluate(). Throws
     * ErrorOnAll where no preconditioner can be made.
     */
    void
    set_operator(const double mass_factor, const bool is_symmetric);

    /**
     * Collective. Make the operators of all levels, from the coarsest to the
     * finest, with a mass factor (1/s^2) from the stiffness of the last
     * evaluate(): for a preconditioner of one's own in place of set_operator()
     * and solve().
     */
    typename PMultigrid<dim>::Levels
    make_levels(const double mass_factor);

    /// Let smoothers that are chosen here take each component by itself.
    void
    smooth_components()
    {
      by_components = true;
    }

    /// Let the next operator have a set-up of its own.
    void
    forget();

    /// Set-ups so far.
    unsigned int
    n_set_ups() const
    {
      return set_ups;
    }

    /**
     * Collective. rows = E^T (force + M~ field), zero where held; with an empty
     * vector for no field. Vectors have the layout of LevelOperator.
     */
    void restrict(VectorType             &rows,
                  const VectorField<dim> &force,
                  const VectorField<dim> *field) const;

    /// Collective. field = E x with the held coefficients that it has.
    void
    extend(VectorField<dim> &field, const VectorType &x) const;

    /// The coefficients of the unknowns in a field, zero where they are held.
    void
    read(VectorType &x, const VectorField<dim> &field) const;

    /// Collective. dst = A src for the A of the last set_operator().
    void
    multiply(VectorType &dst, const VectorType &src);

    /**
     * Collective. Solve A x = b until the residual is @p tolerance times that
     * of zero. Throws ErrorOnAll like set_operator().
     */
    SolveResult
    solve(VectorType &x, const VectorType &b, const double tolerance);

    /**
     * Collective. Solve systems that are coupled by the method @p run(n) of at
     * most n iterations: with the set-ups that they have, or with new ones
     * where these do not pay.
     */
    static SolveResult
    solve_together(
      const std::vector<TangentSystem *> &systems,
      const double                        tolerance,
      const std::function<SolveResult(const unsigned int iterations)> &run);

    /// dst = S src for the preconditioner S.
    void
    precondition(VectorType &dst, const VectorType &src) const
    {
      multigrid->vmult(dst, src);
    }

    /// Whether conjugate gradients solve the last system.
    bool
    takes_cg() const
    {
      return parameters.takes_cg(symmetric) && !projection;
    }

    /// Basis vectors of FGMRES between two restarts; 0: conjugate gradients.
    unsigned int
    n_basis_vectors() const
    {
      if (takes_cg())
        return 0;
      // With a projection, restarts cost more than their vectors.
      return projection ? parameters.max_iterations : 30;
    }

    /**
     * Collective. The velocity with M~ v = momentum, with held coefficients as
     * @p velocity has them.
     */
    SolveResult
    solve_mass(VectorField<dim> &velocity, const VectorField<dim> &momentum);

    void
    initialize(VectorType &vector) const;

  private:
    /// Whether coarse levels pay for an operator with this mass factor.
    bool
    needs_levels(const double mass_factor) const;

    /// Whether the set-up of the last operator is good for one with this mass
    /// factor.
    bool
    is_reusable(const double mass_factor) const;

    /// Collective. Make the entries of a level, for the mass factor.
    void
    assemble(const unsigned int level);

    /// Whether products take the entries of c M~ + K.
    bool
    has_entries() const
    {
      return space().degree() == 1 && tangents.is_symmetric();
    }

    void
    assemble_entries();

    /// y = (c M~ + K) x on the places of the finest level.
    void
    multiply_at_places(double *y, const double *x);

    /// Collective. The preconditioner of the operator; the smoother alone where
    /// there is none with coarse levels, or where these do not pay.
    void
    set_up();

    /// Collective. Likewise, without the second try.
    void
    make_multigrid();

    /// Collective. The smoother, where it is 'auto', and its parameters.
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
    TrialSums<dim>                                  sums;
    std::vector<SpacePolynomials<dim>>              tables; // by level
    TrialStep<dim>                                  trial;
    PointTangents<dim>                              tangents;
    BlockStencil<dim, double>                       entries; // of order 1
    TangentSurfaces<dim>                            of_surfaces;
    std::unique_ptr<PMultigrid<dim>>                multigrid;
    bool                                            symmetric     = true;
    bool                                            by_components = false;
    VolumeProjection<dim>                          *projection;
    // Of the last evaluate() with stiffness and a projection.
    VectorField<dim>                displacement;
    std::vector<ProjectedBody<dim>> projected_bodies;
    // The points with domains of each cell that reaches its neighbours.
    CellWindows<dim>                                                  *windows;
    std::vector<std::pair<unsigned int, std::vector<TrialPoint<dim>>>> domains;
    std::vector<double> window_buffer;

    // Sums of the moduli of compression and of shear of all points.
    std::array<double, 2> moduli{};
    double                force_of_strain = 0.;

    // Of the set-up; iterations are those for a tenth of the residual.
    bool         has_levels = false, is_fresh = false;
    bool         wants_entries         = false; // new ones, for the next system
    bool         levels_fail           = false; // for these unknowns
    double       mass_factor_of_set_up = 0.;
    double       mass_factor           = 0.; // of the operator
    double       first_iterations      = 0.;
    double       excess_iterations     = 0.;
    unsigned int set_ups               = 0;

    std::vector<double> filled_part;
    mutable VectorType  unknowns;
    bool                is_first = true;
  };
} // namespace greville

#endif
