// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "group_lanes.h"
#include "group_update.h"

/// Deformation of groups of points, and update of their material. To be
/// included in sources.
namespace greville
{
  namespace internal
  {
    /// Return an upper bound of the squared ratio of wave speeds in the
    /// reference configuration to the current wave speeds, from F^-1: the
    /// largest absolute row sum of F^-1 F^-T.
    template <int dim>
    inline Simd
    square_of_stretch(const Simd (&inverse)[dim][dim])
    {
      Simd B[dim][dim], largest = 0.;
      multiply_transposed<dim>(inverse, inverse, B);
      for (int i = 0; i < dim; ++i)
        {
          Simd sum = 0.;
          for (int j = 0; j < dim; ++j)
            sum += abs(B[i][j]);
          largest = max(largest, sum);
        }
      return largest;
    }



    /// Set F_zz of axisymmetric points to r / radius0, and return its growth
    /// factor.
    template <int dim>
    inline Simd
    stretch_hoop(const PointLayout<dim> &layout, double *group)
    {
      using Layout = PointLayout<dim>;
      double *const F =
        group + (Layout::F + Layout::F_index(2, 2)) * simd_width;
      const Simd before = load(F);
      const Simd after  = load(group + Layout::position * simd_width) /
                         load(group + layout.radius0 * simd_width);
      store(after, F);
      return after / before;
    }



    /// Update F = (1 + dt grad w) F and J. Returns the increment 1 + dt grad w,
    /// and its component zz in @p hoop.
    template <int dim>
    inline __attribute__((always_inline)) Simd
    deform(const PointLayout<dim> &layout,
           const Group<dim>       &group,
           const Simd (&gradient)[dim][dim],
           const double step,
           Simd (&increment)[dim][dim],
           Simd &hoop,
           Simd &J)
    {
      using Layout = PointLayout<dim>;
      Simd F[dim][dim], new_F[dim][dim];
      hoop = layout.is_axisymmetric() ? stretch_hoop<dim>(layout, group.numbers)
                                      : Simd(1.);
      for (int i = 0; i < dim; ++i)
        {
          load_numbers<dim>(group.numbers, Layout::F + i * dim, F[i]);
          for (int j = 0; j < dim; ++j)
            increment[i][j] =
              step * group.is_used * gradient[i][j] + (i == j ? 1. : 0.);
        }
      multiply<dim>(increment, F, new_F);
      for (int i = 0; i < dim; ++i)
        store_numbers<dim>(new_F[i], Layout::F + i * dim, group.numbers);
      Simd det =
        increment[0][0] * increment[1][1] - increment[0][1] * increment[1][0];
      if constexpr (dim == 3)
        det = det * increment[2][2] +
              increment[0][1] * increment[1][2] * increment[2][0] +
              increment[0][2] * increment[1][0] * increment[2][1] -
              increment[0][2] * increment[1][1] * increment[2][0] -
              increment[0][0] * increment[1][2] * increment[2][1];
      if (layout.is_axisymmetric())
        det *= hoop;
      J = det * load(group.numbers + Layout::J * simd_width);
      store(J, group.numbers + Layout::J * simd_width);
      return det;
    }



    /// Set the projected J of a group, and scale the increment so that its
    /// determinant is the change of the projected J instead of @p det.
    /// @p projected contains a J for each point, or is null.
    template <int dim>
    __attribute__((noinline)) void
    project(const PointLayout<dim> &layout,
            const Group<dim>       &group,
            const Simd             &J,
            const Simd             &det,
            const double          *&projected,
            Simd (&increment)[dim][dim],
            Simd &hoop)
    {
      double    *address = group.numbers + layout.projected_J * simd_width;
      const Simd before  = load(address);
      Simd       after = J, factor = 1.;
      for (unsigned int lane = 0; lane < group.count; ++lane)
        {
          if (projected)
            after[lane] = *projected++;
          const double ratio = after[lane] / before[lane] / det[lane];
          factor[lane]       = dim == 2 && !layout.is_axisymmetric()
                                 ? std::sqrt(ratio)
                                 : std::cbrt(ratio);
        }
      if (layout.is_axisymmetric())
        hoop *= factor;
      store(after, address);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          increment[i][j] *= factor;
    }



    /// Return the square of the speed of pressure waves, modulus / density.
    template <int dim>
    inline __attribute__((always_inline)) Simd
    square_of_wave_speed(const Group<dim> &group, const Simd &J)
    {
      using Layout      = PointLayout<dim>;
      Simd m            = load(group.numbers + Layout::mass * simd_width);
      where(m <= 0., m) = 1.;
      // Divide by the mass first: the division need not wait for the results of
      // the material.
      const Simd v0 = load(group.numbers + Layout::volume0 * simd_width) / m;
      return load(group.numbers + Layout::wave_modulus * simd_width) * (J * v0);
    }



    /// Deform a group, and update its material.
    template <int dim>
    inline __attribute__((always_inline)) void
    deform_and_stress(MaterialPoints<dim>    &points,
                      const PointUpdate<dim> &update,
                      const Group<dim>       &group,
                      const Simd (&grid_gradient)[dim][dim],
                      const bool        is_total,
                      const double    *&projected,
                      MaterialLanes    &lanes,
                      PointTotals<dim> &totals,
                      PointReport      &report)
    {
      const PointLayout<dim> &layout = points.layout();
      Simd increment[dim][dim], hoop, J, det, inverse[dim][dim];
      if (is_total)
        {
          Simd gradient[dim][dim];
          load_inverse_F<dim>(group.numbers, layout.initial_F, inverse);
          multiply<dim>(grid_gradient, inverse, gradient);
          det = deform<dim>(
            layout, group, gradient, update.step, increment, hoop, J);
        }
      else
        det = deform<dim>(
          layout, group, grid_gradient, update.step, increment, hoop, J);
      Simd used_J                       = J;
      where(group.is_used < 1., used_J) = 1.;
      totals.smallest_J                 = min(totals.smallest_J, used_J);
      totals.largest_J                  = max(totals.largest_J, used_J);
      if (layout.projected_J != 0)
        project<dim>(layout, group, J, det, projected, increment, hoop);
      if ((update.material && !update_material(points,
                                               group.number,
                                               group.count,
                                               increment,
                                               hoop,
                                               update,
                                               lanes)) ||
          !all_of(used_J > 0.))
        report_bad_point(points, group, report);

      Simd v[dim], v2 = 0., c2 = square_of_wave_speed<dim>(group, J);
      if (is_total)
        c2 *= square_of_stretch<dim>(inverse);
      else
        {
          load_numbers<dim>(group.numbers, PointLayout<dim>::velocity, v);
          for (int i = 0; i < dim; ++i)
            v2 += v[i] * v[i];
        }
      totals.fastest_wave = max(totals.fastest_wave, sqrt(c2));
      totals.fastest      = max(totals.fastest, sqrt(c2) + sqrt(v2));
    }
  } // namespace internal
} // namespace greville
