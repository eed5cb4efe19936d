// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/order_hierarchy.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<unsigned int>
  OrderHierarchy<dim>::orders(const unsigned int degree,
                              const Coarsening   coarsening)
  {
    if (coarsening == Coarsening::none || coarsening == Coarsening::lattice ||
        coarsening == Coarsening::hp)
      return {degree};
    const unsigned int step = coarsening == Coarsening::one_by_one ? 1
                              : coarsening == Coarsening::by_two   ? 2
                                                                   : degree;

    std::vector<unsigned int> result{degree};
    while (result.back() > 1)
      result.push_back(std::max<int>(1, int(result.back()) - int(step)));
    std::reverse(result.begin(), result.end());
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(OrderHierarchy);
} // namespace greville
