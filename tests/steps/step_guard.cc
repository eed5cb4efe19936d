// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks that each guard of a step stops a run that violates it. The message
// names the event, its place, the usual cause, and the files with the last good
// state, from which the run can resume.
#include <greville/materials/elastic_constants.h>
#include <greville/run/run.h>
#include <greville/steps/explicit_schemes.h>

#include "simulation.h"
#include <limits>

namespace
{
  const MPI_Comm comm = MPI_COMM_WORLD;

  // The fault, in the step after so many.
  std::string            fault;
  constexpr unsigned int n_good_steps = 60;
  bool                   is_wrong_now = false;



  bool
  is_last_process()
  {
    return Utilities::MPI::this_mpi_process(comm) + 1 ==
           Utilities::MPI::n_mpi_processes(comm);
  }



  // sigma = (b - 1) 100 Pa / J, until something goes wrong on one process.
  class FaultyLaw : public MaterialLaw<FaultyLaw>
  {
  public:
    static constexpr const char *name = "faulty";

    void
    initialize(MaterialPoint &point,
               const SymmetricTensor<2, 3> &) const override
    {
      update_point(point);
    }

    void
    update_point(MaterialPoint &point) const
    {
      const SymmetricTensor<2, 3> e = left_cauchy_green_less_one(point.F);
      point.stress                  = 100. / point.J * e;
      point.wave_modulus            = 100. * (2. + e.norm()) / point.J;
      if (is_wrong_now && point.J != 1. && is_last_process())
        {
          AssertThrow(fault != "law that throws", ExcMessage("no root found"));
          if (fault == "law")
            point.stress[0][0] = std::nan("");
          if (fault == "stiffer law")
            point.wave_modulus *= 1e4;
        }
    }

    double
    strain_energy(const MaterialPoint &) const override
    {
      return fault == "energy" ? std::nan("") : 0.;
    }

    Moduli
    moduli() const override
    {
      Moduli result;
      result.shear = 100.;
      return result;
    }
  };



  // USL, until something changes the points of a process.
  class FaultySteps : public USL<2>
  {
  public:
    explicit FaultySteps(const IntegratorParts<2> &parts)
      : USL<2>(parts)
    {}

    void
    advance(State<2> &state, const double dt) override
    {
      is_wrong_now = fault != "" && state.n_steps == n_good_steps;
      if (is_wrong_now && state.bodies[0].points.n_points() > 0)
        change_points(state.bodies[0].points);
      if (is_wrong_now)
        state.points_have_changed();
      USL<2>::advance(state, dt);
      if (is_wrong_now && fault == "infinite")
        state.field.acceleration[0] = std::numeric_limits<double>::infinity();
      if (is_wrong_now && (fault == "momentum" || fault == "infinite"))
        kick_again(state, dt);
      is_wrong_now = false;
    }

  private:
    void
    change_points(MaterialPoints<2> &points) const
    {
      bool                is_first = true;
      unsigned int        place    = 0;
      std::vector<double> lost;
      points.for_each([&](const unsigned int cell, PointRef<2> p) {
        if (!is_first)
          return;
        is_first = false;
        place    = cell;
        if (fault == "count")
          p.position(0) += 1.;
        if (fault == "mass")
          p.mass() *= 1.5;
        if (fault == "volume")
          {
            // The volume stays.
            p.J() *= 1e6;
            p.volume0() *= 1e-6;
          }
        if (fault == "NaN")
          p.velocity(1) = std::nan("");
      });
      if (fault == "count")
        points.remove_leaving(place, lost);
    }

    void
    kick_again(State<2> &state, const double dt)
    {
      PointUpdate<2> update;
      update.acceleration  = &state.field.acceleration;
      update.velocity      = &state.field.velocity;
      update.deformation   = update.velocity;
      update.velocity_step = dt;
      update.move          = true;
      guard.set(update_points(
        state.bodies, discretization.transfer(), update, state.time));
    }
  };



  Text
  falling_block()
  {
    return Text()
      .add("Simulation", {"Bodies = body", "Materials = solid"})
      .add("Scheme", {"Mass = lumped", "Stress update = faulty"})
      .add("Grid", {"Cells = 10, 10"})
      .add("Body body",
           {"Material = solid",
            "Shape = box(0.25, 0.25, 0.65, 0.65)",
            "Velocity = x; 0"})
      .add("Material solid", {"Model = faulty", "Density = 1"})
      .add("Loads", {"Gravity = 0; -1"})
      .add("Time", {"End = 0.2", "Step = 0.002"});
  }



