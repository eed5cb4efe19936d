// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/central_differences.h>

namespace greville
{
  /// Update stress last: w = v'. One pass kicks, deforms and moves the points.
  template <int dim>
  class USL : public CentralDifferences<dim>
  {
  public:
    using CentralDifferences<dim>::CentralDifferences;

  protected:
    bool
    deforms_by_mapped_velocity() const override
    {
      return false;
    }

    void
    take_points(State<dim> &state) override;
  };



  /// Modified update stress last: w = M^-1 P', with P' from the velocities of
  /// the kicked points at x_n.
  template <int dim>
  class MUSL : public CentralDifferences<dim>
  {
  public:
    using CentralDifferences<dim>::CentralDifferences;

  protected:
    bool
    deforms_by_mapped_velocity() const override
    {
      return true;
    }

    void
    take_points(State<dim> &state) override;
  };
} // namespace greville
