// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>
#include <greville/steps/overlap_of_bodies.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Multiples of the cell size: the largest depth of a point inside
    // another body at the start, and the motion after which points inside are
    // checked again.
    constexpr double deepest_of_added = 0.05, way_between_checks = 0.25;

    // Number of bisections for the depth of a point.
    constexpr unsigned int n_bisections = 20;



    /// Return the depth (m) of a point, or 0 if it is less than
    /// @p smallest_depth.
    template <int dim>
    double
    depth_of(const Inside<dim> &is_inside,
             const Point<dim>  &x,
             const double       smallest_depth)
    {
      if (!is_deep<dim>(is_inside, x, smallest_depth))
        return 0.;
      constexpr double largest_ratio = 1e6;
      double           low = smallest_depth, high = 2. * smallest_depth;
      for (; is_deep<dim>(is_inside, x, high) &&
             high < largest_ratio * smallest_depth;
           high *= 2.)
        low = high;
      for (unsigned int k = 0; k < n_bisections; ++k)
        (is_deep<dim>(is_inside, x, 0.5 * (low + high)) ? low : high) =
          0.5 * (low + high);
      return low;
    }



    /// Return a function that tells whether a position is inside of the initial
    /// shape of a body.
    template <int dim>
    Inside<dim>
    inside_of_shape(const BodyParameters &parameters, const std::string &name)
    {
      const std::string section = "Body " + name;
      if (!parameters.shape.empty())
        {
          const auto shape =
            std::make_shared<Shape<dim>>(parameters.shape, section + "/Shape");
          return [shape](const Point<dim> &x) { return shape->contains(x); };
        }
      const std::shared_ptr<ClosestSurface<dim>> surface =
        make_closest_surface<dim>(
          read_surface<dim>(parameters.shape_file,
                            section + "/Shape file",
                            parameters.shape_file_unit));
      return [surface](const Point<dim> &x) { return surface->contains(x); };
    }
  } // namespace



  template <int dim>
  std::vector<std::pair<unsigned int, typename BodyContacts<dim>::Place *>>
  BodyContacts<dim>::added_places(Contact &contact) const
  {
    const bool is_start = parts.front()->current.n_steps == 0;
    std::vector<std::pair<unsigned int, Place *>> added;
    for (unsigned int side = 0; side < 2; ++side)
      for (Place &place : contact.sides[side])
        {
          if (place.is_known || body_of(place).n_points == 0)
            continue;
          // Bodies of contacts exist in all stages.
          if (is_start)
            added.emplace_back(side, &place);
          place.is_known = true;
        }
    return added;
  }



  template <int dim>
  void
  BodyContacts<dim>::check_added(Contact           &contact,
                                 const unsigned int side,
                                 Place             &place) const
  {
    const State<dim> &state           = parts.front()->current;
    const Body<dim>  &body            = body_of(place);
    const bool        is_axisymmetric = body.points.layout().is_axisymmetric();
    double            depth           = 0.;
    const auto        look = [&](const Inside<dim>         &is_inside,
                          const MaterialPoints<dim> &points) {
      points.for_each([&](const unsigned int cell, const ConstPointRef<dim> p) {
        const double allowed =
          deepest_of_added *
          contact.cell_size_at(points.space(), cell, p.position());
        const double of_point =
          depth_of<dim>(is_inside, p.position(), std::max(allowed, depth));
        if (of_point > 1.001 * allowed)
          depth = std::max(depth, of_point);
      });
    };
    const auto look_at_place = [&](const Inside<dim> &is_inside, Place &at) {
      look(is_inside, body_of(at).points);
      look(is_inside, at.part->current.surfaces[at.surface].points);
    };
    run_on_all(comm, [&]() {
      if (contact.rigid >= 0)
        {
          const RigidBody<dim>     &rigid = rigid_bodies[contact.rigid];
          const RigidPosition<dim> &now = state.rigid_bodies[contact.rigid].now;
          look_at_place(mirrored<dim>(
                          [&](const Point<dim> &x) {
                            return rigid.contains(x, now);
                          },
                          is_axisymmetric),
                        place);
        }
      const BodyParameters &parameters = *body.parameters;
      if (!parameters.displacement.empty() ||
          (parameters.shape.empty() && parameters.shape_file.empty()))
        return;
      const Inside<dim> is_inside =
        mirrored<dim>(inside_of_shape<dim>(parameters, body.name),
                      is_axisymmetric);
      for (Place &other : contact.sides[1 - side])
        look_at_place(is_inside, other);
    });
    depth = Utilities::MPI::max(depth, comm);
    std::ostringstream text;
    text.precision(3);
    text << depth;
    AssertThrow(depth == 0.,
                ErrorOnAll("The bodies of 'Contact " + contact.name + "', <" +
                           contact.given.bodies + ">, overlap by " +
                           text.str() +
                           " m at the start: leave a gap between them, or let "
                           "them touch."));
  }



  template <int dim>
  std::string
  BodyContacts<dim>::find_inside_of_rigid(Contact &contact)
  {
    const RigidBody<dim> &rigid = rigid_bodies[contact.rigid];
    const auto &now = parts.front()->current.rigid_bodies[contact.rigid].now;
    std::string problem;
    for (Place &place : contact.sides[0])
      {
        const Body<dim>  &body      = body_of(place);
        const Inside<dim> is_inside = mirrored<dim>(
          [&](const Point<dim> &x) { return rigid.contains(x, now); },
          body.points.layout().is_axisymmetric());
        const MaterialPoints<dim> &points = body.points;
        const auto                 look   = [&](const unsigned int       cell,
                              const ConstPointRef<dim> p) {
          const double h =
            contact.cell_size_at(points.space(), cell, p.position());
          if (!problem.empty() ||
              !is_deep<dim>(is_inside, p.position(), half_of_cell * h))
            return;
          problem = inside_text(body,
                                p.position(),
                                "'Rigid body " + rigid.name() + "'");
        };
        // In total Lagrangian steps, points are stored by initial cells.
        if (points.layout().is_total_lagrangian())
          points.for_each(look);
        else
          for (const NearCell &near :
               near_cells(contact, place, [](const unsigned int) {
                 return -half_of_cell;
               }))
            points.for_each_in_cell(near.cell, [&](const ConstPointRef<dim> p) {
              look(near.cell, p);
            });
      }
    return first_of_all(problem, comm);
  }



  template <int dim>
  std::string
  BodyContacts<dim>::find_inside_of_body(Contact &contact) const
  {
    Sides<dim> sides;
    for (unsigned int side = 0; side < 2; ++side)
      for (const Place &place : contact.sides[side])
        sides[side].push_back(&body_of(place));
    const Overlap<dim> overlap =
      overlap_of_bodies(sides, contact.lattices, comm);
    if (!contact.is_checked)
      contact.first_excess = std::min(overlap.excess, half_of_cell_as_excess);
    if (overlap.excess <= half_of_cell_as_excess + contact.first_excess)
      return "";
    return overlap_text(sides, overlap);
  }



  template <int dim>
  void
  BodyContacts<dim>::check_overlaps(Contact &contact)
  {
    const auto added = added_places(contact);
    for (const auto &[side, place] : added)
      check_added(contact, side, *place);
    if (contact.is_checked && added.empty() && contact.way < way_between_checks)
      return;
    contact.way               = 0.;
    const std::string problem = contact.rigid >= 0
                                  ? find_inside_of_rigid(contact)
                                  : find_inside_of_body(contact);
    contact.is_checked        = true;
    if (problem.empty())
      return;
    const std::string message = problem + " by more than half of a cell";
    AssertThrow(parts.front()->current.n_steps > 0,
                ErrorOnAll("At the start " + message + " in 'Contact " +
                           contact.name +
                           "': leave a gap between them, or let them touch."));
    fail_on_all(message + ": 'Contact " + contact.name +
                  "' has not kept them apart. Take a shorter 'Time/Step' (or "
                  "a smaller 'Time/CFL number'), a larger 'Contact " +
                  contact.name +
                  "/Penalty', or more 'Points per direction' of the bodies",
                comm);
  }



  template <int dim>
  double
  BodyContacts<dim>::rigid_way(const Contact            &contact,
                               const RigidPosition<dim> &before,
                               const RigidPosition<dim> &now) const
  {
    const SplineSpace<dim> &space = contact.sides[0][0].part->space();
    return rigid_bodies[contact.rigid].way(
      before,
      now,
      BoundingBox<dim>({space.lower_corner(), space.upper_corner()}));
  }



  template <int dim>
  void
  BodyContacts<dim>::find_way(
    Contact &contact, const std::vector<ContactPoint<dim>> &points) const
  {
    const State<dim>   &state = parts.front()->current;
    std::vector<double> of_sides(2, 0.);
    for (const ContactPoint<dim> &point : points)
      of_sides[point.side] =
        std::max(of_sides[point.side], point.motion.norm() / point.cell_size);
    Utilities::MPI::max(of_sides, comm, of_sides);
    double way = of_sides[0] + of_sides[1];
    if (contact.given.is_by_material_points())
      way = std::max(way, state.step * state.signals.crossing_rate);
    if (contact.rigid >= 0)
      {
        const RigidBodyState<dim> &body = state.rigid_bodies[contact.rigid];
        way += rigid_way(contact, body.before, body.now) / contact.smallest;
      }
    contact.speed    = state.step > 0. ? way / state.step : 0.;
    contact.last_way = way;
  }



  template <int dim>
  double
  BodyContacts<dim>::bounded_step(const double longest) const
  {
    constexpr unsigned int n_trials = 20;
    double                 dt       = longest;
    std::string            fastest; // contact
    for (unsigned int k = 0; k < n_trials; ++k)
      {
        const auto positions = moved_bodies(dt);
        double     share     = 0.; // of the allowed motion
        for (const Contact &contact : contacts)
          {
            double way = contact.speed * dt;
            if (contact.rigid >= 0)
              {
                const auto &body = positions[contact.rigid];
                way              = std::max(way,
                               rigid_way(contact, body.before, body.now) /
                                 contact.smallest);
              }
            const double own = way / longest_motion;
            if (own > share)
              fastest = contact.name;
            share = std::max(share, own);
          }
        if (share <= 1.)
          break;
        dt *= 0.9 / share;
      }
    const Simulation<dim> &part  = *parts.front();
    const double           first = part.current.estimates.first_step,
                 smallest_step   = part.stage_parameters().time.smallest_step;
    fail_on_all(
      dt < longest && dt < smallest_step * first
        ? "both sides of 'Contact " + fastest +
            "' move so fast relative to one another that the step is " +
            text_of(dt) + " s, below " + text_of(smallest_step) +
            " of the first one, " + text_of(first) +
            " s: in a step they move by a quarter of a cell at most"
        : "",
      comm);
    return dt;
  }



  template <int dim>
  void
  BodyContacts<dim>::check_sides(
    const Contact &contact, const std::vector<ContactPoint<dim>> &points) const
  {
    if (contact.rigid < 0)
      return;
    const RigidBody<dim>      &rigid = rigid_bodies[contact.rigid];
    const RigidBodyState<dim> &body =
      parts.front()->current.rigid_bodies[contact.rigid];
    std::string problem;
    for (const ContactPoint<dim> &point : points)
      if (problem.empty() && rigid.is_crossed_by(point,
                                                 farthest_gap_in_cells,
                                                 body.now,
                                                 body.before))
        problem = "a point of the surface at (" + text_of(point.x) +
                  ") m has passed through 'Rigid body " + rigid.name() +
                  "' in 'Contact " + contact.name +
                  "': the body is too thin for the depth of the contact. Make "
                  "it thicker, at least half of a cell, or take a larger "
                  "'Contact " +
                  contact.name + "/Penalty'";
    fail_on_all(problem, comm);
  }



  template void
  BodyContacts<2>::check_sides(const Contact &,
                               const std::vector<ContactPoint<2>> &) const;
  template void
  BodyContacts<3>::check_sides(const Contact &,
                               const std::vector<ContactPoint<3>> &) const;
  template void
  BodyContacts<2>::check_overlaps(Contact &);
  template void
  BodyContacts<3>::check_overlaps(Contact &);
  template void
  BodyContacts<2>::find_way(Contact &,
                            const std::vector<ContactPoint<2>> &) const;
  template void
  BodyContacts<3>::find_way(Contact &,
                            const std::vector<ContactPoint<3>> &) const;
  template double
  BodyContacts<2>::rigid_way(const Contact &,
                             const RigidPosition<2> &,
                             const RigidPosition<2> &) const;
  template double
  BodyContacts<3>::rigid_way(const Contact &,
                             const RigidPosition<3> &,
                             const RigidPosition<3> &) const;
  template double
  BodyContacts<2>::bounded_step(const double) const;
  template double
  BodyContacts<3>::bounded_step(const double) const;
} // namespace greville
