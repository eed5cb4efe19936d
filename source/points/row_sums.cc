// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_transfer.h>
#include <greville/points/row_sums.h>

#include "group_lanes.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  void
  OuterPoints::drop()
  {
    std::sort(points.begin(), points.end(), [](const auto &a, const auto &b) {
      return a.first > b.first;
    });
    kept          = 0.;
    std::size_t n = 0;
    while (n < points.size() && kept < needed)
      kept += points[n++].second;
    points.resize(n);
    threshold = points.back().first;
  }



  namespace
  {
    inline void
    add_to(std::array<double, n_lanes> &sum, const Lanes &value)
    {
      (lanes_at(sum.data()) + value)
        .copy_to(sum.data(), std::experimental::element_aligned);
    }



    inline Lanes
    used_lanes(const unsigned int count)
    {
      Lanes result;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        result[lane] = lane < count ? 1. : 0.;
      return result;
    }



    template <int dim>
    Tensor<2, dim>
    deformation_since_reference(const ConstPointRef<dim> p,
                                const PointLayout<dim>  &layout)
    {
      const Tensor<2, dim> F = p.matrix(PointLayout<dim>::F);
      return layout.initial_F > 0 ? F * invert(p.matrix(layout.initial_F)) : F;
    }
  } // namespace



  template <int dim>
  RowSums<dim>::RowSums(const Material *material,
                        const double    runout_above,
                        const double    outer_mass)
    : material(material)
    , runout_above(runout_above)
    , has_outer(outer_mass > 0.)
    , outer(outer_mass)
  {}



  template <int dim>
  void
  RowSums<dim>::add_group(const MaterialPoints<dim> &points,
                          const double              *group,
                          const unsigned int         count)
  {
    using Layout     = PointLayout<dim>;
    const Lanes used = used_lanes(count);
    const Lanes m    = used * lanes_at(group + Layout::mass * n_lanes);
    const Lanes V0   = used * lanes_at(group + Layout::volume0 * n_lanes);
    Lanes       x[dim];
    lanes_at(group, Layout::position, x);
    n_points += count;
    add_to(mass, m);
    for (unsigned int d = 0; d < dim; ++d)
      add_to(first_moment[d], m * x[d]);
    if (material)
      {
        MaterialLanes lanes = make_material_lanes<dim>(points.layout());
        load_material_lanes<dim>(points.layout(), group, count, lanes);
        lanes.stress.fill(0.);
        for (unsigned int k = 0; k < Layout::n_stress; ++k)
          lanes.stress[k] = lanes_at(group + (Layout::stress + k) * n_lanes);
        const EnergyLanes energies = material->energies(lanes);
        Lanes w = V0 * energies.strain, heat = V0 * energies.dissipation;
        where(used < 1., w)    = 0.;
        where(used < 1., heat) = 0.;
        add_to(strain, w);
        add_to(dissipation, heat);
      }

    // In 3D, compute a bound of the cubic root: its tangent at any s, V^(1/3)
    // <= (2 s + V / s^2) / 3.
    Lanes V = V0 * lanes_at(group + Layout::J * n_lanes);
    if (points.layout().is_axisymmetric())
      V /= x[0];
    Lanes half;
    if constexpr (dim == 2)
      half = 0.5 * sqrt(V);
    else
      {
        if (typical_size == 0.)
          typical_size = std::cbrt(double(V[0]));
        half = (2. * typical_size + V / (typical_size * typical_size)) / 6. *
               (1. + 1e-14);
      }
    const auto exact_half = [&](const unsigned int lane) {
      return dim == 2 ? double(half[lane]) : 0.5 * std::cbrt(double(V[lane]));
    };
    const Lanes right = x[0] + half, top = x[1] + half;
    const auto  is_above = used > 0. && x[1] > runout_above;
    if (!none_of(is_above))
      {
        Lanes above             = m;
        where(!is_above, above) = 0.;
        mass_above += reduce(above);
        const double smallest_counted_edge =
          has_outer ? std::min(runout.value, outer.smallest()) : runout.value;
        if (!none_of(is_above && !(right <= smallest_counted_edge)))
          for (unsigned int lane = 0; lane < count; ++lane)
            if (is_above[lane] && !(right[lane] <= smallest_counted_edge))
              {
                const double edge = x[0][lane] + exact_half(lane);
                runout.add(edge);
                if (has_outer && edge >= outer.smallest())
                  outer.add(edge, m[lane]);
              }
      }
    if (!none_of(used > 0. && top > height.value))
      for (unsigned int lane = 0; lane < count; ++lane)
        if (top[lane] > height.value)
          height.add(x[1][lane] + exact_half(lane));
  }



  template <int dim>
  void
  RowSums<dim>::add_motion(const double      *group,
                           const unsigned int count,
                           const double      *velocities,
                           const double      *affine,
                           const double      *spread,
                           const double      *deformation)
  {
    using Layout = PointLayout<dim>;
    const Lanes m =
      used_lanes(count) * lanes_at(group + Layout::mass * n_lanes);
    Lanes x[dim], v[dim];
    lanes_at(group, Layout::position, x);
    lanes_at(velocities, 0, v);
    Lanes square = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        square += v[d] * v[d];
        add_to(momentum[d], m * v[d]);
      }
    Lanes speed           = square;
    where(m <= 0., speed) = 0.;
    max(lanes_at(square_of_speed.data()), speed)
      .copy_to(square_of_speed.data(), std::experimental::element_aligned);

    Lanes spins[n_spins];
    if constexpr (dim == 2)
      spins[0] = x[0] * v[1] - x[1] * v[0];
    else
      for (unsigned int i = 0; i < 3; ++i)
        spins[i] =
          x[(i + 1) % 3] * v[(i + 2) % 3] - x[(i + 2) % 3] * v[(i + 1) % 3];
    if (affine)
      {
        // Compute C : (C D), and the skew part of F D C^T.
        Lanes B[dim][dim];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            {
              const Lanes c = lanes_at(affine + (i * dim + j) * n_lanes);
              B[i][j]       = c * lanes_at(spread + j * n_lanes);
              square += c * B[i][j];
            }
        if (deformation)
          {
            Lanes FB[dim][dim]; // F B^T, transposed
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                {
                  FB[i][j] = 0.;
                  for (unsigned int k = 0; k < dim; ++k)
                    FB[i][j] +=
                      B[i][k] * lanes_at(deformation + (j * dim + k) * n_lanes);
                }
            std::copy_n(FB[0], dim * dim, B[0]);
          }
        if constexpr (dim == 2)
          spins[0] += B[1][0] - B[0][1];
        else
          for (unsigned int i = 0; i < 3; ++i)
            spins[i] +=
              B[(i + 2) % 3][(i + 1) % 3] - B[(i + 1) % 3][(i + 2) % 3];
      }
    for (unsigned int i = 0; i < n_spins; ++i)
      add_to(angular_momentum[i], m * spins[i]);
    add_to(kinetic, 0.5 * m * square);
  }



  template <int dim>
  void
  RowSums<dim>::add(const MaterialPoints<dim> &points,
                    const PointTransfer<dim>  *transfer)
  {
    const PointField *field            = points.layout().find("affine");
    const bool        is_total         = points.layout().is_total_lagrangian();
    double            D[dim * n_lanes] = {}, F[dim * dim * n_lanes] = {};
    for (const unsigned int cell : points.cells())
      {
        unsigned int count = points.n_in_first_group(cell);
        for (unsigned int g = points.first_group(cell);
             g != MaterialPoints<dim>::none;
             g = points.next_group(g), count = n_lanes)
          {
            const double *group = points.group(g);
            add_group(points, group, count);
            if (!transfer)
              continue;
            const double *const v =
              group + PointLayout<dim>::velocity * n_lanes;
            if (!field)
              {
                add_motion(group, count, v);
                continue;
              }
            for (unsigned int lane = 0; lane < count; ++lane)
              {
                const auto diagonal = transfer->spread(
                  cell, points.point(g, lane).basis_position(points.layout()));
                for (unsigned int d = 0; d < dim; ++d)
                  D[d * n_lanes + lane] = diagonal[d];
                if (!is_total)
                  continue;
                const auto deformation =
                  deformation_since_reference(points.point(g, lane),
                                              points.layout());
                for (unsigned int k = 0; k < dim * dim; ++k)
                  F[k * n_lanes + lane] = deformation[k / dim][k % dim];
              }
            add_motion(group,
                       count,
                       v,
                       group + field->first * n_lanes,
                       D,
                       is_total ? F : nullptr);
          }
      }
  }



  GREVILLE_INSTANTIATE_CLASS(RowSums);
} // namespace greville
