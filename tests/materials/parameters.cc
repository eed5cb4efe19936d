// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks the list of materials, messages for wrong input, and that every
// parameter of every material has an effect. For the parameters of umat see
// umat.cc.

#include <greville/materials/material_lanes.h>
#include <greville/materials/state_names.h>

#include "materials.h"
#include <sstream>

namespace
{
  // The answers of a material: moduli, and stress, energy, heat, wave
  // modulus and history along a motion that yields, softens, is torn and flows.
  std::vector<double>
  behaviour(const Material &material)
  {
    const Moduli        moduli = material.moduli();
    std::vector<double> result = {moduli.bulk,
                                  moduli.shear,
                                  moduli.viscosity,
                                  moduli.bulk_viscosity,
                                  material.density};
    for (const double volume : {-1e-4, 2e-4})
      {
        MaterialPoint point      = rest(material);
        point.strength_reduction = material.strength_reduction(0.);
        Tensor2 f                = (1 + volume) * one_tensor();
        f[0][1]                  = 1e-3;
        f[2][2] -= 2e-4;
        for (unsigned int n = 0; n < 100; ++n)
          step(material, point, f, 1e-3);
        for (unsigned int i = 0; i < 6; ++i)
          result.push_back(point.stress.access_raw_entry(i));
        result.insert(result.end(),
                      {point.wave_modulus,
                       material.strain_energy(point),
                       material.dissipation(point)});
        result.insert(result.end(),
                      point.state.first.begin(),
                      point.state.first.end());
      }
    return result;
  }



  // Change one parameter after the other in a material with @p settings.
  void
  test_effects(const std::string              &name,
               const std::vector<std::string> &settings,
               std::vector<std::string>        changes)
  {
    print() << name << std::endl;
    const auto   before   = behaviour(*make(name, settings));
    unsigned int declared = 0;
    // Each declared parameter is among the changes.
    ParameterHandler  prm;
    std::stringstream parameters;
    const auto        material = make_material(name, "Name");
    material->declare(prm);
    prm.print_parameters(parameters, ParameterHandler::ShortPRM);
    // Those of pore water have no effect on a law (tests/runs/terzaghi_column).
    for (std::string line; std::getline(parameters, line);)
      declared += line.find("set ") != std::string::npos &&
                  line.find("Porosity") == std::string::npos &&
                  line.find("onductivity") == std::string::npos;
    changes.push_back("Density = 1234");
    check("  parameters", declared == changes.size());
    for (const std::string &change : changes)
      {
        auto changed = settings;
        changed.push_back(change);
        const auto after  = behaviour(*make(name, changed));
        bool       differ = false;
        for (unsigned int i = 0; i < after.size(); ++i)
          differ = differ ||
                   std::abs(after[i] - before[i]) > 1e-6 * std::abs(before[i]);
        check("  " + change + " has an effect", differ);
      }
  }



  // A law with a long history: number k counts steps k times, and the last ones
  // are its energies.
  class Remembering : public MaterialLaw<Remembering>
  {
  public:
    static constexpr unsigned int n = 30;

    std::vector<std::string>
    state_names() const override
    {
      std::vector<std::string> names;
      for (unsigned int k = 0; k < n; ++k)
        names.push_back("number_" + std::to_string(k));
      return names;
    }

    void
    initialize(MaterialPoint          &point,
               const SymmetricTensor2 &stress) const override
    {
      point.F      = one_tensor();
      point.stress = stress;
      point.state.resize(n);
    }

    void
    update_point(MaterialPoint &point) const
    {
      for (unsigned int k = 0; k < n; ++k)
        point.state[k] += k;
      point.stress = point.state[n - 1] * symmetrize(point.increment);
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      return point.state[n - 1];
    }

    double
    dissipation(const MaterialPoint &point) const override
    {
      return point.state[n - 2];
    }

    Moduli
    moduli() const override
    {
      return {};
    }
  };



