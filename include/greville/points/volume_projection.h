// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/point_transfer.h>
#include <greville/points/trial_step.h>

namespace greville
{
  /// Data of a body's points: the projected J, the derivatives of P by its
  /// logarithm, and the share of these derivatives in a stiffness matrix.
  template <int dim>
  struct ProjectedBody
  {
    const MaterialPoints<dim>                   *points;
    double                                       share;
    std::vector<double>                          J_hat;
    std::vector<typename TrialGroup<dim>::Pairs> derivatives;
  };



  /**
   * A projection of volume ratios against locking (F-bar). Instead of F and J =
   * det F of the motion, the material of a body uses
   * @f[
   *   \hat F = (\hat J / J)^{1/dim} F, \qquad
   *   \hat J = \sum_I c_I N_I, \qquad
   *   \sum_J \sum_q V_q N_I(x_q) N_J(x_q) \, c_J
   *     = \sum_q V_q N_I(x_q) J_q,
   * @f]
   * the L2 projection with the stress-free volumes V of the points. The N_I are
   * B-splines of order p - 1 on the mesh (for p = 1, constants in each cell),
   * or of order p on the coarse mesh of cells of twice the size. The forces on
   * the grid follow from the stress sigma(F hat) in the true configuration, J
   * sigma F^-T (@ref deSouzaNeto1996 "de Souza Neto, Peric, Dutko and Owen,
   * 1996"; with B-splines: @ref Elguedj2008 "Elguedj, Bazilevs, Calo and
   * Hughes, 2008"). J hat is a function of the positions of points at the end
   * of a step, so errors do not accumulate.
   *
   * In updated Lagrangian steps, x is the position at the start of the step. In
   * total Lagrangian steps, x is the initial position. J and V are then
   * relative to the initial configuration, so that initial stresses are
   * preserved.
   *
   * The system is solved by a few iterations with the lumped matrix. All
   * right-hand sides use the same number, so that J hat is linear in J. The
   * iterations need no extension of the N_I at surfaces, preserve a constant J,
   * and are exact for p = 1. For nearly incompressible bodies, a single
   * iteration would suffice; the others make J hat accurate for changes of
   * volume, above all at surfaces. If functions of order p = 1 are extended,
   * bodies still lock with the N_I on the mesh. Cells of the coarse mesh begin
   * at the lower corner of the grid. The last cells extend beyond it if the
   * number of cells is odd.
   *
   * Bodies are projected one by one, since their stiffness may differ.
   */
  template <int dim>
  class VolumeProjection
  {
  public:
    /// Collective. The space of order p is kept by reference. If @p coarse, the
    /// cells of the projection have twice the size. Periodic directions then
    /// need an even and sufficient number of cells; otherwise, throws
    /// dealii::ExcMessage.
    void
    reinit(const SplineSpace<dim>        &space,
           DistributedTriangulation<dim> &triangulation,
           const bool                     coarse);

    /// Collective. Return J hat of the @p points of a body, in the order of
    /// MaterialPoints::for_each(), after a step @p dt (s) with the velocity
    /// @p w of the grid; or, with a @p direction, its derivative by dt w.
    /// Unless @p moves, axisymmetric points keep their radius.
    const std::vector<double> &
    project(const MaterialPoints<dim> &points,
            const VectorField<dim>    &w,
            const double               dt,
            const VectorField<dim>    *direction = nullptr,
            const bool                 moves     = true);

    /// Collective. Return, for the same points, the derivative of log J hat
    /// less a @p share of the derivative of log J, in the direction @p du of
    /// the displacement @p u. @p J_hat belongs to @p u.
    const std::vector<double> &
    differentiate(const MaterialPoints<dim> &points,
                  const VectorField<dim>    &u,
                  const VectorField<dim>    &du,
                  const std::vector<double> &J_hat,
                  const double               share);

  private:
    void
    number_coarse_functions();

    template <int n>
    void
    find_J(const MaterialPoints<dim> &points,
           const double               dt,
           const bool                 with_direction,
           const bool                 moves);

    template <int n>
    void
    project_J(const MaterialPoints<dim> &points);

    SpacePolynomials<dim> tables;

    // The functions N_I: q + 1 polynomials in each direction, by cell of the
    // projection, and local numbers of functions, by cell of the mesh.
    unsigned int                       coarsening = 1;
    unsigned int                       q          = 0;
    std::array<SplinePolynomials, dim> polynomials;
    CellEdges<dim>                     edges; // of pairs of cells
    std::vector<unsigned int>          functions;
    VectorType                         weighted, weight;

    std::vector<double> buffer, sums;
    // J of the points' motion, then J hat; dJ / J in the direction.
    std::vector<double> J, rates;
  };
} // namespace greville
