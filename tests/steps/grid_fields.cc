// SPDX-License-Identifier: LGPL-2.1-or-later

// Velocity fields of the grid: bodies that do not touch move in two fields as
// in one, also from a checkpoint, and those that do touch do not see one
// another. A contact of a program's own constrains velocities along a normal
// that is not an axis.
#include <greville/steps/contact.h>
#include <greville/steps/state_tables.h>

#include "simulation.h"

namespace
{
  const MPI_Comm comm = MPI_COMM_WORLD;

  using Fields = std::vector<std::vector<unsigned int>>;



  /**
   * A block that slides along a floor with friction, and one that flies.
   */
  Text
  two_blocks()
  {
    return Text()
      .add("Simulation", {"Bodies = left, right", "Materials = solid"})
      .add("Scheme", {"Mass = lumped"})
      .add("Grid", {"Upper corner = 2, 1", "Cells = 16, 8"})
      .add("Walls", {"Bottom = friction", "Bottom friction = 0.3"})
      .add("Body left",
           {"Material = solid",
            "Shape = box(0.15, 0, 0.6, 0.4)",
            "Velocity = 0.5 + 0.1 * y; 0"})
      .add("Body right",
           {"Material = solid",
            "Shape = box(1.3, 0.4, 1.7, 0.75)",
            "Velocity = -0.2 + 0.3 * y; 0.1 * x"})
      .add("Material solid",
           {"Model = linear-elastic",
            "Density = 1",
            "Young modulus = 100",
            "Poisson ratio = 0.3"})
      .add("Loads", {"Gravity = 0; -3"})
      .add("Time", {"End = 0.05", "Step = 0.0025"});
  }



  std::unique_ptr<Simulation<2>>
  simulation(const Text &text, const Fields &fields)
  {
    SimulationParameters parameters = text.parse();
    parameters.grid.fields          = fields;
    return std::make_unique<Simulation<2>>(parameters);
  }



  /**
   * Returns the last row that a step has summed up.
   */
  std::vector<std::pair<std::string, double>>
  run(Simulation<2> &simulation)
  {
    while (!simulation.is_finished())
      {
        simulation.ask_for_row(std::numeric_limits<double>::max());
        simulation.step();
      }
    return simulation.late_statistics().columns();
  }



