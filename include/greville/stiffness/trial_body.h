// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/material.h>
#include <greville/points/material_points.h>

#include <string>

namespace greville
{
  /// The points of a body and their law in a step of a TangentSystem.
  template <int dim>
  struct TrialBody
  {
    const MaterialPoints<dim> *points;
    const Material            *material;
    std::string                name;
    /// Material::strength_reduction() of the step.
    double strength_reduction = 1.;
    /// The time at the end of the step, s.
    double time = 0.;
  };
} // namespace greville
