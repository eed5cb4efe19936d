// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks fluids: Tait's equation, viscous stresses at known rates, the limits
// of Bingham's law, tearing, spin and energies.

#include "materials.h"

namespace
{
  const double           density = 1200., c = 15., n = 7.;
  const double           B   = density * c * c / n;
  const SymmetricTensor2 one = unit_symmetric_tensor<3>();

  std::unique_ptr<Material>
  fluid(const std::string &name, std::vector<std::string> settings)
  {
    settings.insert(settings.end(), {"Density = 1200", "Sound speed = 15"});
    return make(name, settings);
  }



  Tensor2
  shear(const double rate, const double dt)
  {
    Tensor2 f = one_tensor();
    f[0][1]   = rate * dt;
    return f;
  }



  void
  test(const std::string &name)
  {
    print() << name << std::endl;
    const auto still    = fluid(name, {"Allow tension = true"});
    double     pressure = 0, wave = 0, energy = 0;
    for (const double J : {0.8, 0.95, 0.999, 1., 1.01, 1.2})
      {
        const auto at = [&](const double J) {
          MaterialPoint point = rest(*still);
          step(*still, point, std::cbrt(J) * one_tensor(), 1e12);
          return point;
        };
        const MaterialPoint point = at(J), low = at(J - 1e-6),
                            high = at(J + 1e-6);
        const double p           = B * (std::pow(1 / J, n) - 1);
        pressure = std::max(pressure, (point.stress + p * one).norm() / B);
        wave     = std::max(wave,
                        std::abs(J * (high.stress[0][0] - low.stress[0][0]) /
                                   2e-6 / point.wave_modulus -
                                 1));
        energy   = std::max(energy,
                          std::abs((still->strain_energy(high) -
                                    still->strain_energy(low)) /
                                     2e-6 +
                                   p) /
                            B);
      }
    check("  Tait's equation", pressure, 1e-12);
    check("  modulus of waves = -J dp/dJ", wave, 1e-8);
    check("  p = -dW/dJ", energy, 1e-8);
    check("  modulus and sound speed",
          std::abs(still->moduli().bulk / (density * c * c) - 1),
          1e-14);

    check_initialize(*still, {1e4 * one, -1e4 * one, -1e6 * one});
    const auto    torn = fluid(name, {});
    MaterialPoint point;
    print_message([&]() {
      SymmetricTensor2 stress = -1e4 * one;
      stress[0][1]            = 10;
      still->initialize(point, stress);
    });
    print_message([&]() { torn->initialize(point, 1e3 * one); });
    print_message([&]() { still->initialize(point, 1e5 * one); });

    // Torn: no pressure, no energy, no bulk viscosity, but shear.
    const auto bulk = fluid(name, {"Bulk viscosity = 3"});
    point           = rest(*bulk);
    Tensor2 f       = 1.001 * shear(2., 1e-3);
    step(*bulk, point, f, 1e-3);
    check("  torn",
          std::abs(trace(point.stress)) + std::abs(bulk->strain_energy(point)),
          1e-10);
    check("  shear stress of a torn fluid", point.stress[0][1] > 1e-4);

    // Bulk viscosity against the same fluid without it.
    MaterialPoint with = rest(*bulk), without = rest(*torn);
    step(*bulk, with, 0.999 * one_tensor(), 1e-3);
    step(*torn, without, 0.999 * one_tensor(), 1e-3);
    check("  bulk viscosity",
          (with.stress - without.stress + 3. * 3. * one).norm() / B,
          1e-14);
    check("    in moduli()",
          std::abs(bulk->moduli().bulk_viscosity - 3.) +
            std::abs(bulk->moduli().viscosity - torn->moduli().viscosity),
          1e-14);

    // Objectivity: another frame, and a superposed spin.
    Random random;
    double frame = 0, spin = 0;
    for (unsigned int k = 0; k < 100; ++k)
      {
        const bool    plane = k % 2;
        const Tensor2 h     = random.matrix(1e-2, plane),
                      R = random.rotation(false), W = random.matrix(0.5, plane);
        MaterialPoint a = rest(*still), b = a;
        step(*still, a, one_tensor() + h, 1e-3);
        step(*still, b, R * (one_tensor() + h) * transpose(R), 1e-3);
        frame       = std::max(frame,
                         (b.stress - rotated(R, a.stress)).norm() /
                           std::max(a.stress.norm(), 0.1 * B));
        b           = rest(*still);
        b.increment = one_tensor() + h + (W - transpose(W));
        b.J         = a.J;
        b.dt        = 1e-3;
        still->update(ArrayView<MaterialPoint>(&b, 1));
        spin = std::max(spin, (b.stress - a.stress).norm() / a.stress.norm());
      }
    check("  another frame", frame, 1e-12);
    check("  a spin adds no stress", spin, 1e-12);

    // Work is stored and dissipated.
    const Tensor2 A = random.matrix(0.1, false), C = random.matrix(0.1, false);
    const auto    path = [&](const double s) {
      return one_tensor() + std::sin(3 * s) * A + s * s * C;
    };
    const auto thick =
      fluid(name,
            {name == "bingham" ? "Plastic viscosity = 1e4" : "Viscosity = 1e4",
             "Bulk viscosity = 1e4",
             "Allow tension = true"});
    check_order("  work - energy - heat",
                energy_error(*thick, path, 100),
                energy_error(*thick, path, 200),
                1.);
    double decrease = 0;
    for (unsigned int k = 0; k < 200; ++k)
      {
        const double before = thick->dissipation(point);
        step(*thick, point, one_tensor() + random.matrix(1e-3, false), 1e-3);
        decrease = std::max(decrease, before - thick->dissipation(point));
      }
    check("  heat never decreases", decrease, 0.);
  }
} // namespace



void
test_main()
{
  test("newtonian-fluid");
  test("bingham");

  const auto newton = fluid("newtonian-fluid", {"Viscosity = 0.5"});
  double     error  = 0;
  for (const double rate : {-3., 1e-3, 20.})
    {
      MaterialPoint point = rest(*newton);
      step(*newton, point, shear(rate, 1e-4), 1e-4);
      error = std::max(error, std::abs(point.stress[0][1] / (0.5 * rate) - 1));
    }
  check("newtonian-fluid: shear stress", error, 1e-10);
  check("  viscosity", std::abs(newton->moduli().viscosity - 0.5), 1e-15);

  const auto bingham = fluid("bingham",
                             {"Yield stress = 8",
                              "Plastic viscosity = 0.5",
                              "Regularization = 20"});
  const auto stress  = [&](const double rate) {
    MaterialPoint point = rest(*bingham);
    step(*bingham, point, shear(rate, 1e-6), 1e-6);
    return point.stress[0][1];
  };
  error = 0;
  for (const double rate : {4e-4, 1e-2, 0.05, 1., 30.})
    error = std::max(error,
                     std::abs(stress(rate) /
                                (0.5 * rate + 8 * (1 - std::exp(-20 * rate))) -
                              1));
  check("bingham: Papanastasiou's formula", error, 1e-6);
  check("  fast: Bingham", std::abs(stress(50.) / (8 + 0.5 * 50) - 1), 1e-9);
  check("  slow: viscosity mu + tau_y m",
        std::abs(stress(1e-4) / (1e-4 * (0.5 + 8 * 20)) - 1),
        2e-3);
  check("  viscosity", std::abs(bingham->moduli().viscosity - 160.5), 1e-12);
  check("  at rest", std::abs(stress(0.)), 0.);
  check("  sign", std::abs(stress(-3.) + stress(3.)), 1e-9);
}
