// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "extended_terms.h"
#include <tuple>

namespace greville
{
  /// The sum of P_i^T B_ij P_j over the blocks of half rows B, in half rows of
  /// the coarse unknowns. P_i has the coarse functions of the function i, and
  /// of the unknowns on which i depends if it is extended. Functions that do
  /// not depend on others are inserted direction by direction.
  template <int dim, int nc, int n>
  class GalerkinProduct
  {
  public:
    using Half     = HalfStencil<dim, nc, n, float>;
    using Position = typename LatticeLevel<dim>::Position;
    using FarBlock = typename LatticeLevel<dim>::FarBlock;
    using Terms    = typename ExtendedTerms<dim>::Terms;
    using Term     = typename ExtendedTerms<dim>::Term;

    /// Set the half rows of the local unknowns, and the blocks beyond them.
    GalerkinProduct(const LatticeUnknowns<dim> &coarse,
                    const LatticeLevel<dim>    &fine,
                    std::vector<float>         &rows,
                    std::vector<FarBlock>      &far_blocks)
      : coarse(coarse)
      , scale(1. / fine.unit())
      , rows(rows)
      , far_blocks(far_blocks)
      , extended(coarse, fine)
    {
      rows.assign(coarse.positions().size() * Half::row_size, 0.f);
      fine.for_each_row(
        [&](const Position &i, const float *row) { add(i, row); });
      fine.for_each_far_block([&](const FarBlock &block) { add(block); });
      merge_far_blocks();
      leave_out_other_functions();
    }

  private:
    static constexpr int      p = n - 1;
    static constexpr Position reach{{p, p, dim == 3 ? p : 0}};
    static constexpr int      length    = Half::length;
    static constexpr int      line_size = Half::line_size;
    static constexpr int      n_lines   = Half::n_lines;
    // The largest number of coarse functions of the columns in a direction.
    static constexpr int most = 2 * n + 1;

    /// A column of a function that depends on others.
    struct Column
    {
      Position     first;
      const Terms *terms;
    };

    /// A box of coarse functions, for each of which a row has a block: entry
    /// (c, d) at offset() + c * n_of_line() + d.
    struct Box
    {
      Position first, count;

      int
      n_of_line() const
      {
        return count[0] * nc;
      }

      int
      offset(const Position &I) const
      {
        return (((I[2] - first[2]) * count[1] + I[1] - first[1]) * nc *
                  count[0] +
                I[0] - first[0]) *
               nc;
      }

      int
      size() const
      {
        return count[2] * count[1] * nc * n_of_line();
      }
    };

    static void
    add_multiple(float *to, const float factor, const float *from, const int k)
    {
      for (int e = 0; e < k; ++e)
        to[e] += factor * from[e];
    }

    /// Return the coarse functions of the columns of a row.
    Box
    box_of_columns(const Position &i) const
    {
      Box result;
      for (int d = 0; d < 3; ++d)
        {
          int low = std::numeric_limits<int>::max(), high = -low;
          for (int k = d < dim - 1 ? -reach[d] : 0; k <= reach[d]; ++k)
            if (coarse.has_insertion(d, i[d] + k))
              {
                const NestedKnots::Row &r = coarse.insertion(d, i[d] + k);
                low                       = std::min(low, r.first);
                high = std::max(high, r.first + int(r.weights.size()));
              }
          result.first[d] = low;
          result.count[d] = high - low;
        }
      return result;
    }

    void
    add(const Position &i, const float *row)
    {
      const Terms *own = nullptr; // if the function depends on others
      columns.clear();
      if (extended.touches(i))
        {
          own = extended.find(i);
          take_extended_columns(i, row, own ? own->constrained : 0);
          row = plain_row;
        }
      const Box box = box_of_columns(i);
      add_rows(i, own, sum_columns(i, row, box), box, own != nullptr);
      if (columns.empty())
        return;
      const Box far_box = box_of_extended_columns();
      add_rows(i, own, sum_extended_columns(far_box), far_box, true);
    }

