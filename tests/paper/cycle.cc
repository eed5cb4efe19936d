// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks that the project's V-cycle equals deal.II's, W and F follow their
// recursions, the symmetric cycle is symmetric, and the number of smoothing
// steps has an effect.

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/multigrid/mg_coarse.h>
#include <deal.II/multigrid/mg_matrix.h>
#include <deal.II/multigrid/mg_smoother.h>
#include <deal.II/multigrid/multigrid.h>

#include <greville/multigrid/p_multigrid.h>
#include <greville/paper/assembled_mass_level.h>
#include <greville/paper/paper_parts.h>
#include <greville/spline/order_hierarchy.h>

#include <density.h>

namespace
{
  /// Levels and smoothers in the form that deal.II's classes want.
  struct Operator : public Observable
  {
    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      level->vmult(dst, src);
    }

    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      level->vmult(dst, src);
    }

    const LevelOperator<2> *level = nullptr;
  };

  struct Smoother : public Observable
  {
    struct AdditionalData
    {
      std::shared_ptr<const Preconditioner> smoother;
    };

    void
    initialize(const Operator &, const AdditionalData &data)
    {
      smoother = data.smoother;
    }

    void
    clear()
    {
      smoother.reset();
    }

    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      smoother->vmult(dst, src);
    }

    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      smoother->Tvmult(dst, src);
    }

    std::shared_ptr<const Preconditioner> smoother;
  };
} // namespace



