// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/solve_result.h>
#include <greville/multigrid/p_multigrid.h>
#include <greville/paper/assembled_mass_level.h>

namespace greville
{
  struct MassSolverParameters : SolverParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string operator_kind = "automatic";
  };



  /// The mass matrix of a density on all orders of a hierarchy.
  template <int dim>
  class MassHierarchy
  {
  public:
    /// Collective. Evaluate the density. A MassSolver makes the operators. The
    /// hierarchy is kept by reference.
    MassHierarchy(const OrderHierarchy<dim>   &orders,
                  const dealii::Function<dim> &density)
    {
      for (unsigned int l = 0; l < orders.n_levels(); ++l)
        levels.push_back(
          std::make_unique<AssembledMassLevel<dim>>(orders[l], density));
    }

    /// Collective. Set zero weights at the 2 p + 1 Gauss points per direction,
    /// for the matrix of material points. Fill them before a MassSolver
    /// assembles.
    MassHierarchy(const OrderHierarchy<dim> &orders)
    {
      for (unsigned int l = 0; l < orders.n_levels(); ++l)
        levels.push_back(std::make_unique<AssembledMassLevel<dim>>(
          orders[l],
          DensityWeights<dim>(orders[l], 2 * orders[l].degree() + 1)));
    }

    AssembledMassLevel<dim> &
    finest()
    {
      return *levels.back();
    }

    /// Return the levels from the coarsest to the finest.
    const std::vector<std::unique_ptr<AssembledMassLevel<dim>>> &
    all_levels() const
    {
      return levels;
    }

    typename PMultigrid<dim>::Levels
    operators() const
    {
      typename PMultigrid<dim>::Levels result;
      for (const auto &level : levels)
        result.push_back(level.get());
      return result;
    }

  private:
    std::vector<std::unique_ptr<AssembledMassLevel<dim>>> levels;
  };



  /**
   * The solvers of M x = b by name:
   * - "p-multigrid": @f$ x \leftarrow x + \text{cycle}(b - M x) @f$, see
   *   PMultigrid,
   * - "cg-p-multigrid", "fgmres-p-multigrid": conjugate gradients and FGMRES,
   *   preconditioned by a cycle,
   * - "cg-smoother": conjugate gradients, preconditioned by the smoother of the
   *   finest level,
   * - "cg", "cg-jacobi", "cg-tensor-product": conjugate gradients,
   * - "tensor-product": TensorProductPreconditioner, once,
   * - "lumped": @f$ x = M_L^{-1} b @f$ with the row sums @f$ M_L @f$ of M,
   * - "fmpm-K": K terms of FMPM's series, see add_fmpm_terms(); fmpm-1 is
   *   lumped.
   *
   * All start from zero. Iterations end when the residual has fallen by the
   * tolerance.
   */
  template <int dim>
  class MassSolver
  {
  public:
    /// Return the names, with fmpm-K for any K.
    static std::string
    names();

    /// Throw dealii::ExcMessage, which names the @p parameter, if @p name is
    /// not in names().
    static void
    check_name(const std::string &name, const std::string &parameter);

    /// @p name is one of names(). The other arguments are kept by reference.
    MassSolver(const std::string          &name,
               MassHierarchy<dim>         &hierarchy,
               const MassSolverParameters &parameters,
               const PMultigridParameters &multigrid_parameters,
               const SmootherParameters   &smoother_parameters);

    /// Collective. Make the operators and matrices of the levels that the
    /// solver or its smoother needs.
    void
    assemble();

    /// Collective. Make transfers, smoothers and factorizations.
    void
    setup();

    /// Collective. Solve M x = b from zero, whatever x is.
    SolveResult
    solve(VectorType &x, const VectorType &b) const;

  private:
    const std::string           name;
    MassHierarchy<dim>         &hierarchy;
    const MassSolverParameters &parameters;
    const PMultigridParameters &multigrid_parameters;
    const SmootherParameters   &smoother_parameters;
    const unsigned int          n_terms; // of FMPM, 0: another solver

    std::unique_ptr<Preconditioner> preconditioner;
    VectorType                      inverse_lumped;
  };
} // namespace greville
