// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/steps/coupled_cycle.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CoupledCycle<dim>::update(
    const std::vector<TangentSystem<dim> *>                      &systems,
    const double                                                  stiffness,
    const std::function<std::unique_ptr<LatticeCoupling<dim>>()> &make_coupling)
  {
    std::vector<std::uint64_t> numbers;
    for (const TangentSystem<dim> *system : systems)
      numbers.push_back(system->set_up_number());
    if (numbers == set_ups && std::abs(stiffness - stiffness_of_set_up) <=
                                0.2 * std::max(stiffness, stiffness_of_set_up))
      return;
    set_ups.clear();
    cycle.reset();
    // Open contacts do not couple.
    coupling = stiffness > 0. ? make_coupling()
                              : std::make_unique<LatticeCoupling<dim>>();
    try
      {
        build(systems, true);
      }
    catch (const ErrorOnAll &)
      {
        build(systems, false);
      }
    set_ups             = numbers;
    stiffness_of_set_up = stiffness;
  }



  template <int dim>
  void
  CoupledCycle<dim>::build(const std::vector<TangentSystem<dim> *> &systems,
                           const bool                               coarsens)
  {
    typename LatticeCycle<dim>::Parts parts;
    LatticeCycleParameters            parameters;
    bool                              are_levels_useful = false;
    for (const TangentSystem<dim> *system : systems)
      {
        auto                         part = system->lattice_part();
        const LatticeCycleParameters own  = part.parameters;
        // All parts use the smoother of the most demanding part.
        if (parts.empty())
          parameters = own;
        parameters.shift = std::max(parameters.shift, own.shift);
        parameters.chebyshev_degree =
          std::max(parameters.chebyshev_degree, own.chebyshev_degree);
        parameters.chebyshev_range =
          std::max(parameters.chebyshev_range, own.chebyshev_range);
        parameters.by_components =
          parameters.by_components || own.by_components;
        are_levels_useful = are_levels_useful || part.coarsens;
        parts.push_back(std::move(part.finest));
      }
    cycle =
      std::make_unique<LatticeCycle<dim>>(std::move(parts),
                                          parameters,
                                          coupling->is_empty() ? nullptr
                                                               : coupling.get(),
                                          coarsens && are_levels_useful,
                                          true);
  }



  template <int dim>
  void
  CoupledCycle<dim>::vmult(std::vector<VectorType>       &dst,
                           const std::vector<VectorType> &src) const
  {
    std::vector<VectorType *>       to;
    std::vector<const VectorType *> from;
    for (unsigned int part = 0; part < set_ups.size(); ++part)
      {
        to.push_back(&dst[part]);
        from.push_back(&src[part]);
      }
    cycle->vmult(to, from);
  }



  GREVILLE_INSTANTIATE_CLASS(CoupledCycle);
} // namespace greville
