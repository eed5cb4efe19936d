// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_energy_balance_h
#define greville_steps_energy_balance_h

#include <deal.II/base/mpi.h>

#include <string>
#include <type_traits>
#include <vector>

namespace greville
{
  /**
   * The energy of all processes at some time, and the work until then, see
   * EnergyBalance. Unit: J (2D: J / m).
   */
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
   * with the work W of gravity, loads and walls that move, and the work D <= 0
   * of Cundall's damping. What E has beyond that comes from nothing, and shows
   * an instability.
   *
   * Transfers between points and grid, the filter and friction at walls take
   * energy, too. They are not part of W and D: E may be smaller. The work of
   * friction walls is known nevertheless; what is then missing is the numerical
   * loss().
   */
  class EnergyBalance
  {
  public:
    /**
     * What does work. Load k on surfaces is surfaces + k.
     */
    enum Source : unsigned int
    {
      gravity,
      loads, // on points
      walls, // and what contacts constrain
      surfaces
    };

    /**
     * @p start is E(0) of all processes. Energies below @p negligible are
     * round-off. Unit of both: J (2D: J / m).
     */
    void
    reinit(const double start, const double negligible);

    /**
     * Energy of all processes that bodies bring or take, which come and go
     * between two steps, J (2D: J / m).
     */
    void
    add_to_start(const double amount)
    {
      start += amount;
    }

    /**
     * Work done on the bodies of this process, J (2D: J / m).
     */
    void
    add_work(const unsigned int source, const double amount)
    {
      if (source >= own_work.size())
        own_work.resize(source + 1, 0.);
      own_work[source] += amount;
    }

    /**
     * Likewise by friction walls.
     */
    void
    add_friction(const double amount)
    {
      own_friction += amount;
    }

    /**
     * Work of damping on the bodies of this process, J (2D: J / m): negative
     * where it takes energy.
     */
    void
    add_damping(const double amount)
    {
      own_damping += amount;
    }

    /**
     * Collective. The work W of all processes.
     */
    double
    work(const MPI_Comm comm) const
    {
      double sum = 0.;
      for (const double amount : own_work)
        sum += amount;
      return dealii::Utilities::MPI::sum(sum, comm);
    }

    /**
     * Collective. The part of a source.
     */
    double
    work(const unsigned int source, const MPI_Comm comm) const
    {
      return dealii::Utilities::MPI::sum(
        source < own_work.size() ? own_work[source] : 0., comm);
    }

    /**
     * Collective. The work D of all processes.
     */
    double
    damping(const MPI_Comm comm) const
    {
      return dealii::Utilities::MPI::sum(own_damping, comm);
    }

    /**
     * Collective. The totals with @p energy, the present E of all processes.
     */
    EnergyTotals
    totals(const double energy, const MPI_Comm comm) const;

    /**
     * What the present energy has gained from nothing, as a fraction of the
     * largest energy or work so far. Damping may only take: what D has risen
     * since its lowest value counts as gained. What E is known to @p swing by
     * for a while does not.
     */
    double
    gain(const EnergyTotals &now, const double swing = 0.);

    /**
     * Let gain() and largest_with() compare with what is @p now, too.
     */
    void
    remember(const EnergyTotals &now)
    {
      largest = largest_with(now);
    }

    /**
     * The energy that neither work, nor damping, nor friction walls account
     * for: what transfers, filter and points that have left the grid have
     * taken. Unit: J (2D: J / m).
     */
    double
    loss(const EnergyTotals &now) const
    {
      return start + now.work + now.damping + now.friction - now.energy;
    }

    /**
     * The largest energy or work that gain() or remember() has seen, or is
     * @p now. Unit: J (2D: J / m).
     */
    double
    largest_with(const EnergyTotals &now) const;

    /**
     * Call @p all(name, number) for the numbers that all processes share, and
     * @p sum(name, number) for those of which each has its part: the first
     * @p n_sources sources of work among them.
     */
    template <typename All, typename Sum>
    void
    visit_numbers(const unsigned int n_sources, const All &all, const Sum &sum)
    {
      visit(*this, n_sources, all, sum);
    }

    template <typename All, typename Sum>
    void
    visit_numbers(const unsigned int n_sources,
                  const All         &all,
                  const Sum         &sum) const
    {
      visit(*this, n_sources, all, sum);
    }

  private:
    template <typename Balance, typename All, typename Sum>
    static void
    visit(Balance           &balance,
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

    std::vector<double> own_work; // of sources
    double              start = 0., largest = 0.;
    double              own_damping = 0., own_friction = 0.;
    double              lowest_damping = 0.; // of D, where gain() has seen it
  };

} // namespace greville

#endif
