// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/material_lanes.h>
#include <greville/points/material_points.h>
#include <greville/points/point_material.h>
#include <greville/points/point_update.h>

#include <cmath>

/// Conversion of groups of points to MaterialLanes. To be included in sources.
namespace greville
{
  namespace internal
  {
    static_assert(n_lanes == MaterialPoints<2>::width, "Groups fill lanes.");

    inline Lanes
    lanes_at(const double *address)
    {
      return greville::load<Lanes>(address);
    }



    template <int n>
    inline void
    lanes_at(const double *group, const unsigned int first, Lanes (&values)[n])
    {
      for (int k = 0; k < n; ++k)
        values[k] = lanes_at(group + (first + k) * n_lanes);
    }



    /// Return MaterialLanes with the numbers that all groups share.
    template <int dim>
    inline MaterialLanes
    make_material_lanes(const PointLayout<dim> &layout)
    {
      MaterialLanes points;
      points.n_state = layout.n_state;
      points.state.resize(layout.n_state);
      points.F.fill(0.);
      for (unsigned int i = 0; i < 9; ++i)
        points.increment[i] = i % 4 == 0 ? 1. : 0.;
      return points;
    }



    /// Load a group, without the stress, into the lanes of
    /// make_material_lanes(), see load_material_point().
    template <int dim>
    inline void
    load_material_lanes(const PointLayout<dim> &layout,
                        const double           *group,
                        const unsigned int      count,
                        MaterialLanes          &points)
    {
      using Layout      = PointLayout<dim>;
      const auto number = [&](const unsigned int k) {
        return lanes_at(group + k * n_lanes);
      };
      points.count = count;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          points.F[3 * i + j] = number(Layout::F + Layout::F_index(i, j));
      points.F[8]         = number(Layout::F + Layout::F_index(2, 2));
      const bool is_plane = dim == 2 && !layout.is_axisymmetric();
      points.J            = number(Layout::J);
      if (layout.projected_J != 0)
        {
          const Lanes J     = number(layout.projected_J);
          const Lanes ratio = J / points.J;
          Lanes       factor;
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            factor[lane] = lane < count ? (is_plane ? std::sqrt(ratio[lane])
                                                    : std::cbrt(ratio[lane]))
                                        : 1.;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              points.F[3 * i + j] *= factor;
          if (dim == 2 && !is_plane)
            points.F[8] *= factor;
          points.J = J;
          for (unsigned int lane = count; lane < n_lanes; ++lane)
            points.J[lane] = 1.;
        }
      for (unsigned int k = 0; k < layout.n_state; ++k)
        points.state[k] = number(Layout::state + k);
    }



    /// Store the results of Material::update_lanes().
    template <int dim>
    inline void
    store_material_lanes(const MaterialLanes    &points,
                         const PointLayout<dim> &layout,
                         double                 *group)
    {
      using Layout        = PointLayout<dim>;
      const auto store_at = [&](const unsigned int k, const Lanes &value) {
        store(value, group + k * n_lanes);
      };
      for (unsigned int k = 0; k < Layout::n_stress; ++k)
        store_at(Layout::stress + k, points.stress[k]);
      // Empty lanes have no modulus.
      Lanes modulus = points.wave_modulus;
      for (unsigned int lane = points.count; lane < n_lanes; ++lane)
        modulus[lane] = 0.;
      store_at(Layout::wave_modulus, modulus);
      for (unsigned int k = 0; k < layout.n_state; ++k)
        store_at(layout.state + k, points.state[k]);
    }


    /// Update a group of points by its material, with make_material_lanes().
    /// The increment of F_zz is used in 2D. Returns whether the first @p count
    /// points are valid.
    template <int dim>
    inline bool
    update_material(MaterialPoints<dim> &points,
                    const unsigned int   g,
                    const unsigned int   count,
                    const Lanes (&increment)[dim][dim],
                    const Lanes            &hoop_increment,
                    const PointUpdate<dim> &update,
                    MaterialLanes          &lanes)
    {
      const PointLayout<dim> &layout = points.layout();
      if (update.material->has_lanes())
        {
          load_material_lanes<dim>(layout, points.group(g), count, lanes);
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              lanes.increment[3 * i + j] = increment[i][j];
          if (dim == 2)
            lanes.increment[8] = hoop_increment;
          lanes.dt                 = update.step;
          lanes.strength_reduction = update.strength_reduction;
          update.material->update_lanes(lanes);
          store_material_lanes<dim>(lanes, layout, points.group(g));
          Lanes sum = 0.;
          for (const Lanes &stress : lanes.stress)
            sum += stress;
          return all_of(lanes.J > 0.) && all_of(isfinite(sum));
        }

      MaterialPoint states[n_lanes];
      for (unsigned int lane = 0; lane < count; ++lane)
        {
          MaterialPoint &state = states[lane];
          load_material_point<dim>(points.point(g, lane), layout, state);
          state.dt                 = update.step;
          state.time               = update.time;
          state.strength_reduction = update.strength_reduction;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              state.increment[i][j] = increment[i][j][lane];
          if (dim == 2)
            state.increment[2][2] = hoop_increment[lane];
        }
      update.material->update(dealii::ArrayView<MaterialPoint>(states, count));

      bool good = true;
      for (unsigned int lane = 0; lane < count; ++lane)
        {
          const MaterialPoint &state = states[lane];
          store_material_point<dim>(state, points.point(g, lane), layout);
          double sum = 0.;
          for (unsigned int k = 0; k < state.stress.n_independent_components;
               ++k)
            sum += state.stress.access_raw_entry(k);
          good = good && state.J > 0. && std::isfinite(sum);
        }
      return good;
    }
  } // namespace internal
} // namespace greville
