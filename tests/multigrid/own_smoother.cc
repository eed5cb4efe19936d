// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a smoother that the program defines by name without changing the
// library: Jacobi's method with a fixed factor, in the p-multigrid cycle and in
// conjugate gradients with this cycle.

#include <deal.II/lac/solver_cg.h>

#include <greville/multigrid/mass_level.h>
#include <greville/multigrid/p_multigrid.h>

#include <density.h>

namespace
{
  class FixedJacobi : public DiagonalPreconditioner
  {
  public:
    FixedJacobi(const VectorType &diagonal)
      : DiagonalPreconditioner(diagonal)
    {
      inverse_diagonal *= 0.3;
    }
  };



  unsigned int
  count_iterations(const unsigned int smoothing_steps)
  {
    Box<2>                                     box(MultiIndex<2>{{16, 16}});
    const OrderHierarchy<2>                    orders(box.mesh, 3);
    std::vector<std::unique_ptr<MassLevel<2>>> masses;
    PMultigrid<2>::Levels                      levels;
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        masses.push_back(
          std::make_unique<MassLevel<2>>(orders[l], *density<2>("smooth")));
        masses.back()->assemble(false);
        levels.push_back(masses.back().get());
      }
    PMultigridParameters parameters;
    parameters.restriction    = "transpose";
    parameters.smoother       = "fixed-jacobi";
    parameters.pre_smoothing  = smoothing_steps;
    parameters.post_smoothing = smoothing_steps;
    const PMultigrid<2> cycle(levels, parameters, SmootherParameters(), 1e-6);

    const VectorType     b = pseudo_random_vector(orders.finest());
    VectorType           x(b);
    SolverControl        control(1000, 1e-8 * b.l2_norm(), false, false);
    SolverCG<VectorType> cg(control);
    x = 0.;
    cg.solve(*masses.back(), x, b, cycle);
    return control.last_step();
  }
} // namespace



void
test_main()
{
  add_smoother<2>("fixed-jacobi",
                  false,
                  false,
                  [](const SmootherParameters &,
                     const LevelOperator<2> &level,
                     const bool) {
                    return std::make_unique<FixedJacobi>(level.diagonal());
                  });
  const unsigned int one = count_iterations(1), four = count_iterations(4);
  check_range("iterations with one step", one, 10, 200);
  check("more steps, fewer iterations", four < one);
  check("the list of names",
        smoother_names().find("|fixed-jacobi") != std::string::npos);
}
