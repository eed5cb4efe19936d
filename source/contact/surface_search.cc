// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/numbers.h>

#include <greville/base/mixed_bits.h>
#include <greville/contact/surface_search.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Surfaces face one another where the cosine of the angle between normals
    // is below this, and belong to one another where it is above that.
    constexpr double largest_cosine = -0.7, least_alike = 0.5;

    // Of the weights that a plane full of points would have: less is an end of
    // the surface.
    constexpr double least_cover = 0.4;

    constexpr unsigned int n_projections = 3;

    // Numbers of a point in a message: number, side, position, normal, and the
    // area, in axisymmetry the length in the plane.
    template <int dim>
    constexpr unsigned int row_size = 3 + 2 * dim;



    /**
     * Points of both sides that have come together on this process.
     */
    template <int dim>
    struct Meeting
    {
      using Box = std::array<std::int64_t, dim>;

      struct Hash
      {
        std::size_t
        operator()(const Box &box) const
        {
          std::uint64_t bits = 0;
          for (const std::int64_t i : box)
            bits = mixed_bits(bits ^ std::uint64_t(i));
          return bits;
        }
      };

      /// By side and box, the first number of the row of a point.
      std::array<std::unordered_map<Box, std::vector<unsigned int>, Hash>, 2>
        boxes;
    };



    /**
     * The surface of the points in reach of one of the other side.
     */
    template <int dim>
    class LocalSurface
    {
    public:
      struct Sample
      {
        Point<dim>     x;
        Tensor<1, dim> normal;
        double         area;
      };

      std::vector<Sample> samples;

      /**
       * Project the point onto the surface. Returns whether there is one.
       */
      bool
      project(const Point<dim>     &x,
              const Tensor<1, dim> &normal,
              const double          radius,
              const double          reach,
              double               &gap,
              Tensor<1, dim>       &target_normal)
      {
        const bool    has_normal = normal.norm_square() > 0.;
        const Sample *nearest    = nullptr;
        double        square     = std::numeric_limits<double>::max();
        for (const Sample &sample : samples)
          if ((!has_normal || sample.normal * normal < largest_cosine) &&
              sample.x.distance_square(x) < square)
            {
              nearest = &sample;
              square  = sample.x.distance_square(x);
            }
        if (!nearest || std::sqrt(square) > reach + radius)
          return false;
        const Tensor<1, dim> first = nearest->normal;
        Point<dim>           y     = x - ((x - nearest->x) * first) * first;
        Tensor<1, dim>       n;
        double               cover = 0.;
        for (unsigned int k = 0; k < n_projections; ++k)
          {
            double         distance = 0.;
            Tensor<1, dim> center;
            n     = Tensor<1, dim>();
            cover = 0.;
            for (const Sample &sample : samples)
              {
                const double s =
                  sample.x.distance_square(y) / (radius * radius);
                if (s >= 1. || sample.normal * first < least_alike)
                  continue;
                const double w = sample.area * (1. - s) * (1. - s);
                cover += w;
                n += w * sample.normal;
                distance += w * ((y - sample.x) * sample.normal);
                center += w * (sample.x - y);
              }
            if (!(cover > 0.))
              return false;
            n /= n.norm();
            y -= 0.5 * (distance - center * n) / cover * n;
            const Tensor<1, dim> to_x = x - y;
            y += to_x - (to_x * n) * n;
          }
        const double full =
          dim == 2 ? 16. / 15. * radius : numbers::PI / 3. * radius * radius;
        gap           = (x - y) * n;
        target_normal = n;
        return cover >= least_cover * full && std::abs(gap) < reach &&
               (!has_normal || n * normal < largest_cosine);
      }
    };
  } // namespace



  template <int dim>
  void
  SurfaceSearch<dim>::find_gaps(std::vector<ContactPoint<dim>> &points,
                                const double                    reach) const
  {
    for (ContactPoint<dim> &point : points)
      point.is_facing = false;
    // The boxes around both sides, as the largest -x and x, and the largest
    // area or length of a point.
    constexpr double    none = std::numeric_limits<double>::lowest();
    std::vector<double> extremes(4 * dim + 1, none);
    for (const ContactPoint<dim> &point : points)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            double *const of_side = &extremes[(2 * point.side) * dim];
            of_side[d]            = std::max(of_side[d], -point.x[d]);
            of_side[dim + d]      = std::max(of_side[dim + d], point.x[d]);
          }
        extremes[4 * dim] =
          std::max(extremes[4 * dim], point.area / point.thickness);
      }
    Utilities::MPI::max(extremes, comm, extremes);
    for (unsigned int side = 0; side < 2; ++side)
      if (extremes[2 * side * dim] == none)
        return;
    const double spacing =
      dim == 2 ? extremes[4 * dim] : std::sqrt(extremes[4 * dim]);
    const double radius = 2. * spacing;
    const double size   = reach + 2. * radius; // of a box

    const auto is_near_other = [&](const ContactPoint<dim> &point) {
      const double *const other = &extremes[(2 * (1 - point.side)) * dim];
      for (unsigned int d = 0; d < dim; ++d)
        if (point.x[d] < -other[d] - size || point.x[d] > other[dim + d] + size)
          return false;
      return true;
    };
    using Box         = typename Meeting<dim>::Box;
    const auto box_of = [&](const Point<dim> &x) {
      Box box;
      for (unsigned int d = 0; d < dim; ++d)
        box[d] = std::int64_t(std::floor(x[d] / size));
      return box;
    };
    const auto for_neighbors = [](const Box &box, const auto &action) {
      constexpr unsigned int n = dim == 2 ? 9 : 27;
      for (unsigned int k = 0; k < n; ++k)
        {
          Box other = box;
          for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
            other[d] += int(rest % 3) - 1;
          action(other);
        }
    };
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    const auto         owner_of    = [&](const Box &box) {
      return unsigned(typename Meeting<dim>::Hash()(box) % n_processes);
    };

    // A point is on the process of its box to be projected, and on those of the
    // boxes around it, where others are projected onto it.
    constexpr unsigned int                      n = row_size<dim>;
    std::map<unsigned int, std::vector<double>> to_send;
    for (unsigned int k = 0; k < points.size(); ++k)
      {
        const ContactPoint<dim> &point = points[k];
        if (!is_near_other(point))
          continue;
        std::set<unsigned int> owners;
        if (n_processes == 1)
          owners.insert(0);
        else
          for_neighbors(box_of(point.x),
                        [&](const Box &box) { owners.insert(owner_of(box)); });
        for (const unsigned int owner : owners)
          {
            std::vector<double> &rows = to_send[owner];
            rows.push_back(k);
            rows.push_back(point.side);
            for (unsigned int d = 0; d < dim; ++d)
              rows.push_back(point.x[d]);
            for (unsigned int d = 0; d < dim; ++d)
              rows.push_back(point.normal[d]);
            rows.push_back(point.area / point.thickness);
          }
      }
    const unsigned int me = Utilities::MPI::this_mpi_process(comm);
    const auto         received =
      n_processes == 1 ? to_send : Utilities::MPI::some_to_some(comm, to_send);

    std::vector<double>                               rows;
    std::vector<std::pair<unsigned int, std::size_t>> ends; // of each sender
    for (const auto &[sender, of_sender] : received)
      {
        rows.insert(rows.end(), of_sender.begin(), of_sender.end());
        ends.emplace_back(sender, rows.size());
      }
    const auto position = [&](const unsigned int row, const unsigned int from) {
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = rows[row + from + d];
      return x;
    };
    Meeting<dim> meeting;
    for (unsigned int row = 0; row < rows.size(); row += n)
      meeting.boxes[unsigned(rows[row + 1])][box_of(position(row, 2))]
        .push_back(row);

    std::map<unsigned int, std::vector<double>> answers;
    LocalSurface<dim>                           surface;
    auto                                        sender = ends.begin();
    for (unsigned int row = 0; row < rows.size(); row += n)
      {
        while (row >= sender->second)
          ++sender;
        const Point<dim> x   = position(row, 2);
        const Box        box = box_of(x);
        if (owner_of(box) != me)
          continue;
        surface.samples.clear();
        const Tensor<1, dim> normal = position(row, 2 + dim);
        const auto &others     = meeting.boxes[1 - unsigned(rows[row + 1])];
        const auto  add_sample = [&](const Point<dim>     &y,
                                    const Tensor<1, dim> &m,
                                    const unsigned int    other) {
          if (m * normal < 0.5 && y.distance_square(x) < std::pow(size, 2))
            surface.samples.push_back({y, m, rows[other + 2 + 2 * dim]});
        };
        for_neighbors(box, [&](const Box &near) {
          const auto found = others.find(near);
          if (found == others.end())
            return;
          for (const unsigned int other : found->second)
            {
              Point<dim>     y = position(other, 2);
              Tensor<1, dim> m = position(other, 2 + dim);
              add_sample(y, m, other);
              if (is_axisymmetric)
                {
                  y[0] = -y[0];
                  m[0] = -m[0];
                  add_sample(y, m, other);
                }
            }
        });
        if (surface.samples.empty())
          continue;
        // Material points are no surface: what is near is all that is asked.
        double         gap    = 0.;
        Tensor<1, dim> target = -normal;
        if (surface.samples.front().normal.norm_square() > 0. &&
            !surface.project(x, normal, radius, reach, gap, target))
          continue;
        std::vector<double> &answer = answers[sender->first];
        answer.push_back(rows[row]);
        answer.push_back(gap);
        for (unsigned int d = 0; d < dim; ++d)
          answer.push_back(target[d]);
      }
    for (const auto &[process, answer] :
         n_processes == 1 ? answers
                          : Utilities::MPI::some_to_some(comm, answers))
      for (unsigned int k = 0; k < answer.size(); k += 2 + dim)
        {
          ContactPoint<dim> &point = points[unsigned(answer[k])];
          point.is_facing          = true;
          point.gap                = answer[k + 1] - point.radius;
          for (unsigned int d = 0; d < dim; ++d)
            point.target_normal[d] = answer[k + 2 + d];
        }
  }



  template class SurfaceSearch<2>;
  template class SurfaceSearch<3>;
} // namespace greville
