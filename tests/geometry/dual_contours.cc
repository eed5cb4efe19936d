// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks meshes of rigid bodies given by formulas: they are closed, lie on the
// surface, have the volume of the body, to round-off if planes bound it, and an
// unbounded body is cut at a box.

#include <greville/geometry/closest_surface.h>

#include <tests.h>

// Within (-2, 2)^dim.
template <int dim>
void
check_mesh(const std::string &formula,
           const double       volume,
           const double       tolerance  = 1e-12,
           const bool         is_defined = true)
{
  Point<dim> two;
  for (unsigned int d = 0; d < dim; ++d)
    two[d] = 2.;
  const BoundingBox<dim> box({-two, two}), inner({-two * 0.999, two * 0.999});
  const auto     surface = make_closest_surface<dim>(formula, "Body a/Shape");
  Tensor<1, dim> sum;
  double         found = 0., farthest = 0.;
  for (const Facet<dim> &facet : surface->mesh(box))
    {
      const auto     along = facet[1] - facet[0];
      Tensor<1, dim> area;
      if constexpr (dim == 2)
        area = Tensor<1, 2>({along[1], -along[0]});
      else
        area = 0.5 * cross_product_3d(along, facet[2] - facet[0]);
      sum += area;
      found += area * facet[0] / dim;
      for (const Point<dim> &x : facet)
        if (is_defined && inner.point_inside(x))
          farthest =
            std::max(farthest, std::abs(surface->closest(x, 0.1)->distance));
    }
  check(formula + ": closed", sum.norm(), 1e-10);
  check(formula + ": volume", std::abs(found / volume - 1.), tolerance);
  check(formula + ": on the surface", farthest, 1e-9);
}



void
test_main()
{
  constexpr double pi = numbers::PI;
  check_mesh<2>("box(0, 0.2, 1, 0.9)", 0.7);
  check_mesh<2>("intersection(half_space(3, 4, 3), half_space(4, -3, 3), "
                "half_space(-1, 0, 1))",
                0.92 * 23. / 6.);
  check_mesh<2>("3 * x + 4 * y < 3", 4. / 3. + 9.625, 1e-10);
  check_mesh<2>("difference(box(0, 0, 1, 1), ball(1, 1, 0.3))",
                1. - 0.0225 * pi,
                1e-4);
  check_mesh<2>("level_set(x^2 / 0.04 + y^2 / 0.01 - 1)", 0.02 * pi, 1e-3);
  // The root has values on the right only.
  check_mesh<2>("y < sqrt(x)", 4. + 4. / 3. * std::sqrt(2.), 1e-3, false);
  check_mesh<3>("box(0, 0.2, 0.1, 1, 0.9, 0.12)", 0.014);
  check_mesh<3>("cylinder(0.1, 0.3, 0.2, 0.7, 1.1, 0.5, 0.4)",
                0.16 * pi * std::sqrt(1.09),
                3e-3);
  check_mesh<3>("2 * x - y + 2 * z < 0", 32., 1e-4);
}
