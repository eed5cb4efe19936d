// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <string>
#include <type_traits>
#include <vector>

namespace greville
{
  /// The energy of all processes at some time, and the work until this time,
  /// see EnergyBalance. Unit: J (2D: J / m).
  struct EnergyTotals
  {
    double energy   = 0.; // E
    double work     = 0.; // W
    double damping  = 0.; // D
    double friction = 0.; // work of friction walls
  };



  /**
   * The balance of energy of the bodies,
   *   E(t) = kinetic + strain energy + dissipation <= E(0) + W(t) + D(t),
   * with the work W of gravity, loads and moving walls, and the work D <= 0 of
   * Cundall's damping. Energy above this bound is spurious and indicates an
   * instability.
   *
   * Transfers between points and grid, the filter and friction at walls also
   * dissipate energy. This is not part of W and D, so E may be smaller. The
   * work of friction walls is recorded; the remaining difference is the
   * numerical loss().
   */
  class EnergyBalance
  {
  public:
    /// The sources of work. Load k on surfaces is surfaces + k.
    enum Source : unsigned int
    {
      gravity,
      loads, // loads on points
      walls, // walls and constraints of contacts
      surfaces
    };

    /// @p start is E(0) of all processes. Energies below @p negligible are
    /// round-off. Unit: J (2D: J / m).
    void
    reinit(const double start, const double negligible);

    /// Add the energy of bodies that are added (or removed) between two steps,
    /// of all processes, J (2D: J / m).
    void
    add_to_start(const double amount)
    {
      start += amount;
    }

    /// Add work done on the bodies of this process, J (2D: J / m).
    void
    add_work(const unsigned int source, const double amount)
    {
      if (source >= own_work.size())
        own_work.resize(source + 1, 0.);
      own_work[source] += amount;
    }

    /// Add the work of friction walls on the bodies of this process, J (2D: J /
    /// m).
    void
    add_friction(const double amount)
    {
      own_friction += amount;
    }

    /// Add the work of damping on the bodies of this process, J (2D: J / m),
    /// which is negative if it dissipates energy.
    void
    add_damping(const double amount)
    {
      own_damping += amount;
    }

    /// Collective. Return the work W of all processes.
    double
    work(const MPI_Comm comm) const
    {
      double sum = 0.;
      for (const double amount : own_work)
        sum += amount;
      return dealii::Utilities::MPI::sum(sum, comm);
    }

    /// Collective. Return the work of one source.
    double
    work(const unsigned int source, const MPI_Comm comm) const
    {
      return dealii::Utilities::MPI::sum(
        source < own_work.size() ? own_work[source] : 0., comm);
    }

    /// Collective. Return the work D of all processes.
    double
    damping(const MPI_Comm comm) const
    {
      return dealii::Utilities::MPI::sum(own_damping, comm);
    }

    /// Collective. Return the totals with @p energy, the current E of all
    /// processes.
    EnergyTotals
    totals(const double energy, const MPI_Comm comm) const;

    /// Return the spurious gain of energy, as a fraction of the largest energy
    /// or work so far. Damping may only dissipate, so any rise of D above its
    /// lowest value counts as gain. Known temporary oscillations of E by
    /// @p energy_swing do not count.
    double
    gain(const EnergyTotals &now, const double energy_swing = 0.);

    /// Include @p now in the comparisons of gain() and largest_with().
    void
    remember(const EnergyTotals &now)
    {
      largest = largest_with(now);
    }

    /// Return the energy that disappears without work, damping or friction
    /// walls: the dissipation by transfers and the filter, and the energy of
    /// points that have left the grid. Unit: J (2D: J / m).
    double
    loss(const EnergyTotals &now) const
    {
      return start + now.work + now.damping + now.friction - now.energy;
    }

    /// Return the largest energy or work in @p now and in all calls of gain()
    /// and remember(). Unit: J (2D: J / m).
    double
    largest_with(const EnergyTotals &now) const
    {
      return std::max({largest, std::abs(now.energy), std::abs(now.work)});
    }

    /// Call @p all(name, number) for numbers that are equal on all processes,
    /// and @p sum(name, number) for numbers that are sums over processes,
    /// including the first @p n_sources sources of work.
    template <typename Balance, typename All, typename Sum>
    static void
    visit_numbers(Balance           &balance,
                  const unsigned int n_sources,
                  const All         &all,
                  const Sum         &sum)
    {
      all("energy_at_start", balance.start);
      all("largest_energy", balance.largest);
      all("lowest_damping", balance.lowest_damping);
      if constexpr (!std::is_const_v<Balance>)
        balance.own_work.resize(n_sources, 0.);
      double none = 0.;
      for (unsigned int k = 0; k < n_sources; ++k)
        sum("work_" + std::to_string(k),
            k < balance.own_work.size() ? balance.own_work[k] : none);
      sum("damping", balance.own_damping);
      sum("friction", balance.own_friction);
    }

  private:
    std::vector<double> own_work; // of sources
    double              start = 0., largest = 0.;
    double              own_damping = 0., own_friction = 0.;
    double              lowest_damping = 0.; // of D in calls of gain()
  };
} // namespace greville
