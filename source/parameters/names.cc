// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/mass/fmpm.h>
#include <greville/parameters/names.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // All masses; fmpm-K stands for the names of n_fmpm_terms().
    const std::vector<std::pair<std::string, MassSupport>> known_masses = {
      // Friction walls, APIC and Taylor, domains, implicit steps, water in
      // explicit steps.
      {"consistent", {false, false, true, true, false}},
      {"lumped", {true, true, true, true, true}},
      {"fmpm-K", {true, false, false, false, false}}};
  } // namespace



  std::string
  mass_names()
  {
    std::string names = "auto|";
    for (const auto &mass : known_masses)
      names += mass.first == "fmpm-K" ? fmpm_in_lists : mass.first + "|";
    return names;
  }



  void
  check_mass_name(const std::string &name, const std::string &parameter)
  {
    std::vector<std::string> known = {"auto", "fmpm-2"};
    for (const auto &mass : known_masses)
      known.push_back(mass.first);
    known.pop_back(); // fmpm-K
    if (n_fmpm_terms(name) == 0)
      check_known(name, parameter, known, mass_names());
  }



  void
  Refusal::operator()(const bool         wrong,
                      const std::string &parameter,
                      const std::string &why) const
  {
    Require(!wrong, feature + " does not support " + parameter + ": " + why);
  }



  const MassSupport &
  support_of_mass(const std::string &name)
  {
    const auto found =
      std::find_if(known_masses.begin(),
                   known_masses.end(),
                   [&](const auto &mass) {
                     return mass.first == name ||
                            (mass.first == "fmpm-K" && n_fmpm_terms(name) > 0);
                   });
    Require(found != known_masses.end(), "Unknown mass <" + name + ">.");
    return found->second;
  }



  std::string
  masses_with(const bool MassSupport::*support)
  {
    std::string result;
    for (const auto &[name, has] : known_masses)
      if (has.*support)
        result += (result.empty() ? "" : " or ") + name;
    return result;
  }



  std::vector<FormerParameter>
  former_parameters()
  {
    const std::string constants = "Remove it: its values are constants.";
    return {{"Scheme/Stress update",
             "USF",
             "MUSL deforms points by their mapped velocity, too."},
            {"Walls/",
             "contact",
             "A floor that contacts name is a rigid body, such as 'Rigid body "
             "NAME/Shape' = half_space(0, 1, 0) for y < 0, in a grid that "
             "extends behind it."},
            {"Output/Points format",
             "",
             "Remove the line: points are always written as .vtu files, one "
             "for each time."},
            {"Time/Smallest step",
             "",
             "Remove the line: a run fails if an automatic step falls below a "
             "thousandth of the first one."},
            {"Time/Estimate every",
             "",
             "Remove the line: the critical step is estimated every 20 steps, "
             "and up to every 160 steps while it hardly changes."},
            {"Load balance/Check every",
             "",
             "Remove the line: the work is compared every 50 steps, or in each "
             "step with 'Threshold' = 1."},
            {"Output/Print times",
             "",
             "Remove the line: progress and times are always printed."},
            {"Newton/Print iterations",
             "",
             "Remove the line: newton.csv in the folder of the run has all "
             "iterations."},
            {"Solver/Maximum iterations",
             "",
             "Remove the line: a solver may take 1000 iterations."},
            {"Exponent",
             "",
             "Remove the line: the exponent of Tait's equation is 7."},
            {"Smoother/", "", constants},
            {"Implicit smoother/", "", constants},
            {"Implicit p-multigrid/", "", constants},
            {"Implicit solver/Preconditioner", "", constants},
            {"Implicit solver/Reuse", "", constants},
            {"Implicit solver/Maximum iterations", "", constants}};
  }
} // namespace greville
