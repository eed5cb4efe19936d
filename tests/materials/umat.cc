// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks UMATs of benchmarks/umat step by step against the same laws of the
// library: stress, history, energies and tangents in plane strain and in 3D. An
// incremental UMAT is exact in one case and converges otherwise. Also checks
// the arguments of a UMAT, state variables, errors, and UMATs that write to
// memory of others.
#include <greville/materials/umat.h>
#include <greville/run/check_materials.h>

#include "materials.h"
#include <functional>

namespace
{
  std::string
  library(const std::string &file)
  {
    return "Library = " BUILD_DIR "/libraries/" + file;
  }



  // A law with the section name "Material NAME", which its UMAT sees.
  std::unique_ptr<Umat>
  make_umat(const std::vector<std::string> &settings,
            const std::string              &section = "Material sand")
  {
    auto             law = std::make_unique<Umat>();
    ParameterHandler prm;
    declare_section(prm, section, *law);
    for (const std::string &setting : settings)
      {
        const std::size_t equals = setting.find('=');
        prm.enter_subsection(section);
        prm.set(Utilities::trim(setting.substr(0, equals)),
                Utilities::trim(setting.substr(equals + 1)));
        prm.leave_subsection();
      }
    law->reinit(section);
    return law;
  }



  // Print a message without the folder of libraries and the number of the call.
  void
  print_place(const std::function<void()> &action)
  {
    try
      {
        action();
        print() << "accepted: FAILED" << std::endl;
      }
    catch (const std::exception &error)
      {
        std::string text = message_of(error);
        for (std::size_t at; (at = text.find(BUILD_DIR)) != std::string::npos;)
          text.erase(at, std::string(BUILD_DIR).size());
        const std::size_t call = text.find(", call ");
        if (call != std::string::npos)
          text.erase(call + 6, text.find(' ', call + 7) - call - 6);
        print() << text << std::endl;
      }
  }



  // Material::tangents() of one point.
  MaterialTangent
  tangent_of(const Material      &law,
             const MaterialPoint &begin,
             const unsigned int   dim)
  {
    MaterialTangent result;
    law.tangents(ArrayView<const MaterialPoint>(&begin, 1),
                 ArrayView<MaterialTangent>(&result, 1),
                 dim);
    return result;
  }



  // Both laws along the same motions: compressed first, then led to and fro by
  // increments of random strains and rotations.
  void
  compare(const std::string              &what,
          const Umat                     &umat,
          const Material                 &law,
          const std::vector<unsigned int> kept, // numbers of law's history
          const double                    size)
  {
    Random       random;
    double       error = 0., history = 0., energy = 0., tangent = 0.;
    unsigned int n_plastic = 0;
    for (const unsigned int dim : {2, 3})
      for (unsigned int k = 0; k < 40; ++k)
        {
          const bool    plane = dim == 2;
          MaterialPoint a = rest(umat), b = rest(law);
          a.dim = dim;
          // Without a change of volume, far from the apex of Mohr-Coulomb.
          Tensor2 strain = random.matrix(size, plane);
          if (plane)
            strain[2][2] = 0.;
          const double mean = trace(strain) / dim;
          for (unsigned int d = 0; d < dim; ++d)
            strain[d][d] -= mean;
          for (unsigned int n = 0; n < 12; ++n)
            {
              Tensor2 f = one_tensor();
              if (n < 2)
                for (unsigned int d = 0; d < dim; ++d)
                  f[d][d] -= size;
              else
                f += (n < 8 ? 1. : -0.7) * strain +
                     random.matrix(0.1 * size, plane);
              f                      = random.rotation(plane) * f;
              MaterialPoint before_a = a, before_b = b;
              const double  work = law.dissipation(b);
              for (MaterialPoint *point : {&before_a, &before_b})
                {
                  point->increment = f;
                  point->F         = f * point->F;
                  point->J         = determinant(point->F);
                }
              step(umat, a, f);
              step(law, b, f);
              n_plastic += law.dissipation(b) > work;
              error =
                std::max(error, (a.stress - b.stress).norm() / b.stress.norm());
              for (unsigned int i = 0; i < kept.size(); ++i)
                history =
                  std::max(history,
                           std::abs(a.state[12 + i] - b.state[kept[i]]));
              const double all = law.strain_energy(b) + law.dissipation(b);
              energy           = std::max(
                {energy,
                           std::abs(umat.strain_energy(a) - law.strain_energy(b)) / all,
                           std::abs(umat.dissipation(a) - law.dissipation(b)) / all});
              const MaterialTangent D = tangent_of(law, before_b, dim);
              tangent                 = std::max(tangent,
                                 (tangent_of(umat, before_a, dim) - D).norm() /
                                   D.norm());
            }
        }
    print() << what << ": " << n_plastic << " plastic steps" << std::endl;
    check("  stress", error, 1e-10);
    check("  history", history, 1e-12);
    check("  energies", energy, 1e-10);
    check("  tangent", tangent, 1e-9);
  }



