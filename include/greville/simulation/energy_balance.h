// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_energy_balance_h
#define greville_simulation_energy_balance_h

#include <deal.II/base/mpi.h>

namespace greville
{
  /**
   * The balance of energy of the bodies that move freely,
   *   E(t) = kinetic + strain energy + dissipation <= E(0) + W(t) + D(t),
   * with the work W of gravity, loads, walls and obstacles that move, and the
   * work D <= 0 of Cundall's and kinetic damping. What E has beyond that comes
   * from nothing, and shows an instability.
   *
   * Transfers between points and grid, the filter and friction at walls take
   * energy, too. They are not counted: E may be smaller.
   */
  class EnergyBalance
  {
  public:
    /**
     * @p start is E(0) of all processes. Energies below @p negligible are
     * round-off. Unit of both: J (2D: J / m).
     */
    void
    reinit(const double start, const double negligible);

    /**
     * Work done on the bodies of this process, J (2D: J / m).
     */
    void
    add_work(const double amount)
    {
      own_work += amount;
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
      return dealii::Utilities::MPI::sum(own_work, comm);
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
     * Collective. What @p energy, the present E of all processes, has gained
     * from nothing, as a fraction of the largest energy or work so far. Damping
     * may only take: what D has risen since its lowest value counts as gained.
     */
    double
    gain(const double energy, const MPI_Comm comm);

    /**
     * Call @p all(name, number) for the numbers that all processes share, and
     * @p sum(name, number) for those of which each has its part.
     */
    template <typename All, typename Sum>
    void
    visit_numbers(const All &all, const Sum &sum)
    {
      visit(*this, all, sum);
    }

    template <typename All, typename Sum>
    void
    visit_numbers(const All &all, const Sum &sum) const
    {
      visit(*this, all, sum);
    }

  private:
    template <typename Balance, typename All, typename Sum>
    static void
    visit(Balance &balance, const All &all, const Sum &sum)
    {
      all("energy_at_start", balance.start);
      all("largest_energy", balance.largest);
      all("lowest_damping", balance.lowest_damping);
      sum("work", balance.own_work);
      sum("damping", balance.own_damping);
    }

    double start = 0., largest = 0., own_work = 0., own_damping = 0.;
    double lowest_damping = 0.; // of D, where gain() has seen it
  };

} // namespace greville

#endif
