// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/surface.h>

#include "formula_gradient.h"
#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  SurfaceState<dim>
  surface_state(const ConstPointRef<dim> p, const PointLayout<dim> &layout)
  {
    SurfaceState<dim> state;
    state.X        = p.reference();
    state.x        = p.position();
    state.F        = p.matrix(PointLayout<dim>::F);
    state.velocity = p.velocity();
    // Material points in contact already store their current area as mass.
    state.is_axisymmetric = layout.is_axisymmetric() && !layout.find("radius");
    if (const PointField *normal = layout.find("normal"))
      state.normal = p.vector(normal->first);
    return state;
  }



  namespace
  {
    /// Collective. Return the message for a surface without points.
    template <int dim>
    std::string
    no_point(const std::string                    &section,
             const std::string                    &where,
             const std::string                    &body,
             const std::vector<SurfacePoint<dim>> &placed,
             const MPI_Comm                        comm)
    {
      Point<dim> lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = std::numeric_limits<double>::max();
          upper[d] = std::numeric_limits<double>::lowest();
          for (const SurfacePoint<dim> &point : placed)
            {
              lower[d] = std::min(lower[d], point.x[d]);
              upper[d] = std::max(upper[d], point.x[d]);
            }
          lower[d] = Utilities::MPI::min(lower[d], comm);
          upper[d] = Utilities::MPI::max(upper[d], comm);
        }
      std::ostringstream message;
      if (!(lower[0] <= upper[0]))
        message << "'" << section << "' acts on the surface of 'Body " << body
                << "', but the body has no surface in the grid.";
      else
        message << "The parameter '" << section << "/Where' is <" << where
                << ">: no point of the surface of 'Body " << body
                << "' is in it. Its points are between (" << lower
                << ") m and (" << upper << ") m.";
      return message.str();
    }



    /// Return a surface without points.
    template <int dim>
    Surface<dim>
    empty_surface(const std::string      &name,
                  const std::string      &contact,
                  const bool              is_of_points,
                  const Body<dim>        &body,
                  const SplineSpace<dim> &space)
    {
      PointLayout<dim> layout;
      layout.basis_position = body.points.layout().basis_position;
      layout.add("load", dim);
      layout.add("normal", dim);
      if (body.points.layout().is_axisymmetric())
        layout.add("radius0", 1);
      if (is_of_points)
        for (const std::string field : {"radius", "last_radius"})
          layout.add(field, 1);
      for (const std::string field : {"slip", "new_slip", "before"})
        if (!contact.empty())
          layout.add(field, dim);
      for (const std::string field : {"gap", "state"})
        if (!contact.empty())
          layout.add(field, 1);
      if (!contact.empty() && body.points.layout().find("pore_pressure"))
        layout.add("pore_pressure", 1);
      Surface<dim> surface;
      surface.name    = name;
      surface.contact = contact;
      surface.points.reinit(space, layout);
      return surface;
    }
  } // namespace



  template <int dim>
  Surface<dim>
  make_surface(const std::string                    &name,
               const std::string                    &section,
               const std::string                    &where,
               const Body<dim>                      &body,
               const std::vector<SurfacePoint<dim>> &placed,
               const SplineSpace<dim>               &space,
               const std::string                    &contact)
  {
    Surface<dim> surface = empty_surface(name, contact, false, body, space);
    const PointLayout<dim> layout = surface.points.layout();
    run_on_all(space.communicator(), [&]() {
      const std::string of_body = "Body " + body.name;
      const auto        displacement =
        initial_formulas<dim>(body.parameters->displacement,
                              of_body + "/Displacement");
      const auto velocity =
        initial_formulas<dim>(body.parameters->velocity, of_body + "/Velocity");
      const auto                steps = displacement_steps<dim>(space);
      std::optional<Shape<dim>> shape;
      if (!where.empty())
        shape.emplace(where, section + "/Where");

      std::vector<double> values(layout.size);
      const PointRef<dim> p(values.data());
      const unsigned int  normal = layout.first("normal");
      for (const SurfacePoint<dim> &point : placed)
        {
          if (shape && !shape->contains(point.x))
            continue;
          std::fill(values.begin(), values.end(), 0.);
          Tensor<2, 3>         F = unit_symmetric_tensor<3>();
          Tensor<1, dim>       x = point.x;
          const Tensor<1, dim> v = velocity(point.x);
          if (!displacement.is_zero())
            {
              F += gradient_of<dim>(displacement, point.x, steps);
              x += displacement(point.x);
            }
          for (unsigned int d = 0; d < dim; ++d)
            {
              p.position(d)  = x[d];
              p.reference(d) = point.x[d];
              p.velocity(d)  = v[d];
              p[normal + d]  = point.normal[d];
            }
          if (layout.is_axisymmetric())
            {
              p[layout.radius0] = point.x[0];
              F[2][2]           = x[0] / point.x[0];
            }
          p.mass() = point.area * layout.thickness(point.x);
          p.J()    = determinant(F);
          p.id()   = double(point.id);
          p.set_F(F);
          surface.points.insert(point.cell, make_array_view(values));
        }
    });
    surface.points.defragment();
    const MPI_Comm comm = space.communicator();
    if (Utilities::MPI::sum<std::uint64_t>(surface.points.n_points(), comm) ==
        0)
      Require(false, no_point(section, where, body.name, placed, comm));
    return surface;
  }



  template <int dim>
  Surface<dim>
  make_contactors(const std::string      &name,
                  const std::string      &contact,
                  const Body<dim>        &body,
                  const SplineSpace<dim> &space)
  {
    return empty_surface(name, contact, true, body, space);
  }



  GREVILLE_INSTANTIATE(surface_state);
  GREVILLE_INSTANTIATE(make_surface);
  GREVILLE_INSTANTIATE(make_contactors);
} // namespace greville
