// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/energy_balance.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  void
  EnergyBalance::reinit(const double new_start, const double negligible)
  {
    start   = new_start;
    largest = std::max(std::abs(start), negligible);
    own_work.clear();
    own_damping = own_friction = lowest_damping = 0.;
  }



  EnergyTotals
  EnergyBalance::totals(const double energy, const MPI_Comm comm) const
  {
    std::vector<double> sums{0., own_damping, own_friction};
    for (const double amount : own_work)
      sums[0] += amount;
    Utilities::MPI::sum(sums, comm, sums);
    return {energy, sums[0], sums[1], sums[2]};
  }



  double
  EnergyBalance::gain(const EnergyTotals &now, const double energy_swing)
  {
    lowest_damping = std::min(lowest_damping, now.damping);
    remember(now);
    return (now.energy - energy_swing - start - now.work - lowest_damping) /
           largest;
  }
} // namespace greville
