// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_trial_step_h
#define greville_points_trial_step_h

#include <greville/points/trial_surface.h>

#include <functional>

namespace greville
{
  /**
   * The stress of a step that goes into its internal force.
   */
  enum class StepStress
  {
    /// At its end.
    end,
    /// A mean whose work is the change of the energy of the points, see
    /// TrialStep.
    energy_consistent
  };



  /**
   * A point in a trial step, in the configuration at its begin.
   */
  template <int dim>
  struct TrialPoint
  {
    /// Where the basis functions are taken, m.
    dealii::Point<dim> x;
    /// Volume at the start, m^3 (in 2D m^2, or m^3 per radian).
    double volume;
    /// The first Piola-Kirchhoff stress relative to the begin, Pa.
    dealii::Tensor<2, dim> P;
    /// Its derivative by the increment f, where it is asked for: dP_iJ / df_kL
    /// = map_Jj A_ijkl map_Ll.
    dealii::Tensor<4, dim> A;
    dealii::Tensor<2, dim> map;
    /// Half of the edges of the domain over which gradients are averaged in
    /// cells that reach their neighbours (CellWindows), m.
    dealii::Tensor<1, dim> domain = {};

    /**
     * What the zz entries add in axisymmetry: f_zz = 1 + u_r / radius.
     */
    struct Hoop
    {
      /// m; 0 in plane strain, where nothing below counts.
      double radius = 0.;
      /// The increment, and P_zz.
      double f = 1., P = 0.;
      /// dP_zz / df_zz, dP_zz / df_kL = of_kl map_Ll, dP_iJ / df_zz =
      /// map_Jj by_ij.
      double                 A = 0.;
      dealii::Tensor<2, dim> of, by;
    };

    Hoop hoop = {};
  };



  /**
   * The internal force of points that a displacement u of the grid has moved
   * from x_n, and its derivative. With the basis functions at x_n, the
   * increment f = 1 + grad u and the volumes V_n,
   * @f[
   *   r_i = \sum_p V_n P_{iJ} \partial_J N(x_n), \qquad
   *   P = \det(f) \, \sigma f^{-T}, \qquad
   *   \frac{\partial P_{iJ}}{\partial f_{kL}} = \det(f)
   *     (D_{ijkl} + \sigma_{ij} \delta_{kl} - \sigma_{il} \delta_{jk})
   *     f^{-1}_{Jj} f^{-1}_{Ll}
   * @f]
   * with the Cauchy stress sigma that the material gives for the end of the
   * step and D of Material::tangents(). The points do not change: the materials
   * work on copies.
   *
   * The energy-consistent stress is that of
   * @ref Gonzalez2000 "Gonzalez, 2000":
   * P = (1 + f) / 2 S with the symmetric tensor
   * @f[
   *   S = \bar S + \frac{\Delta W - \bar S : \Delta E}{\Delta E : \Delta E}
   *       \Delta E, \qquad \Delta E = \tfrac12 (f^T f - 1),
   * @f]
   * where S bar is the mean of the second Piola-Kirchhoff stresses (relative to
   * x_n) at both ends, and Delta W the change of the stored and the dissipated
   * energy per volume. So V_n P : grad u is the change of the energy of a
   * point, and the force has no moment. The derivative is that of S bar.
   *
   * Points of total Lagrangian steps (PointLayout::basis_position) have the
   * basis functions at X: f = 1 + grad_X u F_n^-1, and P and its derivative are
   * those times F_n^-T, which belong to gradients with respect to X.
   *
   * Axisymmetric points have the entry f_zz = 1 + N u_r / r_n as well (u_r / X
   * in total Lagrangian steps gives the same), and the component r of the force
   * gets V_n P_zz N / r_n.
   *
   * With the J hat of a VolumeProjection, the material sees it in place of J,
   * sigma is its answer, and f remains that of the motion. The derivative is
   * that for a constant J hat / J.
   */
  template <int dim>
  class TrialStep
  {
  public:
    /**
     * The space is kept by reference, and so are its windows, null where there
     * are none.
     */
    void
    reinit(const SplineSpace<dim> &space,
           const CellWindows<dim> *windows = nullptr);

    /**
     * Evaluate points of one body in a step of length @p dt that ends at @p
     * time (s) with the displacement @p u (m) and a @p strength_reduction (see
     * Material::strength_reduction()), and give them cell by cell to @p action,
     * which may change them. @p J_hat is null without a projection.
     */
    using Action = std::function<void(const unsigned int            cell,
                                      std::vector<TrialPoint<dim>> &points)>;

    PointReport
    evaluate(const MaterialPoints<dim> &points,
             const Material            &material,
             const VectorField<dim>    &u,
             const double               dt,
             const double               time,
             const double               strength_reduction,
             const StepStress           stress,
             const bool                 with_tangents,
             const double              *J_hat,
             const Action              &action);

  private:
    SpacePolynomials<dim>   tables;
    const CellWindows<dim> *windows = nullptr;
    std::vector<double>     buffer, window_buffer;
  };



  /**
   * Sums over TrialPoint of cells, and over the points of surfaces, on a space
   * of any order on the same mesh.
   */
  template <int dim>
  class TrialSums
  {
  public:
    /**
     * The space is kept by reference, and so are its windows, null where there
     * are none.
     */
    void
    reinit(const SplineSpace<dim> &space,
           const CellWindows<dim> *windows = nullptr);

    /**
     * Set the force to zero.
     */
    void
    clear();

    /**
     * Add V_n P grad N.
     */
    void
    add_force(const unsigned int                  cell,
              const std::vector<TrialPoint<dim>> &points);

    /**
     * Add dA load N.
     */
    void
    add_force(const unsigned int                         cell,
              const std::vector<TrialSurfacePoint<dim>> &points);

    /**
     * Add what PointTangents leave out in a cell that reaches its neighbours:
     * the product of a field with the derivative of the force of means over
     * domains, less that of gradients at points. @p u is the buffer of
     * CellWindows::read().
     */
    void
    add_change(const unsigned int                  cell,
               const std::vector<TrialPoint<dim>> &points,
               const std::vector<double>          &u);

    /**
     * Sum of the squares of all forces that have been added, cell by cell.
     */
    double
    square_of_forces() const
    {
      return square;
    }

    /**
     * Collective. The sums of all processes.
     */
    void
    take_force(VectorField<dim> &force) const;

    /**
     * What loads on surfaces contribute to the stiffness, minus their
     * derivative: the symmetric part of the matrix of a cell, as
     * BlockStencil::add_cell() takes it with a stride of n.
     */
    const float *
    stiffness(const unsigned int                         cell,
              const std::vector<TrialSurfacePoint<dim>> &points);

    /**
     * Add all of it times a vector on the places of a matrix on the space, dim
     * components each.
     */
    void
    add_product(double                                    *y,
                const double                              *x,
                const StencilMatrix<dim>                  &places,
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

#endif
