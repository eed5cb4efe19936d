// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_particles_volume_projection_h
#define greville_particles_volume_projection_h

#include <greville/particles/point_transfer.h>

#include <memory>

namespace greville
{
  /**
   * A projection of changes of volume against locking, F-bar: the increments f
   * = 1 + dt grad w of points in a step become
   * @f[
   *   \bar f = (\bar\theta / \theta)^{1/dim} f, \qquad
   *   \theta = \det f, \qquad
   *   \bar\theta(x_p) = \sum_I N_I(x_p)
   *     \frac{\sum_q V_q N_I(x_q) \theta_q}{\sum_q V_q N_I(x_q)}
   * @f]
   * with the B-splines N_I of order p - 1 on the same mesh and the volumes V of
   * the points at the begin; for p = 1 the N_I are one in a cell each. This is
   * the F-bar projection of
   * @ref Elguedj2008 "Elguedj, Bazilevs, Calo and Hughes, 2008". The L2
   * projection has the lumped matrix, so that theta bar lies between the
   * smallest and the largest theta nearby, also at surfaces; it is of order 2
   * inside of a body. The N_I are not extended: where those of order p = 1 are,
   * they still lock.
   *
   * Bodies are projected one by one: their points may differ in stiffness.
   */
  template <int dim>
  class VolumeProjection
  {
  public:
    /**
     * Collective. The space of order p is kept by reference.
     */
    void
    reinit(const SplineSpace<dim>        &space,
           DistributedTriangulation<dim> &triangulation);

    /**
     * Collective. The factors (theta bar / theta)^(1 / dim) of the @p points of
     * a body, in the order of MaterialPoints::for_each(); 1 where theta is not
     * positive.
     */
    const std::vector<double> &
    factors(const MaterialPoints<dim> &points,
            const VectorField<dim>    &w,
            const double               dt);

  private:
    template <int n>
    void
    find_changes(const MaterialPoints<dim> &points, const double dt);

    template <int n>
    void
    average_in_cells(const MaterialPoints<dim> &points);

    template <int n>
    void
    project(const MaterialPoints<dim> &points);

    SpacePolynomials<dim>             tables, lower_tables;
    std::unique_ptr<SplineSpace<dim>> lower_space; // none for p = 1
    std::vector<double>               buffer, sums;
    VectorType                        weighted, weight;
    std::vector<double>               changes; // theta, then the factors
  };
} // namespace greville

#endif