  // Steps, tangents by differences and energies of several points at once keep
  // all numbers apart.
  void
  test_long_history()
  {
    const auto                 material = make_material("remembering", "Law");
    constexpr unsigned int     n        = Remembering::n;
    std::vector<MaterialPoint> points(3);
    for (unsigned int p = 0; p < points.size(); ++p)
      {
        material->initialize(points[p], SymmetricTensor2());
        for (unsigned int i = 0; i <= p; ++i)
          step(*material, points[p], one_tensor());
      }
    bool is_right = true;
    for (unsigned int p = 0; p < points.size(); ++p)
      for (unsigned int k = 0; k < n; ++k)
        is_right = is_right && points[p].state[k] == (p + 1.) * k;
    check("a long history", is_right);

    MaterialTangent D;
    material->tangents(ArrayView<const MaterialPoint>(&points[1], 1),
                       ArrayView<MaterialTangent>(&D, 1),
                       3);
    check("  in differences", std::abs(D[0][0][0][0] - 3. * (n - 1.)), 1e-5);
    MaterialLanes lanes(points[2]);
    const auto    energies = material->energies(lanes);
    check("  in energies of several points",
          energies.strain[0] == 3. * (n - 1.) &&
            energies.dissipation[0] == 3. * (n - 2.));
  }



  void
  bad(const std::string &name, const std::vector<std::string> &settings)
  {
    print_message([&]() { make(name, settings); });
  }
} // namespace



