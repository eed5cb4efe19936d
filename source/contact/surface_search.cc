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
    // Surfaces face one another if the cosine of the angle between the normals
    // is below the first number; points belong to one surface if it is above
    // the second.
    constexpr double largest_cosine_of_facing = -0.7,
                     smallest_cosine_of_side  = 0.5;

    // The least weighted area of points near a projection, relative to a plane
    // full of points: less indicates the end of the surface.
    constexpr double smallest_cover = 0.4;

    constexpr unsigned int n_projections = 3;

    // The numbers of a point in a message: number, side, position, normal, and
    // the area, in axisymmetry the length in the plane.
    template <int dim>
    constexpr unsigned int row_size = 3 + 2 * dim;



    /// Points of both sides that have been sent to this process.
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

      /// For each side and box, the indices at which the rows of its points
      /// begin.
      std::array<std::unordered_map<Box, std::vector<unsigned int>, Hash>, 2>
        boxes;
    };



    /// The surface through the points near a point of the other side.
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

      /// Project the point onto the surface. Returns whether this succeeds.
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
          if ((!has_normal ||
               sample.normal * normal < largest_cosine_of_facing) &&
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
                if (s >= 1. || sample.normal * first < smallest_cosine_of_side)
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
        return cover >= smallest_cover * full && std::abs(gap) < reach &&
               (!has_normal || n * normal < largest_cosine_of_facing);
      }
    };



    /// The boxes around both sides, and the size of the boxes of a search.
    template <int dim>
    struct Extent
    {
      /// Collective.
      Extent(const std::vector<ContactPoint<dim>> &points,
             const double                          reach,
             const MPI_Comm                        comm)
        : extremes(4 * dim + 1, none)
      {
        for (const ContactPoint<dim> &point : points)
          {
            double *const of_side = &extremes[(2 * point.side) * dim];
            for (unsigned int d = 0; d < dim; ++d)
              {
                of_side[d]       = std::max(of_side[d], -point.x[d]);
                of_side[dim + d] = std::max(of_side[dim + d], point.x[d]);
              }
            extremes[4 * dim] =
              std::max(extremes[4 * dim], point.area / point.thickness);
          }
        Utilities::MPI::max(extremes, comm, extremes);
        radius =
          2. * (dim == 2 ? extremes[4 * dim] : std::sqrt(extremes[4 * dim]));
        size = reach + 2. * radius;
      }

      bool
      has_both_sides() const
      {
        return extremes[0] != none && extremes[2 * dim] != none;
      }

      bool
      is_near_other(const ContactPoint<dim> &point) const
      {
        const double *const other = &extremes[(2 * (1 - point.side)) * dim];
        for (unsigned int d = 0; d < dim; ++d)
          if (point.x[d] < -other[d] - size ||
              point.x[d] > other[dim + d] + size)
            return false;
        return true;
      }

      using Box = typename Meeting<dim>::Box;

      Box
      box_of(const Point<dim> &x) const
      {
        Box box;
        for (unsigned int d = 0; d < dim; ++d)
          box[d] = std::int64_t(std::floor(x[d] / size));
        return box;
      }

      template <typename Action>
      static void
      for_neighbors(const Box &box, const Action &action)
      {
        constexpr unsigned int n = dim == 2 ? 9 : 27;
        for (unsigned int k = 0; k < n; ++k)
          {
            Box other = box;
            for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
              other[d] += int(rest % 3) - 1;
            action(other);
          }
      }

      /// For each side, the largest -x and x of its points, and the largest
      /// area (2D: length) of a point.
      static constexpr double none = std::numeric_limits<double>::lowest();
      std::vector<double>     extremes;
      double                  radius, size;
    };



    using Rows = std::map<unsigned int, std::vector<double>>; // by process



    unsigned int
    owner_of(const std::size_t hash, const unsigned int n_processes)
    {
      return hash % n_processes;
    }



    /// The rows of points for other processes. The process of a point's box
    /// projects the point; the processes of the boxes around it project other
    /// points onto it.
    template <int dim>
    Rows
    rows_of_points(const std::vector<ContactPoint<dim>> &points,
                   const Extent<dim>                    &extent,
                   const unsigned int                    n_processes)
    {
      Rows result;
      for (unsigned int k = 0; k < points.size(); ++k)
        {
          const ContactPoint<dim> &point = points[k];
          if (!extent.is_near_other(point))
            continue;
          std::set<unsigned int> owners;
          if (n_processes == 1)
            owners.insert(0);
          else
            extent.for_neighbors(extent.box_of(point.x), [&](const auto &box) {
              owners.insert(
                owner_of(typename Meeting<dim>::Hash()(box), n_processes));
            });
          for (const unsigned int owner : owners)
            {
              std::vector<double> &rows = result[owner];
              rows.push_back(k);
              rows.push_back(point.side);
              for (unsigned int d = 0; d < dim; ++d)
                rows.push_back(point.x[d]);
              for (unsigned int d = 0; d < dim; ++d)
                rows.push_back(point.normal[d]);
              rows.push_back(point.area / point.thickness);
            }
        }
      return result;
    }



    /// Rows of points that have come to this process.
    template <int dim>
    class MetPoints
    {
    public:
      MetPoints(const Rows        &received,
                const Extent<dim> &extent,
                const bool         is_axisymmetric)
        : extent(extent)
        , is_axisymmetric(is_axisymmetric)
      {
        for (const auto &[sender, of_sender] : received)
          {
            rows.insert(rows.end(), of_sender.begin(), of_sender.end());
            ends.emplace_back(sender, rows.size());
          }
        for (unsigned int row = 0; row < rows.size(); row += row_size<dim>)
          meeting
            .boxes[unsigned(rows[row + 1])][extent.box_of(position(row, 2))]
            .push_back(row);
      }

      /// Project the points in boxes of this process, and return, for each
      /// sender, numbers, gaps and normals of the points that face a surface.
      Rows
      project(const double       reach,
              const unsigned int n_processes,
              const unsigned int me)
      {
        Rows answers;
        auto sender = ends.begin();
        for (unsigned int row = 0; row < rows.size(); row += row_size<dim>)
          {
            while (row >= sender->second)
              ++sender;
            const Point<dim> x   = position(row, 2);
            const auto       box = extent.box_of(x);
            if (owner_of(typename Meeting<dim>::Hash()(box), n_processes) != me)
              continue;
            const Tensor<1, dim> normal = position(row, 2 + dim);
            find_samples(row, x, normal, box);
            if (surface.samples.empty())
              continue;
            // Material points are no surface: it is enough that one is near.
            double         gap    = 0.;
            Tensor<1, dim> target = -normal;
            if (surface.samples.front().normal.norm_square() > 0. &&
                !surface.project(x, normal, extent.radius, reach, gap, target))
              continue;
            std::vector<double> &answer = answers[sender->first];
            answer.push_back(rows[row]);
            answer.push_back(gap);
            for (unsigned int d = 0; d < dim; ++d)
              answer.push_back(target[d]);
          }
        return answers;
      }

    private:
      Point<dim>
      position(const unsigned int row, const unsigned int from) const
      {
        Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = rows[row + from + d];
        return x;
      }

      /// Collect the points of the other side around a point, and their mirror
      /// images behind the axis.
      void
      find_samples(const unsigned int                row,
                   const Point<dim>                 &x,
                   const Tensor<1, dim>             &normal,
                   const typename Meeting<dim>::Box &box)
      {
        surface.samples.clear();
        const auto &others     = meeting.boxes[1 - unsigned(rows[row + 1])];
        const auto  add_sample = [&](const Point<dim>     &y,
                                    const Tensor<1, dim> &m,
                                    const unsigned int    other) {
          if (m * normal < 0.5 &&
              y.distance_square(x) < std::pow(extent.size, 2))
            surface.samples.push_back({y, m, rows[other + 2 + 2 * dim]});
        };
        extent.for_neighbors(box, [&](const auto &near) {
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
      }

      const Extent<dim>                                &extent;
      const bool                                        is_axisymmetric;
      std::vector<double>                               rows;
      std::vector<std::pair<unsigned int, std::size_t>> ends; // of each sender
      Meeting<dim>                                      meeting;
      LocalSurface<dim>                                 surface;
    };
  } // namespace



  template <int dim>
  void
  SurfaceSearch<dim>::find_gaps(std::vector<ContactPoint<dim>> &points,
                                const double                    reach) const
  {
    for (ContactPoint<dim> &point : points)
      point.is_facing = false;
    const Extent<dim> extent(points, reach, comm);
    if (!extent.has_both_sides())
      return;
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    const auto         exchange    = [&](const Rows &rows) {
      return n_processes == 1 ? rows : Utilities::MPI::some_to_some(comm, rows);
    };
    MetPoints<dim> met(exchange(rows_of_points(points, extent, n_processes)),
                       extent,
                       is_axisymmetric);
    const Rows     answers = exchange(
      met.project(reach, n_processes, Utilities::MPI::this_mpi_process(comm)));
    for (const auto &[process, answer] : answers)
      for (unsigned int k = 0; k < answer.size(); k += 2 + dim)
        {
          ContactPoint<dim> &point = points[unsigned(answer[k])];
          point.is_facing          = true;
          point.gap                = answer[k + 1] - point.radius;
          for (unsigned int d = 0; d < dim; ++d)
            point.target_normal[d] = answer[k + 2 + d];
        }
  }



  GREVILLE_INSTANTIATE_CLASS(SurfaceSearch);
} // namespace greville
