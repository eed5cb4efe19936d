// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a point and a body in free fall: position and shape are exact for all
// schemes.
#include "simulation.h"

template <int dim>
void
test(const std::string &name, const Text &text, const bool half_steps = true)
{
  Simulated<dim> run(text);
  run.run();
  const double t = run->state().time, dt = run->state().step;
  // Symplectic Euler adds up velocities at the ends of steps.
  const double  fall  = half_steps ? -0.5 * t * t : -0.5 * t * (t + dt);
  double        worst = 0.;
  std::uint64_t n     = 0;
  for (const auto &body : run->bodies())
    {
      body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int d = 0; d < dim; ++d)
          worst = std::max(worst,
                           std::abs(p.position(d) - p.reference(d) -
                                    (d == 0   ? 0.02 * t
                                     : d == 1 ? fall
                                              : 0.)));
        worst =
          std::max(worst,
                   (p.F() - Tensor<2, 3>(unit_symmetric_tensor<3>())).norm());
        ++n;
      });
    }
  check(name, max_all(worst), 1e-12);
  check(name + ", points",
        Utilities::MPI::sum(n, MPI_COMM_WORLD) == run->bodies()[0].n_points);
}



void
test_main()
{
  const auto falling = [](const Text &text, const std::string &rest) {
    return text.with("Loads", {"Gravity = 0; -1" + rest})
      .with("Body body", {"Velocity = 0.02; 0" + rest})
      .with("Material solid", {"Young modulus = 0.1"})
      .with("Time", {"End = 0.5", "Step = 0.02", "Too large step = ignore"});
  };
  const Text point = falling(block_2d("ball(0.3, 0.8, 0.03)"), "")
                       .with("Body body", {"Points per direction = 2"});
  {
    Simulated<2> run(point);
    check("there is one point", run->bodies()[0].n_points == 1);
  }
  const Text box = falling(block_2d("box(0.2, 0.55, 0.6, 0.9)"), "");
  for (const unsigned int p : {1, 2, 3, 4, 5})
    {
      const Text order = point.with("Grid", {"Order = " + std::to_string(p)});
      test<2>("one point, order " + std::to_string(p), order);
    }
  for (const std::string scheme : {"USL", "MUSL"})
    for (const std::string transfer : {"FLIP", "PIC", "APIC"})
      {
        const Text text =
          box.with("Scheme",
                   {"Stress update = " + scheme, "Transfer = " + transfer});
        test<2>("box, " + scheme + ", " + transfer, text);
      }
  test<2>("box, symplectic Euler",
          box.with("Time", {"Velocities at = full steps"}),
          false);
  test<2>("box, fmpm-3", box.with("Scheme", {"Mass = fmpm-3"}));
  test<3>("one point, 3D",
          falling(block_3d("ball(0.3, 0.8, 0.31, 0.07)"), "; 0"));
  test<3>("box, 3D",
          falling(block_3d("box(0.2, 0.55, 0.1, 0.7, 0.9, 0.5)"), "; 0")
            .with("Scheme", {"Transfer = APIC"}));
}