  void
  test_incremental()
  {
    const std::vector<std::string> constants = {"Young modulus = 1e7",
                                                "Poisson ratio = 0.3"};
    const auto                     law = make("linear-elastic", constants);
    const auto                     umat =
      make_umat({library("elastic_c.so"), "Properties = 1e7, 0.3"});
    Random random;
    // Axes that do not turn, seen from axes that do.
    double error = 0., strain = 0.;
    for (unsigned int k = 0; k < 40; ++k)
      {
        MaterialPoint a = rest(*umat), b = rest(*law);
        Tensor2       R = one_tensor(), U = one_tensor();
        for (unsigned int n = 0; n < 8; ++n)
          {
            Tensor2 stretch = one_tensor();
            for (unsigned int d = 0; d < 3; ++d)
              stretch[d][d] += 0.1 * random();
            U                   = stretch * U;
            const Tensor2 R_new = random.rotation(false);
            const Tensor2 f     = R_new * stretch * transpose(R);
            R                   = R_new;
            step(*umat, a, f);
            step(*law, b, f);
            error = std::max(error, (a.stress - b.stress).norm() / 1e7);
          }
        SymmetricTensor2 stran;
        for (unsigned int i = 0; i < 6; ++i)
          stran.access_raw_entry(i) = a.state[i];
        Tensor2 logarithm;
        for (unsigned int d = 0; d < 3; ++d)
          logarithm[d][d] = std::log(U[d][d]);
        strain =
          std::max(strain, (stran - rotated(R, symmetrize(logarithm))).norm());
      }
    print() << "incremental" << std::endl;
    check("  stress", error, 1e-12);
    check("  STRAN is the logarithmic strain", strain, 1e-13);

    check_objectivity(*umat, 0.05);
    // Simple shear and stretch: the order of the integration, its work, and its
    // tangent, whose error is that of the increments.
    const auto path = [](const double s) {
      Tensor2 F = one_tensor();
      F[0][1]   = 0.3 * s;
      F[0][0] += 0.1 * s * s;
      F[1][2] = 0.2 * s;
      return F;
    };
    const auto miss = [&](const unsigned int n) {
      MaterialPoint a = rest(*umat), b = rest(*law);
      for (unsigned int i = 0; i < n; ++i)
        {
          const Tensor2 f = path((i + 1.) / n) * invert(path(double(i) / n));
          step(*umat, a, f);
          step(*law, b, f);
        }
      return (a.stress - b.stress).norm() / b.stress.norm();
    };
    // The law of the rate is another one in large shear.
    check("  large shear is within 1 %", miss(100), 1e-2);
    check_order("  work",
                energy_error(*umat, path, 10),
                energy_error(*umat, path, 20),
                2.);
    const MaterialPoint start = rest(*umat);
    check("  tangent of small steps",
          tangent_error(*umat, start, 0.01, 3),
          1e-4);
    check("    which differences do not have",
          tangent_error(*make_umat({library("elastic_c.so"),
                                    "Properties = 1e7, 0.3",
                                    "Tangent = differences"}),
                        start,
                        0.01,
                        3),
          1e-14);
  }



