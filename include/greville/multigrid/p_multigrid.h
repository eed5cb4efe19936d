// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/lattice_cycle.h>
#include <greville/multigrid/order_transfer.h>
#include <greville/multigrid/smoother.h>
#include <greville/spline/order_hierarchy.h>

namespace greville
{
  enum class CycleType
  {
    V,
    W,
    F
  };

  inline const Choices<CycleType> cycle_types = {{CycleType::V, "V"},
                                                 {CycleType::W, "W"},
                                                 {CycleType::F, "F"}};



  struct PMultigridParameters
  {
    /// Declare the parameters. @p smoothers and @p coarse_preconditioners are
    /// the names to choose from, separated by '|'; if the latter is empty,
    /// there is no choice. All other values are set in the code, or by
    /// declare_levels() in benchmarks.
    void
    declare(dealii::ParameterHandler &prm,
            const std::string        &smoothers,
            const std::string        &coarse_preconditioners);

    /// Return the coarse preconditioners for operators of implicit steps.
    static std::string
    all_coarse_preconditioners()
    {
      return "none|jacobi|lattice|direct";
    }

    bool
    has_coarse_levels() const
    {
      return coarsening != Coarsening::none;
    }

    /// Return whether the lattices of the highest order become coarser.
    bool
    coarsens_lattices() const
    {
      return coarsening == Coarsening::lattice || coarsening == Coarsening::hp;
    }

    /// Return the parameters of a LatticeCycle.
    LatticeCycleParameters
    of_lattices(const SmootherParameters &smoother_parameters) const;

    Coarsening coarsening = Coarsening::one_by_one;
    CycleType  cycle      = CycleType::V;
    // Names of lists to which programs add.
    std::string    prolongation          = "lumped-l2";
    std::string    restriction           = "lumped-l2";
    TransferWeight weight                = TransferWeight::density;
    unsigned int   pre_smoothing         = 1;
    unsigned int   post_smoothing        = 1;
    double         coarse_tolerance      = 1e-4;
    unsigned int   coarse_max_iterations = 1000;
    std::string    coarse_preconditioner = "none";
    std::string    smoother              = "ic0";
  };



  /**
   * p-multigrid (@ref Tielen2019 "Tielen, Moeller and Vuik, 2019";
   * @ref Tielen2020 "2020") for A x = b on a hierarchy of orders. On
   * level l, with smoother S, prolongation P and restriction R,
   * @f{align*}{
   *   x &\leftarrow x + S (b - A x) && \nu_1 \text{ times}, \\
   *   e &= \text{cycle}(l - 1, R (b - A x))
   *     && \text{once (V), twice (W), or an F- and a V-cycle (F)}, \\
   *   x &\leftarrow x + P e, \\
   *   x &\leftarrow x + S (b - A x) && \nu_2 \text{ times},
   * @f}
   * and conjugate gradients on level 0. With restriction = "transpose" the
   * steps after the coarse correction use @f$ S^T @f$, so that V- and W-cycles
   * are symmetric (up to the tolerance of the coarse solver).
   *
   * With Coarsening::none there is no coarse level: a cycle consists of
   * @f$ \nu_1 + \nu_2 @f$ smoothing steps. With Coarsening::lattice and
   * Coarsening::hp, there is one level with a LatticeCycle. The coarse
   * preconditioner "lattice" is a LatticeCycle on level 0.
   *
   * The cycle is not dealii::Multigrid's, whose W-cycle runs as a V-cycle up to
   * version 9.7.
   */
  template <int dim>
  class PMultigrid : public Preconditioner
  {
  public:
    using Levels = std::vector<const LevelOperator<dim> *>;

    /// Collective. @p levels are kept by reference, from the coarsest to the
    /// finest. @p coarse_tolerance is the relative tolerance on level 0. For
    /// Coarsening::none there is one level.
    PMultigrid(const Levels               &levels,
               const PMultigridParameters &parameters,
               const SmootherParameters   &smoother_parameters,
               const double                coarse_tolerance);

    /// Apply one cycle with the initial guess zero.
    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    /// Improve x[level] for the right-hand side b[level], beginning with zero
    /// if @p from_zero.
    void
    cycle(const unsigned int level,
          const CycleType    type,
          const bool         from_zero) const;

    /// Do @p n_steps steps x += S (b - A x), the first one from x = 0 if
    /// @p from_zero, with S^T if @p transpose.
    void
    smooth(const unsigned int level,
           const unsigned int n_steps,
           const bool         transpose,
           const bool         from_zero) const;

    /// Compute residual = b - A x on level l.
    void
    compute_residual(const unsigned int l) const
    {
      levels[l]->vmult_in_cycle(residual[l], x[l]);
      residual[l].sadd(-1., 1., b[l]);
    }

    void
    make_coarse_preconditioner(const SmootherParameters &smoother_parameters);

    void
    solve_coarse() const;

    const Levels                                 levels;
    const PMultigridParameters                   parameters;
    const double                                 coarse_tolerance;
    const bool                                   has_coarse;
    OrderTransfer<dim>                           transfer;
    std::vector<std::unique_ptr<Preconditioner>> smoothers;
    std::unique_ptr<Preconditioner>              coarse_preconditioner;
    mutable std::vector<VectorType>              x, b, residual, correction;
  };
} // namespace greville
