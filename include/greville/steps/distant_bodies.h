// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/bounding_box.h>

#include <greville/contact/rigid_body.h>
#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  /// Return notes about rigid bodies that stay away from their @p regions,
  /// which are the grids of the bodies that may meet them. Throws
  /// dealii::ExcMessage if such a rigid body does not move and no body can
  /// leave its grid.
  template <int dim>
  std::vector<std::string>
  notes_of_distant_bodies(const SimulationParameters        &parameters,
                          const std::vector<RigidBody<dim>> &rigid_bodies,
                          const std::vector<dealii::BoundingBox<dim>> &regions);
} // namespace greville
