// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/late_row.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <typename Points, typename Action>
    void
    for_each_kicked(Points &points, const Action &action)
    {
      const auto        &layout = points.layout();
      const unsigned int others = layout.n_fixed + layout.n_state;
      points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int k = layout.velocity; k < layout.mass; ++k)
          action(p[k]);
        for (unsigned int k = others; k < layout.size; ++k)
          action(p[k]);
      });
    }
  } // namespace



  template <int dim>
  KickedNumbers<dim>::KickedNumbers(const std::vector<Body<dim>> &bodies)
  {
    std::size_t n = 0;
    for (const Body<dim> &body : bodies)
      {
        const PointLayout<dim> &layout = body.points.layout();
        n += body.points.n_points() *
             (dim + layout.size - layout.n_fixed - layout.n_state);
      }
    numbers.reserve(n);
    for (const Body<dim> &body : bodies)
      for_each_kicked(body.points,
                      [&](const double x) { numbers.push_back(x); });
  }



  template <int dim>
  void
  KickedNumbers<dim>::restore(std::vector<Body<dim>> &bodies,
                              const double            weight) const
  {
    auto number = numbers.begin();
    for (Body<dim> &body : bodies)
      for_each_kicked(body.points, [&](double &x) {
        x = weight == 1. ? *number : weight * *number + (1. - weight) * x;
        ++number;
      });
  }



  GREVILLE_INSTANTIATE_CLASS(KickedNumbers);
} // namespace greville