void
test_main()
{
  add_paper_parts();
  Box<2>                  box(MultiIndex<2>{{12, 12}});
  const OrderHierarchy<2> orders(box.mesh, 4);
  const auto              rho = density<2>("smooth");
  std::vector<std::unique_ptr<AssembledMassLevel<2>>> owners;
  std::vector<const LevelOperator<2> *>               levels;
  for (unsigned int l = 0; l < orders.n_levels(); ++l)
    {
      owners.push_back(
        std::make_unique<AssembledMassLevel<2>>(orders[l], *rho));
      owners.back()->assemble(true, false);
      levels.push_back(owners.back().get());
    }

  PMultigridParameters parameters;
  SmootherParameters   smoother_parameters;
  const VectorType     b = pseudo_random_vector(orders.finest());
  // The coarse solver to the end: then all is linear.
  const double coarse = 1e-13;
  parameters.smoother = "gauss-seidel";

  const auto reduction = [&]() {
    const PMultigrid<2> cycle(levels, parameters, smoother_parameters, coarse);
    VectorType          x(b), r(b);
    cycle.vmult(x, b);
    levels.back()->vmult(r, x);
    r -= b;
    return r.l2_norm() / b.l2_norm();
  };

  for (const std::string restriction : {"lumped-l2", "transpose"})
    {
      parameters.restriction = restriction;
      parameters.cycle       = CycleType::V;
      const PMultigrid<2> cycle(levels,
                                parameters,
                                smoother_parameters,
                                coarse);
      VectorType          x(b), y(b);
      cycle.vmult(x, b);

      // deal.II's cycle of the same parts.
      const unsigned int                      top = orders.n_levels() - 1;
      MGLevelObject<Operator>                 operators(0, top);
      MGLevelObject<Smoother::AdditionalData> smoothers(0, top);
      const OrderTransfer<2>                  transfer(levels,
                                      parameters.prolongation,
                                      parameters.restriction,
                                      parameters.weight);
      for (unsigned int l = 0; l <= top; ++l)
        {
          operators[l].level = levels[l];
          if (l > 0)
            smoothers[l].smoother =
              make_smoother<2>(parameters.smoother,
                               smoother_parameters,
                               *levels[l],
                               restriction == "transpose");
        }
      const mg::Matrix<VectorType> matrices(operators);
      MGSmootherPrecondition<Operator, Smoother, VectorType> pre, post;
      pre.initialize(operators, smoothers);
      post.initialize(operators, smoothers);
      post.set_transpose(restriction == "transpose");
      ReductionControl           control(1000, 1e-30, coarse);
      SolverCG<VectorType>       cg(control);
      const PreconditionIdentity identity;
      const MGCoarseGridIterativeSolver<VectorType,
                                        SolverCG<VectorType>,
                                        Operator,
                                        PreconditionIdentity>
                            coarse_solver(cg, operators[0], identity);
      Multigrid<VectorType> multigrid(matrices,
                                      coarse_solver,
                                      transfer,
                                      pre,
                                      post,
                                      0,
                                      top,
                                      Multigrid<VectorType>::v_cycle);
      multigrid.defect.resize(0, top);
      for (unsigned int l = 0; l <= top; ++l)
        orders[l].initialize_vector(multigrid.defect[l]);
      multigrid.defect[top] = b;
      multigrid.cycle();
      y = multigrid.solution[top];
      check(restriction + ": as deal.II's V-cycle", difference(x, y), 1e-11);

      for (const auto &[type, name] : cycle_types)
        {
          parameters.cycle = type;
          const PMultigrid<2> other(levels,
                                    parameters,
                                    smoother_parameters,
                                    coarse);
          other.vmult(y, b);
          if (type != CycleType::V)
            check(restriction + ": " + name + " is not V",
                  difference(x, y) > 1e-6);
          // The adjoint of an F-cycle does its V before its F.
          if (restriction == "transpose" && type != CycleType::F)
            {
              VectorType c(b), z(b);
              for (unsigned int i = 0; i < c.locally_owned_size(); ++i)
                c.local_element(i) = std::cos(5. * b.local_element(i));
              other.vmult(z, c);
              check(name + ": symmetric",
                    std::abs(y * c - b * z) / (y.l2_norm() * c.l2_norm()),
                    1e-9);
            }
        }
    }

  // Two levels of the recursion by hand: with orders 3, 2, 1 the W-cycle
  // equals the F-cycle's; with 4, ..., 1 it does not.
  parameters.restriction = "lumped-l2";
  {
    const std::vector<const LevelOperator<2> *> three{levels[0],
                                                      levels[1],
                                                      levels[2]};
    const VectorType c = pseudo_random_vector(orders[2]);
    VectorType       w(c), f(c);
    parameters.cycle = CycleType::W;
    PMultigrid<2>(three, parameters, smoother_parameters, coarse).vmult(w, c);
    parameters.cycle = CycleType::F;
    PMultigrid<2>(three, parameters, smoother_parameters, coarse).vmult(f, c);
    check("orders 3, 2, 1: W is F", difference(w, f), 1e-11);
  }
  parameters.cycle = CycleType::W;
  const double w   = reduction();
  parameters.cycle = CycleType::F;
  const double f   = reduction();
  check("orders 4, ..., 1: W is not F", std::abs(w - f) > 1e-9);

  // More smoothing, smaller residual.
  parameters.cycle         = CycleType::V;
  parameters.smoother      = "symmetric-gauss-seidel";
  double before            = reduction();
  parameters.pre_smoothing = 3;
  double after             = reduction();
  check("more steps before help", after < before);
  before                    = after;
  parameters.post_smoothing = 3;
  after                     = reduction();
  check("more steps after help", after < before);

  // The options of the transfer and of the coarse solver have an effect.
  parameters.pre_smoothing = parameters.post_smoothing = 1;
  parameters.smoother                                  = "jacobi";
  before                                               = reduction();
  parameters.prolongation                              = "exact-l2";
  after                                                = reduction();
  check("prolongation has an effect", std::abs(before - after) > 1e-9);
  parameters.restriction = "exact-l2";
  before                 = reduction();
  check("restriction has an effect", std::abs(before - after) > 1e-9);
  parameters.weight = TransferWeight::unit;
  after             = reduction();
  check("weight has an effect", std::abs(before - after) > 1e-9);
  parameters.coarse_max_iterations = 2;
  before                           = reduction();
  check("coarse maximum iterations have an effect",
        std::abs(before - after) > 1e-9);
  parameters.coarse_preconditioner = "jacobi";
  after                            = reduction();
  check("coarse preconditioner has an effect", std::abs(before - after) > 1e-9);
}
