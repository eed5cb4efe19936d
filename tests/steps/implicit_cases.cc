// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks implicit steps in cases with references: Cook's membrane, free flight,
// colliding disks, turning walls, limit loads, and wall forces.
#include "simulation.h"
#include <limits>

namespace
{
  /// Cook's membrane with 16 cells: the displacement of the tip, mm, by that
  /// and the gradient of the point next to it.
  double
  membrane_tip(const unsigned int p)
  {
    Simulated<2> run(Text()
                       .add("Simulation",
                            {"Bodies = membrane",
                             "Materials = rubber",
                             "Surface loads = shear"})
                       .add("Grid",
                            {"Lower corner = 0, -0.004",
                             "Upper corner = 0.054, 0.083",
                             "Cells = 18, 29",
                             "Order = " + std::to_string(p)})
                       .add("Time", {"End = 1", "Step = 0.2"})
                       .add("Scheme", {"Stress update = quasi-static"})
                       .add("Scheme", {"Filling threshold = 0.03"})
                       .add("Newton", {"Tolerance = 1e-6"})
                       .add("Body membrane",
                            {"Material = rubber",
                             "Shape = intersection(half_space(1, 0, 0.048), "
                             "half_space(-1, 0, 0), half_space(44, -48, 0), "
                             "half_space(-16, 48, 2.112))",
                             "Placement = fitted",
                             "Points per direction = 3"})
                       .add("Material rubber",
                            {"Model = decoupled-neo-hookean",
                             "Young modulus = 1.0985e6",
                             "Poisson ratio = 0.3"})
                       .add("Surface load shear",
                            {"Body = membrane",
                             "Where = x > 0.047999",
                             "Traction = 0; 62500 * t"})
                       .add("Walls", {"Left = fixed"}));
    run.run();
    const Point<2> tip(0.048, 0.052);
    double         distance = std::numeric_limits<double>::max(), result = 0.;
    for (const auto &body : run->bodies())
      body.points.for_each([&](const unsigned int, const auto point) {
        const Tensor<1, 2> d = tip - point.reference();
        if (d.norm() >= distance)
          return;
        distance = d.norm();
        result   = point.position(1) - point.reference(1);
        for (unsigned int i = 0; i < 2; ++i)
          result += (point.F(1, i) - (i == 1)) * d[i];
      });
    const double nearest = Utilities::MPI::min(distance, MPI_COMM_WORLD);
    return 1e3 * Utilities::MPI::max(distance == nearest ? result : 0.,
                                     MPI_COMM_WORLD);
  }



  /// A block that flies over some of its lengths.
  void
  check_flight(const unsigned int p, const double speed_over_wave_speed)
  {
    const double c     = std::sqrt(100. * 0.7 / (1.3 * 0.4));
    const double speed = speed_over_wave_speed * c;
    Simulated<2> run(
      block_2d("box(4.3, 2.4, 12.3, 10.4)")
        .with("Grid",
              {"Upper corner = 41, 13",
               "Cells = 41, 13",
               "Order = " + std::to_string(p)})
        .with("Body body",
              {"Points per direction = 3",
               "Velocity = " + std::to_string(speed) + "; 0"})
        .with("Scheme",
              {"Mass = consistent", "Stress update = implicit-midpoint"})
        .with("Newton", {"Absolute tolerance = 1e-8"})
        .with("Time",
              {"End = " + std::to_string(24. / speed),
               "Step = " + std::to_string(0.5 / (c + speed))}));
    run.run();
    const Statistics<2> row = run->statistics();
    check("free flight, p = " + std::to_string(p) + ", speed " +
            std::to_string(speed_over_wave_speed),
          row.strain / row.kinetic,
          1e-18);
  }



  /// Steps of ten times the critical one of the consistent mass.
  void
  check_collision()
  {
    const std::string file =
      std::string(SOURCE_DIR) + "/../../prm/simulation/colliding_disks.prm";
    std::ostringstream content;
    content << std::ifstream(file).rdbuf();
    Simulated<2> run(
      Text(content.str())
        .with("Scheme",
              {"Mass = consistent", "Stress update = implicit-midpoint"})
        .with("Time", {"Step = 0.1696"})
        .with("Scheme", {"Filling threshold = 0.1"})
        .with("Newton", {"Absolute tolerance = 1e-8"}));
    const double start   = run->statistics().kinetic;
    double       largest = 0., lowest = start;
    while (!run->is_finished())
      {
        run->step();
        const Statistics<2> row = run->statistics();
        largest =
          std::max(largest, std::abs(row.kinetic + row.strain - start) / start);
        lowest = std::min(lowest, row.kinetic);
      }
    check("disks collide", lowest < 0.1 * start);
    check("  and keep their energy", largest, 1e-6);
  }



