// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/base/with_width.h>
#include <greville/multigrid/lattice_matrix.h>

#include "galerkin_product.h"
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  template <typename Action>
  void
  LatticeMatrix<dim>::with_sizes(const Action &action) const
  {
    with_order(places.lattice()[0].degree(), [&](const auto n) {
      with_one_of<1, dim>(n_components(),
                          [&](const auto nc) { action(nc, n); });
    });
  }



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
  LatticeMatrix<dim>::LatticeMatrix(const LatticeLevel<dim> &fine,
                                    const bool               coarsen)
    : places(fine, coarsen)
  {
    // Coarse functions at the edge of a body can be linearly dependent. Adding
    // this part of the diagonal keeps matrices in single precision positive
    // definite.
    const double regularization = coarsen ? 1e-6 : 0.;
    with_sizes([&](const auto nc, const auto n) {
      using Product =
        GalerkinProduct<dim, decltype(nc)::value, decltype(n)::value>;
      using Half = typename Product::Half;
      row_size   = Half::row_size;
      std::make_unique<Product>(places, fine, rows, far_blocks);
      for (unsigned int u = 0; u < layout().n_owned(); ++u)
        for (unsigned int c = 0; c < n_components(); ++c)
          rows[u * row_size + c * Half::line_size + (n - 1) * nc + c] *=
            1. + regularization;
      for (unsigned int l = 0; l < places.lattice()[0].n_levels(); ++l)
        for (int k = 0; k < Half::n_lines; ++k)
          line_begins.push_back((places.distance(l, k) - Half::length / 2) *
                                nc);
      // Stencils read some numbers after the last place.
      for (auto *values : {&place_x, &place_y})
        values->assign(places.n_places() * nc + Half::line_size, 0.f);
    });
    for (const FarBlock &block : far_blocks)
      far_unknowns.emplace_back(places.find(places.wrapped(block.i)),
                                places.find(places.wrapped(block.j)));
  }



  template <int dim>
  std::vector<std::pair<typename LatticeMatrix<dim>::Position, unsigned char>>
  LatticeMatrix<dim>::constrained_functions() const
  {
    std::vector<std::pair<Position, unsigned char>> result;
    for (unsigned int u = 0; u < places.positions().size(); ++u)
      if (places.constrained()[u] != 0)
        result.emplace_back(places.positions()[u], places.constrained()[u]);
    return result;
  }



  template <int dim>
  void
  LatticeMatrix<dim>::for_each_row(
    const std::function<void(const Position &, const float *)> &visit) const
  {
    for (unsigned int u = 0; u < places.positions().size(); ++u)
      visit(places.positions()[u], rows.data() + u * row_size);
  }



  template <int dim>
  void
  LatticeMatrix<dim>::multiply(SingleVector &y, SingleVector &x) const
  {
    x.update_ghost_values();
    with_sizes([&](const auto width, const auto n) {
      constexpr int nc = decltype(width)::value;
      using Half       = HalfStencil<dim, nc, decltype(n)::value, float>;
      const float                     *from = x.begin();
      const std::vector<unsigned int> &at   = places.places();
      for (std::size_t u = 0; u < at.size(); ++u)
        for (int c = 0; c < nc; ++c)
          place_x[std::size_t(at[u]) * nc + c] = from[u * nc + c];
      for (const auto &[place, u] : places.images())
        for (int c = 0; c < nc; ++c)
          place_x[std::size_t(place) * nc + c] = from[u * nc + c];
      std::fill(place_y.begin(), place_y.end(), 0.f);
      for (std::size_t u = 0; u < at.size(); ++u)
        Half::multiply(rows.data() + u * row_size,
                       place_x.data() + std::size_t(at[u]) * nc,
                       place_y.data() + std::size_t(at[u]) * nc,
                       line_begins.data() + places.levels()[u] * Half::n_lines);
      float *to = y.begin();
      for (std::size_t u = 0; u < at.size(); ++u)
        for (int c = 0; c < nc; ++c)
          to[u * nc + c] = place_y[std::size_t(at[u]) * nc + c];
      for (const auto &[place, u] : places.images())
        for (int c = 0; c < nc; ++c)
          to[u * nc + c] += place_y[std::size_t(place) * nc + c];
      for (std::size_t k = 0; k < far_blocks.size(); ++k)
        {
          const auto [u, v] = far_unknowns[k];
          for (int c = 0; c < nc; ++c)
            for (int d = 0; d < nc; ++d)
              {
                const float value = far_blocks[k].block[c * nc + d];
                to[u * nc + c] += value * from[v * nc + d];
                to[v * nc + d] += value * from[u * nc + c];
              }
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
    int p = 0, n_lines = 0, line_size = 0;
    with_sizes([&](const auto width, const auto n) {
      using Half =
        HalfStencil<dim, decltype(width)::value, decltype(n)::value, float>;
      p         = n - 1;
      n_lines   = Half::n_lines;
      line_size = Half::line_size;
    });
    const int nc = n_components();
    for (unsigned int u = 0; u < places.positions().size(); ++u)
      for (int line = 0; line < n_lines; ++line)
        for (int x = line == 0 ? p : 0; x <= 2 * p; ++x)
          {
            const int v = places.unknown_in_line(u, line, x - p);
            if (v >= 0)
              visit(u,
                    unsigned(v),
                    rows.data() + u * row_size + line * nc * line_size + x * nc,
                    line_size);
          }
    for (std::size_t k = 0; k < far_blocks.size(); ++k)
      visit(far_unknowns[k].first,
            far_unknowns[k].second,
            far_blocks[k].block,
            nc);
  }



  template <int dim>
  UpperTriangle
  LatticeMatrix<dim>::diagonal_block(const int component) const
  {
    // Constrained components do not enter the mean.
    const unsigned int n          = places.positions().size();
    const unsigned int components = n_components();
    std::vector<float> scale(n, 1.f);
    for (unsigned int u = 0; component < 0 && u < n; ++u)
      {
        unsigned int n_free = 0;
        for (unsigned int c = 0; c < components; ++c)
          n_free += !places.is_constrained(u, c);
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
                       const float       *block,
                       const int          stride) {
      double sum = 0.;
      for (unsigned int c = 0; c < components; ++c)
        if (component < 0 || int(c) == component)
          sum += block[c * stride + c];
      sum *= (u == v ? 2. : 1.) * scale[u] * scale[v];
      const unsigned int of_block =
        component < 0 ? (1u << components) - 1 : 1u << component;
      if (u == v && sum == 0. &&
          (places.constrained()[u] & of_block) == of_block)
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
  std::vector<UpperTriangle>
  LatticeMatrix<dim>::diagonal_blocks(const bool by_components) const
  {
    std::vector<UpperTriangle> result;
    for (unsigned int c = 0; c < (by_components ? n_components() : 1); ++c)
      result.push_back(diagonal_block(by_components ? int(c) : -1));
    return result;
  }



  template <int dim>
  std::vector<double>
  LatticeMatrix<dim>::reduced_entries(const unsigned int n,
                                      const Rows        &rows_of_Q) const
  {
    const unsigned int nc = n_components();
    // The rows of Q for the local unknowns.
    std::vector<std::size_t>                     begin{0};
    std::vector<std::pair<unsigned int, double>> Q;
    for (unsigned int u = 0; u < places.positions().size(); ++u)
      for (unsigned int c = 0; c < nc; ++c)
        {
          if (!places.is_constrained(u, c))
            rows_of_Q(u, c, [&](const unsigned int j, const double weight) {
              Q.emplace_back(j, weight);
            });
          begin.push_back(Q.size());
        }
    std::vector<double> result(std::size_t(n) * n, 0.);
    for_each_block([&](const unsigned int u,
                       const unsigned int v,
                       const float       *block,
                       const int          stride) {
      for (unsigned int c = 0; c < nc; ++c)
        for (unsigned int d = 0; d < nc; ++d)
          for (std::size_t k = begin[u * nc + c]; k < begin[u * nc + c + 1];
               ++k)
            for (std::size_t l = begin[v * nc + d]; l < begin[v * nc + d + 1];
                 ++l)
              {
                const double value =
                  Q[k].second * Q[l].second * block[c * stride + d];
                result[std::size_t(Q[k].first) * n + Q[l].first] += value;
                result[std::size_t(Q[l].first) * n + Q[k].first] += value;
              }
    });
    Utilities::MPI::sum(result, layout().communicator(), result);
    return result;
  }



  template <int dim>
  PetscMatrix
  LatticeMatrix<dim>::petsc_matrix(const double unit) const
  {
    const unsigned int       nc = n_components();
    std::vector<PetscInt>    rows, columns;
    std::vector<PetscScalar> values;
    const auto               add = [&](const unsigned int u,
                         const unsigned int c,
                         const unsigned int v,
                         const unsigned int d,
                         const double       value) {
      rows.push_back(layout().global_number(u) * nc + c);
      columns.push_back(layout().global_number(v) * nc + d);
      values.push_back(unit * value);
    };
    for_each_block([&](const unsigned int u,
                       const unsigned int v,
                       const float       *block,
                       const int          stride) {
      for (unsigned int c = 0; c < nc; ++c)
        for (unsigned int d = 0; d < nc; ++d)
          {
            add(u, c, v, d, block[c * stride + d]);
            add(v, d, u, c, block[c * stride + d]);
          }
    });
    for (unsigned int u = 0; u < layout().n_owned(); ++u)
      for (unsigned int c = 0; c < nc; ++c)
        if (places.is_constrained(u, c))
          add(u, c, u, c, 1.);
    const PetscInt n =
      checked_index<PetscInt>(layout().n_owned() * nc, "rows of a matrix");
    Mat mat;
    check_petsc(MatCreate(layout().communicator(), &mat));
    PetscMatrix result(mat);
    check_petsc(MatSetSizes(mat, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
    check_petsc(MatSetBlockSize(mat, nc));
    check_petsc(MatSetType(mat, MATAIJ));
    check_petsc(
      MatSetPreallocationCOO(mat, rows.size(), rows.data(), columns.data()));
    check_petsc(MatSetValuesCOO(mat, values.data(), INSERT_VALUES));
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(LatticeMatrix);
} // namespace greville
