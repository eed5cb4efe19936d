// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/geometry/fitted_points.h>
#include <greville/geometry/inside.h>

#include <algorithm>
#include <memory>
#include <random>

namespace greville
{
  using namespace dealii;

  template <int dim>
  MultiIndex<dim>
  points_of_cell(const PointPlacement &parameters, const std::string &section)
  {
    const auto &given = parameters.points_per_direction;
    Require(given.size() == 1 || given.size() == dim,
            "The parameter '" + section + "/Points per direction' takes 1 or " +
              std::to_string(dim) + " numbers, not " +
              std::to_string(given.size()) + ".");
    MultiIndex<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = given[given.size() == 1 ? 0 : d];
    return result;
  }



  template <int dim>
  std::function<bool(const Point<dim> &)>
  make_inside(const PointPlacement   &parameters,
              const std::string      &section,
              const SplineSpace<dim> &space)
  {
    if (parameters.shape_file.empty())
      return [shape = Shape<dim>(parameters.shape, section + "/Shape")](
               const Point<dim> &x) { return shape.contains(x); };
    std::shared_ptr<const FittedShape<dim>> shape =
      make_fitted_shape<dim>(parameters, section, space);
    return [shape](const Point<dim> &x) { return shape->contains(x); };
  }



  namespace
  {
    /// Call visit(x) for a point of the grid and its periodic images one period
    /// away, the point itself first.
    template <int dim, typename Visit>
    void
    for_each_image(const SplineSpace<dim> &space,
                   const Point<dim>       &x,
                   const Visit            &visit)
    {
      MultiIndex<dim> counts;
      unsigned int    n = 1;
      for (unsigned int d = 0; d < dim; ++d)
        n *= counts[d] = space.is_periodic(d) ? 3 : 1;
      for (unsigned int k = 0; k < n; ++k)
        {
          const auto index = multi_index<dim>(k, counts);
          Point<dim> image = x;
          for (unsigned int d = 0; d < dim; ++d)
            if (index[d] > 0)
              image[d] += (index[d] == 1 ? -1. : 1.) *
                          (space.upper_corner()[d] - space.lower_corner()[d]);
          visit(image);
        }
    }
  } // namespace



  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_points(const PointPlacement   &parameters,
               const std::string      &section,
               const SplineSpace<dim> &space)
  {
    if (parameters.placement == Placement::fitted ||
        parameters.placement == Placement::fitted_lattice)
      return place_fitted_points<dim>(parameters, section, space);
    const auto contains = make_inside<dim>(parameters, section, space);
    const bool gauss    = parameters.placement == Placement::gauss;
    const auto extents  = points_of_cell<dim>(parameters, section);
    std::vector<QGauss<1>> quadratures;
    unsigned int           n_in_cell = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        n_in_cell *= extents[d];
        quadratures.emplace_back(extents[d]);
      }

    std::vector<PlacedPoint<dim>> result;
    for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
      {
        const std::uint64_t position = space.owned_cells()[cell];
        const CellBox<dim>  box      = space.box(cell);
        for (unsigned int k = 0; k < n_in_cell; ++k)
          {
            const auto       local = multi_index<dim>(k, extents);
            PlacedPoint<dim> point;
            point.id     = position * n_in_cell + k;
            point.cell   = cell;
            point.volume = 1.;
            // Compute shifts on demand: they cost as much as all the rest.
            std::array<double, dim> shift{};
            if (parameters.jitter > 0.)
              {
                std::mt19937_64 random(point.id * 0x9E3779B97F4A7C15ull +
                                       parameters.seed);
                std::uniform_real_distribution<double> uniform(-1., 1.);
                for (double &entry : shift)
                  entry = parameters.jitter * uniform(random);
              }
            for (unsigned int d = 0; d < dim; ++d)
              {
                const unsigned int n = extents[d];
                double xi            = gauss ? quadratures[d].point(local[d])(0)
                                             : (local[d] + 0.5) / n;
                xi += shift[d] * 0.5 / n;
                xi         = std::min(std::max(xi, 1e-9), 1. - 1e-9);
                point.x[d] = box.lower[d] + xi * box.size[d];
                point.volume *=
                  box.size[d] *
                  (gauss ? quadratures[d].weight(local[d]) : 1. / n);
              }
            unsigned int n_images = 0;
            for_each_image(space, point.x, [&](const Point<dim> &x) {
              if (contains(x) && n_images++ == 0)
                {
                  point.image = x;
                  result.push_back(point);
                }
            });
            Require(n_images <= 1 || parameters.clip,
                    "The body of '" + section +
                      "' meets its own image across the periodic walls of the "
                      "grid, for instance at (" +
                      text_of(point.x) +
                      ") m. Make the shape smaller, or set 'Clip at the grid' "
                      "to true.");

            // Check that one cell beyond each wall is empty.
            for (unsigned int d = 0; d < dim && !parameters.clip; ++d)
              for (const int side : {-1, 1})
                if (!space.is_periodic(d) &&
                    space.is_at_side(box.index[d], 2 * d + (side > 0)))
                  {
                    Point<dim> outside = point.x;
                    outside[d] += side * box.size[d];
                    Require(!contains(outside),
                            "The body of '" + section +
                              "' sticks out of the grid, for instance at (" +
                              text_of(outside) +
                              ") m. Make the grid larger ('Grid/Lower corner', "
                              "'Grid/Upper corner'), the shape smaller, or set "
                              "'Clip at the grid' to true.");
                  }
          }
      }
    return result;
  }



  GREVILLE_INSTANTIATE(points_of_cell);
  GREVILLE_INSTANTIATE(make_inside);
  GREVILLE_INSTANTIATE(place_points);
} // namespace greville
