// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_stiffness_tangent_surfaces_h
#define greville_stiffness_tangent_surfaces_h

#include <greville/points/trial_step.h>
#include <greville/spline/order_hierarchy.h>
#include <greville/stiffness/tangent_level.h>

#include <functional>
#include <vector>

namespace greville
{
  /**
   * What forces on surfaces give to a TangentSystem: forces on the grid, and
   * their stiffness, which is applied point by point, and whose symmetric part
   * is assembled for preconditioners.
   */
  template <int dim>
  class TangentSurfaces
  {
  public:
    /// What move() calls for a point.
    using Action = std::function<void(const ConstPointRef<dim> p,
                                      const SurfaceState<dim> &state)>;

    /// The spaces are kept by reference.
    void
    reinit(const OrderHierarchy<dim> &orders);

    /**
     * Collective. The force of loads on @p surfaces for the displacement @p u.
     * If @p with_stiffness, their stiffness is added. Returns whether all
     * derivatives are symmetric; true without them.
     */
    bool
    add(const std::vector<LoadedSurface<dim>> &surfaces,
        const VectorField<dim>                &u,
        const SurfaceMotion<dim>              &motion,
        const bool                             with_stiffness,
        VectorField<dim>                      &force);

    /**
     * Collective. Call @p action(p, state) for the points of a surface where
     * the displacement @p u has brought them, in the order of
     * MaterialPoints::for_each().
     */
    void
    move(const MaterialPoints<dim> &points,
         const VectorField<dim>    &u,
         const SurfaceMotion<dim>  &motion,
         const Action              &action);

    /**
     * Collective. The force on the grid of forces on the points of @p surfaces,
     * of one after another, N (2D: N / m).
     */
    void
    spread(const std::vector<const MaterialPoints<dim> *> &surfaces,
           const std::vector<dealii::Tensor<1, dim>>      &forces,
           VectorField<dim>                               &result);

    /**
     * Collective. Add the stiffness of such points against displacements, N / m
     * (2D: N / m^2).
     */
    void
    add_stiffness(const std::vector<const MaterialPoints<dim> *> &surfaces,
                  const std::vector<dealii::Tensor<2, dim>>      &stiffness);

    /// Begin anew, without stiffness.
    void
    clear_stiffness()
    {
      stiff.clear();
      scale_of_points = 0.;
    }

    /// Add the stiffness to that of a level, counted from the coarsest one.
    void
    assemble(TangentLevel<dim> &level, const unsigned int number);

    /// y += K x on the places of the finest level.
    void
    add_product(double *y, const double *x, const StencilMatrix<dim> &places);

    /**
     * The Euclidean norm of what the cells give to the stiffness of forces that
     * a displacement changes, N / m: of the last add() and add_stiffness().
     */
    double
    stiffness_scale() const
    {
      return scale_of_loads + scale_of_points;
    }

  private:
    std::vector<TrialSums<dim>> sums; // by level
    TrialSurfaces<dim>          trial_surfaces;
    // Points with stiffness, cell by cell.
    std::vector<std::pair<unsigned int, std::vector<TrialSurfacePoint<dim>>>>
             stiff;
    MPI_Comm comm           = MPI_COMM_NULL;
    double   scale_of_loads = 0., scale_of_points = 0.;
  };
} // namespace greville

#endif
