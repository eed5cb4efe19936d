#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/simulation/consistent_mass.h>
#include <greville/simulation/parameters.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

namespace greville
{
  using namespace dealii;

  SimulationParameters::Registration::Registration()
  {
    ParameterAcceptor::prm.clear();
  }



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



    void
    declare_model(const std::string &material, const std::string &model)
    {
      ParameterHandler &prm = ParameterAcceptor::prm;
      prm.enter_subsection("Material " + material);
      prm.declare_entry("Model",
                        model,
                        Patterns::Selection(material_names() +
                                            (model.empty() ? "|" : "")),
                        "The constitutive law; it has to be given. Its "
                        "parameters stand in the same section.");
      prm.leave_subsection();
    }
  } // namespace



  SimulationParameters::SimulationParameters(const std::string &file)
    : directory(std::filesystem::path(file).parent_path().string())
    , lines(read_parameter_lines(
        file, "Simulation", {"Benchmark", "Problem"}, "mass_benchmark"))
  {
    read_names();
    for (const std::string &name : general.bodies)
      bodies[name] = std::make_unique<BodyParameters>("Body " + name);
    for (const std::string &name : general.tractions)
      tractions[name] =
        std::make_unique<TractionParameters>("Traction " + name);
    for (const std::string &name : general.materials)
      {
        const std::string model = value_of(lines, "Material " + name, "Model");
        materials[name]         = make_material(model,
                                        "Material " + name,
                                        "Material " + name + "/Model");
        declare_model(name, model);
      }

    check_method();
    parse_parameter_file(file, lines);
    if (general.name.empty())
      general.name = std::filesystem::path(file).stem().string();
    if (scheme.mass == "auto")
      scheme.mass = default_mass();
    for (std::string &mass : sweep.masses)
      if (mass == "auto")
        mass = default_mass();
    check();
    print_used();
    for (const auto &body : bodies)
      if (!body.second->points_file.empty())
        body.second->points_file = path_of(body.second->points_file);
    for (const auto &material : materials)
      material.second->reinit();
    ParameterAcceptor::prm.clear();
  }



  SimulationParameters::SimulationParameters()
  {
    general.bodies    = {"NAME"};
    bodies["NAME"]    = std::make_unique<BodyParameters>("Body NAME");
    tractions["NAME"] = std::make_unique<TractionParameters>("Traction NAME");
    declare_model("NAME", "");
    for (const std::string &model :
         Utilities::split_string_list(material_names(), '|'))
      materials[model] =
        make_material(model, "Material NAME of model " + model, "Model");
  }



  SimulationParameters::~SimulationParameters() = default;



  void
  SimulationParameters::check_method() const
  {
    const std::string method = value_of(lines, "Solver", "Method");
    for (const ParameterLine &line : lines)
      AssertThrow(line.section != "p-multigrid" ||
                    (!method.empty() && line.value != "auto"),
                  ExcMessage(line.place +
                             ": the section p-multigrid is for "
                             "'Solver/Method' = cg-p-multigrid, which has to "
                             "be set beside it. What was 'Coarsening' = auto "
                             "is 'Solver/Method' = cg-ic0."));
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
  SimulationParameters::read_names()
  {
    const auto list = [&](const std::string &entry) {
      const auto result =
        Utilities::split_string_list(value_of(lines, "Simulation", entry), ',');
      for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          AssertThrow(result[i] != result[j],
                      ExcMessage("The parameter 'Simulation/" + entry +
                                 "' has the name <" + result[i] + "> twice."));
      return result;
    };
    general.bodies    = list("Bodies");
    general.materials = list("Materials");
    general.tractions = list("Tractions");
    AssertThrow(!general.bodies.empty(),
                ExcMessage("The parameter 'Simulation/Bodies' is empty: a "
                           "simulation needs a body."));

    // A name and its section belong together.
    const std::pair<std::string, const std::vector<std::string> &> kinds[] = {
      {"Body", general.bodies},
      {"Material", general.materials},
      {"Traction", general.tractions}};
    const char *entries[] = {"Bodies", "Materials", "Tractions"};
    for (unsigned int k = 0; k < 3; ++k)
      {
        const std::string       &kind  = kinds[k].first;
        const auto              &names = kinds[k].second;
        std::vector<std::string> sections;
        for (const ParameterLine &line : lines)
          if (line.section.compare(0, kind.size() + 1, kind + " ") == 0)
            {
              sections.push_back(line.section.substr(kind.size() + 1));
              AssertThrow(
                std::count(names.begin(), names.end(), sections.back()) == 1,
                ExcMessage(line.place + ": there is a section '" +
                           line.section + "', but the parameter 'Simulation/" +
                           entries[k] + "' does not name <" + sections.back() +
                           ">." + did_you_mean(sections.back(), names)));
            }
        for (const std::string &name : names)
          AssertThrow(std::count(sections.begin(), sections.end(), name) > 0,
                      ExcMessage("The parameter 'Simulation/" +
                                 std::string(entries[k]) + "' has the name <" +
                                 name + ">, but there is no section '" + kind +
                                 " " + name + "'." +
                                 did_you_mean(name, sections)));
      }
  }



  void
  SimulationParameters::print_used()
  {
    // The copy lies elsewhere: it has absolute names of files.
    ParameterHandler &prm = ParameterAcceptor::prm;
    const auto        set = [&](const std::string &section,
                         const std::string &entry,
                         const std::string &value) {
      prm.enter_subsection(section);
      const std::string old = prm.get(entry);
      prm.set(entry, value);
      prm.leave_subsection();
      return old;
    };
    std::vector<std::array<std::string, 3>> entries;
    const auto with_path = [&](const std::string &section,
                               const std::string &entry,
                               const std::string &path) {
      entries.push_back(
        {{section,
          entry,
          path.empty() ? "" : std::filesystem::absolute(path).string()}});
    };
    entries.push_back({{"Simulation", "Name", general.name}});
    with_path("Reference", "Surface file", path_of(reference.surface_file));
    with_path("Reference", "Series file", path_of(reference.series_file));
    for (const auto &body : bodies)
      with_path("Body " + body.first,
                "Points file",
                path_of(body.second->points_file));
    for (auto &entry : entries)
      entry[2] = set(entry[0], entry[1], entry[2]);
    std::ostringstream text;
    prm.print_parameters(text, ParameterHandler::Text);
    used_text = text.str();
    // Setting an entry changes what the file has been read into, too.
    const std::string name = general.name;
    for (const auto &entry : entries)
      set(entry[0], entry[1], entry[2]);
    general.name = name;
  }



  namespace
  {
    template <typename T>
    std::string
    text_of(const T &value)
    {
      std::ostringstream text;
      text << value;
      return text.str();
    }



    template <typename T>
    void
    check_different(const std::vector<T> &entries, const std::string &parameter)
    {
      for (std::size_t i = 0; i < entries.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          AssertThrow(entries[i] != entries[j],
                      ExcMessage("The parameter '" + parameter +
                                 "' has the entry <" + text_of(entries[i]) +
                                 "> twice."));
    }
  } // namespace



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
      AssertThrow(traction.second->area > 0.,
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
    for (unsigned int w = 0; w < 2 * dim; ++w)
      AssertThrow(walls.type[w] != "friction" ||
                    !value_of(lines,
                              "Walls",
                              WallParameters::names[w] + " friction")
                       .empty(),
                  ExcMessage("The wall '" + WallParameters::names[w] +
                             "' is friction and needs a coefficient: the "
                             "parameter 'Walls/" +
                             WallParameters::names[w] + " friction'."));
    for (const auto &body : bodies)
      AssertThrow((body.second->K0 >= 0.) == !body.second->surface.empty(),
                  ExcMessage("'Body " + body.first +
                             "' needs both of 'K0' and 'Surface', or none."));
    for (const auto &body : bodies)
      {
        std::string known;
        for (const std::string &name : general.materials)
          known += (known.empty() ? "" : ", ") + name;
        AssertThrow(materials.count(body.second->material) == 1,
                    ExcMessage(
                      "The parameter 'Body " + body.first + "/Material' is <" +
                      body.second->material +
                      ">, which is none of the materials of "
                      "'Simulation/Materials': " +
                      known + "." +
                      did_you_mean(body.second->material, general.materials)));
      }
  }



  std::string
  SimulationParameters::path_of(const std::string &name) const
  {
    const std::filesystem::path path(name);
    return name.empty() || path.is_absolute() || directory.empty()
             ? name
             : (std::filesystem::path(directory) / path).string();
  }
} // namespace greville