  /// Both ends turn by a tenth of a revolution in ten steps, and what is
  /// between them with them: their velocity is linear in the position.
  void
  check_turning_walls()
  {
    const double       angle = 0.02 * numbers::PI;
    std::ostringstream velocity;
    velocity.precision(17);
    velocity << "0; " << 10. * (std::cos(angle) - 1.) << " * y - "
             << 10. * std::sin(angle) << " * z; " << 10. * std::sin(angle)
             << " * y + " << 10. * (std::cos(angle) - 1.) << " * z";
    Simulated<3> run(
      block_3d("box(0, -0.3, -0.3, 1, 0.3, 0.3)")
        .with("Grid",
              {"Lower corner = 0, -0.6, -0.6",
               "Upper corner = 1, 0.6, 0.6",
               "Cells = 4, 6, 6"})
        .with("Material solid", {"Model = neo-hookean"})
        .with("Scheme", {"Mass = consistent", "Stress update = quasi-static"})
        .with("Walls",
              {"Left = moving",
               "Right = moving",
               "Left velocity = " + velocity.str(),
               "Right velocity = " + velocity.str()})
        .with("Newton", {"Tolerance = 1e-10", "Absolute tolerance = 1e-10"})
        .with("Time", {"End = 1", "Step = 0.1"}));
    run.run();
    double worst = 0.;
    for (const auto &body : run->bodies())
      body.points.for_each([&](const unsigned int, const auto point) {
        const double   c = std::cos(10. * angle), s = std::sin(10. * angle);
        const Point<3> X = point.reference();
        worst            = std::max({worst,
                                     std::abs(point.position(0) - X[0]),
                                     std::abs(point.position(1) - c * X[1] + s * X[2]),
                                     std::abs(point.position(2) - s * X[1] - c * X[2])});
      });
    check("walls turn a block",
          Utilities::MPI::max(worst, MPI_COMM_WORLD),
          1e-9);
  }



  /// A shipped file on a coarse mesh, over its exact limit load (N / m).
  double
  limit_load(const std::string &name,
             const std::string &cells,
             const double       exact)
  {
    const std::string file =
      std::string(SOURCE_DIR) + "/../../prm/simulation/" + name + ".prm";
    std::ostringstream content;
    content << std::ifstream(file).rdbuf();
    Simulated<2> run(Text(content.str()).with("Grid", {"Cells = " + cells}));
    run.run();
    return run->statistics().reactions[3][1] / exact;
  }



  void
  check_limit_loads()
  {
    // 5.5 and 2.5 cells in half of the width.
    check("limit load of a strip",
          std::abs(limit_load("footing", "22, 11", -25.70797e3) - 0.963),
          0.005);
    check("limit load of a notched plate",
          std::abs(limit_load("notched_plate", "25, 13", 1.48425e6) - 0.92),
          0.02);
  }



  /// The force of the floor bears the weight, and what it does not bear changes
  /// the momentum.
  void
  check_forces_of_walls()
  {
    const auto block = [](const std::string &scheme) {
      return block_2d("box(0.2, 0, 0.7, 0.6)")
        .with("Scheme", {"Stress update = " + scheme, "Mass = consistent"})
        .with("Walls", {"Bottom = fixed"})
        .with("Loads", {"Gravity = 0.2; -1"})
        .with("Newton", {"Tolerance = 1e-10"})
        .with("Time", {"End = 0.02", "Step = 0.01"});
    };
    Simulated<2> at_rest(block("quasi-static"));
    at_rest.run();
    Statistics<2> row = at_rest->statistics();
    Tensor<1, 2>  weight;
    weight[0] = 0.2 * row.mass;
    weight[1] = -row.mass;
    check("the floor bears the weight",
          (row.reactions[2] + weight).norm() / weight.norm(),
          1e-8);

    Simulated<2> moving(block("backward-euler"));
    moving->step();
    const Tensor<1, 2> before = moving->statistics().momentum;
    moving->step();
    row = moving->statistics();
    check(
      "what it does not bear changes the momentum",
      (row.momentum - before - row.step * (row.reactions[2] + weight)).norm() /
        (row.step * weight.norm()),
      1e-6);
  }
} // namespace



void
test_main()
{
  // 14.74 mm.
  for (const unsigned int p : {2, 3})
    {
      const double tip = membrane_tip(p);
      check("Cook's membrane, p = " + std::to_string(p),
            std::abs(tip / 14.74 - 1.),
            0.01);
      for (const double speed : {0.3, 2.})
        check_flight(p, speed);
    }
  check_collision();
  check_turning_walls();
  check_limit_loads();
  check_forces_of_walls();
}
