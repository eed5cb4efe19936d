// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/material_points.h>

#include <algorithm>
#include <utility>

namespace greville
{
  using namespace dealii;

  template <int dim>
  PointLayout<dim>::PointLayout(const std::vector<std::string> &state_names)
    : n_state(state_names.size())
  {
    for (const std::string &name : state_names)
      add(name, 1);
  }



  template <int dim>
  void
  PointLayout<dim>::add(const std::string &name,
                        const unsigned int n_components)
  {
    if (const PointField *field = find(name))
      {
        (void)field;
        AssertThrow(field->n_components == n_components,
                    ExcDimensionMismatch(field->n_components, n_components));
        return;
      }
    all_fields.push_back({name, size, n_components});
    const std::pair<const char *, unsigned int *> known[] = {
      {"initial_F", &initial_F},
      {"projected_J", &projected_J},
      {"radius0", &radius0},
      {"domain", &domain}};
    for (const auto &[known_name, number] : known)
      if (name == known_name)
        *number = size;
    size += n_components;
  }



  template <int dim>
  const PointField *
  PointLayout<dim>::find(const std::string &name) const
  {
    for (const PointField &field : all_fields)
      if (field.name == name)
        return &field;
    return nullptr;
  }



  template <int dim>
  unsigned int
  PointLayout<dim>::first(const std::string &name) const
  {
    const PointField *field = find(name);
    Require(field, "There is no field '" + name + "'.");
    return field->first;
  }



  template <int dim>
  std::vector<std::string>
  PointLayout<dim>::names() const
  {
    std::vector<PointField> fields = {{"position", position, dim},
                                      {"velocity", velocity, dim},
                                      {"mass", mass, 1},
                                      {"volume0", volume0, 1},
                                      {"J", J, 1},
                                      {"stress", stress, n_stress},
                                      {"wave_modulus", wave_modulus, 1},
                                      {"F", F, n_F},
                                      {"reference", reference, dim},
                                      {"id", id, 1}};
    fields.insert(fields.end(), all_fields.begin(), all_fields.end());
    std::vector<std::string> result(size);
    for (const PointField &field : fields)
      for (unsigned int k = 0; k < field.n_components; ++k)
        result[field.first + k] =
          field.name + (field.n_components == 1 ? "" : "_" + std::to_string(k));
    return result;
  }



  template <int dim>
  void
  MaterialPoints<dim>::reinit(const SplineSpace<dim> &space,
                              const PointLayout<dim> &layout)
  {
    spline_space = &space;
    point_layout = layout;
    n_all_points = 0;
    data.clear();
    links.clear();
    heads.assign(space.owned_cells().size(), none);
    counts.assign(space.owned_cells().size(), 0);
    free_groups            = none;
    filled_cells_are_valid = false;
  }



  template <int dim>
  const std::vector<unsigned int> &
  MaterialPoints<dim>::cells() const
  {
    if (!filled_cells_are_valid)
      {
        filled_cells.clear();
        for (unsigned int cell = 0; cell < counts.size(); ++cell)
          if (counts[cell] > 0)
            filled_cells.push_back(cell);
        filled_cells_are_valid = true;
      }
    return filled_cells;
  }



  template <int dim>
  void
  MaterialPoints<dim>::reserve(const std::size_t n_groups)
  {
    const std::size_t size = std::size_t(point_layout.size) * width;
    if (data.size() >= n_groups * size)
      return;
    // Copy: an AlignedVector that grows in place would double its memory.
    dealii::AlignedVector<double> larger;
    larger.resize_fast(n_groups * size);
    std::copy_n(data.begin(), links.size() * size, larger.begin());
    data.swap(larger);
  }



  template <int dim>
  unsigned int
  MaterialPoints<dim>::new_group()
  {
    if (free_groups != none)
      {
        const unsigned int g = free_groups;
        free_groups          = links[g];
        return g;
      }
    const std::size_t used = links.size();
    if (data.size() < (used + 1) * point_layout.size * width)
      reserve(used + std::max<std::size_t>(1, used / 8));
    links.push_back(none);
    return links.size() - 1;
  }



  template <int dim>
  void
  MaterialPoints<dim>::clear_lane(const unsigned int cell,
                                  const unsigned int g,
                                  const unsigned int lane)
  {
    const PointRef<dim> p = point(g, lane);
    for (unsigned int k = 0; k < point_layout.size; ++k)
      p[k] = 0.;
    const Point<dim> center = spline_space->box(cell).center;
    for (unsigned int d = 0; d < dim; ++d)
      p.position(d) = p[point_layout.basis_position + d] = center[d];
    if (point_layout.is_axisymmetric())
      p[point_layout.radius0] = center[0];
    p.set_F(unit_symmetric_tensor<3>());
    p.J() = 1.;
  }



