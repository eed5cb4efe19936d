// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/lanes.h>
#include <greville/points/trial_surface.h>

#include <array>
#include <functional>

namespace greville
{
  /// The stress used in the internal force of a step.
  enum class StepStress
  {
    /// The stress at the end of the step.
    end,
    /// A mean stress whose work is the change of the energy of the points, see
    /// TrialStep.
    energy_consistent
  };



  /// Up to four points of a cell in a trial step, in the configuration at its
  /// start. Empty lanes have zeros, except for positions and domains.
  template <int dim>
  struct TrialGroup
  {
    /// The number of pairs (iJ), row by row. In 2D, the pair of f_zz = 1 + u_r
    /// / radius follows, which multiplies u_r instead of a derivative; it is
    /// zero in plane strain.
    static constexpr int n_pairs = dim == 2 ? 5 : 9;
    using Pairs                  = std::array<Lanes, n_pairs>;

    /// The position at which basis functions are evaluated, m.
    Lanes x[dim];
    /// The first Piola-Kirchhoff stress relative to the start, times the volume
    /// at the start: V P_iJ, and V P_zz / radius, J (in 2D J / m, or J per
    /// radian).
    Pairs stress;
    /// If requested: V dP / df as in PointTangents, and two means of V dP_ij /
    /// df_ij with respect to the configuration at the end, over i = j
    /// (compression) and over other pairs (shear).
    double *tangent;
    Lanes   compression, shear;
    /// For points with projected volumes: the change of f in an isotropic
    /// expansion of 1 in each direction, and its dual vector. The product of
    /// the dual vector with a change of f is the trace of the displacement
    /// gradient.
    Pairs expansion, dual;
    /// Half of the edges of the domain over which gradients are averaged in
    /// cells that reach their neighbours (CellWindows), m.
    Lanes domain[dim];
  };



  template <int dim>
  class PointTangents;



  /**
   * The internal force of points moved from x_n by a displacement u of the
   * grid, and its derivative. With the basis functions at x_n, the increment f
   * = 1 + grad u and the volumes V_n,
   * @f[
   *   r_i = \sum_p V_n P_{iJ} \partial_J N(x_n), \qquad
   *   P = \det(f) \, \sigma f^{-T}, \qquad
   *   \frac{\partial P_{iJ}}{\partial f_{kL}} = \det(f)
   *     (D_{ijkl} + \sigma_{ij} \delta_{kl} - \sigma_{il} \delta_{jk})
   *     f^{-1}_{Jj} f^{-1}_{Ll}
   * @f]
   * with the Cauchy stress sigma of the material at the end of the step and D
   * of Material::tangents(). The points do not change: the materials work on
   * copies.
   *
   * The energy-consistent stress (@ref Gonzalez2000 "Gonzalez, 2000") is P = (1
   * + f) / 2 S with the symmetric tensor
   * @f[
   *   S = \bar S + \frac{\Delta W - \bar S : \Delta E}{\Delta E : \Delta E}
   *       \Delta E, \qquad \Delta E = \tfrac12 (f^T f - 1),
   * @f]
   * where S bar is the mean of the second Piola-Kirchhoff stresses (relative to
   * x_n) at both ends, and Delta W the change of the stored and the dissipated
   * energy per volume. V_n P : grad u is then the change of the energy of a
   * point, and the force has no moment. The derivative is taken of S bar only.
   *
   * Points of total Lagrangian steps (PointLayout::basis_position) use basis
   * functions at X: f = 1 + grad_X u F_n^-1, and P and its derivative are
   * multiplied by F_n^-T for gradients with respect to X.
   *
   * Axisymmetric points also have the entry f_zz = 1 + N u_r / r_n (u_r / X in
   * total Lagrangian steps gives the same), and V_n P_zz N / r_n is added to
   * the component r of the force.
   *
   * With a VolumeProjection, the material computes sigma with J hat in place of
   * J, while f remains the increment of the motion. The derivative is taken at
   * constant J hat / J.
   */
  template <int dim>
  class TrialStep
  {
  public:
    /// The space and its windows, null if there are none, are kept by
    /// reference.
    void
    reinit(const SplineSpace<dim> &space,
           const CellWindows<dim> *windows = nullptr);

    /// Evaluate the points of one body in a step of length @p dt (s), which
    /// ends at @p time (s), with the displacement @p u (m) and a
    /// @p strength_reduction (see Material::strength_reduction()). Pass the
    /// points cell by cell to @p action, which may change them. The derivatives
    /// are added to @p tangents, unless null. @p J_hat is null without a
    /// projection.
    using Action = std::function<void(const unsigned int            cell,
                                      std::vector<TrialGroup<dim>> &groups)>;

    PointReport
    evaluate(const MaterialPoints<dim> &points,
             const Material            &material,
             const VectorField<dim>    &u,
             const double               dt,
             const double               time,
             const double               strength_reduction,
             const StepStress           stress,
             PointTangents<dim>        *tangents,
             const double              *J_hat,
             const Action              &action);

  private:
    SpacePolynomials<dim>   tables;
    const CellWindows<dim> *windows = nullptr;
    std::vector<double>     buffer, window_buffer;
  };



  /// Sums over the TrialGroup objects of cells and over surface points, on a
  /// space of any order on the same mesh.
  template <int dim>
  class TrialSums
  {
  public:
    /// The space and its windows, null if there are none, are kept by
    /// reference.
    void
    reinit(const SplineSpace<dim> &space,
           const CellWindows<dim> *windows = nullptr);

    /// Set the force to zero.
    void
    clear();

    /// Add V_n P grad N.
    void
    add_force(const unsigned int                  cell,
              const std::vector<TrialGroup<dim>> &groups);

    /// Add dA load N.
    void
    add_force(const unsigned int                         cell,
              const std::vector<TrialSurfacePoint<dim>> &points);

    /// For a cell that reaches its neighbours, add the product of a field with
    /// the derivative of the force with means over domains, less the product of
    /// PointTangents, which has gradients at points. @p u is the buffer of
    /// CellWindows::read().
    void
    add_change(const unsigned int                  cell,
               const std::vector<TrialGroup<dim>> &groups,
               const PointTangents<dim>           &tangents,
               const std::vector<double>          &u);

    /// Return the sum of the squares of all cell forces that have been added.
    double
    square_of_forces() const
    {
      return square;
    }

    /// Collective. Compute the sums over all processes.
    void
    take_force(VectorField<dim> &force) const;

    /// Return the contribution of surface loads to the stiffness of a cell: the
    /// symmetric part of minus their derivative, in the layout of
    /// BlockStencil::add_cell() with a stride of n.
    const float *
    stiffness(const unsigned int                         cell,
              const std::vector<TrialSurfacePoint<dim>> &points);

    /// Call visit(k, f, value) for the values of local basis functions f at
    /// point number k of a cell.
    using Visit =
      std::function<void(unsigned int k, unsigned int f, double value)>;
    void
    for_each_value(const unsigned int                     cell,
                   const std::vector<dealii::Point<dim>> &points,
                   const Visit                           &visit) const;

    /// Add the product of this contribution, including its skew part, with a
    /// vector of dim components on the StencilPlaces of a matrix.
    void
    add_product(double                                    *y,
                const double                              *x,
                const StencilMatrix<dim>                  &stencil,
                const unsigned int                         cell,
                const std::vector<TrialSurfacePoint<dim>> &points);

  private:
    SpacePolynomials<dim>   tables;
    const CellWindows<dim> *windows = nullptr;
    std::vector<double>     sums, window_sums;
    std::vector<float>      matrix;
    double                  square = 0.;
  };
} // namespace greville
