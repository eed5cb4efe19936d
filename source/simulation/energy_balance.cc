// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/energy_balance.h>

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



  double
  EnergyBalance::gain(const double energy, const MPI_Comm comm)
  {
    const double all_work = work(comm);
    lowest_damping        = std::min(lowest_damping, damping(comm));
    largest = std::max({largest, std::abs(energy), std::abs(all_work)});
    return (energy - start - all_work - lowest_damping) / largest;
  }
} // namespace greville
