// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/base/shared_library.h>
#include <greville/materials/state_names.h>
#include <greville/materials/umat.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <functional>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
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



    std::vector<std::string>
    names_of(const std::vector<ParameterLine> &lines,
             const std::string                &entry,
             const std::string                &section = "Simulation")
    {
      const auto result =
        Utilities::split_string_list(value_of(lines, section, entry), ',');
      check_different(result, section + "/" + entry, "name");
      return result;
    }



    /// Check that each name has a section and each section a name.
    void
    check_sections(const std::vector<ParameterLine> &lines,
                   const std::string                &kind,
                   const std::string                &entry,
                   const std::vector<std::string>   &names,
                   const std::string                &of = "Simulation")
    {
      std::vector<std::string> sections;
      for (const ParameterLine &line : lines)
        if (line.section.compare(0, kind.size() + 1, kind + " ") == 0)
          {
            sections.push_back(line.section.substr(kind.size() + 1));
            // Stages contain sections, and bodies a grid.
            if (kind == "Stage" || kind == "Body")
              sections.back() =
                sections.back().substr(0, sections.back().find('/'));
            Require(contains(names, sections.back()),
                    line.place + ": there is a section '" + line.section +
                      "', but the parameter '" + of + "/" + entry +
                      "' does not name <" + sections.back() + ">." +
                      did_you_mean(sections.back(), names));
          }
      for (const std::string &name : names)
        Require(contains(sections, name),
                "The parameter '" + of + "/" + entry + "' has the name <" +
                  name + ">, but there is no section '" + kind + " " + name +
                  "'." + did_you_mean(name, sections));
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
                        "Constitutive law; required. Its parameters are set in "
                        "the same section.");
      prm.leave_subsection();
    }



    /// The kind of the surface load of a @p section. Throws if the section has
    /// a parameter of other kinds only.
    std::shared_ptr<SurfaceLoadKind>
    kind_of_load(const std::vector<ParameterLine> &lines,
                 const std::string                &section)
    {
      std::string name = value_of(lines, section, "Kind");
      if (name.empty())
        name = SurfaceLoadParameters().kind_name;
      std::shared_ptr<SurfaceLoadKind> result =
        make_surface_load_kind(name, section + "/Kind");
      std::map<std::string, std::vector<std::string>> kinds_with;
      for (const std::string &kind :
           Utilities::split_string_list(surface_load_kinds(), '|'))
        {
          ParameterHandler prm;
          const auto other = make_surface_load_kind(kind, section + "/Kind");
          declare_section(prm, section, *other);
          for (const std::string &parameter : names_in_section(prm, section))
            kinds_with[parameter].push_back(kind);
        }
      for (const ParameterLine &line : lines)
        if (line.section == section && kinds_with.count(line.name) > 0)
          {
            const auto &kinds = kinds_with[line.name];
            Require(contains(kinds, name),
                    line.place + ": the parameter '" + section + "/" +
                      line.name + "' belongs to 'Kind' = " +
                      boost::algorithm::join(kinds, " and ") + ", not " + name +
                      ".");
          }
      return result;
    }



    void
    declare_formulas(ParameterHandler                   &prm,
                     std::map<std::string, std::string> &formulas)
    {
      if (formulas.empty())
        return;
      prm.enter_subsection("Formulas");
      for (auto &[name, formula] : formulas)
        add_formula(prm, name, formula)(
          "Definition of a name for all formulas of the file: a formula of x, "
          "y, z, X, Y, Z, t and other names of this section, in any order. A "
          "formula can use the name if it has these variables. If a formula "
          "has a variable of the same name, such as h in 'Time/Step', the name "
          "means this variable.");
      prm.leave_subsection();
    }



    /// Load the libraries of plugins and user-defined laws, whose names become
    /// absolute. Throws with the line if this fails.
    std::vector<ParameterLine>
    with_libraries(std::vector<ParameterLine>   lines,
                   const std::filesystem::path &folder)
    {
      const auto absolute = [&](const std::string &name) {
        return std::filesystem::absolute(folder / name).string();
      };
      const std::vector<ParameterLine> given = lines;
      for (ParameterLine &line : lines)
        try
          {
            // Only the last line with this parameter counts.
            if (line.value != value_of(given, line.section, line.name))
              continue;
            const std::string parameter = line.section + "/" + line.name;
            if (parameter == "Simulation/Additional shared libraries")
              {
                std::vector<std::string> files;
                for (const std::string &name :
                     Utilities::split_string_list(line.value, ','))
                  {
                    files.push_back(absolute(name));
                    load_plugin(files.back(), parameter);
                  }
                line.value = boost::algorithm::join(files, ", ");
              }
            else if (line.name == "Library" && !line.value.empty() &&
                     value_of(given, line.section, "Model") == Umat::name)
              {
                line.value = absolute(line.value);
                Umat::find_function(line.value, parameter);
              }
          }
        catch (const std::exception &error)
          {
            Require(false, line.place + ": " + message_of(error));
          }
      return lines;
    }



    /// Call a function of a law, and add the section to its exceptions if they
    /// do not name it.
    void
    let_law_act(const std::string &section, const std::function<void()> &action)
    {
      const std::string begin = "'" + section + "': ";
      try
        {
          action();
        }
      catch (const std::exception &error)
        {
          const std::string message = message_of(error);
          const bool        has_name =
            message.find("'" + section) != std::string::npos;
          Require(false, (has_name ? "" : begin) + message);
        }
      catch (...)
        {
          Require(false, begin + "its law throws an exception.");
        }
    }



    /// Throw if a file selects the solver by parameters that do not name it.
    void
    check_method(const std::vector<ParameterLine> &lines)
    {
      const std::string method = value_of(lines, "Solver", "Method");
      for (const ParameterLine &line : lines)
        Require(line.section != "p-multigrid" || !method.empty(),
                line.place + ": the section p-multigrid is for 'Solver/Method' "
                             "= cg-p-multigrid: set it, too.");
    }



    void
    check_friction(const WallParameters             &walls,
                   const std::vector<ParameterLine> &lines,
                   const std::string                &stage)
    {
      for (unsigned int w = 0; w < 6; ++w)
        {
          const std::string name = WallParameters::names[w] + " friction";
          Require(walls.type[w] != "friction" ||
                    !value_of(lines, "Walls", name).empty() ||
                    (!stage.empty() &&
                     !value_of(lines, stage + "/Walls", name).empty()),
                  "The wall '" + WallParameters::names[w] +
                    "' is friction and needs a coefficient: the parameter '" +
                    (stage.empty() ? "" : stage + "/") + "Walls/" + name +
                    "'.");
        }
    }



    /// Return the text of a parameter file without parameters of the whole run
    /// that are repeated in stages: a resumed run changes such a value once.
    std::string
    without_common_times(const std::string &text)
    {
      std::istringstream       in(text);
      std::string              result;
      std::vector<std::string> sections;
      for (std::string line; std::getline(in, line);)
        {
          const std::string words = Utilities::trim(line);
          if (words.compare(0, 11, "subsection ") == 0)
            sections.push_back(words.substr(11));
          else if (words == "end" && !sections.empty())
            sections.pop_back();
          const bool is_common =
            sections.size() == 2 && sections[0].compare(0, 6, "Stage ") == 0 &&
            sections[1] == "Time" &&
            (words.compare(0, 9, "set Start") == 0 ||
             words.compare(0, 17, "set Maximum steps") == 0);
          if (!is_common)
            result += line + '\n';
        }
      return result;
    }



    /// Return the lines of sections that begin with a name, which is cut off.
    std::vector<ParameterLine>
    lines_of_stage(const std::vector<ParameterLine> &lines,
                   const std::string                &begin)
    {
      std::vector<ParameterLine> result;
      for (const ParameterLine &line : lines)
        for (const std::string section :
             {"Time", "Scheme", "Walls", "Loads", "Implicit", "Newton"})
          if (line.section == begin + section && !line.name.empty())
            {
              result.push_back(line);
              result.back().section = section;
              result.back().path    = {section};
            }
      return result;
    }



    using Laws = std::map<std::string, std::shared_ptr<Material>>;

    Laws
    make_laws(const std::vector<ParameterLine> &lines, ParameterHandler &prm)
    {
      Laws laws;
      for (const std::string &name : names_of(lines, "Materials"))
        {
          const std::string section = "Material " + name;
          const std::string model   = value_of(lines, section, "Model");
          laws[name]                = make_material(model, section + "/Model");
          let_law_act(section,
                      [&]() { declare_section(prm, section, *laws[name]); });
          declare_model(prm, section, model);
        }
      return laws;
    }



    /// Return the mass for "auto": lumped with APIC and Taylor, and in updated
    /// Lagrangian steps also if bodies spread into thin layers or with friction
    /// walls; otherwise consistent.
    std::string
    default_mass(
      const StageSections                                          &stage,
      const std::map<std::string, std::shared_ptr<const Material>> &laws)
    {
      const bool spreads =
        std::any_of(laws.begin(), laws.end(), [](const auto &law) {
          return law.second->spreads();
        });
      const bool is_lumped =
        stage.scheme.has_affine() ||
        (!stage.scheme.is_total_lagrangian() &&
         (spreads || contains(stage.walls.type, "friction")));
      return is_lumped ? "lumped" : "consistent";
    }
  } // namespace



  void
  SimulationParameters::read(const std::string                  &file,
                             const std::vector<ParameterLine>   &given_lines,
                             const ParameterHandler::OutputStyle style)
  {
    const std::filesystem::path folder =
      std::filesystem::path(file).parent_path();
    const auto lines = with_libraries(given_lines, folder);
    make_sections(lines);
    make_stages(lines);

    if (value_of(lines, "Simulation", "Pore water") == "true")
      output.fields.push_back("pore_pressure");
    ParameterHandler prm;
    declare(prm);
    std::map<std::string, std::string> formulas;
    for (const ParameterLine &line : lines)
      if (line.section == "Formulas" && !line.name.empty())
        formulas[line.name];
    declare_formulas(prm, formulas);
    const Laws laws = make_laws(lines, prm);
    materials.insert(laws.begin(), laws.end());
    check_method(lines);
    parse_parameter_lines(prm, lines, former_parameters());
    if (general.name.empty())
      general.name = std::filesystem::path(file).stem().string();
    locate_files(folder, prm);
    grid.complete(general.dimension, prm);
    std::ostringstream text;
    prm.print_parameters(text, style);
    used_text = without_common_times(text.str());
    NamedFormulas(formulas, Utilities::split_string_list(shape_names(), '|'))
      .attach_to(prm);

    complete_stages();
    // The left wall of a grid that begins at the axis is the axis.
    if (grid.has_axis())
      {
        for (StageParameters &stage : stages)
          if (stage.walls.type[0] == "free")
            stage.walls.type[0] = "sliding";
        if (walls.type[0] == "free")
          walls.type[0] = "sliding";
      }
    check();
    if (stages.empty())
      check_friction(walls, lines, "");
    for (const StageParameters &stage : stages)
      check_friction(stage.walls, lines, "Stage " + stage.name);
    for (const auto &[name, law] : laws)
      let_law_act("Material " + name, [&, &law = law, &name = name]() {
        law->reinit("Material " + name);
        check_state_names(law->state_names(), "Material " + name);
      });
  }



  void
  SimulationParameters::make_sections(const std::vector<ParameterLine> &lines)
  {
    const auto body_names    = names_of(lines, "Bodies"),
               law_names     = names_of(lines, "Materials"),
               load_names    = names_of(lines, "Surface loads"),
               rigid_names   = names_of(lines, "Rigid bodies"),
               contact_names = names_of(lines, "Contacts"),
               region_names  = names_of(lines, "Refinement", "Grid");
    if (body_names.empty())
      for (const ParameterLine &line : lines)
        {
          const std::string hint = did_you_mean(line.section, {"Simulation"});
          Require(hint.empty() || line.section == "Simulation",
                  line.place + ": there is no section '" + line.section + "'." +
                    hint);
        }
    Require(
      !body_names.empty(),
      "The parameter 'Simulation/Bodies' is empty: a simulation needs a body.");
    check_sections(lines, "Body", "Bodies", body_names);
    check_sections(lines, "Material", "Materials", law_names);
    check_sections(lines, "Surface load", "Surface loads", load_names);
    check_sections(lines, "Rigid body", "Rigid bodies", rigid_names);
    check_sections(lines, "Contact", "Contacts", contact_names);
    check_sections(lines, "Stage", "Stages", names_of(lines, "Stages"));
    check_sections(lines, "Refinement", "Refinement", region_names, "Grid");
    for (const std::string &name : region_names)
      grid.regions[name];
    for (const std::string &name : body_names)
      {
        bodies[name];
        body_grids[name];
      }
    for (const std::string &name : load_names)
      surface_loads[name].kind = kind_of_load(lines, "Surface load " + name);
    for (const std::string &name : rigid_names)
      rigid_bodies[name];
    for (const std::string &name : contact_names)
      contacts[name];
  }



  void
  SimulationParameters::locate_files(const std::filesystem::path &folder,
                                     ParameterHandler            &prm)
  {
    const auto locate = [&](const std::string &section,
                            const std::string &entry,
                            std::string       &name) {
      if (name.empty())
        return;
      const auto path = folder / name;
      set_parameter(prm,
                    {section},
                    entry,
                    std::filesystem::absolute(path).string());
      name = path.string();
    };
    set_parameter(prm, {"Simulation"}, "Name", general.name);
    locate("Reference", "Surface file", reference.surface_file);
    locate("Reference", "Failure line file", reference.failure_line_file);
    locate("Reference", "Series file", reference.series_file);
    for (auto &body : bodies)
      {
        locate("Body " + body.first, "Points file", body.second.points_file);
        locate("Body " + body.first, "Shape file", body.second.shape_file);
      }
    for (auto &[name, body] : rigid_bodies)
      locate("Rigid body " + name, "Shape file", body.shape_file);
  }



  void
  SimulationParameters::complete_stages()
  {
    for (StageParameters &stage : stages)
      {
        const auto check_common = [&](const bool         is_same,
                                      const std::string &name,
                                      const double       value) {
          Require(
            is_same,
            "The parameter 'Stage " + stage.name + "/Time/" + name + "' is <" +
              text_of(value) +
              ">. It belongs to the whole run: set it in the section 'Time' "
              "outside of stages. A stage begins when the stage before ends.");
        };
        check_common(stage.time.start == time.start, "Start", stage.time.start);
        check_common(stage.time.max_steps == time.max_steps,
                     "Maximum steps",
                     stage.time.max_steps);
        if (stage.scheme.mass == "auto")
          stage.scheme.mass = default_mass(stage, materials);
      }
    find_materials();
    if (!stages.empty())
      enter_stage(0);
    if (scheme.mass == "auto")
      scheme.mass = default_mass(*this, materials);
    for (std::string &mass : sweep.masses)
      if (mass == "auto")
        mass = default_mass(*this, materials);
  }



  void
  SimulationParameters::make_stages(const std::vector<ParameterLine> &lines)
  {
    const auto names = names_of(lines, "Stages");
    if (names.empty())
      return;
    // All stages begin with the values of the sections outside of stages.
    StageParameters  common;
    ParameterHandler prm;
    common.declare_sections(prm);
    parse_parameter_lines(prm, lines_of_stage(lines, ""), former_parameters());
    for (const std::string &name : names)
      {
        stages.push_back(common);
        stages.back().name    = name;
        WallParameters &walls = stages.back().walls;
        // If the stage gives a wall another type, the wall does not inherit its
        // other parameters.
        for (const ParameterLine &line :
             lines_of_stage(lines, "Stage " + name + "/"))
          for (unsigned int w = 0; w < 6; ++w)
            if (line.section == "Walls")
              {
                const std::string &wall = WallParameters::names[w];
                if (line.name == wall && line.value != walls.type[w])
                  {
                    walls.velocity[w] = walls.displacement[w] = "";
                    walls.region[w]                           = "";
                    walls.friction[w]                         = 0.;
                  }
                else if (line.name == wall + " velocity")
                  walls.displacement[w] = "";
                else if (line.name == wall + " displacement")
                  walls.velocity[w] = "";
              }
      }
  }



  void
  SimulationParameters::use_reference(const UseParameters &use)
  {
    SimulationParameters parameters;
    parameters.bodies["NAME"];
    parameters.surface_loads["NAME"];
    parameters.rigid_bodies["NAME"];
    parameters.contacts["NAME"];
    parameters.grid.regions["NAME"];
    ParameterHandler prm;
    parameters.declare(prm);
    StageParameters stage;
    declare_section(prm, "Stage NAME", stage);
    std::map<std::string, std::string> formulas = {{"NAME", ""}};
    declare_formulas(prm, formulas);
    declare_model(prm, "Material NAME", "");
    std::vector<std::unique_ptr<Material>> laws;
    for (const std::string &model :
         Utilities::split_string_list(material_names(), '|'))
      {
        laws.push_back(make_material(model, "Model"));
        declare_section(prm, "Material NAME of model " + model, *laws.back());
      }
    std::vector<std::unique_ptr<SurfaceLoadKind>> kinds;
    for (const std::string &kind :
         Utilities::split_string_list(surface_load_kinds(), '|'))
      {
        kinds.push_back(make_surface_load_kind(kind, "Kind"));
        declare_section(prm,
                        "Surface load NAME of kind " + kind,
                        *kinds.back());
      }
    use(prm);
  }
} // namespace greville
