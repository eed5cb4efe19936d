// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/steps/step_size.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The largest number of steps. A larger one indicates a wrong parameter.
    constexpr double most_steps = 1e9;

    // The number of estimates of the critical step; the smallest counts.
    constexpr unsigned int n_estimates = 3;

    // With consistent mass, the largest number of cells that a point crosses in
    // a step, times the order. In longer steps, the velocity filter cannot damp
    // the modes that points excite.
    constexpr double largest_crossing = 0.6;

    // If an estimate differs from the last one by less than this fraction, the
    // time to the next estimate doubles, up to a largest factor.
    constexpr double       negligible_change = 0.02;
    constexpr unsigned int longest_delay     = 8;

    // Growth of the largest wave speed after which an estimate is due at once.
    constexpr double wave_growth = 1.1;

    // Accelerations that change a speed by less than this fraction of c + |v|
    // in a step are noise.
    constexpr double noise_of_acceleration = 1e-8;

  } // namespace



  double
  evaluate_step(const Expression     &formula,
                const TimeParameters &parameters,
                const double          h,
                const unsigned int    degree)
  {
    const double arguments[2] = {h, double(degree)};
    const double step         = formula(ArrayView<const double>(arguments, 2));
    Require(step > 0. && std::isfinite(step),
            "The parameter 'Time/Step' is <" + formula_text(parameters.step) +
              ">, which gives " + text_of(step) + " s: it has to be positive.");
    return step;
  }



  void
  check_step(const double                        step,
             const double                        left,
             const TimeParameters               &parameters,
             const std::function<std::string()> &reason)
  {
    Require(left / step <= most_steps || parameters.max_steps > 0,
            "To 'Time/End' it would take " + text_of(left / step) +
              " steps of " + text_of(step) + " s; at most " +
              text_of(most_steps) +
              " are allowed without 'Time/Maximum steps'. " + reason());
    const double shortest =
      std::numeric_limits<double>::epsilon() *
      std::max(std::abs(parameters.start), std::abs(parameters.end));
    Require(step > shortest,
            "A step of " + text_of(step) +
              " s is lost to rounding in times near 'Time/End', " +
              text_of(parameters.end) + " s: steps have to be longer than " +
              text_of(shortest) + " s. " + reason());
  }



  template <int dim>
  std::string
  describe_materials(const std::vector<Body<dim>> &bodies)
  {
    std::ostringstream text;
    text << "Critical steps come from the materials:";
    for (unsigned int b = 0; b < bodies.size(); ++b)
      {
        const Moduli moduli = bodies[b].material->moduli();
        text << (b > 0 ? "," : "") << " 'Material "
             << bodies[b].parameters->material << "' in 'Body "
             << bodies[b].name << "' has the density "
             << bodies[b].material->density << " kg / m^3, K = " << moduli.bulk
             << " Pa, G = " << moduli.shear << " Pa, and the viscosity "
             << moduli.viscosity << " Pa s";
      }
    return text.str() + ".";
  }



  template <int dim>
  StepSize<dim>::StepSize(const TimeParameters &parameters,
                          Discretization<dim>  &discretization,
                          StepLog              &log)
    : parameters(parameters)
    , discretization(discretization)
    , log(log)
  {
    if (!parameters.step.empty())
      formula.emplace(parameters.step,
                      "Time/Step",
                      std::vector<std::string>{"h", "p"});
  }



  template <int dim>
  bool
  StepSize<dim>::is_estimate_due(const State<dim> &state) const
  {
    return state.n_steps == 0 || state.n_rejections > 0 ||
           (parameters.estimate_every > 0 &&
            state.n_steps >= state.estimates.next) ||
           state.signals.wave > wave_growth * state.estimates.wave;
  }



  template <int dim>
  void
  StepSize<dim>::estimate(State<dim> &state, const StepScheme &scheme)
  {
    discretization.sum(state);
    const PartTimer timer(log, "critical step");
    StepEstimates  &estimates = state.estimates;
    const double    last  = estimates.last.empty() ? 0. : estimates.last.back();
    GridField<dim> &field = discretization.field();
    field.mass->release();
    double estimate = CriticalStep<dim>().estimate(*field.mass,
                                                   discretization.transfer(),
                                                   state.bodies,
                                                   state.surfaces,
                                                   field.points,
                                                   scheme,
                                                   state.field.mode);

    // With derivatives averaged over domains, the highest frequency varies with
    // the positions of points in cells more than a few estimates show.
    constexpr double of_domains = 0.85;
    if (discretization.cell_windows() &&
        discretization.field().mass->is_exact())
      estimate *= of_domains;
    estimates.last.push_back(estimate);
    const unsigned int n_kept =
      discretization.field().mass->is_exact() ? n_estimates : 1;
    if (estimates.last.size() > n_kept)
      estimates.last.erase(estimates.last.begin(),
                           estimates.last.end() - n_kept);
    estimates.critical =
      *std::min_element(estimates.last.begin(), estimates.last.end());

    const unsigned int every = parameters.estimate_every;
    if (std::abs(estimate - last) <= negligible_change * estimate)
      estimates.n_between = std::min(std::max(2 * estimates.n_between, every),
                                     longest_delay * every);
    else
      estimates.n_between = every;
    estimates.next = state.n_steps + estimates.n_between;
    estimates.wave = state.signals.wave;
  }



  template <int dim>
  std::string
  StepSize<dim>::describe_step(const State<dim> &state) const
  {
    const std::string materials = describe_materials(state.bodies);
    if (formula)
      return materials;
    return "The step is the smaller of 'Time/CFL number' (" +
           text_of(parameters.cfl) +
           ") times h / (c + |v|), with the largest c + |v| = " +
           text_of(state.signals.fastest) + " m / s, and 'Time/Safety' (" +
           text_of(parameters.safety) + ") times the critical step of " +
           text_of(state.estimates.critical) +
           " s; with consistent mass points cross at most " +
           text_of(largest_crossing) + " / p cells. " + materials;
  }



  template <int dim>
  double
  StepSize<dim>::given_step(const State<dim> &state, const bool has_estimate)
  {
    const double step = evaluate_step(*formula,
                                      parameters,
                                      discretization.cell_size(),
                                      discretization.space().degree());
    if (has_estimate && step > state.estimates.critical)
      {
        const std::string message = "The parameter 'Time/Step' is <" +
                                    parameters.step + ">: the step of " +
                                    text_of(step) +
                                    " s is above the critical step of " +
                                    text_of(state.estimates.critical) +
                                    " s at t = " + text_of(state.time) + " s";
        Require(!parameters.refuses_too_large_steps(),
                message +
                  " ('Time/Too large step' = warn continues; an implicit "
                  "'Scheme/Stress update' has no such limit). " +
                  describe_step(state));
        log.warnings.push_back(message + ".");
      }
    return step;
  }



  template <int dim>
  double
  StepSize<dim>::automatic_step(State<dim> &state) const
  {
    const Signals &signals = state.signals;
    double         step =
      std::min(parameters.cfl * discretization.cell_size() / signals.fastest,
               parameters.safety * state.estimates.critical);
    if (discretization.field().mass->is_exact() && signals.crossing_rate > 0.)
      step = std::min(step,
                      largest_crossing / (discretization.space().degree() *
                                          signals.crossing_rate));
    Require(std::isfinite(step) && step > 0.,
            "The automatic time step is " + text_of(step) + " s. " +
              describe_step(state));
    double &first = state.estimates.first_step;
    if (first == 0.)
      first = step;
    Require(
      step >= parameters.smallest_step * first,
      "The automatic time step has fallen to " + text_of(step) + " s at t = " +
        text_of(state.time) + " s, below " + text_of(parameters.smallest_step) +
        " of the first one, " + text_of(first) + " s. " +
        (state.bodies[0].points.layout().is_total_lagrangian()
           ? "In total Lagrangian steps the most crushed cell bounds the step; "
             "'Scheme/Formulation' = updated Lagrangian has no such bound. "
           : "") +
        describe_step(state));
    return step;
  }



  template <int dim>
  double
  StepSize<dim>::propose(State<dim> &state, const StepScheme &scheme)
  {
    // With a given step, the estimate is only for a warning.
    const bool has_estimate =
      is_estimate_due(state) &&
      (!formula || parameters.looks_at_too_large_steps());
    if (has_estimate)
      estimate(state, scheme);
    const double step =
      formula ? given_step(state, has_estimate) : automatic_step(state);

    const auto reason = [&]() {
      return formula ? "'Time/Step' is <" + formula_text(parameters.step) + ">."
                     : describe_step(state);
    };
    const double left = parameters.end - state.time;
    check_step(step, left, parameters, reason);
    // With a given step, take equal steps to the end; otherwise avoid a tiny
    // last step.
    if (formula)
      return left / std::max(1., std::ceil(left / step - 1e-9));
    if (step >= left)
      return left;
    return step > 0.5 * left ? 0.5 * left : step;
  }



  template <int dim>
  bool
  StepSize<dim>::has_unstable_mode(const State<dim>      &state,
                                   const FieldState<dim> &kept,
                                   const GridField<dim>  &field,
                                   const double           dt) const
  {
    const AccelerationHistory<dim> &history      = kept.history;
    const VectorField<dim>         &acceleration = field.acceleration;
    if (history.n < 2)
      return false;
    const VectorType   &mass = field.lumped_mass;
    std::vector<double> sums(4, 0.);
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
        {
          const double m  = mass.local_element(i);
          const double a2 = acceleration[d].local_element(i);
          const double a1 = history.accelerations[0][d].local_element(i);
          const double a0 = history.accelerations[1][d].local_element(i);
          const double change =
            2. * ((a2 - a1) / history.steps[0] - (a1 - a0) / history.steps[1]) /
            (history.steps[0] + history.steps[1]);
          sums[0] += m * change * change;
          sums[1] += m * a1 * a1;
          sums[2] += m * a2 * a2;
          sums[3] += m / dim;
        }
    Utilities::MPI::sum(sums, discretization.communicator(), sums);
    const double noise = noise_of_acceleration * state.signals.fastest / dt;
    if (!(sums[2] > noise * noise * sums[3]))
      return false;
    const double omega =
      sums[1] > 0. ? std::sqrt(std::sqrt(sums[0] / sums[1])) : 0.;
    return dt * omega > 2. * parameters.safety;
  }



  template <int dim>
  void
  StepSize<dim>::remember(AccelerationHistory<dim> &history,
                          const VectorField<dim>   &acceleration,
                          const double              dt) const
  {
    std::swap(history.accelerations[0], history.accelerations[1]);
    history.accelerations[0] = acceleration;
    history.steps            = {{dt, history.steps[0]}};
    ++history.n;
  }



  GREVILLE_INSTANTIATE(describe_materials);
  GREVILLE_INSTANTIATE_CLASS(StepSize);
} // namespace greville
