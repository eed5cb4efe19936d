// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks element tests of all laws: closed forms of elastic and perfectly
// plastic laws, unloading, the effect of each parameter, messages.

#include <greville/materials/element_test.h>

#include "materials.h"

namespace
{
  const std::string all_tests = element_test_names();



  ElementTestTable
  run(const std::string              &law,
      const std::vector<std::string> &settings,
      const std::string              &test,
      const ElementTestParameters    &parameters)
  {
    return run_element_test(*make(law, settings),
                            "Material soil",
                            test,
                            parameters);
  }



  ElementTestParameters
  from_rest(const double strain)
  {
    ElementTestParameters parameters;
    parameters.initial_stress = {0.};
    parameters.strains        = {strain};
    parameters.steps          = 20;
    return parameters;
  }



  double
  last(const ElementTestTable &table, const std::string &name)
  {
    return table.column(name).back();
  }



  // Hencky's law: Kirchhoff stresses are linear in logarithmic strains.
  void
  test_elastic()
  {
    const double E = 3e6, nu = 0.25, K = E / (3. * (1. - 2. * nu)),
                 G = E / (2. * (1. + nu)), s = 0.1;
    const std::vector<std::string> settings = {"Young modulus = 3e6",
                                               "Poisson ratio = 0.25"};
    const auto                     compare  = [&](const std::string &test,
                             const std::string &name,
                             const double       exact) {
      const auto table = run("linear-elastic", settings, test, from_rest(s));
      check("  " + test + ", " + name,
            std::abs(last(table, name) / exact - 1.),
            1e-10);
    };
    print() << "linear-elastic" << std::endl;
    compare("isotropic", "p", K * s * std::exp(s));
    compare("isotropic", "strain_axial", s / 3.);
    compare("isotropic", "void_ratio", 1.7 * std::exp(-s) - 1.);
    compare("oedometer", "p", K * s * std::exp(s));
    compare("oedometer", "q", 2. * G * s * std::exp(s));
    compare("oedometer", "stress_axial", (K + 4. / 3. * G) * s * std::exp(s));
    compare("triaxial-drained", "q", E * s * std::exp((1. - 2. * nu) * s));
    compare("triaxial-drained", "strain_volumetric", (1. - 2. * nu) * s);
    compare("triaxial-drained", "strain_shear", 2. / 3. * (1. + nu) * s);
    compare("triaxial-undrained", "q", 3. * G * s);
    compare("triaxial-undrained", "pore_pressure", G * s);
    compare("triaxial-undrained", "strain_shear", s);
    const auto shear =
      run("linear-elastic", settings, "simple-shear", from_rest(s));
    check("  simple-shear, the stress that is held",
          std::abs(last(shear, "stress_axial")),
          1e-3);
    check("  simple-shear, the shear stress",
          std::abs(last(shear, "stress_shear") / (G * s) - 1.),
          0.01);
  }



  void
  test_strength()
  {
    print() << "strength" << std::endl;
    ElementTestParameters parameters;
    parameters.initial_stress = {1e5};
    parameters.strains        = {0.1};
    const double N            = 3.; // tan(45 + 30 / 2)^2
    const double n_c          = 2. * 1e4 * std::sqrt(N);
    const auto   soil =
      run("mohr-coulomb",
          {"Young modulus = 1e8", "Friction angle = 30", "Cohesion = 1e4"},
          "triaxial-drained",
          parameters);
    // The cohesion is one of the Kirchhoff stress.
    const double J = std::exp(-last(soil, "strain_volumetric"));
    check("  mohr-coulomb, triaxial-drained",
          std::abs(last(soil, "stress_axial") / (N * 1e5 + n_c / J) - 1.),
          1e-3);
    const auto cone = run("drucker-prager",
                          {"Young modulus = 1e8",
                           "Friction angle = 30",
                           "Cohesion = 0",
                           "Cone = outer"},
                          "triaxial-drained",
                          parameters);
    check("  drucker-prager, triaxial-drained",
          std::abs(last(cone, "stress_axial") / (N * 1e5) - 1.),
          1e-9);
    const auto metal = run("von-mises",
                           {"Young modulus = 1e8", "Yield stress = 2e4"},
                           "triaxial-undrained",
                           parameters);
    check("  von-mises, triaxial-undrained",
          std::abs(last(metal, "q") / 2e4 - 1.),
          0.01);
    // Loading, and back: what stays is plastic.
    parameters.strains = {0.05, 0.04, 0.05};
    const auto loop    = run("drucker-prager",
                          {"Young modulus = 1e8",
                              "Friction angle = 30",
                              "Cohesion = 0",
                              "Cone = outer"},
                          "triaxial-drained",
                          parameters);
    const auto q       = loop.column("q");
    check("  rows", loop.rows.size() == 601);
    check("  down and up", q[400] < 0.9 * q[200] && q[600] > 0.999 * q[200]);
  }



