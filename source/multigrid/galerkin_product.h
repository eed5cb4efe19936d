// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "extended_terms.h"
#include <tuple>

namespace greville
{
  /// The sum of P_i^T B_ij P_j over the blocks of half rows B, in half rows of
  /// the coarse unknowns. P_i contains the coarse functions of function i, and
  /// of the unknowns on which an extended i depends. Other functions are
  /// inserted direction by direction. In a refined grid, an extended function
  /// can have coarse functions of several levels of cells.
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
      , boxes(coarse.lattice()[0].n_levels())
    {
      sums.assign(coarse.positions().size() * sums_size, 0.f);
      fine.for_each_row(
        [&](const Position &i, const float *row) { add(i, row); });
      add_far_blocks(fine);
      merge_far_blocks();
      write_half_rows();
    }

  private:
    static constexpr int      p = n - 1;
    static constexpr Position reach{{p, p, dim == 3 ? p : 0}};
    static constexpr int      length    = Half::length;
    static constexpr int      line_size = Half::line_size;
    static constexpr int      n_lines   = Half::n_lines;
    static constexpr int      sums_size = (2 * n_lines - 1) * nc * line_size;

    using Vector = FixedSimd<float, Half::width>;
    // The components of a function, and one number behind them in 3D.
    static constexpr int block_width = nc == 3 ? 4 : nc;
    using Block                      = FixedSimd<float, block_width>;

    /// A column of a function that depends on unknowns.
    struct Column
    {
      Position     first;
      const Terms *terms;
    };

    /// A box of coarse functions of a level, for which a row has one block
    /// each. Entry (c, d) of a block is at place() + c * stride + d.
    struct Box
    {
      Position begin, end;
      int      begin_x = 0, end_x = 0; // of the functions of columns
      int      stride = 0, first_place = 0;

      Box()
      {
        begin.fill(std::numeric_limits<int>::max());
        end.fill(-std::numeric_limits<int>::max());
      }

      void
      include(const int d, const int first, const int last)
      {
        begin[d] = std::min(begin[d], first);
        end[d]   = std::max(end[d], last + 1);
      }

      bool
      is_empty() const
      {
        return begin[0] >= end[0];
      }

      /// Extend the lines of the box along x, from p functions before @p first
      /// to p functions after @p last.
      void
      include_lines(const int first, const int last)
      {
        begin_x = begin[0];
        end_x   = end[0];
        include(0, first - p, last + p);
        stride =
          ((end[0] - begin[0] - length) * nc + line_size + Half::width - 1) /
          Half::width * Half::width;
      }

      int
      count(const int d) const
      {
        return end[d] - begin[d];
      }

      int
      place(const Position &I) const
      {
        return first_place +
               ((I[2] - begin[2]) * count(1) + I[1] - begin[1]) * nc * stride +
               (I[0] - begin[0]) * nc;
      }

      int
      size() const
      {
        return count(2) * count(1) * nc * stride;
      }
    };

    /// Add @p factor times k numbers, as whole vectors.
    static void
    add_multiple(float *to, const float factor, const float *from, const int k)
    {
      for (int e = 0; e < k; e += Half::width)
        store(Vector(load<Vector>(to + e) + factor * load<Vector>(from + e)),
              to + e);
    }

    /// Add a multiple of lines of a block.
    static void
    add_blocks(float       *to,
               const int    stride_to,
               const float  weight,
               const float *from,
               const int    stride_from,
               const int    n_blocks)
    {
      const Block weights([&](const int d) { return d < nc ? weight : 0.f; });
      for (int l = 0; l < n_blocks; ++l)
        store(Block(load<Block>(to + l * stride_to) +
                    weights * load<Block>(from + l * stride_from)),
              to + l * stride_to);
    }

