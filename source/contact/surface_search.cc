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

    // The least weighted area of points near a projection; a plane full of
    // points has 1. Less indicates the end of the surface.
    constexpr double smallest_cover = 0.4;

    constexpr unsigned int n_projections = 3;

    // The numbers of a point in a message: number, side, position, normal, the
    // area, in axisymmetry the length in the plane, and the cell size.
    template <int dim>
    constexpr unsigned int row_size = 4 + 2 * dim;



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

      /// For each side, level (see Extent) and box, the indices at which the
      /// rows of its points begin.
      using Boxes = std::unordered_map<Box, std::vector<unsigned int>, Hash>;
      std::array<std::map<unsigned int, Boxes>, 2> levels;
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
        double         radius; // of the support of its weight
        double         reach;  // the largest gap to the point x
      };

      std::vector<Sample> samples;

      /// Project the point onto the surface. Returns whether this succeeds.
      bool
      project(const Point<dim>     &x,
              const Tensor<1, dim> &normal,
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
        if (!nearest || std::sqrt(square) > nearest->reach + nearest->radius)
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
                const double r = sample.radius;
                const double s = sample.x.distance_square(y) / (r * r);
                if (s >= 1. || sample.normal * first < smallest_cosine_of_side)
                  continue;
                const double full =
                  dim == 2 ? 16. / 15. * r : numbers::PI / 3. * r * r;
                const double w = sample.area / full * (1. - s) * (1. - s);
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
        gap           = (x - y) * n;
        target_normal = n;
        return cover >= smallest_cover && std::abs(gap) < nearest->reach &&
               (!has_normal || n * normal < largest_cosine_of_facing);
      }
    };



    /// The boxes around both sides, and the boxes of a search. Lengths at a
    /// point are multiples of its cell size h. Points whose h is at most
    /// @f$2^l@f$ times the smallest one belong to the boxes of level l.
    template <int dim>
    struct Extent
    {
      /// Collective.
      Extent(const std::vector<ContactPoint<dim>> &points,
             const double                          reach,
             const MPI_Comm                        comm)
        : reach(reach)
        , extremes(4 * dim + 3, none)
      {
        for (const ContactPoint<dim> &point : points)
          {
            double *const of_side = &extremes[(2 * point.side) * dim];
            for (unsigned int d = 0; d < dim; ++d)
              {
                of_side[d]       = std::max(of_side[d], -point.x[d]);
                of_side[dim + d] = std::max(of_side[dim + d], point.x[d]);
              }
            const double h        = point.cell_size;
            const double area     = point.area / point.thickness;
            const double spacing  = dim == 2 ? area : std::sqrt(area);
            extremes[4 * dim]     = std::max(extremes[4 * dim], spacing / h);
            extremes[4 * dim + 1] = std::max(extremes[4 * dim + 1], -h);
            extremes[4 * dim + 2] = std::max(extremes[4 * dim + 2], h);
          }
        Utilities::MPI::max(extremes, comm, extremes);
        radius   = 2. * extremes[4 * dim];
        size     = reach + 2. * radius;
        smallest = -extremes[4 * dim + 1];
        largest  = extremes[4 * dim + 2];
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
          if (point.x[d] < -other[d] - size * largest ||
              point.x[d] > other[dim + d] + size * largest)
            return false;
        return true;
      }

      using Box = typename Meeting<dim>::Box;

      static Box
      box_of(const Point<dim> &x, const double edge)
      {
        Box box;
        for (unsigned int d = 0; d < dim; ++d)
          box[d] = std::int64_t(std::floor(x[d] / edge));
        return box;
      }

      unsigned int
      level_of(const double h) const
      {
        unsigned int level = 0;
        while (h > (1. + 1e-9) * cell_size(level))
          ++level;
        return level;
      }

      /// Return the largest cell size of a level.
      double
      cell_size(const unsigned int level) const
      {
        return std::ldexp(smallest, level);
      }

      /// Return the largest box, which determines the process of a point.
      Box
      large_box_of(const Point<dim> &x) const
      {
        return box_of(x, size * largest);
      }

      /// Call action for all boxes with an @p edge that are closer to x than
      /// @p distance.
      template <typename Action>
      static void
      for_boxes(const Point<dim> &x,
                const double      distance,
                const double      edge,
                const Action     &action)
      {
        Point<dim> ends[2] = {x, x};
        for (unsigned int d = 0; d < dim; ++d)
          {
            ends[0][d] -= distance;
            ends[1][d] += distance;
          }
        const Box first = box_of(ends[0], edge), last = box_of(ends[1], edge);
        Box       box = first;
        while (box[dim - 1] <= last[dim - 1])
          {
            action(box);
            unsigned int d = 0;
            for (++box[0]; d + 1 < dim && box[d] > last[d]; ++box[d])
              {
                box[d] = first[d];
                ++d;
              }
          }
      }

      /// The largest gap, the radius of weights and the distance at which
      /// points may interact, in cells.
      const double reach;
      double       radius, size;
      /// The cell sizes, m.
      double smallest, largest;

    private:
      /// For each side, the largest -x and x of its points; the largest
      /// spacing of a point in cells; the largest -h and h.
      static constexpr double none = std::numeric_limits<double>::lowest();
      std::vector<double>     extremes;
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
            extent.for_boxes(point.x,
                             extent.size * extent.largest,
                             extent.size * extent.largest,
                             [&](const auto &box) {
                               owners.insert(
                                 owner_of(typename Meeting<dim>::Hash()(box),
                                          n_processes));
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
              rows.push_back(point.cell_size);
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
          {
            const unsigned int level = extent.level_of(cell_size(row));
            meeting
              .levels[unsigned(rows[row + 1])][level]
                     [extent.box_of(position(row, 2), edge_of(level))]
              .push_back(row);
          }
      }

      /// Project the points in boxes of this process, and return, for each
      /// sender, numbers, gaps and normals of the points that face a surface.
      Rows
      project(const unsigned int n_processes, const unsigned int me)
      {
        Rows answers;
        auto sender = ends.begin();
        for (unsigned int row = 0; row < rows.size(); row += row_size<dim>)
          {
            while (row >= sender->second)
              ++sender;
            const Point<dim> x = position(row, 2);
            if (owner_of(typename Meeting<dim>::Hash()(extent.large_box_of(x)),
                         n_processes) != me)
              continue;
            const Tensor<1, dim> normal = position(row, 2 + dim);
            find_samples(row, x, normal);
            if (surface.samples.empty())
              continue;
            // Material points are no surface: it is enough that one is near.
            double         gap    = 0.;
            Tensor<1, dim> target = -normal;
            if (surface.samples.front().normal.norm_square() > 0. &&
                !surface.project(x, normal, gap, target))
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

      double
      cell_size(const unsigned int row) const
      {
        return rows[row + 3 + 2 * dim];
      }

      double
      edge_of(const unsigned int level) const
      {
        return extent.size * extent.cell_size(level);
      }

      /// Return the largest gap between points with these cell sizes. It is
      /// larger than the displacements of both, which are limited by their
      /// cells.
      double
      reach(const double h, const double other) const
      {
        return extent.reach * 0.5 * (h + other);
      }

      /// Collect the points of the other side around a point, and their mirror
      /// images behind the axis.
      void
      find_samples(const unsigned int    row,
                   const Point<dim>     &x,
                   const Tensor<1, dim> &normal)
      {
        surface.samples.clear();
        const double h          = cell_size(row);
        const auto   add_sample = [&](const Point<dim>     &y,
                                    const Tensor<1, dim> &m,
                                    const unsigned int    other) {
          const double of_other = cell_size(other);
          const double radius   = extent.radius * of_other;
          const double gap      = reach(h, of_other);
          if (m * normal < 0.5 &&
              y.distance_square(x) < std::pow(gap + 2. * radius, 2))
            surface.samples.push_back(
              {y, m, rows[other + 2 + 2 * dim], radius, gap});
        };
        for (const auto &[level, boxes] :
             meeting.levels[1 - unsigned(rows[row + 1])])
          {
            const double largest = extent.cell_size(level);
            extent.for_boxes(x,
                             reach(h, largest) + 2. * extent.radius * largest,
                             edge_of(level),
                             [&, &boxes = boxes](const auto &near) {
                               const auto found = boxes.find(near);
                               if (found == boxes.end())
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
      met.project(n_processes, Utilities::MPI::this_mpi_process(comm)));
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
