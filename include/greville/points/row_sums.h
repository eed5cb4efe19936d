// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/material.h>
#include <greville/points/material_points.h>

#include <limits>
#include <utility>
#include <vector>

namespace greville
{
  template <int dim>
  class PointTransfer;

  /// The largest of the numbers that have been added; 0 if there are none.
  struct Largest
  {
    static constexpr double none = std::numeric_limits<double>::lowest();

    Largest(const double value = none)
      : value(value)
    {}

    void
    add(const Largest other)
    {
      value = value < other.value ? other.value : value;
    }

    operator double() const
    {
      return value == none ? 0. : value;
    }

    double value;
  };



  /// The points with the largest edges x (m), an edge being the position plus
  /// half of the size. Their total mass is at least @p needed (kg; 2D: kg / m),
  /// or they are all points. Only few points are stored at a time.
  class OuterPoints
  {
  public:
    explicit OuterPoints(
      const double needed = std::numeric_limits<double>::max())
      : needed(needed)
    {}

    /// Return the edge below which points are not needed.
    double
    smallest() const
    {
      return threshold;
    }

    void
    add(const double edge, const double mass)
    {
      points.emplace_back(edge, mass);
      kept += mass;
      if (kept > 2. * needed && points.size() > 64)
        drop();
    }

    /// Return edges and masses.
    const std::vector<std::pair<double, double>> &
    get() const
    {
      return points;
    }

  private:
    void
    drop();

    std::vector<std::pair<double, double>> points;
    double                                 needed, kept = 0.;
    double threshold = std::numeric_limits<double>::lowest();
  };



  /// Sums and extremes over the points of a body on this process, for a row of
  /// statistics. Units: kg, m, s, J; in 2D per metre of thickness. Each group
  /// of points is added by add_group() before a step changes it, and by
  /// add_motion() with its velocities at the time of the row.
  template <int dim>
  class RowSums
  {
  public:
    static constexpr unsigned int width   = MaterialPoints<dim>::width;
    static constexpr unsigned int n_spins = dim == 2 ? 1 : 3;

    /// One number for each lane.
    using Lane = std::array<double, width>;

    /// Energies are computed for the @p material, and omitted if it is null.
    /// Only points with y above @p runout_above count for the run-out.
    /// outer_points() collects the outermost of these points up to the mass
    /// @p outer_mass, see OuterPoints; none if the mass is 0.
    RowSums(const Material *material  = nullptr,
            const double runout_above = std::numeric_limits<double>::lowest(),
            const double outer_mass   = 0.);

    /// Add the quantities that depend on positions, stresses and history. The
    /// first @p count lanes contain points.
    void
    add_group(const MaterialPoints<dim> &points,
              const double              *group,
              const unsigned int         count);

    /// Add the quantities that depend on velocities @p v (dim x width), and
    /// with APIC and Taylor on the affine matrices @p C (dim x dim x width) and
    /// the diagonals @p D of PointTransfer::spread() (dim x width). In total
    /// Lagrangian steps, both belong to reference positions, from which @p F
    /// (dim x dim x width) is the deformation; null otherwise.
    void
    add_motion(const double      *group,
               const unsigned int count,
               const double      *v,
               const double      *C = nullptr,
               const double      *D = nullptr,
               const double      *F = nullptr);

    /// Add all points in their current state. If @p transfer is null,
    /// quantities that depend on velocities are omitted.
    void
    add(const MaterialPoints<dim> &points,
        const PointTransfer<dim>  *transfer = nullptr);

    const OuterPoints &
    outer_points() const
    {
      return outer;
    }

    std::uint64_t n_points = 0;
    /// Sums by lane.
    Lane                      mass{}, kinetic{}, strain{}, dissipation{};
    std::array<Lane, dim>     momentum{}, first_moment{};
    std::array<Lane, n_spins> angular_momentum{};
    Lane                      square_of_speed{};
    Largest                   runout, height;
    /// The mass of the points that count for the run-out.
    double mass_above = 0.;

    static double
    sum(const Lane &lane)
    {
      return (lane[0] + lane[1]) + (lane[2] + lane[3]);
    }

  private:
    const Material *material;
    double          runout_above;
    bool            has_outer;
    OuterPoints     outer;
    double          typical_size = 0.; // m
  };
} // namespace greville
