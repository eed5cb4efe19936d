// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/surface_values.h>
#include <greville/water/pore_water.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// The penalty of Nitsche's method times the cell size, for each degree of
    /// the displacement. It bounds the trace of a displacement on cells of half
    /// the size.
    constexpr std::array<double, 6> penalties = {{0., 4., 24., 36., 64., 100.}};
  } // namespace



  template <int dim>
  PoreWater<dim>::PoreWater(const SplineSpace<dim>        &displacements,
                            DistributedTriangulation<dim> &triangulation,
                            const SimulationParameters    &parameters)
    : displacements(displacements)
    , parameters(parameters)
    , drained(displacements, parameters, penalties[displacements.degree()])
  {
    orders.reinit(triangulation,
                  displacements.degree(),
                  Coarsening::direct,
                  true);

    for (unsigned int c = 0; c < displacements.owned_cells().size(); ++c)
      parents.push_back(space().find(displacements.box(c).center));
    transfer.reinit(displacements);
    filling.reinit(space());
    points.reinit(displacements,
                  space(),
                  parents,
                  parameters.grid.is_axisymmetric());
    tables.resize(orders.n_levels());
    const bool is_dynamic = !parameters.scheme.is_quasi_static();
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
    flow_is_linear =
      parameters.water.capillary_height == 0. && !drained.has_seepage_face();
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
    // Extend functions to drained surfaces, and to surfaces where friction
    // needs the pressure.
    for (unsigned int k = 0; k < surfaces.size(); ++k)
      if (drained.has_surface(k) ||
          (!surfaces[k].contact.empty() &&
           parameters.contacts.at(surfaces[k].contact).depends_on_pressure()))
        for (const unsigned int cell : surfaces[k].points.cells())
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
  typename WaterPoints<dim>::Numbers
  PoreWater<dim>::numbers_of(const Body<dim> &body) const
  {
    const PointLayout<dim> &layout = body.points.layout();
    const PointField *const change = layout.find(field_of_change);
    return {layout.first(field),
            change ? change->first : numbers::invalid_unsigned_int};
  }



  template <int dim>
  void
  PoreWater<dim>::begin_step(const std::vector<Body<dim>>    &bodies,
                             const std::vector<Surface<dim>> &surfaces,
                             const double                     time,
                             const double                     dt,
                             const Tensor<1, dim>            &gravity,
                             const double                     last_dt)
  {
    // BDF2 is stable up to this ratio of a step to the previous one; beyond it,
    // backward Euler is used.
    constexpr double largest_ratio = 2.4;
    double           ratio         = 0.;
    if (parameters.water.is_second_order && dt <= largest_ratio * last_dt)
      ratio = dt / last_dt;
    part_of_earlier      = ratio * ratio / (1. + 2. * ratio);
    const double flow_dt = (1. + ratio) / (1. + 2. * ratio) * dt;
    points.clear(flow_dt, parameters.water.density * gravity, part_of_earlier);
    for (const Body<dim> &body : bodies)
      points.add(body.points,
                 numbers_of(body),
                 water_constants(body, parameters.water));
    run_on_all(space().communicator(), [&]() {
      drained.add_walls(bodies, filled, time, points);
      drained.add_surfaces(bodies, surfaces, time, points);
      if (!free_surface)
        return;
      free_surface->clear(flow_dt, time);
      for (const Body<dim> &body : bodies)
        free_surface->add(body.points, water_constants(body, parameters.water));
    });
    if (free_surface)
      free_surface->finish();
    std::vector<double> sums{points.moduli()[0],
                             points.moduli()[1],
                             points.mass()};
    Utilities::MPI::sum(sums, space().communicator(), sums);
    scale = sums[0] > 0.
              ? sums[1] / sums[0] / displacements.smallest_cell_size()
              : 1.;
    speed = sums[2] > 0. ? std::sqrt(sums[1] / sums[2]) : 0.;
    if (sums[0] > 0.)
      mean_density = sums[2] / sums[0];
    multigrid.reset();
    multigrid_of_mass.reset();
  }



  template <int dim>
  void
  PoreWater<dim>::guess(VectorType &x)
  {
    initialize(x);
    if (!flow_is_linear ||
        std::any_of(parameters.contacts.begin(),
                    parameters.contacts.end(),
                    [](const auto &contact) {
                      return contact.second.depends_on_pressure();
                    }))
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
    for (const unsigned int n : space().cells_per_direction())
      n_long += n > 1;
    PMultigridParameters cycle = of_cycle.multigrid;
    if (n_long <= 1)
      cycle.coarsening = Coarsening::none;
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
    const Tensor<1, dim> size = space().upper_corner() - space().lower_corner();
    double               square = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      square += std::pow(size[d], 2);
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
  std::vector<std::vector<double>>
  PoreWater<dim>::at_surfaces(
    const VectorType                               &x,
    const std::vector<const MaterialPoints<dim> *> &surfaces) const
  {
    pressure.copy_locally_owned_data_from(x);
    levels.back()->distribute(pressure);
    return values_at_surfaces(tables.back(), parents, pressure, surfaces);
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
  PoreWater<dim>::advance(std::vector<Body<dim>>    &bodies,
                          const std::vector<double> &last) const
  {
    std::vector<
      std::pair<MaterialPoints<dim> *, typename WaterPoints<dim>::Numbers>>
      of_bodies;
    for (Body<dim> &body : bodies)
      of_bodies.emplace_back(&body.points, numbers_of(body));
    points.store(of_bodies);
    std::vector<double> result = points.volumes();
    result.resize(last.size(), 0.);
    if (free_surface)
      {
        result.back() = free_surface->outflow();
        result[1] += result.back();
      }
    // The change of the pore volume already contains this part.
    for (unsigned int k = 1; k < result.size(); ++k)
      result[k] += part_of_earlier * last[k];
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(PoreWater);
} // namespace greville
