// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1 2

// Checks the projection of volume changes: a nearly incompressible beam bends
// without locking, in quasi-static and in explicit steps.
#include "simulation.h"
#include <iomanip>

namespace
{
  template <int dim>
  Text
  beam(const unsigned int n,
       const unsigned int p,
       const std::string &projection)
  {
    const std::string cells = std::to_string(5 * n) + ", " +
                              std::to_string(2 * n) +
                              (dim == 3 ? ", " + std::to_string(2 * n) : "");
    Text text = dim == 2
                  ? block_2d("box(0, 0.6, 4, 1.6)")
                      .with("Grid", {"Upper corner = 5, 2"})
                      .with("Loads", {"Gravity = 0; -0.1 * min(1, t)"})
                  : block_3d("box(0, 0.6, 0.6, 4, 1.6, 1.6)")
                      .with("Grid", {"Upper corner = 5, 2, 2"})
                      .with("Loads", {"Gravity = 0; -0.1 * min(1, t); 0"});
    return text
      .with("Grid", {"Cells = " + cells, "Order = " + std::to_string(p)})
      .with("Body body", {"Points per direction = 3"})
      .with("Material solid",
            {"Model = neo-hookean",
             "Density = 1000",
             "Young modulus = 1e6",
             "Poisson ratio = 0.499"})
      .with("Walls", {"Left = fixed"})
      .with("Scheme", {"Volumetric projection = " + projection})
      // Surfaces lie between cells.
      .with("Scheme", {"Filling threshold = 0"});
  }



  Text
  quasi_static(const Text &text)
  {
    return text.with("Scheme", {"Stress update = quasi-static"})
      .with("Time", {"End = 1", "Step = 1"});
  }



  /// How far the end of the beam has come down.
  template <int dim>
  double
  deflection(Simulated<dim> &simulated)
  {
    simulated.run();
    double sums[2] = {};
    for (const Body<dim> &body : simulated->bodies())
      body.points.for_each([&](const ConstPointRef<dim> p) {
        if (p.reference(0) < 3.5)
          return;
        sums[0] += p.reference(1) - p.position(1);
        sums[1] += 1.;
      });
    Utilities::MPI::sum(ArrayView<const double>(sums, 2),
                        MPI_COMM_WORLD,
                        ArrayView<double>(sums, 2));
    return sums[0] / sums[1];
  }

  template <int dim>
  double
  deflection(const Text &text)
  {
    Simulated<dim> simulated(text);
    return deflection(simulated);
  }



  void
  check_ratio(const std::string &name,
              const double       ratio,
              const double       low,
              const double       high)
  {
    check(name, low < ratio && ratio < high);
    if (!(low < ratio && ratio < high))
      print() << "  " << ratio << " is not between " << low << " and " << high
              << std::endl;
  }



  void
  check_quasi_static()
  {
    const double exact =
      deflection<2>(quasi_static(beam<2>(5, 3, "order p-1")));
    const auto ratio = [&](const unsigned int p,
                           const std::string &projection) {
      return deflection<2>(quasi_static(beam<2>(5, p, projection))) / exact;
    };
    check_ratio("order 1 locks", ratio(1, "none"), 0., 0.5);
    check_ratio("order 1", ratio(1, "order p-1"), 0.97, 1.03);
    check_ratio("order 2 locks a little", ratio(2, "none"), 0.9, 0.97);
    check_ratio("order 2", ratio(2, "order p-1"), 0.99, 1.01);
    check_ratio("order 3", ratio(3, "none"), 0.98, 1.001);
    print() << "deflection " << std::setprecision(4) << 100. * exact << " cm"
            << std::endl;
  }



  void
  check_3d()
  {
    const double fine = deflection<3>(quasi_static(beam<3>(3, 2, "order p-1")));
    check_ratio("3D, order 1 locks",
                deflection<3>(quasi_static(beam<3>(3, 1, "none"))) / fine,
                0.,
                0.6);
    check_ratio("3D, order 1",
                deflection<3>(quasi_static(beam<3>(3, 1, "order p-1"))) / fine,
                0.93,
                1.1);
  }



  /// Half of a swing, which takes longer the softer the beam is.
  void
  check_explicit()
  {
    const auto run = [](const unsigned int p, const std::string &projection) {
      return deflection<2>(beam<2>(5, p, projection)
                             .with("Time", {"End = 0.6"})
                             .with("Loads", {"Gravity = 0; -0.1"}));
    };
    const double exact = run(3, "order p-1");
    check_ratio("explicit, order 1 locks", run(1, "none") / exact, -1., 0.7);
    check_ratio("explicit, order 1", run(1, "order p-1") / exact, 0.9, 1.1);
  }



  /// A uniform change of volume is not projected.
  void
  check_even_compression()
  {
    const auto strain = [](const unsigned int p,
                           const std::string &projection) {
      Simulated<2> simulated(quasi_static(
        block_2d("box(0, 0, 1, 1)", 5)
          .with("Grid", {"Order = " + std::to_string(p)})
          .with("Body body", {"Points per direction = 4", "Placement = Gauss"})
          .with("Walls",
                {"Left = sliding",
                 "Right = sliding",
                 "Bottom = sliding",
                 "Top = moving",
                 "Top displacement = 0; -0.019 * t"})
          .with("Scheme", {"Volumetric projection = " + projection})
          .with("Material solid", {"Model = neo-hookean"})));
      simulated.run();
      double largest = 0.;
      for (const Body<2> &body : simulated->bodies())
        body.points.for_each([&](const ConstPointRef<2> p) {
          largest = std::max(largest, std::abs(p.J() - 0.981));
        });
      return Utilities::MPI::max(largest, MPI_COMM_WORLD);
    };
    for (const unsigned int p : {1, 2, 3})
      check_ratio("even compression, p = " + std::to_string(p),
                  strain(p, "order p-1"),
                  -1.,
                  1e-8);
  }



  /// Both names that do not go together.
  void
  check_refused()
  {
    const auto message = [](const std::vector<std::string> &scheme,
                            const std::vector<std::string> &solver) {
      try
        {
          Simulated<2> simulated(beam<2>(2, 2, "order p-1")
                                   .with("Scheme", scheme)
                                   .with("Implicit solver", solver)
                                   .with("Time", {"Step = 0.1"}));
        }
      catch (const std::exception &error)
        {
          return message_of(error);
        }
      return std::string();
    };
    check("implicit-midpoint",
          message({"Stress update = implicit-midpoint"}, {})
              .find("Volumetric projection") != std::string::npos);
    check("conjugate gradients",
          message({"Stress update = quasi-static"}, {"Method = cg"})
              .find("Implicit solver/Method") != std::string::npos);
  }
} // namespace



void
test_main()
{
  check_quasi_static();
  check_3d();
  check_explicit();
  check_even_compression();
  check_refused();
}
