// SPDX-License-Identifier: LGPL-2.1-or-later

// @sect3{Include files}

// From deal.II come the mesh, the Krylov solvers, tables and output.
#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/table_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/solver_gmres.h>
#include <deal.II/numerics/data_out.h>

// From Greville come the hierarchy of spline spaces, the points with their
// material, the sums over points, the levels with mass and stiffness, the
// multigrid cycle, and files of points.
#include <greville/base/errors.h>
#include <greville/materials/neo_hookean.h>
#include <greville/multigrid/level_fields.h>
#include <greville/multigrid/p_multigrid.h>
#include <greville/particles/body.h>
#include <greville/particles/point_transport.h>
#include <greville/particles/trial_step.h>
#include <greville/simulation/output.h>
#include <greville/stiffness/tangent_level.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>

namespace StepGreville
{
  using namespace dealii;
  using namespace greville;

  // @sect3{The problem}

  // All numbers are in SI units; in 2D masses and energies are those of a slice
  // of one metre. The box is the unit square. A disk of rubber begins at rest,
  // and the floor is an elastic mat whose surface is the line $y = 0.125$: a
  // point at the depth $d$ below it gets the acceleration $\kappa d$ upwards.
  namespace Problem
  {
    constexpr double radius       = 0.2;
    constexpr double height       = 0.625;
    constexpr double floor        = 0.125;
    constexpr double floor_kappa  = 1e6;
    constexpr double gravity      = 10.;
    constexpr double end_time     = 0.5;
    constexpr double output_every = 0.05;
    constexpr double well_filled  = 0.5;
    constexpr char   shape[]      = "ball(0.5, 0.625, 0.2)";
    constexpr char   properties[] = "set Density        = 1000\n"
                                    "set Young modulus  = 5e5\n"
                                    "set Poisson ratio  = 0.3\n";

    inline double
    depth(const double y)
    {
      return std::max(0., floor - y);
    }

    inline double
    acceleration(const double y)
    {
      return floor_kappa * depth(y) - gravity;
    }
  } // namespace Problem

  // @sect3{A level of the hierarchy}

  // On each level there is a spline space of another order, and everything is
  // summed over the same points. A <code>TangentLevel</code> is a
  // <code>LevelOperator</code>: all that the cycle, the smoothers and the
  // transfers ask of an operator.
  template <int dim>
  struct Level
  {
    Level(const SplineSpace<dim> &space)
      : matrix(space)
    {
      transfer.reinit(space);
      sums.reinit(space);
    }

    TangentLevel<dim>  matrix;
    PointTransfer<dim> transfer;
    TrialSums<dim>     sums;
  };

  // @sect3{The class}

  // The constructor makes the mesh, the spaces and the points. From outside one
  // asks for the iterations of the multigrid, or for a run with either scheme.
  // Of the private functions, the first ones sum over the points and solve,
  // then come the two kinds of steps with what they share, and at last what is
  // shown to the user.
  template <int dim>
  class FallingDisk
  {
  public:
    FallingDisk(const unsigned int degree, const unsigned int n_cells);

    std::array<unsigned int, 4>
    count_iterations();

    unsigned int
    n_unknowns() const;

    void
    run(const std::string &scheme);

  private:
    void
    place_points();

    void
    sum_mass();

    void
    sum_forces(const VectorField<dim> &u, const double dt);

    unsigned int
    solve(VectorType        &x,
          const VectorType  &b,
          const double       mass_factor,
          const std::string &coarsening = "one by one");

    const TangentLevel<dim> &
    finest() const
    {
      return levels.back()->matrix;
    }

    double
    wave_speed() const;

    void
    kick(const VectorField<dim> &acceleration, const double dt);

    void
    move(const double dt);

    void
    explicit_step(const double dt);

    void
    implicit_step(const double dt);

    void
    add_energies(const double time, TableHandler &table) const;

    void
    write_files(const double       time,
                const std::string &scheme,
                FieldOutput<dim>  &point_files);

    DistributedTriangulation<dim>            mesh;
    OrderHierarchy<dim>                      spaces;
    std::vector<std::unique_ptr<Level<dim>>> levels;
    CellFilling<dim>                         filling;
    TrialStep<dim>                           trial;
    TrialSums<dim>                           load_sums;
    PointTransport<dim>                      transport;

    NeoHookean             rubber;
    BodyParameters         body_parameters;
    std::vector<Body<dim>> bodies;

