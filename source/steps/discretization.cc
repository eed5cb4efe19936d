// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/memory.h>
#include <greville/base/step_errors.h>
#include <greville/spline/coarse_cells.h>
#include <greville/steps/discretization.h>
#include <greville/steps/implicit_scheme.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/load_balance.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two sortings of the groups of points.
    constexpr unsigned int defragment_every = 200;



    template <int dim>
    MultiIndex<dim>
    to_multi_index(const std::vector<unsigned int> &numbers)
    {
      MultiIndex<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = numbers[d];
      return result;
    }



    template <int dim>
    Point<dim>
    to_point(const std::vector<double> &numbers)
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = numbers[d];
      return result;
    }



    /**
     * Throw where parameters contradict each other.
     */
    void
    check_parameters(const SimulationParameters &parameters)
    {
      AssertThrow(!(parameters.scheme.transfer == "APIC" &&
                    parameters.scheme.quadrature != "points"),
                  ExcMessage("'Scheme/Transfer' = APIC goes with "
                             "'Scheme/Quadrature' = points, not <" +
                             parameters.scheme.quadrature + ">."));
      AssertThrow(parameters.scheme.transfer != "APIC" ||
                    parameters.scheme.mass == "lumped",
                  ExcMessage(
                    "'Scheme/Transfer' = APIC goes with 'Scheme/Mass' "
                    "= lumped, not <" +
                    parameters.scheme.mass +
                    ">: the momentum of APIC is the right-hand side of "
                    "a lumped solve. With the exact mass, PIC already "
                    "is a projection that keeps linear fields."));
    }
  } // namespace



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
    AssertThrow(parameters.general.dimension == dim &&
                  parameters.grid.cells.size() == dim,
                ExcMessage("The parameters are those of a simulation in " +
                           std::to_string(parameters.general.dimension) +
                           "D, not " + std::to_string(dim) + "D."));
    double n_cells = 1.;
    for (const unsigned int n : parameters.grid.cells)
      n_cells *= n;
    check_memory_of_cells(n_cells,
                          dim,
                          parameters.sweep.cells.empty()
                            ? "The parameter 'Grid/Cells'"
                            : "The parameter 'Sweep/Cells'",
                          comm);
    create_box_mesh<dim>(mesh,
                         to_point<dim>(parameters.grid.lower),
                         to_point<dim>(parameters.grid.upper),
                         to_multi_index<dim>(parameters.grid.cells),
                         Walls<dim>::periodic_directions(parameters.walls));
    cell_partition =
      std::make_shared<const Partition>(std::vector<double>(), comm);
    repartition(std::make_shared<const Partition>(
      initial_partition(mesh, parameters, loads)));
    const std::string warning =
      describe_many_coarse_cells<dim>(to_multi_index<dim>(
                                        parameters.grid.cells),
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
    if (Utilities::MPI::n_mpi_processes(comm) == 1 || partition->n_rows == 0 ||
        partition->is_same(*cell_partition))
      return false;
    repartition_mesh(mesh, *partition);
    cell_partition = partition;
    return true;
  }



  template <int dim>
  void
  Discretization<dim>::reinit()
  {
    check_parameters(parameters);
    sums_over_points = parameters.scheme.quadrature == "points";
    reconstruction.emplace(parameters.grid.degree + 1,
                           parameters.scheme.quadrature ==
                             "taylor-least-squares",
                           parameters.scheme.full_cell);
    stamp_of_sums = 0;
    mass_is_known = false;
    grid_walls    = Walls<dim>(parameters.walls);
    // A program's own integrator may be implicit.
    const std::string &scheme = parameters.scheme.stress_update;
    const bool         is_explicit =
      scheme == "USL" || scheme == "USF" || scheme == "MUSL";
    orders.reinit(mesh,
                  parameters.grid.degree,
                  !is_explicit ? parameters.implicit_solver.multigrid.coarsening
                  : parameters.scheme.mass == "consistent" &&
                      parameters.solver.method == "cg-p-multigrid"
                    ? parameters.multigrid.coarsening
                    : "none");
    grid_mass  = make_grid_mass<dim>(parameters.scheme.mass,
                                    orders,
                                    parameters,
                                    grid_walls);
    consistent = dynamic_cast<ConsistentMass<dim> *>(grid_mass.get());
    grid_walls.reinit(space());
    // The grid of total Lagrangian steps is that of initial positions.
    grid_walls.check_paths(space(),
                           parameters.time.start,
                           parameters.time.end,
                           !parameters.scheme.is_total_lagrangian());
    point_transfer.reinit(space());
    projection.reset();
    if (parameters.scheme.volumetric_projection != "none")
      {
        projection = std::make_unique<VolumeProjection<dim>>();
        projection->reinit(space(),
                           mesh,
                           parameters.scheme.volumetric_projection ==
                             "coarse mesh");
      }
    point_transport.reinit(mesh, space());
    space().initialize_vector(lumped);
    initialize(point_momentum);
    forces_of_surfaces.clear();
  }



  template <int dim>
  double
  Discretization<dim>::cell_size() const
  {
    double h = space().lattice().cell_size(0);
    for (unsigned int d = 1; d < dim; ++d)
      h = std::min(h, space().lattice().cell_size(d));
    return h;
  }



  template <int dim>
  void
  Discretization<dim>::initialize(VectorField<dim> &field) const
  {
    for (VectorType &component : field)
      space().initialize_vector(component);
  }



  template <int dim>
  const std::vector<const MaterialPoints<dim> *> &
  Discretization<dim>::quadrature_points(const State<dim> &state,
                                         const bool        anew)
  {
    summed.clear();
    reconstructed.resize(state.bodies.size());
    for (unsigned int b = 0; b < state.bodies.size(); ++b)
      {
        const Body<dim> &body = state.bodies[b];
        if (body.rigid_motion)
          continue;
        if (!sums_over_points && anew)
          reconstruction->reconstruct(body.points, reconstructed[b]);
        summed.push_back(sums_over_points ? &body.points : &reconstructed[b]);
      }
    return summed;
  }



  template <int dim>
  const std::vector<const MaterialPoints<dim> *> &
  Discretization<dim>::sum(const State<dim> &state, VectorField<dim> *force)
  {
    const bool is_current = stamp_of_sums == state.points_stamp;
    if (is_current && !force)
      return quadrature_points(state, false);
    stamp_of_sums = 0;
    {
      const PartTimer timer(log, "points to grid");
      // Reconstructions have stress and loads, which may have changed.
      point_transfer.points_to_grid(quadrature_points(state, true),
                                    is_current ? nullptr : &lumped,
                                    is_current ? nullptr : &point_momentum,
                                    force);
      if (force)
        add_surface_forces(state, *force);
    }
    if (!is_current)
      {
        // That of total Lagrangian steps never changes.
        const PartTimer timer(log, "mass");
        if (!mass_is_known)
          grid_mass->update(lumped, summed, point_transfer);
        mass_is_known = parameters.scheme.is_total_lagrangian();
      }
    stamp_of_sums = state.points_stamp;
    return summed;
  }



  template <int dim>
  void
  Discretization<dim>::add_surface_forces(const State<dim> &state,
                                          VectorField<dim> &force)
  {
    while (forces_of_surfaces.size() < state.surfaces.size())
      {
        forces_of_surfaces.emplace_back();
        initialize(forces_of_surfaces.back());
      }
    for (unsigned int k = 0; k < state.surfaces.size(); ++k)
      {
        point_transfer.points_to_grid({&state.surfaces[k].points},
                                      nullptr,
                                      nullptr,
                                      &forces_of_surfaces[k]);
        for (unsigned int d = 0; d < dim; ++d)
          force[d] += forces_of_surfaces[k][d];
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
    point_transfer.points_to_grid(quadrature_points(state, true),
                                  &mass,
                                  &momentum,
                                  &force);
    add_surface_forces(state, force);
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
    point_transfer.filling(quadrature_points(state, true), filled_part);
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
    stamp_of_sums = 0;
    point_transfer.points_to_grid(quadrature_points(state, true),
                                  &lumped,
                                  &point_momentum,
                                  nullptr);
  }



  template <int dim>
  unsigned int
  Discretization<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                             const std::vector<const VectorField<dim> *> &sums,
                             const std::vector<double> &shares)
  {
    const PartTimer timer(log, "solve");
    fail_with([&]() { grid_mass->solve(x, sums, shares); });
    return grid_mass->n_iterations();
  }



  template <int dim>
  std::string
  Discretization<dim>::transport_points(
    State<dim>                                   &state,
    const std::vector<std::vector<unsigned int>> &left_cells,
    const std::vector<std::vector<unsigned int>> &left_surface_cells)
  {
    const PartTimer timer(log, "transport");
    std::string     problem;
    // All points, free ones, removed ones, and the mass of the last: integers
    // are exact in doubles.
    std::vector<double> counts(4);
    for (unsigned int b = 0; b < state.bodies.size(); ++b)
      {
        Body<dim> &body   = state.bodies[b];
        const auto result = point_transport.move(body.points, left_cells[b]);
        counts[0] += body.points.n_points();
        if (!body.rigid_motion)
          counts[1] += body.points.n_points();
        counts[2] += result.n_removed;
        counts[3] += result.removed_mass;
        state.n_sent += result.n_sent;
        if (result.n_removed > 0 && problem.empty() &&
            (parameters.scheme.outside == "error" ||
             !std::isfinite(result.outside_position.norm())))
          {
            std::ostringstream message;
            message << "point " << result.outside << " of the body '"
                    << body.name << "' has left the grid: it is at ("
                    << result.outside_position << ") m";
            problem = message.str();
          }
        if (state.n_steps % defragment_every == defragment_every - 1)
          body.points.defragment();
      }
    for (unsigned int s = 0; s < left_surface_cells.size(); ++s)
      {
        Surface<dim> &surface = state.surfaces[s];
        const auto    result =
          point_transport.move(surface.points, left_surface_cells[s]);
        if (result.n_removed > 0 && problem.empty() &&
            (parameters.scheme.outside == "error" ||
             !std::isfinite(result.outside_position.norm())))
          {
            std::ostringstream message;
            message << "point " << result.outside
                    << " of the surface of the load '" << surface.name
                    << "' has left the grid: it is at ("
                    << result.outside_position << ") m";
            problem = message.str();
          }
        if (state.n_steps % defragment_every == defragment_every - 1)
          surface.points.defragment();
      }
    state.points_have_changed();
    Utilities::MPI::sum(counts, comm, counts);
    state.n_points = std::uint64_t(counts[0]);
    state.n_free   = std::uint64_t(counts[1]);
    state.n_removed += std::uint64_t(counts[2]);
    state.removed_mass += state.mass_removed_last;
    state.mass_removed_last = counts[3];
    return problem;
  }



  template class Discretization<2>;
  template class Discretization<3>;
} // namespace greville
