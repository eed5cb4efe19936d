// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks loads on surfaces of bodies: their forces, their effect in explicit
// and implicit steps, and refused input.
#include "simulation.h"

namespace
{
  const std::string total   = "Formulation = total Lagrangian";
  const std::string updated = "Formulation = updated Lagrangian";

  /// A body with fitted points and one load.
  Text
  loaded(const Text                     &text,
         const std::vector<std::string> &load,
         const std::vector<std::string> &scheme = {total},
         const unsigned int              n      = 3)
  {
    return text.with("Simulation", {"Surface loads = load"})
      .with("Body body",
            {"Placement = fitted",
             "Points per direction = " + std::to_string(n)})
      .with("Scheme", {"Mass = consistent"})
      .with("Scheme", scheme)
      .with("Surface load load", {"Body = body"})
      .with("Surface load load", load);
  }

  template <int dim>
  Tensor<1, dim>
  resultant(const Simulated<dim> &simulated)
  {
    return simulated.simulation.statistics().loads[0].second;
  }



  void
  check_resultants()
  {
    // Of uniform pressure: zero all around, also when the body has deformed.
    for (const std::string &formulation : {total, updated})
      {
        Simulated<2> box(
          loaded(block_2d("box(0.13, 0.21, 0.77, 0.83)", 8)
                   .with("Material solid", {"Model = neo-hookean"})
                   .with("Body body", {"Velocity = 2 * y^2 - x; x * y"})
                   .with("Time", {"End = 0.1", "Step = 0.002"}),
                 {"Kind = pressure", "Pressure = 10"},
                 {formulation}));
        check(formulation + ": pressure around a box, at rest",
              resultant(box).norm(),
              1e-12);
        const Statistics<2> end = box.run()->statistics();
        check("deformed", end.strain > 0.1 * end.kinetic);
        check(formulation + ": pressure around a deformed box",
              resultant(box).norm() / (10. * 2. * 1.26),
              formulation == total ? 1e-12 : 1e-2);
      }
    {
      Simulated<3> box(
        loaded(block_3d("box(0.1, 0.2, 0.15, 0.8, 0.7, 0.9)", 4)
                 .with("Material solid", {"Model = neo-hookean"})
                 .with("Body body", {"Velocity = 4 * y^2; z^2; x * y"})
                 .with("Time", {"End = 0.03", "Step = 0.003"}),
               {"Kind = pressure", "Pressure = 10"}));
      box.run();
      check("pressure around a deformed box in 3D",
            resultant(box).norm() / 20.,
            1e-12);
    }

    // On half of a disk and of a ball, and on an edge.
    const Simulated<2> disk(
      loaded(block_2d("ball(0.5, 0.5, 0.31)", 8),
             {"Kind = pressure", "Pressure = 2", "Where = x > 0.5"},
             {total},
             4));
    check("pressure on half a disk",
          (resultant(disk) - Point<2>(-2. * 0.62, 0.)).norm(),
          1e-6);
    const Simulated<3> ball(
      loaded(block_3d("ball(0.5, 0.5, 0.5, 0.41)", 4),
             {"Kind = pressure", "Pressure = 2", "Where = z < 0.5"},
             {total},
             4));
    check("pressure on half a ball",
          (resultant(ball) - Point<3>(0., 0., 2. * numbers::PI * 0.41 * 0.41))
            .norm(),
          1e-4);
    const Simulated<2> edge(loaded(block_2d("box(0.13, 0.21, 0.77, 0.83)", 8),
                                   {"Kind = traction",
                                    "Traction = 3 * (Y - 0.21); 1",
                                    "Where = x > 0.769"}));
    check("traction on an edge",
          (resultant(edge) - Point<2>(1.5 * 0.62 * 0.62, 0.62)).norm(),
          1e-12);
    const Simulated<2> stretched(
      loaded(block_2d("box(0.25, 0.25, 0.5, 0.5)", 8)
               .with("Body body", {"Displacement = 0; y"}),
             {"Traction = 3; 0", "Area = current", "Where = x > 0.49"}));
    check("traction per current area",
          (resultant(stretched) - Point<2>(1.5, 0.)).norm(),
          1e-8);
  }



