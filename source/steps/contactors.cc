// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>

#include <cmath>
#include <limits>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // A point is ahead of the others by this fraction of its spacing.
    constexpr double default_radius = 0.5;



    /**
     * A material point that may be one of the outermost layer.
     */
    template <int dim>
    struct Candidate
    {
      ConstPointRef<dim> point;
      unsigned int       cell;
      /// m
      double spacing;
    };



    /**
     * A row for a material point, from the one that it has had in the last
     * step, if it has had one.
     */
    template <int dim>
    std::vector<double>
    contactor(const PointLayout<dim>    &layout,
              const Candidate<dim>      &candidate,
              const double               radius,
              const std::vector<double> *last)
    {
      std::vector<double>       row(layout.size, 0.);
      const PointRef<dim>       p(row.data());
      const ConstPointRef<dim> &from = candidate.point;
      if (last)
        row = *last;
      else
        {
          p[layout.first("radius")] = radius;
          for (unsigned int d = 0; d < dim; ++d)
            p[layout.first("before") + d] = from.position(d);
        }
      for (unsigned int d = 0; d < dim; ++d)
        {
          p.position(d)  = from.position(d);
          p.reference(d) = from.reference(d);
          p.velocity(d)  = from.velocity(d);
        }
      p.id()   = from.id();
      p.mass() = std::pow(candidate.spacing, dim - 1);
      p.J()    = 1.;
      p.set_F(unit_symmetric_tensor<3>());
      return row;
    }
  } // namespace



  template <int dim>
  void
  BodyContacts<dim>::renew_contactors(const Contact &contact)
  {
    const bool is_new = parts.front()->current.n_steps == 0;
    // Points of all surfaces of the first side, and then the second side.
    std::vector<ContactPoint<dim>> points;
    std::vector<Candidate<dim>>    candidates;
    std::vector<std::size_t>       ends;
    double                         largest = 0.; // spacing
    for (const Place &place : contact.sides[0])
      {
        const State<dim>          &state = place.part->current;
        const MaterialPoints<dim> &all =
          state.bodies[state.surfaces[place.surface].body].points;
        for (const unsigned int cell : near_cells(contact, all))
          all.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            ContactPoint<dim> point;
            point.x              = p.position();
            const double spacing = std::pow(p.volume(), 1. / dim);
            point.area           = std::pow(spacing, dim - 1);
            largest              = std::max(largest, spacing);
            points.push_back(point);
            candidates.push_back({p, cell, spacing});
          });
        ends.push_back(points.size());
      }
    if (contact.rigid < 0)
      for (const ContactPoint<dim> &point : collect(contact))
        if (point.side == 1)
          points.push_back(point);
    find_gaps(contact, points, Utilities::MPI::max(largest, comm));

    std::size_t k = 0;
    for (unsigned int s = 0; s < ends.size(); ++s)
      {
        const Place  &place   = contact.sides[0][s];
        Surface<dim> &surface = place.part->current.surfaces[place.surface];
        const PointLayout<dim> layout = surface.points.layout();
        std::unordered_map<std::uint64_t, std::vector<double>> last;
        surface.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          std::vector<double> &row = last[std::uint64_t(p.id())];
          for (unsigned int i = 0; i < layout.size; ++i)
            row.push_back(p[i]);
        });
        surface.points.reinit(place.part->space(), layout);
        for (; k < ends[s]; ++k)
          {
            const Candidate<dim> &candidate = candidates[k];
            const double          gap       = points[k].gap;
            if (!points[k].is_facing || gap >= candidate.spacing)
              continue;
            const auto found = last.find(std::uint64_t(candidate.point.id()));
            std::vector<double> row =
              contactor(layout,
                        candidate,
                        is_new && gap > 0. ? gap
                                           : default_radius * candidate.spacing,
                        found == last.end() ? nullptr : &found->second);
            surface.points.insert(candidate.cell, make_array_view(row));
          }
      }
  }



  template <int dim>
  std::vector<unsigned int>
  BodyContacts<dim>::near_cells(const Contact             &contact,
                                const MaterialPoints<dim> &points)
  {
    if (contact.rigid < 0)
      return points.cells();
    const Lattice<dim>            &lattice = points.space().lattice();
    std::vector<ContactPoint<dim>> centers;
    double                         diagonal = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      diagonal += std::pow(lattice.cell_size(d), 2);
    diagonal = std::sqrt(diagonal);
    for (const unsigned int cell : points.cells())
      {
        centers.emplace_back();
        centers.back().x = lattice.cell_center(
          multi_index<dim>(points.space().owned_cells()[cell],
                           lattice.n_cells()));
      }
    // A point is no further from the center than half of the diagonal, and its
    // spacing is that of a cell with a single point at most.
    find_gaps(contact, centers, 1.5 * diagonal);
    std::vector<unsigned int> result;
    for (std::size_t k = 0; k < centers.size(); ++k)
      if (centers[k].is_facing)
        result.push_back(points.cells()[k]);
    return result;
  }



  template void
  BodyContacts<2>::renew_contactors(const Contact &);
  template void
  BodyContacts<3>::renew_contactors(const Contact &);
} // namespace greville
