// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/geometry/inside.h>
#include <greville/parameters/pores.h>
#include <greville/steps/adapt_grid.h>
#include <greville/steps/body_surfaces.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/load_balance.h>
#include <greville/steps/stage_bodies.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::string
    overlap_message(const Body<dim>        &a,
                    const Body<dim>        &b,
                    const unsigned int      cell,
                    const SplineSpace<dim> &space)
    {
      return "'Body " + b.name + "' overlaps 'Body " + a.name +
             "', for instance at (" + text_of(space.box(cell).center) +
             ") m: the mass would be counted twice. In shapes, difference(a, "
             "b) cuts one body out of another.";
    }



    /// Throw if two bodies share basis functions. In total Lagrangian steps
    /// they would stick together wherever they move.
    template <int dim>
    void
    check_distances(const std::vector<Body<dim>> &bodies,
                    const SplineSpace<dim>       &space)
    {
      // The number n of cells with points in a function's support, the sum of
      // their body numbers, and the sum of the squares. With a single body,
      // sum^2 = squares * n.
      VectorType count, sum, squares;
      for (VectorType *vector : {&count, &sum, &squares})
        space.initialize_vector(*vector);
      for (unsigned int b = 0; b < bodies.size(); ++b)
        for (const unsigned int cell : bodies[b].points.cells())
          for (const unsigned int f : space.cell_functions(cell))
            {
              count.local_element(f) += 1.;
              sum.local_element(f) += b;
              squares.local_element(f) += b * b;
            }
      for (VectorType *vector : {&count, &sum, &squares})
        vector->compress(VectorOperation::add);
      std::ostringstream message;
      for (unsigned int i = 0;
           i < count.locally_owned_size() && message.str().empty();
           ++i)
        if (sum.local_element(i) * sum.local_element(i) !=
            squares.local_element(i) * count.local_element(i))
          message << "With 'Scheme/Formulation' = total Lagrangian the "
                     "initial distance of two bodies is so small that a "
                     "B-spline reaches both, near ("
                  << space.greville_point(i)
                  << ") m: they would move as one body. Place them at least p "
                     "+ 1 cells apart, or give each a grid of its own "
                     "('Grid/Per body' = true); bodies do not interact in "
                     "such steps.";
      throw_on_all(message.str(), space.communicator());
    }



    /// Collective. Set the initial pore pressure of surfaces in contact.
    template <int dim>
    void
    set_pore_pressure(std::vector<Surface<dim>> &surfaces,
                      const WaterTable<dim>     &table,
                      const SplineSpace<dim>    &space)
    {
      run_on_all(space.communicator(), [&]() {
        for (Surface<dim> &surface : surfaces)
          if (const PointField *pore =
                surface.points.layout().find("pore_pressure"))
            surface.points.for_each([&](const PointRef<dim> p) {
              p[pore->first] = table(p.position());
            });
      });
    }
  } // namespace



  template <int dim>
  void
  check_overlap(const BodyList<dim> &bodies, const SplineSpace<dim> &space)
  {
    // Filled fractions of cells. Two bodies overlap if the previous bodies fill
    // more of a cell than the new body leaves free.
    const unsigned int  n_cells = space.owned_cells().size();
    std::vector<double> before(n_cells, 0.), own(n_cells);
    for (unsigned int b = 0; b < bodies.size(); ++b)
      {
        const auto &points = bodies[b].points;
        std::fill(own.begin(), own.end(), 0.);
        points.for_each([&](const unsigned int cell, ConstPointRef<dim> p) {
          own[cell] += p.volume() / cell_volume(space, cell, points.layout());
        });
        std::string message;
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          {
            const auto is_there = [&](const Body<dim> &body) {
              return body.points.n_points(cell) > 0;
            };
            own[cell] = std::min(own[cell], 1.);
            if (own[cell] + before[cell] > 1.5 && message.empty())
              message = overlap_message(*std::find_if(bodies.begin(),
                                                      bodies.end(),
                                                      is_there),
                                        bodies[b],
                                        cell,
                                        space);
            before[cell] = std::min(own[cell] + before[cell], 1.);
          }
        throw_on_all(message, space.communicator());
      }
  }



  // Check, for each two bodies, the points of one that are inside the other.
  // Bodies that touch may share a layer of points on their common boundary.
  template <int dim>
  void
  check_overlap_of_shapes(const BodyList<dim>    &bodies,
                          const SplineSpace<dim> &space)
  {
    // A common volume of two bodies is an error above these fractions of a cell
    // or of the smaller body.
    constexpr double    allowed_part_of_cell = 0.4, allowed_part_of_body = 0.5;
    const std::size_t   n_bodies = bodies.size();
    const unsigned int  n_cells  = space.owned_cells().size();
    std::vector<double> common(n_bodies * n_bodies, 0.), volumes(n_bodies);
    std::vector<double> largest(common);
    std::vector<unsigned int> cells(common.size(), 0);
    run_on_all(space.communicator(), [&]() {
      std::vector<std::function<bool(const Point<dim> &)>> inside(n_bodies);
      const auto has_shape = [&](const std::size_t b) {
        return bodies[b].parameters->points_file.empty() &&
               bodies[b].parameters->displacement.empty();
      };
      // Return, for each cell, the volume of the points of a that are inside b.
      const auto volumes_of = [&](const std::size_t a, const std::size_t b) {
        std::vector<double> result(n_cells, 0.);
        bodies[a].points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> p) {
            if (bodies[b].points.n_points(cell) == 0)
              return;
            if (!inside[b])
              inside[b] = make_inside<dim>(*bodies[b].parameters,
                                           "Body " + bodies[b].name,
                                           space);
            if (inside[b](p.position()))
              result[cell] += p.volume();
          });
        return result;
      };
      for (std::size_t b = 0; b < n_bodies; ++b)
        {
          bodies[b].points.for_each(
            [&](ConstPointRef<dim> p) { volumes[b] += p.volume(); });
          for (std::size_t a = 0; a < b && has_shape(b); ++a)
            {
              if (!has_shape(a))
                continue;
              const std::size_t pair   = a * n_bodies + b;
              const auto        a_in_b = volumes_of(a, b);
              const auto        b_in_a = volumes_of(b, a);
              for (unsigned int cell = 0; cell < n_cells; ++cell)
                {
                  const double own = std::min(a_in_b[cell], b_in_a[cell]);
                  common[pair] += own;
                  if (own > largest[pair])
                    cells[pair] = cell;
                  largest[pair] = std::max(largest[pair], own);
                }
            }
        }
    });
    Utilities::MPI::sum(common, space.communicator(), common);
    Utilities::MPI::sum(volumes, space.communicator(), volumes);
    std::string message;
    for (std::size_t b = 0; b < n_bodies; ++b)
      for (std::size_t a = 0; a < b; ++a)
        {
          const std::size_t pair = a * n_bodies + b;
          if (largest[pair] > 0. && message.empty() &&
              (largest[pair] >
                 allowed_part_of_cell *
                   cell_volume(space, cells[pair], bodies[a].points.layout()) ||
               common[pair] >
                 allowed_part_of_body * std::min(volumes[a], volumes[b])))
            message = overlap_message(bodies[a], bodies[b], cells[pair], space);
        }
    throw_on_all(message, space.communicator());
  }



  namespace
  {
    /// Return the bodies of the first stage with their points, with the numbers
    /// of their laws only.
    template <int dim>
    std::vector<Body<dim>>
    place_bodies(const SimulationParameters &parameters,
                 const Loads<dim>           &loads,
                 const SplineSpace<dim>     &space)
    {
      std::vector<Body<dim>> bodies;
      for (const std::string &name : parameters.general.bodies)
        if (parameters.is_in_stage(name, 0))
          {
            bodies.push_back(make_body<dim>(name, parameters));
            make_points(bodies.back(),
                        space,
                        loads.gravity(parameters.time.start),
                        PointLayout<dim>(
                          bodies.back().material->state_names()));
          }
      return bodies;
    }
  } // namespace



  template <int dim>
  Partition
  initial_partition(DistributedTriangulation<dim> &mesh,
                    const SimulationParameters    &parameters,
                    const Loads<dim>              &loads)
  {
    const MPI_Comm comm = get_communicator(mesh);
    if (Utilities::MPI::n_mpi_processes(comm) == 1)
      return Partition({}, comm);
    const SplineSpace<dim>     cells(mesh, 1);
    std::vector<std::uint64_t> counts(cells.owned_cells().size(), 0);
    for (const Body<dim> &body : place_bodies(parameters, loads, cells))
      for (const unsigned int cell : body.points.cells())
        counts[cell] += body.points.n_points(cell);
    return partition_by_points(counts, cells);
  }



  namespace
  {
    /// Collective. Refine a mesh as the regions with a 'Distance to surface'
    /// require, until the surfaces, which depend on the cells, do not change.
    template <int dim>
    void
    refine_near_surfaces(DistributedTriangulation<dim> &mesh,
                         const SimulationParameters    &parameters,
                         const Loads<dim>              &loads)
    {
      // Surfaces outside of a region's shape may depend on cells around it.
      constexpr unsigned int most_sweeps = 6;
      const GridParameters  &grid        = parameters.grid;
      for (unsigned int k = 0; k < most_sweeps; ++k)
        {
          const SplineSpace<dim> space(mesh, grid.degree);
          const auto             levels =
            grid
              .hierarchy<dim>(
                parameters.time.start,
                find_surfaces(parameters,
                              space,
                              place_bodies(parameters, loads, space),
                              {},
                              true))
              ->refined_also(grid.marked_at_start);
          if (has_cells_of(space, *levels))
            return;
          adapt_box_mesh<dim>(mesh, levels);
        }
    }
  } // namespace



  template <int dim>
  void
  refine_at_surfaces(DistributedTriangulation<dim> &mesh,
                     const SimulationParameters    &parameters,
                     const Loads<dim>              &loads)
  {
    if (parameters.grid.has_distances())
      refine_near_surfaces(mesh, parameters, loads);
    while (true)
      {
        const SplineSpace<dim> space(mesh, parameters.grid.degree);
        const auto             bodies = place_bodies(parameters, loads, space);
        std::vector<const MaterialPoints<dim> *> points;
        for (const Body<dim> &body : bodies)
          points.push_back(&body.points);
        const auto cells = cells_at_surfaces(space, points);
        if (cells.empty())
          return;
        adapt_box_mesh<dim>(mesh, space.hierarchy()->refined_also(cells));
      }
  }



  template <int dim>
  Signals
  initial_signals(const std::vector<Body<dim>> &bodies,
                  const SplineSpace<dim>       &space)
  {
    Signals signals;
    for (const Body<dim> &body : bodies)
      {
        const Moduli moduli = body.material->moduli();
        const double c      = std::sqrt((moduli.bulk + 4. / 3. * moduli.shear) /
                                   body.material->density);
        signals.wave        = std::max(signals.wave, c);
        signals.fastest     = std::max(signals.fastest, c);
        if (!body.points.layout().is_total_lagrangian())
          body.points.for_each([&](ConstPointRef<dim> p) {
            double rate = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              rate += std::abs(p.velocity(d)) / space.cell_size(d);
            signals.fastest =
              std::max(signals.fastest, c + p.velocity().norm());
            signals.crossing_rate = std::max(signals.crossing_rate, rate);
          });
      }
    const MPI_Comm comm   = space.communicator();
    signals.fastest       = Utilities::MPI::max(signals.fastest, comm);
    signals.crossing_rate = Utilities::MPI::max(signals.crossing_rate, comm);
    signals.wave          = Utilities::MPI::max(signals.wave, comm);
    return signals;
  }



  template <int dim>
  void
  renew_signals(State<dim> &state, const SplineSpace<dim> &space)
  {
    const Signals last    = state.signals;
    state.signals         = initial_signals(state.bodies, space);
    state.signals.wave    = std::max(last.wave, state.signals.wave);
    state.signals.fastest = std::max(last.fastest, state.signals.fastest);
  }



  template <int dim>
  State<dim>
  make_initial_state(const SimulationParameters &parameters,
                     const Loads<dim>           &loads,
                     Discretization<dim>        &discretization)
  {
    const SplineSpace<dim> &space = discretization.space();
    State<dim>              state;
    for (const std::string &name : parameters.general.bodies)
      {
        Body<dim> body = make_body<dim>(name, parameters);
        body.points.reinit(space, layout_of<dim>(name, parameters));
        if (parameters.is_in_stage(name, 0))
          add_points(body, 0, parameters, loads, discretization);
        state.n_points += body.n_points;
        state.bodies.push_back(std::move(body));
      }
    state.partition = discretization.partition();
    state.surfaces  = make_surfaces(state.bodies, loads, discretization);
    if (parameters.general.pore_water)
      set_pore_pressure(state.surfaces,
                        {parameters.water.table,
                         parameters.water.density,
                         parameters.water.suction(),
                         loads.gravity(parameters.time.start)},
                        space);
    state.water.assign(2 + 2 * dim + state.surfaces.size(), 0.);
    if (!parameters.water.free_surface_pressure.empty())
      state.water.push_back(0.);
    state.water_of_step.assign(state.water.size(), 0.);
    state.signals      = initial_signals(state.bodies, space);
    state.first_signal = state.signals.fastest;
    state.time = state.velocity_time = parameters.time.start;
    check_overlap<dim>(state.bodies, space);
    check_overlap_of_shapes<dim>(state.bodies, space);
    if (parameters.scheme.is_total_lagrangian())
      check_distances(state.bodies, space);
    discretization.initialize_field(state);
    state.points_have_changed();
    return state;
  }



  template <int dim>
  void
  check_closed_box(const std::vector<Body<dim>> &bodies,
                   const SimulationParameters   &parameters,
                   const SplineSpace<dim>       &space)
  {
    // The thickness, in cells, below which a layer between bodies and a wall
    // counts as round-off.
    constexpr double negligible_layer = 0.1;
    if (!parameters.general.pore_water || parameters.water.bulk_modulus > 0. ||
        is_drained(parameters))
      return;
    const Point<dim>     &lower = space.lower_corner();
    const Point<dim>     &upper = space.upper_corner();
    const WallParameters &walls = parameters.walls;
    double                box = 1., thinnest = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        box *= upper[d] - lower[d];
        thinnest =
          std::min(thinnest, space.cell_size(d) / (upper[d] - lower[d]));
        for (const unsigned int w : {2 * d, 2 * d + 1})
          if (!(walls.is_periodic(w) ||
                (w == 0 && parameters.grid.has_axis()) ||
                (!walls.is_free(w) && walls.region[w].empty())))
            return;
      }
    if (parameters.grid.is_axisymmetric())
      box *= 0.5 * (lower[0] + upper[0]);
    double volume = 0.;
    for (const Body<dim> &body : bodies)
      body.points.for_each([&](ConstPointRef<dim> p) {
        volume +=
          parameters.scheme.is_total_lagrangian() ? p.volume0() : p.volume();
      });
    volume = Utilities::MPI::sum(volume, space.communicator());
    Require(volume < (1. - negligible_layer * thinnest) * box,
            "The pore pressure is undetermined: the parameter 'Water/Bulk "
            "modulus' is 0 (incompressible water), the bodies fill the grid, "
            "all walls constrain the normal motion, and none of 'Walls/... "
            "pore pressure', 'Surface load NAME/Pore pressure' and 'Water/Free "
            "surface pressure' is given. Give one of them, a 'Bulk modulus', "
            "or a surface without a wall.");
  }



  GREVILLE_INSTANTIATE(check_overlap);
  GREVILLE_INSTANTIATE(check_overlap_of_shapes);
  GREVILLE_INSTANTIATE(initial_partition);
  GREVILLE_INSTANTIATE(refine_at_surfaces);
  GREVILLE_INSTANTIATE(initial_signals);
  GREVILLE_INSTANTIATE(renew_signals);
  GREVILLE_INSTANTIATE(make_initial_state);
  GREVILLE_INSTANTIATE(check_closed_box);
} // namespace greville
