// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks laws of critical state soil mechanics: element tests against closed
// forms of modified Cam-Clay and the critical state of NorSand; liquefaction of
// loose sand; steps of any size from any state, energies, rotations.

#include <greville/materials/element_test.h>

#include "materials.h"

namespace
{
  const SymmetricTensor2 one = unit_symmetric_tensor<3>();

  // Of the files below.
  constexpr double M = 1.2, kappa = 0.01, lambda = 0.08, a = 10., e_1 = 1.5,
                   sand_M = 1.25, Gamma = 0.9, sand_lambda = 0.03;



  std::vector<std::string>
  clay(const std::vector<std::string> &more = {})
  {
    std::vector<std::string> settings = {"Shear modulus = 5e6",
                                         "Swelling slope = 0.01",
                                         "Compression slope = 0.08",
                                         "Attraction = 10",
                                         "Critical stress ratio = 1.2",
                                         "Void ratio = 1.5"};
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
  }



  std::vector<std::string>
  sand(const std::vector<std::string> &more = {})
  {
    std::vector<std::string> settings = {"Shear modulus = 2e7",
                                         "Swelling slope = 0.004",
                                         "Attraction = 10",
                                         "Critical stress ratio = 1.25",
                                         "Critical void ratio = 0.9",
                                         "Critical slope = 0.03",
                                         "Hardening = 150"};
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
  }



  // The last row of an element test in the Kirchhoff stress, and the others.
  class End
  {
  public:
    End(const std::string              &law,
        const std::vector<std::string> &settings,
        const std::string              &test,
        const ElementTestParameters    &parameters)
      : table(run_element_test(*make(law, settings), "soil", test, parameters))
    {
      MaterialPoint    start;
      SymmetricTensor2 stress = -parameters.initial_stress.back() * one;
      stress[2][2]            = -parameters.initial_stress.front();
      make(law, settings)->initialize(start, stress);
      J_start = start.J;
    }

    double
    operator()(const std::string &name) const
    {
      return table.column(name).back();
    }

    double
    J() const
    {
      return J_start * std::exp(-(*this)("strain_volumetric"));
    }

    double
    P() const // above the apex
    {
      return J() * (*this)("p") + a;
    }

    double
    q() const
    {
      return J() * (*this)("q");
    }

    const ElementTestTable table;
    double                 J_start;
  };



  ElementTestParameters
  from(const std::vector<double> &stress,
       const std::vector<double> &strains,
       const unsigned int         steps)
  {
    ElementTestParameters parameters;
    parameters.initial_stress = stress;
    parameters.strains        = strains;
    parameters.steps          = steps;
    return parameters;
  }



  void
  test_compression()
  {
    print() << "compression of clay" << std::endl;
    // From an overconsolidated start over the yield point, and back.
    const auto settings = clay({"Overconsolidation ratio = 2"});
    const auto with     = from({1e5}, {0.2, 0.15}, 50);
    const End  up("modified-cam-clay",
                 settings,
                 "isotropic",
                 from({1e5}, {0.2}, 50)),
      down("modified-cam-clay", settings, "isotropic", with);
    const double P_start = up.J_start * 1e5 + a, C_start = 2. * P_start,
                 x    = std::log(C_start / P_start);
    const double P_up = C_start * std::exp((0.2 - kappa * x) / lambda);
    check("  isotropic", std::abs(up.P() / P_up - 1.), 1e-8);
    check("  preconsolidation",
          std::abs(up("preconsolidation") / P_up - 1.),
          1e-8);
    check("  and back",
          std::abs(down.P() / (P_up * std::exp(-0.05 / kappa)) - 1.),
          1e-8);
    print() << "  p, kPa, e: " << up("p") / 1e3 << ' ' << up("void_ratio")
            << ' ' << down("p") / 1e3 << ' ' << down("void_ratio") << std::endl;

    // K0: with a shear modulus without bounds the stress ratio is constant.
    const double Lambda = 1. - kappa / lambda;
    const double eta =
      0.5 * (-3. * Lambda + std::sqrt(9. * Lambda * Lambda + 4. * M * M));
    // Axial stress P + 2 q / 3, lateral stress P - q / 3.
    const double axial   = 1e5,
                 lateral = axial * (1. - eta / 3.) / (1. + 2. / 3. * eta);
    const End    stiff("modified-cam-clay",
                    clay({"Shear modulus = 1e16", "Attraction = 1e-6"}),
                    "oedometer",
                    from({axial, lateral}, {0.2}, 20));
    const double grown =
      stiff("p") * stiff.J() / ((axial + 2. * lateral) / 3. * stiff.J_start);
    check("  K0, stress ratio",
          std::abs(stiff("q") / stiff("p") / eta - 1.),
          1e-8);
    check("  K0, pressure",
          std::abs(std::log(grown) * lambda / 0.2 - 1.),
          1e-8);
    // Properties that hold with any shear modulus.
    const End    soft("modified-cam-clay",
                   clay(),
                   "oedometer",
                   from({1e5, 6e4}, {0.2}, 40));
    const double P = soft.P(), t = soft.q() / (M * P);
    check("  oedometer, volume",
          std::abs(
            (1. + soft("void_ratio")) /
              ((1. + e_1) *
               std::exp(-kappa * std::log(P / 1e3) -
                        (lambda - kappa) * std::log(P * (1. + t * t) / 1e3))) -
            1.),
          1e-8);
    check("  and that of the motion",
          std::abs((1. + soft("void_ratio")) /
                     (1. + soft.table.column("void_ratio")[0]) * std::exp(0.2) -
                   1.),
          1e-12);
    print() << "  K0: " << (1. - eta / 3.) / (1. + 2. / 3. * eta) << ' '
            << (soft("p") - soft("q") / 3.) / soft("stress_axial") << std::endl;
  }



