// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>

#include <algorithm>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<NearContactCell<dim>>
  BodyContacts<dim>::near_cells(
    const Contact                                   &contact,
    Place                                           &place,
    const std::function<double(const unsigned int)> &reach)
  {
    const MaterialPoints<dim>        &points  = body_of(place).points;
    const SplineSpace<dim>           &space   = points.space();
    const std::vector<std::uint64_t> &numbers = space.owned_cells();
    std::vector<NearCell>             result;
    for (const unsigned int cell : points.cells())
      result.push_back({cell, space.box(cell).center, 0.});
    if (contact.rigid < 0)
      return result;

    Tensor<1, dim> smallest;
    for (unsigned int d = 0; d < dim; ++d)
      smallest[d] = space.cell_size(d);
    const double              slack = 0.25 * smallest.norm();
    const RigidPosition<dim> &now =
      parts.front()->current.rigid_bodies[contact.rigid].now;
    CellDistances<dim> &known    = place.distances;
    double              way      = rigid_way(contact, known.position, now);
    double              farthest = std::numeric_limits<double>::lowest();
    for (const NearCell &cell : result)
      farthest = std::max(farthest, reach(cell.cell));
    if (way > slack || farthest > known.reach)
      {
        known = {now,
                 std::max(farthest + slack / contact.cell_size, known.reach),
                 {}};
        way   = 0.;
      }
    const auto size_at = [&](const NearCell &cell) {
      return contact.cell_size_at(space, cell.cell, cell.center);
    };
    const auto half_diagonal = [&](const NearCell &cell) {
      return 0.5 * space.box(cell.cell).size.norm();
    };
    std::vector<ContactPoint<dim>> centers;
    for (const NearCell &cell : result)
      if (known.of_cells.count(numbers[cell.cell]) == 0)
        {
          centers.emplace_back();
          centers.back().x = cell.center;
          centers.back().cell_size =
            known.reach * size_at(cell) + slack + half_diagonal(cell);
        }
    rigid_bodies[contact.rigid].find_gaps(centers,
                                          1.,
                                          known.position,
                                          known.position);
    auto       center = centers.begin();
    const auto is_far = [&](NearCell &cell) {
      const auto [found, is_new] =
        known.of_cells.emplace(numbers[cell.cell],
                               std::numeric_limits<double>::max());
      if (is_new)
        {
          if (center->is_facing)
            found->second = center->gap;
          else if (rigid_bodies[contact.rigid].contains(center->x,
                                                        known.position))
            found->second = -std::numeric_limits<double>::max();
          ++center;
        }
      cell.distance = found->second - way;
      return cell.distance >
             reach(cell.cell) * size_at(cell) + half_diagonal(cell);
    };
    result.erase(std::remove_if(result.begin(), result.end(), is_far),
                 result.end());
    return result;
  }



  template std::vector<NearContactCell<2>>
  BodyContacts<2>::near_cells(
    const Contact &,
    Place &,
    const std::function<double(const unsigned int)> &);
  template std::vector<NearContactCell<3>>
  BodyContacts<3>::near_cells(
    const Contact &,
    Place &,
    const std::function<double(const unsigned int)> &);
} // namespace greville
