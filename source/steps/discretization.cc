// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/memory.h>
#include <greville/base/step_errors.h>
#include <greville/spline/coarse_cells.h>
#include <greville/steps/implicit_scheme.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/load_balance.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two defragmentations of the points.
    constexpr unsigned int defragment_every = 200;



    void
    check_parameters(const SimulationParameters &parameters)
    {
      const bool taylor = parameters.scheme.is_taylor();
      Require(!parameters.scheme.has_affine() ||
                support_of_mass(parameters.scheme.mass).affine,
              "'Scheme/Transfer' = " + parameters.scheme.transfer +
                " needs 'Scheme/Mass' = " + masses_with(&MassSupport::affine) +
                ", not <" + parameters.scheme.mass + ">: the momentum of " +
                parameters.scheme.transfer +
                " is the right-hand side of a lumped solve. With the exact "
                "mass, " +
                (taylor ? "FLIP" : "PIC") + " already " +
                (taylor ? "keeps" : "is a projection that keeps") +
                " linear fields.");
    }



    bool
    has_lumped_steps(const SimulationParameters &parameters)
    {
      return is_explicit_scheme(parameters.scheme.stress_update) &&
             parameters.scheme.has_lumped_mass();
    }



    /// Return whether values of functions are averaged over domains, as
    /// derivatives are: in lumped explicit and in static implicit steps.
    bool
    averages_values(const SimulationParameters &parameters)
    {
      const std::string &name = parameters.scheme.stress_update;
      return has_lumped_steps(parameters) ||
             (is_implicit_scheme(name) &&
              make_implicit_scheme(name, parameters.implicit).is_static);
    }



    /// Return the orders that solvers use.
    Coarsening
    coarsening_of(const SimulationParameters &parameters)
    {
      // An integrator that a program adds may be implicit.
      if (!is_explicit_scheme(parameters.scheme.stress_update))
        return parameters.implicit_solver.multigrid.coarsening;
      return parameters.scheme.has_consistent_mass() &&
                 parameters.solver.has_cycle()
               ? parameters.multigrid.coarsening
               : Coarsening::none;
    }
  } // namespace



  template <int dim>
  MultiIndex<dim>
  create_grid_mesh(DistributedTriangulation<dim> &mesh,
                   const GridParameters          &grid,
                   const WallParameters          &walls,
                   const std::string             &parameter,
                   const double                   start)
  {
    double          n_all_cells = 1.;
    Point<dim>      lower, upper;
    MultiIndex<dim> n_cells;
    CellEdges<dim>  edges;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d]   = grid.lower[d];
        upper[d]   = grid.upper[d];
        n_cells[d] = grid.cells[d];
        edges[d]   = grid.edges(d);
        n_all_cells *= n_cells[d];
      }
    check_memory_of_cells(n_all_cells,
                          dim,
                          "The parameter '" + parameter + "'",
                          get_communicator(mesh));
    auto levels = grid.hierarchy<dim>(start);
    if (levels)
      levels = levels->refined_also(grid.marked_at_start);
    create_box_mesh<dim>(mesh,
                         lower,
                         upper,
                         n_cells,
                         Walls<dim>::periodic_directions(walls),
                         edges,
                         levels);
    return n_cells;
  }



  template <int dim>
  Discretization<dim>::Discretization(const SimulationParameters &parameters,
                                      const Loads<dim>           &loads,
                                      StepLog                    &log,
                                      const MPI_Comm              comm)
    : parameters(parameters)
    , log(log)
    , comm(comm)
    , mesh(comm, Triangulation<dim>::none, mesh_settings<dim>)
    , grid_walls(parameters.walls)
  {
    Require(parameters.general.dimension == dim &&
              parameters.grid.cells.size() == dim,
            "The parameters are those of a simulation in " +
              std::to_string(parameters.general.dimension) + "D, not " +
              std::to_string(dim) + "D.");
    const MultiIndex<dim> n_cells = create_grid_mesh(mesh,
                                                     parameters.grid,
                                                     parameters.walls,
                                                     "Grid/Cells",
                                                     parameters.time.start);
    if (parameters.grid.is_refined())
      refine_at_surfaces(mesh, parameters, loads);
    cell_partition = std::make_shared<const Partition>(
      std::vector<double>(),
      comm,
      parameters.grid.has_changing_cells()
        ? std::make_shared<const RefinedCells>(
            RefinedCells{refined_cells(mesh), {}})
        : nullptr);
    repartition(std::make_shared<const Partition>(
      initial_partition(mesh, parameters, loads).rows,
      comm,
      cell_partition->cells));
    const std::string warning =
      describe_many_coarse_cells<dim>(n_cells,
                                      Utilities::MPI::n_mpi_processes(comm));
    if (!warning.empty())
      log.warnings.push_back(warning);
    reinit();
  }



  template <int dim>
  bool
  Discretization<dim>::repartition(
    const std::shared_ptr<const Partition> &partition)
  {
    const bool adapts = !partition->has_same_cells(*cell_partition);
    if (adapts)
      {
        const Lattice<dim> lattice(mesh);
        adapt_box_mesh<dim>(
          mesh, lattice.hierarchy()->refined_only(partition->cells->all));
      }
    const bool moves = Utilities::MPI::n_mpi_processes(comm) > 1 &&
                       partition->n_rows > 0 &&
                       !partition->is_same(*cell_partition);
    if (moves)
      repartition_mesh(mesh, *partition);
    if (moves || adapts)
      cell_partition = partition;
    return moves || adapts;
  }



  template <int dim>
  void
  Discretization<dim>::reinit_adapted(
    const std::vector<std::uint64_t> &at_surfaces)
  {
    cell_partition =
      std::make_shared<const Partition>(std::vector<double>(),
                                        comm,
                                        std::make_shared<const RefinedCells>(
                                          RefinedCells{refined_cells(mesh),
                                                       at_surfaces}));
    reinit();
  }



  template <int dim>
  void
  Discretization<dim>::reinit()
  {
    check_parameters(parameters);
    version_of_sums = 0;
    mass_is_known   = false;
    grid_walls      = Walls<dim>(parameters.walls);
    orders.reinit(mesh, parameters.grid.degree, coarsening_of(parameters));
    windows.reset();
    if (parameters.scheme.averages_over_domains())
      {
        windows = std::make_unique<CellWindows<dim>>();
        windows->reinit(space(), averages_values(parameters));
        // In lumped steps, all functions that domains reach have mass.
        if (has_lumped_steps(parameters))
          windows->reach_all_neighbors();
      }
    make_field();
    grid_walls.reinit(space());
    // Walls may leave the grid of total Lagrangian steps.
    grid_walls.check_paths(space(),
                           parameters.time.start,
                           parameters.time.end,
                           !parameters.scheme.is_total_lagrangian());
    point_transfer.reinit(space(), windows.get());
    projection.reset();
    if (parameters.scheme.has_projection())
      {
        projection = std::make_unique<VolumeProjection<dim>>();
        projection->reinit(space(),
                           mesh,
                           parameters.scheme.projects_on_coarse_mesh());
      }
    point_transport.reinit(space());
  }



  template <int dim>
  void
  Discretization<dim>::make_field()
  {
    grid_field      = GridField<dim>();
    grid_field.mass = make_grid_mass<dim>(orders, parameters, grid_walls);
    if (is_explicit_scheme(parameters.scheme.stress_update))
      grid_field.mass->set_windows(windows.get());
    space().initialize_vector(grid_field.lumped_mass);
    initialize(grid_field.momentum);
    initialize(grid_field.force);
  }



  template <int dim>
  void
  Discretization<dim>::initialize_field(State<dim> &state) const
  {
    state.field = FieldState<dim>();
    initialize(state.field.velocity);
    initialize(state.field.acceleration);
  }



  template <int dim>
  void
  Discretization<dim>::set_points(const State<dim> &state)
  {
    grid_field.points.clear();
    for (const Body<dim> &body : state.bodies)
      grid_field.points.push_back(&body.points);
  }



  template <int dim>
  void
  Discretization<dim>::sum(const State<dim> &state, const bool with_force)
  {
    set_points(state);
    const bool is_current = version_of_sums == state.points_version;
    if (is_current && !with_force)
      return;
    version_of_sums       = 0;
    GridField<dim> &field = grid_field;
    // The windows of cells follow from the extension of the mass, and the force
    // needs them.
    const bool force_waits = field.mass->has_windows();
    {
      const PartTimer timer(log, "points to grid");
      point_transfer.points_to_grid(
        field.points,
        is_current ? nullptr : &field.lumped_mass,
        is_current ? nullptr : &field.momentum,
        with_force && !force_waits ? &field.force : nullptr,
        is_current || mass_is_known ? nullptr : field.mass->filled_parts());
      if (!is_current)
        field.mass->condense_levels(field.lumped_mass,
                                    field.momentum,
                                    field.points,
                                    point_transfer);
      if (with_force && !force_waits)
        field.mass->condense_levels(field.force);
    }
    // The mass of total Lagrangian steps never changes.
    if (!is_current && !mass_is_known)
      {
        const PartTimer                          timer(log, "mass");
        std::vector<const MaterialPoints<dim> *> of_surfaces;
        for (const Surface<dim> &surface : state.surfaces)
          of_surfaces.push_back(&surface.points);
        field.mass->update(field.lumped_mass,
                           field.points,
                           of_surfaces,
                           point_transfer);
      }
    if (with_force)
      {
        const PartTimer timer(log, "points to grid");
        if (force_waits)
          point_transfer.points_to_grid(field.points,
                                        nullptr,
                                        nullptr,
                                        &field.force);
        add_surface_forces(state, field.surface_forces, field.force);
      }
    if (!is_current)
      mass_is_known = parameters.scheme.is_total_lagrangian();
    version_of_sums = state.points_version;
  }



  template <int dim>
  void
  Discretization<dim>::add_surface_forces(
    const State<dim>              &state,
    std::vector<VectorField<dim>> &of_surfaces,
    VectorField<dim>              &force)
  {
    while (of_surfaces.size() < state.surfaces.size())
      {
        of_surfaces.emplace_back();
        initialize(of_surfaces.back());
      }
    for (unsigned int k = 0; k < state.surfaces.size(); ++k)
      {
        point_transfer.points_to_grid({&state.surfaces[k].points},
                                      nullptr,
                                      nullptr,
                                      &of_surfaces[k]);
        grid_field.mass->condense(of_surfaces[k]);
        grid_field.mass->condense_levels(of_surfaces[k]);
        for (unsigned int d = 0; d < dim; ++d)
          force[d] += of_surfaces[k][d];
      }
  }



  template <int dim>
  void
  Discretization<dim>::find_force(const State<dim>     &state,
                                  const Tensor<1, dim> &gravity,
                                  VectorField<dim>     &force)
  {
    VectorType       mass;
    VectorField<dim> momentum;
    space().initialize_vector(mass);
    initialize(momentum);
    set_points(state);
    point_transfer.points_to_grid(grid_field.points, &mass, &momentum, &force);
    grid_field.mass->condense_levels(mass, momentum, {}, point_transfer);
    grid_field.mass->condense_levels(force);
    std::vector<VectorField<dim>> of_surfaces;
    add_surface_forces(state, of_surfaces, force);
    for (unsigned int d = 0; d < dim; ++d)
      force[d].add(gravity[d], mass);
  }



  template <int dim>
  std::vector<unsigned char>
  Discretization<dim>::cell_classes(const State<dim> &state,
                                    const bool        is_implicit)
  {
    typename CellFilling<dim>::Walls contact_walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      contact_walls[w] = grid_walls.is_friction(w);
    std::vector<double> filled_part;
    set_points(state);
    point_transfer.filling(grid_field.points, filled_part);
    CellFilling<dim> filling;
    filling.reinit(space(), contact_walls);
    filling.update(filled_part,
                   parameters.scheme.filling_threshold(is_implicit));
    std::vector<unsigned char> result;
    for (unsigned int cell = 0; cell < filled_part.size(); ++cell)
      result.push_back(filling.cell_class(cell));
    return result;
  }



  template <int dim>
  void
  Discretization<dim>::sum_momentum(const State<dim> &state)
  {
    const PartTimer timer(log, "points to grid");
    version_of_sums = 0;
    set_points(state);
    point_transfer.points_to_grid(grid_field.points,
                                  &grid_field.lumped_mass,
                                  &grid_field.momentum,
                                  nullptr);
    grid_field.mass->condense_levels(grid_field.lumped_mass,
                                     grid_field.momentum,
                                     grid_field.points,
                                     point_transfer);
  }



  template <int dim>
  unsigned int
  Discretization<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                             const std::vector<const VectorField<dim> *> &sums,
                             const std::vector<double> &shares)
  {
    const PartTimer timer(log, "solve");
    fail_with([&]() { grid_field.mass->solve(x, sums, shares); });
    return grid_field.mass->n_iterations();
  }



  template <int dim>
  double
  Discretization<dim>::flip_share(const State<dim> &state,
                                  const double      dt) const
  {
    const SchemeParameters &scheme = parameters.scheme;
    if (scheme.is_pic() || scheme.flip == 0.)
      return 0.;
    if (scheme.flip == 1.)
      return 1.;
    return std::pow(scheme.flip, dt * state.first_signal / cell_size());
  }



  template <int dim>
  void
  Discretization<dim>::transport_points(State<dim>        &state,
                                        const PointMotion &motion)
  {
    const PartTimer timer(log, "transport");
    std::string     problem = motion.problem;
    const auto      move    = [&](MaterialPoints<dim>             &points,
                          const std::vector<unsigned int> &left,
                          const std::string               &owner) {
      const auto result = point_transport.move(points, left);
      if (result.n_removed > 0 && problem.empty() &&
          (parameters.scheme.stops_outside() ||
           !std::isfinite(result.outside_position.norm())))
        problem = "point " + std::to_string(result.outside) + " of the " +
                  owner + "' has left the grid: it is at (" +
                  text_of(result.outside_position) +
                  ") m. Enlarge the grid, set the type of this wall, or set "
                          "'Scheme/Points outside' = remove";
      if (state.n_steps % defragment_every == defragment_every - 1)
        points.defragment();
      return result;
    };
    // Numbers of points and of removed points, exact in doubles, and the
    // removed mass.
    std::vector<double> counts(3);
    for (unsigned int b = 0; b < state.bodies.size(); ++b)
      {
        Body<dim> &body = state.bodies[b];
        const auto result =
          move(body.points, motion.left_cells[b], "body '" + body.name);
        counts[0] += body.points.n_points();
        counts[1] += result.n_removed;
        counts[2] += result.removed_mass;
        state.n_sent += result.n_sent;
      }
    for (unsigned int s = 0; s < motion.left_surface_cells.size(); ++s)
      move(state.surfaces[s].points,
           motion.left_surface_cells[s],
           "surface of the load '" + state.surfaces[s].name);
    state.points_have_changed();
    Utilities::MPI::sum(counts, comm, counts);
    state.n_points = std::uint64_t(counts[0]);
    state.n_removed += std::uint64_t(counts[1]);
    state.removed_mass += state.mass_removed_last;
    state.mass_removed_last = counts[2];
    fail_on_all(problem, comm);
  }



  GREVILLE_INSTANTIATE(create_grid_mesh);
  GREVILLE_INSTANTIATE_CLASS(Discretization);
} // namespace greville
