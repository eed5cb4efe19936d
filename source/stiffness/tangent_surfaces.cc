// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/stiffness/tangent_surfaces.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  TangentSurfaces<dim>::reinit(const OrderHierarchy<dim> &orders)
  {
    sums.resize(orders.n_levels());
    for (unsigned int l = 0; l < sums.size(); ++l)
      sums[l].reinit(orders[l]);
    trial_surfaces.reinit(orders.finest());
    comm = orders.finest().communicator();
  }



  template <int dim>
  bool
  TangentSurfaces<dim>::add(const std::vector<LoadedSurface<dim>> &surfaces,
                            const VectorField<dim>                &u,
                            const SurfaceMotion<dim>              &motion,
                            const bool        with_stiffness,
                            VectorField<dim> &force)
  {
    // Derivatives are finite differences, with this round-off.
    constexpr double round_off = 1e-6;

    unsigned int is_asymmetric = 0;
    double       square        = 0.;
    sums.back().clear();
    for (const LoadedSurface<dim> &surface : surfaces)
      trial_surfaces.evaluate(
        surface,
        u,
        motion,
        with_stiffness,
        [&](const unsigned int cell, const auto &points) {
          sums.back().add_force(cell, points);
          if (!with_stiffness)
            return;
          stiff.emplace_back(cell, points);
          double of_cell = 0.;
          for (const TrialSurfacePoint<dim> &point : points)
            {
              const Tensor<2, dim> &D = point.by_displacement;
              of_cell += point.area * D.norm();
              if (point.by_gradient.norm() > 0. ||
                  (D - transpose(D)).norm() > round_off * D.norm())
                is_asymmetric = 1;
            }
          square += of_cell * of_cell;
        });
    sums.back().take_force(force);
    if (!with_stiffness)
      return true;
    scale_of_loads = std::sqrt(Utilities::MPI::sum(square, comm));
    return Utilities::MPI::max(is_asymmetric, comm) == 0;
  }



  template <int dim>
  void
  TangentSurfaces<dim>::move(const MaterialPoints<dim> &points,
                             const VectorField<dim>    &u,
                             const SurfaceMotion<dim>  &motion,
                             const Action              &action)
  {
    trial_surfaces.evaluate({&points,
                             [&](const ConstPointRef<dim> p,
                                 const SurfaceState<dim> &state) {
                               action(p, state);
                               return Tensor<1, dim>();
                             }},
                            u,
                            motion,
                            false,
                            [](const unsigned int, const auto &) {});
  }



  template <int dim>
  void
  TangentSurfaces<dim>::spread(
    const std::vector<const MaterialPoints<dim> *> &surfaces,
    const std::vector<Tensor<1, dim>>              &forces,
    VectorField<dim>                               &result)
  {
    auto                                force = forces.begin();
    std::vector<TrialSurfacePoint<dim>> trials;
    sums.back().clear();
    for (const MaterialPoints<dim> *points : surfaces)
      for (const unsigned int cell : points->cells())
        {
          trials.clear();
          points->for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            TrialSurfacePoint<dim> trial;
            trial.x    = p.basis_position(points->layout());
            trial.area = 1.;
            trial.load = *force++;
            trials.push_back(trial);
          });
          sums.back().add_force(cell, trials);
        }
    sums.back().take_force(result);
  }



  template <int dim>
  void
  TangentSurfaces<dim>::for_each_weight(const MaterialPoints<dim> &points,
                                        const TangentLevel<dim>   &finest,
                                        const VisitWeight         &visit) const
  {
    const ExtendedMass<dim> &mass        = finest.extended();
    const auto              &constrained = finest.constrained_components();
    std::size_t              first       = 0;
    std::vector<Point<dim>>  x;
    for (const unsigned int cell : points.cells())
      {
        x.clear();
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          x.push_back(p.basis_position(points.layout()));
        });
        sums.back().for_each_value(
          cell,
          x,
          [&](const unsigned int k, const unsigned int f, const double value) {
            mass.unknowns().for_each_unknown(
              mass.matrix().place(f),
              [&](const unsigned int u, const double weight) {
                visit(first + k, u, value * weight, constrained[f]);
              });
          });
        first += x.size();
      }
  }



  template <int dim>
  void
  TangentSurfaces<dim>::set_stiffness_of_points(
    const std::vector<const MaterialPoints<dim> *> &surfaces,
    const std::vector<double>                      &norms)
  {
    double square = 0.;
    auto   norm   = norms.begin();
    for (const MaterialPoints<dim> *points : surfaces)
      for (const unsigned int cell : points->cells())
        {
          double of_cell = 0.;
          for (unsigned int k = 0; k < points->n_points(cell); ++k)
            of_cell += *norm++;
          square += of_cell * of_cell;
        }
    scale_of_points = std::sqrt(Utilities::MPI::sum(square, comm));
  }



  template <int dim>
  void
  TangentSurfaces<dim>::assemble(TangentLevel<dim> &level,
                                 const unsigned int number)
  {
    const unsigned int n =
      Utilities::fixed_power<dim>(level.space().degree() + 1);
    for (const auto &[cell, points] : stiff)
      level.stiffness().add_cell(cell, sums[number].stiffness(cell, points), n);
  }



  template <int dim>
  void
  TangentSurfaces<dim>::add_product(double                   *y,
                                    const double             *x,
                                    const StencilMatrix<dim> &stencil)
  {
    for (const auto &[cell, points] : stiff)
      sums.back().add_product(y, x, stencil, cell, points);
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSurfaces);
} // namespace greville