    /// Add P_i^T times the blocks of a box, which can exceed rows.
    void
    add_rows(const Position &i,
             const Terms    *own,
             const float    *blocks,
             const Box      &box,
             const bool      can_exceed)
    {
      const auto add = [&](const Position &I, const float weight) {
        add_to_row(I, weight, blocks, box);
        if (can_exceed)
          add_beyond_row(I, weight, blocks, box);
      };
      if (!own)
        {
          coarse.for_each_coarse(i, add);
          return;
        }
      const Position first = coarse.first_coarse(i);
      for (const Term &term : own->list)
        add(sum(first, term.offset), term.weight);
    }

    /// Return the sum of B_ij P_j over columns j that do not depend on others.
    const float *
    sum_columns(const Position &i, const float *row, const Box &box)
    {
      const int w      = box.n_of_line();
      const int w_line = nc * w, w_layer = box.count[1] * w_line;

      // Entry (line, c, X, d).
      std::fill_n(in_x, n_lines * w_line, 0.f);
      for (int x = 0; x < length; ++x)
        if (coarse.has_insertion(0, i[0] + x - p))
          {
            const NestedKnots::Row &r    = coarse.insertion(0, i[0] + x - p);
            const float            *from = row + x * nc;
            for (unsigned int k = 0; k < r.weights.size(); ++k)
              {
                const float weight = scale * r.weights[k];
                float      *to     = in_x + (r.first - box.first[0] + k) * nc;
                for (int l = 0; l < n_lines * nc; ++l)
                  for (int d = 0; d < nc; ++d)
                    to[l * w + d] += weight * from[l * line_size + d];
              }
          }

      // Entry (z, Y, c, X, d).
      std::fill_n(in_y, (reach[2] + 1) * w_layer, 0.f);
      for (int dz = 0, line = 0; dz <= reach[2]; ++dz)
        for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy, ++line)
          if (coarse.has_insertion(1, i[1] + dy))
            {
              const NestedKnots::Row &r = coarse.insertion(1, i[1] + dy);
              for (unsigned int k = 0; k < r.weights.size(); ++k)
                add_multiple(in_y + dz * w_layer +
                               (r.first - box.first[1] + k) * w_line,
                             r.weights[k],
                             in_x + line * w_line,
                             w_line);
            }
      if constexpr (dim == 3)
        {
          std::fill_n(in_z, box.count[2] * w_layer, 0.f);
          for (int dz = 0; dz <= reach[2]; ++dz)
            if (coarse.has_insertion(2, i[2] + dz))
              {
                const NestedKnots::Row &r = coarse.insertion(2, i[2] + dz);
                for (unsigned int k = 0; k < r.weights.size(); ++k)
                  add_multiple(in_z + (r.first - box.first[2] + k) * w_layer,
                               r.weights[k],
                               in_y + dz * w_layer,
                               w_layer);
              }
        }
      return dim == 3 ? in_z : in_y;
    }

    void
    add(const FarBlock &fine)
    {
      coarse.for_each_coarse(fine.i, [&](const Position &I, const float of_i) {
        coarse.for_each_coarse(fine.j,
                               [&](const Position &J, const float of_j) {
                                 add_block(I, J, of_i * of_j, fine.block, nc);
                               });
      });
    }