  template <int dim>
  void
  MaterialPoints<dim>::insert(const unsigned int             cell,
                              const ArrayView<const double> &values)
  {
    AssertThrow(values.size() == point_layout.size,
                ExcDimensionMismatch(values.size(), point_layout.size));
    const unsigned int lane = counts[cell] % width;
    if (lane == 0)
      {
        const unsigned int g = new_group();
        links[g]             = heads[cell];
        heads[cell]          = g;
        for (unsigned int l = 1; l < width; ++l)
          clear_lane(cell, g, l);
      }
    const PointRef<dim> target = point(heads[cell], lane);
    for (unsigned int k = 0; k < point_layout.size; ++k)
      target[k] = values[k];
    if (counts[cell]++ == 0)
      filled_cells_are_valid = false;
    ++n_all_points;
  }



  template <int dim>
  void
  MaterialPoints<dim>::remove_leaving(const unsigned int   cell,
                                      std::vector<double> &leaving)
  {
    unsigned int n = n_in_first_group(cell);
    for (unsigned int g = heads[cell]; g != none; n = width)
      {
        // The first group can become empty and be removed.
        const unsigned int next = links[g];
        for (unsigned int lane = 0; lane < n;)
          {
            const PointRef<dim> p = point(g, lane);
            if (spline_space->contains(cell, p.basis_position(point_layout)))
              {
                ++lane;
                continue;
              }
            const std::size_t begin = leaving.size();
            leaving.resize(begin + point_layout.size);
            for (unsigned int k = 0; k < point_layout.size; ++k)
              leaving[begin + k] = p[k];

            // The last point of the first group fills the hole.
            const unsigned int head = heads[cell];
            const unsigned int last = n_in_first_group(cell) - 1;
            for (unsigned int k = 0; k < point_layout.size; ++k)
              p[k] = point(head, last)[k];
            if (last > 0)
              clear_lane(cell, head, last);
            --counts[cell];
            --n_all_points;
            if (head == g)
              --n;
            if (last == 0)
              {
                heads[cell] = links[head];
                links[head] = free_groups;
                free_groups = head;
              }
            if (counts[cell] == 0)
              filled_cells_are_valid = false;
          }
        g = next;
      }
  }



  template <int dim>
  void
  MaterialPoints<dim>::defragment()
  {
    // The old position of each group in the new order, and new links.
    std::vector<unsigned int> old, new_links;
    std::vector<bool>         is_used(links.size(), false);
    old.reserve(links.size());
    new_links.reserve(links.size());
    for (const unsigned int cell : cells())
      {
        unsigned int g = heads[cell];
        heads[cell]    = old.size();
        for (; g != none; g = links[g])
          {
            old.push_back(g);
            new_links.push_back(links[g] == none ? none : old.size());
            is_used[g] = true;
          }
      }
    links.swap(new_links);
    free_groups = none;

    std::vector<double> numbers(std::size_t(point_layout.size) * width);
    // Move a group to an unused position, then another group to the position
    // that has become free, and so on, until group @p last is to move.
    const auto fill = [&](unsigned int place, const unsigned int last) {
      while (place < old.size() && old[place] != none)
        {
          const unsigned int g = std::exchange(old[place], none);
          if (g == last)
            break;
          std::copy_n(group(g), numbers.size(), group(place));
          place = g;
        }
      return place;
    };
    for (unsigned int place = 0; place < old.size(); ++place)
      if (!is_used[place])
        fill(place, none);
    // The remaining groups form cycles.
    for (unsigned int place = 0; place < old.size(); ++place)
      if (old[place] != none && old[place] != place)
        {
          std::copy_n(group(place), numbers.size(), numbers.begin());
          std::copy_n(numbers.begin(),
                      numbers.size(),
                      group(fill(place, place)));
        }

    // Release spare memory beyond the reserve of new_group().
    if (data.size() / 9 * 8 > old.size() * numbers.size())
      {
        dealii::AlignedVector<double> smaller;
        smaller.resize_fast(old.size() * numbers.size());
        std::copy_n(data.begin(), smaller.size(), smaller.begin());
        data.swap(smaller);
      }
  }



  GREVILLE_INSTANTIATE_CLASS(PointLayout);
  GREVILLE_INSTANTIATE_CLASS(MaterialPoints);
} // namespace greville
