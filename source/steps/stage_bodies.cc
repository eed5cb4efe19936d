// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/in_stage.h>
#include <greville/points/point_material.h>
#include <greville/steps/implicit_scheme.h>
#include <greville/steps/stage_bodies.h>
#include <greville/water/pore_water.h>

#include <algorithm>
#include <cmath>
#include <typeinfo>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Elastic laws are equal if their stored energies differ by a smaller
    // fraction.
    constexpr double energy_tolerance = 1e-10;

    // The strength divisor during a transfer of stress, so that any stress is
    // elastic. A point outside of the new yield surface returns to it in the
    // next step.
    constexpr double any_strength = 1e-9;



    /// Add the fields that schemes and loads of all stages keep in points.
    template <int dim>
    void
    add_fields(PointLayout<dim> &layout, SimulationParameters parameters)
    {
      for (unsigned int k = 0; k < parameters.n_stages(); ++k)
        {
          parameters.enter_stage(k);
          if (parameters.scheme.has_affine())
            layout.add("affine", dim * dim);
          const std::string &name = parameters.scheme.stress_update;
          if (is_implicit_scheme(name) &&
              make_implicit_scheme(name, parameters.implicit)
                .keeps_acceleration &&
              (!parameters.scheme.is_total_lagrangian() ||
               parameters.grid.adapt_every > 0))
            layout.add("acceleration", dim);
          in_stage(parameters, k, [&]() {
            Loads<dim>(parameters).add_fields(layout);
          });
          if (parameters.scheme.has_projection())
            layout.add("projected_J", 1);
          if (parameters.scheme.averages_over_domains())
            layout.add("domain", dim);
          if (parameters.grid.is_axisymmetric())
            layout.add("radius0", 1);
          if (parameters.general.pore_water)
            layout.add(PoreWater<dim>::field, 1);
          if (parameters.water.is_second_order)
            layout.add(PoreWater<dim>::field_of_change, 1);
        }
    }



    bool
    changes_material(const std::string          &body,
                     const SimulationParameters &parameters)
    {
      return std::any_of(parameters.stages.begin(),
                         parameters.stages.end(),
                         [&](const StageParameters &stage) {
                           const auto &first = parameters.stages[0].material_of;
                           return stage.material_of.count(body) > 0 &&
                                  stage.material_of.at(body) != first.at(body);
                         });
    }



    std::vector<SoilLayer>
    layers_of(const SimulationParameters &parameters, const unsigned int stage)
    {
      std::vector<SoilLayer> layers;
      for (const auto &[name, body] : parameters.bodies)
        if (body.K0 >= 0. && !body.shape.empty() &&
            parameters.is_in_stage(name, stage))
          layers.push_back({name,
                            body.surface,
                            body.shape,
                            parameters.materials.at(body.material)->density});
      return layers;
    }



    /// Throw if a body begins at rest although gravity acts between periodic
    /// walls.
    template <int dim>
    void
    check_rest(const Body<dim>            &body,
               const SimulationParameters &parameters,
               const Tensor<1, dim>       &gravity)
    {
      const bool has_K0 = body.parameters->K0 >= 0.;
      if (!has_K0 && parameters.water.table.empty())
        return;
      for (unsigned int d = 0; d < dim; ++d)
        Require(gravity[d] == 0. || !parameters.walls.is_periodic(2 * d),
                "The parameter '" +
                  (has_K0 ? "Body " + body.name + "/K0' is " +
                              text_of(body.parameters->K0)
                          : "Water/Table' is <" +
                              formula_text(parameters.water.table) + ">") +
                  ", but 'Loads/Gravity', (" + text_of(gravity) +
                  ") m / s^2 at the start, acts between the walls '" +
                  WallParameters::names[2 * d] + "' and '" +
                  WallParameters::names[2 * d + 1] +
                  "', which are periodic: there is no equilibrium.");
    }



    bool
    is_elastic_strain(const std::string &name)
    {
      return name.compare(0, 2, "b_") == 0;
    }



    template <int dim>
    class NewMaterial
    {
    public:
      NewMaterial(Body<dim>              &body,
                  const Material         &before,
                  const PointLayout<dim> &layout)
        : body(body)
        , before(before)
        , after(*body.material)
        , old_layout(body.points.layout())
        , layout(layout)
        , old_names(old_layout.names())
        , names(layout.names())
      {}

      bool
      is_same_model() const
      {
        return typeid(before) == typeid(after) &&
               before.state_names() == after.state_names();
      }

      /// Return whether the points of this process, with their deformation and
      /// history, have equal stresses with the old and the new material.
      bool
      fits() const
      {
        const Moduli a = before.moduli(), b = after.moduli();
        bool result = is_same_model() && a.bulk == b.bulk && a.shear == b.shear;
        if (result)
          body.points.for_each([&](ConstPointRef<dim> p) {
            MaterialPoint point;
            load_material_point<dim>(p, old_layout, point);
            const double old_energy = before.strain_energy(point),
                         new_energy = after.strain_energy(point);
            if (std::abs(new_energy - old_energy) >
                energy_tolerance * std::abs(old_energy))
              result = false;
          });
        return result;
      }

      void
      scale_mass()
      {
        const double ratio = after.density / before.density;
        if (ratio != 1.)
          body.points.for_each([&](PointRef<dim> p) { p.mass() *= ratio; });
      }

      /// Replace the points by new ones with the old stresses.
      void
      replace(const double time)
      {
        std::vector<unsigned int> cells;
        std::vector<double>       rows;
        std::vector<double>       values(layout.size);
        body.points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> p) {
            for (unsigned int k = 0; k < layout.size; ++k)
              {
                const auto found =
                  std::find(old_names.begin(), old_names.end(), names[k]);
                const bool is_history =
                  k >= layout.state && k < layout.state + layout.n_state;
                values[k] = found == old_names.end() || is_history
                              ? 0.
                              : p[found - old_names.begin()];
              }
            const PointRef<dim> q(values.data());
            set_state(p, q, time);
            cells.push_back(cell);
            rows.insert(rows.end(), values.begin(), values.end());
          });
        body.points.reinit(body.points.space(), layout);
        for (std::size_t k = 0; k < cells.size(); ++k)
          body.points.insert(cells[k],
                             ArrayView<const double>(&rows[k * layout.size],
                                                     layout.size));
        body.points.defragment();
      }

    private:
      /// Set the state of a new point q with the stress of the old point p.
      void
      set_state(const ConstPointRef<dim> p,
                const PointRef<dim>      q,
                const double             time) const
      {
        MaterialPoint old_state, state;
        load_material_point<dim>(p, old_layout, old_state);
        state.F = state.increment = unit_symmetric_tensor<3>();
        state.strength_reduction  = any_strength;
        state.position            = old_state.position;
        state.time                = time;
        state.dim                 = dim;
        state.state.resize(layout.n_state);
        try
          {
            after.initialize(state, p.stress());
          }
        catch (const std::exception &error)
          {
            Require(false,
                    "'Body " + body.name + "' cannot have '" + "Material " +
                      body.parameters->material + "' at (" +
                      text_of(p.position()) + ") m: " + message_of(error));
          }
        const auto history = after.state_names();
        for (unsigned int i = 0; is_same_model() && i < history.size(); ++i)
          if (!is_elastic_strain(history[i]))
            state.state[i] = old_state.state[i];

        q.volume0() = p.volume() / state.J;
        q.J()       = state.J;
        q.set_F(state.F);
        if (layout.initial_F != 0)
          {
            // F = F_motion F_initial, with the same F_motion as before.
            Tensor<2, dim> old_F, old_initial, new_F;
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                {
                  old_F[i][j]       = p.F(i, j);
                  new_F[i][j]       = state.F[i][j];
                  old_initial[i][j] = p[old_layout.initial_F + i * dim + j];
                }
            const Tensor<2, dim> initial = old_initial * invert(old_F) * new_F;
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                q[layout.initial_F + i * dim + j] = initial[i][j];
          }
        if (layout.projected_J != 0)
          q[layout.projected_J] = state.J;
        if (layout.domain != 0)
          set_domain(p, q);
        store_material_point<dim>(state, q, layout);
      }

      /// Set the initial box of q such that its current size is the old one,
      /// see PointLayout.
      void
      set_domain(const ConstPointRef<dim> p, const PointRef<dim> q) const
      {
        Tensor<2, dim> squares;
        Tensor<1, dim> today;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            {
              const double edge = p[old_layout.domain + j];
              squares[i][j]     = q.F(i, j) * q.F(i, j);
              today[i] += p.F(i, j) * p.F(i, j) * edge * edge;
            }
        const Tensor<1, dim> free = invert(squares) * today;
        for (unsigned int d = 0; d < dim; ++d)
          q[layout.domain + d] = std::sqrt(free[d] > 0. ? free[d] : today[d]);
      }

      Body<dim>                     &body;
      const Material                &before, &after;
      const PointLayout<dim>         old_layout, layout;
      const std::vector<std::string> old_names, names;
    };
  } // namespace



  template <int dim>
  Body<dim>
  make_body(const std::string &name, const SimulationParameters &parameters)
  {
    Body<dim> body;
    body.name       = name;
    body.parameters = &parameters.bodies.at(name);
    body.material   = parameters.materials.at(body.parameters->material).get();
    return body;
  }



  template <int dim>
  PointLayout<dim>
  layout_of(const std::string &name, const SimulationParameters &parameters)
  {
    const BodyParameters &body = parameters.bodies.at(name);
    PointLayout<dim>      layout(
      parameters.materials.at(body.material)->state_names());
    add_fields(layout, parameters);
    if (parameters.scheme.is_total_lagrangian())
      {
        layout.basis_position = PointLayout<dim>::reference;
        if (!body.stress.empty() || body.K0 >= 0. ||
            changes_material(name, parameters))
          layout.add("initial_F", dim * dim);
      }
    return layout;
  }



  template <int dim>
  void
  add_points(Body<dim>                  &body,
             const unsigned int          stage,
             const SimulationParameters &parameters,
             const Loads<dim>           &loads,
             Discretization<dim>        &discretization)
  {
    const Tensor<1, dim> gravity = loads.gravity(parameters.time.start);
    check_rest(body, parameters, gravity);
    const auto left  = make_points(body,
                                  discretization.space(),
                                  gravity,
                                  layout_of<dim>(body.name, parameters),
                                  layers_of(parameters, stage),
                                  WaterTable<dim>(parameters.water.table,
                                                  parameters.water.density,
                                                  parameters.water.suction(),
                                                  gravity));
    const auto moved = discretization.transport().move(body.points, left);
    Require(Utilities::MPI::sum(moved.n_removed,
                                discretization.communicator()) == 0,
            "The parameter 'Body " + body.name +
              "/Displacement' moves points out of the grid.");
  }



  template <int dim>
  std::vector<Surface<dim>>
  make_surfaces(const std::vector<Body<dim>> &bodies,
                const Loads<dim>             &loads,
                Discretization<dim>          &discretization)
  {
    auto surfaces =
      loads.surfaces().make_surfaces(bodies, discretization.space());
    for (Surface<dim> &surface : surfaces)
      {
        const auto moved =
          discretization.transport().move(surface.points,
                                          surface.points.cells());
        Require(Utilities::MPI::sum(moved.n_removed,
                                    discretization.communicator()) == 0,
                "The surface of 'Surface load " + surface.name +
                  "' is outside of the grid after the initial displacement.");
        if (bodies[surface.body].n_points == 0)
          surface.points.reinit(discretization.space(),
                                PointLayout<dim>(surface.points.layout()));
      }
    return surfaces;
  }



  template <int dim>
  std::vector<Body<dim>>
  make_later_bodies(const std::vector<Body<dim>> &first,
                    const SimulationParameters   &parameters,
                    Discretization<dim>          &discretization)
  {
    std::vector<Body<dim>> result;
    SimulationParameters   later = parameters;
    result.reserve(first.size());
    for (unsigned int k = 1; k < parameters.stages.size(); ++k)
      in_stage(parameters, k, [&]() {
        later.enter_stage(k);
        const Loads<dim> loads(later);
        bool             is_changed = false;
        for (const std::string &name : parameters.general.bodies)
          if (later.is_in_stage(name, k) && !later.is_in_stage(name, k - 1))
            {
              result.push_back(make_body<dim>(name, later));
              add_points(result.back(), k, later, loads, discretization);
              result.back().parameters = &parameters.bodies.at(name);
              is_changed               = true;
            }
        BodyList<dim> there;
        const auto    add = [&](const std::vector<Body<dim>> &bodies) {
          for (const Body<dim> &body : bodies)
            if (body.n_points > 0 && later.is_in_stage(body.name, k))
              there.add(body);
        };
        add(first);
        add(result);
        if (is_changed)
          {
            check_overlap(there, discretization.space());
            check_overlap_of_shapes(there, discretization.space());
          }
      });
    return result;
  }



  template <int dim>
  void
  change_bodies(State<dim>                          &state,
                const std::vector<const Material *> &before,
                const SimulationParameters          &parameters,
                const Loads<dim>                    &loads,
                Discretization<dim>                 &discretization)
  {
    const SplineSpace<dim> &space = discretization.space();
    const MPI_Comm          comm  = discretization.communicator();
    std::vector<bool>       is_new(state.bodies.size(), false);
    for (unsigned int b = 0; b < state.bodies.size(); ++b)
      {
        Body<dim>             &body   = state.bodies[b];
        const PointLayout<dim> layout = layout_of<dim>(body.name, parameters);
        const bool             was_there =
          parameters.is_in_stage(body.name, state.stage - 1);
        if (!parameters.is_in_stage(body.name, state.stage))
          {
            const std::uint64_t n_points =
              Utilities::MPI::sum<std::uint64_t>(body.points.n_points(), comm);
            state.n_points -= n_points;
            body.n_points -= n_points;
            body.points.reinit(space, layout);
          }
        else if (!was_there)
          {
            add_points(body, state.stage, parameters, loads, discretization);
            state.n_points += body.n_points;
            is_new[b] = true;
          }
        else if (before[b] != body.material)
          {
            NewMaterial<dim> change(body, *before[b], layout);
            change.scale_mass();
            bool fits = false;
            run_on_all(comm, [&]() { fits = change.fits(); });
            if (Utilities::MPI::min<unsigned int>(fits, comm) == 0)
              {
                Require(
                  layout.projected_J == 0 || !layout.is_total_lagrangian(),
                  "'Materials' gives 'Body " + body.name +
                    "' a material with another model or other elastic "
                    "constants, but 'Scheme/Volumetric projection' in total "
                    "Lagrangian steps projects the volume since the start.");
                run_on_all(comm, [&]() { change.replace(state.time); });
              }
          }
      }
    std::vector<Surface<dim>> surfaces;
    for (Surface<dim> &surface : state.surfaces)
      {
        const Body<dim> &body = state.bodies[surface.body];
        if (!parameters.is_in_stage(body.name, state.stage))
          surface.points.reinit(space,
                                PointLayout<dim>(surface.points.layout()));
        else if (is_new[surface.body])
          {
            if (surfaces.empty())
              surfaces = make_surfaces(state.bodies, loads, discretization);
            for (const Surface<dim> &made : surfaces)
              if (made.name == surface.name)
                surface = made;
          }
      }
    if (contains(is_new, true))
      check_overlap<dim>(state.bodies, space);
    state.points_have_changed();
  }



  GREVILLE_INSTANTIATE(make_body);
  GREVILLE_INSTANTIATE(layout_of);
  GREVILLE_INSTANTIATE(add_points);
  GREVILLE_INSTANTIATE(make_surfaces);
  GREVILLE_INSTANTIATE(make_later_bodies);
  GREVILLE_INSTANTIATE(change_bodies);
} // namespace greville
