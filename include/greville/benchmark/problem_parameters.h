// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/body.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// The parameters of the body: a box, its density or material points, clamped
  /// walls, and acceleration.
  struct ProblemParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Check what the parameter patterns cannot check.
    void
    check(const unsigned int dim) const;

    std::map<std::string, std::string>
    formulas() const;

    /// Return the placement of @p n points per cell and direction in the named
    /// body. The surfaces of the body cut cells.
    template <int dim>
    PointPlacement
    placement(const std::string      &body,
              const unsigned int      n,
              const SplineSpace<dim> &space) const;

    std::vector<double>       lower        = {0., 0., 0.};
    std::vector<double>       upper        = {1., 1., 1.};
    std::vector<unsigned int> cell_ratio   = {1, 1, 1};
    std::string               density      = "1";
    std::string               acceleration = "-9.81";
    std::vector<std::string>  clamped;
    std::vector<std::string>  bodies;
    std::string               shapes;
    std::vector<unsigned int> points_per_direction = {2};
    double                    jitter               = 0.5;
    double                    filling_threshold    = 0.45;
    bool                      extend               = true;
  };
} // namespace greville
