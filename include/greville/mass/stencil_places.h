// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/zeroed_array.h>
#include <greville/spline/spline_space.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace greville
{
  /**
   * The *places* of functions in memory. The functions of a line in x have
   * consecutive places, padded such that neighbours are found by arithmetic
   * without tests for walls. Vectors on places are interleaved: entry c of
   * place i is at i * width + c. Entries that are never written use no memory.
   *
   * Some functions have *rows*. Segments are ranges of rows at consecutive
   * places of a line.
   *
   * If a direction of n functions is periodic, the functions with @f$ i_d < p
   * @f$ have a second place, an *image*, at @f$ n + i_d @f$, for cells at the
   * upper end (see ExtendedUnknowns).
   */
  template <int dim>
  class StencilPlaces
  {
  public:
    /// The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /// Return the number of places.
    std::size_t
    size() const
    {
      return n_places;
    }

    /// Return the place of a function with a local number. Places ascend with
    /// the lexicographic position.
    unsigned int
    place(const unsigned int function) const
    {
      return place_of[function];
    }

    /// Return the place of function number @p x in line number @p line of the
    /// (p + 1)^(dim - 1) lines of an owned cell.
    unsigned int
    cell_place(const unsigned int cell,
               const unsigned int x,
               const unsigned int line) const
    {
      const unsigned int n     = spline_space->degree() + 1;
      const unsigned int first = first_place(cell);
      const unsigned int start = line_of[first];
      return line_begin[start + line % n + line / n * n_lines_y] + x +
             (first - line_begin[start]);
    }

    /// Return the images of local functions: function and place.
    const std::vector<std::pair<unsigned int, unsigned int>> &
    images() const
    {
      return image_places;
    }

    /// Choose the functions with rows, by local numbers, and their images.
    void
    set_rows(const std::vector<unsigned int> &functions);

    /// Call visit(i) for all places with a row, ascending.
    template <typename Visit>
    void
    for_each_row(const Visit &visit) const
    {
      for (const Segment &segment : segments)
        for (unsigned int i = segment.begin; i < segment.end; ++i)
          visit(i);
    }

    /// Call visit(begin, end, distance) for all segments. distance(k) is the
    /// distance to the place with the same x in neighbouring line number k.
    template <typename Visit>
    void
    for_each_segment(const Visit &visit) const
    {
      for (const Segment &segment : segments)
        visit(segment.begin, segment.end, [&](const unsigned int k) {
          return line_begin[segment.line + neighbor_lines[k]] -
                 line_begin[segment.line];
        });
    }

    /// Call visit(j) for all places j of the full stencil of row @p i,
    /// ascending.
    template <typename Visit>
    void
    for_each_place(const unsigned int i, const Visit &visit) const
    {
      const int p = spline_space->degree();
      for_each_line<false>(i, p, [&](const unsigned int j, const auto...) {
        for (int dx = -p; dx <= p; ++dx)
          visit(j + dx);
      });
    }

  protected:
    /// Rows at consecutive places of a line.
    struct Segment
    {
      unsigned int begin, end; // places
      unsigned int line;
    };

    /// Return the place of the first function of an owned cell.
    unsigned int
    first_place(const unsigned int cell) const
    {
      return place_of[spline_space->cell_functions(cell)[0]];
    }

    /// Call visit(j, low_line, low, k) for the lines up to the distance
    /// @p reach from the place @p i, or only for its own line and later lines.
    /// j is the place with the same x in the visited line. low_line is the one
    /// of both lines with the smaller indices, and low is its place with this
    /// x. k = |dy| + |dz| (p + 1).
    template <bool upper, typename Visit>
    void
    for_each_line(const unsigned int i,
                  const int          reach,
                  const Visit       &visit) const;

    const SplineSpace<dim> *spline_space = nullptr;
    std::size_t             n_places     = 0;

    // Lines are counted in a box around the lines of this process. A function
    // at x in a line has the place line_begin[line] + x.
    std::vector<int>          line_begin;
    std::vector<int>          neighbor_lines; // distances of line numbers
    unsigned int              n_lines_y = 0;
    std::vector<unsigned int> place_of; // by local number
    ZeroedArray<unsigned>     line_of;  // by place
    std::vector<Segment>      segments;

    std::vector<std::pair<unsigned int, unsigned int>> image_places;

  private:
    /// A function or an image, numbered without periodicity.
    struct Function
    {
      unsigned int         number;
      std::array<int, dim> index;
    };

    std::vector<Function>
    functions_and_images() const;

    /// Set the lines in a box around functions, and their places.
    void
    make_lines(const std::vector<Function> &functions);

    unsigned int
    line_number(const std::array<int, dim> &index) const
    {
      return index[1] - lowest[1] +
             (dim == 3 ? (index[dim - 1] - lowest[dim - 1]) * int(n_lines_y)
                       : 0);
    }

    std::array<int, dim> lowest{};
  };



  template <int dim>
  template <bool upper, typename Visit>
  void
  StencilPlaces<dim>::for_each_line(const unsigned int i,
                                    const int          reach,
                                    const Visit       &visit) const
  {
    const int          n       = spline_space->degree() + 1;
    const int          reach_z = dim == 3 ? reach : 0;
    const unsigned int line    = line_of[i];
    const auto         at      = [&](const unsigned int other) -> unsigned int {
      return int(i) + line_begin[other] - line_begin[line];
    };
    for (int dz = upper ? 0 : -reach_z; dz <= reach_z; ++dz)
      for (int dy = upper && dz == 0 ? 0 : -reach; dy <= reach; ++dy)
        {
          const unsigned int other = line + dz * int(n_lines_y) + dy;
          const unsigned int low =
            line + std::min(dz, 0) * int(n_lines_y) + std::min(dy, 0);
          visit(at(other), low, at(low), std::abs(dz) * n + std::abs(dy));
        }
  }
} // namespace greville
