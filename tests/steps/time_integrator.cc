// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a time integrator that the program defines by name without changing
// the library: symplectic Euler that proposes too long a step and rejects it.
// With the accepted steps it agrees bitwise with USL.
#include <greville/steps/implicit_steps.h>
#include <greville/steps/move_points.h>

#include "simulation.h"

namespace
{
  template <int dim>
  class Euler : public TimeIntegrator<dim>
  {
  public:
    explicit Euler(const IntegratorParts<dim> &parts)
      : discretization(parts.discretization)
    {
      for (auto *field : {&velocity, &acceleration})
        discretization.initialize(*field);
    }

    double
    propose_step(State<dim> &state) override
    {
      const double dt = (0.1 - state.time) / (20. - state.n_steps);
      return 4. * dt / (1 << state.n_rejections);
    }

    void
    try_step(State<dim> &, const double dt) override
    {
      if (dt > 0.006)
        throw StepRejected("the step is too long");
    }

    void
    advance(State<dim> &state, const double dt) override
    {
      discretization.sum(state, true);
      GridField<dim> &field = discretization.field();
      discretization.solve({&velocity, &acceleration},
                           {&field.momentum, &field.force});
      for (unsigned int d = 0; d < dim; ++d)
        velocity[d].add(dt, acceleration[d]);

      PointUpdate<dim> update;
      update.acceleration      = &acceleration;
      update.velocity          = &velocity;
      update.deformation       = &velocity;
      update.move              = true;
      update.step              = dt;
      update.velocity_step     = dt;
      const PointMotion motion = update_points(state.bodies,
                                               discretization.transfer(),
                                               update,
                                               state.time + dt);
      discretization.transport_points(state, motion);
      std::swap(state.field.velocity, velocity);
      state.time += dt;
      state.velocity_time = state.time;
      state.step          = dt;
      ++state.n_steps;
    }

  private:
    Discretization<dim> &discretization;
    VectorField<dim>     velocity, acceleration;
  };



  std::vector<double>
  run(const std::string &name)
  {
    Simulated<2> simulated(
      block_2d("box(0.2, 0.2, 0.6, 0.6)", 10)
        .with("Body body", {"Velocity = 0.2 * x; -0.5 * y"})
        .with("Scheme", {"Stress update = " + name})
        .with("Time",
              {"End = 0.1", "Step = 0.005", "Velocities at = full steps"}));
    simulated.run();
    check("steps to the end", simulated->state().n_steps == 20);
    const Statistics<2> row = simulated->statistics();
    return {row.kinetic, row.strain, row.center[0], row.center[1]};
  }
} // namespace



void
test_main()
{
  add_time_integrator<2>("euler", [](const IntegratorParts<2> &parts) {
    return std::make_unique<Euler<2>>(parts);
  });
  check("the same bits", run("euler") == run("USL"));

  bool is_refused = false;
  try
    {
      run("leapfrog");
    }
  catch (const std::exception &error)
    {
      is_refused = message_of(error).find("USL|MUSL|") != std::string::npos &&
                   message_of(error).find("|euler") != std::string::npos;
    }
  check("an unknown name is answered with the list", is_refused);

  // One without a critical step says so: then points may cross many cells.
  add_time_integrator<2>("own-newmark", [](const IntegratorParts<2> &parts) {
    return std::make_unique<ImplicitSteps<2>>("newmark", parts);
  });
  std::vector<Statistics<2>> rows;
  for (const std::string name : {"newmark", "own-newmark"})
    {
      Simulated<2> moved(
        block_2d("ball(0.5, 0.5, 0.3)", 10)
          .with("Grid", {"Upper corner = 3, 1", "Cells = 30, 10"})
          .with("Body body", {"Velocity = 1 + 0.1 * y; 0"})
          .with("Scheme", {"Stress update = " + name})
          .with("Time", {"End = 1", "Step = 0.25"}));
      rows.push_back(moved.run()->statistics());
      check(name + ", implicit", moved->is_implicit());
      // Cut cells are those of the implicit threshold.
      unsigned int n_cut = 0;
      for (const unsigned char c :
           moved->grid().cell_classes(moved->state(), moved->is_implicit()))
        n_cut += c == 1;
      check(name + ", cut cells",
            Utilities::MPI::sum(n_cut, MPI_COMM_WORLD) > 0);
    }
  check("own implicit steps: moved", rows[1].center[0] > 1.4);
  check("own implicit steps: the same", rows[0].values() == rows[1].values());

  // What all processes throw fails a step. What one throws is not known to the
  // others, and stays what it is.
  bool is_failed = false, is_local = false;
  try
    {
      fail_with([&]() { throw_on_all("no solution", MPI_COMM_WORLD); });
    }
  catch (const StepFailed &)
    {
      is_failed = true;
    }
  try
    {
      fail_with([]() { throw std::bad_alloc(); });
    }
  catch (const std::bad_alloc &)
    {
      is_local = true;
    }
  check("an error of all", is_failed);
  check("an error of one", is_local);
}
