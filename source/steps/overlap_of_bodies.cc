// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/overlap_of_bodies.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Collective. Find the intersection of the boxes around the points of both
    /// sides. Return whether there is one.
    template <int dim>
    bool
    find_common_box(const Sides<dim> &sides,
                    Point<dim>       &lower,
                    Point<dim>       &upper,
                    const MPI_Comm    comm)
    {
      // The largest -x and x of each side.
      constexpr double    none = std::numeric_limits<double>::lowest();
      std::vector<double> extremes(4 * dim, none);
      for (unsigned int side = 0; side < 2; ++side)
        for (const Body<dim> *body : sides[side])
          body->points.for_each([&](const ConstPointRef<dim> p) {
            double *const of_side = &extremes[2 * side * dim];
            for (unsigned int d = 0; d < dim; ++d)
              {
                of_side[d]       = std::max(of_side[d], -p.position(d));
                of_side[dim + d] = std::max(of_side[dim + d], p.position(d));
              }
          });
      Utilities::MPI::max(extremes, comm, extremes);
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = -std::min(extremes[d], extremes[2 * dim + d]);
          upper[d] = std::min(extremes[dim + d], extremes[3 * dim + d]);
          if (lower[d] >= upper[d])
            return false;
        }
      return true;
    }
  } // namespace



  template <int dim>
  Overlap<dim>
  overlap_of_bodies(const Sides<dim> &sides,
                    Tensor<1, dim>    h,
                    const MPI_Comm    comm)
  {
    Point<dim> lower, upper;
    if (!find_common_box(sides, lower, upper, comm))
      return {};
    // Add the range of points that affect volume fractions in the box.
    lower -= 2. * h;
    upper += 2. * h;
    double                        sums[2] = {}; // of spacings, and their number
    double                        largest = 0.; // spacing
    std::vector<VolumePoint<dim>> points;
    for (unsigned int side = 0; side < 2; ++side)
      for (unsigned int b = 0; b < sides[side].size(); ++b)
        {
          const auto &of_body = sides[side][b]->points;
          of_body.for_each([&](const ConstPointRef<dim> p) {
            VolumePoint<dim> point;
            point.x = p.position();
            for (unsigned int d = 0; d < dim; ++d)
              if (point.x[d] < lower[d] || point.x[d] > upper[d])
                return;
            const double extent = p.extent(of_body.layout());
            point.volume        = std::pow(extent, dim);
            point.side          = side;
            point.body          = b;
            points.push_back(point);
            sums[0] += extent;
            sums[1] += 1.;
            largest = std::max(largest, extent);
          });
        }
    Utilities::MPI::sum(ArrayView<const double>(sums, 2),
                        comm,
                        ArrayView<double>(sums, 2));
    if (sums[1] == 0.)
      return {};
    largest = Utilities::MPI::max(largest, comm);
    for (unsigned int d = 0; d < dim; ++d)
      h[d] = std::max(h[d], std::max(largest, 2. * sums[0] / sums[1]));
    return largest_overlap(points, h, comm);
  }



  template <int dim>
  std::string
  inside_text(const Body<dim>   &body,
              const Point<dim>  &x,
              const std::string &other)
  {
    return "a point of 'Body " + body.name + "' at (" + text_of(x) +
           ") m is inside of " + other;
  }



  template <int dim>
  std::string
  overlap_text(const Sides<dim> &sides, const Overlap<dim> &overlap)
  {
    std::string names;
    for (const Body<dim> *other : sides[1 - overlap.side])
      names += (names.empty() ? "'Body " : " or 'Body ") + other->name + "'";
    return inside_text(*sides[overlap.side][overlap.body], overlap.x, names);
  }



  template <int dim>
  bool
  is_deep(const Inside<dim> &is_inside,
          const Point<dim>  &x,
          const double       distance)
  {
    if (!is_inside(x))
      return false;
    constexpr unsigned int n_directions = dim == 2 ? 9 : 27;
    for (unsigned int k = 0; k < n_directions; ++k)
      {
        Tensor<1, dim> direction;
        for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
          direction[d] = double(rest % 3) - 1.;
        if (direction.norm_square() > 0. &&
            !is_inside(x + distance / direction.norm() * direction))
          return false;
      }
    return true;
  }



  template <int dim>
  Inside<dim>
  mirrored(const Inside<dim> &is_inside, const bool is_axisymmetric)
  {
    if (!is_axisymmetric)
      return is_inside;
    return [is_inside](Point<dim> x) {
      x[0] = std::abs(x[0]);
      return is_inside(x);
    };
  }



  GREVILLE_INSTANTIATE(overlap_of_bodies);
  GREVILLE_INSTANTIATE(inside_text);
  GREVILLE_INSTANTIATE(overlap_text);
  GREVILLE_INSTANTIATE(is_deep);
  GREVILLE_INSTANTIATE(mirrored);
} // namespace greville