  void
  test_clay_in_shear()
  {
    print() << "shear of clay" << std::endl;
    for (const double R : {1., 1.5, 8.})
      {
        const auto settings =
          clay({"Overconsolidation ratio = " + std::to_string(R)});
        const End drained("modified-cam-clay",
                          settings,
                          "triaxial-drained",
                          from({1e5}, {1.5}, 1500));
        check("  drained: q = M P",
              std::abs(drained.q() / (M * drained.P()) - 1.),
              1e-4);
        check("  q = M p",
              std::abs(drained("q") / (M * drained("p")) - 1.),
              2e-4);
        check("  the lateral stress",
              std::abs(drained("p") - drained("q") / 3. - 1e5),
              1e-4);
        check("  void ratio",
              std::abs(
                (1. + drained("void_ratio")) /
                  ((1. + e_1) * std::exp(-lambda * std::log(drained.P() / 1e3) -
                                         (lambda - kappa) * std::log(2.))) -
                1.),
              1e-4);

        const End    undrained("modified-cam-clay",
                            settings,
                            "triaxial-undrained",
                            from({1e5}, {0.5}, 500));
        const double P_start = undrained.J_start * 1e5 + a,
                     P_end =
                       P_start * std::pow(R / 2., (lambda - kappa) / lambda);
        const double p_end = (P_end - a) / undrained.J_start,
                     q_end = M * P_end / undrained.J_start;
        check("  undrained: p", std::abs(undrained("p") / p_end - 1.), 1e-6);
        check("  q", std::abs(undrained("q") / q_end - 1.), 1e-6);
        check("  pore pressure",
              std::abs(undrained("pore_pressure") -
                       (1e5 - p_end + q_end / 3.)) /
                1e5,
              1e-6);
        const auto q = drained.table.column("q");
        print() << "  R = " << R << ", kPa: peak "
                << *std::max_element(q.begin(), q.end()) / 1e3 << ", end "
                << drained("q") / 1e3 << ", undrained " << undrained("q") / 1e3
                << std::endl;
      }
    // Steps of another size end in the same state.
    const End coarse("modified-cam-clay",
                     clay(),
                     "triaxial-drained",
                     from({1e5}, {1.5}, 30));
    check("  coarse steps", std::abs(coarse.q() / (M * coarse.P()) - 1.), 1e-4);
  }



  void
  test_sand_in_shear()
  {
    print() << "shear of sand" << std::endl;
    for (const double psi : {-0.15, -0.05, 0.05})
      {
        const End  drained("nor-sand",
                          sand({"State parameter = " + std::to_string(psi)}),
                          "triaxial-drained",
                          from({1e5}, {2.}, 1000));
        const auto q = drained.table.column("q");
        check("  q = M P",
              std::abs(drained.q() / (sand_M * drained.P()) - 1.),
              1e-4);
        check("  critical void ratio",
              std::abs(drained("void_ratio") -
                       (Gamma - sand_lambda * std::log(drained.P() / 1e3))),
              1e-4);
        check("  state parameter", std::abs(drained("state_parameter")), 1e-4);
        check("  image pressure",
              std::abs(drained("image_pressure") / drained.P() - 1.),
              1e-4);
        print() << "  psi = " << psi << ", kPa: peak "
                << *std::max_element(q.begin(), q.end()) / 1e3 << ", end "
                << drained("q") / 1e3 << ", strain of volume "
                << drained("strain_volumetric") << std::endl;
      }

    // Loose sand in undrained shear: a peak, and what the void ratio leaves.
    const End    loose("nor-sand",
                    sand({"State parameter = 0.08"}),
                    "triaxial-undrained",
                    from({1e5}, {1.}, 2000));
    const auto   q    = loose.table.column("q");
    const auto   peak = std::max_element(q.begin(), q.end());
    const double P_end =
      1e3 * std::exp((Gamma - loose("void_ratio")) / sand_lambda);
    check("  liquefied: P", std::abs(loose.P() / P_end - 1.), 1e-3);
    check("  q", std::abs(loose.q() / (sand_M * P_end) - 1.), 1e-3);
    check("  a peak early on", peak - q.begin() < 100 && *peak > 2. * q.back());
    print() << "  loose and undrained: peak " << *peak / 1e3 << ", end "
            << q.back() / 1e3 << ", pore pressure "
            << loose("pore_pressure") / 1e3 << std::endl;
  }



