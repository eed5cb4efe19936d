// SPDX-License-Identifier: Apache-2.0 WITH LLVM-exception OR LGPL-2.1-or-later

// @sect3{Include files}

// From deal.II: a Krylov solver and tables.
#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/table_handler.h>
#include <deal.II/lac/solver_gmres.h>

// From Greville: a material, the points of a body with their transfer to the
// grid, the levels with mass and stiffness, the multigrid cycle, statistics,
// and files for ParaView.
#include <greville/base/errors.h>
#include <greville/materials/neo_hookean.h>
#include <greville/points/point_transport.h>
#include <greville/run/output.h>
#include <greville/steps/statistics.h>
#include <greville/stiffness/tangent_system.h>

#include <filesystem>
#include <iostream>

namespace StepGreville
{
  using namespace dealii;
  using namespace greville;

  // @sect3{The problem}

  // All numbers are in SI units; in 2D masses and energies are per metre of
  // thickness. The box is the unit square. A disk of rubber starts at rest, and
  // the floor is an elastic mat with the surface $y = 0.125$: a point at the
  // depth $d$ below it has the upward acceleration $\kappa d$.
  constexpr int    dim          = 2;
  constexpr double radius       = 0.2;
  constexpr double height       = 0.625;
  constexpr double floor_height = 0.125;
  constexpr double floor_kappa  = 1e6;
  constexpr double gravity      = 10.;
  constexpr double end_time     = 0.5;
  constexpr double output_every = 0.05;
  constexpr char   shape[]      = "ball(0.5, 0.625, 0.2)";
  constexpr char   properties[] = "set Density        = 1000\n"
                                  "set Young modulus  = 5e5\n"
                                  "set Poisson ratio  = 0.3\n";

  double
  floor_depth(const Point<dim> &x)
  {
    return std::max(0., floor_height - x[dim - 1]);
  }

  // @sect3{The class}

  // An <code>OrderHierarchy</code> has a spline space for each order, and a
  // <code>TangentSystem</code> sums mass, forces and stiffness of points for
  // all of them. A <code>PointTransfer</code> maps between the points and the
  // space of the highest order.
  class FallingDisk
  {
    DistributedTriangulation<dim>       mesh;
    TangentParameters                   parameters;
    OrderHierarchy<dim>                 orders;
    std::unique_ptr<TangentSystem<dim>> system;
    PointTransfer<dim>                  transfer;
    PointTransport<dim>                 transport;

    NeoHookean                               rubber;
    BodyParameters                           body_parameters;
    std::vector<Body<dim>>                   bodies; // one, the disk
    std::vector<TrialBody<dim>>              trial_bodies;
    std::vector<const MaterialPoints<dim> *> points;

    VectorField<dim> zero, velocity, force, load;
    VectorType       lumped_mass;
    double           crossing_time; // of a pressure wave through a cell
    unsigned int     n_solves = 0, n_iterations = 0;

  public:
    // @sect4{The constructor}

    // The mesh is a forest of p4est that <code>create_box_mesh()</code> refines
    // to equal cells. The spline spaces have the orders $p, p - 1, \ldots, 1$.
    // No function is constrained, and B-splines are extended in cells that
    // points fill by less than a half.
    FallingDisk(const unsigned int degree, const unsigned int n_cells)
      : mesh(MPI_COMM_WORLD, Triangulation<dim>::none, mesh_settings<dim>)
    {
      const Point<dim> lower, upper(1., 1.);
      create_box_mesh<dim>(mesh, lower, upper, {{n_cells, n_cells}});
      orders.reinit(mesh, degree, Coarsening::one_by_one);
      const TangentSystem<dim>::ConstrainedFunctions nothing;
      system = std::make_unique<TangentSystem<dim>>(
        orders, nothing, parameters, 0.5, false);

      const SplineSpace<dim> &space = system->space();
      transfer.reinit(space);
      transport.reinit(space);
      space.initialize_vector(lumped_mass);
      zero.fill(lumped_mass);
      velocity = force = load = zero;

      // A material declares its parameters in a <code>ParameterHandler</code>.
      // Here a string sets them; a file may do so as well.
      ParameterHandler prm;
      rubber.declare(prm);
      prm.parse_input_from_string(properties);
      rubber.reinit("Material rubber");
      const Moduli moduli       = rubber.moduli();
      const double wave_modulus = moduli.bulk + 4. / 3. * moduli.shear;
      crossing_time = std::sqrt(rubber.density / wave_modulus) / n_cells;

      // The points are the points of a lattice that lie in the disk.
      body_parameters.shape                = shape;
      body_parameters.points_per_direction = {4};
      bodies.resize(1);
      bodies[0].name       = "disk";
      bodies[0].parameters = &body_parameters;
      bodies[0].material   = &rubber;
      const PointLayout<dim> layout(rubber.state_names());
      make_points(bodies[0], space, Tensor<1, dim>(), layout);
      points       = {&bodies[0].points};
      trial_bodies = {{&bodies[0].points, &rubber, "disk"}};
    }

