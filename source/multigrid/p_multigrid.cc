// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/linear_algebra/krylov.h>
#include <greville/multigrid/p_multigrid.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  void
  PMultigridParameters::declare(ParameterHandler  &prm,
                                const std::string &smoothers,
                                const std::string &coarse_preconditioners)
  {
    add_parameter(prm, "Smoother", smoother, Patterns::Selection(smoothers))(
      std::string("The smoother of all levels but the coarsest.") +
      (smoother == "auto" ? " auto: chebyshev-ic0, with pore water "
                            "chebyshev-component-ic0, and where "
                            "Poisson's ratio is above 0.4 or "
                            "0.475 chebyshev-component-ic0 with a "
                            "degree raised by 1 or 3, and a range "
                            "of 2 or 4 times the given one."
                          : ""));
    if (!coarse_preconditioners.empty())
      add_parameter(prm,
                    "Coarse preconditioner",
                    coarse_preconditioner,
                    Patterns::Selection(coarse_preconditioners))(
        "Preconditioner of the conjugate gradients at p = 1.");
  }



  LatticeCycleParameters
  PMultigridParameters::of_lattices(
    const SmootherParameters &smoother_parameters) const
  {
    const bool by_components = smoother == "chebyshev-component-ic0";
    Require(!coarsens_lattices() || by_components ||
              smoother == "chebyshev-ic0",
            "The coarsening <" + word_of(coarsening, coarsenings) +
              "> takes the smoothers chebyshev-ic0 and "
              "chebyshev-component-ic0, but 'Smoother' is <" +
              smoother + ">.");
    return {smoother_parameters.shift,
            smoother_parameters.chebyshev_degree,
            smoother_parameters.chebyshev_range,
            by_components,
            coarsening == Coarsening::hp};
  }



  template <int dim>
  PMultigrid<dim>::PMultigrid(const Levels               &levels,
                              const PMultigridParameters &parameters,
                              const SmootherParameters   &smoother_parameters,
                              const double                coarse_tolerance)
    : levels(levels)
    , parameters(parameters)
    , coarse_tolerance(coarse_tolerance)
    , has_coarse(parameters.has_coarse_levels())
    , transfer(levels,
               parameters.prolongation,
               parameters.restriction,
               parameters.weight)
    , smoothers(levels.size())
    , x(levels.size())
    , b(levels.size())
    , residual(levels.size())
    , correction(levels.size())
  {
    Require(has_coarse || levels.size() == 1, "Coarsening none has one level.");
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        for (auto *vectors : {&x, &b, &residual, &correction})
          initialize_vector((*vectors)[l], *levels[l]);
        if (l > 0 || !has_coarse)
          smoothers[l] = make_smoother<dim>(parameters.smoother,
                                            smoother_parameters,
                                            *levels[l],
                                            transfer.is_symmetric());
      }
    if (has_coarse)
      make_coarse_preconditioner(smoother_parameters);
  }



  template <int dim>
  void
  PMultigrid<dim>::make_coarse_preconditioner(
    const SmootherParameters &smoother_parameters)
  {
    const std::string name = parameters.coarsens_lattices()
                               ? "lattice"
                               : parameters.coarse_preconditioner;
    if (name == "none")
      return;
    if (name != "lattice" && name != "direct")
      {
        coarse_preconditioner =
          make_smoother<dim>(name, smoother_parameters, *levels[0], true);
        return;
      }
    coarse_preconditioner =
      name == "direct" ? levels[0]->petsc_preconditioner(
                           "-pc_type lu -pc_factor_mat_solver_type mumps")
                       : levels[0]->lattice_preconditioner(
                           parameters.of_lattices(smoother_parameters));
    Require(coarse_preconditioner,
            "The parameter 'Coarse preconditioner' is <" + name +
              ">, which needs entries that this operator does not provide.");
  }



  template <int dim>
  void
  PMultigrid<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    b.back() = src;
    cycle(levels.size() - 1, parameters.cycle, true);
    dst = x.back();
  }



  template <int dim>
  void
  PMultigrid<dim>::cycle(const unsigned int l,
                         const CycleType    type,
                         const bool         from_zero) const
  {
    if (l == 0 && has_coarse)
      {
        solve_coarse();
        return;
      }
    smooth(l, parameters.pre_smoothing, false, from_zero);
    if (l > 0)
      {
        compute_residual(l);
        b[l - 1] = 0.;
        transfer.restrict_and_add(l, b[l - 1], residual[l]);
        cycle(l - 1, type, true);
        // The coarsest level is solved, so that a second visit would not help.
        if (type != CycleType::V && l > 1)
          cycle(l - 1,
                type == CycleType::W ? CycleType::W : CycleType::V,
                false);
        transfer.prolongate_and_add(l, x[l], x[l - 1]);
      }
    smooth(l, parameters.post_smoothing, transfer.is_symmetric(), false);
  }



  template <int dim>
  void
  PMultigrid<dim>::smooth(const unsigned int l,
                          const unsigned int n_steps,
                          const bool         transpose,
                          const bool         from_zero) const
  {
    const auto precondition = [&](VectorType &dst, const VectorType &src) {
      transpose ? smoothers[l]->Tvmult(dst, src)
                : smoothers[l]->vmult(dst, src);
    };
    if (from_zero && n_steps == 0)
      x[l] = 0.;
    for (unsigned int step = 0; step < n_steps; ++step)
      if (from_zero && step == 0)
        precondition(x[l], b[l]);
      else
        {
          compute_residual(l);
          precondition(correction[l], residual[l]);
          x[l] += correction[l];
        }
  }



  template <int dim>
  void
  PMultigrid<dim>::solve_coarse() const
  {
    x[0] = 0.;
    if ((coarse_tolerance >= 1. || parameters.coarsens_lattices()) &&
        coarse_preconditioner)
      {
        const double start = b[0].l2_norm();
        if (start != 0. && std::isfinite(start))
          coarse_preconditioner->vmult(x[0], b[0]);
        return;
      }
    // If the iterations do not suffice, the correction is merely worse.
    solve_krylov(
      {coarse_tolerance, parameters.coarse_max_iterations},
      [&](VectorType &dst, const VectorType &src) {
        levels[0]->vmult(dst, src);
      },
      [&](VectorType &dst, const VectorType &src) {
        if (coarse_preconditioner)
          coarse_preconditioner->vmult(dst, src);
        else
          dst = src;
      },
      x[0],
      b[0]);
  }



  GREVILLE_INSTANTIATE_CLASS(PMultigrid);
} // namespace greville
