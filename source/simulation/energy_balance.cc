#include <deal.II/base/mpi.h>

#include <greville/simulation/energy_balance.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  void
  EnergyBalance::reinit(const double new_start, const double negligible)
  {
    start    = new_start;
    largest  = std::max(std::abs(start), negligible);
    own_work = 0.;
  }



  double
  EnergyBalance::gain(const double energy, const MPI_Comm comm)
  {
    const double work = Utilities::MPI::sum(own_work, comm);
    largest           = std::max({largest, std::abs(energy), std::abs(work)});
    return (energy - start - work) / largest;
  }
} // namespace greville
