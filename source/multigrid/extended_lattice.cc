// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/with_width.h>
#include <greville/multigrid/extended_lattice.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ExtendedLattice<dim>::ExtendedLattice(
    const ExtendedMass<dim>          &matrix,
    const Extension<dim>             &extension,
    const std::vector<unsigned char> &constrained,
    const double                      unit)
    : matrix(matrix)
    , extension(extension)
    , constrained(constrained)
    , matrix_unit(unit > 0. ? unit : 1.)
  {}



  template <int dim>
  typename ExtendedLattice<dim>::Lattice
  ExtendedLattice<dim>::lattice() const
  {
    const SplineSpace<dim> &space = matrix.matrix().space();
    Lattice                 result;
    result.fill(NestedKnots(0, 1, false));
    // Levels without cells have no functions.
    const unsigned int n_levels = space.n_used_levels();
    for (unsigned int d = 0; d < dim; ++d)
      {
        std::vector<NestedKnots>  knots;
        std::vector<unsigned int> begin;
        for (unsigned int l = 0; l < n_levels; ++l)
          {
            const CellHierarchy<dim> *levels = space.hierarchy();
            const unsigned int        n =
              levels ? levels->n_cells(l)[d] : space.cells_per_direction()[d];
            begin.push_back(levels ? levels->offset(l)[d] : 0);
            std::vector<double> edges = space.lattice().edges(d);
            if (levels)
              edges = std::vector<double>(edges.begin() + begin[l],
                                          edges.begin() + begin[l] + n + 1);
            knots.emplace_back(space.degree(), n, space.is_periodic(d), edges);
          }
        result[d] = n_levels > 1 ? NestedKnots(knots, begin) : knots[0];
      }
    return result;
  }



  template <int dim>
  typename ExtendedLattice<dim>::Position
  ExtendedLattice<dim>::position(const std::uint64_t number) const
  {
    const auto index =
      multi_index<dim>(number, matrix.matrix().space().n_functions());
    Position result{};
    std::copy_n(index.begin(), dim, result.begin());
    return result;
  }



  template <int dim>
  std::vector<std::pair<typename ExtendedLattice<dim>::Position, unsigned char>>
  ExtendedLattice<dim>::constrained_functions() const
  {
    const SplineSpace<dim> &space = matrix.matrix().space();
    std::vector<std::pair<Position, unsigned char>> result;
    for (unsigned int f = 0; f < constrained.size(); ++f)
      if (constrained[f] != 0 && extension[f] != Extension<dim>::inactive)
        result.emplace_back(position(space.function_position(f)),
                            constrained[f]);
    return result;
  }



  template <int dim>
  void
  ExtendedLattice<dim>::for_each_extended(
    const std::function<void(const Position &, const Terms &)> &visit) const
  {
    const SplineSpace<dim> &space     = matrix.matrix().space();
    const auto             &rows      = extension.rows();
    const auto             &functions = extension.extended_functions();
    Terms                   terms;
    for (unsigned int k = 0; k < functions.size(); ++k)
      {
        terms.clear();
        for (std::size_t e = rows.begin[k]; e < rows.begin[k + 1]; ++e)
          terms.emplace_back(position(rows.positions[e]), rows.weights[e]);
        visit(position(space.function_position(functions[k])), terms);
      }
  }



  template <int dim>
  void
  ExtendedLattice<dim>::for_each_row(
    const std::function<void(const Position &, const float *)> &visit) const
  {
    const StencilMatrix<dim> &stencil = matrix.matrix();
    with_order(stencil.space().degree(), [&](const auto n) {
      using Half = HalfStencil<dim, 1, decltype(n)::value, float>;
      std::vector<double> full((2 * Half::n_lines - 1) * Half::length);
      float               row[Half::row_size] = {};
      for_each_place([&](const Position &i, const unsigned int place) {
        stencil.get_row(place, full.data());
        for (int k = 0; k < Half::n_lines; ++k)
          for (int x = k == 0 ? Half::length / 2 : 0; x < Half::length; ++x)
            row[k * Half::line_size + x] =
              (k == 0 && x == Half::length / 2 ? 0.5 : 1.) *
              full[(Half::n_lines - 1 + k) * Half::length + x];
        visit(i, row);
      });
    });
  }



  template <int dim>
  void
  ExtendedLattice<dim>::multiply(SingleVector &y, SingleVector &x) const
  {
    if (source.size() == 0)
      for (VectorType *vector : {&source, &result})
        matrix.unknowns().initialize_vector(*vector, 1);
    std::copy_n(x.begin(), x.locally_owned_size(), source.begin());
    matrix.vmult(result, source, 1);
    std::copy_n(result.begin(), y.locally_owned_size(), y.begin());
  }



  template <int dim>
  std::vector<UpperTriangle>
  ExtendedLattice<dim>::diagonal_blocks(const bool) const
  {
    return {matrix.local_entries(1)};
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedLattice);
} // namespace greville