  void
  test_interface()
  {
    const std::vector<std::string> common   = {library("umat_probe_c.so"),
                                               "Properties = 1e6, 0.01, 1"};
    auto                           settings = common;
    settings.insert(settings.end(),
                    {"State variables = 24",
                     "Initial state = 0;0;0;0;0;0;0;0;0;0;0;0;0;0;0;0;0;0;0;"
                     "0;0;x;y;x+z",
                     "Element length = 0.25"});
    const auto umat = make_umat(settings);
    check("36 names", umat->state_names().size() == 36);
    MaterialPoint point;
    point.dim      = 2;
    point.position = Point<3>(1., 2., 3.);
    SymmetricTensor2 stress;
    stress[0][0] = -1e4;
    umat->initialize(point, stress);
    check("the initial stress", (point.stress - stress).norm(), 0.);
    check("  with F = 1", (point.F - one_tensor()).norm(), 0.);
    check("the initial state",
          point.state[12 + 21] == 1. && point.state[12 + 22] == 2. &&
            point.state[12 + 23] == 4.);
    check("waves", std::abs(point.wave_modulus - 1e6), 0.);

    // A quarter of a turn with a shear after a first step.
    point.time = 0.5;
    step(*umat, point, one_tensor(), 0.5);
    check("KINC", point.state[12 + 7] == 1.);
    Tensor2 f = one_tensor();
    f[0][0] = f[1][1] = 0.;
    f[0][1]           = -1.;
    f[1][0]           = 1.;
    point.time        = 0.75;
    step(*umat, point, f, 0.25);
    check("the stress turns", std::abs(point.stress[1][1] + 1e4), 1e-8);
    check("  and is not changed",
          std::abs(point.stress.norm() / 1e4 - 1.),
          1e-12);
    print() << "given in plane strain:";
    for (unsigned int k = 0; k < 19; ++k)
      print() << ' ' << std::round(1e6 * point.state[12 + k]) / 1e6 + 0.;
    print() << std::endl;
    check("sums go on", std::abs(point.state[12 + 19] - 0.75), 1e-15);
    const MaterialPoint flat = point;
    point.dim                = 3;
    step(*umat, point, one_tensor(), 0.25);
    print() << "in 3D: " << point.state[12 + 6] << std::endl;

    // Copies have histories of their own.
    MaterialPoint copy = flat;
    copy.state[30]     = 7.;
    check("copies", flat.state[30] != 7. && copy.state[30] == 7.);

    // A step that the law finds too long.
    f                     = one_tensor();
    f[0][0]               = 1.02;
    MaterialPoint too_far = flat;
    print_place([&]() { step(*umat, too_far, f, 0.25); });

    // Names, units, and the moduli of waves.
    settings = common;
    settings.push_back("State variables = void_ratio, suction [Pa]");
    const auto named = make_umat({library("elastic_c.so"),
                                  "Properties = 1e7, 0.3",
                                  "State variables = void_ratio, suction [Pa]",
                                  "Bulk modulus = 3e7",
                                  "Shear modulus = 1e7"});
    for (const std::string &state : named->state_names())
      print() << ' ' << state
              << (named->state_unit(state).empty()
                    ? ""
                    : " [" + named->state_unit(state) + "]");
    print() << std::endl;
    check("given moduli", named->moduli().bulk == 3e7);
    check("  make waves faster",
          std::abs(rest(*named).wave_modulus - 3e7 - 4. / 3. * 1e7),
          1e-6);
  }



