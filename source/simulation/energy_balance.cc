#include <greville/simulation/energy_balance.h>
#include <greville/simulation/statistics.h>

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



  template <int dim>
  double
  free_energy(const std::vector<Body<dim>> &bodies, const MPI_Comm comm)
  {
    using Layout = PointLayout<dim>;
    double sum   = 0.;
    for (const Body<dim> &body : bodies)
      if (body.imposed_velocity.empty())
        {
          const Layout      &layout = body.points.layout();
          const unsigned int s      = body.points.stride();
          body.points.for_each([&](const unsigned int, const double *p) {
            for (unsigned int d = 0; d < dim; ++d)
              sum += 0.5 * p[Layout::mass * s] *
                     std::pow(p[(Layout::velocity + d) * s], 2);
            const MaterialPoint point = material_point<dim>(p, s, layout);
            sum +=
              p[Layout::volume0 * s] * (body.material->strain_energy(point) +
                                        body.material->dissipation(point));
          });
        }
    return Utilities::MPI::sum(sum, comm);
  }



  template double
  free_energy<2>(const std::vector<Body<2>> &, const MPI_Comm);
  template double
  free_energy<3>(const std::vector<Body<3>> &, const MPI_Comm);
} // namespace greville
