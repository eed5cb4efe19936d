// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks that two simulations with different parameters, names and dimensions,
// which step alternately in one program, agree with each alone, and that a
// change of a copy leaves the original parameters unchanged.
#include "simulation.h"

namespace
{
  constexpr unsigned int n_steps = 12;

  template <int dim>
  std::vector<double>
  state_of(const Simulation<dim> &simulation)
  {
    auto result = simulation.statistics().values();
    result.push_back(simulation.state().time);
    result.push_back(simulation.state().step);
    result.push_back(simulation.state().n_all_iterations);
    return result;
  }

  template <int dim>
  std::vector<double>
  alone(const Text &text)
  {
    Simulation<dim> simulation(text.parse());
    while (simulation.state().n_steps < n_steps)
      simulation.step();
    return state_of(simulation);
  }

  std::string
  message_of_check(const SimulationParameters &parameters)
  {
    try
      {
        parameters.check();
      }
    catch (const std::exception &error)
      {
        return message_of(error);
      }
    return "";
  }
} // namespace



void
test_main()
{
  // An elastic block that is pulled, and a heavy ball that falls on a fluid.
  const Text plane =
    Text()
      .add("Simulation",
           {"Bodies = block", "Materials = rubber", "Surface loads = pull"})
      .add("Grid", {"Cells = 8, 8", "Order = 3"})
      .add("Scheme", {"Mass = consistent", "Filter = 0.2"})
      .add("Solver", {"Tolerance = 1e-10"})
      .add("Walls", {"Left = fixed"})
      .add("Body block",
           {"Material = rubber",
            "Shape = box(0, 0, 0.6, 0.5)",
            "Placement = fitted"})
      .add("Material rubber",
           {"Model = neo-hookean", "Density = 1", "Young modulus = 100"})
      .add("Surface load pull",
           {"Body = block", "Where = x > 0.599", "Traction = 10; 0"})
      .add("Time", {"End = 10"});
  const Text space =
    Text()
      .add("Simulation",
           {"Dimension = 3", "Bodies = pool, ball", "Materials = water, lead"})
      .add("Grid",
           {"Lower corner = 0, 0, 0",
            "Upper corner = 1, 1, 1",
            "Cells = 4, 4, 4",
            "Order = 1"})
      .add("Loads", {"Gravity = 0; 0; -10"})
      .add("Walls", {"Back = friction", "Back friction = 0.2"})
      .add("Body pool", {"Material = water", "Shape = box(0, 0, 0, 1, 1, 0.5)"})
      .add("Body ball",
           {"Material = lead",
            "Shape = ball(0.5, 0.5, 0.76, 0.2)",
            "Velocity = 0; 0; -1"})
      .add("Material water",
           {"Model = newtonian-fluid", "Density = 1", "Sound speed = 20"})
      .add("Material lead",
           {"Model = linear-elastic", "Density = 10", "Young modulus = 1e3"})
      .add("Time", {"End = 10", "CFL number = 0.3"});
  const auto plane_alone = alone<2>(plane);
  const auto space_alone = alone<3>(space);

  {
    const SimulationParameters a = plane.parse("a.prm"),
                               b = space.parse("b.prm");
    check("names", a.bodies.count("block") == 1 && b.bodies.count("pool") == 1);
    check("names of others",
          a.bodies.size() == 1 && a.materials.size() == 1 &&
            b.surface_loads.empty() &&
            b.used().find("block") == std::string::npos);
    check("defaults of others",
          a.solver.tolerance == 1e-10 && b.solver.tolerance == 0. &&
            a.scheme.filter == 0.2 && b.scheme.filter == 0.4 &&
            a.scheme.mass == "consistent" && b.scheme.mass == "lumped");

    // Simulations have their own parameters.
    Simulation<2> first{SimulationParameters(a)};
    Simulation<3> second{SimulationParameters(b)};
    while (second.state().n_steps < n_steps)
      {
        first.step();
        second.step();
      }
    check("the plane one as alone", state_of(first) == plane_alone);
    check("the other one as alone", state_of(second) == space_alone);
  }

  const SimulationParameters original = plane.parse();
  SimulationParameters       copy     = original;
  copy.grid.cells                     = {4, 4};
  copy.grid.degree                    = 2;
  copy.bodies["block"].shape          = "box(0, 0, 0.6, 0.75)";
  Simulation<2> changed(copy), unchanged(original);
  check("a copy has its own grid",
        changed.space().degree() == 2 && unchanged.space().degree() == 3 &&
          original.grid.cells[0] == 8);
  check("and its own bodies",
        changed.bodies()[0].n_points != unchanged.bodies()[0].n_points);
  while (unchanged.state().n_steps < n_steps)
    {
      changed.step();
      unchanged.step();
    }
  check("the original runs as before", state_of(unchanged) == plane_alone);

  check("parameters can be checked", message_of_check(copy).empty());
  copy.grid.upper = {1., 1., 1.};
  print() << message_of_check(copy) << std::endl;
}