    // @sect4{find_velocity}

    // Compute the velocity of the grid from the momentum of the points, with
    // row sums in place of the mass matrix. It is zero for functions without
    // points.
    void
    divide_by_mass(VectorField<dim> &field, const VectorType &mass)
    {
      for (VectorType &component : field)
        for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
          if (mass.local_element(i) > 0.)
            component.local_element(i) /= mass.local_element(i);
    }

    void
    find_velocity()
    {
      transfer.points_to_grid(points, &lumped_mass, &velocity, nullptr);
      divide_by_mass(velocity, lumped_mass);
    }

    // @sect4{sum_forces}

    // Sum up the force of the stresses for a displacement $u$ of the grid,
    // minus the load of gravity and floor, and the derivative of both on all
    // levels. The work of the stress equals the change of the strain energy;
    // the matrix is therefore not symmetric. The load acts in the middle of the
    // step, after the share $1/2$ of the displacement; it is given per area of
    // a surface, or per mass of a body. A point may fail on one process only:
    // all processes throw, so that they end together.
    void
    sum_forces(const VectorField<dim> &u,
               const double            dt,
               const bool              with_stiffness)
    {
      const auto        stress = StepStress::energy_consistent;
      const std::string problem =
        system->evaluate(trial_bodies, u, dt, stress, with_stiffness, force);
      throw_on_all(problem, MPI_COMM_WORLD);
      const auto b = [](const ConstPointRef<dim>,
                        const SurfaceState<dim> &point) {
        return Point<dim>(0., floor_kappa * floor_depth(point.x) - gravity);
      };
      system->surfaces().add({{points[0], b}}, u, {0.5}, with_stiffness, load);
      for (unsigned int d = 0; d < dim; ++d)
        force[d] -= load[d];
    }

    // @sect4{solve}

    // Assemble the multigrid and solve. Each level adds $c$ times its mass to
    // its stiffness; it is a <code>LevelOperator</code>, the interface that the
    // cycle, the smoothers and the transfers need. The cycle is a
    // preconditioner for any Krylov solver of deal.II. Its parts are chosen by
    // name: a Chebyshev polynomial of IC(0) as smoother, $M_k^{-1} P$ with the
    // mixed mass matrix $P$ of two orders as prolongation, its transpose as
    // restriction. A cycle on coarser and coarser lattices is applied to the
    // system of order 1 once per cycle, because the tolerance is 1. (The
    // coarsening "lattice" needs no levels but the finest one.) The vectors of
    // levels have an entry for each function and component, and the vectors of
    // the system for each unknown.
    unsigned int
    solve(VectorType &x, const VectorType &b, const double mass_factor)
    {
      const auto levels = system->make_levels(mass_factor);

      PMultigridParameters cycle;
      cycle.smoother              = "chebyshev-ic0";
      cycle.prolongation          = "ic0-l2";
      cycle.restriction           = "transpose";
      cycle.coarse_preconditioner = "lattice";
      SmootherParameters smoother;
      smoother.chebyshev_degree = 3;
      smoother.chebyshev_range  = 8.;
      const PMultigrid<dim> multigrid(levels, cycle, smoother, 1.);

      const auto &unknowns = system->finest().extended().unknowns();
      VectorType  all_x, all_b;
      initialize_vector<dim>(all_x, *levels.back());
      initialize_vector<dim>(all_b, *levels.back());
      unknowns.write(all_b, b, dim);

      SolverControl            control(100, 1e-8 * b.l2_norm());
      SolverFGMRES<VectorType> solver(control);
      solver.solve(*levels.back(), all_x, all_b, multigrid);
      unknowns.read(x, all_x, dim);
      ++n_solves;
      n_iterations += control.last_step();
      return control.last_step();
    }

    // @sect4{count_iterations}

    // Measure the quality of the preconditioner. The right-hand side is as
    // rough as the grid allows, with an irregular number for each function. The
    // systems belong to steps in which a pressure wave crosses 1, 10 and 100
    // cells. <code>restrict()</code> applies $E^T$ to a field, such as a sum
    // over points, and returns the right-hand side of the unknowns.
    void
    count_iterations(TableHandler &table)
    {
      const SplineSpace<dim> &space = system->space();
      VectorField<dim>        rough = zero;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int i = 0; i < rough[c].locally_owned_size(); ++i)
          rough[c].local_element(i) =
            std::sin(1e3 * std::sin(space.owned_functions()[i] * dim + c));
      system->set_points(trial_bodies);
      VectorType b, x;
      system->initialize(b);
      system->initialize(x);
      system->restrict(b, rough, nullptr);

