// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks an operator of this file as a level of PMultigrid: mass plus beta
// times the Laplacian, for one or two components. It needs few iterations on
// any mesh, and as many for all components.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/solver_cg.h>

#include <greville/multigrid/p_multigrid.h>
#include <greville/paper/paper_parts.h>
#include <greville/spline/order_hierarchy.h>

#include <tests.h>

namespace
{
  /// int phi_i phi_j + beta int grad phi_i grad phi_j for each component, with
  /// zero values at x = 0.
  class MassAndLaplacian : public LevelOperator<2>
  {
  public:
    MassAndLaplacian(const SplineSpace<2> &space,
                     const double          beta,
                     const unsigned int    n_components)
      : spline_space(space)
      , n_fields(n_components)
      , view_dst(space.communicator(), space.n_locally_owned_dofs())
      , view_src(space.communicator(), space.n_locally_owned_dofs())
    {
      const PetscInt n = space.n_locally_owned_dofs();
      const PetscInt m = std::pow(2 * space.degree() + 1, 2);
      Mat            mat;
      check_petsc(MatCreate(space.communicator(), &mat));
      check_petsc(MatSetSizes(mat, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
      check_petsc(MatSetType(mat, MATMPIAIJ));
      check_petsc(MatMPIAIJSetPreallocation(mat, m, nullptr, m, nullptr));
      entries.reset(mat);
      add_cells(beta);
      constrain();
      initialize_vector<2>(matrix_diagonal, *this);
      space.initialize_vector(to);
      space.initialize_vector(from);
      view_dst.with(to.begin(),
                    [&](Vec y) { check_petsc(MatGetDiagonal(mat, y)); });
      for (unsigned int i = 0; i < matrix_diagonal.locally_owned_size(); ++i)
        matrix_diagonal.local_element(i) = to.local_element(i / n_fields);
    }

    const SplineSpace<2> &
    space() const override
    {
      return spline_space;
    }

    unsigned int
    n_components() const override
    {
      return n_fields;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      apply_by_components(n_fields,
                          dst,
                          src,
                          to,
                          from,
                          [&](VectorType       &y,
                              const VectorType &x,
                              const unsigned int) {
                            view_src.with(x.begin(), [&](Vec in) {
                              view_dst.with(y.begin(), [&](Vec out) {
                                check_petsc(MatMult(entries.get(), in, out));
                              });
                            });
                          });
    }

    const VectorType &
    diagonal() const override
    {
      return matrix_diagonal;
    }

    const std::vector<unsigned int> &
    inactive() const override
    {
      return constrained;
    }

    Mat
    matrix() const override
    {
      return entries.get();
    }

  private:
    void
    add_cells(const double beta)
    {
      const unsigned int n = spline_space.degree() + 1;
      const QGauss<1>    gauss(n);
      for (unsigned int cell = 0; cell < spline_space.owned_cells().size();
           ++cell)
        {
          const MultiIndex<2> index = spline_space.box(cell).index;
          // 1D matrices of values and derivatives
          std::array<std::vector<double>, 2> M, K;
          for (unsigned int d = 0; d < 2; ++d)
            {
              M[d].assign(n * n, 0.);
              K[d].assign(n * n, 0.);
              const auto         &knots = spline_space.knots(d);
              const double        lower = knots.element_lower(index[d]);
              const double        h     = knots.element_upper(index[d]) - lower;
              std::vector<double> values(n), slopes(n);
              for (unsigned int q = 0; q < gauss.size(); ++q)
                {
                  const double x = lower + h * gauss.point(q)(0);
                  knots.evaluate(index[d],
                                 x,
                                 0,
                                 ArrayView<double>(values.data(), n));
                  knots.evaluate(index[d],
                                 x,
                                 1,
                                 ArrayView<double>(slopes.data(), n));
                  for (unsigned int a = 0; a < n; ++a)
                    for (unsigned int b = 0; b < n; ++b)
                      {
                        M[d][a * n + b] +=
                          h * gauss.weight(q) * values[a] * values[b];
                        K[d][a * n + b] +=
                          h * gauss.weight(q) * slopes[a] * slopes[b];
                      }
                }
            }
          std::vector<PetscInt> numbers;
          for (const unsigned int f : spline_space.cell_functions(cell))
            numbers.push_back(spline_space.partitioner()->local_to_global(f));
          std::vector<double> values;
          for (unsigned int i = 0; i < n * n; ++i)
            for (unsigned int j = 0; j < n * n; ++j)
              {
                const unsigned int x = (i % n) * n + j % n;
                const unsigned int y = (i / n) * n + j / n;
                values.push_back(M[0][x] * M[1][y] + beta * K[0][x] * M[1][y] +
                                 beta * M[0][x] * K[1][y]);
              }
          check_petsc(MatSetValues(entries.get(),
                                   n * n,
                                   numbers.data(),
                                   n * n,
                                   numbers.data(),
                                   values.data(),
                                   ADD_VALUES));
        }
      check_petsc(MatAssemblyBegin(entries.get(), MAT_FINAL_ASSEMBLY));
      check_petsc(MatAssemblyEnd(entries.get(), MAT_FINAL_ASSEMBLY));
    }

    void
    constrain()
    {
      const auto           &functions = spline_space.owned_functions();
      std::vector<PetscInt> numbers;
      for (unsigned int i = 0; i < functions.size(); ++i)
        if (functions[i] % spline_space.n_functions()[0] == 0)
          {
            constrained.push_back(i);
            numbers.push_back(spline_space.partitioner()->local_to_global(i));
          }
      check_petsc(MatZeroRowsColumns(
        entries.get(), numbers.size(), numbers.data(), 1., nullptr, nullptr));
    }

    const SplineSpace<2>     &spline_space;
    const unsigned int        n_fields;
    PetscMatrix               entries;
    PetscVectorView           view_dst, view_src;
    VectorType                matrix_diagonal;
    std::vector<unsigned int> constrained;
    mutable VectorType        to, from;
  };



  unsigned int
  count_iterations(const unsigned int cells,
                   const unsigned int degree,
                   const double       beta,
                   const unsigned int n_components,
                   const Coarsening   coarsening,
                   const std::string &smoother)
  {
    Box<2>                  box(MultiIndex<2>{{cells, cells}});
    const OrderHierarchy<2> orders(box.mesh, degree, coarsening);
    std::vector<std::unique_ptr<MassAndLaplacian>> operators;
    PMultigrid<2>::Levels                          levels;
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        operators.push_back(
          std::make_unique<MassAndLaplacian>(orders[l], beta, n_components));
        levels.push_back(operators.back().get());
      }
    PMultigridParameters parameters;
    SmootherParameters   smoother_parameters;
    parameters.coarsening            = coarsening;
    parameters.prolongation          = "exact-l2";
    parameters.restriction           = "transpose";
    parameters.smoother              = smoother;
    parameters.coarse_preconditioner = "jacobi";
    smoother_parameters.overlap      = 2;
    const PMultigrid<2> cycle(levels, parameters, smoother_parameters, 1e-4);

    VectorType x, b;
    initialize_vector<2>(x, *levels.back());
    initialize_vector<2>(b, *levels.back());
    const VectorType random = pseudo_random_vector(orders.finest());
    for (unsigned int i = 0; i < b.locally_owned_size(); ++i)
      b.local_element(i) =
        std::cos(i % n_components) * random.local_element(i / n_components);
    for (const unsigned int i : levels.back()->inactive())
      for (unsigned int c = 0; c < n_components; ++c)
        b.local_element(i * n_components + c) = 0.;
    SolverControl control(200, 1e-8 * b.l2_norm(), false, false);
    SolverFlexibleCG<VectorType>(control).solve(*levels.back(), x, b, cycle);
    return control.last_step();
  }
} // namespace



void
test_main()
{
  add_paper_parts();
  for (const double beta : {1e-3, 1., 1e6})
    for (const unsigned int p : {2, 3})
      {
        print() << "beta = " << beta << ", p = " << p << std::endl;
        for (const unsigned int cells : {8, 16, 32})
          for (const Coarsening coarsening :
               {Coarsening::one_by_one, Coarsening::direct})
            {
              const unsigned int n =
                count_iterations(cells, p, beta, 1, coarsening, "ic0");
              check_range("  iterations, " + std::to_string(cells) +
                            " cells, " + word_of(coarsening, coarsenings),
                          n,
                          2,
                          12);
              if (cells == 16)
                check_range(
                  "  of two components",
                  count_iterations(cells, p, beta, 2, coarsening, "ic0"),
                  n - 1,
                  n + 1);
            }
        check_range(
          "  with Chebyshev",
          count_iterations(16, p, beta, 2, Coarsening::direct, "chebyshev"),
          2,
          40);
      }
}
