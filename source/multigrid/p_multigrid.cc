#include <deal.II/lac/diagonal_matrix.h>
#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>

#include <greville/multigrid/p_multigrid.h>

namespace greville
{
  using namespace dealii;

  void
  PMultigridParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Coarsening",
      coarsening,
      "The orders of the levels: p, p-1, ..., 1 (one by one), p, p-2, ..., 1 "
      "(by two), p, 1 (direct), or p alone (none).",
      Patterns::Selection(OrderHierarchy<2>::coarsenings()));
    prm.add_parameter("Cycle",
                      cycle,
                      "The cycle.",
                      Patterns::Selection("V|W|F"));
    prm.add_parameter(
      "Prolongation",
      prolongation,
      "From an order to the next higher one: L2 projection with the lumped "
      "mass matrix, or with the exact one (1D banded solves).",
      Patterns::Selection(OrderTransfer<2>::prolongations()));
    prm.add_parameter("Restriction",
                      restriction,
                      "From an order to the next lower one: L2 projection of "
                      "the residual, lumped or exact, or the transpose of the "
                      "prolongation, which makes the cycle symmetric.",
                      Patterns::Selection(OrderTransfer<2>::restrictions()));
    prm.add_parameter("Transfer weight",
                      weighting,
                      "The weight of the L2 products in the transfer.",
                      Patterns::Selection(OrderTransfer<2>::weightings()));
    prm.add_parameter("Smoother",
                      smoother,
                      "The smoother of all levels but the coarsest, or of the "
                      "only level where Coarsening is none.",
                      Patterns::Selection(smoother_names()));
    prm.add_parameter(
      "Pre-smoothing steps",
      pre_smoothing,
      "nu1, smoothing steps before the coarse correction. Unit: steps.",
      Patterns::Integer(0, 100));
    prm.add_parameter(
      "Post-smoothing steps",
      post_smoothing,
      "nu2, smoothing steps after the coarse correction. Unit: steps.",
      Patterns::Integer(0, 100));
    prm.add_parameter(
      "Coarse tolerance",
      coarse_tolerance,
      "Relative residual of the conjugate gradients at p = 1. Where p = 1 is "
      "the only level, the solver's tolerance applies. Unit: none.",
      Patterns::Double(0., 1.));
    prm.add_parameter("Coarse maximum iterations",
                      coarse_max_iterations,
                      "The conjugate gradients at p = 1 end after so many "
                      "iterations at the latest. Unit: iterations.",
                      Patterns::Integer(1));
    prm.add_parameter("Coarse preconditioner",
                      coarse_preconditioner,
                      "Preconditioner of the conjugate gradients at p = 1.",
                      Patterns::Selection("none|jacobi|tensor-product"));
  }



  template <int dim>
  class PMultigrid<dim>::Matrices : public MGMatrixBase<VectorType>
  {
  public:
    Matrices(const std::vector<MassLevel<dim> *> &levels)
      : levels(levels)
    {}

    void
    vmult(const unsigned int level,
          VectorType        &dst,
          const VectorType  &src) const override
    {
      levels[level]->vmult(dst, src);
    }

    void
    vmult_add(const unsigned int level,
              VectorType        &dst,
              const VectorType  &src) const override
    {
      VectorType product(dst);
      vmult(level, product, src);
      dst += product;
    }

    void
    Tvmult(const unsigned int level,
           VectorType        &dst,
           const VectorType  &src) const override
    {
      vmult(level, dst, src);
    }

    void
    Tvmult_add(const unsigned int level,
               VectorType        &dst,
               const VectorType  &src) const override
    {
      vmult_add(level, dst, src);
    }

    unsigned int
    get_minlevel() const override
    {
      return 0;
    }

    unsigned int
    get_maxlevel() const override
    {
      return levels.size() - 1;
    }

  private:
    const std::vector<MassLevel<dim> *> levels;
  };



  template <int dim>
  class PMultigrid<dim>::Smoother : public MGSmootherBase<VectorType>
  {
  public:
    Smoother(const Matrices                                     &matrices,
             const std::vector<std::unique_ptr<Preconditioner>> &smoothers,
             std::vector<VectorType>                            &residual,
             const unsigned int                                  n_steps,
             const bool                                          transpose)
      : matrices(matrices)
      , smoothers(smoothers)
      , residual(residual)
      , correction(residual)
      , n_steps(n_steps)
      , transpose(transpose)
    {}

    void
    clear() override
    {}

    void
    smooth(const unsigned int level,
           VectorType        &u,
           const VectorType  &rhs) const override
    {
      for (unsigned int step = 0; step < n_steps; ++step)
        add_correction(level, u, rhs);
    }

    void
    apply(const unsigned int level,
          VectorType        &u,
          const VectorType  &rhs) const override
    {
      if (n_steps == 0)
        u = 0.;
      else
        precondition(level, u, rhs);
      for (unsigned int step = 1; step < n_steps; ++step)
        add_correction(level, u, rhs);
    }

  private:
    void
    precondition(const unsigned int level,
                 VectorType        &dst,
                 const VectorType  &src) const
    {
      if (transpose)
        smoothers[level]->Tvmult(dst, src);
      else
        smoothers[level]->vmult(dst, src);
    }

    void
    add_correction(const unsigned int level,
                   VectorType        &u,
                   const VectorType  &rhs) const
    {
      VectorType &r = residual[level];
      matrices.vmult(level, r, u);
      r.sadd(-1., 1., rhs);
      precondition(level, correction[level], r);
      u += correction[level];
    }

    const Matrices                                     &matrices;
    const std::vector<std::unique_ptr<Preconditioner>> &smoothers;
    std::vector<VectorType>                            &residual;
    mutable std::vector<VectorType>                     correction;
    const unsigned int                                  n_steps;
    const bool                                          transpose;
  };



  template <int dim>
  class PMultigrid<dim>::CoarseSolver : public MGCoarseGridBase<VectorType>
  {
  public:
    CoarseSolver(const MassLevel<dim>     &level,
                 const std::string        &preconditioner,
                 const SmootherParameters &parameters,
                 const double              tolerance,
                 const unsigned int        max_iterations)
      : level(level)
      , tolerance(tolerance)
      , max_iterations(max_iterations)
    {
      if (preconditioner == "none")
        return;
      this->preconditioner =
        make_smoother<dim>(preconditioner, parameters, level, true);
    }

    void
    operator()(const unsigned int,
               VectorType       &dst,
               const VectorType &src) const override
    {
      dst                = 0.;
      const double start = src.l2_norm();
      if (start == 0. || !std::isfinite(start))
        return;
      // Too few iterations make a worse correction, not an error.
      IterationNumberControl control(max_iterations, tolerance * start);
      SolverCG<VectorType>   cg(control, memory);
      if (preconditioner)
        cg.solve(level, dst, src, *preconditioner);
      else
        cg.solve(level, dst, src, PreconditionIdentity());
    }

    std::size_t
    memory_consumption() const
    {
      return preconditioner ? preconditioner->memory_consumption() : 0;
    }

  private:
    const MassLevel<dim>                   &level;
    const double                            tolerance;
    const unsigned int                      max_iterations;
    std::unique_ptr<Preconditioner>         preconditioner;
    mutable GrowingVectorMemory<VectorType> memory;
  };



  template <int dim>
  PMultigrid<dim>::PMultigrid(const std::vector<MassLevel<dim> *> &levels,
                              const PMultigridParameters          &parameters,
                              const SmootherParameters &smoother_parameters,
                              const double              coarse_tolerance)
    : order_transfer(levels,
                     parameters.prolongation,
                     parameters.restriction,
                     parameters.weighting)
    , cycle_type(parameters.cycle == "V"   ? Cycle::V
                 : parameters.cycle == "W" ? Cycle::W
                                           : Cycle::F)
    , smoothers(levels.size())
    , level_matrices(std::make_unique<Matrices>(levels))
    , x(levels.size())
    , b(levels.size())
    , residual(levels.size())
  {
    const bool is_symmetric = parameters.restriction == "transpose";
    const bool has_coarse   = parameters.coarsening != "none";
    AssertThrow(has_coarse || levels.size() == 1,
                ExcMessage("Coarsening none has one level."));
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        for (auto *vectors : {&x, &b, &residual})
          levels[l]->space().initialize_vector((*vectors)[l]);
        if (l > 0 || !has_coarse)
          smoothers[l] = make_smoother<dim>(parameters.smoother,
                                            smoother_parameters,
                                            *levels[l],
                                            is_symmetric);
      }
    pre = std::make_unique<Smoother>(
      *level_matrices, smoothers, residual, parameters.pre_smoothing, false);
    post = std::make_unique<Smoother>(*level_matrices,
                                      smoothers,
                                      residual,
                                      parameters.post_smoothing,
                                      is_symmetric);
    if (has_coarse)
      coarse = std::make_unique<CoarseSolver>(*levels[0],
                                              parameters.coarse_preconditioner,
                                              smoother_parameters,
                                              coarse_tolerance,
                                              parameters.coarse_max_iterations);
  }



  template <int dim>
  PMultigrid<dim>::~PMultigrid() = default;



  template <int dim>
  void
  PMultigrid<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    b.back() = src;
    cycle(x.size() - 1, cycle_type, true);
    dst = x.back();
  }



  template <int dim>
  void
  PMultigrid<dim>::Tvmult(VectorType &dst, const VectorType &src) const
  {
    vmult(dst, src);
  }



  template <int dim>
  void
  PMultigrid<dim>::cycle(const unsigned int l,
                         const Cycle        type,
                         const bool         from_zero) const
  {
    if (l == 0 && coarse)
      {
        (*coarse)(0, x[0], b[0]);
        return;
      }
    if (from_zero)
      pre->apply(l, x[l], b[l]);
    else
      pre->smooth(l, x[l], b[l]);
    if (l == 0)
      {
        post->smooth(l, x[l], b[l]);
        return;
      }

    level_matrices->vmult(l, residual[l], x[l]);
    residual[l].sadd(-1., 1., b[l]);
    b[l - 1] = 0.;
    order_transfer.restrict_and_add(l, b[l - 1], residual[l]);
    cycle(l - 1, type, true);
    // The coarsest level is solved; a second visit would change nothing.
    if (type != Cycle::V && l > 1)
      cycle(l - 1, type == Cycle::W ? Cycle::W : Cycle::V, false);
    order_transfer.prolongate_and_add(l, x[l], x[l - 1]);

    post->smooth(l, x[l], b[l]);
  }



  template <int dim>
  std::size_t
  PMultigrid<dim>::memory_consumption() const
  {
    std::size_t n = order_transfer.memory_consumption() +
                    (coarse ? coarse->memory_consumption() : 0);
    for (const auto &smoother : smoothers)
      if (smoother)
        n += smoother->memory_consumption();
    for (const auto &vector : x)
      n += 5 * vector.memory_consumption();
    return n;
  }



  template <int dim>
  const MGMatrixBase<VectorType> &
  PMultigrid<dim>::matrices() const
  {
    return *level_matrices;
  }



  template <int dim>
  const MGSmootherBase<VectorType> &
  PMultigrid<dim>::pre_smoother() const
  {
    return *pre;
  }



  template <int dim>
  const MGSmootherBase<VectorType> &
  PMultigrid<dim>::post_smoother() const
  {
    return *post;
  }



  template <int dim>
  const MGCoarseGridBase<VectorType> &
  PMultigrid<dim>::coarse_solver() const
  {
    Assert(coarse, ExcMessage("There is no coarse level."));
    return *coarse;
  }



  template class PMultigrid<2>;
  template class PMultigrid<3>;
} // namespace greville