      const unsigned int n_inactive = system->finest().inactive().size();
      table.add_value("cells", space.cells_per_direction()[0]);
      table.add_value("p", space.degree());
      table.add_value("unknowns",
                      dim * (space.n_dofs() -
                             Utilities::MPI::sum(n_inactive, MPI_COMM_WORLD)));
      for (const unsigned int n : {1, 10, 100})
        {
          const double dt = n * crossing_time;
          sum_forces(zero, dt, true);
          table.add_value("CFL " + std::to_string(n),
                          solve(x, b, 2. / (dt * dt)));
        }
    }

    // @sect4{update_points}

    // Add the change of the grid velocity to the velocities of the points
    // (FLIP). Points move with the velocity of the grid, and its gradient
    // deforms them, which changes their stress. Points that have left their
    // cell are then moved to the new cell and its process.
    void
    update_points(const VectorField<dim> *acceleration,
                  const double            velocity_step,
                  const double            step)
    {
      PointUpdate<dim> update;
      update.acceleration  = acceleration;
      update.velocity_step = velocity_step;
      update.velocity      = &velocity;
      update.deformation   = step > 0. ? &velocity : nullptr;
      update.move          = step > 0.;
      update.step          = step;
      update.material      = &rubber;
      const PointReport report =
        transfer.grid_to_points(bodies[0].points, update);
      throw_on_all(report.bad_reason, MPI_COMM_WORLD);
      const auto result = transport.move(bodies[0].points, report.left_cells);
      throw_on_all(result.outside < 0 ? "" : "The disk has left the box.",
                   MPI_COMM_WORLD);
    }

    // @sect4{explicit_step}

    // Take a step of the velocity Verlet method with lumped mass: half a kick,
    // a move with the velocity in the middle of the step, and the other half of
    // the kick with the forces at its end. The sign of the kick is negative
    // because <code>force</code> is stress minus load. This scheme needs no
    // solver.
    void
    explicit_step(const double dt)
    {
      const auto kick_half = [&]() {
        find_velocity();
        sum_forces(zero, dt, false);
        divide_by_mass(force, lumped_mass);
        update_points(&force, -dt / 2., 0.);
      };
      kick_half();
      find_velocity();
      update_points(nullptr, 0., dt);
      kick_half();
    }

    // @sect4{implicit_step}

    // Take a step of the midpoint rule for the displacement $u$ of the grid,
    // @f[
    //   M \left( \frac{2 u}{\Delta t^2} - \frac{2 v_n}{\Delta t} \right)
    //   + f(u) - b(u) = 0, \qquad
    //   v_{n+1} = \frac{2 u}{\Delta t} - v_n.
    // @f]
    // First a solve with the mass gives the velocity $v_n$ of the grid from the
    // momentum of the points; Newton's method then starts with a free flight,
    // and reduces the residual to a small part of the load (a problem without
    // load needs another scale, such as the stress forces).
    // <code>extend()</code> applies $E$ to the solution of a system and returns
    // all coefficients of a field. The acceleration of the grid is
    // $(v_{n+1} - v_n) / \Delta t$, and its mean velocity $u / \Delta t$.
    void
    implicit_step(const double dt)
    {
      system->set_points(trial_bodies);
      VectorField<dim> momentum = zero, v = zero, u = zero, du = zero, a = zero;
      transfer.points_to_grid(points, &lumped_mass, &momentum, nullptr);
      system->solve_mass(v, momentum);
      for (unsigned int d = 0; d < dim; ++d)
        u[d].equ(dt, v[d]);

      VectorType residual, weight, x;
      for (VectorType *vector : {&residual, &weight, &x})
        system->initialize(*vector);
      for (unsigned int iteration = 0;; ++iteration)
        {
          sum_forces(u, dt, true);
          for (unsigned int d = 0; d < dim; ++d)
            {
              a[d].equ(2. / (dt * dt), u[d]);
              a[d].add(-2. / dt, v[d]);
            }
          system->restrict(residual, force, &a);
          system->restrict(weight, load, nullptr);
          if (residual.l2_norm() <= 1e-8 * weight.l2_norm())
            break;
          AssertThrow(iteration < 20,
                      ExcMessage("Newton's method did not converge."));
          solve(x, residual, 2. / (dt * dt));
          system->extend(du, x);
          for (unsigned int d = 0; d < dim; ++d)
            u[d] -= du[d];
        }

      for (unsigned int d = 0; d < dim; ++d)
        velocity[d].equ(1. / dt, u[d]);
      update_points(&a, dt, dt);
    }