  // Steps of any size from any state: in the surface, and finite.
  void
  test_robustness(const std::string              &law,
                  const std::vector<std::string> &settings)
  {
    print() << law << ", any step" << std::endl;
    const auto   material = make(law, settings);
    const bool   is_clay  = law == "modified-cam-clay";
    const double m        = is_clay ? M : sand_M;
    Random       random;
    double       outside = -1.;
    unsigned int n_torn = 0, n_wrong = 0;
    for (unsigned int k = 0; k < 3000; ++k)
      {
        MaterialPoint point;
        if (k % 4 == 0)
          point = rest(*material);
        else
          material->initialize(point, -std::pow(10., 3. + 3. * random()) * one);
        for (unsigned int n = 0; n < 4; ++n)
          {
            const double size = std::pow(10., -2.5 + 2.2 * random());
            Tensor2      f    = one_tensor() + random.matrix(size, k % 2) +
                        size * random() * one_tensor();
            if (!(determinant(f) > 0.1))
              continue;
            point.increment = f;
            point.F         = f * point.F;
            point.J *= determinant(f);
            MaterialTangent D;
            material->tangents(ArrayView<const MaterialPoint>(&point, 1),
                               ArrayView<MaterialTangent>(&D, 1),
                               3);
            material->update(ArrayView<MaterialPoint>(&point, 1));
            const SymmetricTensor2 tau = point.J * point.stress;
            const double           P   = a - trace(tau) / 3.,
                         q             = std::sqrt(1.5) * deviator(tau).norm(),
                         C             = point.state[8];
            n_wrong += !(std::isfinite(tau.norm()) && std::isfinite(D.norm()) &&
                         point.wave_modulus > 0. && P > -1e-12 * (a + q));
            n_torn += P < 0.1 * a;
            // With what rounding of tau leaves of P.
            const double noise = 1e-9 * (P + q) + 1e-12 * a;
            outside =
              std::max(outside,
                       is_clay
                         ? std::hypot(q / m, P - 0.5 * C) / (0.5 * C + noise) -
                             1. - noise / C
                         : (P > 1e3 * noise ? q / (m * P) - 1. +
                                                std::log(P / C) - 1e-9 * q / P
                                            : -1.));
          }
      }
    check("  finite", n_wrong == 0);
    check("  in the yield surface", outside, 1e-6);
    check("  torn", n_torn > 100);
  }



  void
  test_rest(const std::string &law, const std::vector<std::string> &settings)
  {
    print() << law << std::endl;
    const auto material = make(law, settings);
    check_objectivity(*material, 0.02);
    SymmetricTensor2 oblique = -1e5 * one;
    oblique[0][1]            = 2e4;
    oblique[2][2]            = -1.2e5;
    oblique[0][2]            = -1e4;
    check_initialize(*material, {-1e3 * one, -1e6 * one, 5. * one, oblique});
    const auto path = [](const double s) {
      Tensor2 F = one_tensor();
      F[0][0] -= 0.1 * s;
      F[1][1] -= 0.05 * s;
      F[0][1] = 0.1 * s * s;
      return F;
    };
    check_order("  energy",
                energy_error(*material, path, 400),
                energy_error(*material, path, 1600) * 2,
                1);
    print_message([&]() {
      MaterialPoint point;
      material->initialize(point, 20. * one);
    });
    print_message([&]() {
      MaterialPoint    point;
      SymmetricTensor2 stress = -1e5 * one;
      stress[2][2]            = -1e6;
      material->initialize(point, stress);
    });
  }
} // namespace



void
test_main()
{
  test_compression();
  test_clay_in_shear();
  test_sand_in_shear();
  test_rest("modified-cam-clay", clay());
  test_rest("nor-sand", sand({"Swelling slope = 0.01"}));
  test_robustness("modified-cam-clay", clay());
  test_robustness("modified-cam-clay", clay({"Overconsolidation ratio = 10"}));
  test_robustness("nor-sand", sand());
  test_robustness("nor-sand", sand({"State parameter = 0.1"}));
  test_robustness("nor-sand", sand({"State parameter = -0.2"}));
}
