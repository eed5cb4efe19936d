// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/in_stage.h>
#include <greville/parameters/names.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Check that output stays inside the folder that a file names.
    void
    check_output(const std::string &name, const OutputParameters &output)
    {
      Require(
        name.find('/') == std::string::npos && name != "..",
        "The parameter 'Simulation/Name' is <" + name +
          ">: a name has no slashes; 'Output/Directory' is for other folders.");
      Require(output.directory != "~" &&
                output.directory.compare(0, 2, "~/") != 0,
              "The parameter 'Output/Directory' is <" + output.directory +
                ">: parameter files do not expand ~. Write the full path.");
      for (const auto &part : std::filesystem::path(output.directory))
        Require(part != "..",
                "The parameter 'Output/Directory' is <" + output.directory +
                  ">: write the folder without '..'.");
      if (output.statistics_every != "auto")
        {
          double every = -1.;
          try
            {
              every = Utilities::string_to_double(output.statistics_every);
            }
          catch (const std::exception &)
            {}
          Require(every >= 0. && std::isfinite(every),
                  "The parameter 'Output/Statistics every' is <" +
                    output.statistics_every +
                    ">; it has to be auto or a nonnegative number of seconds.");
        }
    }



    void
    check_sweep(const SweepParameters &sweep)
    {
      for (const std::string &name : sweep.masses)
        check_mass_name(name, "Sweep/Masses");
      check_different(sweep.cells, "Sweep/Cells");
      check_different(sweep.degrees, "Sweep/Orders");
      check_different(sweep.formulations, "Sweep/Formulations");
      check_different(sweep.masses, "Sweep/Masses");
      check_different(Utilities::split_string_list(sweep.values, '|'),
                      "Sweep/Values");
      Require(sweep.parameter.empty() == sweep.values.empty(),
              "'Sweep' needs both of 'Parameter' and 'Values', or none.");
      Require(sweep.parameter.empty() ||
                (sweep.parameter.find('/') != std::string::npos &&
                 sweep.parameter.compare(0, 6, "Sweep/") != 0 &&
                 sweep.parameter != "Output/Directory"),
              "The parameter 'Sweep/Parameter' is <" + sweep.parameter +
                ">: it takes a parameter of another section, written as "
                "SECTION/PARAMETER, such as Material clay/Cohesion, but not "
                "'Output/Directory'.");
    }



    void
    check_materials_of_bodies(const SimulationParameters &parameters)
    {
      for (const auto &body : parameters.bodies)
        Require((body.second.K0 >= 0.) == !body.second.surface.empty(),
                "'Body " + body.first +
                  "' needs both of 'K0' and 'Surface', or none.");
      const auto check_material = [&](const std::string &body,
                                      const std::string &material) {
        const auto &known = parameters.general.materials;
        check_known(material,
                    "Body " + body + "/Material",
                    known,
                    "the materials of 'Simulation/Materials': " +
                      boost::algorithm::join(known, ", "));
      };
      for (const auto &body : parameters.bodies)
        check_material(body.first, body.second.material);
      // Stages may give a body its own material later than the first one.
      for (const auto &stage : parameters.stages)
        for (const auto &[body, material] : stage.material_of)
          check_material(body, material);
    }



    /// Check @p parameters, which have entered the stage k, with @p all stages.
    void
    check_change_of_stage(const SimulationParameters &all,
                          const unsigned int          k,
                          const SimulationParameters &parameters)
    {
      SimulationParameters first = all;
      first.enter_stage(0);
      const double start = parameters.time.start, end = parameters.time.end;
      Require(parameters.scheme.formulation == all.stages[0].scheme.formulation,
              all.stage_text(k) + "'Scheme/Formulation' is " +
                parameters.scheme.formulation + ", but the first stage has " +
                all.stages[0].scheme.formulation +
                ": all stages need the same.");
      Require(!(all.stages[k].reset_displacements &&
                parameters.scheme.is_total_lagrangian()),
              all.stage_text(k) +
                "'Reset displacements' does not support 'Scheme/Formulation' = "
                "total Lagrangian, in which basis functions belong to the "
                "initial positions.");
      // Times of steps have round-off errors.
      Require(start + 1e-12 * std::max(std::abs(start), std::abs(end)) < end,
              all.stage_text(k) + "'Time/End' is " + text_of(end) +
                " s, but the stage begins at " + text_of(start) +
                " s. Time continues over the stages: each 'End' has to be "
                "later than the one before.");
      for (unsigned int w = 0; w < 2 * all.general.dimension; ++w)
        Require(parameters.walls.is_periodic(w) == first.walls.is_periodic(w),
                all.stage_text(k) + "the wall '" + WallParameters::names[w] +
                  "' is " + parameters.walls.type[w] + ", but it is " +
                  first.walls.type[w] +
                  " in the first stage: a wall is periodic in all stages or in "
                  "none.");
    }



    void
    check_total_lagrangian(const SimulationParameters &parameters)
    {
      const Refusal refuse{"'Scheme/Formulation' = total Lagrangian"};
      refuse(parameters.scheme.transfer == "APIC",
             "'Scheme/Transfer' = APIC",
             "take FLIP, PIC or Taylor.");
      for (unsigned int w = 0; w < 2 * parameters.general.dimension; ++w)
        refuse(parameters.walls.type[w] == "friction",
               "'Walls/" + WallParameters::names[w] + "' = friction",
               "walls act on the initial configuration, which does not slide "
               "along them.");
    }



    void
    check_friction_walls(const SimulationParameters &parameters)
    {
      for (unsigned int w = 0; w < 2 * parameters.general.dimension; ++w)
        Require(parameters.walls.type[w] != "friction" ||
                  support_of_mass(parameters.scheme.mass).friction_walls ||
                  is_implicit_scheme(parameters.scheme.stress_update),
                "'Walls/" + WallParameters::names[w] +
                  "' = friction does not support 'Scheme/Mass' = " +
                  parameters.scheme.mass + ": take " +
                  masses_with(&MassSupport::friction_walls) +
                  ", or a rigid body that 'Contacts' name, such as "
                  "half_space(0, 1, 0).");
    }



    void
    check_domains(const SimulationParameters &parameters)
    {
      const Refusal refuse{"'Scheme/Functions' = domains"};
      refuse(parameters.scheme.is_total_lagrangian(),
             "'Scheme/Formulation' = total Lagrangian",
             "points do not move through cells; take points.");
      refuse(parameters.scheme.has_projection(),
             "'Scheme/Volumetric projection' = " +
               parameters.scheme.volumetric_projection,
             "it projects gradients at points; take none.");
      refuse(is_explicit_scheme(parameters.scheme.stress_update) &&
               !support_of_mass(parameters.scheme.mass).domains,
             "'Scheme/Mass' = " + parameters.scheme.mass,
             "take " + masses_with(&MassSupport::domains) + ".");
      refuse(parameters.scheme.has_affine(),
             "'Scheme/Transfer' = " + parameters.scheme.transfer,
             "take FLIP or PIC.");
      for (const auto &body : parameters.bodies)
        refuse(body.second.points_file.empty() &&
                 (body.second.placement == Placement::gauss ||
                  body.second.placement == Placement::fitted),
               "'Body " + body.first +
                 "/Placement' = " + word_of(body.second.placement, placements),
               "no boxes around such points fill a cell; take equidistant or "
               "fitted lattice.");
    }



    /// Check the motion, the regions and the friction of the walls.
    void
    check_walls(const WallParameters &walls, const unsigned int dim)
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        {
          const std::string &name = WallParameters::names[w];
          const std::string &v    = walls.velocity[w];
          const std::string &d    = walls.displacement[w];
          Require(v.empty() || d.empty(),
                  "The wall '" + name + "' has both of '" + name +
                    " velocity' (<" + v + ">) and '" + name +
                    " displacement' (<" + d + ">): give one of them.");
          Require(
            walls.type[w] == "sliding" ||
              (walls.type[w] == "moving") == !(v + d).empty(),
            "The wall '" + name + "' is " + walls.type[w] + ", and '" + name +
              (!d.empty() ? " displacement' is <" + d + ">"
               : !v.empty()
                 ? " velocity' is <" + v + ">"
                 : " velocity' and '" + name + " displacement' are empty") +
              ": a moving wall needs one of them, a sliding wall may have "
              "one, other walls have none.");
          Require(
            walls.region[w].empty() || walls.type[w] == "fixed" ||
              walls.type[w] == "sliding" || walls.type[w] == "moving",
            "The wall '" + name + "' is " + walls.type[w] + ", and '" + name +
              " region' is <" + formula_text(walls.region[w]) +
              ">: only fixed, sliding and moving walls may have a region.");
        }
      for (unsigned int w = 0; w < 2 * dim; ++w)
        Require(walls.friction[w] == 0. || walls.type[w] == "friction",
                "The wall '" + WallParameters::names[w] + "' is " +
                  walls.type[w] + ", but has a coefficient of friction.");
      for (unsigned int w = 2 * dim; w < 6; ++w)
        {
          const std::string &name = WallParameters::names[w];
          Require(walls.type[w] == "free",
                  "The wall '" + name + "' is " + walls.type[w] +
                    ", but there is no such wall in 2D.");
          for (const auto &[what, value] :
               {std::make_pair(" velocity", walls.velocity[w]),
                std::make_pair(" displacement", walls.displacement[w]),
                std::make_pair(" region", walls.region[w]),
                std::make_pair(" friction",
                               walls.friction[w] == 0.
                                 ? std::string()
                                 : text_of(walls.friction[w]))})
            Require(value.empty(),
                    "The parameter 'Walls/" + name + what + "' is <" + value +
                      ">, but there is no such wall in 2D.");
        }
    }



    void
    check_periodic_walls(const SimulationParameters &parameters)
    {
      const WallParameters &walls     = parameters.walls;
      const GridParameters &grid      = parameters.grid;
      const unsigned int    dim       = parameters.general.dimension;
      const bool            has_water = parameters.general.pore_water;
      for (unsigned int w = 0; w < 2 * dim; w += 2)
        {
          const bool is_periodic = walls.is_periodic(w);
          Require(is_periodic == walls.is_periodic(w + 1),
                  "The wall '" + WallParameters::names[w] + "' is " +
                    walls.type[w] + " and '" + WallParameters::names[w + 1] +
                    "' is " + walls.type[w + 1] +
                    ": both or none have to be periodic.");
          // Cells of the pore pressure are twice as large.
          const unsigned int n =
                               grid.cells.size() == dim ? grid.cells[w / 2] : 0,
                             needed = (has_water ? 2 : 1) * (grid.degree + 1);
          Require(!is_periodic || grid.knots[w / 2].empty(),
                  "The walls '" + WallParameters::names[w] + "' and '" +
                    WallParameters::names[w + 1] +
                    "' are periodic, and there are 'Grid/Knots " +
                    std::string(1, "xyz"[w / 2]) +
                    "' between them: cells in a periodic direction are equal.");
          Require(!is_periodic || n == 0 || n >= needed,
                  "The parameter 'Grid/Cells' has " + std::to_string(n) +
                    " cells from '" + WallParameters::names[w] + "' to '" +
                    WallParameters::names[w + 1] + "', which are periodic: " +
                    (has_water
                       ? "the pressure of pore water has half as many, and "
                       : "") +
                    "B-splines of 'Grid/Order' " + std::to_string(grid.degree) +
                    " need " + std::to_string(needed) +
                    " cells or more, so that none overlaps itself.");
        }
    }
  } // namespace



  void
  SimulationParameters::check() const
  {
    if (grid.is_axisymmetric())
      check_axisymmetry();
    grid.check(general.dimension);
    if (has_body_grids())
      check_body_grids();
    Require(solver.tolerance == 0. || solver.tolerance >= 1e-15,
            "The parameter 'Solver/Tolerance' is <" +
              text_of(solver.tolerance) +
              ">; it has to be 0 or a number between 1e-15 and 1.");
    check_output(general.name, output);
    check_sweep(sweep);
    load_balance.check();
    for (const auto &load : surface_loads)
      load.second.check("Surface load " + load.first, bodies);
    check_contacts();
    check_materials_of_bodies(*this);
    if (grid.is_refined())
      check_refinement();
    else
      Require(!grid.has_changing_cells() && grid.most_cells == 0,
              "The parameters 'Adapt every', 'Adapt at start' and 'Most cells' "
              "of 'Grid' need regions in 'Grid/Refinement'.");
    Require(!output.has_stress_jumps() ||
              std::any_of(grid.regions.begin(),
                          grid.regions.end(),
                          [](const auto &region) {
                            return region.second.indicator ==
                                   Indicator::stress_jump;
                          }),
            "The field stress_jump of 'Output/Fields' needs a region of "
            "'Grid/Refinement' with 'Indicator' = stress jump.");
    check_construction();
    check_water();
    if (stages.empty())
      check_stage();
    for (unsigned int k = 0; k < stages.size(); ++k)
      {
        SimulationParameters parameters = *this;
        parameters.enter_stage(k);
        check_change_of_stage(*this, k, parameters);
        in_stage(*this, k, [&]() { parameters.check_stage(); });
      }
  }



  namespace
  {
    /// Throw unless hat functions can have the larger cells of two bodies.
    void
    check_cells(const std::string          &name,
                const ContactParameters    &contact,
                const SimulationParameters &parameters)
    {
      std::vector<GridParameters> grids;
      for (const auto &side : contact.sides())
        for (const std::string &body : side)
          grids.push_back(parameters.grid_of(body));
      const GridParameters &first = grids[0];
      for (const GridParameters &other : grids)
        Require((first.is_uniform() && other.is_uniform()) ||
                  (first.knots == other.knots && first.cells == other.cells &&
                   first.lower == other.lower && first.upper == other.upper),
                "'Grid/Knots' do not support sections 'Body NAME/Grid' with "
                "other cells in 'Contact " +
                  name + "': both bodies need the cells of one grid.");
    }
  } // namespace



  void
  SimulationParameters::check_contacts() const
  {
    Require(contacts.empty() || implicit_solver.multigrid.coarsens_lattices(),
            "'Implicit solver/Levels' = orders does not support "
            "'Simulation/Contacts': take lattice or hp.");
    for (const auto &[name, contact] : contacts)
      {
        contact.check("Contact " + name, bodies, rigid_bodies);
        Require(!contact.is_by_material_points() ||
                  !scheme.is_total_lagrangian(),
                "'Contact " + name +
                  "/Contactors' = material points does not support "
                  "'Scheme/Formulation' = total Lagrangian, in which surfaces "
                  "stay whole: take surface points.");
        if (rigid_bodies.count(contact.sides()[1][0]) == 0)
          check_cells(name, contact, *this);
      }
    for (const auto &[name, body] : rigid_bodies)
      {
        body.check("Rigid body " + name, general.dimension);
        Require(bodies.count(name) == 0,
                "The name <" + name +
                  "> is in both 'Simulation/Bodies' and 'Rigid bodies'.");
        const auto is_met = [&name = name](const auto &contact) {
          return contact.second.sides()[1] == std::vector<std::string>{name};
        };
        Require(std::any_of(contacts.begin(), contacts.end(), is_met),
                "'Rigid body " + name +
                  "' is in no contact: nothing meets it. Name it as the second "
                  "one of 'Contact NAME/Bodies'.");
      }
    // Pressure and friction would count twice.
    std::map<std::set<std::string>, std::string> contact_of;
    for (const auto &[name, contact] : contacts)
      {
        const auto sides = contact.sides();
        for (const std::string &first : sides[0])
          for (const std::string &second : sides[1])
            {
              const auto added =
                contact_of.emplace(std::set<std::string>{first, second}, name);
              Require(added.second,
                      "The parameter 'Contact " + name + "/Bodies' is <" +
                        contact.bodies + ">, but <" + first + "> and <" +
                        second + "> are in 'Contact " + added.first->second +
                        "' already: two bodies can have only one contact.");
            }
      }
    const auto groups = body_groups();
    for (const auto &[name, contact] : contacts)
      for (const auto &group : groups)
        {
          const auto sides = contact.sides();
          const auto has   = [&](const unsigned int side) {
            return contains(group, sides[side][0]);
          };
          Require(!has(0) || !has(1),
                  "'Contact " + name + "/Bodies' is <" + contact.bodies +
                    ">, but another contact joins them by '+': bodies that "
                    "stick have no contact.");
        }
    for (unsigned int w = 0; w < 2 * general.dimension && !contacts.empty();
         ++w)
      Require(!walls.is_periodic(w),
              "'Walls/" + WallParameters::names[w] +
                "' = periodic does not support 'Simulation/Contacts': surfaces "
                "do not meet across periodic walls.");
  }



  void
  SimulationParameters::check_stage() const
  {
    check_walls(walls, general.dimension);
    check_periodic_walls(*this);
    check_mass_name(scheme.mass, "Scheme/Mass");
    if (grid.is_axisymmetric())
      check_axisymmetry_of_stage();
    if (scheme.is_total_lagrangian())
      check_total_lagrangian(*this);
    check_friction_walls(*this);
    if (scheme.averages_over_domains())
      check_domains(*this);
    check_water_of_stage();
    if (grid.is_refined())
      check_refinement_of_stage();
    Require(scheme.is_flip() || scheme.flip == 1.,
            "The parameter 'Scheme/FLIP share' is " + text_of(scheme.flip) +
              ", but 'Scheme/Transfer' is " + scheme.transfer +
              ": only FLIP and Taylor have a share.");
    Require(time.start <= time.end,
            "'Time/Start' is " + text_of(time.start) +
              " s, after 'Time/End', " + text_of(time.end) + " s.");
    Require(!time.step.empty() || (time.cfl > 0. && time.safety > 0.),
            "Without a 'Time/Step', the parameters 'Time/CFL number' and "
            "'Time/Safety' have to be above zero; they are " +
              text_of(time.cfl) + " and " + text_of(time.safety) + ".");
  }
} // namespace greville
