// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/benchmark/laplace_level.h>
#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/multigrid/lattice_cycle.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// The integrals int N_a N_b and int N_a' N_b' over an element for all
    /// pairs a <= b of its @p n functions.
    struct PairIntegrals
    {
      PairIntegrals(const KnotVector  &knots,
                    const unsigned int element,
                    const unsigned int n)
      {
        const QGauss<1> gauss(n);
        const double    lower = knots.element_lower(element);
        const double    h     = knots.element_upper(element) - lower;
        std::array<std::vector<double>, 2> f{
          {std::vector<double>(n), std::vector<double>(n)}};
        std::array<std::vector<double> *, 2> sums{{&values, &slopes}};
        for (auto *sum : sums)
          sum->assign(n * (n + 1) / 2, 0.);
        for (unsigned int q = 0; q < n; ++q)
          for (unsigned int derivative = 0; derivative < 2; ++derivative)
            {
              const std::vector<double> &at = f[derivative];
              knots.evaluate(element,
                             lower + h * gauss.point(q)(0),
                             derivative,
                             ArrayView<double>(f[derivative].data(), n));
              unsigned int pair = 0;
              for (unsigned int a = 0; a < n; ++a)
                for (unsigned int b = a; b < n; ++b, ++pair)
                  (*sums[derivative])[pair] +=
                    h * gauss.weight(q) * at[a] * at[b];
            }
      }

      std::vector<double> values, slopes;
    };
  } // namespace



  template <int dim>
  void
  add_laplace_matrix(StencilMatrix<dim> &matrix)
  {
    const SplineSpace<dim> &space   = matrix.space();
    const unsigned int      n       = space.degree() + 1;
    const unsigned int      n_pairs = n * (n + 1) / 2;

    std::array<std::vector<PairIntegrals>, dim> tables;
    MultiIndex<dim>                             extents;
    for (unsigned int d = 0; d < dim; ++d)
      {
        extents[d] = n_pairs;
        for (unsigned int i = 0; i < space.cells_per_direction()[d]; ++i)
          tables[d].emplace_back(space.knots(d), i, n);
      }
    std::vector<double> sums(Utilities::fixed_power<dim>(n_pairs));
    for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
      {
        const MultiIndex<dim> index = space.box(c).index;
        for (unsigned int k = 0; k < sums.size(); ++k)
          {
            const auto pair = multi_index<dim>(k, extents);
            sums[k]         = 0.;
            for (unsigned int derivative = 0; derivative < dim; ++derivative)
              {
                double product = 1.;
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    const PairIntegrals &table = tables[d][index[d]];
                    product *= d == derivative ? table.slopes[pair[d]]
                                               : table.values[pair[d]];
                  }
                sums[k] += product;
              }
          }
        matrix.add_cell(c, sums.data());
      }
  }



  template <int dim>
  LaplaceLevel<dim>::LaplaceLevel(const SplineSpace<dim>           &space,
                                  const std::vector<unsigned char> &constrained)
    : spline_space(space)
    , constrained(constrained)
  {
    AssertThrow(constrained.size() == space.owned_functions().size() +
                                        space.ghost_functions().size(),
                ExcDimensionMismatch(constrained.size(),
                                     space.owned_functions().size() +
                                       space.ghost_functions().size()));
    // All functions are unknowns.
    CellFilling<dim> filling(space);
    filling.update(std::vector<double>(space.owned_cells().size(), 1.), 0.);
    extension.reinit(space, filling);
    stencil.reinit(space);
    stencil.begin(extension, true);
    stencil.unknowns().constrain(constrained);
    add_laplace_matrix(stencil.matrix());
    stencil.finish();
    for (unsigned int f = 0; f < space.owned_functions().size(); ++f)
      if (constrained[f] != 0)
        constrained_functions.push_back(f);

    const UpperTriangle local   = stencil.local_entries(1);
    double              largest = 0.;
    for (unsigned int u = 0; u < local.size(); ++u)
      largest = std::max(largest, local.diagonal(u));
    largest = Utilities::MPI::max(largest, space.communicator());
    entries = std::make_unique<MassMatrix<dim>>(stencil,
                                                local,
                                                constrained_functions,
                                                largest);
    space.initialize_vector(matrix_diagonal);
    PetscVectorView view(space.communicator(), space.n_locally_owned_dofs());
    view.with(matrix_diagonal.begin(), [&](Vec diagonal) {
      check_petsc(MatGetDiagonal(matrix(), diagonal));
    });
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  LaplaceLevel<dim>::petsc_preconditioner(const std::string &options) const
  {
    return std::make_unique<PetscPreconditioner>(matrix(), options);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  LaplaceLevel<dim>::lattice_preconditioner(
    const LatticeCycleParameters &parameters) const
  {
    return std::make_unique<LatticeCycle<dim>>(
      std::make_unique<ExtendedLattice<dim>>(
        stencil, extension, constrained, matrix_diagonal.linfty_norm()),
      parameters);
  }



  GREVILLE_INSTANTIATE(add_laplace_matrix);
  GREVILLE_INSTANTIATE_CLASS(LaplaceLevel);
} // namespace greville
