// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/mixed_bits.h>
#include <greville/contact/combine_by_key.h>
#include <greville/steps/body_contacts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The default distance from a point to the surface of its body, as a
    // fraction of its spacing.
    constexpr double default_radius = 0.5;

    // Sliding distance, in spacings, over which a radius returns to the
    // default.
    constexpr double memory = 10.;

    // Points inside the other side are moved to its surface unless their depth
    // is below this fraction of the spacing, which is round-off.
    constexpr double smallest_lift = 1e-6;

    // Forces below this fraction of the modulus times the area of a point may
    // be neglected in the next step.
    constexpr double negligible_pressure = 1e-10;

    // The critical step is estimated anew if more than this fraction of the
    // contactors is new in a step.
    constexpr double largest_joined_fraction = 0.1;

    // A point touches if its initial depth is below this fraction of its
    // spacing.
    constexpr double deepest_initially = 0.25;



    /// Return the gap at which the outermost layer of points with this
    /// @p spacing ends. @p lowest is the smallest gap nearby. The layer is one
    /// spacing thick. It ends midway between two rows if no point is closer
    /// than half a spacing. A point that @p joins the layer is at most half of
    /// its spacing behind the foremost point. Otherwise, a second row would
    /// enter the mean gap as it approaches, and the contact energy would jump.
    double
    end_of_layer(const double lowest, const double spacing, const bool joins)
    {
      return joins ? std::max(lowest, 0.) + 0.5 * spacing
                   : std::max(std::min(lowest, 0.) + spacing,
                              lowest + 0.5 * spacing);
    }



    template <int dim, typename Action>
    void
    for_each_in_cell(MaterialPoints<dim> &points,
                     const unsigned int   cell,
                     const Action        &action)
    {
      constexpr unsigned int none  = MaterialPoints<dim>::none,
                             width = MaterialPoints<dim>::width;
      unsigned int n               = points.n_in_first_group(cell);
      for (unsigned int g = points.first_group(cell); g != none;
           g = points.next_group(g), n = width)
        for (unsigned int lane = 0; lane < n; ++lane)
          action(points.point(g, lane));
    }



    /// Return a contactor's row for a material point. It keeps the force of the
    /// point's @p last row, if there is one. A radius other than the default
    /// belongs to the initial position; it is forgotten as the point slides.
    /// @p pore is the field of the pore pressure, null without water.
    template <int dim, typename MaterialPoint>
    std::vector<double>
    contactor(const PointLayout<dim>  &layout,
              const MaterialPoint     &candidate,
              const ContactPoint<dim> &met,
              const double             radius,
              const PointField        *pore,
              const double            *last)
    {
      std::vector<double>  row(layout.size, 0.);
      const PointRef<dim>  p(row.data());
      const PointRef<dim> &from   = candidate.point;
      const unsigned int   before = layout.first("before");
      if (last)
        {
          std::copy(last, last + layout.size, row.begin());
          const double way =
            (from.position() - Point<dim>(p.vector(before)) - met.target_motion)
              .norm();
          const double last_radius = p[layout.first("last_radius")];
          p[layout.first("radius")] =
            last_radius + (default_radius * candidate.spacing - last_radius) *
                            std::min(1., way / (memory * candidate.spacing));
        }
      else
        {
          p[layout.first("radius")]      = radius;
          p[layout.first("last_radius")] = radius;
          p[layout.first("gap")]         = met.gap - radius;
          if (pore)
            p[layout.first("pore_pressure")] = from[pore->first];
          for (unsigned int d = 0; d < dim; ++d)
            p[before + d] = from.position(d);
        }
      for (unsigned int d = 0; d < dim; ++d)
        {
          p[layout.first("normal") + d] = -met.target_normal[d];
          p.position(d)                 = from.position(d);
          p.reference(d)                = from.reference(d);
          p.velocity(d)                 = from.velocity(d);
        }
      p.id()                 = from.id();
      const double last_area = p.mass();
      p.mass()               = met.area;
      for (unsigned int d = 0; d < dim; ++d)
        p[layout.first("load") + d] *= last_area / p.mass();
      if (layout.is_axisymmetric())
        p[layout.radius0] = from.position(0);
      p.J() = 1.;
      p.set_F(unit_symmetric_tensor<3>());
      return row;
    }



    /// Exclude a point that leaves the layer from the averages of the contact,
    /// but keep its force.
    template <int dim>
    void
    take_area(const PointRef<dim> contactor, const PointLayout<dim> &layout)
    {
      constexpr double left = 1e-14;
      contactor.mass() *= left;
      for (unsigned int d = 0; d < dim; ++d)
        contactor[layout.first("load") + d] /= left;
    }



    /// Move a point and its position at the start of the last step by @p way,
    /// unless it would leave the grid.
    template <int dim>
    void
    lift(const PointRef<dim>     point,
         const PointRef<dim>     contactor,
         const PointLayout<dim> &layout,
         const Tensor<1, dim>   &way,
         const SplineSpace<dim> &space)
    {
      const Point<dim> x = point.position() + way;
      for (unsigned int d = 0; d < dim; ++d)
        if (!(x[d] > space.lower_corner()[d] && x[d] < space.upper_corner()[d]))
          return;
      for (unsigned int d = 0; d < dim; ++d)
        {
          point.position(d)     = x[d];
          contactor.position(d) = x[d];
          contactor[layout.first("before") + d] += way[d];
        }
    }



    /// Collective. Return, for each point that faces the other side, the
    /// smallest gap of the first side's points in its box and the neighboring
    /// boxes, on all processes. Boxes are as large as the smallest cells, or
    /// twice as large and so on, and not smaller than the cell at the point.
    template <int dim>
    std::vector<double>
    lowest_in_boxes(const std::vector<ContactPoint<dim>> &points,
                    const MPI_Comm                        comm)
    {
      constexpr unsigned int n_near = dim == 2 ? 9 : 27;
      std::vector<double>    sizes(2, std::numeric_limits<double>::lowest());
      for (const ContactPoint<dim> &point : points)
        {
          sizes[0] = std::max(sizes[0], point.cell_size);
          sizes[1] = std::max(sizes[1], -point.cell_size);
        }
      Utilities::MPI::max(sizes, comm, sizes);
      const double smallest = -sizes[1];
      const auto   level_of = [&](const double h) {
        return unsigned(std::ceil(std::log2(h / smallest) - 1e-6));
      };
      const unsigned int n_levels = sizes[0] > 0. ? level_of(sizes[0]) + 1 : 1;
      const auto         box_of   = [&](const Point<dim>  &x,
                              const unsigned int near,
                              const unsigned int level) {
        const double  h    = std::ldexp(smallest, int(level));
        std::uint64_t bits = level;
        unsigned int  rest = near;
        for (unsigned int d = 0; d < dim; ++d, rest /= 3)
          bits =
            mixed_bits(bits ^ std::uint64_t(std::int64_t(std::floor(x[d] / h)) +
                                            std::int64_t(rest % 3) - 1));
        return bits;
      };
      constexpr unsigned int own  = n_near / 2;
      constexpr double       none = std::numeric_limits<double>::max();
      std::vector<std::unordered_map<std::uint64_t, const ContactPoint<dim> *>>
        foremost(n_levels);
      for (const ContactPoint<dim> &point : points)
        if (point.is_facing && point.side == 0)
          {
            for (unsigned int level = 0; level < n_levels; ++level)
              {
                const ContactPoint<dim> *&first =
                  foremost[level]
                    .emplace(box_of(point.x, own, level), &point)
                    .first->second;
                if (point.gap < first->gap)
                  first = &point;
              }
          }
      std::unordered_map<std::uint64_t, double> lowest;
      for (unsigned int level = 0; level < n_levels; ++level)
        for (const auto &[box, point] : foremost[level])
          for (unsigned int near = 0; near < n_near; ++near)
            {
              double &gap = lowest.emplace(box_of(point->x, near, level), none)
                              .first->second;
              gap = std::min(gap, point->gap);
            }
      combine_by_key(
        lowest,
        [](double &lowest_gap, const double gap) {
          lowest_gap = std::min(lowest_gap, gap);
        },
        comm);
      std::vector<double> result;
      for (const ContactPoint<dim> &point : points)
        {
          const auto found =
            point.is_facing
              ? lowest.find(box_of(point.x, own, level_of(point.cell_size)))
              : lowest.end();
          result.push_back(found == lowest.end() ? 0. : found->second);
        }
      return result;
    }
  } // namespace



  template <int dim>
  struct BodyContacts<dim>::Candidates
  {
    /// The points of all surfaces of the first side, followed by the second
    /// side.
    std::vector<ContactPoint<dim>> points;
    struct MaterialPoint
    {
      PointRef<dim> point;
      unsigned int  cell;
      double        spacing; // in the direction of the other side, m
    };
    /// The material points of the first side.
    std::vector<MaterialPoint> material_points;
    std::vector<std::size_t>   ends; // of surfaces
    /// The result of lowest_in_boxes().
    std::vector<double> lowest;
  };



  namespace
  {
    /// Return the edges of a box of the volume 1 with the proportions of the
    /// cell in which a material point was placed.
    template <int dim>
    Tensor<1, dim>
    proportions(const MaterialPoints<dim> &points, const ConstPointRef<dim> p)
    {
      Point<dim> X;
      for (unsigned int d = 0; d < dim; ++d)
        X[d] = p.reference(d);
      const CellBox<dim> box = points.space().box_around(X);
      return box.size / std::pow(box.volume(), 1. / dim);
    }



    /// Return the longest edge of the box of a material point.
    template <int dim>
    double
    longest_spacing(const MaterialPoints<dim> &points,
                    const ConstPointRef<dim>   p)
    {
      const Tensor<1, dim> edges   = proportions(points, p);
      double               longest = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        longest = std::max(longest, edges[d]);
      return p.extent(points.layout()) * longest;
    }



    /// Return an upper bound of the longest edge over the extent of points.
    template <int dim>
    double
    largest_proportion(const SplineSpace<dim> &space)
    {
      // The proportions of cells do not depend on their level.
      const CellHierarchy<dim> *levels = space.hierarchy();
      const MultiIndex<dim>     n_cells =
        levels ? levels->n_cells(0) : space.cells_per_direction();
      std::array<double, dim> smallest, largest;
      for (unsigned int d = 0; d < dim; ++d)
        {
          smallest[d] = largest[d] = space.cell_size(d, 0);
          for (unsigned int k = 0; k < n_cells[d]; ++k)
            {
              const double h = space.cell_size(d, k);
              smallest[d]    = std::min(smallest[d], h);
              largest[d]     = std::max(largest[d], h);
            }
        }
      double result = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          // A box of the volume 1 with one edge as long as possible.
          double product = 1.;
          for (unsigned int e = 0; e < dim; ++e)
            if (e != d)
              product *= largest[d] / smallest[e];
          result = std::max(result, std::pow(product, 1. / dim));
        }
      return result;
    }



    /// Set the spacing of a material point, and its area, for the direction in
    /// which it meets the other side.
    template <int dim, typename MaterialPoint>
    void
    take_spacing(MaterialPoint             &point,
                 const MaterialPoints<dim> &points,
                 ContactPoint<dim>         &contactor)
    {
      const ConstPointRef<dim> p       = point.point;
      const double             spacing = p.extent(points.layout());
      const Tensor<1, dim>     edges   = proportions(points, p);
      double                   square  = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        square += std::pow(contactor.target_normal[d] / edges[d], 2);
      point.spacing = spacing / std::sqrt(square);
      contactor.area =
        std::pow(spacing, dim) / point.spacing * contactor.thickness;
    }
  } // namespace



  template <int dim>
  typename BodyContacts<dim>::Candidates
  BodyContacts<dim>::find_candidates(Contact &contact)
  {
    Candidates result;
    auto      &points = result.points;
    // A step may bring points closer. Their stiffness must enter the critical
    // step before that.
    const double motion = are_implicit ? longest_trial_motion : longest_motion;
    // The largest spacing of a cell, and of all cells, in units of its size.
    std::vector<std::vector<double>> spacings;
    double                           largest = 0.;
    for (const Place &place : contact.sides[0])
      {
        const MaterialPoints<dim> &of_body = body_of(place).points;
        const double               longest =
          contact.is_uniform ? 1. : largest_proportion(of_body.space());
        std::vector<double> &of_cells =
          spacings.emplace_back(of_body.space().owned_cells().size(), 0.);
        for (const unsigned int cell : of_body.cells())
          {
            double &of_cell = of_cells[cell];
            of_body.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
              of_cell = std::max(of_cell, p.extent(of_body.layout()));
            });
            of_cell *=
              longest / contact.cell_size_at(of_body.space(),
                                             cell,
                                             of_body.space().box(cell).center);
            largest = std::max(largest, of_cell);
          }
      }
    largest            = Utilities::MPI::max(largest, comm);
    const double reach = largest + motion;
    for (Place &place : contact.sides[0])
      {
        MaterialPoints<dim>        &all      = body_of(place).points;
        const std::vector<double>  &of_cells = spacings[result.ends.size()];
        const std::vector<NearCell> near =
          near_cells(contact, place, [&](const unsigned int cell) {
            return contact.is_uniform ? reach : of_cells[cell] + motion;
          });
        std::size_t n_near = points.size();
        for (const NearCell &cell : near)
          n_near += all.n_points(cell.cell);
        points.reserve(n_near);
        result.material_points.reserve(n_near);
        for (const NearCell &cell : near)
          for_each_in_cell(all, cell.cell, [&](const PointRef<dim> p) {
            // The distance from the other side differs between a point and the
            // center of its cell by at most the distance between the two.
            const double distance =
              cell.distance - p.position().distance(cell.center);
            const double h =
              contact.cell_size_at(all.space(), cell.cell, p.position());
            if (distance > (contact.is_uniform
                              ? reach * h
                              : longest_spacing<dim>(all, p) + motion * h))
              return;
            const double       spacing = p.extent(all.layout());
            ContactPoint<dim> &point   = points.emplace_back();
            point.x                    = p.position();
            point.cell_size            = h;
            point.thickness            = all.layout().thickness(p.position());
            point.area = std::pow(spacing, dim - 1) * point.thickness;
            result.material_points.push_back({p, cell.cell, spacing});
          });
        result.ends.push_back(points.size());
      }
    if (contact.rigid < 0)
      for (const ContactPoint<dim> &point : collect(contact))
        if (point.side == 1)
          points.push_back(point);
    find_gaps(contact, points, reach);
    if (!contact.is_uniform)
      for (std::size_t k = 0, s = 0; k < result.material_points.size(); ++k)
        {
          while (k >= result.ends[s])
            ++s;
          const MaterialPoints<dim> &of_body =
            body_of(contact.sides[0][s]).points;
          auto &candidate = result.material_points[k];
          points[k].is_facing =
            points[k].is_facing &&
            points[k].gap < longest_spacing<dim>(of_body, candidate.point) +
                              motion * points[k].cell_size;
          if (points[k].is_facing)
            take_spacing(candidate, of_body, points[k]);
        }
    // If the lowest point is inside, the layer begins there. Otherwise, points
    // above would hide it in the mean.
    result.lowest = lowest_in_boxes(points, comm);
    return result;
  }



  template <int dim>
  void
  BodyContacts<dim>::renew_contactors(Contact &contact)
  {
    const Candidates candidates = find_candidates(contact);
    for (unsigned int s = 0; s < candidates.ends.size(); ++s)
      renew_contactors(contact, candidates, s);
  }



  template <int dim>
  void
  BodyContacts<dim>::renew_contactors(const Contact     &contact,
                                      const Candidates  &candidates,
                                      const unsigned int s)
  {
    const bool    is_new          = parts.front()->current.n_steps == 0;
    const Place  &place           = contact.sides[0][s];
    Surface<dim> &surface         = place.part->current.surfaces[place.surface];
    const PointLayout<dim> layout = surface.points.layout();
    std::unordered_map<std::uint64_t, std::size_t> last; // first numbers
    std::vector<double>                            last_rows;
    last_rows.reserve(surface.points.n_points() * layout.size);
    surface.points.for_each([&](ConstPointRef<dim> p) {
      last[std::uint64_t(p.id())] = last_rows.size();
      for (unsigned int i = 0; i < layout.size; ++i)
        last_rows.push_back(p[i]);
    });
    surface.points.reinit(place.part->space(), layout);
    unsigned int              n_joined = 0;
    std::vector<unsigned int> left;
    for (std::size_t k = s == 0 ? 0 : candidates.ends[s - 1];
         k < candidates.ends[s];
         ++k)
      {
        const auto              &candidate = candidates.material_points[k];
        const ContactPoint<dim> &point     = candidates.points[k];
        const double             gap       = point.gap;
        const auto found = last.find(std::uint64_t(candidate.point.id()));
        const bool joins = !is_new && found == last.end();
        const bool is_in_layer =
          point.is_facing &&
          gap < end_of_layer(candidates.lowest[k], candidate.spacing, joins);
        // Implicit steps begin with the forces of the last step.
        const double *const last_row =
          found == last.end() ? nullptr : &last_rows[found->second];
        const bool leaves =
          are_implicit && last_row && !is_in_layer &&
          ConstPointRef<dim>(last_row).vector(layout.first("load")).norm() *
              ConstPointRef<dim>(last_row).mass() >
            negligible_pressure * contact.modulus * point.area;
        if (!is_in_layer && !leaves)
          continue;
        std::vector<double> row =
          contactor(layout,
                    candidate,
                    point,
                    is_new && gap < candidate.spacing &&
                        gap > -deepest_initially * candidate.spacing
                      ? gap
                      : default_radius * candidate.spacing,
                    body_of(place).points.layout().find("pore_pressure"),
                    last_row);
        if (leaves)
          take_area(PointRef<dim>(row.data()), layout);
        if (is_in_layer && gap < -smallest_lift * candidate.spacing && !is_new)
          {
            lift(candidate.point,
                 PointRef<dim>(row.data()),
                 layout,
                 -gap * point.target_normal,
                 surface.points.space());
            left.push_back(candidate.cell);
          }
        surface.points.insert(candidate.cell, make_array_view(row));
        n_joined += last_row == nullptr;
      }
    Simulation<dim>          &part    = *place.part;
    std::vector<unsigned int> numbers = {n_joined,
                                         unsigned(last.size()),
                                         unsigned(left.size())};
    Utilities::MPI::sum(numbers, comm, numbers);
    // The critical step depends on the stiffness of all contactors.
    if (numbers[0] > largest_joined_fraction * numbers[1])
      part.current.estimates.next = part.current.n_steps;
    if (numbers[2] == 0)
      return;
    left.erase(std::unique(left.begin(), left.end()), left.end());
    for (MaterialPoints<dim> *moved : {&body_of(place).points, &surface.points})
      part.discretization.transport().move(*moved, left);
    part.current.points_have_changed();
  }



  template void
  BodyContacts<2>::renew_contactors(Contact &);
  template void
  BodyContacts<3>::renew_contactors(Contact &);
} // namespace greville
