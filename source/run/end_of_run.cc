// SPDX-License-Identifier: LGPL-2.1-or-later

// Ends a SimulationRun early, and controls its ramps.

#include <deal.II/base/utilities.h>

#include <greville/base/named_formulas.h>
#include <greville/materials/state_names.h>
#include <greville/parameters/in_stage.h>
#include <greville/run/simulation_run.h>
#include <greville/steps/step_size.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the sides of all comparisons in a formula.
    std::vector<std::string>
    compared_in(const std::string &formula)
    {
      struct Side
      {
        std::size_t begin;
        bool        is_compared; // with the side before it
      };
      std::vector<std::string> result;
      std::vector<Side>        open = {{0, false}}; // for each parenthesis
      const auto end_side = [&](const std::size_t end, const bool is_compared) {
        const std::string side = Utilities::trim(
          formula.substr(open.back().begin, end - open.back().begin));
        if ((is_compared || open.back().is_compared) && !side.empty())
          result.push_back(side);
      };
      for (std::size_t i = 0; i < formula.size(); ++i)
        {
          const char c = formula[i];
          if (c == '(')
            open.push_back({i + 1, false});
          else if (c == ')' && open.size() > 1)
            {
              end_side(i, false);
              open.pop_back();
            }
          else if (std::string("<>=!&|?:,").find(c) != std::string::npos)
            {
              const bool compares =
                std::string("<>=!").find(c) < std::string::npos;
              end_side(i, compares);
              if (i + 1 < formula.size() &&
                  std::string("=&|").find(formula[i + 1]) != std::string::npos)
                ++i;
              open.back() = {i + 1, compares};
            }
        }
      end_side(formula.size(), false);
      return result;
    }



    /// Throw if a factor decreases or is negative anywhere in a stage.
    void
    check_factor(const Expression &factor, const TimeParameters &time)
    {
      constexpr unsigned int n = 100;
      const auto fail          = [&](const double t, const std::string &why) {
        Require(false,
                "The parameter 'Time/Ramp until failure' is <" +
                  formula_text(time.ramp) + ">, which " + why +
                  " at t = " + text_of(t) +
                  " s: it has to be a nonnegative factor that grows from "
                           "'Time/Start' to 'Time/End'.");
      };
      double first = 0., last = 0.;
      for (unsigned int k = 0; k <= n; ++k)
        {
          const double t     = time.start + (time.end - time.start) * k / n;
          const double value = factor(ArrayView<const double>(&t, 1));
          if (value < 0.)
            fail(t, "is " + text_of(value));
          if (k == 0)
            first = value;
          else if (value < last)
            fail(t, "falls");
          last = value;
        }
      if (time.end > time.start && last == first)
        fail(time.end, "still is " + text_of(last));
    }



    /// Return 'Time/Step' of the current stage, the shortest of all parts, s.
    template <int dim>
    double
    given_step(const CoupledSimulations<dim> &simulations)
    {
      double shortest = std::numeric_limits<double>::infinity();
      for (unsigned int k = 0; k < simulations.n_parts(); ++k)
        {
          const Simulation<dim> &part = simulations.part(k);
          const TimeParameters  &time = part.stage_parameters().time;
          shortest                    = std::min(
            shortest,
            evaluate_step(Expression(time.step, "Time/Step", {"h", "p"}),
                          time,
                          part.grid().cell_size(),
                          part.space().degree()));
        }
      return shortest;
    }



    template <int dim>
    BodyList<dim>
    bodies_of(const std::vector<State<dim>> &states)
    {
      BodyList<dim> bodies;
      for (const State<dim> &state : states)
        bodies.add(state.bodies);
      return bodies;
    }
  } // namespace



  void
  EndOfRun::make(Stage                          &result,
                 const TimeParameters           &time,
                 const std::vector<std::string> &names)
  {
    if (!time.end_when.empty())
      try
        {
          result.criterion.emplace(time.end_when, "Time/End when", names);
        }
      catch (const std::exception &error)
        {
          Require(false,
                  message_of(error) +
                    " 'Output/Probes' gives the columns of probes.");
        }
    const std::string end_when    = formula_text(time.end_when);
    const std::string definitions = time.end_when.substr(end_when.size());
    for (const std::string &side : compared_in(end_when))
      {
        const std::string itself =
          "(" + side + ") == (" + side + ")" + definitions;
        result.compared.emplace_back(
          side, Expression(itself, "Time/End when", names));
        std::optional<Expression> constant;
        try
          {
            constant.emplace(itself,
                             "Time/End when",
                             std::vector<std::string>());
          }
        catch (const std::exception &)
          {
            continue;
          }
        Require((*constant)({}) != 0.,
                "The parameter 'Time/End when' is <" + end_when + ">, where <" +
                  side + "> is NaN: comparisons with it are never true.");
      }
    if (!time.ramp.empty())
      {
        result.factor.emplace(time.ramp,
                              "Time/Ramp until failure",
                              std::vector<std::string>{"t"});
        check_factor(*result.factor, time);
      }
  }



  EndOfRun::EndOfRun(const SimulationParameters     &parameters,
                     const std::vector<std::string> &columns)
  {
    std::vector<std::string> names;
    for (unsigned int k = 0; k < columns.size(); ++k)
      if (is_state_name(columns[k]) && !contains(names, columns[k]))
        {
          names.push_back(columns[k]);
          column_numbers.push_back(k);
        }
    for (unsigned int k = 0; k < parameters.n_stages(); ++k)
      {
        SimulationParameters stage = parameters;
        stage.enter_stage(k);
        stages.emplace_back();
        in_stage(parameters, k, [&]() { make(stages[k], stage.time, names); });
        if (!any_factor && stages[k].factor)
          any_factor = stages[k].factor;
      }
  }



  std::vector<double>
  EndOfRun::values_of(const std::vector<double> &row) const
  {
    std::vector<double> values;
    for (const unsigned int number : column_numbers)
      values.push_back(row[number]);
    return values;
  }



  bool
  EndOfRun::holds(const unsigned int         stage,
                  const std::vector<double> &row) const
  {
    const auto values = values_of(row);
    return stages[stage].criterion &&
           (*stages[stage].criterion)(make_array_view(values)) != 0.;
  }



  std::string
  EndOfRun::undefined(const unsigned int         stage,
                      const std::vector<double> &row) const
  {
    const auto values = values_of(row);
    for (const auto &[side, equals_itself] : stages[stage].compared)
      if (equals_itself(make_array_view(values)) == 0.)
        return side;
    return "";
  }



  double
  EndOfRun::factor(const unsigned int stage, const double time) const
  {
    const auto &own = stages[stage].factor ? stages[stage].factor : any_factor;
    return (*own)(ArrayView<const double>(&time, 1));
  }



  std::string
  EndOfRun::criteria(const std::string &parameters)
  {
    std::string result;
    for (const ParameterLine &line :
         parameter_lines_of(parameters, "parameters"))
      if (line.name == "End when")
        result += line.section + ": " + line.value + "\n";
    return result;
  }



  template <int dim>
  std::vector<double>
  SimulationRun<dim>::row_now()
  {
    probes.forget();
    probes.take(0, simulations.bodies());
    std::vector<double> values =
      values_of(begin_row(), simulations.statistics());
    const auto &more = probes.finish(common().time);
    values.insert(values.end(), more.begin(), more.end());
    return values;
  }



  template <int dim>
  bool
  SimulationRun<dim>::take_step()
  {
    const bool is_new_stage =
      common().n_steps == 0 || simulations.first().is_stage_finished();
    if (is_new_stage || !is_in_ramp())
      {
        simulations.step();
        if (is_in_ramp() && holds_now())
          {
            // At the start of a stage there is no state to go back to.
            ramp.failed_at = common().time;
            end_ramp(simulations.first().stage_parameters().time.start);
          }
        return true;
      }

    const double step = given_step(simulations);
    const double smallest =
      simulations.first().stage_parameters().implicit.smallest_step;
    const double time      = common().time;
    auto         before    = simulations.state();
    const auto   intervals = simulations.contact_intervals();
    const auto   go_back   = [&]() {
      simulations.set_state(before);
      simulations.set_contact_intervals(intervals);
    };
    // Halve the bracket, down to the smallest step.
    const auto halve = [&]() {
      const double fraction =
        std::max(smallest, 0.5 * (ramp.failed_at - time) / step);
      for (State<dim> &state : before)
        state.step_fraction = std::min(state.step_fraction, fraction);
      go_back();
    };
    if (std::isfinite(ramp.failed_at))
      halve();
    const auto is_narrow = [&](const double t) {
      return ramp.failed_at - t <= (1. + 1e-6) * smallest * step;
    };
    try
      {
        simulations.step();
      }
    catch (const StepGivenUp &error)
      {
        // The last good state was stored in single precision.
        go_back();
        const double fraction = std::min(before[0].step_fraction, smallest);
        ramp.failed_at = std::min(ramp.failed_at, time + fraction * step);
        ramp.message   = message_of(error);
        end_ramp(time);
        return true;
      }
    if (!holds_now())
      {
        if (is_narrow(common().time))
          {
            ramp.before = before;
            end_ramp(common().time);
          }
        else
          ramp.before = std::move(before);
        return true;
      }
    ramp.failed_at = common().time;
    ramp.failed    = simulations.state();
    for (State<dim> &state : before)
      ++state.n_all_rejections;
    if (is_narrow(time))
      {
        go_back();
        end_ramp(time);
        return true;
      }
    halve();
    return false;
  }



  template <int dim>
  bool
  SimulationRun<dim>::criterion_holds(const unsigned int         stage,
                                      const std::vector<double> &row)
  {
    const std::string undefined = end_of_run.undefined(stage, row);
    if (!undefined.empty() && !has_noted_undefined)
      notes.note("'Time/End when' compares <" + undefined +
                 ">, which is NaN at t = " + text_of(row[0]) +
                 " s: the comparison is false.");
    has_noted_undefined = has_noted_undefined || !undefined.empty();
    return end_of_run.holds(stage, row);
  }



  template <int dim>
  void
  SimulationRun<dim>::end_ramp(const double last_time)
  {
    ends                     = true;
    const unsigned int stage = common().stage;
    ramp_result.emplace();
    ramp_result->from = end_of_run.factor(stage, last_time);
    if (std::isfinite(ramp.failed_at))
      ramp_result->to = end_of_run.factor(stage, ramp.failed_at);
    if (!ramp.message.empty())
      notes.note("The ramp ends because no equilibrium is found. " +
                 ramp.message);
    // The displacement increments are the differences of two states.
    const auto  last = simulations.state();
    const auto &from = ramp.failed.empty() ? ramp.before : last;
    const auto &to   = ramp.failed.empty() ? last : ramp.failed;
    if (from.empty())
      return;
    const std::string folder = directory + "/failure";
    run_on_first(comm, [&]() {
      std::filesystem::remove_all(folder);
      std::filesystem::create_directory(folder);
    });
    FieldOutput<dim> states(folder, parameters.output);
    states.write_points(from[0].time, bodies_of(from), comm);
    states.write_points(to[0].time, bodies_of(to), comm);
  }



  GREVILLE_INSTANTIATE_CLASS(SimulationRun);
} // namespace greville
