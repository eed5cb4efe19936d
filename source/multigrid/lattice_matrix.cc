// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/base/with_width.h>
#include <greville/multigrid/lattice_matrix.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Coarse functions at the edge of a body may be linearly dependent to
    // single precision: this fraction of the largest diagonal entry keeps
    // matrices positive definite.
    constexpr double relative_regularization = 1e-6;
  } // namespace



  template <int dim>
  template <typename Action>
  void
  LatticeMatrix<dim>::with_sizes(const Action &action) const
  {
    with_order(knots[0].degree(), [&](const auto n) {
      with_one_of<1, dim>(components, [&](const auto nc) { action(nc, n); });
    });
  }



  /**
   * The sum of P_i^T B_ij P_j over the blocks of half rows B, in half rows.
   */
  template <int dim>
  template <int nc, int n>
  class LatticeMatrix<dim>::Product
  {
  public:
    using Half = HalfStencil<dim, nc, n, double>;

    Product(LatticeMatrix &coarse, const LatticeLevel<dim> &fine)
      : coarse(coarse)
      , scale(1. / fine.unit())
    {
      coarse.row_size = Half::row_size;
      coarse.rows.assign(coarse.positions.size() * Half::row_size, 0.);
      set_extended(fine);
    }

    void
    add(const Position &i, const double *row)
    {
      if (touches_extended(i))
        {
          add_with_extended(i, row);
          return;
        }
      // The first coarse function of the columns and their number.
      std::array<int, dim> first, count;
      for (unsigned int d = 0; d < dim; ++d)
        {
          int low = std::numeric_limits<int>::max(), high = -low;
          for (int k = -p; k <= p; ++k)
            if (const NestedKnots::Row *r = column(d, i[d] + k))
              {
                low  = std::min(low, r->first);
                high = std::max(high, r->first + int(r->weights.size()));
              }
          first[d] = low;
          count[d] = high - low;
        }

      // In x: [line][c][X][d].
      const int w = count[0] * nc;
      std::fill_n(in_x, n_lines * nc * w, 0.);
      for (int x = 0; x < length; ++x)
        if (const NestedKnots::Row *r = column(0, i[0] + x - p))
          for (unsigned int k = 0; k < r->weights.size(); ++k)
            {
              const double  weight = scale * r->weights[k];
              const double *from   = row + x * nc;
              double       *to     = in_x + (r->first - first[0] + k) * nc;
              for (int l = 0; l < n_lines * nc; ++l)
                for (int d = 0; d < nc; ++d)
                  to[l * w + d] += weight * from[l * line_size + d];
            }

      // In y: [dz][Y][c][X][d].
      const int     w_line  = nc * w;
      const int     w_layer = count[1] * w_line;
      constexpr int n_z     = dim == 3 ? n : 1;
      std::fill_n(in_y, n_z * w_layer, 0.);
      for (int dz = 0, line = 0; dz < n_z; ++dz)
        for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy, ++line)
          if (const NestedKnots::Row *r = column(1, i[1] + dy))
            for (unsigned int k = 0; k < r->weights.size(); ++k)
              add_multiple(in_y + dz * w_layer +
                             (r->first - first[1] + k) * w_line,
                           r->weights[k],
                           in_x + line * w_line,
                           w_line);
      const double *result = in_y;
      if constexpr (dim == 3)
        {
          std::fill_n(in_z, count[2] * w_layer, 0.);
          for (int dz = 0; dz < n_z; ++dz)
            if (const NestedKnots::Row *r = column(2, i[2] + dz))
              for (unsigned int k = 0; k < r->weights.size(); ++k)
                add_multiple(in_z + (r->first - first[2] + k) * w_layer,
                             r->weights[k],
                             in_y + dz * w_layer,
                             w_layer);
          result = in_z;
        }
      for_each_term(i, [&](const Position &I, const double weight) {
        add_to_row(I, weight, result, first, count);
      });
    }

    /// Add P_i^T B_ij P_j for a block beyond the stencils of the finer level.
    void
    add(const typename LatticeLevel<dim>::FarBlock &fine)
    {
      for_each_term(fine.i, [&](const Position &I, const double of_i) {
        for_each_term(fine.j, [&](const Position &J, const double of_j) {
          add_block(I, J, of_i * of_j, fine.block, nc);
        });
      });
    }

    /// Leave out other functions than the unknowns.
    void
    finish()
    {
      merge_beyond();
      for (unsigned int u = 0; u < coarse.positions.size(); ++u)
        for (int k = 0; k < n_lines; ++k)
          for (int x = 0; x < length; ++x)
            {
              const int v =
                k == 0 && x < p ?
                  -1 :
                  coarse
                    .unknown_at[coarse.places[u] + coarse.distances[k] + x - p];
              double *block = half_row(u) + k * nc * line_size + x * nc;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  if (v < 0 || ((coarse.constrained[u] >> c) & 1) ||
                      ((coarse.constrained[v] >> d) & 1))
                    block[c * line_size + d] = 0.;
            }
    }

  private:
    static constexpr int p         = n - 1;
    static constexpr int length    = Half::length;
    static constexpr int line_size = Half::line_size;
    static constexpr int n_lines   = Half::n_lines;
    static constexpr int middle    = n_lines - 1;
    // The largest number of coarse functions of the columns.
    static constexpr int most = 2 * n + 1;

    double *
    half_row(const unsigned int u) const
    {
      return coarse.rows.data() + u * Half::row_size;
    }

    /// Add a multiple of a block at x in a line, counted from the own line, to
    /// the half row of the first function of both in the order of places.
    void
    add_to_half_row(const unsigned int u,
                    const int          line,
                    const int          x,
                    const double       weight,
                    const double      *block,
                    const int          stride)
    {
      if (line > 0 || (line == 0 && x >= p))
        {
          double *to = half_row(u) + line * nc * line_size + x * nc;
          for (int c = 0; c < nc; ++c)
            for (int d = 0; d < nc; ++d)
              to[c * line_size + d] += weight * block[c * stride + d];
          return;
        }
      const int v =
        coarse.unknown_at[coarse.places[u] - coarse.distances[-line] + x - p];
      if (v < 0)
        return;
      double *to =
        half_row(v) - line * nc * line_size + (length - 1 - x) * nc;
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          to[d * line_size + c] += weight * block[c * stride + d];
    }

    static void
    add_multiple(double *to, const double factor, const double *from, const int k)
    {
      for (int e = 0; e < k; ++e)
        to[e] += factor * from[e];
    }

    /// Add up the listed blocks of the same functions.
    void
    merge_beyond()
    {
      auto &list = coarse.beyond;
      std::sort(list.begin(), list.end(), [](const Beyond &a, const Beyond &b) {
        return std::tie(a.u, a.v, a.i, a.j) < std::tie(b.u, b.v, b.i, b.j);
      });
      std::size_t n_merged = 0;
      for (const Beyond &entry : list)
        if (n_merged > 0 && list[n_merged - 1].i == entry.i &&
            list[n_merged - 1].j == entry.j)
          for (int k = 0; k < nc * nc; ++k)
            list[n_merged - 1].block[k] += entry.block[k];
        else
          list[n_merged++] = entry;
      list.resize(n_merged);
    }

    /// Return the insertion of a function, null outside.
    const NestedKnots::Row *
    column(const unsigned int d, const int i) const
    {
      const int k = i + coarse.margin();
      return k >= 0 && k < int(coarse.insertions[d].size()) &&
                 !coarse.insertions[d][k].weights.empty()
               ? &coarse.insertions[d][k]
               : nullptr;
    }

    /// A coarse function of a fine one, counted from the first function of its
    /// insertion.
    struct Term
    {
      Position offset;
      double    weight;
    };

    /// The coarse functions of a fine one.
    struct Terms
    {
      Position          lowest, highest;
      std::vector<Term> list;
    };

    /// A column of a fine row: its block and its coarse functions.
    struct Column
    {
      const double *block;
      Position     first;
      const Terms *terms;
    };

    void
    set_extended(const LatticeLevel<dim> &fine)
    {
      const auto                                     lattice = fine.lattice();
      std::vector<std::pair<Position, unsigned int>> all;
      fine.for_each_extended([&](const Position &i, const auto &terms) {
        all.emplace_back(i, extended.size());
        extended.push_back(insert(i, terms, lattice));
      });
      if (all.empty())
        return;
      for (unsigned int d = 0; d < dim; ++d)
        if (lattice[d].is_periodic())
          for (std::size_t k = 0, n_before = all.size(); k < n_before; ++k)
            for (const int shift : {-1, 1})
              {
                auto image = all[k];
                image.first[d] += shift * lattice[d].n_functions();
                if (image.first[d] >= -p &&
                    image.first[d] < lattice[d].n_functions() + p)
                  all.push_back(image);
              }
      std::size_t n_all = 1;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const auto is_before = [&](const auto &a, const auto &b) {
            return a.first[d] < b.first[d];
          };
          low[d] =
            std::min_element(all.begin(), all.end(), is_before)->first[d] - p;
          size[d] =
            std::max_element(all.begin(), all.end(), is_before)->first[d] + p +
            1 - low[d];
          n_all *= size[d];
        }
      extended_at.assign(n_all, none);
      is_near.assign(n_all, false);
      for (const auto &entry : all)
        {
          extended_at[box_place(entry.first)] = entry.second;
          for_each_neighbor(entry.first, [&](const Position &j) {
            is_near[box_place(j)] = true;
          });
        }
    }

    template <typename Visit>
    static void
    for_each_neighbor(const Position &i, const Visit &visit)
    {
      Position j = i;
      for (int dz = dim == 3 ? -p : 0; dz <= (dim == 3 ? p : 0); ++dz)
        for (int dy = -p; dy <= p; ++dy)
          for (int dx = -p; dx <= p; ++dx)
            {
              j[0] = i[0] + dx;
              j[1] = i[1] + dy;
              if (dim == 3)
                j[dim - 1] = i[dim - 1] + dz;
              visit(j);
            }
    }

    /// Return the coarse functions of an extended function.
    Terms
    insert(const Position                          &i,
           const typename LatticeLevel<dim>::Terms &terms,
           const Lattice                           &lattice) const
    {
      std::map<Position, double> sums;
      for (const auto &[given, weight] : terms)
        {
          // The image next to the function.
          Position u = given;
          for (unsigned int d = 0; d < dim; ++d)
            if (lattice[d].is_periodic())
              {
                const int period = lattice[d].n_functions();
                if (2 * (u[d] - i[d]) > period)
                  u[d] -= period;
                else if (2 * (i[d] - u[d]) > period)
                  u[d] += period;
              }
          for_each_term(u, [&](const Position &I, const double of_u) {
            sums[I] += weight * of_u;
          });
        }
      Terms result;
      for (unsigned int d = 0; d < dim; ++d)
        {
          result.lowest[d]  = std::numeric_limits<int>::max();
          result.highest[d] = -result.lowest[d];
        }
      constexpr double negligible = 1e-5;
      for (const auto &[I, weight] : sums)
        if (std::abs(weight) > negligible)
          {
            Term term{I, weight};
            for (unsigned int d = 0; d < dim; ++d)
              {
                term.offset[d] -= coarse.insertion(d, i[d]).first;
                result.lowest[d]  = std::min(result.lowest[d], term.offset[d]);
                result.highest[d] = std::max(result.highest[d], term.offset[d]);
              }
            result.list.push_back(term);
          }
      return result;
    }

    /// Call visit(I, weight) for the coarse functions of an unknown, not
    /// wrapped.
    template <typename Visit>
    void
    for_each_term(const Position &u, const Visit &visit) const
    {
      const NestedKnots::Row &x = coarse.insertion(0, u[0]),
                             &y = coarse.insertion(1, u[1]);
      const NestedKnots::Row *z =
        dim == 3 ? &coarse.insertion(dim - 1, u[dim - 1]) : nullptr;
      Position I{};
      for (unsigned int kz = 0; kz < (z ? z->weights.size() : 1); ++kz)
        for (unsigned int ky = 0; ky < y.weights.size(); ++ky)
          for (unsigned int kx = 0; kx < x.weights.size(); ++kx)
            {
              if (z)
                I[dim - 1] = z->first + kz;
              I[1] = y.first + ky;
              I[0] = x.first + kx;
              visit(I,
                    x.weights[kx] * y.weights[ky] * (z ? z->weights[kz] : 1.));
            }
    }

    std::size_t
    box_place(const Position &i) const
    {
      std::size_t result = 0;
      for (int d = dim - 1; d >= 0; --d)
        result = result * size[d] + (i[d] - low[d]);
      return result;
    }

    bool
    is_in_box(const Position &i) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (i[d] < low[d] || i[d] >= low[d] + size[d])
          return false;
      return true;
    }

    bool
    touches_extended(const Position &i) const
    {
      return !extended.empty() && is_in_box(i) && is_near[box_place(i)];
    }

    /// Set the coarse functions of a fine one and return them.
    const Terms &
    terms_of(const Position &i, Terms &own) const
    {
      if (is_in_box(i))
        {
          const unsigned int e = extended_at[box_place(i)];
          if (e != none)
            return extended[e];
        }
      own.list.clear();
      Position first;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const NestedKnots::Row &r = coarse.insertion(d, i[d]);
          first[d]                  = r.first;
          own.lowest[d]             = 0;
          own.highest[d]            = int(r.weights.size()) - 1;
        }
      for_each_term(i, [&](const Position &I, const double weight) {
        Term term{I, weight};
        for (unsigned int d = 0; d < dim; ++d)
          term.offset[d] -= first[d];
        own.list.push_back(term);
      });
      return own;
    }

    void
    add_with_extended(const Position &i, const double *row)
    {
      // The columns and their range of coarse functions.
      columns.clear();
      own_terms.resize(n_lines * length + 1);
      std::array<int, dim> first, count;
      first.fill(std::numeric_limits<int>::max());
      std::array<int, dim> last;
      last.fill(-std::numeric_limits<int>::max());
      constexpr int n_z = dim == 3 ? n : 1;
      for (int dz = 0, line = 0; dz < n_z; ++dz)
        for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy, ++line)
          for (int x = line == 0 ? p : 0; x < length; ++x)
            {
              const double *block   = row + line * nc * line_size + x * nc;
              bool         is_zero = true;
              for (int c = 0; c < nc; ++c)
                for (int d = 0; d < nc; ++d)
                  is_zero = is_zero && block[c * line_size + d] == 0.;
              if (is_zero)
                continue;
              Position j = i;
              j[0] += x - p;
              j[1] += dy;
              if (dim == 3)
                j[dim - 1] += dz;
              Column column{block,
                            {},
                            &terms_of(j, own_terms[line * length + x])};
              for (unsigned int d = 0; d < dim; ++d)
                {
                  column.first[d] = coarse.insertion(d, j[d]).first;
                  first[d] =
                    std::min(first[d],
                             column.first[d] + column.terms->lowest[d]);
                  last[d] =
                    std::max(last[d],
                             column.first[d] + column.terms->highest[d]);
                }
              columns.push_back(column);
            }
      if (columns.empty())
        return;
      for (unsigned int d = 0; d < dim; ++d)
        count[d] = last[d] - first[d] + 1;
      const int w       = count[0] * nc;
      const int w_line  = nc * w;
      const int w_layer = count[1] * w_line;
      sum_of_columns.assign((dim == 3 ? count[dim - 1] : 1) * w_layer, 0.);
      for (const Column &column : columns)
        for (const Term &term : column.terms->list)
          {
            double *to = sum_of_columns.data() +
                        (column.first[0] + term.offset[0] - first[0]) * nc +
                        (column.first[1] + term.offset[1] - first[1]) * w_line +
                        (dim == 3 ? (column.first[dim - 1] +
                                     term.offset[dim - 1] - first[dim - 1]) *
                                      w_layer
                                  : 0);
            const double weight = scale * term.weight;
            for (int c = 0; c < nc; ++c)
              for (int d = 0; d < nc; ++d)
                to[c * w + d] += weight * column.block[c * line_size + d];
          }
      Position own_first;
      for (unsigned int d = 0; d < dim; ++d)
        own_first[d] = coarse.insertion(d, i[d]).first;
      for (const Term &term : terms_of(i, own_terms.back()).list)
        {
          Position I = own_first;
          for (unsigned int d = 0; d < dim; ++d)
            I[d] += term.offset[d];
          add_to_row(I, term.weight, sum_of_columns.data(), first, count);
          add_beyond(I, term.weight, sum_of_columns.data(), first, count);
        }
    }

    /// List the blocks beyond the stencil.
    void
    add_beyond(const Position             &I,
               const double                 weight,
               const double                *sum,
               const std::array<int, dim> &first,
               const std::array<int, dim> &count)
    {
      bool exceeds = false;
      for (unsigned int d = 0; d < dim; ++d)
        exceeds =
          exceeds || first[d] < I[d] - p || first[d] + count[d] > I[d] + n;
      if (!exceeds)
        return;
      const int w = count[0] * nc, w_line = nc * w, w_layer = count[1] * w_line;
      Position  J;
      for (int Z = 0; Z < (dim == 3 ? count[dim - 1] : 1); ++Z)
        for (int Y = 0; Y < count[1]; ++Y)
          for (int X = 0; X < count[0]; ++X)
            {
              if (dim == 3)
                J[dim - 1] = first[dim - 1] + Z;
              J[1] = first[1] + Y;
              J[0] = first[0] + X;
              if (!is_inside(I, J))
                add_block(
                  I, J, weight, sum + Z * w_layer + Y * w_line + X * nc, w);
            }
    }

    static bool
    is_inside(const Position &I, const Position &J)
    {
      bool result = true;
      for (unsigned int d = 0; d < dim; ++d)
        result = result && std::abs(J[d] - I[d]) <= p;
      return result;
    }

    int
    unknown(const Position &i) const
    {
      Position wrapped;
      for (unsigned int d = 0; d < dim; ++d)
        wrapped[d] = coarse.wrap(d, i[d]);
      return coarse.find(wrapped);
    }

    /// Add a multiple of a block.
    void
    add_block(const Position &I,
              const Position &J,
              const double     weight,
              const double    *block,
              const int       stride)
    {
      const int u = unknown(I), v = unknown(J);
      if (u < 0 || v < 0)
        return;
      if (is_inside(I, J))
        {
          int line = J[1] - I[1] + p;
          if (dim == 3)
            line += (J[dim - 1] - I[dim - 1] + p) * length;
          add_to_half_row(
            u, line - middle, J[0] - I[0] + p, weight, block, stride);
          return;
        }
      Beyond entry{{I, J, {}}, unsigned(u), unsigned(v)};
      bool   is_zero = true;
      for (int c = 0; c < nc; ++c)
        for (int d = 0; d < nc; ++d)
          if (!((coarse.constrained[u] >> c) & 1) &&
              !((coarse.constrained[v] >> d) & 1))
            {
              entry.block[c * nc + d] = weight * block[c * stride + d];
              is_zero = is_zero && entry.block[c * nc + d] == 0.;
            }
      if (!is_zero)
        coarse.beyond.push_back(entry);
    }

    /// Add a multiple of the columns of a fine row to the row of a coarse
    /// function.
    void
    add_to_row(const Position             &I,
               const double                 weight,
               const double                *sum,
               const std::array<int, dim> &first,
               const std::array<int, dim> &count)
    {
      Position wrapped;
      for (unsigned int d = 0; d < dim; ++d)
        wrapped[d] = coarse.wrap(d, I[d]);
      const int u = coarse.find(wrapped);
      if (u < 0)
        return;
      const int            w       = count[0] * nc;
      const int            w_line  = nc * w;
      const int            w_layer = count[1] * w_line;
      std::array<int, dim> begin, end;
      for (unsigned int d = 0; d < dim; ++d)
        {
          begin[d] = std::max(first[d], I[d] - p);
          end[d]   = std::min(first[d] + count[d], I[d] + n);
        }
      if (begin[0] >= end[0])
        return;
      const int z = dim - 1;
      for (int Z = dim == 3 ? begin[z] : 0; Z < (dim == 3 ? end[z] : 1); ++Z)
        for (int Y = begin[1]; Y < end[1]; ++Y)
          {
            const int line =
              (dim == 3 ? (Z - I[z] + p) * length : 0) + Y - I[1] + p - middle;
            const double *from = sum +
                                 (dim == 3 ? (Z - first[z]) * w_layer : 0) +
                                 (Y - first[1]) * w_line;
            const int direct = line > 0  ? begin[0] :
                               line == 0 ? std::max(begin[0], I[0]) :
                                           end[0];
            for (int X = begin[0]; X < std::min(direct, end[0]); ++X)
              add_to_half_row(
                u, line, X - I[0] + p, weight, from + (X - first[0]) * nc, w);
            if (direct < end[0])
              for (int c = 0; c < nc; ++c)
                add_multiple(half_row(u) + (line * nc + c) * line_size +
                               (direct - I[0] + p) * nc,
                             weight,
                             from + c * w + (direct - first[0]) * nc,
                             (end[0] - direct) * nc);
          }
    }

    LatticeMatrix     &coarse;
    const double        scale;

    // The extended functions of the finer level, and a box around them.
    static constexpr unsigned int none = static_cast<unsigned int>(-1);
    std::vector<Terms>            extended;
    std::array<int, dim>          low{}, size{};
    std::vector<unsigned int>     extended_at;
    std::vector<bool>             is_near;
    std::vector<Terms>            own_terms;
    std::vector<Column>           columns;
    std::vector<double>            sum_of_columns;

    double in_x[n_lines * nc * most * nc];
    double in_y[(dim == 3 ? n : 1) * most * nc * most * nc];
    double in_z[dim == 3 ? most * most * nc * most * nc : 1];
  };



  template <int dim>
  bool
  LatticeMatrix<dim>::can_coarsen(const LatticeLevel<dim> &fine)
  {
    for (const NestedKnots &direction : fine.lattice())
      if (direction.coarser().n_cells() < direction.n_cells())
        return true;
    return false;
  }



  template <int dim>
  LatticeMatrix<dim>::LatticeMatrix(const LatticeLevel<dim> &fine)
    : components(fine.n_components())
  {
    const Lattice fine_knots = fine.lattice();
    for (unsigned int d = 0; d < dim; ++d)
      {
        knots[d]    = fine_knots[d].coarser();
        const int n = fine_knots[d].n_functions();
        for (int i = -margin(); i < n + margin(); ++i)
          insertions[d].push_back(fine_knots[d].is_periodic() ||
                                      (i >= 0 && i < n)
                                    ? fine_knots[d].insertion(i, knots[d])
                                    : NestedKnots::Row{0, {}});
      }
    number_unknowns(fine);
    make_places();
    make_transfer(fine);
    with_sizes([&](const auto nc, const auto n) {
      const auto product =
        std::make_unique<Product<decltype(nc)::value, decltype(n)::value>>(
          *this, fine);
      fine.for_each_row(
        [&](const Position &i, const double *row) { product->add(i, row); });
      fine.for_each_far_block([&](const auto &block) { product->add(block); });
      product->finish();

      // The diagonal.
      using Half =
        HalfStencil<dim, decltype(nc)::value, decltype(n)::value, double>;
      const auto entry = [&](const unsigned int u, const unsigned int c) {
        return rows.data() + u * row_size + c * Half::line_size + (n - 1) * nc +
               c;
      };
      for (unsigned int u = 0; u < unknowns->n_owned(); ++u)
        for (unsigned int c = 0; c < components; ++c)
          if (!((constrained[u] >> c) & 1))
            *entry(u, c) *= 1. + relative_regularization;
    });
  }



  template <int dim>
  template <typename Visit>
  void
  LatticeMatrix<dim>::for_each_coarse(const Position &fine,
                                      const Visit    &visit) const
  {
    const NestedKnots::Row &x = insertion(0, fine[0]),
                           &y = insertion(1, fine[1]);
    const NestedKnots::Row *z =
      dim == 3 ? &insertion(dim - 1, fine[dim - 1]) : nullptr;
    Position i{};
    for (unsigned int kz = 0; kz < (z ? z->weights.size() : 1); ++kz)
      for (unsigned int ky = 0; ky < y.weights.size(); ++ky)
        for (unsigned int kx = 0; kx < x.weights.size(); ++kx)
          {
            if (z)
              i[dim - 1] = wrap(dim - 1, z->first + kz);
            i[1] = wrap(1, y.first + ky);
            i[0] = wrap(0, x.first + kx);
            visit(i,
                  x.weights[kx] * y.weights[ky] * (z ? z->weights[kz] : 1.f));
          }
  }



  template <int dim>
  void
  LatticeMatrix<dim>::number_unknowns(const LatticeLevel<dim> &fine)
  {
    using List                     = LinearAlgebra::distributed::Vector<double>;
    const MPI_Comm     comm        = fine.layout().communicator();
    const unsigned int me          = Utilities::MPI::this_mpi_process(comm);
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    std::uint64_t      n_keys      = 1;
    for (const NestedKnots &direction : knots)
      n_keys *= direction.n_functions();
    checked_index<types::global_dof_index>(n_keys, "functions of a level");

    // The keys that owned unknowns need, with components, and the keys that
    // rows of this process need.
    const unsigned int                     all = (1u << components) - 1;
    std::map<std::uint64_t, unsigned char> needed;
    std::map<std::uint64_t, Position>      position_of;
    const auto fine_positions = fine.unknown_positions();
    const auto fine_bits      = fine.constrained_unknowns();
    for (unsigned int u = 0; u < fine_positions.size(); ++u)
      if ((fine_bits[u] & all) != all)
        for_each_coarse(fine_positions[u], [&](const Position &i, const float) {
          needed[key(i)] |= all & ~fine_bits[u];
          position_of.emplace(key(i), i);
        });
    if (n_processes > 1)
      {
        const auto add = [&](const Position &f) {
          for_each_coarse(f, [&](const Position &i, const float) {
            position_of.emplace(key(i), i);
          });
        };
        fine.for_each_row([&](const Position &f, const double *) { add(f); });
        fine.for_each_extended([&](const Position &, const auto &terms) {
          for (const auto &term : terms)
            add(term.first);
        });
      }
    IndexSet mine(n_keys), others(n_keys);
    mine.add_range(n_keys * me / n_processes, n_keys * (me + 1) / n_processes);
    for (const auto &entry : position_of)
      others.add_index(entry.first);
    List list(mine, others, comm);

    // The first process that needs a key owns it.
    const auto set_all = [&](const double value) {
      for (unsigned int k = 0; k < list.locally_owned_size() +
                                     list.get_partitioner()->n_ghost_indices();
           ++k)
        list.local_element(k) = value;
    };
    set_all(n_processes);
    for (const auto &entry : needed)
      list(entry.first) = me;
    list.compress(VectorOperation::min);
    list.update_ghost_values();
    std::vector<std::uint64_t> owned;
    for (const auto &entry : needed)
      if (list(entry.first) == me)
        owned.push_back(entry.first);

    // The numbers of the keys, from 1 on.
    const std::uint64_t first = sum_before(owned.size(), comm);
    list.zero_out_ghost_values();
    set_all(0.);
    for (std::uint64_t k = 0; k < owned.size(); ++k)
      list(owned[k]) = first + k + 1;
    list.compress(VectorOperation::add);
    list.update_ghost_values();
    std::vector<std::pair<types::global_dof_index, std::uint64_t>> ghosts;
    for (const auto &entry : position_of)
      {
        const auto number = types::global_dof_index(list(entry.first));
        if (number > 0 && (number <= first || number > first + owned.size()))
          ghosts.emplace_back(number - 1, entry.first);
      }
    std::sort(ghosts.begin(), ghosts.end());
    std::vector<types::global_dof_index> ghost_numbers;
    positions.clear();
    for (const std::uint64_t k : owned)
      positions.push_back(position_of.at(k));
    for (const auto &ghost : ghosts)
      {
        ghost_numbers.push_back(ghost.first);
        positions.push_back(position_of.at(ghost.second));
      }
    unknowns = std::make_shared<const InterleavedLayout>(first,
                                                         owned.size(),
                                                         ghost_numbers,
                                                         comm);

    // The components that a process needs and none constrains, as sums.
    constrained.assign(positions.size(), 0);
    const auto constrained_of_finer = fine.constrained_functions();
    for (unsigned int c = 0; c < components; ++c)
      {
        constexpr double much = 1e9;
        list.zero_out_ghost_values();
        set_all(0.);
        for (const auto &entry : needed)
          list(entry.first) = (entry.second >> c) & 1;
        for (const auto &[f, bits] : constrained_of_finer)
          if ((bits >> c) & 1)
            for_each_coarse(f, [&](const Position &i, const float) {
              if (position_of.count(key(i)) > 0)
                list(key(i)) = much;
            });
        list.compress(VectorOperation::max);
        list.update_ghost_values();
        for (unsigned int u = 0; u < positions.size(); ++u)
          {
            const double value = list(key(positions[u]));
            if (value == 0. || value == much)
              constrained[u] |= 1u << c;
          }
      }
  }



  template <int dim>
  void
  LatticeMatrix<dim>::make_places()
  {
    const int            p = knots[0].degree();
    std::array<int, dim> highest;
    lowest.fill(std::numeric_limits<int>::max());
    highest.fill(-std::numeric_limits<int>::max());
    for (const Position &i : positions)
      for (unsigned int d = 0; d < dim; ++d)
        {
          lowest[d]  = std::min(lowest[d], i[d]);
          highest[d] = std::max(highest[d], i[d]);
        }
    std::size_t n_places = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        if (positions.empty())
          lowest[d] = highest[d] = 0;
        if (knots[d].is_periodic())
          {
            lowest[d]  = 0;
            highest[d] = knots[d].n_functions() - 1;
          }
        lowest[d] -= p;
        extents[d] = highest[d] + p + 1 - lowest[d];
        n_places *= extents[d];
      }
    checked_index<unsigned int>(n_places, "places of a level");
    unknown_at.assign(n_places, -1);
    places.clear();
    images.clear();
    std::vector<std::pair<Position, unsigned int>> all;
    for (unsigned int u = 0; u < positions.size(); ++u)
      all.emplace_back(positions[u], u);
    for (unsigned int d = 0; d < dim; ++d)
      if (knots[d].is_periodic())
        for (std::size_t k = 0, n_before = all.size(); k < n_before; ++k)
          for (const int shift : {-1, 1})
            {
              auto image = all[k];
              image.first[d] += shift * knots[d].n_functions();
              if (image.first[d] >= lowest[d] &&
                  image.first[d] < lowest[d] + extents[d])
                all.push_back(image);
            }
    for (unsigned int k = 0; k < all.size(); ++k)
      {
        const unsigned int at = place(all[k].first);
        unknown_at[at]        = all[k].second;
        if (k < positions.size())
          places.push_back(at);
        else
          images.emplace_back(at, all[k].second);
      }
    distances.clear();
    for (int dz = 0; dz <= (dim == 3 ? p : 0); ++dz)
      for (int dy = dz == 0 ? 0 : -p; dy <= p; ++dy)
        distances.push_back((std::ptrdiff_t(dz) * extents[1] + dy) *
                            extents[0]);
    // Stencils read some numbers behind their last place.
    constexpr unsigned int margin = 16;
    place_x.assign((n_places + margin) * components, 0.f);
    place_y.assign((n_places + margin) * components, 0.f);
  }



  template <int dim>
  int
  LatticeMatrix<dim>::find(const Position &position) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (position[d] < lowest[d] || position[d] >= lowest[d] + extents[d])
        return -1;
    return unknown_at[place(position)];
  }



  template <int dim>
  void
  LatticeMatrix<dim>::make_transfer(const LatticeLevel<dim> &fine)
  {
    for (const Position &f : fine.unknown_positions())
      {
        for_each_coarse(f, [&](const Position &i, const float weight) {
          const int u = find(i);
          if (u >= 0)
            transfer.push_back({unsigned(u), weight});
        });
        transfer_begin.push_back(transfer.size());
      }
  }



  template <int dim>
  void
  LatticeMatrix<dim>::prolongate_and_add(SingleVector &fine,
                                         SingleVector &coarse) const
  {
    coarse.update_ghost_values();
    with_one_of<1, dim>(components, [&](const auto width) {
      constexpr int nc   = decltype(width)::value;
      const float  *from = coarse.begin();
      float        *to   = fine.begin();
      for (std::size_t f = 0; f + 1 < transfer_begin.size(); ++f, to += nc)
        for (std::size_t e = transfer_begin[f]; e < transfer_begin[f + 1]; ++e)
          for (int c = 0; c < nc; ++c)
            to[c] += transfer[e].weight * from[transfer[e].unknown * nc + c];
    });
    coarse.zero_out_ghost_values();
  }



  template <int dim>
  void LatticeMatrix<dim>::restrict(SingleVector       &coarse,
                                    const SingleVector &fine) const
  {
    coarse = 0.f;
    with_one_of<1, dim>(components, [&](const auto width) {
      constexpr int nc   = decltype(width)::value;
      const float  *from = fine.begin();
      float        *to   = coarse.begin();
      for (std::size_t f = 0; f + 1 < transfer_begin.size(); ++f, from += nc)
        for (std::size_t e = transfer_begin[f]; e < transfer_begin[f + 1]; ++e)
          for (int c = 0; c < nc; ++c)
            to[transfer[e].unknown * nc + c] += transfer[e].weight * from[c];
    });
    coarse.compress(VectorOperation::add);
    for (unsigned int u = 0; u < unknowns->n_owned(); ++u)
      if (constrained[u] != 0)
        for (unsigned int c = 0; c < components; ++c)
          if ((constrained[u] >> c) & 1)
            coarse.local_element(u * components + c) = 0.f;
  }



  template <int dim>
  std::vector<std::pair<typename LatticeMatrix<dim>::Position, unsigned char>>
  LatticeMatrix<dim>::constrained_functions() const
  {
    std::vector<std::pair<Position, unsigned char>> result;
    for (unsigned int u = 0; u < positions.size(); ++u)
      if (constrained[u] != 0)
        result.emplace_back(positions[u], constrained[u]);
    return result;
  }



  template <int dim>
  void
  LatticeMatrix<dim>::for_each_row(
    const std::function<void(const Position &, const double *)> &visit) const
  {
    for (unsigned int u = 0; u < positions.size(); ++u)
      visit(positions[u], rows.data() + u * row_size);
  }



  template <int dim>
  void
  LatticeMatrix<dim>::finish()
  {
    single_rows.assign(rows.begin(), rows.end());
  }



  template <int dim>
  void
  LatticeMatrix<dim>::multiply(SingleVector &y, SingleVector &x) const
  {
    x.update_ghost_values();
    with_sizes([&](const auto width, const auto n) {
      constexpr int nc    = decltype(width)::value;
      using Half          = HalfStencil<dim, nc, decltype(n)::value, float>;
      const float   *from = x.begin();
      std::ptrdiff_t of_lines[Half::n_lines];
      for (int k = 0; k < Half::n_lines; ++k)
        of_lines[k] = (distances[k] - (Half::length / 2)) * nc;
      for (std::size_t u = 0; u < places.size(); ++u)
        for (int c = 0; c < nc; ++c)
          place_x[std::size_t(places[u]) * nc + c] = from[u * nc + c];
      for (const auto &image : images)
        for (int c = 0; c < nc; ++c)
          place_x[std::size_t(image.first) * nc + c] =
            from[image.second * nc + c];
      std::fill(place_y.begin(), place_y.end(), 0.f);
      for (std::size_t u = 0; u < places.size(); ++u)
        Half::multiply(single_rows.data() + u * row_size,
                       place_x.data() + std::size_t(places[u]) * nc,
                       place_y.data() + std::size_t(places[u]) * nc,
                       of_lines);
      float *to = y.begin();
      for (std::size_t u = 0; u < places.size(); ++u)
        for (int c = 0; c < nc; ++c)
          to[u * nc + c] = place_y[std::size_t(places[u]) * nc + c];
      for (const auto &image : images)
        for (int c = 0; c < nc; ++c)
          to[image.second * nc + c] +=
            place_y[std::size_t(image.first) * nc + c];
      for (const Beyond &entry : beyond)
        for (int c = 0; c < nc; ++c)
          for (int d = 0; d < nc; ++d)
            {
              const float value = entry.block[c * nc + d];
              to[entry.u * nc + c] += value * from[entry.v * nc + d];
              to[entry.v * nc + d] += value * from[entry.u * nc + c];
            }
    });
    y.compress(VectorOperation::add);
    x.zero_out_ghost_values();
  }



  template <int dim>
  template <typename Visit>
  void
  LatticeMatrix<dim>::for_each_block(const Visit &visit) const
  {
    with_sizes([&](const auto width, const auto n) {
      constexpr int nc = decltype(width)::value;
      using Half       = HalfStencil<dim, nc, decltype(n)::value, double>;
      constexpr int p  = decltype(n)::value - 1;
      for (unsigned int u = 0; u < positions.size(); ++u)
        for (int k = 0; k < Half::n_lines; ++k)
          for (int x = k == 0 ? p : 0; x < Half::length; ++x)
            {
              const int v = unknown_at[places[u] + distances[k] + x - p];
              if (v >= 0)
                visit(u,
                      unsigned(v),
                      k == 0 && x == p,
                      rows.data() + u * row_size + k * nc * Half::line_size +
                        x * nc,
                      Half::line_size);
            }
      for (const Beyond &entry : beyond)
        visit(entry.u, entry.v, false, entry.block, nc);
    });
  }



  template <int dim>
  UpperTriangle
  LatticeMatrix<dim>::diagonal_block(const int component) const
  {
    // The mean leaves out constrained components.
    const unsigned int n = positions.size();
    std::vector<float> scale(n, 1.f);
    for (unsigned int u = 0; component < 0 && u < n; ++u)
      {
        unsigned int n_free = 0;
        for (unsigned int c = 0; c < components; ++c)
          n_free += !((constrained[u] >> c) & 1);
        scale[u] = 1.f / std::sqrt(float(std::max(n_free, 1u)));
      }
    using Entry = std::pair<unsigned int, double>;
    std::vector<std::size_t> begin(n + 1, 0);
    for_each_block([&](const unsigned int u,
                       const unsigned int v,
                       const auto...) { ++begin[std::min(u, v) + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<Entry>       entries(begin[n]);
    std::vector<std::size_t> next(begin);
    for_each_block([&](const unsigned int u,
                       const unsigned int v,
                       const bool         is_diagonal,
                       const double      *block,
                       const int          stride) {
      double sum = 0.;
      for (unsigned int c = 0; c < components; ++c)
        if (component < 0 || int(c) == component)
          sum += block[c * stride + c];
      sum *= (u == v ? 2. : 1.) * scale[u] * scale[v];
      const unsigned int of_block =
        component < 0 ? (1u << components) - 1 : 1u << component;
      if (is_diagonal && (constrained[u] & of_block) == of_block)
        sum = 1.;
      entries[next[std::min(u, v)]++] = {std::max(u, v), sum};
    });
    UpperTriangle result;
    result.row_begin.reserve(n + 1);
    result.columns.reserve(entries.size());
    result.values.reserve(entries.size());
    for (unsigned int u = 0; u < n; ++u)
      {
        Entry *const row       = entries.data() + begin[u];
        Entry *const end       = entries.data() + begin[u + 1];
        const auto   is_before = [](const Entry &a, const Entry &b) {
          return a.first < b.first;
        };
        if (!std::is_sorted(row, end, is_before))
          std::sort(row, end, is_before);
        for (const Entry *entry = row; entry != end; ++entry)
          if (entry != row && entry[-1].first == entry->first)
            result.values.back() += entry->second;
          else
            {
              result.columns.push_back(entry->first);
              result.values.push_back(entry->second);
            }
        result.row_begin.push_back(result.columns.size());
      }
    return result;
  }



  template <int dim>
  std::vector<OverlappingCholesky>
  LatticeMatrix<dim>::factorize(const CholeskyParameters &parameters,
                                const bool                by_components) const
  {
    std::vector<OverlappingCholesky> result(by_components ? components : 1);
    std::vector<std::array<int, 3>>  of_unknowns(unknowns->n_owned());
    for (unsigned int u = 0; u < of_unknowns.size(); ++u)
      std::copy(positions[u].begin(),
                positions[u].end(),
                of_unknowns[u].begin());
    for (unsigned int c = 0; c < result.size(); ++c)
      result[c].factorize(diagonal_block(by_components ? int(c) : -1),
                          unknowns,
                          of_unknowns,
                          knots[0].degree(),
                          1,
                          parameters);
    return result;
  }



  template <int dim>
  std::vector<double>
  LatticeMatrix<dim>::all_entries() const
  {
    const std::size_t n =
      Utilities::MPI::sum(unknowns->n_owned(), unknowns->communicator()) *
      components;
    std::vector<double> result(n * n, 0.);
    for_each_block([&](const unsigned int u,
                       const unsigned int v,
                       const bool,
                       const double *block,
                       const int    stride) {
      const std::size_t i = unknowns->global_number(u) * components,
                        j = unknowns->global_number(v) * components;
      for (unsigned int c = 0; c < components; ++c)
        for (unsigned int d = 0; d < components; ++d)
          {
            result[(i + c) * n + j + d] += block[c * stride + d];
            result[(j + d) * n + i + c] += block[c * stride + d];
          }
    });
    for (unsigned int u = 0; u < unknowns->n_owned(); ++u)
      for (unsigned int c = 0; c < components; ++c)
        if ((constrained[u] >> c) & 1)
          result[(unknowns->global_number(u) * components + c) * (n + 1)] = 1.;
    Utilities::MPI::sum(result, unknowns->communicator(), result);
    return result;
  }



  template class LatticeMatrix<2>;
  template class LatticeMatrix<3>;
} // namespace greville
