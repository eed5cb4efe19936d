// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/simulation/consistent_mass.h>
#include <greville/simulation/parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * The value of the last line with this parameter.
     */
    std::string
    value_of(const std::vector<ParameterLine> &lines,
             const std::string                &section,
             const std::string                &name)
    {
      std::string result;
      for (const ParameterLine &line : lines)
        if (line.section == section && line.name == name)
          result = line.value;
      return result;
    }



    template <typename T>
    void
    check_different(const std::vector<T> &entries,
                    const std::string    &parameter,
                    const std::string    &what = "entry")
    {
      for (auto entry = entries.begin(); entry != entries.end(); ++entry)
        AssertThrow(std::count(entries.begin(), entry, *entry) == 0,
                    ExcMessage("The parameter '" + parameter + "' has the " +
                               what + " <" + text_of(*entry) + "> twice."));
    }



    /**
     * The names of an entry of the section "Simulation".
     */
    std::vector<std::string>
    names_of(const std::vector<ParameterLine> &lines, const std::string &entry)
    {
      const auto result =
        Utilities::split_string_list(value_of(lines, "Simulation", entry), ',');
      check_different(result, "Simulation/" + entry, "name");
      return result;
    }



    /**
     * A name and its section belong together.
     */
    void
    check_sections(const std::vector<ParameterLine> &lines,
                   const std::string                &kind,
                   const std::string                &entry,
                   const std::vector<std::string>   &names)
    {
      std::vector<std::string> sections;
      for (const ParameterLine &line : lines)
        if (line.section.compare(0, kind.size() + 1, kind + " ") == 0)
          {
            sections.push_back(line.section.substr(kind.size() + 1));
            AssertThrow(
              std::count(names.begin(), names.end(), sections.back()) == 1,
              ExcMessage(line.place + ": there is a section '" + line.section +
                         "', but the parameter 'Simulation/" + entry +
                         "' does not name <" + sections.back() + ">." +
                         did_you_mean(sections.back(), names)));
          }
      for (const std::string &name : names)
        AssertThrow(std::count(sections.begin(), sections.end(), name) > 0,
                    ExcMessage("The parameter 'Simulation/" + entry +
                               "' has the name <" + name +
                               ">, but there is no section '" + kind + " " +
                               name + "'." + did_you_mean(name, sections)));
    }



    void
    declare_model(ParameterHandler  &prm,
                  const std::string &section,
                  const std::string &model)
    {
      prm.enter_subsection(section);
      prm.declare_entry("Model",
                        model,
                        Patterns::Selection(material_names() +
                                            (model.empty() ? "|" : "")),
                        "The constitutive law; it has to be given. Its "
                        "parameters stand in the same section.");
      prm.leave_subsection();
    }



    /**
     * Throws where a file means the solver by parameters that do not name it.
     */
    void
    check_method(const std::vector<ParameterLine> &lines)
    {
      const std::string method = value_of(lines, "Solver", "Method");
      for (const ParameterLine &line : lines)
        AssertThrow(line.section != "p-multigrid" ||
                      (!method.empty() && line.value != "auto"),
                    ExcMessage(
                      line.place +
                      ": the section p-multigrid is for 'Solver/Method' = "
                      "cg-p-multigrid, which has to be set beside it. What was "
                      "'Coarsening' = auto is 'Solver/Method' = cg-ic0."));
    }



    void
    check_friction(const WallParameters             &walls,
                   const std::vector<ParameterLine> &lines)
    {
      for (unsigned int w = 0; w < 6; ++w)
        AssertThrow(
          walls.type[w] != "friction" ||
            !value_of(lines, "Walls", WallParameters::names[w] + " friction")
               .empty(),
          ExcMessage("The wall '" + WallParameters::names[w] +
                     "' is friction and needs a coefficient: the parameter "
                     "'Walls/" +
                     WallParameters::names[w] + " friction'."));
    }
  } // namespace



  SimulationParameters::SimulationParameters()
  {
    // A symmetric cycle, for conjugate gradients.
    multigrid.restriction = "transpose";
    multigrid.smoother    = "ic0";
    smoother.overlap      = 2;
  }



  SimulationParameters::SimulationParameters(const std::string &file)
    : SimulationParameters()
  {
    const auto lines          = read_parameter_lines(file,
                                            "Simulation",
                                            {"Benchmark", "Problem"},
                                            "mass_benchmark");
    const auto body_names     = names_of(lines, "Bodies"),
               law_names      = names_of(lines, "Materials"),
               traction_names = names_of(lines, "Tractions");
    AssertThrow(!body_names.empty(),
                ExcMessage("The parameter 'Simulation/Bodies' is empty: a "
                           "simulation needs a body."));
    check_sections(lines, "Body", "Bodies", body_names);
    check_sections(lines, "Material", "Materials", law_names);
    check_sections(lines, "Traction", "Tractions", traction_names);
    for (const std::string &name : body_names)
      bodies[name];
    for (const std::string &name : traction_names)
      tractions[name];

    ParameterHandler prm;
    declare(prm);
    std::map<std::string, std::shared_ptr<Material>> laws;
    for (const std::string &name : law_names)
      {
        const std::string section = "Material " + name;
        const std::string model   = value_of(lines, section, "Model");
        laws[name]                = make_material(model, section + "/Model");
        declare_section(prm, section, *laws[name]);
        declare_model(prm, section, model);
      }
    materials.insert(laws.begin(), laws.end());

    check_method(lines);
    parse_parameter_file(prm, file, lines);
    if (general.name.empty())
      general.name = std::filesystem::path(file).stem().string();
    if (scheme.mass == "auto")
      scheme.mass = default_mass();
    for (std::string &mass : sweep.masses)
      if (mass == "auto")
        mass = default_mass();
    check();
    check_friction(walls, lines);

    // What is used lies elsewhere: it has absolute names of files.
    const auto set = [&](const std::string &section,
                         const std::string &entry,
                         const std::string &value) {
      prm.enter_subsection(section);
      prm.set(entry, value);
      prm.leave_subsection();
    };
    const auto locate = [&](const std::string &section,
                            const std::string &entry,
                            std::string       &name) {
      if (name.empty())
        return;
      const auto path = std::filesystem::path(file).parent_path() / name;
      set(section, entry, std::filesystem::absolute(path).string());
      name = path.string();
    };
    set("Simulation", "Name", general.name);
    locate("Reference", "Surface file", reference.surface_file);
    locate("Reference", "Series file", reference.series_file);
    for (auto &body : bodies)
      locate("Body " + body.first, "Points file", body.second.points_file);
    std::ostringstream text;
    prm.print_parameters(text, ParameterHandler::Text);
    used_text = text.str();

    for (const auto &law : laws)
      law.second->reinit("Material " + law.first);
  }



  void
  SimulationParameters::declare(ParameterHandler &prm)
  {
    declare_section(prm, "Simulation", general);
    declare_section(prm, "Grid", grid);
    declare_section(prm, "Time", time);
    declare_section(prm, "Scheme", scheme);
    declare_section(prm, "Walls", walls);
    declare_section(prm, "Loads", loads);
    declare_section(prm, "Exact solution", exact);
    declare_section(prm, "Sweep", sweep);
    declare_section(prm, "Reference", reference);
    declare_section(prm, "Output", output);
    declare_section(prm, "Solver", solver);
    declare_section(prm, "p-multigrid", multigrid);
    declare_section(prm, "Smoother", smoother);
    declare_section(prm, "Implicit", implicit);
    declare_section(prm, "Newton", newton);
    declare_section(prm, "Implicit solver", implicit_solver);
    declare_section(prm, "Implicit p-multigrid", implicit_solver.multigrid);
    declare_section(prm, "Implicit smoother", implicit_solver.smoother);
    for (auto &body : bodies)
      declare_section(prm, "Body " + body.first, body.second);
    for (auto &traction : tractions)
      declare_section(prm, "Traction " + traction.first, traction.second);
  }



  void
  SimulationParameters::print_reference(std::ostream &out)
  {
    SimulationParameters parameters;
    parameters.bodies["NAME"];
    parameters.tractions["NAME"];
    ParameterHandler prm;
    parameters.declare(prm);
    declare_model(prm, "Material NAME", "");
    std::vector<std::unique_ptr<Material>> laws;
    for (const std::string &model :
         Utilities::split_string_list(material_names(), '|'))
      {
        laws.push_back(make_material(model, "Model"));
        declare_section(prm, "Material NAME of model " + model, *laws.back());
      }
    print_parameter_reference(out, "greville", prm);
  }



  std::string
  SimulationParameters::default_mass() const
  {
    if (scheme.transfer == "APIC")
      return "lumped";
    for (const auto &material : materials)
      if (material.second->spreads())
        return "lumped";
    return "consistent";
  }



  void
  SimulationParameters::check() const
  {
    const unsigned int dim   = general.dimension;
    const auto         needs = [&](const std::size_t  size,
                           const std::string &name,
                           const std::string &what) {
      AssertThrow(size == dim,
                  ExcMessage("The parameter '" + name + "' takes " +
                             std::to_string(dim) + " " + what + " in " +
                             std::to_string(dim) +
                             "D (see 'Simulation/Dimension'), not " +
                             std::to_string(size) + "."));
    };
    needs(grid.lower.size(), "Grid/Lower corner", "numbers");
    needs(grid.upper.size(), "Grid/Upper corner", "numbers");
    needs(grid.cells.size(), "Grid/Cells", "numbers");
    for (unsigned int d = 0; d < dim; ++d)
      AssertThrow(grid.lower[d] < grid.upper[d],
                  ExcMessage("'Grid/Upper corner' has to be larger than "
                             "'Grid/Lower corner' in all directions, but " +
                             text_of(grid.upper[d]) + " is not above " +
                             text_of(grid.lower[d]) + "."));
    for (unsigned int w = 0; w < 2 * dim; ++w)
      AssertThrow((walls.type[w] == "moving") == !walls.velocity[w].empty(),
                  ExcMessage("The wall '" + WallParameters::names[w] + "' is " +
                             walls.type[w] + ", and '" +
                             WallParameters::names[w] + " velocity' is <" +
                             walls.velocity[w] +
                             ">: a moving wall has one, others have none."));

    // What is written stays below the folder that a file names.
    AssertThrow(general.name.find('/') == std::string::npos &&
                  general.name != "..",
                ExcMessage("The parameter 'Simulation/Name' is <" +
                           general.name +
                           ">: a name has no slashes; 'Output/Directory' is "
                           "for other folders."));
    for (const auto &part : std::filesystem::path(output.directory))
      AssertThrow(part != "..",
                  ExcMessage("The parameter 'Output/Directory' is <" +
                             output.directory +
                             ">: write the folder without '..'."));
    check_mass_name(scheme.mass, "Scheme/Mass");
    for (const std::string &name : sweep.masses)
      check_mass_name(name, "Sweep/Masses");
    check_different(sweep.cells, "Sweep/Cells");
    check_different(sweep.degrees, "Sweep/Orders");
    check_different(sweep.masses, "Sweep/Masses");
    check_different(sweep.quadratures, "Sweep/Quadratures");
    smoother.check();
    AssertThrow(scheme.transfer == "FLIP" || scheme.flip == 1.,
                ExcMessage("The parameter 'Scheme/FLIP share' is " +
                           text_of(scheme.flip) +
                           ", but 'Scheme/Transfer' is " + scheme.transfer +
                           ": a share belongs to FLIP."));
    AssertThrow(!time.step.empty() || (time.cfl > 0. && time.safety > 0.),
                ExcMessage("Without a 'Time/Step', the parameters 'Time/CFL "
                           "number' and 'Time/Safety' have to be above zero; "
                           "they are " +
                           text_of(time.cfl) + " and " + text_of(time.safety) +
                           "."));
    for (const auto &traction : tractions)
      AssertThrow(traction.second.area > 0.,
                  ExcMessage("The parameter 'Traction " + traction.first +
                             "/Area' has to be positive."));
    AssertThrow(reference.time_unit > 0. && reference.value_unit > 0.,
                ExcMessage("'Reference/Time unit' and 'Reference/Value unit' "
                           "have to be positive."));
    for (unsigned int w = 0; w < 6; ++w)
      AssertThrow((walls.friction[w] == 0. || walls.type[w] == "friction") &&
                    (w < 2 * dim || walls.type[w] == "free"),
                  ExcMessage("The wall '" + WallParameters::names[w] + "' is " +
                             walls.type[w] +
                             (w < 2 * dim ? ", but has a friction."
                                          : ", but there is none in 2D.")));
    for (const auto &body : bodies)
      AssertThrow((body.second.K0 >= 0.) == !body.second.surface.empty(),
                  ExcMessage("'Body " + body.first +
                             "' needs both of 'K0' and 'Surface', or none."));
    for (const auto &body : bodies)
      {
        AssertThrow(materials.count(body.second.material) == 1,
                    ExcMessage(
                      "The parameter 'Body " + body.first + "/Material' is <" +
                      body.second.material +
                      ">; it has to be one of the materials of "
                      "'Simulation/Materials': " +
                      boost::algorithm::join(general.materials, ", ") + "." +
                      did_you_mean(body.second.material, general.materials)));
      }
  }
} // namespace greville