  /**
   * Positions and velocities of all points of this process.
   */
  std::vector<double>
  values(const Simulation<2> &simulation)
  {
    std::vector<double> result;
    for (const Body<2> &body : simulation.bodies())
      body.points.for_each([&](const unsigned int, ConstPointRef<2> p) {
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



  /**
   * The mean displacement of a body.
   */
  Tensor<1, 2>
  moved(const Body<2> &body)
  {
    Tensor<1, 2> u;
    double       mass = 0.;
    body.points.for_each([&](const unsigned int, ConstPointRef<2> p) {
      mass += p.mass();
      for (unsigned int d = 0; d < 2; ++d)
        u[d] += p.mass() * (p.position(d) - p.reference(d));
    });
    for (unsigned int d = 0; d < 2; ++d)
      u[d] = Utilities::MPI::sum(u[d], comm);
    return u / Utilities::MPI::sum(mass, comm);
  }



  /**
   * Functions move across a normal only.
   */
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
      for (GridField<2> &field : step.fields)
        for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size();
             ++i)
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
  message_of_run(const Text &text, const Fields &fields)
  {
    std::string message;
    try
      {
        simulation(text, fields)->step();
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
  // The same as in one field, to round-off, or to the tolerance of the solver.
  const Fields two = {{0}, {1}};
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    for (const std::string order : {"USL", "USF", "MUSL"})
      {
        const Text text =
          two_blocks()
            .with("Scheme", {"Mass = " + mass, "Stress update = " + order})
            .with("Solver", {"Tolerance = 1e-12"});
        const auto one = simulation(text, {}), both = simulation(text, two);
        const auto row_of_one = run(*one), row_of_both = run(*both);
        const std::string name = mass + ", " + order + ": ";
        for (unsigned int c = 0; c < row_of_one.size(); ++c)
          if (row_of_one[c].first != "iterations")
            check(name + "row, " + row_of_one[c].first,
                  std::abs(row_of_one[c].second - row_of_both[c].second),
                  mass == "consistent" ? 1e-7 : 1e-12);
        check(name + "fields", both->state().fields.size() == 2);
        check(name + "points",
              distance(values(*one), values(*both)),
              mass == "consistent" ? 1e-9 : 1e-13);
        const Statistics<2> a = one->statistics(), b = both->statistics();
        check(name + "active", a.active == b.active);
        check(name + "friction",
              std::abs(a.work.friction - b.work.friction),
              1e-9);
        check(name + "slides", a.work.friction < -1e-4);
        check(name + "reaction",
              (a.reactions[2] - b.reactions[2]).norm(),
              1e-6);
      }

  // All fields are in a checkpoint: the same bits, but for where the solver of
  // friction begins with the consistent mass.
  for (const std::string mass : {"lumped", "consistent"})
    {
      const Text text  = two_blocks().with("Scheme", {"Mass = " + mass});
      const auto first = simulation(text, two), next = simulation(text, two);
      for (unsigned int k = 0; k < 8; ++k)
        first->step();
      TablesFile content;
      content.tables = make_tables(first->state(), first->space());
      State<2> state = next->state();
      set_from_tables(state, content, next->grid());
      next->set_state(state);
      first->set_state(State<2>(first->state()));
      run(*first);
      run(*next);
      check(mass + ", checkpoint",
            distance(values(*first), values(*next)),
            mass == "lumped" ? 0. : 1e-9);
    }

  // Bodies that meet: one field sticks, those of two pass through one another.
  const Text meeting =
    two_blocks()
      .with("Walls", {"Bottom = free", "Bottom friction = 0"})
      .with("Loads", {"Gravity = "})
      .with("Body left", {"Shape = box(0.4, 0.3, 0.8, 0.7)", "Velocity = 1; 0"})
      .with("Body right",
            {"Shape = box(0.9, 0.3, 1.3, 0.7)", "Velocity = -1; 0"})
      .with("Time", {"End = 0.2"});
  const auto sticking = simulation(meeting, {}),
             passing  = simulation(meeting, two);
  run(*sticking);
  run(*passing);
  check("sticks", moved(sticking->bodies()[0])[0] < 0.15);
  check("passes",
        std::abs(moved(passing->bodies()[0])[0] - 0.2) +
          std::abs(moved(passing->bodies()[1])[0] + 0.2),
        1e-12);

  // What is refused.
  check_refused("no field",
                message_of_run(two_blocks(), {{0}}),
                "'right' is in 0 of GridParameters::fields");
  check_refused("twice",
                message_of_run(two_blocks(), {{0}, {1, 0}}),
                "'left' is in 2 of GridParameters::fields");
  check_refused("no such body",
                message_of_run(two_blocks(), {{0}, {1, 2}}),
                "has the body number 2 of 2");
  check_refused(
    "implicit",
    message_of_run(two_blocks()
                     .with("Walls", {"Bottom = fixed", "Bottom friction = 0"})
                     .with("Scheme", {"Stress update = newmark"}),
                   two),
    "several GridParameters::fields");

  // A block slides down a plane that no axis is normal to.
  add_contact<2>(&Rail::make);
  const double angle = numbers::PI / 6.;
  const Text   falls = block_2d("box(0.45, 0.55, 0.75, 0.85)")
                       .with("Loads", {"Gravity = 0; -10"})
                       .with("Body body", {"Velocity = 0; -1"})
                       .with("Time", {"End = 0.1", "Step = 0.002"});
  Rail::normal = Point<2>(std::sin(angle), std::cos(angle));
  for (const std::string order : {"USL", "USF", "MUSL"})
    {
      const auto sliding =
        simulation(falls.with("Scheme", {"Stress update = " + order}), {});
      run(*sliding);
      const Tensor<1, 2> u    = moved(sliding->bodies()[0]);
      const Tensor<1, 2> down = Point<2>(std::cos(angle), -std::sin(angle));
      const double       path = std::sin(angle) * (0.1 + 0.5 * 10. * 0.1 * 0.1);
      check(order + ", across the normal", std::abs(u * down - path), 1e-10);
      check(order + ", along it", std::abs(u * Rail::normal), 1e-10);
      // What is constrained does no work where it does not move.
      check(order + ", work",
            std::abs(sliding->statistics().work.walls),
            1e-10);
    }
  for (const std::string mass : {"consistent", "fmpm-2"})
    check_refused(mass,
                  message_of_run(falls.with("Scheme", {"Mass = " + mass}), {}),
                  "along a normal that is not an axis");

  check_refused("implicit steps with a contact",
                message_of_run(falls.with("Scheme",
                                          {"Stress update = newmark",
                                           "Mass = lumped"}),
                               {}),
                "a contact of add_contact()");

  // An axis is a component, for all masses.
  Rail::normal = Point<2>(0., 1.);
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      std::vector<std::vector<double>> results;
      for (const bool by_components : {false, true})
        {
          Rail::by_components = by_components;
          const auto rests =
            simulation(falls.with("Scheme", {"Mass = " + mass}), {});
          run(*rests);
          results.push_back(values(*rests));
          check(mass + ", rests", moved(rests->bodies()[0]).norm(), 1e-10);
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
