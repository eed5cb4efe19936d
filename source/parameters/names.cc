// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/mass/fmpm.h>
#include <greville/parameters/names.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // All masses except those of n_fmpm_terms().
    const std::vector<std::string> known_masses = {"auto",
                                                   "consistent",
                                                   "lumped"};
  } // namespace



  std::string
  mass_names()
  {
    std::string names;
    for (const std::string &name : known_masses)
      names += name + "|";
    return names + fmpm_in_lists;
  }



  void
  check_mass_name(const std::string &name, const std::string &parameter)
  {
    auto known = known_masses;
    if (n_fmpm_terms(name) > 0 ||
        std::count(known.begin(), known.end(), name) == 1)
      return;
    known.push_back("fmpm-2");
    AssertThrow(false,
                ExcMessage("The parameter '" + parameter + "' is <" + name +
                           ">; it has to be one of " + mass_names() + "." +
                           did_you_mean(name, known)));
  }



  std::string
  mass_solver_methods()
  {
    return "cg-ic0|cg-p-multigrid|cg-jacobi|cg";
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
            {"Smoother/", "", constants},
            {"Implicit smoother/", "", constants},
            {"Implicit p-multigrid/Coarse preconditioner", "", constants},
            {"Implicit solver/Preconditioner", "", constants},
            {"Implicit solver/Reuse", "", constants},
            {"Implicit solver/Maximum iterations", "", constants}};
  }
} // namespace greville
