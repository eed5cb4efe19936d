// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/benchmark/benchmark_problem.h>
#include <greville/paper/paper_parts.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  std::string
  operator_names()
  {
    return "mass|laplace|elasticity|mass and elasticity";
  }



  namespace
  {
    /// The PETSc preconditioners and their options.
    const std::vector<std::pair<std::string, std::string>> algebraic = {
      {"cg-ic0", "-pc_type bjacobi -sub_pc_type icc"},
      {"cg-gamg", "-pc_type gamg"},
      {"cg-boomeramg",
       "-pc_type hypre -pc_hypre_type boomeramg "
       "-pc_hypre_boomeramg_strong_threshold 0.5"}};

    std::string
    level_solver_names(const std::string &operator_name)
    {
      std::string names = is_elastic(operator_name) ? "" : "p-multigrid|cg|";
      names += "cg-p-multigrid|fgmres-p-multigrid|fgmres-tielen|cg-smoother|"
               "cg-jacobi";
      for (const auto &name : algebraic)
        names += "|" + name.first;
      return names;
    }
  } // namespace



  std::string
  solvers_beside_mass()
  {
    return level_solver_names("laplace") +
           " (p-multigrid and cg not for elasticity)";
  }



  void
  check_solver(const std::string &solver,
               const std::string &operator_name,
               const std::string &parameter)
  {
    if (operator_name == "mass")
      {
        MassSolver<2>::check_name(solver, parameter);
        return;
      }
    const std::string names = level_solver_names(operator_name);
    const auto        known = Utilities::split_string_list(names, '|');
    Require(std::count(known.begin(), known.end(), solver) == 1,
            "The parameter '" + parameter + "' is <" + solver +
              ">; for the operator <" + operator_name +
              "> it has to be one of " + names + "." +
              did_you_mean(solver, known));
  }



  bool
  takes_smoother(const std::string &solver)
  {
    return takes_cycle(solver) || solver == "cg-smoother";
  }



  LevelSolver
  make_level_solver(const std::string          &name,
                    const std::string          &operator_name,
                    const PMultigridParameters &multigrid,
                    const SmootherParameters   &smoother)
  {
    LevelSolver result;
    result.has_preconditioner = name != "cg";
    result.multigrid          = multigrid;
    result.smoother           = smoother;
    if (name.compare(0, 6, "fgmres") == 0)
      result.method = LevelMethod::fgmres;
    if (name == "p-multigrid")
      result.method = LevelMethod::stationary;
    if (name == "cg-p-multigrid")
      // A coarse solve up to a tolerance is not linear.
      result.method = LevelMethod::flexible_cg;
    if (takes_cycle(name))
      return result;

    if (name == "fgmres-tielen")
      {
        result.multigrid                       = PaperMultigridParameters();
        result.smoother                        = SmootherParameters();
        result.smoother.ordering               = "amd";
        result.multigrid.coarse_preconditioner = "direct";
        result.multigrid.coarse_tolerance      = 1.;
        if (is_elastic(operator_name))
          {
            // The components are coupled, so all are factorized together.
            result.multigrid.smoother = "petsc";
            result.smoother.petsc_options =
              "-pc_type asm -pc_asm_overlap 1 -sub_pc_type ilut";
          }
        return result;
      }
    // One application per iteration, without levels.
    result.multigrid.coarsening     = Coarsening::none;
    result.multigrid.pre_smoothing  = 1;
    result.multigrid.post_smoothing = 0;
    if (name == "cg-jacobi")
      result.multigrid.smoother = "jacobi";
    for (const auto &entry : algebraic)
      if (entry.first == name)
        {
          result.multigrid.smoother     = "petsc";
          result.smoother.petsc_options = entry.second;
        }
    return result;
  }
} // namespace greville
