// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/utilities.h>

#include <greville/materials/hencky_law.h>
#include <greville/materials/left_cauchy_green.h>

#include <algorithm>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A HenckyLaw whose points store the elastic part of their deformation, with
   * F = F_e F_p and the exponential map (de Souza Neto, Peric, Owen,
   * Computational Methods for Plasticity, section 14.4). The trial state of a
   * step with the increment f is b_e = f b_e f^T.
   *
   * State: the elastic left Cauchy-Green tensor less the identity, b_e - 1
   * (zero in the stress-free state); the equivalent plastic strain; the plastic
   * work per volume of the stress-free state, J / m^3, all of which is heat;
   * and further variables of the @p Law.
   */
  template <typename Law, typename Elastic = ElasticConstants>
  class ElastoplasticLaw : public HenckyLaw<Law, Elastic>
  {
  public:
    std::array<Lanes, 6>
    trial(const MaterialLanes &points) const
    {
      return push_forward(points.increment, current(points));
    }

    std::array<Lanes, 6>
    current(const MaterialLanes &points) const
    {
      std::array<Lanes, 6> e;
      std::copy_n(points.state.first.begin(), 6, e.begin());
      return e;
    }

    Lanes
    heat(const MaterialLanes &points) const
    {
      return points.state[work];
    }

    double
    dissipation(const MaterialPoint &point) const override
    {
      return point.state[work];
    }

  protected:
    static constexpr unsigned int plastic_strain = 6, work = 7, more = 8;

    /// Return the names of the state variables, followed by the names
    /// @p of_law.
    static std::vector<std::string>
    names_with(const std::vector<std::string> &of_law)
    {
      auto names = dealii::Utilities::split_string_list(
        "b_xx, b_yy, b_zz, b_xy, b_xz, b_yz, plastic_strain, dissipation");
      names.insert(names.end(), of_law.begin(), of_law.end());
      return names;
    }

    /// Set the state of a point without plastic strain.
    static void
    set_elastic(MaterialPoint &point, const dealii::SymmetricTensor<2, 3> &e)
    {
      point.state.first.fill(0.);
      for (unsigned int i = 0; i < 6; ++i)
        point.state[i] = e.access_raw_entry(i);
    }
  };
} // namespace greville
