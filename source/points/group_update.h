// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/row_sums.h>

#include "point_kernels.h"
#include <cmath>
#include <sstream>

/// The parts of PointTransfer::grid_to_points() that do not depend on the basis
/// functions: kick and move a group of points. group_deformation.h deforms it.
/// To be included in sources.
namespace greville
{
  namespace internal
  {
    /// A pass over points. Kick changes velocities; deform changes F, J, stress
    /// and state, and positions if PointUpdate::move. Two fields are v and a of
    /// a kick; or w, which deforms points, and v, which moves them. The
    /// gradient of the first field is evaluated to deform points, and in kicks
    /// of Taylor.
    template <bool kick_,
              bool deform_,
              bool two_fields_,
              bool apic_,
              bool gradient_ = deform_>
    struct Pass
    {
      static constexpr bool kick       = kick_;
      static constexpr bool deform     = deform_;
      static constexpr bool two_fields = two_fields_;
      static constexpr bool apic       = apic_;
      static constexpr bool gradient   = gradient_;

      /// Number of the vector field that moves points, and number of fields.
      static constexpr int velocity = !kick && two_fields ? 1 : 0;
      static constexpr int n_fields = two_fields ? 2 : 1;
    };



    /// Fields of the grid at a group of points.
    template <int dim, typename Pass>
    struct GridValues
    {
      /// Positions at which the basis functions are evaluated.
      Simd x[dim];
      Simd fields[Pass::n_fields * dim];
      /// The gradient of the first field.
      Simd gradient[dim][dim];
      /// For APIC: sum_i N_i v_i (x_i - x)^T with the Greville points x_i, and
      /// the diagonal of sum_i N_i (x_i - x) (x_i - x)^T, which rows of Taylor
      /// need, too.
      Simd moments[dim][dim];
      Simd inertia[dim];
    };



    /// A group of points, and its cell.
    template <int dim>
    struct Group
    {
      unsigned int  cell, number;
      unsigned int  count; // of points
      Simd          is_used;
      double       *numbers;
      const double *center, *inverse_h;
    };



    /// Sums and extremes over points, see PointReport.
    template <int dim>
    struct PointTotals
    {
      Simd fastest = 0., fastest_wave = 0.;
      Simd mass = 0., crossed = 0.;
      Simd momentum[dim];
      Simd smallest_J = std::numeric_limits<double>::max(), largest_J = 0.;
      bool is_left = false; // the cell

      PointTotals()
      {
        std::fill_n(momentum, dim, Simd(0.));
      }

      void
      write(PointReport &report) const
      {
        report.fastest_signal = hmax(fastest);
        report.fastest_wave   = hmax(fastest_wave);
        report.sums.mass      = reduce(mass);
        for (int i = 0; i < dim; ++i)
          report.sums.momentum[i] = reduce(momentum[i]);
        report.sums.crossed    = hmax(crossed);
        report.sums.smallest_J = hmin(smallest_J);
        report.sums.largest_J  = hmax(largest_J);
      }
    };



    /// Describe the error of a point of a group, if it is the first one.
    template <int dim>
    void
    report_bad_point(const MaterialPoints<dim> &points,
                     const Group<dim>          &group,
                     PointReport               &report)
    {
      for (unsigned int lane = 0; lane < group.count && report.bad_point < 0;
           ++lane)
        {
          const ConstPointRef<dim> p   = points.point(group.number, lane);
          const double             J   = p.J();
          double                   sum = 0.;
          for (unsigned int k = 0; k < PointLayout<dim>::n_fixed; ++k)
            sum += p[k];
          if (J > 0. && std::isfinite(sum))
            continue;
          report.bad_point = std::int64_t(p.id());
          std::ostringstream reason;
          if (J <= 0.)
            reason << "its volume has become negative (J = " << J << ")";
          else
            reason << "its state is infinite or NaN (J = " << J << ", velocity "
                   << p.velocity(0) << " m/s in x)";
          reason << "; it is "
                 << describe_place<dim>(points.space(),
                                        group.cell,
                                        p.position(),
                                        "from");
          report.bad_reason = reason.str();
        }
    }



    /// Add the velocities of a group to a row, with APIC and Taylor also the
    /// affine matrices C and the diagonals D, and in total Lagrangian steps the
    /// deformation F. Velocities are interpolated between their old and new
    /// values.
    template <int dim>
    __attribute__((noinline)) void
    add_motion(const PointUpdate<dim> &update,
               const Group<dim>       &group,
               const Simd (&v)[dim],
               const unsigned int first_affine,
               const Simd (*C)[dim],
               const Simd *D,
               const Simd (*F)[dim] = nullptr)
    {
      const auto interpolate =
        [&](const Simd &after, const unsigned int number, double *result) {
          const Simd before = load(group.numbers + number * simd_width);
          store(before + update.row_fraction * (after - before), result);
        };
      double velocities[dim * simd_width];
      for (int i = 0; i < dim; ++i)
        interpolate(v[i],
                    PointLayout<dim>::velocity + i,
                    velocities + i * simd_width);
      if (!C)
        {
          update.row->add_motion(group.numbers, group.count, velocities);
          return;
        }
      double matrices[dim * dim * simd_width], diagonals[dim * simd_width],
        deformations[dim * dim * simd_width];
      for (int i = 0; i < dim; ++i)
        {
          for (int j = 0; j < dim; ++j)
            {
              const int k = (i * dim + j) * simd_width;
              interpolate(C[i][j], first_affine + i * dim + j, matrices + k);
              if (F)
                store(F[i][j], deformations + k);
            }
          store(D[i], diagonals + i * simd_width);
        }
      update.row->add_motion(group.numbers,
                             group.count,
                             velocities,
                             matrices,
                             diagonals,
                             F ? deformations : nullptr);
    }