  // All laws, from a stress that they can have.
  void
  test_all()
  {
    for (const std::string &law :
         Utilities::split_string_list(material_names(), '|'))
      {
        ElementTestParameters parameters;
        parameters.strains = {0.02, 0.01};
        parameters.steps   = 50;
        std::vector<std::string> settings;
        if (law == "umat")
          settings = {"Library = " BUILD_DIR "/libraries/elastic_c.so",
                      "Properties = 1e7, 0.3"};
        const bool is_fluid = make(law, settings)->shares_volume();
        print() << law;
        for (const std::string &test :
             Utilities::split_string_list(all_tests, '|'))
          {
            // No stress holds a fluid.
            if (is_fluid && (test == "triaxial-drained"))
              continue;
            const auto table  = run(law, settings, test, parameters);
            bool       finite = table.rows.size() == 101;
            for (const auto &row : table.rows)
              for (const double value : row)
                finite = finite && std::isfinite(value);
            check(law + ", " + test, finite);
            print() << ", " << std::setprecision(4) << last(table, "p") / 1e5
                    << ' ' << last(table, "q") / 1e5;
          }
        print() << std::endl;
      }
  }



  ElementTestParameters
  read_section(const std::string &lines)
  {
    ElementTestParameters parameters;
    ParameterHandler      prm;
    declare_section(prm, ElementTestParameters::section, parameters);
    parse_parameter_lines(prm,
                          parameter_lines_of("subsection Element test\n" +
                                               lines + "\nend\n",
                                             "parameters"));
    return parameters;
  }



  void
  test_effects()
  {
    ElementTestParameters before;
    before.strains     = {0.02};
    before.steps       = 10;
    const auto differs = [&](const std::string           &law,
                             const ElementTestParameters &after) {
      const auto a      = run(law, {}, "oedometer", before),
                 b      = run(law, {}, "oedometer", after);
      double difference = a.rows.size() != b.rows.size();
      for (const char *name : {"p", "q", "void_ratio", "strain_axial"})
        difference =
          std::max(difference, std::abs(last(a, name) / last(b, name) - 1.));
      return difference > 1e-6;
    };
    const auto read = [](const std::string &line) {
      return read_section("set Strain = 0.02\nset Steps = 10\nset " + line);
    };
    for (const std::string line : {"Initial stress = 2e5",
                                   "Initial stress = 1e5, 5e4",
                                   "Strain = 0.03",
                                   "Strain = 0.03, 0.02",
                                   "Steps = 20",
                                   "Void ratio = 0.5"})
      check(line + " has an effect", differs("mohr-coulomb", read(line)));
    check("Strain rate = 1 has an effect",
          differs("bingham", read("Strain rate = 1")));
  }



  void
  test_messages()
  {
    ElementTestParameters parameters;
    print_message([&]() { run("mohr-coulomb", {}, "triaxial", parameters); });
    parameters.initial_stress = {5e5, 1e5};
    print_message(
      [&]() { run("von-mises", {}, "triaxial-drained", parameters); });
    parameters.initial_stress = {1., 2., 3.};
    print_message([&]() { run("von-mises", {}, "oedometer", parameters); });
    // The largest lateral tension, E exp(-1 - e) / 2 for the axial extension e,
    // falls below that of the start.
    parameters.initial_stress = {0., -1.5e4};
    parameters.strains        = {-0.5};
    parameters.steps          = 10;
    print_message([&]() {
      run("linear-elastic",
          {"Young modulus = 1e5", "Poisson ratio = 0"},
          "triaxial-drained",
          parameters);
    });
    print_message([]() { read_section("set Steps = 0"); });
  }
} // namespace



void
test_main()
{
  test_elastic();
  test_strength();
  test_all();
  test_effects();
  test_messages();
}