    void
    add(const Position &i, const float *row)
    {
      const Terms *own = nullptr; // if the function depends on unknowns
      columns.clear();
      if (extended.touches(i))
        {
          own = extended.find(i);
          if (own && own->list.empty())
            return;
          take_extended_columns(i, row, own ? own->constrained : 0);
          row = plain_row;
        }
      const Box plain = box_of_columns(i);
      std::fill(boxes.begin(), boxes.end(), Box());
      Box &box = box_of(coarse.first_coarse(i));
      box      = plain;
      for (const Column &column : columns)
        for (const auto &range : column.terms->ranges)
          for (int d = 0; d < 3; ++d)
            boxes[range.level].include(d,
                                       column.first[d] + range.lowest[d],
                                       column.first[d] + range.highest[d]);
      begin_blocks(i, own);
      sum_columns(i, row, plain, box);
      sum_extended_columns();
      add_rows(i, own, own || !columns.empty());
    }

    Box &
    box_of(const Position &I)
    {
      return boxes[coarse.level(I)];
    }

    /// Return the coarse functions of the columns of a row.
    Box
    box_of_columns(const Position &i) const
    {
      Box result;
      for (int d = 0; d < 3; ++d)
        for (int k = d < dim - 1 ? -reach[d] : 0; k <= reach[d]; ++k)
          include_coarse(d, i[d] + k, result);
      return result;
    }

    void
    include_coarse(const int d, const int i, Box &box) const
    {
      if (!coarse.has_insertion(d, i))
        return;
      const NestedKnots::Row &r = coarse.insertion(d, i);
      box.include(d, r.first, r.first + int(r.weights.size()) - 1);
    }

    /// Prepare the boxes for the lines of all coarse functions of i, with zero
    /// blocks.
    void
    begin_blocks(const Position &i, const Terms *own)
    {
      const NestedKnots::Row &r         = coarse.insertion(0, i[0]);
      const unsigned int      of_row    = coarse.level(coarse.first_coarse(i));
      int                     n_numbers = 0;
      for (unsigned int l = 0; l < boxes.size(); ++l)
        {
          Box &box = boxes[l];
          if (box.is_empty())
            continue;
          int first = box.begin[0], last = box.end[0] - 1;
          if (!own && l == of_row)
            {
              first = r.first;
              last  = r.first + int(r.weights.size()) - 1;
            }
          if (own)
            for (const auto &range : own->ranges)
              if (range.level == l)
                {
                  first = r.first + range.lowest[0];
                  last  = r.first + range.highest[0];
                }
          box.include_lines(first, last);
          box.first_place = n_numbers;
          n_numbers += box.size();
        }
      blocks.assign(n_numbers + block_width, 0.f);
    }

