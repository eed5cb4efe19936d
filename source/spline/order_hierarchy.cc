// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/spline/order_hierarchy.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<unsigned int>
  OrderHierarchy<dim>::orders(const unsigned int degree,
                              const std::string &coarsening)
  {
    const auto names = Utilities::split_string_list(coarsenings(), '|');
    Require(std::count(names.begin(), names.end(), coarsening) == 1,
            "The coarsening <" + coarsening + "> is none of " + coarsenings() +
              ".");
    if (coarsening == "none" || coarsening == "lattice" || coarsening == "hp")
      return {degree};
    const unsigned int step =
      coarsening == "one by one" ? 1 : (coarsening == "by two" ? 2 : degree);

    std::vector<unsigned int> result{degree};
    while (result.back() > 1)
      result.push_back(std::max<int>(1, int(result.back()) - int(step)));
    std::reverse(result.begin(), result.end());
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(OrderHierarchy);
} // namespace greville
