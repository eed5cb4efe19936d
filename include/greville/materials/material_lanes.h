// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/lanes.h>
#include <greville/materials/material.h>

namespace greville
{
  /// Several points at once, see MaterialPoint for the units. Lanes without a
  /// point are stress-free. Energies do not depend on the last four members.
  struct MaterialLanes
  {
    MaterialLanes() = default;

    explicit MaterialLanes(const MaterialPoint &point)
      : MaterialLanes(&point, 1)
    {}

    /// Copy @p count points into the first lanes, and the last of these points
    /// into the other lanes.
    MaterialLanes(const MaterialPoint *points, const unsigned int count)
      : count(count)
      , n_state(History<double>::n_first + points->state.more.size())
      , dt(points->dt)
      , strength_reduction(points->strength_reduction)
    {
      const auto lanes_of = [&](const auto &number) {
        return Lanes([&](const auto lane) {
          return number(points[std::min<unsigned int>(lane, count - 1)]);
        });
      };
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          {
            F[3 * i + j] = lanes_of(
              [&](const MaterialPoint &point) { return point.F[i][j]; });
            increment[3 * i + j] = lanes_of([&](const MaterialPoint &point) {
              return point.increment[i][j];
            });
          }
      J = lanes_of([](const MaterialPoint &point) { return point.J; });
      for (unsigned int i = 0; i < 6; ++i)
        stress[i] = lanes_of([&](const MaterialPoint &point) {
          return point.stress.access_raw_entry(i);
        });
      state.resize(n_state);
      for (unsigned int k = 0; k < n_state; ++k)
        state[k] =
          lanes_of([&](const MaterialPoint &point) { return point.state[k]; });
    }

    /// Copy the results of update_lanes() to the points.
    void
    write(MaterialPoint *points) const
    {
      for (unsigned int lane = 0; lane < count; ++lane)
        {
          MaterialPoint &point = points[lane];
          for (unsigned int i = 0; i < 6; ++i)
            point.stress.access_raw_entry(i) = stress[i][lane];
          for (unsigned int k = 0; k < n_state; ++k)
            point.state[k] = state[k][lane];
          point.wave_modulus = wave_modulus[lane];
        }
    }

    unsigned int count = n_lanes, n_state = 0;
    /// The deformation gradient, row by row.
    std::array<Lanes, 9> F;
    Lanes                J;
    /// The Cauchy stress: xx, yy, zz, xy, xz, yz.
    std::array<Lanes, 6> stress;
    /// The history. Its first n_state entries are used.
    History<Lanes> state;
    /// The increment of the deformation gradient, row by row.
    std::array<Lanes, 9> increment;
    double               dt = 0., strength_reduction = 1.;
    Lanes                wave_modulus;
  };



  /// Energies per volume of the stress-free state, J / m^3.
  struct EnergyLanes
  {
    Lanes strain = 0., dissipation = 0.;
  };



  /// A MaterialTangent of several points: D_ijkl is at [entry][3 k + l].
  /// Entries ij are xx, yy, zz, xy, xz, yz.
  using TangentLanes = std::array<std::array<Lanes, 9>, 6>;



  /// A Material that updates as many points at once as Lanes contain. A law
  /// implements update_lanes() and, for implicit steps, tangent_lanes(), which
  /// kernels call with their groups of points. It also implements energies() or
  /// strain_energy().
  class LanesMaterial : public Material
  {
  public:
    bool
    has_lanes() const final
    {
      return true;
    }

    void
    update_lanes(MaterialLanes &points) const override = 0;

    void
    update(const dealii::ArrayView<MaterialPoint> &points) const final
    {
      for (std::size_t first = 0; first < points.size(); first += n_lanes)
        {
          MaterialLanes lanes(points.begin() + first,
                              std::min<std::size_t>(n_lanes,
                                                    points.size() - first));
          update_lanes(lanes);
          lanes.write(points.begin() + first);
        }
    }

    /// Compute the derivatives of the stresses that update_lanes() returns,
    /// like tangents(). Columns with k or l >= @p dim are not set. The default
    /// uses central differences.
    virtual void
    tangent_lanes(const MaterialLanes &points,
                  TangentLanes        &D,
                  const unsigned int   dim) const
    {
      constexpr double difference = 0x1p-23; // see Material::tangents()
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          {
            for (const double change : {difference, -difference})
              {
                MaterialLanes moved = points;
                for (unsigned int j = 0; j < 3; ++j)
                  {
                    moved.increment[3 * k + j] +=
                      change * points.increment[3 * l + j];
                    moved.F[3 * k + j] += change * points.F[3 * l + j];
                  }
                if (k == l)
                  moved.J *= 1. + change;
                update_lanes(moved);
                for (unsigned int e = 0; e < 6; ++e)
                  D[e][3 * k + l] =
                    change > 0.
                      ? moved.stress[e]
                      : (D[e][3 * k + l] - moved.stress[e]) / (2. * difference);
              }
          }
    }

    void
    tangents(const dealii::ArrayView<const MaterialPoint> &points,
             const dealii::ArrayView<MaterialTangent>     &result,
             const unsigned int                            dim) const final
    {
      AssertThrow(points.size() == result.size(),
                  dealii::ExcDimensionMismatch(points.size(), result.size()));
      TangentLanes D;
      for (auto &row : D)
        row.fill(0.);
      for (std::size_t first = 0; first < points.size(); first += n_lanes)
        {
          const MaterialLanes lanes(
            points.begin() + first,
            std::min<std::size_t>(n_lanes, points.size() - first));
          tangent_lanes(lanes, D, dim);
          for (unsigned int lane = 0; lane < lanes.count; ++lane)
            for (unsigned int e = 0; e < 6; ++e)
              for (unsigned int kl = 0; kl < 9; ++kl)
                {
                  const unsigned int i = entry_rows[e], j = entry_columns[e];
                  MaterialTangent   &of_point = result[first + lane];
                  of_point[i][j][kl / 3][kl % 3] =
                    of_point[j][i][kl / 3][kl % 3] = D[e][kl][lane];
                }
        }
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      return energies(MaterialLanes(point)).strain[0];
    }
  };
} // namespace greville