  std::string
  run(const Text &text, const std::string &folder, const bool resumes = false)
  {
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      std::ofstream("run.prm")
        << text
             .with("Output",
                   {"Directory = " + folder, "Earlier results = remove"})
             .content;
    MPI_Barrier(comm);
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    std::string           message;
    RunOptions            options;
    options.resumes = resumes;
    try
      {
        run_simulations("run.prm", comm, options);
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    is_wrong_now = false;
    MPI_Barrier(comm);
    return message;
  }



  /// The message of a run has all the words, and the state of the @p step is in
  /// the files that it names.
  void
  check_stopped(const std::string              &what,
                const Text                     &text,
                const unsigned int              step,
                const std::vector<std::string> &words)
  {
    fault                     = what;
    const std::string message = run(text, "guard");
    for (const std::string &word : words)
      check(what + ", <" + word + ">: " + message,
            message.find(word) != std::string::npos);
    check(what + ", step: " + message,
          message.find("The state of step " + std::to_string(step) + ",") !=
            std::string::npos);
    const auto        begin = message.find("<guard/files/points_");
    const std::string file =
      begin == std::string::npos
        ? "no file"
        : message.substr(begin + 1, message.find('>', begin) - begin - 1);
    check(what + ", " + file,
          file.rfind("guard/files/points_", 0) == 0 &&
            std::filesystem::exists(file));
    const std::string checkpoint =
      "guard/checkpoint_" + Utilities::int_to_string(step, 10) + ".h5";
    check(what + ", " + checkpoint,
          (message.find(checkpoint) != std::string::npos) == (step > 0) &&
            std::filesystem::exists(checkpoint) == (step > 0));
  }
} // namespace



void
test_main()
{
  add_material<FaultyLaw>();
  add_time_integrator<2>("faulty", [](const IntegratorParts<2> &parts) {
    return std::make_unique<FaultySteps>(parts);
  });

  // A step in the middle of a run.
  const Text         text = falling_block();
  const unsigned int last = 50;
  check_stopped("count",
                text,
                last,
                {"points have been lost", "error of the program"});
  check_stopped("mass", text, last, {"the mass of the points is"});
  check_stopped("volume",
                text,
                last,
                {"the volume of point ",
                 " of the body 'body' at (",
                 "in the cell (",
                 "has to be between 0.0001 and 10000",
                 "'Time/Safety'"});
  check_stopped("NaN", text, last, {"is infinite or NaN", "from the cell ("});
  check_stopped(
    "law",
    text,
    last,
    {"point ", "is infinite or NaN", "it is at (", "from the cell ("});
  check_stopped("law that throws",
                text,
                last,
                {"the law of the body 'body' has failed: no root found"});
  check_stopped("momentum",
                text,
                last,
                {"the momentum of the points is (", "has to be at most 1e-06"});

  check_stopped("infinite",
                text,
                last,
                {"mass or velocity are infinite or NaN: of point "});
  // Another run goes on from the last good state.
  fault = "";
  check("goes on: " + run(text, "guard", true),
        run(text, "guard", true).empty());

  fault                    = "energy";
  const std::string energy = run(text, "guard");
  check("energy: " + energy,
        energy.find("the dissipation of the bodies is infinite or NaN") !=
          std::string::npos);
  fault = "";

  check_stopped("gravity",
                text.with("Loads", {"Gravity = 0; t > 0.121 ? 1/0 : -1"})
                  .with("Output", {"Statistics every = 1"}),
                last,
                {"'Loads/Gravity' is infinite at t = 0.122"});

  // Wrong steps.
  const Text long_steps = text.with("Scheme", {"Stress update = USL"})
                            .with("Time", {"Too large step = ignore"});
  check_stopped("fast points",
                long_steps.with("Body body", {"Velocity = 40; 0"})
                  .with("Time", {"Step = 0.005"}),
                0,
                {"a point has crossed 2 cells",
                 "of the body 'body' at (",
                 "'Time/Step', which is <0.005>"});
  check_stopped("stiffer law",
                text,
                last,
                {"pressure waves have crossed ",
                 " m / s, are at point ",
                 "'Time/Step', which is <0.002>"});
}
