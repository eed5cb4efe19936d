// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    void
    refuse_with_water(const bool         wrong,
                      const std::string &parameter,
                      const std::string &why)
    {
      AssertThrow(!wrong,
                  ExcMessage(
                    "'Simulation/Pore water' = true does not go with " +
                    parameter + ": " + why));
    }



    void
    refuse_without_water(const bool is_given, const std::string &parameter)
    {
      AssertThrow(!is_given,
                  ExcMessage("The parameter '" + parameter +
                             "' is for pore water, and 'Simulation/Pore water' "
                             "is false."));
    }
  } // namespace



  void
  SimulationParameters::check_water() const
  {
    const WaterParameters none;
    for (const auto &[name, material] : materials)
      {
        const std::string section = "Material " + name + "/";
        if (!general.pore_water)
          {
            refuse_without_water(material->porosity != 0.,
                                 section + "Porosity");
            refuse_without_water(material->conductivity != 0.,
                                 section + "Hydraulic conductivity");
            continue;
          }
        AssertThrow(material->porosity > 0. && material->porosity < 1.,
                    ExcMessage("The parameter '" + section + "Porosity' is " +
                               text_of(material->porosity) +
                               ": with 'Simulation/Pore water' it has to be "
                               "above 0 and below 1."));
        AssertThrow(material->conductivity > 0. &&
                      std::isfinite(material->conductivity),
                    ExcMessage("The parameter '" + section +
                               "Hydraulic conductivity' is " +
                               text_of(material->conductivity) +
                               " m / s: with 'Simulation/Pore water' it has to "
                               "be above 0, and finite."));
      }
    if (!general.pore_water)
      {
        refuse_without_water(water.density != none.density, "Water/Density");
        refuse_without_water(water.bulk_modulus != none.bulk_modulus,
                             "Water/Bulk modulus");
        refuse_without_water(water.degree != none.degree, "Water/Order");
        for (const auto &[name, load] : surface_loads)
          refuse_without_water(!load.pore_pressure.empty(),
                               "Surface load " + name + "/Pore pressure");
        return;
      }
    for (const auto &[name, value] :
         {std::make_pair("Density", water.density),
          std::make_pair("Bulk modulus", water.bulk_modulus)})
      AssertThrow(std::isfinite(value),
                  ExcMessage(std::string("The parameter 'Water/") + name +
                             "' is " + text_of(value) +
                             ": it has to be finite. Water of the 'Bulk "
                             "modulus' 0 is incompressible."));
    AssertThrow(water.degree == 0 || water.degree == grid.degree ||
                  water.degree + 1 == grid.degree,
                ExcMessage(
                  "The parameter 'Water/Order' is " +
                  std::to_string(water.degree) +
                  ": the pore pressure has the order of 'Grid/Order', " +
                  std::to_string(grid.degree) + ", or one less."));
    for (const unsigned int n : grid.cells)
      AssertThrow(n % 2 == 0,
                  ExcMessage("The parameter 'Grid/Cells' has a direction of " +
                             std::to_string(n) +
                             " cells: with 'Simulation/Pore water' numbers of "
                             "cells are even, as the pressure has cells of "
                             "twice the size."));
    refuse_with_water(has_body_grids(),
                      "'Grid/Per body' and sections 'Grid' of bodies",
                      "water passes between bodies on one grid.");
    refuse_with_water(!contacts.empty(),
                      "'Simulation/Contacts'",
                      "what passes where bodies touch is not known.");
    refuse_with_water(has_ramp(),
                      "'Time/Ramp until failure'",
                      "time is that of the flow.");
    for (const auto &[name, body] : bodies)
      refuse_with_water(body.K0 >= 0.,
                        "'Body " + name + "/K0'",
                        "it knows no weight of water. Give the effective "
                        "'Stress', or begin with a stage that finds it.");
  }



  void
  SimulationParameters::check_water_of_stage() const
  {
    bool is_drained = false;
    for (unsigned int w = 0; w < 6; ++w)
      {
        const std::string wall =
          "Walls/" + WallParameters::names[w] + " pore pressure";
        const std::string &pressure = walls.pore_pressure[w];
        is_drained                  = is_drained || !pressure.empty();
        if (!general.pore_water)
          refuse_without_water(!pressure.empty(), wall);
        if (pressure.empty())
          continue;
        const std::string given = "'" + wall + "', which is <" + pressure + ">";
        refuse_with_water(w >= 2 * general.dimension,
                          given,
                          "there is no such wall in 2D.");
        refuse_with_water(grid.has_axis() && w == 0,
                          given,
                          "the wall is the axis, through which nothing flows.");
        refuse_with_water(walls.is_periodic(w),
                          given,
                          "the wall is periodic, so that it has no end there.");
        refuse_with_water(
          scheme.is_total_lagrangian(),
          "'Scheme/Formulation' = total Lagrangian and " + given,
          "bodies leave the wall, whose place is that of the initial "
          "configuration. Give the 'Pore pressure' of a 'Surface load', or "
          "take updated Lagrangian.");
      }
    if (!general.pore_water)
      return;
    for (const auto &load : surface_loads)
      is_drained = is_drained || !load.second.pore_pressure.empty();
    AssertThrow(is_drained || water.bulk_modulus > 0.,
                ExcMessage("The parameter 'Water/Bulk modulus' is 0, which "
                           "makes water incompressible, and no 'Walls/... pore "
                           "pressure' or 'Surface load NAME/Pore pressure' "
                           "gives a pressure anywhere: give one of them."));
    refuse_with_water(!is_implicit_scheme(scheme.stress_update),
                      "'Scheme/Stress update' = " + scheme.stress_update,
                      "its steps are explicit; take quasi-static, "
                      "backward-euler, newmark or generalized-alpha.");
    refuse_with_water(scheme.stress_update == "implicit-midpoint",
                      "'Scheme/Stress update' = implicit-midpoint",
                      "it conserves energy, and water that flows does not; "
                      "take newmark or generalized-alpha.");
    refuse_with_water(scheme.has_projection(),
                      "'Scheme/Volumetric projection' = " +
                        scheme.volumetric_projection,
                      "take none.");
    refuse_with_water(scheme.averages_over_domains(),
                      "'Scheme/Functions' = domains",
                      "take points.");
    refuse_with_water(implicit_solver.always_takes_cg(),
                      "'Implicit solver/Method' = cg",
                      "its systems are not symmetric; take auto or fgmres.");
  }
} // namespace greville
