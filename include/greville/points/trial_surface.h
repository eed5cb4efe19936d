// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/point_transfer.h>
#include <greville/points/surface.h>

#include <functional>

namespace greville
{
  /// A surface point in a trial step, in the configuration at its start.
  template <int dim>
  struct TrialSurfacePoint
  {
    /// The position at which basis functions are evaluated, m.
    dealii::Point<dim> x;
    /// The initial area, m^2 (in 2D m), or the mass of a point of a body.
    double area;
    /// Force per initial area, Pa, or per mass.
    dealii::Tensor<1, dim> load;
    /// The derivatives of the load by the displacement, [i][k], and by the
    /// gradient of the displacement with respect to x, [i][k][L], if requested.
    dealii::Tensor<2, dim> by_displacement;
    dealii::Tensor<3, dim> by_gradient;
  };



  /// A surface with the force per initial area on its points; or the points of
  /// a body with the force per mass. Points of bodies have a mass instead of
  /// the area and no normal, and their force depends only on position and
  /// velocity.
  template <int dim>
  struct LoadedSurface
  {
    const MaterialPoints<dim> *points;
    std::function<dealii::Tensor<1, dim>(const ConstPointRef<dim> p,
                                         const SurfaceState<dim> &state)>
      load;
  };



  /// The motion of a surface in a trial step with the displacement u. The state
  /// of its points is evaluated after the given share of the step, with the
  /// velocity v + v_by_u u.
  template <int dim>
  struct SurfaceMotion
  {
    double                  share  = 1.;
    const VectorField<dim> *v      = nullptr; // null: zero
    double                  v_by_u = 0.;
  };



  /// Loads on surfaces, and on points of bodies, moved by a displacement u of
  /// the grid. The derivatives are central differences, which are exact up to
  /// round-off for loads that are quadratic in F, x and v, such as pressure.
  template <int dim>
  class TrialSurfaces
  {
  public:
    /// The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// Evaluate the points of a surface and pass them cell by cell to
    /// @p action.
    using Action =
      std::function<void(const unsigned int                         cell,
                         const std::vector<TrialSurfacePoint<dim>> &points)>;

    void
    evaluate(const LoadedSurface<dim> &surface,
             const VectorField<dim>   &u,
             const SurfaceMotion<dim> &motion,
             const bool                with_derivatives,
             const Action             &action);

  private:
    SpacePolynomials<dim> tables;
    std::vector<double>   buffer;
  };
} // namespace greville
