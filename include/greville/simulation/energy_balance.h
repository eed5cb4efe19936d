#ifndef greville_simulation_energy_balance_h
#define greville_simulation_energy_balance_h

#include <deal.II/base/mpi.h>

namespace greville
{
  /**
   * The balance of energy of the bodies that move freely,
   *   E(t) = kinetic + strain energy + dissipation <= E(0) + W(t),
   * with the work W of gravity, loads, walls and obstacles that move. What
   * numerical damping takes makes E smaller; what E has beyond E(0) + W comes
   * from nothing, and shows an instability.
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
     * Collective. What @p energy, the present E of all processes, has gained
     * from nothing, as a fraction of the largest energy or work so far.
     */
    double
    gain(const double energy, const MPI_Comm comm);

  private:
    double start = 0., largest = 0., own_work = 0.;
  };

} // namespace greville

#endif