  void
  test_messages()
  {
    const auto bad = [](const std::vector<std::string> &settings) {
      print_place([&]() { make_umat(settings); });
    };
    const std::string elastic = library("elastic_c.so");
    bad({});
    bad({"Library = nowhere/soil.so"});
    bad({library("sponge.so")});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = 2 e"});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = e, stran_xx"});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = e, stress_xy"});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = e, e"});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = 10001"});
    bad({elastic, "Properties = 1e7, 0.3", "State variables = 99999999999"});
    bad({elastic,
         "Properties = 1e7, 0.3",
         "State variables = 3",
         "Initial state = 1; 2"});
    bad({elastic, "Properties = 1e7, 0.3", "Bulk modulus = 1"});
    bad({library("umat_probe_c.so"),
         "Properties = 1e6, 1, 0",
         "State variables = 24"});
  }



  // The examples of doc/user/own_laws.md: both alike, and Hooke's law.
  void
  test_examples()
  {
    const std::vector<std::string> common  = {"Properties = 1e7, 0.3",
                                              "State variables = theta"};
    const auto                     example = [&](const std::string &file) {
      auto settings = common;
      settings.push_back(library(file));
      return make_umat(settings);
    };
    const auto c = example("own_laws_c.so"), fortran = example("own_laws_f.so");
    const auto law =
      make("linear-elastic", {"Young modulus = 1e7", "Poisson ratio = 0.3"});
    MaterialPoint a = rest(*c), b = rest(*fortran), exact = rest(*law);
    Tensor2       f = one_tensor();
    f[0][0] += 1e-7;
    f[1][2] += 2e-7;
    for (MaterialPoint *point : {&a, &b, &exact})
      step(point == &a   ? static_cast<const Material &>(*c)
           : point == &b ? static_cast<const Material &>(*fortran)
                         : *law,
           *point,
           f);
    check("examples alike", (a.stress - b.stress).norm(), 1e-12);
    check("  and exact",
          (a.stress - exact.stress).norm() / exact.stress.norm(),
          1e-6);
    check("  with their state",
          std::abs(a.state[12] - 1e-7) < 1e-13 && a.state[12] == b.state[12]);
  }



  // Faults of tests/materials/umat_faults.c from a time on. Calls before it are
  // right, also after a fault.
  void
  test_faults()
  {
    for (const unsigned int dim : {2, 3})
      for (unsigned int fault = 1; fault < 20; ++fault)
        {
          const auto umat =
            make_umat({library("umat_faults_c.so"),
                       "Properties = 1e6, " + std::to_string(fault) + ", 0.25",
                       "State variables = 1"});
          MaterialPoint point = rest(*umat);
          point.dim           = dim;
          point.position      = Point<3>(1., 2., 3.);
          MaterialPoint late  = point;
          late.time           = 1.;
          print_place([&]() { step(*umat, late, one_tensor(), 0.5); });
          point.time = 0.5;
          step(*umat, point, one_tensor(), 0.5);
          check("a call after it", point.state[12] == 0.5);
        }
  }
} // namespace



void
test_main()
{
  const std::vector<std::string> constants = {"Young modulus = 1e7",
                                              "Poisson ratio = 0.3"};
  compare("elastic.f",
          *make_umat({library("elastic_f.so"), "Properties = 1e7, 0.3"}),
          *make("linear-elastic", constants),
          {},
          0.02);
  auto settings = constants;
  settings.insert(settings.end(),
                  {"Yield stress = 1e5", "Hardening modulus = 1e6"});
  compare("von_mises.f",
          *make_umat({library("von_mises_f.so"),
                      "Properties = 1e7, 0.3, 1e5, 1e6",
                      "State variables = 7"}),
          *make("von-mises", settings),
          {0, 1, 2, 3, 4, 5, 6},
          0.02);
  settings = constants;
  settings.insert(settings.end(),
                  {"Cohesion = 5e4",
                   "Residual cohesion = 5e4",
                   "Friction angle = 10",
                   "Residual friction angle = 10",
                   "Dilatancy angle = 3"});
  compare("mohr_coulomb.cc",
          *make_umat({library("mohr_coulomb_cc.so"),
                      "Properties = 1e7, 0.3, 5e4, 10, 3",
                      "State variables = 7"}),
          *make("mohr-coulomb", settings),
          {0, 1, 2, 3, 4, 5, 6},
          0.01);
  test_incremental();
  test_interface();
  test_messages();
  test_examples();
  test_faults();
}
