// SPDX-License-Identifier: LGPL-2.1-or-later

#include "dual_contours.h"

#include <greville/base/eigenvectors.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace greville::internal
{
  using namespace dealii;

  namespace
  {
    // The smallest number of cells across a thin box.
    constexpr unsigned int least_cells_across = 12;

    // Planes intersect in an edge or corner if an eigenvalue of the sum of n
    // n^T is above this fraction of the largest one, as for angles from 11
    // degrees.
    constexpr double least_eigenvalue = 0.01;



    template <int dim>
    struct ContourCell
    {
      /// The points at which the surface cuts edges, and its normals there, if
      /// known.
      std::vector<std::pair<Point<dim>, Tensor<1, dim>>> planes;
      /// The vertex. It lies on an edge or a corner if the planes have two or
      /// three independent normals.
      Point<dim>   x;
      unsigned int n_across = 0;

      /// Minimize the sum of squared distances from the planes, close to the
      /// mean of their points; take the mean if the minimum is beyond @p reach.
      void
      find_vertex(const Tensor<1, dim> &reach)
      {
        Point<dim> mean;
        for (const auto &[point, n] : planes)
          mean += point / double(planes.size());
        SymmetricTensor<2, dim> matrix;
        Tensor<1, dim>          right_side, change;
        for (const auto &[point, n] : planes)
          {
            matrix += symmetrize(outer_product(n, n));
            right_side += (n * (point - mean)) * n;
          }
        const auto pairs = eigenvectors(matrix); // the largest value first
        for (const auto &[value, vector] : pairs)
          if (value > least_eigenvalue * pairs[0].first)
            {
              change += (vector * right_side) / value * vector;
              ++n_across;
            }
        for (unsigned int d = 0; d < dim; ++d)
          if (std::abs(change[d]) > reach[d])
            n_across = 0;
        x = n_across > 0 ? mean + change : mean;
      }
    };



    /// Return the result of @p function, or nothing if a formula has no value.
    template <typename Function>
    auto
    value_or_none(const Function &function) -> decltype(function())
    {
      try
        {
          return function();
        }
      catch (const ExceptionBase &)
        {
          return {};
        }
    }


    /// The cells of a lattice of nodes, and the faces around the edges of the
    /// lattice that the surface cuts.
    template <int dim>
    class ContourCells
    {
    public:
      ContourCells(const std::function<bool(const Point<dim> &)> &contains,
                   const ClosestSurface<dim>                     &surface,
                   const BoundingBox<dim>                        &box,
                   const unsigned int                             n_cells)
        : contains(contains)
        , surface(surface)
        , box(box)
      {
        double longest = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          longest = std::max(longest, box.side_length(d));
        // The first and the last nodes are outside, and no node is on a side.
        n_all = 1;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double part = box.side_length(d) / longest;
            n_nodes[d]        = 2 + std::max(least_cells_across,
                                      unsigned(std::lround(part * n_cells)));
            h[d]              = box.side_length(d) / (n_nodes[d] - 2.);
            n_all *= n_nodes[d];
          }
      }

      /// Cut the edges, and find the vertices of the cells around them.
      void
      find_vertices()
      {
        std::vector<bool> inside(n_all);
        for (std::size_t k = 0; k < n_all; ++k)
          inside[k] = is_inside(position(multi_index<dim>(k, n_nodes)));
        for (std::size_t k = 0; k < n_all; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            {
              const MultiIndex<dim> node = multi_index<dim>(k, n_nodes);
              MultiIndex<dim>       next = node;
              if (++next[d] < n_nodes[d] &&
                  inside[k] != inside[lexicographic<dim>(next, n_nodes)])
                cut_edge(node, next, d, inside[k]);
            }
        for (auto &[number, cell] : cells)
          {
            // Sharp tips may end in the next cell, which may have no node
            // inside.
            cell.find_vertex(1.5 * h);
            if (const auto found = closest(cell.x))
              cell.x = found->point;
          }
      }

      /// Divide the faces into segments or triangles.
      ClosedSurface<dim>
      facets()
      {
        ClosedSurface<dim> result;
        for (auto face : faces)
          {
            const auto across = [&](const unsigned int v) {
              return cells[face[v]].n_across;
            };
            // If there is an edge of the surface, the common side of two
            // triangles must be along it.
            if (dim == 3 && across(0) + across(2) < across(1) + across(dim))
              std::rotate(face.begin(), face.begin() + 1, face.end());
            for (unsigned int t = 2; t <= n_around - (dim == 3); ++t)
              {
                Facet<dim> &facet = result.emplace_back();
                facet             = {cells[face[0]].x, cells[face[t - 1]].x};
                if (dim == 3)
                  facet.push_back(cells[face[t]].x);
              }
          }
        return result;
      }

    private:
      Point<dim>
      position(const MultiIndex<dim> &node) const
      {
        Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = box.lower_bound(d) + (node[d] - 0.5) * h[d];
        return x;
      }

      bool
      is_inside(const Point<dim> &x) const
      {
        return box.point_inside(x) &&
               value_or_none([&]() { return contains(x); });
      }

      std::optional<ClosestPoint<dim>>
      closest(const Point<dim> &x) const
      {
        return value_or_none([&]() { return surface.closest(x, h.norm()); });
      }

      /// Find the point at which the surface cuts an edge, and add the face of
      /// the cells around the edge.
      void
      cut_edge(const MultiIndex<dim> &node,
               const MultiIndex<dim> &next,
               const unsigned int     d,
               const bool             begins_inside)
      {
        Point<dim> ends[2] = {position(node), position(next)};
        for (unsigned int step = 0; step < 40; ++step)
          {
            const Point<dim> middle = ends[0] + 0.5 * (ends[1] - ends[0]);
            ends[is_inside(middle) != begins_inside] = middle;
          }
        const auto found = closest(ends[0]);
        // In this order, the inside is on the left of a segment, and a
        // quadrilateral is counterclockwise when seen from outside.
        auto              &face = faces.emplace_back();
        const unsigned int e = (d + 1) % dim, f = (d + 2) % dim;
        for (unsigned int v = 0; v < n_around; ++v)
          {
            MultiIndex<dim> cell = node;
            cell[e] -= v == 0 || v == 3;
            cell[f] -= dim == 3 && v < 2;
            face[v] = lexicographic<dim>(cell, n_nodes);
            cells[face[v]].planes.emplace_back(ends[0],
                                               found ? found->normal
                                                     : Tensor<1, dim>());
          }
        if (begins_inside == (dim == 2 && d == 1))
          std::reverse(face.begin(), face.end());
      }

      const std::function<bool(const Point<dim> &)> &contains;
      const ClosestSurface<dim>                     &surface;
      const BoundingBox<dim>                        &box;
      MultiIndex<dim>                                n_nodes;
      Tensor<1, dim>                                 h;
      std::size_t                                    n_all;
      // Cells have the numbers of their first nodes. A face of 2 or 4 cells
      // surrounds each edge that the surface cuts.
      static constexpr unsigned int n_around = 1 << (dim - 1);
      std::unordered_map<std::size_t, ContourCell<dim>> cells;
      std::vector<std::array<std::size_t, n_around>>    faces;
    };
  } // namespace



  template <int dim>
  ClosedSurface<dim>
  dual_contours(const std::function<bool(const Point<dim> &)> &contains,
                const ClosestSurface<dim>                     &surface,
                const BoundingBox<dim>                        &box,
                const unsigned int                             n_cells)
  {
    ContourCells<dim> cells(contains, surface, box, n_cells);
    cells.find_vertices();
    return cells.facets();
  }



  GREVILLE_INSTANTIATE(dual_contours);
} // namespace greville::internal
