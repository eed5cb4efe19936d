// SPDX-License-Identifier: LGPL-2.1-or-later

#include "closest_shape.h"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace internal
  {
    namespace
    {
      /**
       * The facets that separate the inside from the outside in a simplex.
       */
      template <int dim>
      class SimplexCutter
      {
      public:
        SimplexCutter(const SidesOfShape<dim> &shape,
                      ClosedSurface<dim>      &facets)
          : shape(shape)
          , facets(facets)
        {}

        void
        cut(const std::array<Point<dim>, dim + 1> &vertices,
            const std::array<bool, dim + 1>       &are_inside)
        {
          std::array<Point<dim>, dim + 1> inside, outside;
          unsigned int                    n_inside = 0, n_outside = 0;
          for (unsigned int k = 0; k <= dim; ++k)
            (are_inside[k] ? inside[n_inside++] : outside[n_outside++]) =
              vertices[k];
          if (n_inside == 0 || n_outside == 0)
            return;
          // Corners of a segment, a triangle or a quadrilateral.
          Facet<dim>     corners;
          Tensor<1, dim> out;
          for (unsigned int i = 0; i < n_inside; ++i)
            for (unsigned int j = 0; j < n_outside; ++j)
              {
                corners.push_back(
                  crossing(inside[i],
                           outside[i % 2 == 0 ? j : n_outside - 1 - j]));
                out += outside[j] - inside[i];
              }
          if constexpr (dim == 2)
            add(corners, normal_of(corners) * out < 0.);
          else
            {
              const Facet<3> one         = {corners[0], corners[1], corners[2]};
              const bool     is_triangle = corners.size() == 3;
              const Facet<3> other       = {corners[0],
                                            corners[2],
                                            corners[is_triangle ? 2 : 3]};
              const bool     is_inwards =
                (normal_of(one) + normal_of(other)) * out < 0.;
              add(one, is_inwards);
              if (!is_triangle)
                add(other, is_inwards);
            }
        }

      private:
        Point<dim>
        crossing(Point<dim> inside, Point<dim> outside) const
        {
          for (unsigned int k = 0; k < 50; ++k)
            {
              const Point<dim> middle = inside + 0.5 * (outside - inside);
              (shape.is_inside(middle) ? inside : outside) = middle;
            }
          return inside + 0.5 * (outside - inside);
        }

        static Tensor<1, dim>
        normal_of(const Facet<dim> &facet)
        {
          const auto along = facet[1] - facet[0];
          if constexpr (dim == 2)
            return Tensor<1, 2>({along[1], -along[0]});
          else
            return cross_product_3d(along, facet[2] - facet[0]);
        }

        void
        add(Facet<dim> facet, const bool is_inwards)
        {
          if (is_inwards)
            std::swap(facet[0], facet[1]);
          // None where the surface passes through a vertex.
          if (normal_of(facet).norm() > 0.)
            facets.push_back(facet);
        }

        const SidesOfShape<dim> &shape;
        ClosedSurface<dim>      &facets;
      };
    } // namespace



    template <int dim>
    ClosedSurface<dim>
    facets_of(const SidesOfShape<dim> &shape,
              const double             size,
              const BoundingBox<dim>  &clip)
    {
      // Cells reach over the ends of the body, but not over those of the clip.
      const BoundingBox<dim>       extent = shape.box();
      Point<dim>                   lower;
      Tensor<1, dim>               h;
      std::array<std::size_t, dim> n;
      std::size_t                  n_vertices = 1;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] =
            std::max(extent.lower_bound(d) - 0.37 * size, clip.lower_bound(d));
          const double upper =
            std::min(extent.upper_bound(d) + 0.37 * size, clip.upper_bound(d));
          if (!(upper > lower[d]))
            return {};
          n[d] = std::size_t(std::ceil((upper - lower[d]) / size));
          h[d] = (upper - lower[d]) / n[d];
          n_vertices *= n[d] + 1;
        }
      const auto vertex = [&](std::size_t k) {
        Point<dim> x = lower;
        for (unsigned int d = 0; d < dim; ++d, k /= n[d - 1] + 1)
          x[d] += h[d] * (k % (n[d] + 1));
        return x;
      };
      std::vector<bool> are_inside(n_vertices);
      for (std::size_t k = 0; k < n_vertices; ++k)
        are_inside[k] = shape.is_inside(vertex(k));

      ClosedSurface<dim>              facets;
      SimplexCutter<dim>              cutter(shape, facets);
      std::array<Point<dim>, dim + 1> corners;
      std::array<bool, dim + 1>       sides;
      for (std::size_t k = 0; k < n_vertices; ++k)
        {
          std::array<std::size_t, dim> strides;
          bool                         is_cell = true;
          for (std::size_t d = 0, rest = k, stride = 1; d < dim; ++d)
            {
              is_cell    = is_cell && rest % (n[d] + 1) < n[d];
              strides[d] = stride;
              stride *= n[d] + 1;
              rest /= n[d] + 1;
            }
          if (!is_cell)
            continue;
          // A simplex for each order of the axes, along the same diagonal.
          std::array<unsigned int, dim> axes;
          std::iota(axes.begin(), axes.end(), 0u);
          do
            {
              std::size_t at = k;
              for (unsigned int i = 0; i <= dim; ++i)
                {
                  corners[i] = vertex(at);
                  sides[i]   = are_inside[at];
                  if (i < dim)
                    at += strides[axes[i]];
                }
              cutter.cut(corners, sides);
          } while (std::next_permutation(axes.begin(), axes.end()));
        }
      return facets;
    }



    template ClosedSurface<2>
    facets_of(const SidesOfShape<2> &, const double, const BoundingBox<2> &);
    template ClosedSurface<3>
    facets_of(const SidesOfShape<3> &, const double, const BoundingBox<3> &);
  } // namespace internal
} // namespace greville
