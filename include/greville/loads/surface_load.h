// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/base/errors.h>
#include <greville/points/surface.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace greville
{
  /// A load on the points of a surface, as a force per initial area.
  template <int dim>
  class SurfaceLoad
  {
  public:
    virtual ~SurfaceLoad() = default;

    /// Return the load on a point at time @p t (s), Pa. Throws
    /// dealii::ExcMessage if a formula has no value there.
    virtual dealii::Tensor<1, dim>
    load(const SurfaceState<dim> &state, const double t) const = 0;

    /// Return Surface::stiffness, Pa / m.
    virtual double
    stiffness() const
    {
      return 0.;
    }

    /// Return Surface::damping, Pa s / m.
    virtual double
    damping() const
    {
      return 0.;
    }
  };



  /// The body and the section of a surface load.
  struct LoadedBody
  {
    /// Section of the load, for messages.
    std::string     section;
    const Material &material;
    /// Smallest edge of a cell, m.
    double cell_size;
  };



  /**
   * The parameters of a kind of surface load ('Surface load NAME/Kind').
   *
   * A new kind is one header with a class that derives from SurfaceLoadKindOf,
   * and one line in the list of source/loads/surface_load.cc; or a call of
   * add_surface_load_kind() in a program.
   */
  class SurfaceLoadKind
  {
  public:
    virtual ~SurfaceLoadKind() = default;

    /// Declare the parameters of this kind in the current section of @p prm.
    /// Parsed values are stored in this object.
    virtual void
    declare(dealii::ParameterHandler &prm) = 0;

    /// Throw dealii::ExcMessage, which names the @p section, if a parameter is
    /// missing or contradicts another one.
    virtual void
    check(const std::string &section) const = 0;

    /// Return the names and values of the parameters that determine the
    /// strength of the load, for messages. Messages omit empty values.
    virtual std::vector<std::pair<std::string, std::string>>
    strengths() const
    {
      return {};
    }

    virtual std::unique_ptr<SurfaceLoad<2>>
    make_2d(const LoadedBody &body) const = 0;

    virtual std::unique_ptr<SurfaceLoad<3>>
    make_3d(const LoadedBody &body) const = 0;

    template <int dim>
    std::unique_ptr<SurfaceLoad<dim>>
    make(const LoadedBody &body) const
    {
      if constexpr (dim == 2)
        return make_2d(body);
      else
        return make_3d(body);
    }
  };



  /// Implements SurfaceLoadKind for a class Kind with a member template Load of
  /// the dimension, which derives from SurfaceLoad. The constructor of Load
  /// takes the Kind and the LoadedBody.
  template <typename Kind>
  class SurfaceLoadKindOf : public SurfaceLoadKind
  {
  public:
    /// Throw if the first one of strengths() has no value.
    void
    check(const std::string &section) const override
    {
      const auto parameters = this->strengths();
      Require(parameters.empty() || !parameters[0].second.empty(),
              "'" + section + "' has 'Kind' = " + Kind::name +
                " and needs the parameter '" + parameters[0].first + "'.");
    }

    std::unique_ptr<SurfaceLoad<2>>
    make_2d(const LoadedBody &body) const final
    {
      return std::make_unique<typename Kind::template Load<2>>(
        static_cast<const Kind &>(*this), body);
    }

    std::unique_ptr<SurfaceLoad<3>>
    make_3d(const LoadedBody &body) const final
    {
      return std::make_unique<typename Kind::template Load<3>>(
        static_cast<const Kind &>(*this), body);
    }
  };



  using MakeSurfaceLoadKind = std::unique_ptr<SurfaceLoadKind> (*)();

  template <typename Kind>
  std::unique_ptr<SurfaceLoadKind>
  make_kind()
  {
    return std::make_unique<Kind>();
  }

  /// Add a kind to the list, before parameters are read. Not thread-safe.
  void
  add_surface_load_kind(const std::string        &name,
                        const MakeSurfaceLoadKind make);

  /// Add a kind by its class, which needs a default constructor and a static
  /// name.
  template <typename Kind>
  void
  add_surface_load_kind()
  {
    add_surface_load_kind(Kind::name, make_kind<Kind>);
  }

  /// Return the names of all kinds, separated by '|'.
  std::string
  surface_load_kinds();

  /// Return a kind by name. Throws dealii::ExcMessage with the @p parameter and
  /// surface_load_kinds() for an unknown @p name.
  std::unique_ptr<SurfaceLoadKind>
  make_surface_load_kind(const std::string &name, const std::string &parameter);
} // namespace greville
