// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/trial_step.h>
#include <greville/spline/order_hierarchy.h>
#include <greville/stiffness/tangent_level.h>

#include <functional>
#include <vector>

namespace greville
{
  /// The contribution of surface forces to a TangentSystem: forces on the grid,
  /// and their stiffness. The stiffness is applied point by point; its
  /// symmetric part is assembled for preconditioners.
  template <int dim>
  class TangentSurfaces
  {
  public:
    /// A function that move() calls for each point.
    using Action = std::function<void(const ConstPointRef<dim> p,
                                      const SurfaceState<dim> &state)>;

    /// The spaces are kept by reference.
    void
    reinit(const OrderHierarchy<dim> &orders);

    /// Collective. Add the force of loads on @p surfaces for the displacement
    /// @p u, and their stiffness if @p with_stiffness. Returns whether all
    /// derivatives are symmetric; without stiffness, returns true.
    bool
    add(const std::vector<LoadedSurface<dim>> &surfaces,
        const VectorField<dim>                &u,
        const SurfaceMotion<dim>              &motion,
        const bool                             with_stiffness,
        VectorField<dim>                      &force);

    /// Collective. Call @p action(p, state) for the points of a surface, moved
    /// by the displacement @p u, in the order of MaterialPoints::for_each().
    void
    move(const MaterialPoints<dim> &points,
         const VectorField<dim>    &u,
         const SurfaceMotion<dim>  &motion,
         const Action              &action);

    /// Collective. Add to the grid the forces on the points of all @p surfaces,
    /// one surface after another, N (2D: N / m).
    void
    spread(const std::vector<const MaterialPoints<dim> *> &surfaces,
           const std::vector<dealii::Tensor<1, dim>>      &forces,
           VectorField<dim>                               &result);

    /// Call visit(s, u, weight, constrained) for the weights with which the
    /// unknowns u of the @p finest level interpolate point number s of a
    /// surface. Constrained components (bits) have no weight.
    using VisitWeight = std::function<
      void(std::size_t s, unsigned int u, double weight, unsigned char)>;
    void
    for_each_weight(const MaterialPoints<dim> &points,
                    const TangentLevel<dim>   &finest,
                    const VisitWeight         &visit) const;

    /// Collective. Set the norms, N / m (2D: N / m^2), of the stiffness of
    /// points for stiffness_scale(). This stiffness is not assembled.
    void
    set_stiffness_of_points(
      const std::vector<const MaterialPoints<dim> *> &surfaces,
      const std::vector<double>                      &norms);

    /// Remove all stiffness.
    void
    clear_stiffness()
    {
      stiff.clear();
      scale_of_points = 0.;
    }

    /// Add the stiffness to a level. Its @p number counts from the coarsest
    /// one.
    void
    assemble(TangentLevel<dim> &level, const unsigned int number);

    /// Compute y += K x on the places of the finest level.
    void
    add_product(double *y, const double *x, const StencilMatrix<dim> &stencil);

    /// Return the Euclidean norm of the cell contributions to the stiffness of
    /// displacement-dependent forces, N / m, from the last add() and
    /// set_stiffness_of_points().
    double
    stiffness_scale() const
    {
      return scale_of_loads + scale_of_points;
    }

  private:
    std::vector<TrialSums<dim>> sums; // by level
    TrialSurfaces<dim>          trial_surfaces;
    // Points with stiffness, by cell.
    std::vector<std::pair<unsigned int, std::vector<TrialSurfacePoint<dim>>>>
             stiff;
    MPI_Comm comm           = MPI_COMM_NULL;
    double   scale_of_loads = 0., scale_of_points = 0.;
  };
} // namespace greville