  /// A free body gets the momentum of the force times the time.
  void
  check_momentum()
  {
    for (const std::string &formulation : {total, updated})
      for (const std::string scheme :
           {"USL", "MUSL", "newmark", "backward-euler"})
        for (const std::string mass : {"lumped", "consistent"})
          {
            const bool is_implicit =
              scheme == "newmark" || scheme == "backward-euler";
            Simulated<2>        body(loaded(
              block_2d("box(0.2, 0.25, 0.7, 0.75)")
                .with("Time", {"End = 0.1", "Step = 0.0025"})
                .with("Newton", {"Tolerance = 1e-10"})
                .with("Body body", {"Velocity = 1; 0"}),
              {"Traction = 3; -1", "Where = y > 0.74"},
              {formulation, "Stress update = " + scheme, "Mass = " + mass}));
            const Tensor<1, 2>  before = body->statistics().momentum;
            const Statistics<2> end    = body.run()->statistics();
            // Velocities of explicit steps are those half a step before.
            const double time = is_implicit ? 0.1 : 0.09875;
            check(formulation + ", " + scheme + ", " + mass + ": momentum",
                  (end.momentum - before - Point<2>(1.5, -0.5) * time).norm(),
                  formulation == total ? 1e-8 : 2e-3);
          }
  }



  /// A state to go back to has the surfaces, too; stages share them.
  void
  check_states()
  {
    const Text   body = loaded(block_2d("ball(0.5, 0.5, 0.31)", 8)
                               .with("Body body", {"Velocity = 2; -y"})
                               .with("Time", {"End = 0.1", "Step = 0.005"}),
                             {"Kind = spring", "Stiffness = 100"});
    Simulated<2> run(body);
    for (unsigned int k = 0; k < 10; ++k)
      run->step();
    const State<2>     state = run->state();
    const Tensor<1, 2> force = resultant(run);
    run.run();
    const Tensor<1, 2> first = resultant(run);
    run->set_state(state);
    check("state: force", resultant(run) == force);
    run.run();
    check("state: force at the end", resultant(run) == first);

    // A body in equilibrium under all loads stays at rest in explicit steps.
    // (It lies between cells, so that both have the same extension.)
    Text text =
      loaded(block_2d("box(0.25, 0.25, 0.75, 0.75)", 8)
               .with("Material solid", {"Model = neo-hookean"})
               .with("Newton", {"Tolerance = 1e-11"}),
             {"Kind = pressure",
              "Pressure = 10 * min(1, t)",
              "Where = x > 0.7499"})
        .with("Simulation",
              {"Surface loads = load, pull, hold, rest, absorb",
               "Stages = static, dynamic"})
        .with("Surface load pull",
              {"Body = body",
               "Where = y > 0.7499",
               "Traction = x * min(1, t); 3 * min(1, t)",
               "Area = current"})
        .with("Surface load hold",
              {"Body = body",
               "Where = x < 0.2501",
               "Kind = displacement",
               "Displacement = 0.1 * min(1, t); 0"})
        .with("Surface load rest",
              {"Body = body", "Kind = spring", "Stiffness = 10"})
        .with("Surface load absorb", {"Body = body", "Kind = dashpot"});
    const auto in_stage = [&](const std::string              &name,
                              const std::string              &section,
                              const std::vector<std::string> &lines) {
      text.content += "subsection Stage " + name + "\n" +
                      Text().add(section, lines).content + "end\n";
    };
    in_stage("static", "Time", {"End = 1", "Step = 0.25"});
    in_stage("static", "Scheme", {"Stress update = quasi-static"});
    in_stage("dynamic", "Time", {"End = 1.1"});
    in_stage("dynamic", "Scheme", {"Stress update = USL"});
    Simulated<2> stages(text);
    while (stages->state().stage == 0)
      stages->step();
    const auto before = stages->statistics();
    const auto after  = stages.run()->statistics();
    check("equilibrium: energy of motion", after.kinetic / after.strain, 1e-16);
    check("equilibrium: strain energy",
          std::abs(after.strain / before.strain - 1.),
          1e-8);
    Tensor<1, 2> sum;
    for (const auto &load : after.loads)
      sum += load.second;
    check("equilibrium: sum of loads", sum.norm(), 1e-7);
    check("equilibrium: stretch", after.strain > 0.1);
  }



