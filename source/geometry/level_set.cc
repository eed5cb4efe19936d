// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/compatibility.h>
#include <greville/geometry/level_set.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Positions coincide if they are closer than this fraction of a cell.
    constexpr double same_place = 1e-11;

    // The step of differences of formulas, in cells.
    constexpr double difference_step = 0.01;

    // The weights of derivatives of sixth order.
    constexpr double difference_weights[3] = {3. / 4., -3. / 20., 1. / 60.};
  } // namespace



  template <int dim>
  double
  LevelSet<dim>::value(const Point<dim> &x) const
  {
    if (kind == plane)
      return as_plane.distance(x);
    if (kind == quadric)
      return 0.5 * ((x - center) * (metric * (x - center)) / radius - radius);
    return (*expression)(ArrayView<const double>(&x[0], dim));
  }



  template <int dim>
  Tensor<1, dim>
  LevelSet<dim>::gradient(const Point<dim> &x, const Tensor<1, dim> &size) const
  {
    if (kind == plane)
      return as_plane.normal;
    if (kind == quadric)
      return metric * (x - center) / radius;
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      for (int k = 1; k <= 3; ++k)
        for (const int side : {-1, 1})
          {
            const double step    = difference_step * size[d];
            Point<dim>   shifted = x;
            shifted[d] += side * k * step;
            result[d] +=
              side * difference_weights[k - 1] / step * value(shifted);
          }
    return result;
  }



  template <int dim>
  bool
  LevelSet<dim>::operator==(const LevelSet &other) const
  {
    return kind == other.kind && as_plane.normal == other.as_plane.normal &&
           as_plane.offset == other.as_plane.offset && center == other.center &&
           metric == other.metric && radius == other.radius &&
           text == other.text;
  }



  template <int dim>
  CellLevelSet<dim>::CellLevelSet(const LevelSet<dim>  &level_set,
                                  const Point<dim>     &corner,
                                  const Tensor<1, dim> &size)
    : level_set(level_set)
    , corner(corner)
    , size(size)
  {
    if (level_set.kind == LevelSet<dim>::formula)
      {
        double largest = 0.;
        for (unsigned int k = 0; k <= (1u << dim); ++k)
          {
            Point<dim> xi;
            for (unsigned int d = 0; d < dim; ++d)
              xi[d] = k == (1u << dim) ? 0.5 : double((k >> d) & 1);
            largest = std::max(largest, gradient(xi).norm());
          }
        scale = largest > 0. ? 1. / largest : 1.;
      }
    else
      scale = 1. / size.norm();
  }



  template <int dim>
  Point<dim>
  CellLevelSet<dim>::position(const Point<dim> &xi) const
  {
    Point<dim> x = corner;
    for (unsigned int d = 0; d < dim; ++d)
      x[d] += xi[d] * size[d];
    return x;
  }



  template <int dim>
  double
  CellLevelSet<dim>::value(const Point<dim> &xi, const unsigned int) const
  {
    return scale * level_set.value(position(xi));
  }



  template <int dim>
  Tensor<1, dim>
  CellLevelSet<dim>::gradient(const Point<dim> &xi, const unsigned int) const
  {
    Tensor<1, dim> result = level_set.gradient(position(xi), size);
    for (unsigned int d = 0; d < dim; ++d)
      result[d] *= scale * size[d];
    return result;
  }



  template <int dim>
  SymmetricTensor<2, dim>
  CellLevelSet<dim>::hessian(const Point<dim> &xi, const unsigned int) const
  {
    SymmetricTensor<2, dim> result;
    if (level_set.kind == LevelSet<dim>::quadric)
      {
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int e = d; e < dim; ++e)
            result[d][e] = scale * size[d] * size[e] * level_set.metric[d][e] /
                           level_set.radius;
      }
    else if (level_set.kind == LevelSet<dim>::formula)
      {
        const double step = 2. * difference_step;
        for (unsigned int d = 0; d < dim; ++d)
          for (const int side : {-1, 1})
            for (int k = 1; k <= 2; ++k)
              {
                Point<dim> shifted = xi;
                shifted[d] += side * k * step;
                const Tensor<1, dim> derivative = gradient(shifted);
                const double weight = side * (k == 1 ? 8. : -1.) / (12. * step);
                for (unsigned int e = d; e < dim; ++e)
                  result[d][e] += weight * derivative[e];
              }
      }
    return result;
  }



  template <int dim>
  int
  CellLevelSet<dim>::sign(const BoundingBox<dim> &box) const
  {
    const Point<dim> center  = box.center();
    const auto       slopes  = gradient(center);
    const auto       curving = hessian(center);
    const bool       guessed = level_set.kind == LevelSet<dim>::formula;
    double           radius  = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double half = 0.5 * box.side_length(d);
        radius += std::abs(slopes[d]) * half;
        for (unsigned int e = 0; e < dim; ++e)
          radius += (guessed ? 1. : 0.5) * std::abs(curving[d][e]) * half *
                    0.5 * box.side_length(e);
      }
    const double middle = value(center);
    radius -= same_place;
    if (std::abs(middle) <= radius)
      return 0;
    if (guessed)
      for (unsigned int k = 0; k < (1u << dim); ++k)
        if (value(box.vertex(k)) * middle < 0.)
          return 0;
    return middle < 0. ? -1 : 1;
  }



  template <int dim>
  double
  CellLevelSet<dim>::flatness(const BoundingBox<dim> &box) const
  {
    const Tensor<1, dim> slopes  = gradient(box.center());
    const auto           curving = hessian(box.center());
    double               result  = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        double slope = std::abs(slopes[d]);
        for (unsigned int e = 0; e < dim; ++e)
          slope -= 0.5 * std::abs(curving[d][e]) * box.side_length(e);
        result = std::max(result, slope);
      }
    const double norm = slopes.norm();
    return norm > 0. ? result / norm : 0.;
  }



  template <int dim>
  Plane<dim>
  CellLevelSet<dim>::tangent_plane(const Point<dim> &xi) const
  {
    Point<dim> x = xi;
    if (level_set.kind != LevelSet<dim>::plane)
      for (unsigned int step = 0; step < 3; ++step)
        {
          const auto   slopes = gradient(x);
          const double square = slopes.norm_square();
          if (square > 0.)
            x -= value(x) / square * slopes;
        }
    Plane<dim>     result;
    Tensor<1, dim> slopes = gradient(x);
    const double   norm   = slopes.norm();
    if (norm == 0.)
      slopes[0] = 1.;
    result.normal = slopes / (norm > 0. ? norm : 1.);
    result.offset = result.normal * x;
    if (norm > 0.)
      result.offset -= value(x) / norm;
    return result;
  }



  template <int dim>
  unsigned int
  CellLevelSet<dim>::axis() const
  {
    if (level_set.kind == LevelSet<dim>::plane)
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(level_set.as_plane.normal[d]) == 1.)
          return d;
    return dim;
  }



  template <int dim>
  typename ShapeTree<dim>::Side
  ShapeTree<dim>::evaluate(const std::vector<Side> &sides,
                           std::vector<bool>       &active) const
  {
    const Side side = evaluate(root, sides, nullptr);
    if (side == unknown)
      evaluate(root, sides, &active);
    return side;
  }



  template <int dim>
  typename ShapeTree<dim>::Side
  ShapeTree<dim>::evaluate(const Node              &node,
                           const std::vector<Side> &sides,
                           std::vector<bool>       *active) const
  {
    Side side = unknown;
    if (node.kind == Node::leaf)
      {
        side = sides[node.level_set];
        if (active && side == unknown)
          (*active)[node.level_set] = true;
      }
    else
      {
        // An intersection is outside if one child is, a union inside.
        const Side deciding = node.kind == Node::all_of ? outside : inside;
        side                = Side(-deciding);
        for (const Node &child : node.children)
          {
            const Side other = evaluate(child, sides, nullptr);
            if (other == deciding)
              {
                side = deciding;
                break;
              }
            if (other == unknown)
              side = unknown;
          }
        if (active && side == unknown)
          for (const Node &child : node.children)
            evaluate(child, sides, active);
      }
    return node.inverted ? Side(-side) : side;
  }



  GREVILLE_INSTANTIATE_CLASS(LevelSet);
  GREVILLE_INSTANTIATE_CLASS(CellLevelSet);
  template ShapeTree<2>::Side
  ShapeTree<2>::evaluate(const std::vector<Side> &, std::vector<bool> &) const;
  template ShapeTree<3>::Side
  ShapeTree<3>::evaluate(const std::vector<Side> &, std::vector<bool> &) const;
} // namespace greville
