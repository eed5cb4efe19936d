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



    /// Find the largest overlap in equal cells of the size @p h, m.
    template <int dim>
    Overlap<dim>
    overlap_in_equal_cells(const Sides<dim> &sides,
                           Tensor<1, dim>    h,
                           const MPI_Comm    comm)
    {
      Point<dim> lower, upper;
      if (!find_common_box(sides, lower, upper, comm))
        return {};
      // Add the range of points that affect volume fractions in the box.
      lower -= 2. * h;
      upper += 2. * h;
      double sums[2] = {}; // of spacings, and their number
      double largest = 0.; // spacing
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



    /// Return the edges of a level of a lattice in a direction.
    template <int dim>
    std::vector<double>
    edges_of_level(const Lattice<dim> &lattice,
                   const unsigned int  level,
                   const unsigned int  d)
    {
      std::vector<double> result;
      if (const CellHierarchy<dim> *levels = lattice.hierarchy())
        {
          const auto first =
            (*levels->edges())[d].begin() + levels->offset(level)[d];
          result.assign(first, first + levels->n_cells(level)[d] + 1);
        }
      else
        for (unsigned int k = 0; k <= lattice.n_cells()[d]; ++k)
          result.push_back(lattice.edge(d, k));
      return result;
    }



    /// Return the edges between @p lower and @p upper: each lattice is a part
    /// of one grid. Between and beyond the lattices, cells have the size of the
    /// next cell of a lattice.
    template <int dim>
    std::vector<double>
    edges_between(const std::vector<Lattice<dim>> &lattices,
                  const unsigned int               level,
                  const unsigned int               d,
                  const double                     lower,
                  const double                     upper)
    {
      std::vector<std::vector<double>> parts;
      for (const Lattice<dim> &lattice : lattices)
        parts.push_back(edges_of_level(lattice, level, d));
      std::sort(parts.begin(), parts.end());
      std::vector<double> result = parts[0];
      for (const std::vector<double> &part : parts)
        {
          const double h = result.back() - result[result.size() - 2];
          while (result.back() + 1.5 * h < part.front())
            result.push_back(result.back() + h);
          for (const double edge : part)
            if (edge > result.back() + 1e-6 * h)
              result.push_back(edge);
        }
      const double last = result.back() - result[result.size() - 2];
      while (result.back() < upper)
        result.push_back(result.back() + last);
      const double        first = result[1] - result[0];
      std::vector<double> before;
      while (result.front() - before.size() * first > lower)
        before.push_back(result.front() - (before.size() + 1.) * first);
      result.insert(result.begin(), before.rbegin(), before.rend());
      return result;
    }



    /// Return each n-th edge.
    std::vector<double>
    every(const std::vector<double> &edges, const unsigned int n)
    {
      std::vector<double> result;
      for (std::size_t k = 0; k + 1 < edges.size(); k += n)
        result.push_back(edges[k]);
      result.push_back(edges.back());
      return result;
    }



    /// Return the level of the largest cell at x of refined grids.
    template <int dim>
    unsigned int
    level_at(const std::vector<Lattice<dim>> &lattices, const Point<dim> &x)
    {
      unsigned int result = numbers::invalid_unsigned_int;
      for (const Lattice<dim> &lattice : lattices)
        result = std::min(result,
                          lattice.hierarchy()
                            ? lattice.hierarchy()->level(lattice.find_cell(x))
                            : 0);
      return result;
    }



    /// Collective. Return how many cells to join in each direction, so that a
    /// cell has two of these points in each direction, and no point is larger
    /// than a cell.
    template <int dim>
    unsigned int
    cells_for_points(const std::vector<VolumePoint<dim>> &points,
                     const CellEdges<dim>                &edges,
                     const MPI_Comm                       comm)
    {
      double sums[2] = {}, largest = 0.;
      for (const VolumePoint<dim> &point : points)
        {
          double volume = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const auto end = std::upper_bound(edges[d].begin() + 1,
                                                edges[d].end() - 1,
                                                point.x[d]);
              volume *= end[0] - end[-1];
            }
          const double share = std::pow(point.volume / volume, 1. / dim);
          sums[0] += share;
          sums[1] += 1.;
          largest = std::max(largest, share);
        }
      Utilities::MPI::sum(ArrayView<const double>(sums, 2),
                          comm,
                          ArrayView<double>(sums, 2));
      largest = Utilities::MPI::max(largest, comm);
      return std::max(
        1.,
        std::round(std::max(largest, 2. * sums[0] / std::max(sums[1], 1.))));
    }
  } // namespace



  template <int dim>
  Overlap<dim>
  overlap_of_bodies(const Sides<dim>                &sides,
                    const std::vector<Lattice<dim>> &lattices,
                    const MPI_Comm                   comm)
  {
    Tensor<1, dim> h;
    bool           is_uniform = true;
    for (const Lattice<dim> &lattice : lattices)
      {
        is_uniform = is_uniform && has_equal_cells(lattice);
        for (unsigned int d = 0; d < dim; ++d)
          h[d] = std::max(h[d], lattice.largest_cell_size(d));
      }
    if (is_uniform)
      return overlap_in_equal_cells(sides, h, comm);
    Point<dim> lower, upper;
    if (!find_common_box(sides, lower, upper, comm))
      return {};
    lower -= 2. * h;
    upper += 2. * h;
    unsigned int n_levels = 1;
    for (const Lattice<dim> &lattice : lattices)
      if (lattice.hierarchy())
        n_levels = std::max(n_levels, lattice.hierarchy()->n_levels());
    std::vector<std::vector<VolumePoint<dim>>> of_levels(n_levels);
    for (unsigned int side = 0; side < 2; ++side)
      for (unsigned int b = 0; b < sides[side].size(); ++b)
        sides[side][b]->points.for_each([&](const ConstPointRef<dim> p) {
          VolumePoint<dim> point;
          point.x = p.position();
          for (unsigned int d = 0; d < dim; ++d)
            if (point.x[d] < lower[d] || point.x[d] > upper[d])
              return;
          point.volume =
            std::pow(p.extent(sides[side][b]->points.layout()), dim);
          point.side = side;
          point.body = b;
          of_levels[level_at(lattices, point.x)].push_back(point);
        });
    Overlap<dim>                  result;
    std::vector<VolumePoint<dim>> points;
    for (unsigned int level = n_levels; level-- > 0;)
      {
        CellEdges<dim> edges;
        for (unsigned int d = 0; d < dim; ++d)
          edges[d] = edges_between(lattices, level, d, lower[d], upper[d]);
        const unsigned int n =
          cells_for_points<dim>(of_levels[level], edges, comm);
        for (unsigned int d = 0; d < dim; ++d)
          edges[d] = every(edges[d], n);
        points.insert(points.end(),
                      of_levels[level].begin(),
                      of_levels[level].end());
        const Overlap<dim> of_level = largest_overlap<dim>(points, edges, comm);
        if (of_level.excess > result.excess)
          result = of_level;
      }
    return result;
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



  template Overlap<2>
  overlap_of_bodies(const Sides<2> &,
                    const std::vector<Lattice<2>> &,
                    const MPI_Comm);
  template Overlap<3>
  overlap_of_bodies(const Sides<3> &,
                    const std::vector<Lattice<3>> &,
                    const MPI_Comm);
  GREVILLE_INSTANTIATE(inside_text);
  GREVILLE_INSTANTIATE(overlap_text);
  GREVILLE_INSTANTIATE(is_deep);
  GREVILLE_INSTANTIATE(mirrored);
} // namespace greville