    /// Add the velocities and velocity gradients of a group to a row.
    template <int dim, typename Pass>
    __attribute__((noinline)) void
    add_motion_of_taylor(const PointLayout<dim>      &layout,
                         const PointUpdate<dim>      &update,
                         const Group<dim>            &group,
                         const GridValues<dim, Pass> &grid,
                         const unsigned int           first_affine,
                         const Simd (&v)[dim])
    {
      Simd inverse[dim][dim], F[dim][dim], G[dim][dim];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          G[i][j] = group.is_used * grid.gradient[i][j];
      const bool is_total = layout.is_total_lagrangian();
      if (is_total)
        {
          load_inverse_F<dim>(group.numbers, layout.initial_F, inverse);
          invert<dim>(inverse, F);
        }
      add_motion<dim>(update,
                      group,
                      v,
                      first_affine,
                      G,
                      grid.inertia,
                      is_total ? F : nullptr);
    }



    /// Store the velocity gradient G of points at positions x + step v, for the
    /// gradient at x: G (1 + step G)^-1.
    template <int dim>
    __attribute__((noinline)) void
    store_gradient(const Group<dim> &group,
                   const Simd (&gradient)[dim][dim],
                   const double       step,
                   const unsigned int first_affine)
    {
      Simd G[dim][dim], increment[dim][dim], inverse[dim][dim];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            G[i][j]         = group.is_used * gradient[i][j];
            increment[i][j] = step * G[i][j] + (i == j ? 1. : 0.);
          }
      if (step != 0.)
        {
          Simd before[dim][dim];
          std::copy_n(G[0], dim * dim, before[0]);
          invert<dim>(increment, inverse);
          multiply<dim>(before, inverse, G);
        }
      for (int i = 0; i < dim; ++i)
        store_numbers<dim>(G[i], first_affine + i * dim, group.numbers);
    }



    /// v = flip (v + dt' a) + (1 - flip) v_grid
    template <int dim, typename Pass>
    inline __attribute__((always_inline)) void
    kick(const PointLayout<dim>      &layout,
         const PointUpdate<dim>      &update,
         const Group<dim>            &group,
         const GridValues<dim, Pass> &grid,
         const unsigned int           first_gradient,
         Simd (&v)[dim])
    {
      load_numbers<dim>(group.numbers, PointLayout<dim>::velocity, v);
      for (int i = 0; i < dim; ++i)
        v[i] =
          group.is_used *
          (update.flip * (v[i] + update.velocity_step * grid.fields[dim + i]) +
           (1. - update.flip) * grid.fields[i]);
      if (update.row)
        {
          if (first_gradient != 0)
            add_motion_of_taylor<dim>(
              layout, update, group, grid, first_gradient, v);
          else
            add_motion<dim>(update, group, v, 0, nullptr, nullptr);
        }
      store_numbers<dim>(v, PointLayout<dim>::velocity, group.numbers);
    }



    /// v = v_grid, C = moments D^-1
    template <int dim, typename Pass>
    inline __attribute__((always_inline)) void
    kick_affine(const PointUpdate<dim>      &update,
                const Group<dim>            &group,
                const GridValues<dim, Pass> &grid,
                const unsigned int           first_affine,
                Simd (&v)[dim])
    {
      Simd C[dim][dim], D[dim];
      for (int j = 0; j < dim; ++j)
        {
          const double smallest =
            1e-12 / (group.inverse_h[j] * group.inverse_h[j]);
          v[j]                         = group.is_used * grid.fields[j];
          D[j]                         = grid.inertia[j];
          where(D[j] < smallest, D[j]) = smallest;
          for (int i = 0; i < dim; ++i)
            C[i][j] = group.is_used * grid.moments[i][j] / D[j];
        }
      if (update.row)
        add_motion<dim>(update, group, v, first_affine, C, D);
      store_numbers<dim>(v, PointLayout<dim>::velocity, group.numbers);
      for (int i = 0; i < dim; ++i)
        store_numbers<dim>(C[i], first_affine + i * dim, group.numbers);
    }



    /// x += dt v_grid
    template <int dim, typename Pass>
    inline __attribute__((always_inline)) void
    move(const PointUpdate<dim>      &update,
         const Group<dim>            &group,
         const GridValues<dim, Pass> &grid,
         const bool                   is_total,
         const Simd (&v)[dim],
         PointTotals<dim> &totals)
    {
      using Layout = PointLayout<dim>;
      Simd x[dim];
      if (is_total)
        load_numbers<dim>(group.numbers, Layout::position, x);
      else
        std::copy_n(grid.x, dim, x);
      const Simd m =
        group.is_used * load(group.numbers + Layout::mass * simd_width);
      totals.mass += m;
      for (int i = 0; i < dim; ++i)
        {
          const Simd way =
            update.step * group.is_used * grid.fields[Pass::velocity * dim + i];
          totals.momentum[i] += m * v[i];
          totals.crossed = max(totals.crossed, abs(way) * group.inverse_h[i]);
          x[i] += way;
          const Simd t = (x[i] - group.center[i]) * group.inverse_h[i];
          totals.is_left =
            totals.is_left || (!is_total && !all_of(abs(t) < 0.5));
        }
      store_numbers<dim>(x, Layout::position, group.numbers);
    }
  } // namespace internal
} // namespace greville