    /// Add P_i^T times the blocks of the boxes, which may reach beyond rows.
    void
    add_rows(const Position &i, const Terms *own, const bool can_exceed)
    {
      const auto add = [&](const Position &I, const float weight) {
        const int u = coarse.find(coarse.wrapped(I));
        if (u < 0)
          return;
        const Box &box = box_of(I);
        if (!box.is_empty())
          add_to_row(I, u, weight, box);
        if (can_exceed)
          add_beyond_row(I, u, weight);
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

    /// Add the sum of B_ij P_j over columns j that do not depend on unknowns.
    /// The box @p plain contains their coarse functions.
    void
    sum_columns(const Position &i,
                const float    *row,
                const Box      &plain,
                const Box      &box)
    {
      const int w       = box.stride;
      const int w_line  = nc * w;
      const int w_layer = plain.count(1) * w_line;

      // Entry (line, c, X, d).
      in_x.assign(n_lines * w_line + block_width, 0.f);
      for (int x = 0; x < length; ++x)
        if (coarse.has_insertion(0, i[0] + x - p))
          {
            const NestedKnots::Row &r = coarse.insertion(0, i[0] + x - p);
            for (unsigned int k = 0; k < r.weights.size(); ++k)
              add_blocks(in_x.data() + (r.first - box.begin[0] + k) * nc,
                         w,
                         scale * r.weights[k],
                         row + x * nc,
                         line_size,
                         n_lines * nc);
          }

      // Entry (z, Y, c, X, d).
      in_y.assign((reach[2] + 1) * w_layer, 0.f);
      for (int dz = 0, line = 0; dz <= reach[2]; ++dz)
        for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy, ++line)
          if (coarse.has_insertion(1, i[1] + dy))
            {
              const NestedKnots::Row &r = coarse.insertion(1, i[1] + dy);
              for (unsigned int k = 0; k < r.weights.size(); ++k)
                add_multiple(in_y.data() + dz * w_layer +
                               (r.first - plain.begin[1] + k) * w_line,
                             r.weights[k],
                             in_x.data() + line * w_line,
                             w_line);
            }
      for (int dz = 0; dz <= reach[2]; ++dz)
        if (coarse.has_insertion(2, i[2] + dz))
          {
            const NestedKnots::Row &r = coarse.insertion(2, i[2] + dz);
            for (unsigned int k = 0; k < r.weights.size(); ++k)
              add_multiple(
                blocks.data() +
                  box.place({{box.begin[0], plain.begin[1], r.first + int(k)}}),
                r.weights[k],
                in_y.data() + dz * w_layer,
                w_layer);
          }
    }

    /// Add the blocks of the finer level beyond its rows, row by row.
    void
    add_far_blocks(const LatticeLevel<dim> &fine)
    {
      std::vector<FarBlock> of_row;
      const auto            add_row = [&]() {
        if (of_row.empty())
          return;
        const Position &i = of_row[0].i;
        std::fill(boxes.begin(), boxes.end(), Box());
        for (const FarBlock &far : of_row)
          for (int d = 0; d < 3; ++d)
            include_coarse(d, far.j[d], box_of(coarse.first_coarse(far.j)));
        begin_blocks(i, nullptr);
        for (const FarBlock &far : of_row)
          {
            const Box &box = box_of(coarse.first_coarse(far.j));
            float      block[nc * block_width] = {};
            for (int c = 0; c < nc; ++c)
              std::copy_n(far.block + c * nc, nc, block + c * block_width);
            coarse.for_each_coarse(far.j,
                                   [&](const Position &J, const float weight) {
                                     add_blocks(blocks.data() + box.place(J),
                                                box.stride,
                                                scale * weight,
                                                block,
                                                block_width,
                                                nc);
                                   });
          }
        add_rows(i, nullptr, true);
        of_row.clear();
      };
      fine.for_each_far_block([&](const FarBlock &far) {
        if (!of_row.empty() && far.i != of_row[0].i)
          add_row();
        of_row.push_back(far);
      });
      add_row();
    }

    /// Copy a row to plain_row, without the @p constrained components (bits) of
    /// the row. Columns of functions that depend on unknowns are not copied but
    /// listed in columns.
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
              const std::size_t first = extended_blocks.size();
              extended_blocks.resize(first + nc * block_width, 0.f);
              float *block   = plain_row + line * nc * line_size + x * nc;
              bool   is_zero = true;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  {
                    float      &entry = block[c * line_size + d];
                    const float value =
                      (terms->constrained >> d) & 1 ? 0.f : entry;
                    is_zero = is_zero && value == 0.f;
                    extended_blocks[first + c * block_width + d] = value;
                    entry                                        = 0.f;
                  }
              if (is_zero || terms->list.empty())
                extended_blocks.resize(first);
              else
                columns.push_back({coarse.first_coarse(j), terms});
            }
    }

    /// Add the sum of B_ij P_j over the listed columns.
    void
    sum_extended_columns()
    {
      const float *block = extended_blocks.data();
      for (const Column &column : columns)
        {
          for (const Term &term : column.terms->list)
            {
              const Box &box = boxes[term.level];
              add_blocks(blocks.data() +
                           box.place(sum(column.first, term.offset)),
                         box.stride,
                         scale * term.weight,
                         block,
                         block_width,
                         nc);
            }
          block += nc * block_width;
        }
    }

    /// Add a multiple of the blocks of a box to the row of a coarse function,
    /// except for blocks beyond the row.
    void
    add_to_row(const Position    &I,
               const unsigned int u,
               const float        weight,
               const Box         &box)
    {
      float    *row   = sums.data() + u * sums_size;
      const int end_Y = std::min(box.end[1], I[1] + reach[1] + 1),
                end_Z = std::min(box.end[2], I[2] + reach[2] + 1);
      for (int Z = std::max(box.begin[2], I[2] - reach[2]); Z < end_Z; ++Z)
        for (int Y = std::max(box.begin[1], I[1] - reach[1]); Y < end_Y; ++Y)
          {
            const int    line = n_lines - 1 + (Z - I[2]) * length + Y - I[1];
            const float *from = blocks.data() + box.place({{I[0] - p, Y, Z}});
            for (int c = 0; c < nc; ++c)
              add_multiple(row + (line * nc + c) * line_size,
                           weight,
                           from + c * box.stride,
                           line_size);
          }
    }

    /// List the blocks of the boxes beyond the row of a coarse function.
    void
    add_beyond_row(const Position &I, const unsigned int u, const float weight)
    {
      for (const Box &box : boxes)
        for (int Z = box.begin[2]; Z < box.end[2]; ++Z)
          for (int Y = box.begin[1]; Y < box.end[1]; ++Y)
            {
              const bool is_in_line = std::abs(Y - I[1]) <= reach[1] &&
                                      std::abs(Z - I[2]) <= reach[2];
              for (int X = box.begin_x; X < box.end_x; ++X)
                if (!is_in_line || std::abs(X - I[0]) > p)
                  add_far_block(I, u, {{X, Y, Z}}, weight, box);
            }
    }

    static Position
    sum(const Position &a, const Position &b)
    {
      return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
    }

    static bool
    is_zero(const float *block, const int stride)
    {
      bool result = true;
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          result = result && block[c * stride + d] == 0.f;
      return result;
    }

    void
    add_far_block(const Position    &I,
                  const unsigned int u,
                  const Position    &J,
                  const float        weight,
                  const Box         &box)
    {
      const float *block = blocks.data() + box.place(J);
      if (is_zero(block, box.stride))
        return;
      const int v = coarse.find(coarse.wrapped(J));
      if (v < 0)
        return;
      FarBlock entry{I, J, {}};
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          if (!coarse.is_constrained(u, c) && !coarse.is_constrained(v, d))
            entry.block[c * nc + d] = weight * block[c * box.stride + d];
      if (!is_zero(entry.block, nc))
        far_blocks.push_back(entry);
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

    /// Write the half rows. A block before the diagonal block is added,
    /// transposed, to the row of the function in its column. Blocks of
    /// constrained components, and of functions that are not unknowns, are
    /// omitted.
    void
    write_half_rows()
    {
      rows.assign(coarse.positions().size() * Half::row_size, 0.f);
      const float *block = sums.data();
      for (unsigned int u = 0; u < coarse.positions().size(); ++u)
        for (int line = 1 - n_lines; line < n_lines;
             ++line, block += nc * line_size)
          for (int x = 0; x < length; ++x)
            {
              const int v = coarse.unknown_in_line(u, line, x - p);
              if (v < 0)
                continue;
              const bool is_before = line < 0 || (line == 0 && x < p);
              float     *to        = rows.data() +
                          std::size_t(is_before ? v : u) * Half::row_size +
                          std::abs(line) * nc * line_size +
                          (is_before ? length - 1 - x : x) * nc;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  if (!coarse.is_constrained(u, c) &&
                      !coarse.is_constrained(v, d))
                    to[is_before ? d * line_size + c : c * line_size + d] +=
                      block[c * line_size + x * nc + d];
            }
    }

    const LatticeUnknowns<dim> &coarse;
    const float                 scale;
    std::vector<float>         &rows;
    std::vector<FarBlock>      &far_blocks;

    const ExtendedTerms<dim> extended;
    std::vector<Column>      columns;
    std::vector<float>       extended_blocks; // of the columns

    float              plain_row[Half::row_size];
    std::vector<Box>   boxes; // of the row's blocks, by level of cells
    std::vector<float> in_x, in_y, blocks;
    // Rows with all neighbours, as [line][c][x][d].
    std::vector<float> sums;
  };
} // namespace greville