    // @sect4{write}

    // Write the points and the velocity of the grid to files for ParaView, and
    // the energies to a row of the table. The centre of the disk is at
    // $0.625 - g t^2 / 2$ until it touches the floor. The sum of the energies
    // should be constant.
    void
    write(const double time, FieldOutput<dim> &files, TableHandler &table)
    {
      find_velocity();
      GridFields<dim> fields;
      fields.velocity = velocity;
      fields.mass     = lumped_mass;
      files.write_points(time, bodies, MPI_COMM_WORLD);
      files.write_grid(time, system->space(), fields);

      const Point<dim>          g(0., -gravity);
      std::vector<RowSums<dim>> sums_of_bodies = {
        RowSums<dim>(bodies[0].material)};
      sums_of_bodies[0].add(bodies[0].points, &transfer);
      Statistics<dim> sums;
      add_sums(sums, bodies, sums_of_bodies, g, MPI_COMM_WORLD);
      double elastic = 0.;
      bodies[0].points.for_each([&](const auto point) {
        const double d = floor_depth(point.position());
        elastic += 0.5 * point.mass() * floor_kappa * d * d;
      });
      elastic = sums.strain + Utilities::MPI::sum(elastic, MPI_COMM_WORLD);
      const double lowest = floor_height + radius;
      const double potential =
        sums.gravitational - sums.mass * gravity * lowest;
      const double free_fall = height - 0.5 * gravity * time * time;
      table.add_value("time", time);
      table.add_value("height", sums.center[dim - 1]);
      table.add_value("free fall",
                      free_fall > lowest ? std::to_string(free_fall) : "-");
      table.add_value("kinetic", sums.kinetic);
      table.add_value("potential", potential);
      table.add_value("elastic", elastic);
      table.add_value("sum", sums.kinetic + potential + elastic);
    }

    // @sect4{run}

    // Run a scheme to the end. An explicit step must be shorter than the time
    // in which a wave crosses a cell. The length of an implicit step follows
    // from the process to resolve: two milliseconds resolve the impact.
    void
    run(const std::string &scheme)
    {
      const bool         is_implicit = scheme == "implicit";
      const double       longest     = is_implicit ? 2e-3 : 0.3 * crossing_time;
      const unsigned int n_steps     = std::ceil(output_every / longest - 1e-9);
      const unsigned int n_outputs   = std::lround(end_time / output_every);

      run_on_first(MPI_COMM_WORLD,
                   [&]() { std::filesystem::create_directories(scheme); });
      const OutputParameters output_parameters;
      FieldOutput<dim>       files(scheme, output_parameters);
      TableHandler           table;
      write(0., files, table);
      for (unsigned int output = 1; output <= n_outputs; ++output)
        {
          for (unsigned int step = 0; step < n_steps; ++step)
            is_implicit ? implicit_step(output_every / n_steps)
                        : explicit_step(output_every / n_steps);
          write(output * output_every, files, table);
        }

      if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
        return;
      std::cout << "\n"
                << n_outputs * n_steps << ' ' << scheme << " steps of "
                << bodies[0].n_points << " points";
      if (is_implicit)
        std::cout << ", " << n_solves << " linear systems, " << n_iterations
                  << " iterations";
      std::cout << std::endl;
      for (const std::string column :
           {"time", "kinetic", "potential", "elastic", "sum"})
        table.set_precision(column, 2);
      table.set_precision("height", 6);
      table.write_text(std::cout, TableHandler::org_mode_table);
    }
  };
} // namespace StepGreville

// @sect3{The main function}

// Print the table of iterations, then run both kinds of steps with quadratic
// splines.
int
main(int argc, char **argv)
{
  using namespace StepGreville;
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool is_first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try
    {
      TableHandler table;
      for (const unsigned int n_cells : {16, 32, 64})
        for (unsigned int p = 1; p <= 4; ++p)
          FallingDisk(p, n_cells).count_iterations(table);
      if (is_first)
        {
          std::cout << "Iterations with p-multigrid:" << std::endl;
          table.write_text(std::cout, TableHandler::org_mode_table);
        }
      for (const std::string scheme : {"explicit", "implicit"})
        FallingDisk(2, 16).run(scheme);
    }
  catch (const std::exception &exception)
    {
      if (is_first)
        std::cerr << greville::message_of(exception) << std::endl;
      return 1;
    }
}