  /// A wave in a bar without lateral strain leaves through a dashpot.
  void
  check_dashpot(const std::string &scheme, const std::string &formulation)
  {
    const std::string c = "11.6024", s = "max(-0.25, min(0.25, x - 0.5))";
    Text              bar;
    bar.add("Simulation", {"Bodies = body", "Materials = solid"})
      .add("Grid",
           {"Lower corner = -0.125, 0",
            "Upper corner = 1.125, 0.125",
            "Cells = 40, 4"})
      .add("Walls", {"Bottom = sliding", "Top = sliding"})
      .add("Time", {"End = 0.085"})
      .add("Body body",
           {"Material = solid",
            "Shape = box(0, 0, 1, 0.125)",
            "Velocity = 1e-3 * (1 + cos(4 * pi * (" + s + "))); 0",
            "Displacement = -1e-3 / " + c + " * (" + s + " + sin(4 * pi * (" +
              s + ")) / (4 * pi)); 0"})
      .add("Material solid",
           {"Model = neo-hookean",
            "Density = 1",
            "Young modulus = 100",
            "Poisson ratio = 0.3"});
    if (scheme != "USL")
      bar.add("Time", {"Step = 1e-3"});
    Simulated<2>        run(loaded(bar,
                            {"Kind = dashpot", "Where = x > 0.9999"},
                            {"Stress update = " + scheme, formulation}));
    const Statistics<2> begin = run->statistics();
    const Statistics<2> end   = run.run()->statistics();
    const double        part =
      (end.kinetic + end.strain) / (begin.kinetic + begin.strain);
    check(scheme + ", " + formulation + ": amplitude that a dashpot sends back",
          std::sqrt(part),
          0.01);
    if (std::getenv("SHOW"))
      print() << scheme << ": amplitude " << std::sqrt(part) << ", "
              << run->state().n_steps << " steps" << std::endl;
    // The dashpot has all of the energy.
    check(scheme + ", " + formulation + ": work of a dashpot",
          std::abs(run->state().energy.work(MPI_COMM_WORLD) /
                     (begin.kinetic + begin.strain) +
                   1.),
          0.01);
  }



  /// A block without Poisson's ratio between a spring and a traction.
  void
  check_equilibrium(const std::string              &name,
                    const double                    k,
                    const std::vector<std::string> &hold)
  {
    for (const std::string &formulation : {total, updated})
      {
        std::ostringstream exact;
        exact.precision(12);
        exact << "Displacement = 1e-3 / " << k << " + 1e-5 * (X - 0.2); 0";
        Simulated<2> run(
          loaded(block_2d("box(0.2, 0, 0.7, 0.5)", 8)
                   .with("Material solid", {"Poisson ratio = 0"})
                   .with("Walls", {"Bottom = sliding"})
                   .with("Time", {"End = 1", "Step = 1"})
                   .with("Newton", {"Tolerance = 1e-10"})
                   .with("Exact solution", {exact.str()}),
                 {"Traction = 1e-3 * t; 0", "Where = x > 0.699"},
                 {"Stress update = quasi-static", formulation})
            .with("Simulation", {"Surface loads = load, hold"})
            .with("Surface load hold", {"Body = body", "Where = x < 0.2001"})
            .with("Surface load hold", hold));
        const auto loads = run.run()->statistics().loads;
        check(name + ", " + formulation + ": reaction",
              (loads[0].second + loads[1].second).norm() / 5e-4,
              1e-7);
        check(name + ", " + formulation + ": displacement",
              run.displacement_error().l2,
              1e-4);
      }
  }



