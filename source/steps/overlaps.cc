// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/step_errors.h>
#include <greville/contact/overlap.h>
#include <greville/geometry/closest_surface.h>
#include <greville/geometry/shape.h>
#include <greville/steps/body_contacts.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Of the larger cell size: how deep a point of a body may be inside of
    // another one, at the start and later; and the way after which the later
    // check is made again.
    constexpr double deepest_of_added = 0.05, deepest_later = 0.5,
                     way_between_checks = 0.25;

    // Overlap::excess of bodies that overlap by half of a cell, beyond the
    // first one: points that fill cells stick out of their shape by part of a
    // spacing.
    constexpr double largest_excess = 0.3;

    // Halvings of the interval in which the depth of a point is looked for.
    constexpr unsigned int n_bisections = 20;

    template <int dim>
    using Inside = std::function<bool(const Point<dim> &x)>;



    /**
     * Return whether the points at a distance from x, along the axes and the
     * diagonals, are all inside, and x itself.
     */
    template <int dim>
    bool
    is_deep(const Inside<dim> &is_inside,
            const Point<dim>  &x,
            const double       distance)
    {
      if (!is_inside(x))
        return false;
      constexpr unsigned int n_directions = dim == 2 ? 9 : 27;
      for (unsigned int k = 0; k < n_directions; ++k)
        {
          Tensor<1, dim> direction;
          for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
            direction[d] = double(rest % 3) - 1.;
          if (direction.norm_square() > 0. &&
              !is_inside(x + distance / direction.norm() * direction))
            return false;
        }
      return true;
    }



    /**
     * Return the depth (m) of a point, at least @p least: larger values are
     * found, 0 stands for all smaller ones.
     */
    template <int dim>
    double
    depth_of(const Inside<dim> &is_inside,
             const Point<dim>  &x,
             const double       least)
    {
      if (!is_deep<dim>(is_inside, x, least))
        return 0.;
      constexpr double largest_ratio = 1e6;
      double           low = least, high = 2. * least;
      for (; is_deep<dim>(is_inside, x, high) && high < largest_ratio * least;
           high *= 2.)
        low = high;
      for (unsigned int k = 0; k < n_bisections; ++k)
        (is_deep<dim>(is_inside, x, 0.5 * (low + high)) ? low : high) =
          0.5 * (low + high);
      return low;
    }



    /**
     * Return what tells whether a place is inside of the initial shape of a
     * body.
     */
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



    /**
     * Return the same for axisymmetric bodies, which go on beyond the axis.
     */
    template <int dim>
    Inside<dim>
    mirrored(const Inside<dim> &is_inside, const bool is_axisymmetric)
    {
      if (!is_axisymmetric)
        return is_inside;
      return [is_inside](Point<dim> x) {
        x[0] = std::abs(x[0]);
        return is_inside(x);
      };
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
          // Bodies of contacts are there in all stages.
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
    const double      allowed         = deepest_of_added * contact.cell_size;
    const Body<dim>  &body            = body_of(place);
    const bool        is_axisymmetric = body.points.layout().is_axisymmetric();
    double            depth           = 0.;
    const auto        look            = [&](const Inside<dim>   &is_inside,
                          MaterialPoints<dim> &points) {
      points.for_each([&](const unsigned int, const ConstPointRef<dim> p) {
        depth = std::max(depth,
                         depth_of<dim>(is_inside,
                                       p.position(),
                                       std::max(allowed, depth)));
      });
    };
    const auto look_at_place = [&](const Inside<dim> &is_inside, Place &at) {
      look(is_inside, body_of(at).points);
      look(is_inside, at.part->current.surfaces[at.surface].points);
    };
    run_on_all(
      [&]() {
        if (contact.rigid >= 0)
          {
            const RigidBody<dim>     &rigid = rigid_bodies[contact.rigid];
            const RigidPosition<dim> &now =
              state.rigid_bodies[contact.rigid].now;
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
      },
      comm);
    depth = Utilities::MPI::max(depth, comm);
    std::ostringstream text;
    text.precision(3);
    text << depth;
    AssertThrow(depth <= 1.001 * allowed,
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
    const double          depth = deepest_later * contact.cell_size;
    const RigidBody<dim> &rigid = rigid_bodies[contact.rigid];
    const auto &now = parts.front()->current.rigid_bodies[contact.rigid].now;
    std::string problem;
    for (Place &place : contact.sides[0])
      {
        const Body<dim>  &body      = body_of(place);
        const Inside<dim> is_inside = mirrored<dim>(
          [&](const Point<dim> &x) { return rigid.contains(x, now); },
          body.points.layout().is_axisymmetric());
        const auto look = [&](const ConstPointRef<dim> p) {
          if (!problem.empty() || !is_deep<dim>(is_inside, p.position(), depth))
            return;
          std::ostringstream text;
          text << "a point of 'Body " << body.name << "' at (" << p.position()
               << ") m is inside of 'Rigid body " << rigid.name() << "'";
          problem = text.str();
        };
        // Cells of total Lagrangian points are not where the points are.
        if (body.points.layout().is_total_lagrangian())
          body.points.for_each(
            [&](const unsigned int, const ConstPointRef<dim> p) { look(p); });
        else
          for (const NearCell &cell : near_cells(contact, place, -depth))
            body.points.for_each_in_cell(cell.cell, look);
      }
    return first_of_all(problem, comm);
  }



  template <int dim>
  std::string
  BodyContacts<dim>::find_inside_of_body(Contact &contact) const
  {
    // The boxes around both sides, as the largest -x and x.
    constexpr double    none = std::numeric_limits<double>::lowest();
    std::vector<double> extremes(4 * dim, none);
    for (unsigned int side = 0; side < 2; ++side)
      for (Place &place : contact.sides[side])
        body_of(place).points.for_each(
          [&](const unsigned int, const ConstPointRef<dim> p) {
            double *const of_side = &extremes[2 * side * dim];
            for (unsigned int d = 0; d < dim; ++d)
              {
                of_side[d]       = std::max(of_side[d], -p.position(d));
                of_side[dim + d] = std::max(of_side[dim + d], p.position(d));
              }
          });
    Utilities::MPI::max(extremes, comm, extremes);
    Point<dim> lower, upper; // of what they have in common
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = -std::min(extremes[d], extremes[2 * dim + d]);
        upper[d] = std::min(extremes[dim + d], extremes[3 * dim + d]);
        if (lower[d] >= upper[d])
          return "";
      }
    // Around it by what the fractions of a place depend on.
    double                        size    = 0.; // of points, and their number
    Tensor<1, dim>                h       = contact.cell_sizes;
    double                        sums[2] = {};
    const Point<dim>              low = lower - 2. * h, high = upper + 2. * h;
    std::vector<VolumePoint<dim>> points;
    std::vector<std::string>      names;
    for (unsigned int side = 0; side < 2; ++side)
      for (Place &place : contact.sides[side])
        {
          const Body<dim> &body = body_of(place);
          body.points.for_each(
            [&](const unsigned int, const ConstPointRef<dim> p) {
              VolumePoint<dim> point;
              point.x = p.position();
              for (unsigned int d = 0; d < dim; ++d)
                if (point.x[d] < low[d] || point.x[d] > high[d])
                  return;
              const double extent = p.extent(body.points.layout());
              point.volume        = std::pow(extent, dim);
              point.side          = side;
              point.body          = names.size();
              points.push_back(point);
              sums[0] += extent;
              sums[1] += 1.;
            });
          names.push_back(body.name);
        }
    Utilities::MPI::sum(ArrayView<const double>(sums, 2),
                        comm,
                        ArrayView<double>(sums, 2));
    if (sums[1] == 0.)
      return "";
    size = sums[0] / sums[1];
    for (unsigned int d = 0; d < dim; ++d)
      h[d] = std::max(h[d], 2. * size);
    const Overlap<dim> overlap = largest_overlap(points, h, comm);
    if (!contact.is_checked)
      contact.first_excess = std::min(overlap.excess, largest_excess);
    if (overlap.excess <= largest_excess + contact.first_excess)
      return "";
    std::ostringstream text;
    text << "a point of 'Body " << names[overlap.body] << "' at (" << overlap.x
         << ") m is inside of ";
    for (unsigned int k = 0; k < contact.sides[1 - overlap.side].size(); ++k)
      text << (k == 0 ? "'Body " : " or 'Body ")
           << body_of(contact.sides[1 - overlap.side][k]).name << "'";
    return text.str();
  }



  template <int dim>
  void
  BodyContacts<dim>::check_overlaps(Contact &contact)
  {
    const auto added = added_places(contact);
    for (const auto &[side, place] : added)
      check_added(contact, side, *place);
    if (contact.is_checked && added.empty() &&
        contact.way < way_between_checks * contact.cell_size)
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
                  "' has not held them apart. Take a shorter 'Time/Step' (or a "
                  "smaller 'Time/CFL number'), a larger 'Contact " +
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
    const Lattice<dim> &lattice = contact.sides[0][0].part->space().lattice();
    Point<dim>          lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = lattice.lower(d);
        upper[d] = lattice.upper(d);
      }
    return rigid_bodies[contact.rigid].way(before,
                                           now,
                                           BoundingBox<dim>({lower, upper}));
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
        std::max(of_sides[point.side], point.motion.norm());
    Utilities::MPI::max(of_sides, comm, of_sides);
    double way = of_sides[0] + of_sides[1];
    if (contact.given.is_by_material_points())
      way =
        std::max(way,
                 state.step * contact.cell_size * state.signals.crossing_rate);
    if (contact.rigid >= 0)
      {
        const RigidBodyState<dim> &body = state.rigid_bodies[contact.rigid];
        way += rigid_way(contact, body.before, body.now);
      }
    contact.speed    = state.step > 0. ? way / state.step : 0.;
    contact.last_way = way;
  }



  template <int dim>
  double
  BodyContacts<dim>::bounded_step(double dt) const
  {
    constexpr unsigned int n_trials = 20;
    for (unsigned int k = 0; k < n_trials; ++k)
      {
        const auto positions = moved_bodies(dt);
        double     share     = 0.; // of what is allowed
        for (const Contact &contact : contacts)
          {
            double way = contact.speed * dt;
            if (contact.rigid >= 0)
              {
                const auto &body = positions[contact.rigid];
                way = std::max(way, rigid_way(contact, body.before, body.now));
              }
            share = std::max(share, way / (longest_motion * contact.cell_size));
          }
        if (share <= 1.)
          break;
        dt *= 0.9 / share;
      }
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
      if (problem.empty() &&
          rigid.lets_through(point,
                             farthest_gap_in_cells * contact.cell_size,
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
  BodyContacts<2>::bounded_step(double) const;
  template double
  BodyContacts<3>::bounded_step(double) const;
} // namespace greville
