// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/pores.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace greville
{
  using namespace dealii;

  namespace
  {
    const Refusal refuse_with_water{"'Simulation/Pore water' = true"};



    void
    refuse_without_water(const bool is_given, const std::string &parameter)
    {
      Require(!is_given,
              "The parameter '" + parameter +
                "' needs 'Simulation/Pore water' = true.");
    }



    /// Check the combination of conditions at a wall or a surface. @p names are
    /// the names of its pressure, seepage face and flux in a @p section.
    void
    check_boundary(const std::string                &section,
                   const std::array<std::string, 3> &names,
                   const std::string                &pressure,
                   const bool                        is_seepage_face,
                   const std::string                &flux)
    {
      Require(pressure.empty() || flux.empty(),
              "The parameters '" + section + names[0] + "' and '" + names[2] +
                "' are both given: give one of them.");
      Require(!pressure.empty() || !is_seepage_face,
              "The parameter '" + section + names[1] + "' is true and needs '" +
                names[0] + "': 0 in air.");
    }



    /// Return the materials of bodies in all stages.
    std::set<std::string>
    materials_of(const SimulationParameters     &parameters,
                 const std::vector<std::string> &bodies)
    {
      std::set<std::string> result;
      for (const std::string &name : bodies)
        {
          result.insert(parameters.bodies.at(name).material);
          for (const StageParameters &stage : parameters.stages)
            if (stage.material_of.count(name) > 0)
              result.insert(stage.material_of.at(name));
        }
      return result;
    }



    /// Return the materials of bodies that have a grid of their own, beside
    /// saturated bodies.
    std::set<std::string>
    materials_without_pores(const SimulationParameters &parameters)
    {
      std::set<std::string> with, without;
      for (const auto &group : parameters.body_groups())
        (has_pores(parameters, group) ? with : without)
          .merge(materials_of(parameters, group));
      if (with.empty())
        return {};
      for (const std::string &name : with)
        without.erase(name);
      return without;
    }



    void
    refuse_pores(const std::string &section, const Material &material)
    {
      refuse_without_water(material.porosity != 0., section + "Porosity");
      refuse_without_water(material.conductivity != 0.,
                           section + "Hydraulic conductivity");
      refuse_without_water(material.has_kozeny_carman,
                           section + "Conductivity law");
    }



    /// Check a material that is dry beside saturated ones.
    void
    check_dry(const std::string &section, const Material &material)
    {
      Require(material.conductivity == 0.,
              "The parameter '" + section + "Hydraulic conductivity' is " +
                text_of(material.conductivity) +
                " m / s, but its 'Porosity' is 0: water needs pores.");
      Require(!material.has_kozeny_carman,
              "The parameter '" + section +
                "Conductivity law' is kozeny-carman, but its 'Porosity' is 0: "
                "water needs pores.");
    }



    void
    check_saturated(const std::string     &section,
                    const Material        &material,
                    const WaterParameters &water)
    {
      Require(
        material.porosity > 0. && material.porosity < 1.,
        "The parameter '" + section + "Porosity' is " +
          text_of(material.porosity) +
          ": with 'Simulation/Pore water' it has to be above 0 and below 1.");
      Require(material.density >= material.porosity * water.density,
              "The parameter '" + section + "Density' is " +
                text_of(material.density) +
                " kg / m^3 for soil and water together, but the water in the "
                "pores alone has " +
                text_of(material.porosity * water.density) +
                " kg / m^3 ('Porosity' times 'Water/Density').");
      Require(material.conductivity > 0. &&
                std::isfinite(material.conductivity),
              "The parameter '" + section + "Hydraulic conductivity' is " +
                text_of(material.conductivity) +
                " m / s: with 'Simulation/Pore water' it has to be above 0, "
                "and finite.");
    }



    void
    refuse_water(
      const WaterParameters                              &water,
      const std::map<std::string, SurfaceLoadParameters> &surface_loads)
    {
      const WaterParameters none;
      refuse_without_water(water.density != none.density, "Water/Density");
      refuse_without_water(water.bulk_modulus != none.bulk_modulus,
                           "Water/Bulk modulus");
      refuse_without_water(!water.table.empty(), "Water/Table");
      refuse_without_water(water.capillary_height != 0.,
                           "Water/Capillary height");
      refuse_without_water(water.is_second_order, "Water/Integration");
      refuse_without_water(!water.free_surface_pressure.empty(),
                           "Water/Free surface pressure");
      for (const auto &[name, load] : surface_loads)
        {
          const std::string section = "Surface load " + name;
          refuse_without_water(!load.pore_pressure.empty(),
                               section + "/Pore pressure");
          refuse_without_water(load.seepage_face, section + "/Seepage face");
          refuse_without_water(!load.flux.empty(), section + "/Flux");
        }
    }



    void
    check_finite(const WaterParameters &water)
    {
      for (const auto &[name, value] :
           {std::make_pair("Density", water.density),
            std::make_pair("Bulk modulus", water.bulk_modulus),
            std::make_pair("Capillary height", water.capillary_height)})
        Require(
          std::isfinite(value),
          std::string("The parameter 'Water/") + name + "' is " +
            text_of(value) +
            ": it has to be finite. 'Bulk modulus' = 0 makes water "
            "incompressible, and 'Capillary height' = 0 keeps pores full.");
    }



    void
    check_cells_of_water(const SimulationParameters &parameters)
    {
      const auto check_cells = [](const std::string               &section,
                                  const std::vector<unsigned int> &cells) {
        for (const unsigned int n : cells)
          Require(n % 2 == 0,
                  "The parameter '" + section +
                    "Grid/Cells' has a direction with " + std::to_string(n) +
                    " cells: 'Simulation/Pore water' needs even numbers, "
                    "because cells of the pressure are twice as large.");
      };
      check_cells("", parameters.grid.cells);
      for (const auto &[name, own] : parameters.body_grids)
        if (has_pores(parameters, {name}))
          check_cells("Body " + name + "/", own.cells);
    }



    void
    check_water_of_loads(const SimulationParameters &parameters)
    {
      for (const auto &[name, load] : parameters.surface_loads)
        {
          check_boundary("Surface load " + name + "/",
                         {{"Pore pressure", "Seepage face", "Flux"}},
                         load.pore_pressure,
                         load.seepage_face,
                         load.flux);
          refuse_with_water(
            load.passes_water() && !has_pores(parameters, {load.body}),
            "'Surface load " + name +
              (load.flux.empty() ? "/Pore pressure'" : "/Flux'"),
            "the material of 'Body " + load.body + "' has no pores.");
        }
    }



    void
    check_water_at_wall(const SimulationParameters &parameters,
                        const unsigned int          w)
    {
      const std::string  section  = "Walls/";
      const std::string  name     = WallParameters::names[w];
      const std::string &pressure = parameters.walls.pore_pressure[w];
      const std::string &flux     = parameters.walls.flux[w];
      if (!parameters.general.pore_water)
        {
          refuse_without_water(!pressure.empty(),
                               section + name + " pore pressure");
          refuse_without_water(parameters.walls.seepage_face[w],
                               section + name + " seepage face");
          refuse_without_water(!flux.empty(), section + name + " flux");
          return;
        }
      check_boundary(
        section,
        {{name + " pore pressure", name + " seepage face", name + " flux"}},
        pressure,
        parameters.walls.seepage_face[w],
        flux);
      if (pressure.empty() && flux.empty())
        return;
      const std::string given =
        "'" + section + name + (flux.empty() ? " pore pressure" : " flux") +
        "', which is <" + (flux.empty() ? pressure : flux) + ">";
      refuse_with_water(w >= 2 * parameters.general.dimension,
                        given,
                        "there is no such wall in 2D.");
      refuse_with_water(parameters.grid.has_axis() && w == 0,
                        given,
                        "the wall is the axis, through which nothing flows.");
      refuse_with_water(parameters.walls.is_periodic(w),
                        given,
                        "the wall is periodic and has no boundary there.");
      refuse_with_water(
        parameters.scheme.is_total_lagrangian(),
        "'Scheme/Formulation' = total Lagrangian and " + given,
        "the wall stays in the initial configuration, and bodies move away "
        "from it. Give it for a 'Surface load', or take updated Lagrangian.");
    }



    void
    check_free_surface(const SimulationParameters &parameters)
    {
      const std::string given = "'Water/Free surface pressure', which is <" +
                                parameters.water.free_surface_pressure + ">";
      refuse_with_water(parameters.scheme.is_total_lagrangian(),
                        "'Scheme/Formulation' = total Lagrangian and " + given,
                        "the layer of points at the free surface is found "
                        "from their current cells; take updated Lagrangian, "
                        "or give 'Pore pressure' of a 'Surface load'.");
      refuse_with_water(!parameters.contacts.empty(),
                        "'Simulation/Contacts' and " + given,
                        "surfaces in contact are impervious, which the "
                        "layer of points at the free surface ignores. Give "
                        "'Pore pressure' of a 'Surface load'.");
      for (const auto &[name, load] : parameters.surface_loads)
        refuse_with_water(load.passes_water(),
                          given + " and 'Surface load " + name +
                            (load.flux.empty() ? "/Pore pressure'" : "/Flux'"),
                          "that surface is a part of the free surface. Give "
                          "one of them.");
    }



    void
    check_scheme_of_water(const SimulationParameters &parameters)
    {
      const std::string given_scheme =
        "'Scheme/Stress update' = " + parameters.scheme.stress_update;
      if (is_explicit_scheme(parameters.scheme.stress_update))
        {
          refuse_with_water(parameters.scheme.stress_update != "USL",
                            given_scheme,
                            "points deform with the velocity that the pressure "
                            "has corrected; take USL.");
          refuse_with_water(parameters.water.is_second_order,
                            "'Water/Integration' = BDF2 and " + given_scheme,
                            "the pressure belongs to the end of an explicit "
                            "step; take backward-euler.");
          refuse_with_water(parameters.time.has_half_steps(),
                            "'Time/Velocities at' = half steps and " +
                              given_scheme,
                            "the pressure belongs to whole steps; take full "
                            "steps.");
          const std::string &mass = parameters.scheme.mass;
          refuse_with_water(!support_of_mass(mass).explicit_water,
                            "'Scheme/Mass' = " + mass + " and " + given_scheme,
                            "take " +
                              masses_with(&MassSupport::explicit_water) + ".");
        }
      refuse_with_water(parameters.scheme.stress_update == "implicit-midpoint",
                        given_scheme,
                        "it conserves energy, but seepage dissipates energy; "
                        "take newmark or generalized-alpha.");
      refuse_with_water(parameters.scheme.has_projection(),
                        "'Scheme/Volumetric projection' = " +
                          parameters.scheme.volumetric_projection,
                        "take none.");
      refuse_with_water(parameters.scheme.averages_over_domains(),
                        "'Scheme/Functions' = domains",
                        "take points.");
      refuse_with_water(parameters.implicit_solver.method ==
                          TangentParameters::Method::cg,
                        "'Implicit solver/Method' = cg",
                        "its systems are nonsymmetric; take auto or fgmres.");
    }
  } // namespace



  bool
  has_pores(const SimulationParameters     &parameters,
            const std::vector<std::string> &bodies)
  {
    const auto materials = materials_of(parameters, bodies);
    return std::any_of(materials.begin(),
                       materials.end(),
                       [&](const std::string &name) {
                         return parameters.materials.at(name)->porosity > 0.;
                       });
  }



  bool
  is_drained(const SimulationParameters &parameters)
  {
    return !parameters.water.free_surface_pressure.empty() ||
           std::any_of(parameters.walls.pore_pressure.begin(),
                       parameters.walls.pore_pressure.end(),
                       [](const std::string &p) { return !p.empty(); }) ||
           std::any_of(parameters.surface_loads.begin(),
                       parameters.surface_loads.end(),
                       [](const auto &load) {
                         return !load.second.pore_pressure.empty();
                       });
  }



  std::string
  describe_water_at_boundaries(const SimulationParameters &parameters)
  {
    std::string result;
    const auto  add = [&](const std::string &name, const std::string &value) {
      if (!value.empty())
        result += (result.empty() ? "The water has '" : ", '") + name + "' <" +
                  formula_text(value) + ">";
    };
    for (unsigned int w = 0; w < 6; ++w)
      {
        const std::string wall = "Walls/" + WallParameters::names[w];
        add(wall + " pore pressure", parameters.walls.pore_pressure[w]);
        add(wall + " flux", parameters.walls.flux[w]);
      }
    for (const auto &[name, load] : parameters.surface_loads)
      {
        add("Surface load " + name + "/Pore pressure", load.pore_pressure);
        add("Surface load " + name + "/Flux", load.flux);
      }
    add("Water/Free surface pressure", parameters.water.free_surface_pressure);
    return result.empty() ? "" : result + ". ";
  }



  void
  SimulationParameters::check_water() const
  {
    if (!general.pore_water)
      {
        for (const auto &[name, material] : materials)
          refuse_pores("Material " + name + "/", *material);
        refuse_water(water, surface_loads);
        return;
      }
    const auto without_pores = materials_without_pores(*this);
    for (const auto &[name, material] : materials)
      if (without_pores.count(name) > 0)
        check_dry("Material " + name + "/", *material);
      else
        check_saturated("Material " + name + "/", *material, water);
    check_water_of_loads(*this);
    check_finite(water);
    check_cells_of_water(*this);
    refuse_with_water(has_body_grids() && contacts.empty(),
                      "'Grid/Per body' and sections 'Grid' of bodies",
                      "water flows between bodies on a common grid only. Leave "
                      "the grids of bodies out, or let 'Contacts' name the "
                      "bodies.");
    for (const auto &[name, body] : bodies)
      refuse_with_water(body.K0 >= 0. && water.table.empty() &&
                          has_pores(*this, {name}),
                        "'Body " + name + "/K0' without a 'Water/Table'",
                        "the effective stress is the weight of the soil less "
                        "the pressure of the water. Give the table or the "
                        "effective 'Stress', or begin with a stage that finds "
                        "it.");
  }



  void
  SimulationParameters::check_water_of_stage() const
  {
    for (unsigned int w = 0; w < 6; ++w)
      check_water_at_wall(*this, w);
    if (!general.pore_water)
      return;
    if (!water.free_surface_pressure.empty())
      check_free_surface(*this);
    check_scheme_of_water(*this);
  }
} // namespace greville