void
test_main()
{
  print() << material_names() << std::endl;

  const std::vector<std::string> elastic = {"Young modulus = 2e6",
                                            "Poisson ratio = 0.2"};
  test_effects("linear-elastic", {}, elastic);
  test_effects("neo-hookean", {}, elastic);
  test_effects("decoupled-neo-hookean", {}, elastic);
  test_effects(
    "von-mises",
    {},
    {elastic[0], elastic[1], "Yield stress = 2e3", "Hardening modulus = 1e3"});
  test_effects("drucker-prager",
               {"Cohesion = 2e3", "Dilatancy angle = 5"},
               {elastic[0],
                elastic[1],
                "Friction angle = 25",
                "Dilatancy angle = 10",
                "Cohesion = 1e3",
                "Tension cut-off = 500",
                "Cone = outer",
                "Strength reduction = 2"});
  test_effects("drucker-prager",
               {"Cohesion = 2e3", "Dilatancy angle = 5", "Cone = outer"},
               {elastic[0],
                elastic[1],
                "Friction angle = 25",
                "Dilatancy angle = 10",
                "Cohesion = 1e3",
                "Tension cut-off = 0",
                "Cone = inner",
                "Strength reduction = 2"});
  test_effects("drucker-prager",
               {"Cohesion = 2e3", "Dilatancy angle = 5"},
               {elastic[0],
                elastic[1],
                "Friction angle = 25",
                "Dilatancy angle = 10",
                "Cohesion = 1e3",
                "Tension cut-off = 500",
                "Cone = plane strain associated",
                "Strength reduction = 2"});
  test_effects("mohr-coulomb",
               {"Cohesion = 2e3",
                "Residual cohesion = 1e3",
                "Dilatancy angle = 5"},
               {elastic[0],
                elastic[1],
                "Cohesion = 3e3",
                "Residual cohesion = 500",
                "Friction angle = 35",
                "Residual friction angle = 20",
                "Dilatancy angle = 10",
                "Softening = exponential",
                "Softening strain = 0.2",
                "Strength reduction = 2"});
  const std::vector<std::string> soil = {"Shear modulus = 1e6",
                                         "Swelling slope = 0.02",
                                         "Attraction = 200",
                                         "Critical stress ratio = 1.3",
                                         "Overconsolidation ratio = 3"};
  const auto with_soil                = [&](std::vector<std::string> more) {
    more.insert(more.begin(), soil.begin(), soil.end());
    return more;
  };
  test_effects("modified-cam-clay",
               {},
               with_soil({"Compression slope = 0.2", "Void ratio = 1"}));
  test_effects("nor-sand",
               {},
               with_soil({"Critical void ratio = 0.8",
                          "Critical slope = 0.05",
                          "State parameter = -0.1",
                          "Dilatancy factor = 2",
                          "Hardening = 50"}));
  const std::vector<std::string> tait = {"Sound speed = 20",
                                         "Bulk viscosity = 1",
                                         "Allow tension = true"};
  test_effects("newtonian-fluid",
               {},
               {tait[0], tait[1], tait[2], "Viscosity = 1"});
  test_effects("bingham",
               {},
               {tait[0],
                tait[1],
                tait[2],
                "Yield stress = 1",
                "Plastic viscosity = 1",
                "Regularization = 2"});

  // A state of zeros is the stress-free one; impossible deformations give
  // results that are not finite.
  for (const std::string &name :
       Utilities::split_string_list(material_names(), '|'))
    {
      if (name == "umat") // which needs a library
        continue;
      const auto    material = make(name);
      MaterialPoint point;
      point.F = one_tensor();
      step(*material, point, one_tensor());
      check(name + ", zeros are stress-free", point.stress.norm(), 0.);
      Tensor2 f = one_tensor();
      f[0][0]   = -0.5;
      step(*material, point, f);
      check("  J < 0 is not finite", !std::isfinite(point.stress.norm()));
    }

  // Wrong input.
  print_message([]() { make_material("jelly", "Law"); });
  print_message([]() { make("umat"); });
  add_material("remembering", []() -> std::unique_ptr<Material> {
    return std::make_unique<Remembering>();
  });
  print_message([]() { add_material("remembering", nullptr); });
  print_message([]() { add_material("", nullptr); });
  print_message([]() { add_material("clay|sand", nullptr); });
  for (const std::vector<std::string> &names :
       std::vector<std::vector<std::string>>{
         {""}, {"e,p"}, {"1st"}, {"stress_xx"}, {"e", "p", "e"}, {"e", "F_xy"}})
    print_message([&]() { check_state_names(names, "Material clay"); });
  test_long_history();
  bad("linear-elastic", {"Poisson ratio = 0.5"});
  bad("neo-hookean", {"Poisson ratio = -1"});
  bad("decoupled-neo-hookean", {"Poisson ratio = 0.5"});
  bad("drucker-prager", {"Dilatancy angle = 31"});
  bad("drucker-prager", {"Friction angle = 0"});
  bad("drucker-prager", {"Cohesion = 1e3", "Tension cut-off = 1e4"});
  bad("modified-cam-clay", {"Swelling slope = 0.1"});
  bad("mohr-coulomb", {"Residual cohesion = 2e3"});
  bad("mohr-coulomb", {"Residual friction angle = 31"});
  bad("mohr-coulomb", {"Residual friction angle = 20", "Dilatancy angle = 25"});
  bad("mohr-coulomb", {"Residual cohesion = 0", "Residual friction angle = 0"});

  // Values that the patterns exclude: refused when they are read.
  for (const auto &[name, setting] :
       std::vector<std::pair<std::string, std::string>>{
         {"linear-elastic", "Density = 0"},
         {"linear-elastic", "Young modulus = 0"},
         {"linear-elastic", "Poisson ratio = 0.6"},
         {"von-mises", "Yield stress = 0"},
         {"von-mises", "Hardening modulus = -1"},
         {"drucker-prager", "Friction angle = 90"},
         {"drucker-prager", "Cone = round"},
         {"mohr-coulomb", "Softening strain = 0"},
         {"newtonian-fluid", "Sound speed = 0"},
         {"newtonian-fluid", "Viscosity = -1"},
         {"bingham", "Regularization = 0"}})
    {
      bool refused = false;
      try
        {
          make(name, {setting});
        }
      catch (const std::exception &)
        {
          refused = true;
        }
      check(name + ", " + setting + " is refused", refused);
    }
}
