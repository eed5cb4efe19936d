// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/constraints.h>

#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<ConstrainedDirections<dim>>
  Constraints<dim>::reduce(const std::vector<unsigned char> &constrained)
  {
    // A unit vector with a smaller remainder is a combination of the other
    // directions. A direction counts as an axis if a component differs from 1
    // by less than the second number.
    constexpr double negligible = 1e-6, round_off = 1e-14;
    std::map<unsigned int, ConstrainedDirections<dim>> result;
    for (const auto &[i, direction] : directions)
      {
        unsigned char      &bits  = components[i];
        const unsigned char all   = bits | constrained[i];
        const auto          found = result.find(i);
        Tensor<1, dim>      rest  = direction;
        for (unsigned int c = 0; c < dim; ++c)
          if ((all >> c) & 1)
            rest[c] = 0.;
        if (found != result.end())
          rest -= found->second.part_along(rest);
        const double size = rest.norm();
        if (!(size > negligible * direction.norm()))
          continue;
        rest /= size;
        unsigned int axis = 0;
        for (unsigned int c = 1; c < dim; ++c)
          if (std::abs(rest[c]) > std::abs(rest[axis]))
            axis = c;
        if (found == result.end() && 1. - std::abs(rest[axis]) < round_off)
          {
            bits |= 1 << axis;
            continue;
          }
        ConstrainedDirections<dim> &own = result[i];
        own.function                    = i;
        own.unit[own.n++]               = rest;
      }
    std::vector<ConstrainedDirections<dim>> list;
    for (const auto &entry : result)
      list.push_back(entry.second);
    return list;
  }



  GREVILLE_INSTANTIATE_CLASS(Constraints);
} // namespace greville
