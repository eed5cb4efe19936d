// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/move_points.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The number of steps between two averages of volume changes, and the
    // fraction of the difference from the average that is removed while a wave
    // crosses a cell.
    constexpr unsigned int share_every = 10;
    constexpr double       share_rate  = 0.025;
  } // namespace



  void
  PointMotion::merge(const PointMotion &before)
  {
    fastest_signal = std::max(fastest_signal, before.fastest_signal);
    fastest_wave   = std::max(fastest_wave, before.fastest_wave);
    sums.add(before.sums);
    if (!before.problem.empty())
      problem = before.problem;
  }



  template <int dim>
  void
  stop_points(State<dim> &state)
  {
    for_all_points(state, [](MaterialPoints<dim> &points) {
      const PointField *affine = points.layout().find("affine");
      points.for_each([&](PointRef<dim> p) {
        for (unsigned int d = 0; d < dim; ++d)
          p.velocity(d) = 0.;
        for (unsigned int k = 0; affine && k < dim * dim; ++k)
          p[affine->first + k] = 0.;
      });
    });
  }



  template <int dim>
  PointMotion
  update_points(std::vector<Body<dim>> &bodies,
                PointTransfer<dim>     &transfer,
                PointUpdate<dim>        update,
                const double            time,
                LateRow<dim>           *row)
  {
    PointMotion motion;
    motion.left_cells.resize(bodies.size());
    for (unsigned int b = 0; b < bodies.size(); ++b)
      {
        Body<dim> &body = bodies[b];
        update.row      = row && update.acceleration ? &row->sums[b] : nullptr;
        update.row_fraction       = row ? row->fraction : 0.;
        update.material           = body.material;
        update.time               = time;
        update.strength_reduction = body.material->strength_reduction(time);
        PointReport report;
        // A law may throw on one process, but all processes must go on to the
        // next body.
        try
          {
            report = transfer.grid_to_points(body.points, update);
          }
        catch (const std::exception &error)
          {
            if (motion.problem.empty())
              motion.problem = "the law of the body '" + body.name +
                               "' has failed: " + message_of(error);
          }
        motion.sums.add(report.sums);
        motion.fastest_signal =
          std::max(motion.fastest_signal, report.fastest_signal);
        motion.fastest_wave =
          std::max(motion.fastest_wave, report.fastest_wave);
        if (update.move)
          motion.left_cells[b] = report.left_cells;
        if (report.bad_point >= 0 && motion.problem.empty())
          motion.problem = "point " + std::to_string(report.bad_point) +
                           " of the body '" + body.name +
                           "': " + report.bad_reason;
      }
    return motion;
  }



  template <int dim>
  void
  update_surfaces(std::vector<Surface<dim>> &surfaces,
                  PointTransfer<dim>        &transfer,
                  PointUpdate<dim>           update,
                  PointMotion               &motion)
  {
    update.material   = nullptr;
    update.projection = nullptr;
    update.apic       = false;
    update.taylor     = false;
    update.flip       = 0.;
    motion.left_surface_cells.resize(surfaces.size());
    for (unsigned int s = 0; s < surfaces.size(); ++s)
      {
        const PointReport report =
          transfer.grid_to_points(surfaces[s].points, update);
        if (update.move)
          motion.left_surface_cells[s] = report.left_cells;
        if (report.bad_point >= 0 && motion.problem.empty())
          motion.problem = "point " + std::to_string(report.bad_point) +
                           " of the surface of the load '" + surfaces[s].name +
                           "': " + report.bad_reason;
      }
  }



  template <int dim>
  void
  share_volume(State<dim> &state, PointTransfer<dim> &transfer, const double h)
  {
    state.time_to_share += state.step;
    if (state.n_steps % share_every != 0)
      return;
    for (Body<dim> &body : state.bodies)
      if (body.material->shares_volume() &&
          !body.points.layout().is_total_lagrangian())
        {
          const double c =
            std::sqrt(body.material->moduli().bulk / body.material->density);
          transfer.share_volume(body.points,
                                -std::expm1(-share_rate * c *
                                            state.time_to_share / h));
        }
    state.time_to_share = 0.;
  }



  GREVILLE_INSTANTIATE(stop_points);
  GREVILLE_INSTANTIATE(update_points);
  GREVILLE_INSTANTIATE(update_surfaces);
  GREVILLE_INSTANTIATE(share_volume);
} // namespace greville
