// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/state.h>

#include <optional>

namespace greville
{
  /// A copy of a state in half of the memory: its points are PointsCopy objects
  /// in single precision.
  template <int dim>
  class Snapshot
  {
  public:
    void
    take(const State<dim> &state)
    {
      rest = static_cast<const StateWithoutBodies<dim> &>(state);
      points.resize(state.bodies.size());
      n_points.resize(points.size());
      for (unsigned int b = 0; b < points.size(); ++b)
        {
          points[b].copy(state.bodies[b].points);
          n_points[b] = state.bodies[b].n_points;
        }
      surfaces.resize(state.surfaces.size());
      for (unsigned int s = 0; s < surfaces.size(); ++s)
        surfaces[s].copy(state.surfaces[s].points);
    }

    /// Overwrite a state of the same bodies and surfaces.
    void
    restore(State<dim> &state) const
    {
      Assert(rest, dealii::ExcNotInitialized());
      static_cast<StateWithoutBodies<dim> &>(state) = *rest;
      for (unsigned int b = 0; b < points.size(); ++b)
        {
          points[b].restore(state.bodies[b].points);
          state.bodies[b].n_points = n_points[b];
        }
      for (unsigned int s = 0; s < surfaces.size(); ++s)
        surfaces[s].restore(state.surfaces[s].points);
      state.points_have_changed();
    }

    unsigned int
    stage() const
    {
      return rest->stage;
    }

    /// Return the bytes of the points on this process.
    std::size_t
    memory_consumption() const
    {
      std::size_t n = 0;
      for (const PointsCopy<dim> &copy : points)
        n += copy.memory_consumption();
      for (const PointsCopy<dim> &copy : surfaces)
        n += copy.memory_consumption();
      return n;
    }

  private:
    // Assigning an empty vector keeps the layout on processes without entries,
    // but not on others. The next assignment would then be collective on the
    // others only.
    std::optional<StateWithoutBodies<dim>> rest;
    std::vector<PointsCopy<dim>>           points, surfaces;
    std::vector<std::uint64_t>             n_points;
  };
} // namespace greville
