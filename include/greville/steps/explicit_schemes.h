// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_explicit_schemes_h
#define greville_steps_explicit_schemes_h

#include <greville/steps/central_differences.h>

namespace greville
{
  /**
   * Update stress last: w = v', in the pass that kicks and moves the points.
   */
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



  /**
   * Update stress first: w = v, before F is summed up. With velocities at half
   * steps it deforms over the step before, to which v belongs: F, J and stress
   * of a finished step are those of t_n.
   */
  template <int dim>
  class USF : public CentralDifferences<dim>
  {
  public:
    using CentralDifferences<dim>::CentralDifferences;

  protected:
    bool
    deforms_first() const override
    {
      return true;
    }

    bool
    deforms_by_mapped_velocity() const override
    {
      return true;
    }

    void
    find_fields(State<dim> &state) override;

    void
    take_points(State<dim> &state) override;
  };



  /**
   * Modified update stress last: w = M^-1 P', P' from the velocities of the
   * kicked points at x_n.
   */
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

#endif