  /// Newton's method with the exact tangents of all loads is quadratic.
  void
  check_tangents()
  {
    for (const std::string &formulation : {total, updated})
      for (const std::vector<std::string> &load :
           std::vector<std::vector<std::string>>{
             {"Kind = pressure", "Pressure = 25 * t * (1 + x)"},
             {"Traction = 20 * y * t; 10 * t", "Area = current"},
             {"Kind = displacement",
              "Displacement = 0.2 * X * t; 0.1 * t",
              "Stiffness = 300"}})
        {
          std::string message = "converged";
          try
            {
              std::vector<std::string> lines = load;
              lines.push_back("Where = x > 0.699");
              Simulated<2> run(
                loaded(block_2d("box(0, 0.2, 0.7, 0.5)", 8)
                         .with("Material solid", {"Model = neo-hookean"})
                         .with("Walls", {"Left = fixed"})
                         .with("Time", {"End = 1", "Step = 1"})
                         .with("Newton",
                               {"Tolerance = 1e-11",
                                "Largest linear tolerance = 1e-5",
                                "Maximum iterations = 10"})
                         .with("Implicit", {"Smallest step = 1"}),
                       lines,
                       {"Stress update = quasi-static", formulation}));
              run.run();
            }
          catch (const std::exception &error)
            {
              message = message_of(error);
            }
          check(formulation + ", " + load[0] + ": Newton's method",
                message == "converged");
          if (message != "converged")
            print() << message << std::endl;
        }
  }



  /// A pressure in 3D that bends a beam: one step of Newton's method is that
  /// with the exact tangent.
  void
  check_tangent_3d()
  {
    std::string message = "converged";
    try
      {
        Simulated<3> run(
          loaded(block_3d("box(0, 0.3, 0.25, 1, 0.7, 0.6)", 4)
                   .with("Material solid", {"Model = neo-hookean"})
                   .with("Walls", {"Left = fixed"})
                   .with("Time", {"End = 1", "Step = 1"})
                   .with("Newton",
                         {"Tolerance = 1e-11",
                          "Largest linear tolerance = 1e-5",
                          "Maximum iterations = 8"})
                   .with("Implicit", {"Smallest step = 1"}),
                 {"Kind = pressure",
                  "Pressure = 0.3 * t * (1 + 0.5 * y)",
                  "Where = z > 0.599"},
                 {"Stress update = quasi-static", total}));
        run.run();
        // The force turns with the beam.
        check("beam: force", resultant(run)[0] < -0.005);
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    check("beam: Newton's method", message == "converged");
    if (message != "converged")
      print() << message << std::endl;
  }



  /// Springs and pressure store and give energy.
  void
  check_energy()
  {
    for (const std::string scheme :
         {"USL", "newmark", "generalized-alpha", "implicit-midpoint"})
      {
        Simulated<2> run(
          loaded(block_2d("ball(0.5, 0.5, 0.31)", 8)
                   .with("Material solid", {"Model = neo-hookean"})
                   .with("Body body", {"Velocity = 2; -y"})
                   .with("Time", {"End = 0.2", "Step = 0.002"}),
                 {"Kind = spring", "Stiffness = 100"},
                 {total, "Stress update = " + scheme}));
        const Statistics<2> begin = run->statistics();
        const Statistics<2> end   = run.run()->statistics();
        const double        work  = run->state().energy.work(MPI_COMM_WORLD);
        check(scheme + ": springs work", work < -0.1 * begin.kinetic);
        check(scheme + ": energy",
              std::abs(end.kinetic + end.strain - begin.kinetic - work) /
                begin.kinetic,
              scheme == "implicit-midpoint" ? 1e-6 : 0.03);
        if (std::getenv("SHOW"))
          print() << scheme << " " << begin.kinetic << " " << end.kinetic << " "
                  << end.strain << " " << work << std::endl;
      }
    // Stiff springs set the step.
    Simulated<2> stiff(loaded(block_2d("ball(0.5, 0.5, 0.31)", 8)
                                .with("Body body", {"Velocity = 1; -y"})
                                .with("Time", {"End = 0.02"}),
                              {"Kind = spring", "Stiffness = 1e6"}));
    stiff.run();
    check("stiff springs: steps", stiff->state().n_steps > 50);
    check("stiff springs: speed", stiff->statistics().largest_speed < 5.);
  }



  /// The pressure of a wind against a surface: drag (w - v), with w in x.
  class Wind : public SurfaceLoadKindOf<Wind>
  {
  public:
    static constexpr const char *name = "wind";

    void
    declare(ParameterHandler &prm) override
    {
      prm.add_parameter("Drag", drag, "Pressure per speed. Unit: Pa s / m.");
      prm.add_parameter("Speed", speed, "Speed of the wind. Unit: m / s.");
    }

    template <int dim>
    struct Load : SurfaceLoad<dim>
    {
      Load(const Wind &kind, const LoadedBody &)
        : kind(kind)
      {}

      Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double) const override
      {
        Tensor<1, dim> wind;
        wind[0] = kind.speed;
        return kind.drag * (wind - state.velocity);
      }

      double
      damping() const override
      {
        return kind.drag;
      }

      const Wind &kind;
    };

  private:
    double drag = 0., speed = 0.;
  };



