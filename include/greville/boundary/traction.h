// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_boundary_traction_h
#define greville_boundary_traction_h

#include <greville/boundary/point_load.h>
#include <greville/geometry/shape.h>

#include <limits>
#include <sstream>

namespace greville
{
  /**
   * The traction s(x, X, t), Pa, on a surface of area A: a dead load on the
   * points in a shape, each of which has the part of A that its V0 has of the
   * volume of all of them. Points keep their area over their mass, m^2 / kg.
   */
  template <int dim>
  class Traction : public PointLoad<dim>
  {
  public:
    static PointLoads<dim>
    make(const SimulationParameters &parameters)
    {
      PointLoads<dim> result;
      for (const std::string &name : parameters.general.tractions)
        result.push_back(
          std::make_unique<Traction>(name, parameters.tractions.at(name)));
      return result;
    }

    Traction(const std::string &name, const TractionParameters &parameters)
      : section("Traction " + name)
      , parameters(parameters)
      , traction(parameters.traction, section + "/Traction")
    {}

    std::string
    parameter_names() const override
    {
      return "'" + section + "/Traction' with '" + section + "/Area'";
    }

    void
    add_fields(PointLayout<dim> &layout) const override
    {
      layout.add(section, 1);
    }

    void
    find_points(std::vector<Body<dim>> &bodies,
                const MPI_Comm          comm) const override
    {
      const Shape<dim> shape(parameters.shape, section + "/Shape");
      double           volume = 0.;
      for (Body<dim> &body : bodies)
        {
          const unsigned int field = body.points.layout().first(section);
          body.points.for_each([&](const unsigned int, PointRef<dim> p) {
            p[field] = shape.contains(p.reference()) ? p.volume0() : 0.;
            volume += p[field];
          });
        }
      volume = dealii::Utilities::MPI::sum(volume, comm);
      AssertThrow(volume > 0., dealii::ExcMessage(no_point(bodies, comm)));
      for (Body<dim> &body : bodies)
        {
          const unsigned int field = body.points.layout().first(section);
          body.points.for_each([&](const unsigned int, PointRef<dim> p) {
            p[field] *= parameters.area / volume / p.mass();
          });
        }
    }

    void
    add_acceleration(MaterialPoints<dim> &points,
                     const unsigned int   first,
                     const double         t) const override
    {
      const unsigned int field = points.layout().first(section);
      points.for_each([&](const unsigned int, PointRef<dim> p) {
        if (p[field] > 0.)
          {
            const dealii::Tensor<1, dim> s = traction(p, p.position(), t);
            for (unsigned int d = 0; d < dim; ++d)
              p[first + d] += p[field] * s[d];
          }
      });
    }

    typename PointLoad<dim>::AtPosition
    at_position(const PointLayout<dim> &layout, const double t) const override
    {
      if (!traction.use_position())
        return {};
      return
        [this, t, field = layout.first(section)](const ConstPointRef<dim>  p,
                                                 const dealii::Point<dim> &x) {
          return p[field] > 0. ? p[field] * traction(p, x, t)
                               : dealii::Tensor<1, dim>();
        };
    }

  private:
    /**
     * Collective.
     */
    std::string
    no_point(const std::vector<Body<dim>> &bodies, const MPI_Comm comm) const
    {
      dealii::Point<dim> lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = std::numeric_limits<double>::max();
          upper[d] = std::numeric_limits<double>::lowest();
          for (const Body<dim> &body : bodies)
            body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
              lower[d] = std::min(lower[d], p.reference(d));
              upper[d] = std::max(upper[d], p.reference(d));
            });
          lower[d] = dealii::Utilities::MPI::min(lower[d], comm);
          upper[d] = dealii::Utilities::MPI::max(upper[d], comm);
        }
      std::ostringstream message;
      message << "The parameter '" << section << "/Shape' is <"
              << parameters.shape
              << ">: no point is in it. Points are between (" << lower
              << ") m and (" << upper << ") m initially. Where they are comes "
              << "from 'Grid/Cells'";
      for (const Body<dim> &body : bodies)
        message << ", 'Body " << body.name
                << (body.parameters->points_file.empty()
                      ? "/Points per direction'"
                      : "/Points file'");
      message << ".";
      return message.str();
    }

    const std::string        section;
    const TractionParameters parameters;
    LoadFormulas<dim>        traction;
  };
} // namespace greville

#endif
