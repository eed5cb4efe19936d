// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/base/step_errors.h>
#include <greville/steps/step_guard.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two checks of the energy balance, and before the first.
    constexpr unsigned int energy_every = 100;

    // The fraction of set_energy_swing() that does not count as spurious
    // energy. With modes at 0.95 of their critical step, E varies by a factor
    // of ten, and E less this fraction by two. A growing mode keeps a tenth of
    // its energy.
    constexpr double swing_left_out = 0.9;

    // The accepted gain, as a fraction of the largest energy or work of one
    // source so far.
    constexpr double accepted_gain = 0.1;

    // The fraction of the mass that rounding may change.
    constexpr double mass_tolerance = 1e-10;

    // The largest J and 1 / J.
    constexpr double largest_volume_change = 1e4;

    // The largest numbers of cells that points and pressure waves may cross in
    // an explicit step. Waves of half this speed already make all schemes
    // unstable.
    constexpr double most_cells_of_points = 1., most_cells_of_waves = 3.;

    // The accepted error of the momentum due to rounding, functions of hardly
    // any mass and iterative solvers, as a fraction of the mass times the
    // fastest signal.
    constexpr double momentum_tolerance = 1e-6;

    /// Return the sum of n values by several independent partial sums. A single
    /// sum would wait for each addition.
    template <typename Value>
    double
    sum_of(const unsigned int n, const Value &value)
    {
      constexpr unsigned int width        = 8;
      double                 parts[width] = {}, sum = 0.;
      unsigned int           i = 0;
      for (; i + width <= n; i += width)
        for (unsigned int k = 0; k < width; ++k)
          parts[k] += value(i + k);
      for (; i < n; ++i)
        sum += value(i);
      for (const double part : parts)
        sum += part;
      return sum;
    }



    constexpr const char *error_of_program =
      "This is an error of the program, or of another one that changes points "
      "between steps";
  } // namespace



  template <int dim>
  void
  MomentumBalance<dim>::add(const VectorField<dim> &field, const double factor)
  {
    for (unsigned int d = 0; d < dim; ++d)
      expected[d] +=
        factor * sum_of(field[d].locally_owned_size(), [&](const auto i) {
          return field[d].local_element(i);
        });
  }



  template <int dim>
  void
  MomentumBalance<dim>::add(const VectorType       &mass,
                            const VectorField<dim> &field,
                            const double            factor)
  {
    for (unsigned int d = 0; d < dim; ++d)
      expected[d] +=
        factor * sum_of(mass.locally_owned_size(), [&](const auto i) {
          return mass.local_element(i) * field[d].local_element(i);
        });
  }



  template <int dim>
  StepGuard<dim>::StepGuard(const SimulationParameters &parameters,
                            const Discretization<dim>  &discretization,
                            StepLog                    &log)
    : parameters(parameters)
    , discretization(discretization)
    , log(log)
  {}



  template <int dim>
  void
  StepGuard<dim>::weigh(State<dim> &state) const
  {
    double mass = 0.;
    for (const Body<dim> &body : state.bodies)
      body.points.for_each([&](ConstPointRef<dim> p) { mass += p.mass(); });
    state.mass = Utilities::MPI::sum(mass, discretization.communicator());
    state.removed_mass = state.mass_removed_last = 0.;
  }



  template <int dim>
  void
  StepGuard<dim>::start(State<dim> &state) const
  {
    weigh(state);
    // Speeds of 1e-8 times the wave speed are round-off.
    state.energy.reinit(energy_of_bodies<dim>(state.bodies,
                                              discretization.transfer(),
                                              discretization.communicator()),
                        1e-16 * state.mass * state.first_signal *
                          state.first_signal);
  }



  template <int dim>
  void
  StepGuard<dim>::set(const PointMotion &motion)
  {
    sums     = motion.sums;
    wave     = motion.fastest_wave;
    has_sums = true;
  }



  template <int dim>
  void
  StepGuard<dim>::set(const MomentumBalance<dim> &momentum)
  {
    balance = momentum;
  }



  template <int dim>
  template <typename Measure>
  std::string
  StepGuard<dim>::worst_point(const State<dim> &state,
                              const Measure    &measure) const
  {
    const MPI_Comm comm    = discretization.communicator();
    double         largest = -std::numeric_limits<double>::infinity();
    std::string    text;
    for (const Body<dim> &body : state.bodies)
      body.points.for_each([&](const unsigned int cell, ConstPointRef<dim> p) {
        double value = measure(body, p);
        if (std::isnan(value))
          value = std::numeric_limits<double>::infinity();
        if (!(value > largest))
          return;
        largest = value;
        text    = "point " + std::to_string(std::int64_t(p.id())) +
               " of the body '" + body.name + "' " +
               describe_place<dim>(discretization.space(), cell, p.position());
      });
    if (largest < Utilities::MPI::max(largest, comm))
      text = "";
    return first_of_all(text, comm);
  }



  template <int dim>
  void
  StepGuard<dim>::check_count(const State<dim> &state) const
  {
    std::uint64_t n_points = 0;
    for (const Body<dim> &body : state.bodies)
      n_points += body.n_points;
    if (state.n_points + state.n_removed == n_points)
      return;
    throw StepFailed("points have been lost: there are " +
                       std::to_string(state.n_points) + ", and " +
                       std::to_string(state.n_removed) +
                       " have left the grid, of " + std::to_string(n_points) +
                       ". " + error_of_program,
                     false);
  }



  template <int dim>
  void
  StepGuard<dim>::check_points(const State<dim> &state,
                               const double      mass,
                               const bool        is_implicit) const
  {
    const MPI_Comm      comm     = discretization.communicator();
    std::vector<double> extremes = {-sums.smallest_J,
                                    sums.largest_J,
                                    sums.crossed,
                                    wave};
    Utilities::MPI::max(extremes, comm, extremes);
    const double smallest_J = -extremes[0], largest_J = extremes[1];
    const double largest_change = largest_volume_change;
    // The sum includes points that are then removed.
    const double before = state.mass - state.removed_mass;
    if (!(std::abs(mass - before) <= mass_tolerance * state.mass))
      throw StepFailed("the mass of the points is " + text_of(mass) +
                         " kg, and it was " + text_of(before) + " kg before. " +
                         error_of_program,
                       false);
    if (largest_J > largest_change || smallest_J < 1. / largest_change)
      throw StepFailed(
        "the volume of " +
        worst_point(state,
                    [](const Body<dim> &, ConstPointRef<dim> p) {
                      return std::abs(std::log(p.J()));
                    }) +
        ", is J = " +
        text_of(largest_J > largest_change ? largest_J : smallest_J) +
        " times the initial one, and has to be between " +
        text_of(1. / largest_change) + " and " + text_of(largest_change) +
        ". The usual causes are steps that are too long ('Time/Safety', "
        "'Time/Step'), and a material that is too weak for its loads");
    if (is_implicit)
      return;
    const double h  = discretization.cell_size();
    const double dt = state.step;
    if (!parameters.scheme.is_total_lagrangian() &&
        extremes[2] > most_cells_of_points)
      throw StepFailed(
        "a point has crossed " + text_of(extremes[2]) +
        " cells in the step, but explicit steps allow at most " +
        text_of(most_cells_of_points) + ": the fastest one is " +
        worst_point(state,
                    [](const Body<dim> &, ConstPointRef<dim> p) {
                      double square = 0.;
                      for (unsigned int d = 0; d < dim; ++d)
                        square += p.velocity(d) * p.velocity(d);
                      return square;
                    }) +
        ". The usual cause is " +
        (parameters.time.step.empty()
           ? "'Time/CFL number', which is " + text_of(parameters.time.cfl)
           : "'Time/Step', which is <" + formula_text(parameters.time.step) +
               ">") +
        ", or a 'Velocity' of a body");
    // If larger steps are allowed, StepSize has already warned.
    if (parameters.time.refuses_too_large_steps() &&
        extremes[3] * dt / h > most_cells_of_waves)
      throw StepFailed(
        "pressure waves have crossed " + text_of(extremes[3] * dt / h) +
        " cells in the step, but explicit steps are stable only below " +
        text_of(most_cells_of_waves) + ": the fastest ones, with " +
        text_of(extremes[3]) + " m / s, are at " +
        worst_point(state,
                    [](const Body<dim> &, ConstPointRef<dim> p) {
                      return p.mass() > 0. ? p.wave_modulus() * p.J() *
                                               p.volume0() / p.mass()
                                           : 0.;
                    }) +
        ". The usual cause is " +
        (parameters.time.step.empty()
           ? "a law that becomes stiffer within a step"
           : "'Time/Step', which is <" + formula_text(parameters.time.step) +
               ">"));
  }



  template <int dim>
  void
  StepGuard<dim>::check_momentum(const Tensor<1, dim> &expected,
                                 const Tensor<1, dim> &found,
                                 const double          size,
                                 const State<dim>     &state,
                                 const bool            is_implicit) const
  {
    const bool is_exact =
      discretization.field().mass->is_diagonal() && !is_implicit;
    const double difference = (found - expected).norm();
    if (difference <= momentum_tolerance * size)
      return;
    std::ostringstream message;
    message << "the momentum of the points is (" << found
            << ") kg m / s, but their momentum before the step and the "
               "impulses of forces and walls give ("
            << expected << ") kg m / s: the difference is " << difference / size
            << " of the mass times the fastest signal, and has to be at most "
            << momentum_tolerance << ". ";
    const std::string surface =
      is_implicit ? std::string() : surface_without_mass(state);
    if (!surface.empty())
      message
        << "The force of " << surface
        << " acts on functions of the grid that have no mass: the body is "
           "too thin for its cells, or a part of it is; take smaller "
           "cells";
    else
      message << "The usual cause is "
              << (is_exact ? "an error of the program, or of another one that "
                             "changes points or grid in a step"
                           : "a solver of the mass matrix that is not accurate "
                             "('Solver/Tolerance')");
    throw StepFailed(message.str(), false);
  }



  template <int dim>
  std::string
  StepGuard<dim>::surface_without_mass(const State<dim> &state) const
  {
    std::string           result;
    const GridField<dim> &field = discretization.field();
    for (unsigned int k = 0;
         k < state.surfaces.size() && k < field.surface_forces.size();
         ++k)
      {
        const VectorField<dim> &force   = field.surface_forces[k];
        const Surface<dim>     &surface = state.surfaces[k];
        for (unsigned int i = 0;
             i < force[0].locally_owned_size() && result.empty();
             ++i)
          if (!field.mass->has_points(i))
            for (unsigned int d = 0; d < dim; ++d)
              if (force[d].local_element(i) != 0.)
                result = surface.contact.empty()
                           ? "'Surface load " + surface.name + "'"
                           : "'Contact " + surface.contact + "'";
      }
    return first_of_all(result, discretization.communicator());
  }



  template <int dim>
  void
  StepGuard<dim>::check(State<dim> &state, const bool is_implicit)
  {
    check_count(state);
    if (has_sums)
      {
        std::vector<double> numbers = {sums.mass};
        for (unsigned int d = 0; d < dim; ++d)
          {
            numbers.push_back(sums.momentum[d]);
            numbers.push_back(balance ? balance->expected[d] : 0.);
          }
        Utilities::MPI::sum(numbers, discretization.communicator(), numbers);
        Tensor<1, dim> found, expected;
        bool           is_finite = std::isfinite(numbers[0]);
        for (unsigned int d = 0; d < dim; ++d)
          {
            found[d]    = numbers[1 + 2 * d];
            expected[d] = numbers[2 + 2 * d];
            is_finite   = is_finite && std::isfinite(found[d]);
          }
        if (!is_finite)
          throw StepFailed(
            "mass or velocity are infinite or NaN: of " +
            worst_point(state, [](const Body<dim> &, ConstPointRef<dim> p) {
              double sum = p.mass();
              for (unsigned int d = 0; d < dim; ++d)
                sum += std::abs(p.velocity(d));
              return std::isfinite(sum) ? 0. : sum;
            }));
        check_points(state, numbers[0], is_implicit);
        if (balance)
          check_momentum(expected,
                         found,
                         state.mass * std::max(state.signals.fastest,
                                               state.first_signal) +
                           expected.norm(),
                         state,
                         is_implicit);
      }
    has_sums = false;
    balance.reset();
    energy_swing = 0.;
  }



  template <int dim>
  bool
  StepGuard<dim>::looks_at_energy(const unsigned int n_steps,
                                  const bool         is_last) const
  {
    return n_steps % energy_every == 0 || (is_last && n_steps > energy_every);
  }



  template <int dim>
  void
  StepGuard<dim>::check_energy(State<dim> &state, const EnergyTotals &now) const
  {
    const SchemeParameters &scheme = parameters.scheme;
    const MPI_Comm          comm   = discretization.communicator();
    double                  gain   = state.energy.gain(now,
                                    swing_left_out *
                                      Utilities::MPI::sum(energy_swing, comm));
    const double limit = std::max(accepted_gain, 2. * state.warned_gain);
    if (!scheme.looks_at_energy() || !(gain > limit))
      return;
    // A stiff body between others stores far less energy than the work that
    // passes through it, and each part of this work has an error.
    const unsigned int n_sources =
      EnergyBalance::surfaces + state.surfaces.size();
    double largest_work = 0.;
    for (unsigned int k = 0; k < n_sources; ++k)
      largest_work =
        std::max(largest_work, std::abs(state.energy.work(k, comm)));
    const double largest = state.energy.largest_with(now);
    if (largest_work > largest)
      gain *= largest / largest_work;
    if (!(gain > limit))
      return;
    state.warned_gain = gain;
    std::ostringstream message;
    message
      << "energy has come from nothing: " << 100. * gain
      << " % of the largest energy or work of one source so far, beyond the "
         "work of loads, walls and damping. The steps are unstable with mass <"
      << scheme.mass
      << ">: take 'Scheme/Mass' = lumped or fmpm-2, a larger "
         "'Scheme/Filter' or a smaller 'Time/Safety'";
    if (scheme.stops_at_energy_gain())
      throw StepFailed(message.str() +
                       " ('Scheme/Energy gain' = warn continues)");
    log.warnings.push_back("Step " + std::to_string(state.n_steps) + ": " +
                           message.str() + ".");
  }



  GREVILLE_INSTANTIATE_CLASS(MomentumBalance);
  GREVILLE_INSTANTIATE_CLASS(StepGuard);
} // namespace greville
