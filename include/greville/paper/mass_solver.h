// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_paper_mass_solver_h
#define greville_paper_mass_solver_h

#include <greville/linear_algebra/solve_result.h>
#include <greville/multigrid/p_multigrid.h>
#include <greville/paper/assembled_mass_level.h>
#include <greville/spline/order_hierarchy.h>

namespace greville
{
  struct MassSolverParameters : SolverParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string operator_kind = "automatic";
  };



  /**
   * The mass matrix of a density on all orders of a hierarchy.
   */
  template <int dim>
  class MassHierarchy
  {
  public:
    /**
     * Collective. Evaluates the density; operators are made by a MassSolver.
     * The hierarchy is kept by reference.
     */
    MassHierarchy(const OrderHierarchy<dim>   &orders,
                  const dealii::Function<dim> &density)
    {
      for (unsigned int l = 0; l < orders.n_levels(); ++l)
        levels.push_back(
          std::make_unique<AssembledMassLevel<dim>>(orders[l], density));
    }

    /**
     * Collective. Weights of zero at the 2 p + 1 Gauss points per direction
     * that make the matrix of material points, to be filled before a MassSolver
     * assembles.
     */
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

    /**
     * From the coarsest to the finest.
     */
    const std::vector<std::unique_ptr<AssembledMassLevel<dim>>> &
    all_levels() const
    {
      return levels;
    }

    /**
     * The same as PMultigrid takes them.
     */
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
    /**
     * The names, with fmpm-K for any K.
     */
    static std::string
    names();

    /**
     * Throws dealii::ExcMessage, which names the @p parameter, for a name that
     * is not one of names().
     */
    static void
    check_name(const std::string &name, const std::string &parameter);

    /**
     * @p name is one of names(). The others are kept by reference.
     */
    MassSolver(const std::string          &name,
               MassHierarchy<dim>         &hierarchy,
               const MassSolverParameters &parameters,
               const PMultigridParameters &multigrid_parameters,
               const SmootherParameters   &smoother_parameters);

    /**
     * Collective. Make the operators of the levels that the solver needs, and
     * the matrices that it or its smoother needs.
     */
    void
    assemble();

    /**
     * Collective. Make transfers, smoothers, factorizations.
     */
    void
    setup();

    /**
     * Collective. The initial value of x does not matter.
     */
    SolveResult
    solve(VectorType &x, const VectorType &b) const;

    static bool
    uses_multigrid(const std::string &name)
    {
      return name.find("p-multigrid") != std::string::npos;
    }

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

#endif