  /// A box of mass m in a wind on an area A, all of which is on one side: v = w
  /// (1 - exp(-A drag t / m)).
  void
  check_own_kind()
  {
    add_surface_load_kind<Wind>();
    Simulated<2> box(
      loaded(block_2d("box(0.13, 0.21, 0.77, 0.83)", 8)
               .with("Time", {"End = 0.1", "Step = 0.001"}),
             {"Kind = wind", "Drag = 0.1", "Speed = 3", "Where = x < 0.131"}));
    const double m = box.simulation.statistics().mass;
    const double v = box.run()->statistics().momentum[0] / m;
    check("a kind of one's own: momentum",
          v / (3. * (1. - std::exp(-0.62 * 0.1 * 0.1 / m))) - 1.,
          0.01);
  }



  void
  check_parameters()
  {
    const Text                     block = block_2d("box(0.2, 0.2, 0.7, 0.7)");
    const std::vector<std::string> pull  = {"Traction = 1; 0"};
    check_refused(
      "unknown body",
      loaded(block, pull).with("Surface load load", {"Body = brick"}),
      "'Surface load load/Body' is <brick>; it has to be one of "
      "the bodies");
    check_refused("no fitted points",
                  loaded(block, pull).with("Body body", {"Placement = Gauss"}),
                  "here 'Placement' is Gauss");
    check_refused("points of a file",
                  loaded(block, pull)
                    .with("Body body",
                          {"Points file = points.csv", "Shape = "}),
                  "here there is a 'Points file'");
    check_refused(
      "nothing selected",
      loaded(block, pull).with("Surface load load", {"Where = x > 0.8"}),
      "'Surface load load/Where' is <x > 0.8>: no point of the "
      "surface of 'Body body' is in it");
    check_refused("no surface",
                  loaded(block_2d("box(-1, -1, 2, 2)")
                           .with("Body body", {"Clip at the grid = true"}),
                         pull),
                  "but the body has no surface in the grid");
    check_refused("no traction",
                  loaded(block, {}),
                  "has 'Kind' = traction and needs the parameter 'Traction'");
    check_refused("no stiffness",
                  loaded(block, {"Kind = spring"}),
                  "needs the parameter 'Stiffness'");
    check_refused("parameter of another kind",
                  loaded(block, {"Kind = pressure", "Pressure = 1"})
                    .with("Surface load load", {"Stiffness = 1"}),
                  "belongs to 'Kind' = spring and displacement, not pressure");
    check_refused(
      "section without a name",
      loaded(block, pull).with("Surface load other", {"Body = body"}),
      "'Simulation/Surface loads' does not name <other>");
    check_refused("wrong formula",
                  loaded(block, {"Traction = 1; W"}),
                  "'Surface load load/Traction'");
  }
} // namespace



void
test_main()
{
  check_resultants();
  check_momentum();
  check_states();
  check_dashpot("USL", total);
  check_dashpot("USL", updated);
  check_dashpot("newmark", total);
  check_equilibrium("spring", 5., {"Kind = spring", "Stiffness = 5"});
  check_equilibrium("penalty",
                    10. * 100. / 0.125,
                    {"Kind = displacement", "Displacement = 0; 0"});
  check_tangents();
  check_tangent_3d();
  check_energy();
  check_own_kind();
  check_parameters();
}
