// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/mass/fmpm.h>
#include <greville/paper/level_solver.h>
#include <greville/paper/mass_solver.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;

  void
  MassSolverParameters::declare(ParameterHandler &prm)
  {
    SolverParameters::declare(prm);
    prm.add_parameter(
      "Operator",
      operator_kind,
      "How M is applied: by the assembled matrix, matrix-free, or (automatic) "
      "by the matrix in cg and cg-jacobi, as other codes do, and matrix-free "
      "in all others. Smoothers that need the matrix have it assembled in any "
      "case.",
      Patterns::Selection("automatic|assembled|matrix-free"));
  }



  namespace
  {
    const std::vector<std::string> solver_names = {"p-multigrid",
                                                   "cg-p-multigrid",
                                                   "fgmres-p-multigrid",
                                                   "cg-smoother",
                                                   "cg",
                                                   "cg-jacobi",
                                                   "cg-tensor-product",
                                                   "tensor-product",
                                                   "lumped"};
  } // namespace



  template <int dim>
  std::string
  MassSolver<dim>::names()
  {
    return boost::algorithm::join(solver_names, "|") + "|" + fmpm_in_lists;
  }



  template <int dim>
  MassSolver<dim>::MassSolver(const std::string          &name,
                              MassHierarchy<dim>         &hierarchy,
                              const MassSolverParameters &parameters,
                              const PMultigridParameters &multigrid_parameters,
                              const SmootherParameters   &smoother_parameters)
    : name(name)
    , hierarchy(hierarchy)
    , parameters(parameters)
    , multigrid_parameters(multigrid_parameters)
    , smoother_parameters(smoother_parameters)
    , n_terms(n_fmpm_terms(name))
  {
    Require(n_terms > 0 ||
              std::count(solver_names.begin(), solver_names.end(), name) == 1,
            "Unknown solver <" + name + ">.");
  }



  template <int dim>
  void
  MassSolver<dim>::check_name(const std::string &name,
                              const std::string &parameter)
  {
    auto known = solver_names;
    known.push_back("fmpm-2");
    if (n_fmpm_terms(name) == 0)
      check_known(name, parameter, known, names());
  }



  template <int dim>
  void
  MassSolver<dim>::assemble()
  {
    preconditioner.reset();
    const bool apply_matrix = parameters.operator_kind == "assembled" ||
                              (parameters.operator_kind == "automatic" &&
                               (name == "cg" || name == "cg-jacobi"));
    const std::string smoother = takes_cycle(name) || name == "cg-smoother"
                                   ? multigrid_parameters.smoother
                                   : "";
    const bool        smoother_wants_matrix =
      !smoother.empty() && smoother_needs_matrix(smoother);

    const auto &levels = hierarchy.all_levels();
    for (unsigned int l = 0; l < levels.size(); ++l)
      if (l + 1 == levels.size() || takes_cycle(name))
        {
          const bool has_smoother = l > 0 || !takes_cycle(name) ||
                                    !multigrid_parameters.has_coarse_levels();
          levels[l]->assemble(has_smoother && smoother_wants_matrix,
                              apply_matrix,
                              has_smoother && smoother == "ict");
        }
  }



  template <int dim>
  void
  MassSolver<dim>::setup()
  {
    AssembledMassLevel<dim> &finest = hierarchy.finest();
    if (takes_cycle(name))
      {
        // For p = 1, the coarse solver alone must reach the tolerance.
        preconditioner = std::make_unique<PMultigrid<dim>>(
          hierarchy.operators(),
          multigrid_parameters,
          smoother_parameters,
          hierarchy.all_levels().size() == 1
            ? 0.5 * parameters.tolerance
            : multigrid_parameters.coarse_tolerance);
      }
    else if (name == "cg-smoother")
      preconditioner = make_smoother<dim>(multigrid_parameters.smoother,
                                          smoother_parameters,
                                          finest,
                                          true);
    else if (name == "cg-jacobi")
      preconditioner =
        std::make_unique<DiagonalPreconditioner>(finest.diagonal());
    else if (name == "tensor-product" || name == "cg-tensor-product")
      preconditioner =
        make_smoother<dim>("tensor-product", smoother_parameters, finest, true);
    else if (n_terms > 0)
      {
        inverse_lumped = finest.lumped();
        for (double &entry : inverse_lumped)
          entry = 1. / entry;
      }
  }



  template <int dim>
  SolveResult
  MassSolver<dim>::solve(VectorType &x, const VectorType &b) const
  {
    const AssembledMassLevel<dim> &finest = hierarchy.finest();
    return solve_and_check<dim>(finest, x, b, parameters.tolerance, [&]() {
      if (n_terms > 0)
        {
          x = b;
          x.scale(inverse_lumped);
          add_fmpm_terms(x, b, finest, inverse_lumped, n_terms);
          return SolveResult();
        }
      if (name == "tensor-product")
        {
          preconditioner->vmult(x, b);
          return SolveResult();
        }
      // The coarse solve is not linear, so a flexible method is needed.
      const LevelMethod method = name == "p-multigrid" ? LevelMethod::stationary
                                 : name == "fgmres-p-multigrid"
                                   ? LevelMethod::fgmres
                                 : takes_cycle(name) ? LevelMethod::flexible_cg
                                                     : LevelMethod::cg;
      return iterate<dim>(
        method, finest, preconditioner.get(), parameters, x, b);
    });
  }



  GREVILLE_INSTANTIATE_CLASS(MassHierarchy);
  GREVILLE_INSTANTIATE_CLASS(MassSolver);
} // namespace greville
