// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/rigid_body.h>
#include <greville/steps/simulation.h>

#include <string>
#include <vector>

namespace greville
{
  /// A check for bodies that pass through one another or through a rigid body,
  /// because they have no common grid and no contact names both. The first
  /// overlap of a pair by more than half a cell causes a warning.
  template <int dim>
  class PassingBodies
  {
  public:
    /// The @p parts and the @p rigid_bodies are kept by reference.
    PassingBodies(const SimulationParameters           &parameters,
                  const std::vector<Simulation<dim> *> &parts,
                  const std::vector<RigidBody<dim>>    &rigid_bodies,
                  const MPI_Comm                        comm);

    /// Collective. Add warnings to the log of the first part. Overlaps are
    /// checked at the start, in every tenth explicit step and in each implicit
    /// step, if both bodies may have moved by a quarter of a cell since the
    /// last check.
    void
    check();

  private:
    struct Pair
    {
      std::array<std::string, 2> names;
      int    rigid        = -1; // number of the second one if it is rigid
      bool   is_warned_of = false;
      double time         = 0.,
             way          = 0.; // s, of the last check; m, since the last test
      RigidPosition<dim> last;
    };

    /// The extent of a body, as the largest -x and x, and its largest speed (m
    /// / s), over all processes.
    struct Motion
    {
      const Body<dim>    *body = nullptr;
      Simulation<dim>    *part = nullptr;
      std::vector<double> largest;
    };

    std::vector<Motion>
    motions() const;

    /// Collective. Return a text with the first point that is deep in the other
    /// body, and both names; empty if there is no such point.
    std::string
    find_overlap(const Pair &pair, const Motion &first, const Motion *second);

    std::vector<Simulation<dim> *>     parts;
    const std::vector<RigidBody<dim>> &rigid_bodies;
    const MPI_Comm                     comm;
    std::vector<Pair>                  pairs;
  };
} // namespace greville
