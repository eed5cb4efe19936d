// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /// The loads on the surfaces of bodies, see SurfaceLoadParameters. Each load
  /// has a Surface in the State, in the same order. The surfaces of bodies in
  /// contact follow; the contacts set their loads.
  template <int dim>
  class SurfaceLoads
  {
  public:
    /// Throws dealii::ExcMessage for invalid formulas.
    SurfaceLoads(const SimulationParameters &parameters);

    unsigned int
    n_loads() const
    {
      return loads.size();
    }

    /// Return the parameters that scale the loads, with their values, for
    /// messages.
    std::string
    description() const;

    /// Collective. Return the surfaces of the bodies. If bodies have an initial
    /// displacement, the points are still in the cells of their original
    /// positions. Throws dealii::ExcMessage if a surface has no points.
    std::vector<Surface<dim>>
    make_surfaces(const std::vector<Body<dim>> &bodies,
                  const SplineSpace<dim>       &space) const;

    /// Set the loads of points at time @p t (s).
    void
    set(std::vector<Surface<dim>> &surfaces, const double t) const;

    /// Set the loads to zero.
    void
    clear(std::vector<Surface<dim>> &surfaces) const;

    /// Return the @p surfaces with their loads at time @p t, for TangentSystem.
    /// The result refers to the surfaces and to this object.
    std::vector<LoadedSurface<dim>>
    loaded(const std::vector<Surface<dim>> &surfaces, const double t) const;

    /// Collective. Return the name of each load and its force at time @p t, N
    /// (in 2D N / m).
    std::vector<std::pair<std::string, dealii::Tensor<1, dim>>>
    resultants(const std::vector<Surface<dim>> &surfaces,
               const double                     t,
               const MPI_Comm                   comm) const;

  private:
    std::vector<std::string>           names;
    std::vector<SurfaceLoadParameters> parameters;
    struct ContactSurface
    {
      std::string contact, body;
      bool        is_of_material_points;
    };

    std::vector<ContactSurface>                    contacts;
    std::vector<std::unique_ptr<SurfaceLoad<dim>>> loads;
  };
} // namespace greville
