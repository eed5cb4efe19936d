// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/trial_surface.h>

#include "gradients.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    // The step of finite differences, relative to the cell size and to strains.
    constexpr double difference = 1e-6;



    /// Return the state of a point after a further displacement with the given
    /// gradient.
    template <int dim>
    SurfaceState<dim>
    moved_state(const SurfaceState<dim>  &begin,
                const SurfaceMotion<dim> &motion,
                const Tensor<1, dim>     &v,
                const Tensor<1, dim>     &u,
                const Tensor<2, dim>     &gradient,
                const bool                is_total)
    {
      SurfaceState<dim> state = begin;
      state.x += motion.share * u;
      state.F += motion.share * (is_total ? gradient : gradient * begin.F);
      state.velocity = v + motion.v_by_u * u;
      return state;
    }



    template <int dim>
    void
    set_derivatives(TrialSurfacePoint<dim>   &trial,
                    const LoadedSurface<dim> &surface,
                    const ConstPointRef<dim>  p,
                    const SurfaceState<dim>  &begin,
                    const SurfaceMotion<dim> &motion,
                    const Tensor<1, dim>     &v,
                    const Tensor<1, dim>     &u,
                    const Tensor<2, dim>     &gradient,
                    const double              h,
                    const bool                is_total,
                    const bool                has_normal)
    {
      const auto load = [&](const Tensor<1, dim> &at,
                            const Tensor<2, dim> &gradient_at) {
        return surface.load(
          p, moved_state<dim>(begin, motion, v, at, gradient_at, is_total));
      };
      for (unsigned int k = 0; k < dim; ++k)
        {
          Tensor<1, dim> step;
          step[k] = difference * h;
          const Tensor<1, dim> derivative =
            (load(u + step, gradient) - load(u - step, gradient)) /
            (2. * step[k]);
          for (unsigned int i = 0; i < dim; ++i)
            trial.by_displacement[i][k] = derivative[i];
          for (unsigned int L = 0; has_normal && L < dim; ++L)
            {
              Tensor<2, dim> change;
              change[k][L] = difference;
              const Tensor<1, dim> slope =
                (load(u, gradient + change) - load(u, gradient - change)) /
                (2. * difference);
              for (unsigned int i = 0; i < dim; ++i)
                trial.by_gradient[i][k][L] = slope[i];
            }
        }
    }



    template <int dim, int n>
    void
    evaluate_points(const LoadedSurface<dim>                  &surface,
                    const SpacePolynomials<dim>               &tables,
                    const double                              *fields,
                    const SurfaceMotion<dim>                  &motion,
                    const bool                                 derivatives,
                    const typename TrialSurfaces<dim>::Action &action)
    {
      const MaterialPoints<dim> &points     = *surface.points;
      const PointLayout<dim>    &layout     = points.layout();
      const bool                 is_total   = layout.is_total_lagrangian();
      const bool                 has_normal = layout.find("normal");
      const unsigned int         n_fields   = motion.v ? 2 * dim : dim;
      std::vector<TrialSurfacePoint<dim>> trials;
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(tables, cell);
          trials.clear();
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            TrialSurfacePoint<dim> trial;
            trial.x    = p.basis_position(layout);
            trial.area = p.mass();
            const ValuesAndGradients<dim, n> N(geometry, trial.x);
            Tensor<1, dim>                   u, v;
            Tensor<2, dim>                   gradient;
            for (int a = 0; a < power(n, dim); ++a)
              {
                const double *c =
                  fields + std::size_t(geometry.functions[a]) * n_fields;
                for (int i = 0; i < dim; ++i)
                  {
                    u[i] += c[i] * N.values[a];
                    if (motion.v)
                      v[i] += c[dim + i] * N.values[a];
                    for (int j = 0; j < dim; ++j)
                      gradient[i][j] += c[i] * N.gradients.values[j][a];
                  }
              }
            const SurfaceState<dim> begin = surface_state<dim>(p, layout);
            trial.load                    = surface.load(
              p, moved_state<dim>(begin, motion, v, u, gradient, is_total));
            if (derivatives)
              set_derivatives<dim>(trial,
                                   surface,
                                   p,
                                   begin,
                                   motion,
                                   v,
                                   u,
                                   gradient,
                                   1. / geometry.inverse_h[0],
                                   is_total,
                                   has_normal);
            trials.push_back(trial);
          });
          action(cell, trials);
        }
    }
  } // namespace



  template <int dim>
  void
  TrialSurfaces<dim>::reinit(const SplineSpace<dim> &space)
  {
    tables.reinit(space);
  }



  template <int dim>
  void
  TrialSurfaces<dim>::evaluate(const LoadedSurface<dim> &surface,
                               const VectorField<dim>   &u,
                               const SurfaceMotion<dim> &motion,
                               const bool                with_derivatives,
                               const Action             &action)
  {
    const SplineSpace<dim> &space    = *tables.space;
    const unsigned int      n_fields = motion.v ? 2 * dim : dim;
    buffer.resize(n_local_functions(space) * n_fields);
    for (unsigned int d = 0; d < dim; ++d)
      {
        put_into_buffer(u[d], n_fields, d, buffer);
        if (motion.v)
          put_into_buffer((*motion.v)[d], n_fields, dim + d, buffer);
      }
    run_on_all(space.communicator(), [&]() {
      with_order(space.degree(), [&](const auto size) {
        evaluate_points<dim, decltype(size)::value>(
          surface, tables, buffer.data(), motion, with_derivatives, action);
      });
    });
  }



  GREVILLE_INSTANTIATE_CLASS(TrialSurfaces);
} // namespace greville
