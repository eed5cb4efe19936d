// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/contact/rigid_body.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points face a rigid surface if the cosine of the angle between the
    // normals is below this.
    constexpr double largest_cosine_of_rigid = -0.7;

    // Two sides of a body are opposite if the cosine of the angle between their
    // normals is below this: blades have angles of less than 25 degrees.
    constexpr double largest_cosine_of_sides = -0.9;

    // A path meets the surface if it is closer than this fraction of the reach.
    constexpr double smallest_distance = 1e-6;

    // Half the time (s) between the rotations whose difference gives the spin;
    // at the start, the whole time.
    constexpr double half_of_quotient = 1e-6;

    // The number of places per direction at which a shape of unknown extent is
    // sampled.
    template <int dim>
    constexpr unsigned int n_samples_per_direction = dim == 2 ? 16 : 8;

    // The number of lattice cells per direction for integrals over a shape.
    constexpr unsigned int n_cells_of_mass = 24;



    /// Volume, center and second moments about the center of a shape, from
    /// quadratures over its parts of the cells of a lattice.
    template <int dim>
    struct Moments
    {
      double         volume = 0.;
      Point<dim>     center;
      Tensor<2, dim> second; // int (x - c) (x - c)^T dx

      Moments(const RigidBodyParameters &parameters,
              const std::string         &section,
              const BoundingBox<dim>    &box)
      {
        MultiIndex<dim> n_cells;
        n_cells.fill(n_cells_of_mass);
        Point<dim> lower, upper;
        for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d] = box.lower_bound(d);
            upper[d] = box.upper_bound(d);
            Require(std::isfinite(lower[d]) && std::isfinite(upper[d]),
                    "'" + section +
                      "' is free and has a 'Density', but the extent of its "
                      "shape is unknown: give 'Mass' and 'Inertia'.");
            const double more = 1e-3 * (upper[d] - lower[d]);
            lower[d] -= more;
            upper[d] += more;
          }
        DistributedTriangulation<dim> mesh(MPI_COMM_SELF,
                                           Triangulation<dim>::none,
                                           mesh_settings<dim>);
        create_box_mesh<dim>(mesh, lower, upper, n_cells);
        const Lattice<dim>                lattice(mesh);
        std::unique_ptr<FittedShape<dim>> shape;
        if (parameters.shape_file.empty())
          shape = std::make_unique<LevelSetShape<dim>>(parameters.shape,
                                                       section + "/Shape");
        else
          shape = std::make_unique<SurfaceShape<dim>>(
            read_surface<dim>(parameters.shape_file,
                              section + "/Shape file",
                              parameters.shape_file_unit),
            lattice);

        const QGauss<dim> whole(2);
        Tensor<1, dim>    first;
        const auto        add = [&](const CellBox<dim> &box,
                             const Point<dim>   &xi,
                             const double        weight) {
          const double cell_volume = box.volume();
          Point<dim>   x           = box.lower;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] += xi[d] * box.size[d];
          volume += weight * cell_volume;
          first += weight * cell_volume * x;
          second += weight * cell_volume *
                    outer_product(Tensor<1, dim>(x), Tensor<1, dim>(x));
        };
        for (unsigned int cell = 0; cell < mesh.n_active_cells(); ++cell)
          {
            const CellBox<dim> box =
              lattice.box(multi_index<dim>(cell, n_cells));
            const CellPart<dim> part = shape->cut(box, 3);
            if (part.is_full)
              for (unsigned int q = 0; q < whole.size(); ++q)
                add(box, whole.point(q), whole.weight(q));
            else
              for (const auto &point : part.points)
                add(box, point.x, point.weight);
          }
        center = Point<dim>(first / volume);
        second -= volume *
                  outer_product(Tensor<1, dim>(center), Tensor<1, dim>(center));
      }
    };
  } // namespace



  template <int dim>
  RigidBody<dim>::RigidBody(const std::string         &name,
                            const RigidBodyParameters &parameters)
    : body_name(name)
    , free(parameters.is_free)
  {
    const std::string section = "Rigid body " + name;
    for (unsigned int d = 0; d < parameters.reference_point.size(); ++d)
      reference[d] = parameters.reference_point[d];
    surface =
      parameters.shape_file.empty()
        ? make_closest_surface<dim>(parameters.shape, section + "/Shape")
        : make_closest_surface<dim>(
            read_surface<dim>(parameters.shape_file,
                              section + "/Shape file",
                              parameters.shape_file_unit));
    // Throws for an empty shape.
    extent = surface->box();
    if (!parameters.velocity.empty())
      velocity = {parameters.velocity, section + "/Velocity", {"t"}};
    if (!parameters.rotation.empty())
      rotation = {parameters.rotation, section + "/Rotation", {"t"}};
    if (!free)
      return;
    mass = parameters.mass;
    for (unsigned int d = 0; d < parameters.inertia.size(); ++d)
      inertia[d][d] = parameters.inertia[d];
    if (parameters.density > 0.)
      {
        const Moments<dim> moments(parameters, section, extent);
        const double       turning = trace(moments.second);
        Require(moments.volume > 0. && turning > 0. && std::isfinite(turning),
                "'" + section +
                  "' is free and has a 'Density', but its shape is so small, "
                  "or so far away, that it has no mass or inertia in double "
                  "precision: give 'Mass' and 'Inertia'.");
        reference = moments.center;
        mass      = parameters.density * moments.volume;
        if constexpr (dim == 2)
          inertia[0][0] = parameters.density * trace(moments.second);
        else
          inertia = parameters.density *
                    (trace(moments.second) *
                       Tensor<2, dim>(unit_symmetric_tensor<dim>()) -
                     moments.second);
      }
  }



  template <int dim>
  RigidPosition<dim>
  RigidBody<dim>::position_at_start(const double t) const
  {
    Require(rotation.is_zero() || rotation(t).norm() == 0.,
            "The parameter 'Rigid body " + body_name +
              "/Rotation' is not zero at the start, t = " + text_of(t) +
              " s: 'Shape' gives the initial orientation.");
    RigidPosition<dim> position;
    position.reference = reference;
    if (free)
      position.velocity = velocity(t);
    else
      follow(position, t, 0.);
    return position;
  }



  template <int dim>
  void
  RigidBody<dim>::follow(RigidPosition<dim> &position,
                         const double        t,
                         const double        dt) const
  {
    const QGauss<1> quadrature(3);
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      position.displacement +=
        dt * quadrature.weight(q) * velocity(t + dt * quadrature.point(q)[0]);
    position.velocity = velocity(t + dt);
    if (rotation.is_zero())
      return;
    position.rotation = rotation_matrix<dim>(rotation(t + dt));
    // dR / dt R^T is the cross product with the spin. The formula may have no
    // value before the start.
    const double         before = std::min(half_of_quotient, dt);
    const Tensor<2, dim> rate =
      (rotation_matrix<dim>(rotation(t + dt + half_of_quotient)) -
       rotation_matrix<dim>(rotation(t + dt - before))) *
      transpose(position.rotation) / (half_of_quotient + before);
    if constexpr (dim == 2)
      position.spin[0] = 0.5 * (rate[1][0] - rate[0][1]);
    else
      for (unsigned int d = 0; d < 3; ++d)
        position.spin[d] = 0.5 * (rate[(d + 2) % 3][(d + 1) % 3] -
                                  rate[(d + 1) % 3][(d + 2) % 3]);
  }



  template <int dim>
  Tensor<2, dim == 2 ? 1 : 3>
  RigidBody<dim>::current_inertia(const RigidPosition<dim> &position) const
  {
    if constexpr (dim == 2)
      return inertia;
    else
      return position.rotation * inertia * transpose(position.rotation);
  }



  template <int dim>
  void
  RigidBody<dim>::move(RigidPosition<dim>   &now,
                       RigidPosition<dim>   &before,
                       const RigidStep<dim> &step) const
  {
    const RigidPosition<dim> last = now;
    if (!free)
      follow(now, step.t, step.dt);
    else
      {
        // The angular momentum belongs to the rotation at which the spin was
        // computed.
        const RotationVector<dim> angular_momentum =
          current_inertia(before) * now.spin + step.velocity_dt * step.moment;
        now.spin = invert(current_inertia(now)) * angular_momentum;
        now.velocity += step.velocity_dt * (step.force / mass + step.gravity);
        now.displacement += step.dt * now.velocity;
        rotate(now, step.dt);
      }
    before = last;
  }



  template <int dim>
  void
  RigidBody<dim>::find_gaps(std::vector<ContactPoint<dim>> &points,
                            const double                    reach,
                            const RigidPosition<dim>       &now,
                            const RigidPosition<dim>       &before) const
  {
    for (ContactPoint<dim> &point : points)
      {
        point.is_facing = false;
        point.distance  = std::numeric_limits<double>::infinity();
        // Shape and distances rotate with the body.
        const auto closest = surface->closest(initial_position(now, point.x),
                                              reach * point.cell_size);
        if (!closest)
          continue;
        point.distance              = closest->distance;
        const Tensor<1, dim> normal = now.rotation * closest->normal;
        if (point.normal.norm_square() > 0. &&
            normal * point.normal > largest_cosine_of_rigid)
          continue;
        point.is_facing     = true;
        point.gap           = closest->distance - point.radius;
        point.target_normal = normal;
        point.target_motion = current_position(now, closest->point) -
                              current_position(before, closest->point);
      }
  }



  template <int dim>
  bool
  RigidBody<dim>::is_crossed_by(const ContactPoint<dim>  &point,
                                const double              reach_in_cells,
                                const RigidPosition<dim> &now,
                                const RigidPosition<dim> &before) const
  {
    const double     reach = reach_in_cells * point.cell_size;
    const Point<dim> start = initial_position(before, point.x - point.motion);
    const Point<dim> end   = initial_position(now, point.x);
    const Tensor<1, dim> motion = end - start;
    const double         length = motion.norm();
    if (point.distance > length)
      return false;
    const auto last = surface->closest(end, reach);
    if (!last || motion * last->normal <= 0.)
      return false;
    // Find the place of entry by steps up to the distance to the surface.
    auto   first = surface->closest(start, reach);
    double way   = 0.;
    while (first && first->distance > smallest_distance * reach && way < length)
      {
        way += first->distance;
        first = surface->closest(start + way / length * motion, reach);
      }
    return first && way < length &&
           first->normal * last->normal < largest_cosine_of_sides;
  }



  template <int dim>
  bool
  RigidBody<dim>::may_be_near(const BoundingBox<dim>   &region,
                              const double              margin,
                              const RigidPosition<dim> &now) const
  {
    if (std::isfinite(extent.lower_bound(0)))
      {
        std::vector<Point<dim>> corners;
        for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell; ++v)
          corners.push_back(initial_position(now, region.vertex(v)));
        const BoundingBox<dim> box(corners);
        for (unsigned int d = 0; d < dim; ++d)
          if (extent.lower_bound(d) > box.upper_bound(d) + margin ||
              extent.upper_bound(d) < box.lower_bound(d) - margin)
            return false;
        return true;
      }
    Tensor<1, dim>  size;
    MultiIndex<dim> n;
    n.fill(n_samples_per_direction<dim>);
    for (unsigned int d = 0; d < dim; ++d)
      size[d] = region.side_length(d) / n[d];
    const double within = 0.5 * size.norm() + margin;
    try
      {
        for (unsigned int k = 0;
             k < Utilities::pow(n_samples_per_direction<dim>, dim);
             ++k)
          {
            const auto index = multi_index<dim>(k, n);
            Point<dim> x;
            for (unsigned int d = 0; d < dim; ++d)
              x[d] = region.lower_bound(d) + (index[d] + 0.5) * size[d];
            x = initial_position(now, x);
            if (surface->contains(x) || surface->closest(x, within))
              return true;
          }
      }
    catch (const ExceptionBase &)
      {
        // The formula has no value at this place, which may therefore be near.
        return true;
      }
    return false;
  }



  template <int dim>
  double
  RigidBody<dim>::way(const RigidPosition<dim> &before,
                      const RigidPosition<dim> &now,
                      const BoundingBox<dim>   &region) const
  {
    const bool is_open = !std::isfinite(extent.lower_bound(0));
    double     longest = 0.;
    for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell; ++v)
      {
        const Point<dim> X =
          is_open ? initial_position(now, region.vertex(v)) : extent.vertex(v);
        longest = std::max(longest,
                           current_position(now, X).distance(
                             current_position(before, X)));
      }
    return longest;
  }



  template <int dim>
  const ClosedSurface<dim> &
  RigidBody<dim>::mesh(const RigidPosition<dim> &now,
                       const BoundingBox<dim>   &region) const
  {
    std::vector<Point<dim>> corners;
    for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_cell; ++v)
      corners.push_back(initial_position(now, region.vertex(v)));
    const BoundingBox<dim> box(corners);
    if (last_mesh.empty())
      has_end = std::isfinite(extent.lower_bound(0));
    if (last_mesh.empty() || (!has_end && !(box == last_region)))
      last_mesh = surface->mesh(box);
    last_region = box;
    return last_mesh;
  }



  GREVILLE_INSTANTIATE_CLASS(RigidBody);
} // namespace greville
