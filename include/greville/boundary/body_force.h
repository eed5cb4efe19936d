// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/point_load.h>

namespace greville
{
  /// A force b(x, X, t) per mass on all points.
  template <int dim>
  class BodyForce : public PointLoad<dim>
  {
  public:
    static PointLoads<dim>
    make(const SimulationParameters &parameters)
    {
      PointLoads<dim> result;
      if (!parameters.loads.body_force.empty())
        result.push_back(std::make_unique<BodyForce>(parameters.loads));
      return result;
    }

    BodyForce(const LoadParameters &parameters)
      : force(parameters.body_force, "Loads/Body force")
    {}

    std::string
    parameter_names() const override
    {
      return "'Loads/Body force'";
    }

    void
    add_fields(PointLayout<dim> &layout) const override
    {
      force.add_fields(layout);
    }

    void
    precompute(MaterialPoints<dim> &points) const override
    {
      force.precompute(points);
    }

    void
    add_acceleration(MaterialPoints<dim> &points,
                     const unsigned int   first,
                     const double         t) const override
    {
      force.add(points, first, t);
    }

    typename PointLoad<dim>::AtPosition
    at_position(const PointLayout<dim> &, const double t) const override
    {
      if (!force.use_position())
        return {};
      return [this, t](const ConstPointRef<dim>  p,
                       const dealii::Point<dim> &x) { return force(p, x, t); };
    }

  private:
    LoadFormulas<dim> force;
  };
} // namespace greville
