// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/stiffness/tangent_bodies.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TangentBodies<dim>::TangentBodies(const SplineSpace<dim> &space,
                                    VolumeProjection<dim>  *projection,
                                    CellWindows<dim>       *windows)
    : space(space)
    , projection(projection)
    , windows(windows)
  {
    trial.reinit(space, windows);
    sums.reinit(space, windows);
    K.reinit(space);
  }



  namespace
  {
    /// Return the sums of the compression and shear moduli, A_iiii and A_ijij,
    /// times the volumes.
    template <int dim>
    std::array<double, 2>
    sum_moduli(const std::vector<TrialGroup<dim>> &groups)
    {
      Lanes compression = 0., shear = 0.;
      for (const TrialGroup<dim> &group : groups)
        {
          compression += group.compression;
          shear += group.shear;
        }
      return {{reduce(compression), reduce(shear)}};
    }



    /// Append the derivative of V P of a group by the logarithm of J hat, for
    /// an isotropic expansion of 1 / dim in each direction (1 / 3 in
    /// axisymmetry). The dependence of f on J hat is excluded. A share of the
    /// derivative remains in the derivative by f, a full matrix of @p n_used
    /// pairs.
    template <int dim>
    void
    take_volume_stiffness(const int           n_used,
                          TrialGroup<dim>    &group,
                          ProjectedBody<dim> &projected)
    {
      const double n    = n_used == TrialGroup<dim>::n_pairs ? 3 : 2;
      const double rest = 1. - projected.share;
      typename TrialGroup<dim>::Pairs derivative;
      derivative.fill(0.);
      for (int r = 0; r < n_used; ++r)
        {
          double *row = group.tangent + r * n_used * n_lanes;
          Lanes   sum = (1. - n) * group.stress[r];
          for (int s = 0; s < n_used; ++s)
            sum += load<Lanes>(row + s * n_lanes) * group.expansion[s];
          sum *= 1. / n;
          for (int s = 0; s < n_used; ++s)
            store(Lanes(load<Lanes>(row + s * n_lanes) -
                        rest * sum * group.dual[s]),
                  row + s * n_lanes);
          if (r < dim * dim)
            group.compression -= rest / dim * sum * group.expansion[r];
          derivative[r] = sum;
        }
      projected.derivatives.push_back(derivative);
    }



    /// Return the fraction of the volumetric stiffness that is not much larger
    /// than the shear stiffness.
    double
    share_of_volume_stiffness(const Moduli &moduli)
    {
      constexpr double largest_ratio = 2.;
      return moduli.shear > 0.
               ? std::min(1., largest_ratio * moduli.shear / moduli.bulk)
               : 1.;
    }
  } // namespace



  template <int dim>
  void
  TangentBodies<dim>::begin_tangents(const std::vector<TrialBody<dim>> &bodies,
                                     const StepStress                   stress,
                                     BlockStencil<dim, double>         *entries)
  {
    plastic_flow =
      std::any_of(bodies.begin(), bodies.end(), [](const TrialBody<dim> &body) {
        return !body.material->has_symmetric_tangent();
      });
    const bool are_symmetric =
      stress == StepStress::end && !projection && !plastic_flow;
    K.clear(are_symmetric,
            !bodies.empty() && bodies[0].points->layout().is_axisymmetric());
    const bool assembles = entries && are_symmetric,
               keeps     = !assembles || windows;
    if (assembles)
      {
        entries->clear();
        K.sum_at_once(
          [entries](const unsigned int cell,
                    const double      *values,
                    const unsigned int stride) {
            entries->add_cell(cell, values, stride);
          },
          keeps);
      }
    std::size_t n_groups = 0;
    for (const TrialBody<dim> &body : bodies)
      for (const unsigned int cell : body.points->cells())
        {
          const std::size_t of_cell =
            (body.points->n_points(cell) + MaterialPoints<dim>::width - 1) /
            MaterialPoints<dim>::width;
          n_groups = keeps ? n_groups + of_cell : std::max(n_groups, of_cell);
        }
    K.reserve(n_groups);
  }



  template <int dim>
  std::string
  TangentBodies<dim>::evaluate(const std::vector<TrialBody<dim>> &bodies,
                               const VectorField<dim>            &u,
                               const double                       dt,
                               const StepStress                   stress,
                               const bool                 with_stiffness,
                               BlockStencil<dim, double> *entries,
                               VectorField<dim>          &force)
  {
    std::string problem;
    // Sums over cells of the compression and shear moduli of K, see
    // sum_moduli(), and of the square of each cell's compression modulus before
    // take_volume_stiffness().
    std::vector<double> all_moduli(3);
    sums.clear();
    if (with_stiffness)
      {
        begin_tangents(bodies, stress, entries);
        if (projection)
          displacement = u;
        projected_bodies.clear();
        domains.clear();
      }
    for (const TrialBody<dim> &body : bodies)
      {
        PointReport        report;
        ProjectedBody<dim> projected{body.points,
                                     share_of_volume_stiffness(
                                       body.material->moduli()),
                                     {},
                                     {}};
        if (projection)
          projected.J_hat = projection->project(*body.points, u, 1.);
        // A law may throw on one process; all processes then continue with the
        // next body.
        try
          {
            report =
              trial.evaluate(*body.points,
                             *body.material,
                             u,
                             dt,
                             body.time,
                             body.strength_reduction,
                             stress,
                             with_stiffness ? &K : nullptr,
                             projection ? projected.J_hat.data() : nullptr,
                             [&](const unsigned int cell, auto &groups) {
                               sums.add_force(cell, groups);
                               if (!with_stiffness)
                                 return;
                               auto of_cell = sum_moduli<dim>(groups);
                               all_moduli[2] += of_cell[0] * of_cell[0];
                               if (projection)
                                 {
                                   for (TrialGroup<dim> &group : groups)
                                     take_volume_stiffness(K.n_pairs(),
                                                           group,
                                                           projected);
                                   of_cell = sum_moduli<dim>(groups);
                                 }
                               all_moduli[0] += of_cell[0];
                               all_moduli[1] += of_cell[1];
                               if (windows && windows->reaches(cell))
                                 domains.emplace_back(cell, groups);
                             });
          }
        catch (const std::exception &error)
          {
            if (problem.empty())
              problem = "the law of the body '" + body.name +
                        "' has failed: " + message_of(error);
          }
        if (report.bad_point >= 0 && problem.empty())
          problem = "point " + std::to_string(report.bad_point) +
                    " of the body '" + body.name + "': " + report.bad_reason;
        if (with_stiffness && projection)
          projected_bodies.push_back(std::move(projected));
      }
    sums.take_force(force);
    if (with_stiffness)
      {
        Utilities::MPI::sum(all_moduli, space.communicator(), all_moduli);
        sums_of_moduli  = {{all_moduli[0], all_moduli[1]}};
        force_of_strain = std::sqrt(all_moduli[2]) / space.smallest_cell_size();
      }
    return problem;
  }



  template <int dim>
  void
  TangentBodies<dim>::multiply_rest(VectorField<dim>       &force,
                                    const VectorField<dim> &direction)
  {
    sums.clear();
    if (windows)
      {
        windows->read(direction, window_buffer);
        for (const auto &of_cell : domains)
          sums.add_change(of_cell.first, of_cell.second, K, window_buffer);
      }
    std::vector<TrialGroup<dim>> groups;
    for (const ProjectedBody<dim> &body : projected_bodies)
      {
        const MaterialPoints<dim> &points = *body.points;
        const double              *change = projection
                                 ->differentiate(points,
                                                 displacement,
                                                 direction,
                                                 body.J_hat,
                                                 body.share)
                                 .data();
        const auto *derivative = body.derivatives.data();
        for (const unsigned int cell : points.cells())
          {
            groups.clear();
            unsigned int count = points.n_in_first_group(cell);
            for (unsigned int g = points.first_group(cell); g != points.none;
                 g = points.next_group(g), count = n_lanes, ++derivative)
              {
                TrialGroup<dim> &group  = groups.emplace_back();
                Lanes            factor = 0.;
                for (unsigned int lane = 0; lane < count; ++lane)
                  factor[lane] = *change++;
                const double *x =
                  points.group(g) + points.layout().basis_position * n_lanes;
                for (unsigned int d = 0; d < dim; ++d)
                  group.x[d] = load<Lanes>(x + d * n_lanes);
                for (unsigned int r = 0; r < group.stress.size(); ++r)
                  group.stress[r] = factor * (*derivative)[r];
              }
            sums.add_force(cell, groups);
          }
      }
    sums.take_force(force);
  }



  template <int dim>
  double
  TangentBodies<dim>::force_scale() const
  {
    return std::sqrt(
      Utilities::MPI::sum(sums.square_of_forces(), space.communicator()));
  }



  GREVILLE_INSTANTIATE_CLASS(TangentBodies);
} // namespace greville
