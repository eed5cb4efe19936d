// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a point load that the program defines without changing the library: a
// magnet that pulls points, which it marks at the start. It must act like a
// body force with the same formula.

#include <greville/boundary/point_load.h>

#include "simulation.h"

namespace
{
  double strength = 0.; // m / s^2

  class Magnet : public PointLoad<2>
  {
  public:
    static PointLoads<2>
    make(const SimulationParameters &)
    {
      PointLoads<2> result;
      if (strength > 0.)
        result.push_back(std::make_unique<Magnet>());
      return result;
    }

    std::string
    parameter_names() const override
    {
      return "the magnet";
    }

    void
    add_fields(PointLayout<2> &layout) const override
    {
      layout.add("magnet", 1);
    }

    void
    find_points(std::vector<Body<2>> &bodies, const MPI_Comm) const override
    {
      for (Body<2> &body : bodies)
        {
          const unsigned int field = body.points.layout().first("magnet");
          body.points.for_each(
            [&](PointRef<2> p) { p[field] = p.reference(0) > 0.4 ? 1. : 0.; });
        }
    }

    void
    add_acceleration(MaterialPoints<2> &points,
                     const unsigned int first,
                     const double       t) const override
    {
      const unsigned int field = points.layout().first("magnet");
      points.for_each(
        [&](PointRef<2> p) { p[first] += p[field] * strength * (1. + t); });
    }
  };



  Statistics<2>
  run(const double with_strength, const std::vector<std::string> &loads)
  {
    strength = with_strength;
    Simulated<2> simulated(block_2d("box(0.2, 0.2, 0.6, 0.6)", 10)
                             .with("Loads", loads)
                             .with("Time", {"End = 0.1", "Step = 0.005"}));
    return simulated.run()->statistics();
  }
} // namespace



void
test_main()
{
  add_point_load<2>(Magnet::make);
  const Statistics<2> own = run(3., {}),
                      library =
                        run(0.,
                            {"Body force = if(X > 0.4, 3 * (1 + t), 0); 0"});
  check("the magnet pulls", own.momentum[0] > 0.01);
  check("momentum",
        std::abs(own.momentum[0] - library.momentum[0]),
        1e-12 * own.momentum[0]);
  check("strain energy",
        std::abs(own.strain - library.strain),
        1e-11 * own.strain);
}
