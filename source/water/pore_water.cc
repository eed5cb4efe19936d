// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/parameters/names.h>
#include <greville/water/pore_water.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * The penalty of Nitsche's method that covers the trace of a displacement
     * on cells of half the size, times the size of a cell.
     */
    constexpr std::array<double, 6> penalties = {{0., 4., 24., 36., 64., 100.}};



    template <int dim>
    std::vector<std::string>
    variables_of_surfaces()
    {
      std::vector<std::string> variables = coordinate_names<dim>();
      for (unsigned int d = 0; d < dim; ++d)
        variables.push_back(std::string(1, "XYZ"[d]));
      variables.push_back("t");
      return variables;
    }
  } // namespace



  template <int dim>
  PoreWater<dim>::PoreWater(const SplineSpace<dim>        &displacements,
                            DistributedTriangulation<dim> &triangulation,
                            const SimulationParameters    &parameters)
    : displacements(displacements)
    , parameters(parameters)
  {
    const unsigned int p = displacements.degree();
    const unsigned int q =
      parameters.water.degree > 0 ? parameters.water.degree : p;
    orders.reinit(triangulation, q, "direct", true);
    penalty = penalties[q];

    const auto &lattice = space().lattice();
    const auto &cells   = space().owned_cells();
    for (const std::uint64_t position : displacements.owned_cells())
      {
        auto index =
          multi_index<dim>(position, displacements.lattice().n_cells());
        for (unsigned int d = 0; d < dim; ++d)
          index[d] /= 2;
        const std::uint64_t parent =
          lexicographic<dim>(index, lattice.n_cells());
        parents.push_back(std::lower_bound(cells.begin(), cells.end(), parent) -
                          cells.begin());
      }
    transfer.reinit(displacements);
    filling.reinit(space());
    points.reinit(displacements,
                  space(),
                  parents,
                  parameters.grid.is_axisymmetric());
    tables.resize(orders.n_levels());
    const bool is_dynamic = parameters.scheme.stress_update != "quasi-static";
    is_explicit           = is_explicit_scheme(parameters.scheme.stress_update);
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        levels.push_back(std::make_unique<PressureLevel<dim>>(orders[l]));
        if (is_dynamic)
          levels_of_mass.push_back(
            std::make_unique<PressureLevel<dim>>(orders[l]));
        tables[l].reinit(orders[l]);
      }
    of_cycle.multigrid.smoother = "chebyshev-ic0";
    for (VectorType *vector : {&pressure, &rows})
      initialize(*vector);

    if (!parameters.water.free_surface_pressure.empty())
      free_surface = std::make_unique<FreeSurface<dim>>(
        displacements,
        space(),
        parents,
        parameters.grid.is_axisymmetric(),
        parameters.water.free_surface_pressure,
        "Water/Free surface pressure");
    flow_is_linear = parameters.water.capillary_height == 0.;
    std::vector<std::string> variables = coordinate_names<dim>();
    variables.push_back("t");
    const WallParameters &walls = parameters.walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (walls.passes_water(w))
        {
          const std::string name = "Walls/" + WallParameters::names[w];
          of_walls.emplace(w,
                           make_given(walls.pore_pressure[w],
                                      walls.flux[w],
                                      walls.seepage_face[w],
                                      name + " pore pressure",
                                      name + " flux",
                                      variables));
        }
    const auto &names = parameters.general.surface_loads;
    for (unsigned int k = 0; k < names.size(); ++k)
      {
        const SurfaceLoadParameters &load =
          parameters.surface_loads.at(names[k]);
        const std::string name = "Surface load " + names[k];
        if (load.passes_water())
          of_surfaces.emplace(k,
                              make_given(load.pore_pressure,
                                         load.flux,
                                         load.seepage_face,
                                         name + "/Pore pressure",
                                         name + "/Flux",
                                         variables_of_surfaces<dim>()));
      }
    for (const auto *given : {&of_walls, &of_surfaces})
      for (const auto &entry : *given)
        if (entry.second.kind == Kind::seepage)
          flow_is_linear = false;
  }



  template <int dim>
  typename PoreWater<dim>::Given
  PoreWater<dim>::make_given(const std::string              &pressure,
                             const std::string              &flux,
                             const bool                      is_seepage_face,
                             const std::string              &pressure_name,
                             const std::string              &flux_name,
                             const std::vector<std::string> &variables)
  {
    if (!flux.empty())
      return {{flux, flux_name, variables}, Kind::flux};
    return {{pressure, pressure_name, variables},
            is_seepage_face ? Kind::seepage : Kind::pressure};
  }



  template <int dim>
  void
  PoreWater<dim>::set(DrainedPoint<dim>             &point,
                      const Given                   &given,
                      const ArrayView<const double> &arguments) const
  {
    point.kind  = given.kind;
    point.value = given.formula(arguments);
    if (given.kind == Kind::flux)
      return;
    // Below a water level water comes in, too.
    if (point.value > 0.)
      point.kind = Kind::pressure;
    point.mobility *=
      relative_conductivity(point.value, parameters.water.suction())[0];
  }



  template <int dim>
  bool
  PoreWater<dim>::set_soil(DrainedPoint<dim>            &point,
                           const std::vector<Body<dim>> &bodies,
                           const unsigned int            cell) const
  {
    double volume = 0., volume0 = 0., mobility = 0., solid = 0.;
    for (const Body<dim> &body : bodies)
      {
        const WaterConstants soil = constants(body);
        body.points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          volume += p.volume();
          volume0 += p.volume0();
          mobility += p.volume() * soil.mobility;
          solid += p.volume() * soil.solid;
        });
      }
    if (volume == 0.)
      return false;
    point.mobility = mobility / volume;
    point.solid    = solid / volume;
    point.old_J    = volume / volume0;
    return true;
  }



  template <int dim>
  WaterConstants
  PoreWater<dim>::constants(const Body<dim> &body) const
  {
    const Material        &material = *body.material;
    const WaterParameters &water    = parameters.water;
    return {water.bulk_modulus > 0. ? material.porosity / water.bulk_modulus
                                    : 0.,
            material.conductivity / water.unit_weight(),
            material.conductivity_law == "kozeny-carman"
              ? 1. - material.porosity
              : 0.,
            water.suction()};
  }



  template <int dim>
  void
  PoreWater<dim>::set_points(const std::vector<Body<dim>>    &bodies,
                             const std::vector<Surface<dim>> &surfaces)
  {
    std::vector<const MaterialPoints<dim> *> of_bodies;
    for (const Body<dim> &body : bodies)
      of_bodies.push_back(&body.points);
    transfer.filling(of_bodies, filled);
    if (free_surface)
      free_surface->find_layer(filled);
    const unsigned int  n_cells = space().owned_cells().size();
    std::vector<double> parts(n_cells, 0.);
    for (unsigned int c = 0; c < filled.size(); ++c)
      parts[parents[c]] += filled[c] / GeometryInfo<dim>::max_children_per_cell;
    // Functions are extended to where a surface is drained.
    for (const auto &drained : of_surfaces)
      for (const unsigned int cell : surfaces[drained.first].points.cells())
        if (parts[parents[cell]] <= 0.)
          parts[parents[cell]] = -1.;
    const bool changed =
      filling.update(parts, parameters.scheme.filling_threshold(true), true) ||
      is_first;
    is_first = false;
    for (const Levels *all : {&levels, &levels_of_mass})
      for (auto &level : *all)
        level->begin(filling, parts, changed);
    multigrid.reset();
    multigrid_of_mass.reset();
  }



  template <int dim>
  void
  PoreWater<dim>::begin_step(const std::vector<Body<dim>>    &bodies,
                             const std::vector<Surface<dim>> &surfaces,
                             const double                     time,
                             const double                     dt,
                             const Tensor<1, dim>            &gravity)
  {
    points.clear(dt, parameters.water.density * gravity);
    for (const Body<dim> &body : bodies)
      points.add(body.points,
                 body.points.layout().first(field),
                 constants(body));
    run_on_all(
      [&]() {
        add_walls(bodies, time);
        add_surfaces(bodies, surfaces, time);
        if (!free_surface)
          return;
        free_surface->clear(dt, time);
        for (const Body<dim> &body : bodies)
          free_surface->add(body.points, constants(body));
      },
      space().communicator());
    if (free_surface)
      free_surface->finish();
    std::vector<double> sums{points.moduli()[0],
                             points.moduli()[1],
                             points.mass()};
    Utilities::MPI::sum(sums, space().communicator(), sums);
    scale = sums[0] > 0.
              ? sums[1] / sums[0] / displacements.lattice().smallest_cell_size()
              : 1.;
    speed = sums[2] > 0. ? std::sqrt(sums[1] / sums[2]) : 0.;
    if (sums[0] > 0.)
      mean_density = sums[2] / sums[0];
    multigrid.reset();
    multigrid_of_mass.reset();
  }



  template <int dim>
  void
  PoreWater<dim>::add_walls(const std::vector<Body<dim>> &bodies,
                            const double                  time)
  {
    const auto                 &lattice = displacements.lattice();
    const QGauss<dim - 1>       gauss(displacements.degree() + 1);
    std::array<double, dim + 1> arguments;
    arguments[dim] = time;
    for (const auto &[w, given] : of_walls)
      {
        const unsigned int d    = w / 2;
        const unsigned int side = w % 2;
        const double       area = lattice.cell_volume() / lattice.cell_size(d);
        for (unsigned int c = 0; c < displacements.owned_cells().size(); ++c)
          {
            const auto index = multi_index<dim>(displacements.owned_cells()[c],
                                                lattice.n_cells());
            if (index[d] != (side == 0 ? 0 : lattice.n_cells()[d] - 1))
              continue;
            DrainedPoint<dim> of_cell;
            if (!set_soil(of_cell, bodies, c))
              continue;
            const Point<dim> corner = lattice.cell_corner(index);
            for (unsigned int q = 0; q < gauss.size(); ++q)
              {
                DrainedPoint<dim> point = of_cell;
                point.cell              = c;
                point.boundary          = w;
                for (unsigned int e = 0, k = 0; e < dim; ++e)
                  point.x[e] =
                    e == d
                      ? (side == 0 ? lattice.lower(d) : lattice.upper(d))
                      : corner[e] + lattice.cell_size(e) * gauss.point(q)[k++];
                point.area[d] = (side == 0 ? -1. : 1.) * area *
                                gauss.weight(q) * std::min(1., filled[c]);
                point.to_basis = unit_symmetric_tensor<dim>();
                if (parameters.grid.is_axisymmetric())
                  {
                    point.radius = point.x[0];
                    point.area *= point.radius;
                  }
                point.penalty = penalty / (2. * lattice.cell_size(d));
                for (unsigned int e = 0; e < dim; ++e)
                  arguments[e] = point.x[e];
                set(point,
                    given,
                    ArrayView<const double>(arguments.data(), dim + 1));
                points.add(point);
              }
          }
      }
  }



  template <int dim>
  void
  PoreWater<dim>::add_surfaces(const std::vector<Body<dim>>    &bodies,
                               const std::vector<Surface<dim>> &surfaces,
                               const double                     time)
  {
    const auto                     &lattice = displacements.lattice();
    std::array<double, 2 * dim + 1> arguments;
    arguments[2 * dim] = time;
    for (const auto &of_surface : of_surfaces)
      {
        const Given            &given   = of_surface.second;
        const Surface<dim>     &surface = surfaces[of_surface.first];
        const PointLayout<dim> &layout  = surface.points.layout();
        const WaterConstants    soil    = constants(bodies[surface.body]);
        for (const unsigned int cell : surface.points.cells())
          {
            surface.points.for_each_in_cell(
              cell, [&](const ConstPointRef<dim> p) {
                const SurfaceState<dim> state = surface_state<dim>(p, layout);
                DrainedPoint<dim>       point;
                point.cell     = cell;
                point.boundary = 2 * dim + of_surface.first;
                point.x        = p.basis_position(layout);
                point.area     = p.mass() * state.area_vector();
                point.to_basis = unit_symmetric_tensor<dim>();
                if (layout.is_total_lagrangian())
                  point.to_basis = invert(state.F);
                point.mobility = soil.mobility;
                point.solid    = soil.solid;
                point.old_J    = determinant(state.F);
                if (parameters.grid.is_axisymmetric())
                  {
                    point.radius = state.x[0];
                    point.old_J *= state.x[0] / state.X[0];
                  }
                // The size of the cell along the normal, which has the
                // direction F^T area in the configuration of the basis
                // functions.
                Tensor<1, dim> normal = point.area;
                if (layout.is_total_lagrangian())
                  normal = transpose(state.F) * point.area;
                double size = 0.;
                for (unsigned int d = 0; d < dim; ++d)
                  size += std::abs(normal[d]) / (2. * lattice.cell_size(d));
                point.penalty =
                  penalty * size * point.area.norm() / normal.norm_square();
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    arguments[d]       = state.x[d];
                    arguments[dim + d] = state.X[d];
                  }
                set(point,
                    given,
                    ArrayView<const double>(arguments.data(), 2 * dim + 1));
                points.add(point);
              });
          }
      }
  }



  template <int dim>
  void
  PoreWater<dim>::guess(VectorType &x)
  {
    initialize(x);
    if (!flow_is_linear)
      points.average_old_pressure(x);
  }



  template <int dim>
  void
  PoreWater<dim>::evaluate(const VectorField<dim> &u,
                           const VectorType       &x,
                           VectorField<dim>       &force,
                           VectorType             &residual)
  {
    pressure.copy_locally_owned_data_from(x);
    levels.back()->distribute(pressure);
    points.evaluate(u, pressure, force, rows);
    if (free_surface)
      {
        free_surface->add_rows(pressure, rows);
        outer_work = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const VectorType &outer = free_surface->force()[d];
            force[d] += outer;
            for (unsigned int i = 0; i < outer.locally_owned_size(); ++i)
              outer_work -= outer.local_element(i) * u[d].local_element(i);
          }
      }
    levels.back()->condense(rows);
    rows *= scale;
    residual.copy_locally_owned_data_from(rows);
  }



  template <int dim>
  void
  PoreWater<dim>::multiply(const VectorField<dim> &du,
                           const VectorType       &dx,
                           VectorField<dim>       &force,
                           VectorType             &result) const
  {
    pressure.copy_locally_owned_data_from(dx);
    levels.back()->distribute(pressure);
    points.multiply(du, pressure, force, rows);
    if (free_surface)
      free_surface->add_derivative(pressure, rows);
    levels.back()->condense(rows);
    rows *= scale;
    result.copy_locally_owned_data_from(rows);
  }



  template <int dim>
  void
  PoreWater<dim>::begin_force(VectorField<dim> &force) const
  {
    points.begin_force(force);
    if (free_surface)
      for (unsigned int d = 0; d < dim; ++d)
        force[d] += free_surface->force()[d];
  }



  template <int dim>
  void
  PoreWater<dim>::spread(const VectorType &dx, VectorField<dim> &force) const
  {
    pressure.copy_locally_owned_data_from(dx);
    levels.back()->distribute(pressure);
    points.spread(pressure, force);
  }



  template <int dim>
  std::unique_ptr<PMultigrid<dim>>
  PoreWater<dim>::make_cycle(const Levels &of_cycles,
                             const double  mobility) const
  {
    for (unsigned int l = 0; l < of_cycles.size(); ++l)
      {
        StencilMatrix<dim> &matrix = of_cycles[l]->begin_matrix();
        points.add_schur_complement(tables[l], mobility, matrix);
        if (free_surface)
          free_surface->add_schur_complement(tables[l], matrix);
        of_cycles[l]->finish_matrix();
      }
    // In strips one cell wide, IC(0) is exact.
    unsigned int n_long = 0;
    for (const unsigned int n : space().lattice().n_cells())
      n_long += n > 1;
    PMultigridParameters cycle = of_cycle.multigrid;
    if (n_long <= 1)
      cycle.coarsening = "none";
    typename PMultigrid<dim>::Levels operators;
    for (const auto &level : of_cycles)
      if (n_long > 1 || level == of_cycles.back())
        operators.push_back(level.get());
    return std::make_unique<PMultigrid<dim>>(operators,
                                             cycle,
                                             of_cycle.smoother,
                                             cycle.coarse_tolerance);
  }



  template <int dim>
  void
  PoreWater<dim>::find_free_motion(const SolveMass &solve_mass)
  {
    VectorField<dim> force, motion;
    for (unsigned int d = 0; d < dim; ++d)
      {
        displacements.initialize_vector(force[d]);
        displacements.initialize_vector(motion[d]);
      }
    pressure = 1.;
    points.spread(pressure, force);
    for (VectorType &component : force)
      component *= -1.;
    solve_mass(force, motion);
    points.set_free_motion(motion);
  }



  template <int dim>
  void
  PoreWater<dim>::set_up(const double mass_factor, const SolveMass &solve_mass)
  {
    if (flow_is_linear && (multigrid || multigrid_of_mass))
      return;
    if (!is_explicit)
      multigrid = make_cycle(levels, 0.);
    // Inertia does not count where waves pass the grid in a step.
    const auto &lattice = space().lattice();
    double      square  = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      square += std::pow(lattice.upper(d) - lattice.lower(d), 2);
    if (!is_explicit && speed * speed >= mass_factor * square)
      return;
    find_free_motion(solve_mass);
    multigrid_of_mass = make_cycle(levels_of_mass, 1. / mass_factor);
  }



  template <int dim>
  void
  PoreWater<dim>::precondition(VectorType &dx, const VectorType &of_rows) const
  {
    if (multigrid)
      multigrid->vmult(dx, of_rows);
    else
      dx = 0.;
    if (multigrid_of_mass)
      {
        multigrid_of_mass->vmult(rows, of_rows);
        dx.add(1., rows);
      }
    dx *= 1. / scale;
  }



  template <int dim>
  double
  PoreWater<dim>::force_scale() const
  {
    return std::sqrt(
      Utilities::MPI::sum(points.squares()[0], space().communicator()));
  }



  template <int dim>
  double
  PoreWater<dim>::round_off() const
  {
    constexpr double units = 16. * std::numeric_limits<double>::epsilon();
    return units * scale *
           std::sqrt(
             Utilities::MPI::sum(points.squares()[1], space().communicator()));
  }



  template <int dim>
  std::vector<double>
  PoreWater<dim>::advance(std::vector<Body<dim>> &bodies) const
  {
    std::vector<std::pair<MaterialPoints<dim> *, unsigned int>> of_bodies;
    for (Body<dim> &body : bodies)
      of_bodies.emplace_back(&body.points, body.points.layout().first(field));
    points.store(of_bodies);
    std::vector<double> result = points.volumes();
    if (free_surface)
      {
        result.resize(3 + 2 * dim + parameters.general.surface_loads.size(),
                      0.);
        result.back() = free_surface->outflow();
        result[1] += result.back();
      }
    return result;
  }



  template class PoreWater<2>;
  template class PoreWater<3>;
} // namespace greville
