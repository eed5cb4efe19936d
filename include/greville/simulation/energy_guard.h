// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_energy_guard_h
#define greville_simulation_energy_guard_h

#include <greville/simulation/discretization.h>

namespace greville
{
  /**
   * Watches the EnergyBalance of a state: warns, or stops the run, where energy
   * has come from nothing.
   */
  template <int dim>
  class EnergyGuard
  {
  public:
    /**
     * All are kept by reference.
     */
    EnergyGuard(const SchemeParameters    &parameters,
                const Discretization<dim> &discretization,
                StepLog                   &log);

    /**
     * Collective. The initial energy.
     */
    void
    start(State<dim> &state) const;

    /**
     * Collective. Every hundred steps, and after the last one. Throws
     * StepFailed where that is asked for.
     */
    void
    check(State<dim> &state, const bool is_last) const;

  private:
    const SchemeParameters    &parameters;
    const Discretization<dim> &discretization;
    StepLog                   &log;
  };
} // namespace greville

#endif
