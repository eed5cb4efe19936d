// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>
#include <greville/steps/distant_bodies.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Multiples of the cell size: the search distance for the other
    // side, and the largest initial overlap of surfaces.
    constexpr double reach_in_cells  = farthest_gap_in_cells,
                     deepest_overlap = 0.05;
  } // namespace



  template <int dim>
  std::vector<BoundingBox<dim>>
  BodyContacts<dim>::regions_of_rigid_bodies() const
  {
    std::vector<std::vector<Point<dim>>> corners(rigid_bodies.size());
    for (const Contact &contact : contacts)
      if (contact.rigid >= 0)
        for (const Place &place : contact.sides[0])
          {
            const SplineSpace<dim> &space = place.part->space();
            corners[contact.rigid].insert(corners[contact.rigid].end(),
                                          {space.lower_corner(),
                                           space.upper_corner()});
          }
    std::vector<BoundingBox<dim>> regions;
    for (const auto &of_body : corners)
      regions.emplace_back(of_body);
    return regions;
  }



  template <int dim>
  BodyContacts<dim>::BodyContacts(const SimulationParameters &parameters,
                                  const std::vector<Simulation<dim> *> &parts,
                                  const MPI_Comm                        comm)
    : parts(parts)
    , comm(comm)
    , search(parameters.grid.is_axisymmetric(), comm)
    , are_implicit(steps_are_implicit())
  {
    std::string others;
    bool        has_static = false;
    for (unsigned int k = 0; k < parameters.n_stages(); ++k)
      {
        const SchemeParameters &scheme = k < parameters.stages.size()
                                           ? parameters.stages[k].scheme
                                           : parameters.scheme;
        has_static                     = has_static || scheme.is_quasi_static();
        if (!is_implicit_scheme(scheme.stress_update))
          others = scheme.stress_update;
      }
    for (const std::string &name : parameters.general.contacts)
      Require(
        others.empty() || !parameters.contacts.at(name).is_augmented(),
        "'Contact " + name +
          "/Method' = augmented does not support 'Scheme/Stress update' = " +
          others + ": explicit steps have no iterations.");
    std::vector<RigidBodyState<dim>> positions;
    for (const std::string &name : parameters.general.rigid_bodies)
      {
        Require(!has_static || !parameters.rigid_bodies.at(name).is_free,
                "'Scheme/Stress update' = quasi-static does not support 'Rigid "
                "body " +
                  name +
                  "/Free' = true: without inertia its motion is unknown. Give "
                  "it a 'Velocity'.");
        rigid_bodies.emplace_back(name, parameters.rigid_bodies.at(name));
        const auto position =
          rigid_bodies.back().position_at_start(parameters.time.start);
        positions.push_back({position, position});
      }
    for (const std::string &name : parameters.general.contacts)
      make_contact(parameters, name);
    all_notes = notes_of_distant_bodies(parameters,
                                        rigid_bodies,
                                        regions_of_rigid_bodies());
    set_intervals({});
    for (Simulation<dim> *part : parts)
      {
        part->current.rigid_bodies = positions;
        part->last_good.take(part->current);
      }
    passing = std::make_unique<PassingBodies<dim>>(parameters,
                                                   parts,
                                                   rigid_bodies,
                                                   comm);
    act();
  }



  template <int dim>
  bool
  BodyContacts<dim>::steps_are_implicit() const
  {
    return parts.front()->is_implicit();
  }



  template <int dim>
  void
  BodyContacts<dim>::set_place(ContactPoint<dim>       &point,
                               const ConstPointRef<dim> p,
                               const SurfaceState<dim> &at,
                               const PointField        *radius)
  {
    point.x         = at.x;
    point.thickness = at.is_axisymmetric ? at.x[0] : 1.;
    if (radius)
      {
        point.radius = p[radius->first];
        point.area   = p.mass();
        return;
      }
    const Tensor<1, dim> area = p.mass() * at.area_vector();
    point.area                = area.norm();
    point.normal              = area / point.area;
  }



  template <int dim>
  std::vector<ContactPoint<dim>>
  BodyContacts<dim>::collect(const Contact &contact) const
  {
    std::size_t n_points = 0;
    for (const auto &side : contact.sides)
      for (const Place &place : side)
        n_points +=
          place.part->current.surfaces[place.surface].points.n_points();
    std::vector<ContactPoint<dim>> points;
    points.reserve(n_points);
    for (unsigned int side = 0; side < 2; ++side)
      for (const Place &place : contact.sides[side])
        {
          const State<dim>   &state      = place.part->current;
          const Surface<dim> &surface    = state.surfaces[place.surface];
          const auto         &layout     = surface.points.layout();
          const unsigned int  slip       = layout.first("slip"),
                             before      = layout.first("before");
          const PointField *const radius = layout.find("radius");
          const PointField *const pore   = layout.find("pore_pressure");
          surface.points.for_each([&](const unsigned int       cell,
                                      const ConstPointRef<dim> p) {
            ContactPoint<dim> &point = points.emplace_back();
            point.side               = side;
            point.cell_size =
              contact.cell_size_at(surface.points.space(), cell, p.position());
            set_place(point, p, surface_state<dim>(p, layout), radius);
            point.slip = p.vector(slip);
            if (pore)
              point.pore_pressure = p[pore->first];
            if (state.step > 0.)
              point.motion = point.x - Point<dim>(p.vector(before));
          });
        }
    return points;
  }



  template <int dim>
  void
  BodyContacts<dim>::check(const Contact                        &contact,
                           const std::vector<ContactPoint<dim>> &points) const
  {
    const double longest =
      are_implicit ? std::numeric_limits<double>::infinity() : longest_motion;
    const bool  is_new = parts.front()->current.n_steps == 0;
    std::string problem;
    double      depth = 0.;
    const auto  add =
      [&](const std::string &what, const double way, const double cell_size) {
        if (way > longest * cell_size && problem.empty())
          {
            std::ostringstream message;
            message << what << " in 'Contact " << contact.name
                    << "' has moved by " << way
                    << " m in a step, more than a quarter of a cell: surfaces "
                       "may pass through one another. Take a shorter 'Time/"
                       "Step', or a smaller 'Time/CFL number'";
            problem = message.str();
          }
      };
    if (contact.rigid >= 0)
      {
        const RigidBodyState<dim> &body =
          parts.front()->current.rigid_bodies[contact.rigid];
        add("'Rigid body " + rigid_bodies[contact.rigid].name() + "'",
            rigid_way(contact, body.before, body.now),
            contact.smallest);
      }
    for (const ContactPoint<dim> &point : points)
      {
        const Tensor<1, dim> motion =
          point.is_facing ? point.motion - point.target_motion : point.motion;
        if (motion.norm() > longest * point.cell_size && problem.empty())
          add("a point of the surface at (" + text_of(point.x) + ") m",
              motion.norm(),
              point.cell_size);
        if (is_new && point.is_facing &&
            -point.gap > deepest_overlap * point.cell_size)
          depth = std::max(depth, -point.gap);
      }
    fail_on_all(problem, comm);
    check_sides(contact, points);
    depth = Utilities::MPI::max(depth, comm);
    AssertThrow(depth == 0.,
                ErrorOnAll("The bodies of 'Contact " + contact.name + "', <" +
                           contact.given.bodies + ">, overlap by " +
                           text_of(depth) +
                           " m at the start: leave a gap between them, or let "
                           "them touch."));
  }



  template <int dim>
  void
  BodyContacts<dim>::act()
  {
    std::vector<std::uint64_t> new_versions;
    for (const Simulation<dim> *part : parts)
      new_versions.push_back(part->current.points_version);
    set_laws();
    if (new_versions == points_versions)
      return;
    const State<dim> &state = parts.front()->current;
    const PartTimer   timer(parts.front()->log, "contact");
    passing->check();
    now.contacts.clear();
    now.rigid_bodies.clear();
    for (const RigidBodyState<dim> &body : state.rigid_bodies)
      now.rigid_bodies.push_back(body.now);
    for (Contact &contact : contacts)
      {
        check_overlaps(contact);
        // Implicit steps renew contactors at their start, see TrialContacts.
        if (contact.given.is_by_material_points() &&
            (!are_implicit || state.n_steps == 0))
          renew_contactors(contact);
        std::vector<ContactPoint<dim>> points = collect(contact);
        Point<dim>                     about;
        if (contact.rigid >= 0)
          {
            const RigidPosition<dim> &body =
              state.rigid_bodies[contact.rigid].now;
            about = current_position(body, body.reference);
          }
        find_way(contact, points);
        find_gaps(contact, points, reach_in_cells);
        check(contact, points);
        now.contacts.push_back(contact.average->act(points, state.step, about));
        if (contact.stored_energy < 0.)
          {
            double stored = 0.;
            for (const ContactPoint<dim> &point : points)
              if (point.is_facing)
                stored += point.force.norm() * std::max(-point.gap, 0.);
            contact.stored_energy = Utilities::MPI::sum(stored, comm);
          }
        // Implicit steps have already set loads and slip at their end.
        if (!are_implicit || state.n_steps == 0)
          give(contact, points);
      }
    for (unsigned int k = 0; k < parts.size(); ++k)
      new_versions[k] = parts[k]->current.points_version;
    points_versions = new_versions;
  }



  template <int dim>
  void
  BodyContacts<dim>::find_gaps(const Contact                  &contact,
                               std::vector<ContactPoint<dim>> &points,
                               const double                    reach)
  {
    if (contact.rigid < 0)
      {
        search.find_gaps(points, reach);
        for (ContactPoint<dim> &point : points)
          if (point.is_facing)
            point.offset_from_hats = -0.5 * point.gap * point.normal;
        return;
      }
    const RigidBodyState<dim> &body =
      parts.front()->current.rigid_bodies[contact.rigid];
    rigid_bodies[contact.rigid].find_gaps(points, reach, body.now, body.before);
  }



  template <int dim>
  void
  BodyContacts<dim>::give(const Contact                        &contact,
                          const std::vector<ContactPoint<dim>> &points)
  {
    auto point = points.begin();
    for (const auto &side : contact.sides)
      for (const Place &place : side)
        {
          Surface<dim> &surface   = place.part->current.surfaces[place.surface];
          const auto   &layout    = surface.points.layout();
          const unsigned int load = layout.first("load"),
                             slip = layout.first("new_slip"),
                             gap  = layout.first("gap");
          const bool              is_of_points = layout.find("radius");
          const unsigned int      normal       = layout.first("normal");
          const PointField *const pore         = layout.find("pore_pressure");
          surface.points.for_each([&](PointRef<dim> p) {
            for (unsigned int d = 0; d < dim; ++d)
              {
                p[load + d] = point->force[d] / p.mass();
                p[slip + d] = point->new_slip[d];
              }
            // Implicit steps search farther.
            const double farthest = reach_in_cells * point->cell_size;
            p[gap] =
              point->is_facing ? std::min(point->gap, farthest) : farthest;
            p[gap + 1] = double(point->state);
            if (pore)
              p[pore->first] = point->pore_pressure;
            if (is_of_points && point->is_facing)
              for (unsigned int d = 0; d < dim; ++d)
                p[normal + d] = -point->target_normal[d];
            ++point;
          });
        }
  }



  template <int dim>
  void
  BodyContacts<dim>::commit()
  {
    for (const Contact &contact : contacts)
      for (const auto &side : contact.sides)
        for (const Place &place : side)
          {
            Surface<dim> &surface = place.part->current.surfaces[place.surface];
            const auto   &layout  = surface.points.layout();
            const unsigned int slip        = layout.first("slip"),
                               after       = layout.first("new_slip"),
                               before      = layout.first("before");
            const PointField *const radius = layout.find("radius");
            const unsigned int last = radius ? layout.first("last_radius") : 0;
            surface.points.for_each([&](PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                {
                  p[slip + d]   = p[after + d];
                  p[before + d] = p.position(d);
                }
              if (radius)
                p[last] = p[radius->first];
            });
          }
  }



  template <int dim>
  RigidStep<dim>
  BodyContacts<dim>::rigid_step(const unsigned int body, const double t) const
  {
    RigidStep<dim> step;
    for (unsigned int c = 0; c < contacts.size(); ++c)
      if (contacts[c].rigid == int(body))
        {
          step.force -= now.contacts[c].force;
          step.moment -= now.contacts[c].moment;
        }
    run_or_fail(comm,
                [&]() { step.gravity = parts.front()->loads.gravity(t); });
    return step;
  }



  template <int dim>
  std::vector<RigidBodyState<dim>>
  BodyContacts<dim>::moved_bodies(const double dt) const
  {
    const State<dim>                &state     = parts.front()->current;
    std::vector<RigidBodyState<dim>> positions = state.rigid_bodies;
    for (unsigned int k = 0; k < positions.size(); ++k)
      {
        RigidStep<dim> step = rigid_step(k, state.time);
        step.t              = state.time;
        step.dt             = dt;
        step.velocity_dt    = 0.5 * (state.step + dt);
        run_or_fail(comm, [&]() {
          rigid_bodies[k].move(positions[k].now, positions[k].before, step);
        });
      }
    return positions;
  }



  template <int dim>
  void
  BodyContacts<dim>::begin_step(const double dt)
  {
    at_start = now;
    for (Contact &contact : contacts)
      contact.way += contact.last_way;
    add_to_intervals(at_start.contacts, dt);
    const auto positions = moved_bodies(dt);
    commit();
    for (Simulation<dim> *part : parts)
      part->current.rigid_bodies = positions;
  }



  template <int dim>
  void
  BodyContacts<dim>::end_step()
  {
    for (Contact &contact : contacts)
      {
        contact.way = std::numeric_limits<double>::max();
        check_overlaps(contact);
        if (contact.rigid >= 0)
          {
            auto points = collect(contact);
            find_gaps(contact, points, reach_in_cells);
            check_sides(contact, points);
          }
      }
    passing->check();
    for (unsigned int k = 0; k < parts.size(); ++k)
      points_versions[k] = parts[k]->current.points_version;
  }



  template <int dim>
  void
  BodyContacts<dim>::add_to_intervals(
    const std::vector<ContactResult<dim>> &results, const double dt)
  {
    for (unsigned int k = 0; k < contacts.size(); ++k)
      {
        ContactInterval<dim> &interval = of_interval[k];
        const Tensor<1, dim> &force    = results[k].force;
        interval.impulse += dt * force;
        interval.time += dt;
        interval.largest_force = std::max(interval.largest_force, force.norm());
      }
  }



  template <int dim>
  void
  BodyContacts<dim>::set_intervals(
    const std::vector<ContactInterval<dim>> &intervals)
  {
    of_interval = intervals;
    of_interval.resize(contacts.size());
  }



  template <int dim>
  void
  BodyContacts<dim>::add_to(Statistics<dim> &row,
                            const bool       at_start_of_step) const
  {
    const Results &results = at_start_of_step ? at_start : now;
    for (unsigned int k = 0; k < contacts.size(); ++k)
      row.contacts.push_back({contacts[k].name, results.contacts[k]});
    for (unsigned int k = 0; k < rigid_bodies.size(); ++k)
      row.rigid_bodies.push_back(
        {rigid_bodies[k].name(), results.rigid_bodies[k]});
  }



  GREVILLE_INSTANTIATE_CLASS(BodyContacts);
} // namespace greville
