// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Base class of loads on material points. A load adds its acceleration to the
   * field "load" of points. Data of points that it needs (whether a point bears
   * the load, a weight, a normal) are computed once and stored in fields of its
   * own.
   *
   * A new load is one header with a class that derives from it, and one line in
   * the list of source/boundary/loads.cc, or a call of add_point_load() in a
   * program.
   */
  template <int dim>
  class PointLoad
  {
  public:
    virtual ~PointLoad() = default;

    /// Return the parameters that scale the load, for messages.
    virtual std::string
    parameter_names() const = 0;

    /// Add the load's own fields to the layout of points.
    virtual void
    add_fields(PointLayout<dim> &) const
    {}

    /// Collective. Fill the load's own fields, with all points at their initial
    /// positions. Throws dealii::ExcMessage if no point bears the load.
    virtual void
    find_points(std::vector<Body<dim>> &, const MPI_Comm) const
    {}

    /// Fill the data that depend only on the initial positions of @p points.
    /// Called whenever initial positions are set.
    virtual void
    precompute(MaterialPoints<dim> &) const
    {}

    /// Add the acceleration at time @p t (s), m / s^2, to number @p first and
    /// the following numbers of all @p points. It may be called several times
    /// for the same time: for repeated steps, and for output.
    virtual void
    add_acceleration(MaterialPoints<dim> &points,
                     const unsigned int   first,
                     const double         t) const = 0;

    /// A function that returns the acceleration of a point at @p x, m / s^2.
    using AtPosition =
      std::function<dealii::Tensor<1, dim>(const ConstPointRef<dim>  p,
                                           const dealii::Point<dim> &x)>;

    /// Return, for a load that depends on the current position, its
    /// acceleration at time @p t (s) of points of this @p layout; implicit
    /// steps evaluate it at the end positions of points. Other loads return an
    /// empty function.
    virtual AtPosition
    at_position(const PointLayout<dim> &, const double) const
    {
      return {};
    }
  };

  template <int dim>
  using PointLoads = std::vector<std::unique_ptr<PointLoad<dim>>>;

  /// A function that makes all loads of a kind that the parameters define.
  template <int dim>
  using MakePointLoads =
    std::function<PointLoads<dim>(const SimulationParameters &parameters)>;

  /// Add a kind of loads to the list, for simulations that are made afterwards.
  template <int dim>
  void
  add_point_load(const MakePointLoads<dim> &make);
} // namespace greville