    VectorField<dim> velocity, force, load;
    VectorType       lumped_mass;
    const double     cell_size;
    bool             is_first_sum = true;

    std::vector<std::pair<double, std::string>> grid_files;
    unsigned int                                n_solves     = 0;
    unsigned int                                n_iterations = 0;
  };

  // @sect4{FallingDisk::FallingDisk}

  // The mesh is a forest of p4est that <code>create_box_mesh()</code> refines
  // to equal cells. On it live the spaces of the orders
  // $p, p - 1, \ldots, 1$; as in deal.II, level 0 is the coarsest one.
  template <int dim>
  FallingDisk<dim>::FallingDisk(const unsigned int degree,
                                const unsigned int n_cells)
    : mesh(MPI_COMM_WORLD, Triangulation<dim>::none, mesh_settings<dim>)
    , cell_size(1. / n_cells)
  {
    Point<dim>      upper;
    MultiIndex<dim> cells;
    for (unsigned int d = 0; d < dim; ++d)
      {
        upper[d] = 1.;
        cells[d] = n_cells;
      }
    create_box_mesh<dim>(mesh, Point<dim>(), upper, cells);

    spaces.reinit(mesh, degree, "one by one");
    for (unsigned int l = 0; l < spaces.n_levels(); ++l)
      levels.push_back(std::make_unique<Level<dim>>(spaces[l]));

    filling.reinit(spaces.finest());
    trial.reinit(spaces.finest());
    load_sums.reinit(spaces.finest());
    transport.reinit(mesh, spaces.finest());
    spaces.finest().initialize_vector(lumped_mass);
    for (VectorField<dim> *field : {&velocity, &force, &load})
      for (VectorType &component : *field)
        spaces.finest().initialize_vector(component);
    place_points();
  }

  // @sect4{FallingDisk::place_points}

  // A material declares its parameters in a <code>ParameterHandler</code>,
  // which may have read them from a file; here they are a text. The points are
  // those of a lattice whose centres lie in the disk. Besides what all points
  // have they get a field <code>"load"</code>, the acceleration that
  // <code>points_to_grid()</code> adds to the forces.
  template <int dim>
  void
  FallingDisk<dim>::place_points()
  {
    ParameterHandler prm;
    rubber.declare(prm);
    prm.parse_input_from_string(Problem::properties);
    rubber.reinit("Material rubber");

    body_parameters.shape                = Problem::shape;
    body_parameters.points_per_direction = {4};

    bodies.resize(1);
    bodies[0].name       = "disk";
    bodies[0].parameters = &body_parameters;
    bodies[0].material   = &rubber;

    PointLayout<dim> layout(rubber.state_names());
    layout.add("load", dim);
    make_points(bodies[0], spaces.finest(), Tensor<1, dim>(), layout);
  }

  // @sect3{Mass, stiffness and the multigrid}

  // @sect4{FallingDisk::sum_mass}

  // The functions at the edge of the disk see few points, and the mass matrix
  // of all functions is as good as singular. So they become extended
  // B-splines: the polynomials of the cells inside the disk go on into those
  // that the points fill in part. <code>CellFilling</code> tells the two kinds
  // of cells apart, and the levels make the matrix $E$ from it that gives all
  // coefficients from those that are left as unknowns. Then each level gets its
  // mass matrix $M$, weights for the transfer between the levels, and a
  // stiffness of zero.
  template <int dim>
  void
  FallingDisk<dim>::sum_mass()
  {
    const std::vector<const MaterialPoints<dim> *> points = {&bodies[0].points};
    std::vector<double>                            filled_part;
    levels.back()->transfer.filling(points, filled_part);
    const bool changed =
      filling.update(filled_part, Problem::well_filled) || is_first_sum;
    is_first_sum = false;
    for (auto &level : levels)
      {
        level->matrix.begin(filling, changed);
        level->transfer.add_mass_matrix(points, level->matrix.mass());
        level->matrix.finish_mass(false);
        level->transfer.mass_weights(points, level->matrix.weights());
        level->matrix.begin_tangent();
      }
  }

  // @sect4{FallingDisk::sum_forces}

