// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks soil with a strength that decreases in time: a block at rest under its
// weight stays elastic until its strength no longer suffices, on any number of
// processes. A formula without a strength ends the run with a message.

#include "simulation.h"

namespace
{
  Text
  block(const std::string &law, const std::string &reduction)
  {
    return Text()
      .add("Simulation", {"Bodies = block", "Materials = soil"})
      .add("Scheme", {"Mass = lumped"})
      .add("Grid", {"Cells = 10, 10"})
      .add("Body block",
           {"Material = soil",
            "Shape = box(0., 0., 0.6, 0.5)",
            "K0 = 0.5",
            "Surface = 0.5"})
      .add("Material soil",
           {"Model = " + law,
            "Density = 2000",
            "Young modulus = 1e6",
            "Friction angle = 30",
            "Cohesion = 3e3",
            "Strength reduction = " + reduction})
      .add("Walls", {"Left = sliding", "Bottom = fixed"})
      .add("Loads", {"Gravity = 0; -10"})
      .add("Time", {"End = 0.1", "Step = 0.002"});
  }



  void
  test(const std::string &law)
  {
    double heat[3];
    for (const unsigned int i : {0, 1, 2})
      {
        const std::string formulas[] = {"1",
                                        "1 + 100 * max(0, t - 0.05)",
                                        "1 + 100 * max(0, t - 0.03)"};
        Simulated<2>      simulated(block(law, formulas[i]));
        heat[i] = simulated.run()->statistics().dissipation;
      }
    print() << law << ": heat " << heat[0] << ", " << heat[1] << ", " << heat[2]
            << " J" << std::endl;
    check("  strength that falls", heat[0] < heat[1] && heat[1] < heat[2]);
  }
} // namespace



void
test_main()
{
  test("drucker-prager");
  test("mohr-coulomb");
  for (const std::string formula : {"1 - 30 * t", "sqrt(0.051 - t)"})
    try
      {
        Simulated<2> simulated(block("mohr-coulomb", formula));
        simulated.run();
        check("a formula without strength is refused", false);
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
}
