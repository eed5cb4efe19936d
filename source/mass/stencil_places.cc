// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/mass/stencil_places.h>

#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  StencilPlaces<dim>::reinit(const SplineSpace<dim> &space)
  {
    spline_space         = &space;
    const auto functions = functions_and_images();
    make_lines(functions);
    const unsigned int n =
      space.owned_functions().size() + space.ghost_functions().size();
    line_of = ZeroedArray<unsigned int>(n_places);
    place_of.resize(n);
    image_places.clear();
    for (std::size_t k = 0; k < functions.size(); ++k)
      {
        const unsigned int line  = line_number(functions[k].index);
        const unsigned int place = line_begin[line] + functions[k].index[0];
        line_of[place]           = line;
        if (k < n)
          place_of[k] = place;
        else
          image_places.emplace_back(functions[k].number, place);
      }
    segments.clear();
  }



  template <int dim>
  std::vector<typename StencilPlaces<dim>::Function>
  StencilPlaces<dim>::functions_and_images() const
  {
    const SplineSpace<dim> &space = *spline_space;
    const unsigned int      n =
      space.owned_functions().size() + space.ghost_functions().size();
    std::vector<Function> functions;
    functions.reserve(n);
    for (unsigned int f = 0; f < n; ++f)
      {
        const auto i =
          multi_index<dim>(space.function_position(f), space.n_functions());
        Function function{f, {}};
        for (unsigned int d = 0; d < dim; ++d)
          function.index[d] = i[d];
        functions.push_back(function);
      }
    for (unsigned int d = 0; d < dim; ++d)
      if (space.is_periodic(d))
        {
          const std::size_t n_before = functions.size();
          for (std::size_t k = 0; k < n_before; ++k)
            if (functions[k].index[d] < int(space.degree()))
              {
                functions.push_back(functions[k]);
                functions.back().index[d] += space.n_functions()[d];
              }
        }
    return functions;
  }



  template <int dim>
  void
  StencilPlaces<dim>::make_lines(const std::vector<Function> &functions)
  {
    using Range                 = std::array<int, 2>;
    constexpr int   largest_int = std::numeric_limits<int>::max();
    constexpr Range empty       = {{largest_int, -largest_int}};
    const int       p           = spline_space->degree();

    // The box of lines around the functions, extended by p.
    std::array<Range, dim> box;
    box.fill(empty);
    for (const Function &function : functions)
      for (unsigned int d = 0; d < dim; ++d)
        box[d] = {{std::min(box[d][0], function.index[d] - p),
                   std::max(box[d][1], function.index[d] + p)}};
    const auto size = [&](const unsigned int d) {
      return functions.empty() ? 0 : box[d][1] - box[d][0] + 1;
    };
    for (unsigned int d = 0; d < dim; ++d)
      lowest[d] = box[d][0];
    n_lines_y = size(1);
    neighbor_lines.clear();
    for (int dz = (dim == 3 ? -p : 0); dz <= (dim == 3 ? p : 0); ++dz)
      for (int dy = -p; dy <= p; ++dy)
        neighbor_lines.push_back(dz * int(n_lines_y) + dy);

    // The range of x in each line, and the range reached by the rows of
    // neighbouring lines.
    std::vector<Range> own(size(1) * (dim == 3 ? size(dim - 1) : 1), empty);
    for (const Function &function : functions)
      {
        Range &range = own[line_number(function.index)];
        range        = {{std::min(range[0], function.index[0]),
                         std::max(range[1], function.index[0])}};
      }
    auto reached = own;
    for (unsigned int line = 0; line < own.size(); ++line)
      if (own[line][0] <= own[line][1])
        for (const int offset : neighbor_lines)
          {
            Range &range = reached[line + offset];
            range        = {{std::min(range[0], own[line][0] - p),
                             std::max(range[1], own[line][1] + p)}};
          }

    n_places = 0;
    line_begin.assign(own.size(), 0);
    for (unsigned int line = 0; line < own.size(); ++line)
      if (reached[line][0] <= reached[line][1])
        {
          line_begin[line] = int(n_places) - reached[line][0];
          n_places += reached[line][1] - reached[line][0] + 1;
          Require(n_places < std::size_t(largest_int),
                  "A process has more coefficients than an integer can count.");
        }
  }



  template <int dim>
  void
  StencilPlaces<dim>::set_rows(const std::vector<unsigned int> &functions)
  {
    std::vector<unsigned int> rows;
    rows.reserve(functions.size());
    for (const unsigned int f : functions)
      rows.push_back(place_of[f]);
    if (!image_places.empty())
      {
        std::vector<bool> has_row(place_of.size(), false);
        for (const unsigned int f : functions)
          has_row[f] = true;
        for (const auto &[f, place] : image_places)
          if (has_row[f])
            rows.push_back(place);
      }
    if (!std::is_sorted(rows.begin(), rows.end()))
      std::sort(rows.begin(), rows.end());
    segments.clear();
    for (const unsigned int place : rows)
      {
        if (segments.empty() || segments.back().end != place)
          segments.push_back({place, place, line_of[place]});
        ++segments.back().end;
      }
  }



  GREVILLE_INSTANTIATE_CLASS(StencilPlaces);
} // namespace greville