  // The force of the stresses for a displacement $u$ of the grid, the load of
  // gravity and floor, and the derivative of both, on all levels.
  //
  // <code>TrialStep</code> evaluates the law of the material at copies of the
  // points and hands over the points cell by cell, with their stress and its
  // derivative; <code>TrialSums</code> makes forces and cell matrices of it.
  // The stress is the one whose work is the change of the strain energy, which
  // is why the matrix is not symmetric.
  template <int dim>
  void
  FallingDisk<dim>::sum_forces(const VectorField<dim> &u, const double dt)
  {
    const MaterialPoints<dim> &points = bodies[0].points;
    levels.back()->sums.clear();
    load_sums.clear();
    for (auto &level : levels)
      level->matrix.begin_tangent();

    const PointReport report =
      trial.evaluate(points,
                     rubber,
                     u,
                     dt,
                     1.,
                     StepStress::energy_consistent,
                     true,
                     nullptr,
                     [&](const unsigned int cell, const auto &cell_points) {
                       levels.back()->sums.add_force(cell, cell_points);
                       for (auto &level : levels)
                         level->matrix.stiffness().add_cell(
                           cell,
                           level->sums.stiffness(cell, cell_points, false));
                     });
    // A point that breaks does so on one process. All of them throw, so that
    // they end together.
    throw_on_all(report.bad_reason, MPI_COMM_WORLD);

    // The load is that of the middle of the step, $x_n + u / 2$: a copy of the
    // points goes there. Its derivative by $u$ is $-\kappa / 2$ below the
    // surface of the floor. Loads per area of a surface and per mass of a body
    // are summed alike, so that the mass stands in place of the area.
    MaterialPoints<dim> middle = points;
    PointUpdate<dim>    half_way;
    half_way.velocity = &u;
    half_way.move     = true;
    half_way.step     = 0.5;
    levels.back()->transfer.grid_to_points(middle, half_way);
    for (const unsigned int cell : points.cells())
      {
        std::vector<TrialSurfacePoint<dim>> loads;
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> point) {
          loads.emplace_back();
          loads.back().x    = point.position();
          loads.back().area = point.mass();
        });
        auto load_of_point = loads.begin();
        middle.for_each_in_cell(cell, [&](const ConstPointRef<dim> point) {
          const double y               = point.position(dim - 1);
          load_of_point->load[dim - 1] = Problem::acceleration(y);
          if (Problem::depth(y) > 0.)
            load_of_point->by_displacement[dim - 1][dim - 1] =
              -0.5 * Problem::floor_kappa;
          ++load_of_point;
        });
        load_sums.add_force(cell, loads);
        for (auto &level : levels)
          level->matrix.stiffness().add_cell(cell,
                                             level->sums.stiffness(cell,
                                                                   loads));
      }
    levels.back()->sums.take_force(force);
    load_sums.take_force(load);
  }

  // @sect4{FallingDisk::solve}

  // Here the multigrid is put together. Each level adds $c$ times its mass to
  // its stiffness. The cycle is a preconditioner for any Krylov solver of
  // deal.II. Its parts are chosen by name: a Chebyshev polynomial of IC(0) as
  // smoother, $M_k^{-1} P$ with the mixed mass matrix $P$ of two orders as
  // prolongation, its transpose as restriction. The system of order 1 is solved
  // by an algebraic method, once per cycle, for the tolerance is 1.
  template <int dim>
  unsigned int
  FallingDisk<dim>::solve(VectorType        &x,
                          const VectorType  &b,
                          const double       mass_factor,
                          const std::string &coarsening)
  {
    typename PMultigrid<dim>::Levels operators;
    for (auto &level : levels)
      {
        level->matrix.finish_tangent(mass_factor);
        operators.push_back(&level->matrix);
      }
    if (coarsening == "none")
      operators.erase(operators.begin(), operators.end() - 1);

    PMultigridParameters cycle;
    cycle.coarsening            = coarsening;
    cycle.smoother              = "chebyshev-ic0";
    cycle.prolongation          = "ic0-l2";
    cycle.restriction           = "transpose";
    cycle.coarse_preconditioner = "lattice";
    SmootherParameters smoother;
    smoother.chebyshev_degree = 3;
    smoother.chebyshev_range  = 8.;
    const PMultigrid<dim> multigrid(operators, cycle, smoother, 1.);

    SolverControl            control(100, 1e-8 * b.l2_norm());
    SolverFGMRES<VectorType> solver(control);
    x = 0.;
    solver.solve(finest(), x, b, multigrid);
    ++n_solves;
    n_iterations += control.last_step();
    return control.last_step();
  }

  // @sect4{FallingDisk::count_iterations}

  // How good is the preconditioner? The right-hand side is as rough as the grid
  // can have it, a number without pattern for each function. It is solved for
  // with the mass alone, and with mass and stiffness of steps in which a
  // pressure wave runs through 10 and 100 cells; the last once more with the
  // smoother in place of the cycle. The sums are made anew for each system, for
  // <code>solve()</code> adds the mass to them.
  template <int dim>
  std::array<unsigned int, 4>
  FallingDisk<dim>::count_iterations()
  {
    const auto      &positions = spaces.finest().owned_functions();
    VectorField<dim> rough = load, zero = load;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < positions.size(); ++i)
        rough[c].local_element(i) =
          std::sin(1e3 * std::sin(positions[i] * dim + c));

    sum_mass();
    const VectorType            b = condense_field<dim>(finest(), rough);
    VectorType                  x(b);
    std::array<unsigned int, 4> result;
    result[0] = solve(x, b, 1.);
    for (const unsigned int n : {1, 2, 3})
      {
        const double n_waves = n == 1 ? 10. : 100.;
        const double dt      = n_waves * cell_size / wave_speed();
        sum_mass();
        sum_forces(zero, dt);
        result[n] = solve(x, b, 2. / (dt * dt), n == 3 ? "none" : "one by one");
      }
    return result;
  }



  // The speed of pressure waves sets the length of explicit steps.
  template <int dim>
  double
  FallingDisk<dim>::wave_speed() const
  {
    const Moduli moduli = rubber.moduli();
    return std::sqrt((moduli.bulk + 4. / 3. * moduli.shear) / rubber.density);
  }



  // Unknowns are the coefficients of the functions that the levels call active.
  template <int dim>
  unsigned int
  FallingDisk<dim>::n_unknowns() const
  {
    return dim * (spaces.finest().n_dofs() -
                  Utilities::MPI::sum<unsigned int>(finest().inactive().size(),
                                                    MPI_COMM_WORLD));
  }

  // @sect3{Steps}

  // @sect4{FallingDisk::kick and FallingDisk::move}

  // Points take the change of their velocity from the grid, and keep what the
  // grid cannot see of it (FLIP). They move with the grid, and its gradient
  // deforms them, which gives them a new stress. Those that have left their
  // cell then go to the new one, on whichever process it is.
  template <int dim>
  void
  FallingDisk<dim>::kick(const VectorField<dim> &acceleration, const double dt)
  {
    PointUpdate<dim> update;
    update.acceleration  = &acceleration;
    update.velocity_step = dt;
    levels.back()->transfer.grid_to_points(bodies[0].points, update);
  }



  template <int dim>
  void
  FallingDisk<dim>::move(const double dt)
  {
    PointUpdate<dim> update;
    update.velocity    = &velocity;
    update.deformation = &velocity;
    update.move        = true;
    update.step        = dt;
    update.material    = &rubber;
    const PointReport report =
      levels.back()->transfer.grid_to_points(bodies[0].points, update);
    throw_on_all(report.bad_reason, MPI_COMM_WORLD);
    const auto result = transport.move(bodies[0].points, report.left_cells);
    throw_on_all(result.outside < 0 ? "" : "The disk has left the box.",
                 MPI_COMM_WORLD);
  }

  // @sect4{FallingDisk::explicit_step}

  // The velocity Verlet method with lumped mass: half a kick, a move with the
  // velocity of the middle of the step, and the other half of the kick with the
  // forces at its end. This one needs no solver: the mass matrix is replaced by
  // its row sums, and functions without points keep the velocity zero.
  template <int dim>
  void
  FallingDisk<dim>::explicit_step(const double dt)
  {
    const std::vector<const MaterialPoints<dim> *> points = {&bodies[0].points};
    PointTransfer<dim> &transfer = levels.back()->transfer;

    const auto divide_by_mass = [&](VectorField<dim> &field) {
      for (VectorType &component : field)
        for (unsigned int i = 0; i < component.locally_owned_size(); ++i)
          if (lumped_mass.local_element(i) > 0.)
            component.local_element(i) /= lumped_mass.local_element(i);
    };
    const auto kick_half = [&]() {
      const unsigned int field = bodies[0].points.layout().first("load");
      bodies[0].points.for_each([&](const unsigned int,
                                    const PointRef<dim> point) {
        point[field + dim - 1] = Problem::acceleration(point.position(dim - 1));
      });
      transfer.points_to_grid(points, &lumped_mass, &velocity, &force);
      divide_by_mass(force);
      kick(force, dt / 2.);
    };

    kick_half();
    transfer.points_to_grid(points, &lumped_mass, &velocity, nullptr);
    divide_by_mass(velocity);
    move(dt);
    kick_half();
  }

  // @sect4{FallingDisk::implicit_step}

  // The midpoint rule for the displacement $u$ of the grid,
  // @f[
  //   M \left( \frac{2 u}{\Delta t^2} - \frac{2 v_n}{\Delta t} \right)
  //   + f(u) - b(u) = 0, \qquad
  //   v_{n+1} = \frac{2 u}{\Delta t} - v_n.
  // @f]
  // First the mass gives the velocity of the grid from the momentum of the
  // points; then Newton's method begins with a free flight. The multigrid
  // solves both kinds of systems. From forces to the right-hand side of a level
  // leads $E^T$ (<code>condense_field()</code>), from its solution to all
  // coefficients of a field $E$ (<code>distribute_field()</code>).
  template <int dim>
  void
  FallingDisk<dim>::implicit_step(const double dt)
  {
    sum_mass();
    levels.back()->transfer.points_to_grid({&bodies[0].points},
                                           &lumped_mass,
                                           &velocity,
                                           nullptr);
    VectorType v, u, du, residual, inertia;
    for (VectorType *vector : {&v, &u, &du, &residual, &inertia})
      initialize_vector<dim>(*vector, finest());
    solve(v, condense_field<dim>(finest(), velocity), 1.);

    u.equ(dt, v);
    for (unsigned int iteration = 0;; ++iteration)
      {
        sum_forces(distribute_field<dim>(finest(), u), dt);
        const VectorType weight = condense_field<dim>(finest(), load);
        residual                = condense_field<dim>(finest(), force);
        residual -= weight;
        inertia.equ(2. / (dt * dt), u);
        inertia.add(-2. / dt, v);
        finest().multiply_mass(du, inertia);
        residual += du;
        if (residual.l2_norm() <= 1e-8 * weight.l2_norm())
          break;
        AssertThrow(iteration < 20,
                    ExcMessage("Newton's method did not converge."));
        solve(du, residual, 2. / (dt * dt));
        u -= du;
      }

    // The grid's acceleration is $(v_{n+1} - v_n) / \Delta t$, and its mean
    // velocity $u / \Delta t$.
    inertia.equ(2. / (dt * dt), u);
    inertia.add(-2. / dt, v);
    kick(distribute_field<dim>(finest(), inertia), dt);
    u /= dt;
    velocity = distribute_field<dim>(finest(), u);
    move(dt);
  }

  // @sect3{What is shown}

  // @sect4{FallingDisk::add_energies}

  // Until the disk meets the floor, its centre is at $0.625 - g t^2 / 2$. At
  // all times the sum of its energies should stay as it was.
  template <int dim>
  void
  FallingDisk<dim>::add_energies(const double time, TableHandler &table) const
  {
    double mass = 0., moment = 0., kinetic = 0., elastic = 0.;
    bodies[0].points.for_each(
      [&](const unsigned int, const ConstPointRef<dim> point) {
        const double depth = Problem::depth(point.position(dim - 1));
        mass += point.mass();
        moment += point.mass() * point.position(dim - 1);
        kinetic += 0.5 * point.mass() * point.velocity().norm_square();
        MaterialPoint state;
        load_material_point<dim>(point, bodies[0].points.layout(), state);
        elastic += point.volume0() * rubber.strain_energy(state) +
                   0.5 * point.mass() * Problem::floor_kappa * depth * depth;
      });
    for (double *sum : {&mass, &moment, &kinetic, &elastic})
      *sum = Utilities::MPI::sum(*sum, MPI_COMM_WORLD);

    const double height = moment / mass;
    const double gap    = Problem::height - Problem::radius - Problem::floor;
    const double fall   = 0.5 * Problem::gravity * time * time;
    const double potential =
      mass * Problem::gravity * (height - Problem::floor - Problem::radius);
    table.add_value("time", time);
    table.add_value("height", height);
    table.add_value("free fall",
                    fall < gap ? std::to_string(Problem::height - fall) : "-");
    table.add_value("kinetic", kinetic);
    table.add_value("potential", potential);
    table.add_value("elastic", elastic);
    table.add_value("sum", kinetic + potential + elastic);
  }

  // @sect4{FallingDisk::write_files}

  // Greville writes the points. The velocity of the grid goes through deal.II:
  // <code>SplineSpace::extract()</code> writes a spline as a field of a
  // <code>DoFHandler</code> with Bernstein polynomials, and from there on it is
  // a finite element field like any other.
  template <int dim>
  void
  FallingDisk<dim>::write_files(const double       time,
                                const std::string &scheme,
                                FieldOutput<dim>  &point_files)
  {
    point_files.write_points(time, bodies, MPI_COMM_WORLD);

    const SplineSpace<dim> &space = spaces.finest();
    DoFHandler<dim>         dof_handler(mesh);
    dof_handler.distribute_dofs(space.fe());
    IndexSet relevant;
    DoFTools::extract_locally_relevant_dofs(dof_handler, relevant);
    VectorField<dim> fields;
    DataOut<dim>     data_out;
    for (unsigned int c = 0; c < dim; ++c)
      {
        fields[c].reinit(dof_handler.locally_owned_dofs(),
                         relevant,
                         MPI_COMM_WORLD);
        space.extract(velocity[c], dof_handler, fields[c]);
        fields[c].update_ghost_values();
        data_out.add_data_vector(dof_handler,
                                 fields[c],
                                 std::string("velocity_") + "xyz"[c]);
      }
    data_out.build_patches(space.degree());

    const std::string name = data_out.write_vtu_with_pvtu_record(
      scheme + "/", "grid", grid_files.size(), MPI_COMM_WORLD, 4);
    grid_files.emplace_back(time, name);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::ofstream file(scheme + "/grid.pvd");
        DataOutBase::write_pvd_record(file, grid_files);
      }
  }

  // @sect4{FallingDisk::run}

  // An explicit step must not be longer than a wave takes through a cell. An
  // implicit one is as long as what happens wants it to be: two milliseconds
  // show the impact.
  template <int dim>
  void
  FallingDisk<dim>::run(const std::string &scheme)
  {
    const bool   is_implicit = scheme == "implicit";
    const double longest = is_implicit ? 2e-3 : 0.3 * cell_size / wave_speed();
    const unsigned int n_steps =
      std::ceil(Problem::output_every / longest - 1e-9);
    const double dt = Problem::output_every / n_steps;

    run_on_first([&]() { std::filesystem::create_directories(scheme); },
                 MPI_COMM_WORLD);
    const OutputParameters output_parameters;
    FieldOutput<dim>       point_files(scheme, output_parameters);
    TableHandler           table;
    add_energies(0., table);
    write_files(0., scheme, point_files);
    const unsigned int n_outputs =
      std::lround(Problem::end_time / Problem::output_every);
    for (unsigned int output = 1; output <= n_outputs; ++output)
      {
        for (unsigned int step = 0; step < n_steps; ++step)
          is_implicit ? implicit_step(dt) : explicit_step(dt);
        add_energies(output * Problem::output_every, table);
        write_files(output * Problem::output_every, scheme, point_files);
      }

    for (const std::string column : {"kinetic", "potential", "elastic", "sum"})
      table.set_precision(column, 2);
    table.set_precision("time", 2);
    table.set_precision("height", 6);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
      return;
    std::cout << "\n"
              << n_outputs * n_steps << ' ' << scheme << " steps of "
              << bodies[0].n_points << " points";
    if (is_implicit)
      std::cout << ", " << n_solves << " linear systems, "
                << std::setprecision(2) << double(n_iterations) / n_solves
                << " iterations each";
    std::cout << std::endl;
    table.write_text(std::cout, TableHandler::org_mode_table);
  }
} // namespace StepGreville

// @sect3{The main function}

// First the table of iterations, then both kinds of steps with quadratic
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
          {
            FallingDisk<2> disk(p, n_cells);
            const auto     iterations = disk.count_iterations();
            table.add_value("cells", n_cells);
            table.add_value("p", p);
            table.add_value("unknowns", disk.n_unknowns());
            table.add_value("mass", iterations[0]);
            table.add_value("10 cells", iterations[1]);
            table.add_value("100 cells", iterations[2]);
            table.add_value("smoother", iterations[3]);
          }
      if (is_first)
        {
          std::cout << "Iterations with p-multigrid:" << std::endl;
          table.write_text(std::cout, TableHandler::org_mode_table);
        }
      for (const std::string scheme : {"explicit", "implicit"})
        FallingDisk<2>(2, 16).run(scheme);
    }
  catch (const std::exception &exception)
    {
      if (is_first)
        std::cerr << greville::message_of(exception) << std::endl;
      return 1;
    }
}
