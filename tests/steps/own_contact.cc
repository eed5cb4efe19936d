// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a contact of the program that constrains velocities along a normal
// that is not an axis.
#include <greville/steps/contact.h>

#include "simulation.h"

namespace
{
  const MPI_Comm comm = MPI_COMM_WORLD;

  void
  run(Simulation<2> &simulation)
  {
    while (!simulation.is_finished())
      simulation.step();
  }



  /// Positions and velocities of all points of this process.
  std::vector<double>
  values(const Simulation<2> &simulation)
  {
    std::vector<double> result;
    for (const Body<2> &body : simulation.bodies())
      body.points.for_each([&](ConstPointRef<2> p) {
        for (unsigned int d = 0; d < 2; ++d)
          {
            result.push_back(p.position(d));
            result.push_back(p.velocity(d));
          }
      });
    return result;
  }



  double
  distance(const std::vector<double> &a, const std::vector<double> &b)
  {
    double result = a.size() == b.size() ? 0. : 1.;
    for (unsigned int k = 0; k < std::min(a.size(), b.size()); ++k)
      result = std::max(result, std::abs(a[k] - b[k]));
    return Utilities::MPI::max(result, comm);
  }



  /// The mean displacement of a body.
  Tensor<1, 2>
  moved(const Body<2> &body)
  {
    Tensor<1, 2> u;
    double       mass = 0.;
    body.points.for_each([&](ConstPointRef<2> p) {
      mass += p.mass();
      for (unsigned int d = 0; d < 2; ++d)
        u[d] += p.mass() * (p.position(d) - p.reference(d));
    });
    for (unsigned int d = 0; d < 2; ++d)
      u[d] = Utilities::MPI::sum(u[d], comm);
    return u / Utilities::MPI::sum(mass, comm);
  }



  /// Functions move across a normal only.
  class Rail : public Contact<2>
  {
  public:
    static Tensor<1, 2> normal;
    static bool         by_components;

    static std::unique_ptr<Contact<2>>
    make(const IntegratorParts<2> &)
    {
      return normal.norm() > 0. ? std::make_unique<Rail>() : nullptr;
    }

    void
    constrain(ContactStep<2> &step) override
    {
      GridField<2> &field = step.field;
      for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size(); ++i)
        {
          if (by_components)
            field.constraints.components[i] |= 2;
          else
            field.constraints.directions.emplace_back(i, 2. * normal);
          for (auto *given : {&field.velocity, &field.acceleration})
            {
              const double part = values_at<2>(*given, i) * normal;
              for (unsigned int d = 0; d < 2; ++d)
                (*given)[d].local_element(i) -= part * normal[d];
            }
        }
    }

    bool
    constrains() const override
    {
      return true;
    }
  };

  Tensor<1, 2> Rail::normal;
  bool         Rail::by_components = false;



  std::string
  message_of_run(const Text &text)
  {
    std::string message;
    try
      {
        Simulation<2>(text.parse()).step();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    MPI_Barrier(comm);
    return message;
  }



  void
  check_refused(const std::string &name,
                const std::string &message,
                const std::string &wanted)
  {
    check(name + ": " + message, message.find(wanted) != std::string::npos);
  }
} // namespace



void
test_main()
{
  // A block slides down a plane that no axis is normal to.
  add_contact<2>(&Rail::make);
  const double angle = numbers::PI / 6.;
  const Text   falls = block_2d("box(0.45, 0.55, 0.75, 0.85)")
                       .with("Loads", {"Gravity = 0; -10"})
                       .with("Body body", {"Velocity = 0; -1"})
                       .with("Time", {"End = 0.1", "Step = 0.002"});
  Rail::normal = Point<2>(std::sin(angle), std::cos(angle));
  for (const std::string order : {"USL", "MUSL"})
    {
      Simulation<2> sliding(
        falls.with("Scheme", {"Stress update = " + order}).parse());
      run(sliding);
      const Tensor<1, 2> u    = moved(sliding.bodies()[0]);
      const Tensor<1, 2> down = Point<2>(std::cos(angle), -std::sin(angle));
      const double       path = std::sin(angle) * (0.1 + 0.5 * 10. * 0.1 * 0.1);
      check(order + ", across the normal", std::abs(u * down - path), 1e-10);
      check(order + ", along it", std::abs(u * Rail::normal), 1e-10);
      // Constraints do no work on functions that do not move.
      check(order + ", work", std::abs(sliding.statistics().work.walls), 1e-10);
    }
  for (const std::string mass : {"consistent", "fmpm-2"})
    check_refused(mass,
                  message_of_run(falls.with("Scheme", {"Mass = " + mass})),
                  "along a normal that is not an axis");

  check_refused("implicit steps with a contact",
                message_of_run(falls.with(
                  "Scheme", {"Stress update = newmark", "Mass = lumped"})),
                "a contact of add_contact()");

  // An axis is a component, for all masses.
  Rail::normal = Point<2>(0., 1.);
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      std::vector<std::vector<double>> results;
      for (const bool by_components : {false, true})
        {
          Rail::by_components = by_components;
          Simulation<2> rests(falls.with("Scheme", {"Mass = " + mass}).parse());
          run(rests);
          results.push_back(values(rests));
          check(mass + ", rests", moved(rests.bodies()[0]).norm(), 1e-10);
        }
      check(mass + ", the same bits", distance(results[0], results[1]) == 0.);
    }
  Rail::normal = Tensor<1, 2>();

  // Directions in the space of components that are free.
  Constraints<2> constraints;
  constraints.clear(4);
  constraints.components[3] = 2;
  constraints.directions    = {{0, Point<2>(1., 1.)},
                               {0, Point<2>(-2., -2.)},
                               {1, Point<2>(1., 1.)},
                               {1, Point<2>(3., 1.)},
                               {2, Point<2>(1., 1.)},
                               {3, Point<2>(0., 1.)}};
  const auto reduced        = constraints.reduce({0, 0, 1, 0});
  check("directions", reduced.size() == 2);
  check("one direction", reduced[0].function == 0 && reduced[0].n == 1);
  check("all directions", reduced[1].function == 1 && reduced[1].n == 2);
  check("an axis is left", constraints.components[2] == 2);
  check("nothing is left", constraints.components[3] == 2);
}