    /// Copy a row to plain_row, without the columns of functions that depend on
    /// others, which are listed in columns, and without the components @p
    /// constrained (bits) of the row.
    void
    take_extended_columns(const Position     &i,
                          const float        *row,
                          const unsigned char constrained)
    {
      std::copy_n(row, Half::row_size, plain_row);
      for (int line = 0; line < n_lines; ++line)
        for (int c = 0; c < nc; ++c)
          if ((constrained >> c) & 1)
            std::fill_n(plain_row + (line * nc + c) * line_size,
                        line_size,
                        0.f);
      extended_blocks.clear();
      for (int dz = 0, line = 0; dz <= reach[2]; ++dz)
        for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy, ++line)
          for (int x = line == 0 ? p : 0; x < length; ++x)
            {
              const Position j     = sum(i, {{x - p, dy, dz}});
              const Terms   *terms = extended.find(j);
              if (!terms)
                continue;
              float *block   = plain_row + line * nc * line_size + x * nc;
              bool   is_zero = true;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  {
                    float      &entry = block[c * line_size + d];
                    const float value =
                      (terms->constrained >> d) & 1 ? 0.f : entry;
                    is_zero = is_zero && value == 0.f;
                    extended_blocks.push_back(value);
                    entry = 0.f;
                  }
              if (is_zero)
                extended_blocks.resize(extended_blocks.size() - nc * nc);
              else
                columns.push_back({coarse.first_coarse(j), terms});
            }
    }

    /// Return the coarse functions of the listed columns.
    Box
    box_of_extended_columns() const
    {
      Box      result;
      Position last;
      result.first.fill(std::numeric_limits<int>::max());
      last.fill(-std::numeric_limits<int>::max());
      for (const Column &column : columns)
        for (unsigned int d = 0; d < 3; ++d)
          {
            result.first[d] =
              std::min(result.first[d],
                       column.first[d] + column.terms->lowest[d]);
            last[d] =
              std::max(last[d], column.first[d] + column.terms->highest[d]);
          }
      for (unsigned int d = 0; d < 3; ++d)
        result.count[d] = std::max(0, last[d] - result.first[d] + 1);
      return result;
    }

    /// Return the sum of B_ij P_j over the listed columns.
    const float *
    sum_extended_columns(const Box &box)
    {
      const int w = box.n_of_line();
      sum_of_columns.assign(box.size(), 0.f);
      const float *block = extended_blocks.data();
      for (const Column &column : columns)
        {
          for (const Term &term : column.terms->list)
            {
              float *to = sum_of_columns.data() +
                          box.offset(sum(column.first, term.offset));
              const float weight = scale * term.weight;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  to[c * w + d] += weight * block[c * nc + d];
            }
          block += nc * nc;
        }
      return sum_of_columns.data();
    }

    /// Add a multiple of the blocks of a box to the row of a coarse function,
    /// as far as it reaches.
    void
    add_to_row(const Position &I,
               const float     weight,
               const float    *blocks,
               const Box      &box)
    {
      const int u = coarse.find(coarse.wrapped(I));
      if (u < 0)
        return;
      Position begin, end;
      for (unsigned int d = 0; d < 3; ++d)
        {
          begin[d] = std::max(box.first[d], I[d] - reach[d]);
          end[d]   = std::min(box.first[d] + box.count[d], I[d] + reach[d] + 1);
        }
      if (begin[0] >= end[0])
        return;
      for (int Z = begin[2]; Z < end[2]; ++Z)
        for (int Y = begin[1]; Y < end[1]; ++Y)
          {
            const int line = (Z - I[2]) * length + Y - I[1];
            // Blocks of functions before I belong to the rows of those.
            const int    own  = line > 0    ? begin[0]
                                : line == 0 ? std::max(begin[0], I[0])
                                            : end[0];
            const float *from = blocks + box.offset({{begin[0], Y, Z}});
            for (int X = begin[0]; X < std::min(own, end[0]); ++X)
              add_to_earlier_row(u,
                                 line,
                                 X - I[0] + p,
                                 weight,
                                 from + (X - begin[0]) * nc,
                                 box.n_of_line());
            if (own < end[0])
              for (int c = 0; c < nc; ++c)
                add_multiple(half_row(u) + (line * nc + c) * line_size +
                               (own - I[0] + p) * nc,
                             weight,
                             from + c * box.n_of_line() + (own - begin[0]) * nc,
                             (end[0] - own) * nc);
          }
    }

    /// List the blocks of a box beyond the row of a coarse function.
    void
    add_beyond_row(const Position &I,
                   const float     weight,
                   const float    *blocks,
                   const Box      &box)
    {
      bool exceeds = false;
      for (unsigned int d = 0; d < 3; ++d)
        exceeds = exceeds || box.first[d] < I[d] - reach[d] ||
                  box.first[d] + box.count[d] > I[d] + reach[d] + 1;
      if (!exceeds)
        return;
      Position J;
      for (int Z = 0; Z < box.count[2]; ++Z)
        for (int Y = 0; Y < box.count[1]; ++Y)
          for (int X = 0; X < box.count[0]; ++X)
            {
              J = sum(box.first, {{X, Y, Z}});
              if (!is_inside(I, J))
                add_block(
                  I, J, weight, blocks + box.offset(J), box.n_of_line());
            }
    }

    static Position
    sum(const Position &a, const Position &b)
    {
      return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
    }

    static bool
    is_inside(const Position &I, const Position &J)
    {
      bool result = true;
      for (unsigned int d = 0; d < 3; ++d)
        result = result && std::abs(J[d] - I[d]) <= reach[d];
      return result;
    }

    /// Add a multiple of a block anywhere.
    void
    add_block(const Position &I,
              const Position &J,
              const float     weight,
              const float    *block,
              const int       stride)
    {
      const int u = coarse.find(coarse.wrapped(I)),
                v = coarse.find(coarse.wrapped(J));
      if (u < 0 || v < 0)
        return;
      if (is_inside(I, J))
        {
          const int line = (J[2] - I[2]) * length + J[1] - I[1],
                    x    = J[0] - I[0] + p;
          if (line < 0 || (line == 0 && x < p))
            {
              add_to_earlier_row(u, line, x, weight, block, stride);
              return;
            }
          for (int c = 0; c < nc; ++c)
            add_multiple(half_row(u) + (line * nc + c) * line_size + x * nc,
                         weight,
                         block + c * stride,
                         nc);
          return;
        }
      FarBlock entry{I, J, {}};
      bool     is_zero = true;
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          if (!coarse.is_constrained(u, c) && !coarse.is_constrained(v, d))
            {
              entry.block[c * nc + d] = weight * block[c * stride + d];
              is_zero = is_zero && entry.block[c * nc + d] == 0.f;
            }
      if (!is_zero)
        far_blocks.push_back(entry);
    }

    float *
    half_row(const unsigned int u)
    {
      return rows.data() + u * Half::row_size;
    }

    /// Add a multiple of the transpose of a block to the row of the function in
    /// its column, in a line before u, or in the same line.
    void
    add_to_earlier_row(const unsigned int u,
                       const int          line,
                       const int          x,
                       const float        weight,
                       const float       *block,
                       const int          stride)
    {
      const int v = coarse.unknown_in_line(u, line, x - p);
      if (v < 0)
        return;
      float *to = half_row(v) - line * nc * line_size + (length - 1 - x) * nc;
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          to[d * line_size + c] += weight * block[c * stride + d];
    }

    /// Add up the listed blocks of the same functions.
    void
    merge_far_blocks()
    {
      std::sort(far_blocks.begin(),
                far_blocks.end(),
                [](const FarBlock &a, const FarBlock &b) {
                  return std::tie(a.i, a.j) < std::tie(b.i, b.j);
                });
      std::size_t n_merged = 0;
      for (const FarBlock &entry : far_blocks)
        if (n_merged > 0 && far_blocks[n_merged - 1].i == entry.i &&
            far_blocks[n_merged - 1].j == entry.j)
          for (int k = 0; k < nc * nc; ++k)
            far_blocks[n_merged - 1].block[k] += entry.block[k];
        else
          far_blocks[n_merged++] = entry;
      far_blocks.resize(n_merged);
    }

    /// Set the blocks of functions that are no unknowns, and of constrained
    /// components, to zero.
    void
    leave_out_other_functions()
    {
      for (unsigned int u = 0; u < coarse.positions().size(); ++u)
        for (int line = 0; line < n_lines; ++line)
          for (int x = line == 0 ? p : 0; x < length; ++x)
            {
              const int v     = coarse.unknown_in_line(u, line, x - p);
              float    *block = half_row(u) + line * nc * line_size + x * nc;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  if (v < 0 || coarse.is_constrained(u, c) ||
                      coarse.is_constrained(v, d))
                    block[c * line_size + d] = 0.f;
            }
    }

    const LatticeUnknowns<dim> &coarse;
    const float                 scale;
    std::vector<float>         &rows;
    std::vector<FarBlock>      &far_blocks;

    const ExtendedTerms<dim> extended;
    std::vector<Column>      columns;
    std::vector<float>       extended_blocks; // of the columns
    std::vector<float>       sum_of_columns;

    float plain_row[Half::row_size];
    float in_x[n_lines * nc * most * nc];
    float in_y[(dim == 3 ? n : 1) * most * nc * most * nc];
    float in_z[dim == 3 ? most * most * nc * most * nc : 1];
  };
} // namespace greville
