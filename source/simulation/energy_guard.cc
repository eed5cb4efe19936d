// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/energy_guard.h>
#include <greville/simulation/statistics.h>
#include <greville/simulation/step_errors.h>

#include <algorithm>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two looks at the balance, and before the first: a load that
    // begins at once excites modes whose kinetic energy, half a step behind the
    // strain energy, is not yet that of a mean.
    constexpr unsigned int check_every = 100;
  } // namespace



  template <int dim>
  EnergyGuard<dim>::EnergyGuard(const SchemeParameters    &parameters,
                                const Discretization<dim> &discretization,
                                StepLog                   &log)
    : parameters(parameters)
    , discretization(discretization)
    , log(log)
  {}



  template <int dim>
  void
  EnergyGuard<dim>::start(State<dim> &state) const
  {
    const MPI_Comm comm       = discretization.communicator();
    double         point_mass = 0.;
    for (const Body<dim> &body : state.bodies)
      {
        body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          point_mass += p.mass();
        });
      }
    // Speeds of 1e-8 times that of waves are round-off.
    state.energy.reinit(free_energy<dim>(state.bodies,
                                         discretization.transfer(),
                                         comm),
                        1e-16 * Utilities::MPI::sum(point_mass, comm) *
                          state.first_signal * state.first_signal);
  }



  template <int dim>
  void
  EnergyGuard<dim>::check(State<dim> &state, const bool is_last) const
  {
    if (parameters.energy_gain == "ignore" || state.n_steps < check_every ||
        (state.n_steps % check_every != 0 && !is_last))
      return;
    const PartTimer timer(log, "energy");
    const MPI_Comm  comm = discretization.communicator();
    const double    gain = state.energy.gain(
      free_energy<dim>(state.bodies, discretization.transfer(), comm), comm);
    if (!(gain > std::max(parameters.energy_tolerance, 2. * state.warned_gain)))
      return;
    state.warned_gain = gain;
    std::ostringstream message;
    message << "energy has come from nothing: " << 100. * gain
            << " % of the largest energy so far, with the work of loads, walls "
               "and damping counted. The steps are unstable with mass <"
            << parameters.mass
            << ">: take 'Scheme/Mass' = lumped or fmpm-2, a larger "
               "'Scheme/Filter' or a smaller 'Time/Safety'";
    if (parameters.energy_gain == "stop")
      throw StepFailed(message.str() +
                       " ('Scheme/Energy gain' = warn goes on)");
    log.warnings.push_back("Step " + std::to_string(state.n_steps) + ": " +
                           message.str() + ".");
  }



  template class EnergyGuard<2>;
  template class EnergyGuard<3>;
} // namespace greville
