// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/extended_multigrid.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ExtendedMultigrid<dim>::ExtendedMultigrid(
    const OrderHierarchy<dim>  &orders,
    const ExtendedMass<dim>    &mass,
    const ConstrainedFunctions &constrained,
    const PMultigridParameters &parameters,
    const SmootherParameters   &smoother_parameters)
    : orders(orders)
    , mass(mass)
    , parameters(parameters)
    , smoother_parameters(smoother_parameters)
    , constrained(constrained)
  {
    orders.finest().initialize_vector(to);
    orders.finest().initialize_vector(from);
    for (unsigned int c = 0; c < dim; ++c)
      {
        const auto differs = [&](const Group &group) {
          return Utilities::MPI::max<unsigned int>(
                   constrained(orders.finest(), c) !=
                     constrained(orders.finest(), group.component),
                   orders.finest().communicator()) == 1;
        };
        group_of[c] = 0;
        while (group_of[c] < groups.size() && differs(groups[group_of[c]]))
          ++group_of[c];
        if (group_of[c] < groups.size())
          continue;
        // With this quadrature, the weights give exactly the matrix of the
        // material points.
        groups.push_back({c, {}, nullptr});
        for (unsigned int l = 0; l < orders.n_levels(); ++l)
          groups.back().levels.push_back(std::make_unique<MassLevel<dim>>(
            orders[l],
            DensityWeights<dim>(orders[l], 2 * orders[l].degree() + 1)));
      }
  }



  template <int dim>
  void
  ExtendedMultigrid<dim>::update(
    const CellFilling<dim>                           &filling,
    const bool                                        unknowns_changed,
    const std::function<void(DensityWeights<dim> &)> &fill)
  {
    for (Group &group : groups)
      {
        typename PMultigrid<dim>::Levels operators;
        for (unsigned int l = 0; l < group.levels.size(); ++l)
          {
            MassLevel<dim> &level = *group.levels[l];
            operators.push_back(&level);
            if (unknowns_changed)
              level.extend(Extension<dim>(orders[l], filling),
                           constrained(orders[l], group.component));
            if (&group == &groups[0])
              fill(level.weights());
            else
              level.weights() = groups[0].levels[l]->weights();
            level.assemble();
          }
        group.cycle =
          std::make_unique<PMultigrid<dim>>(operators,
                                            parameters,
                                            smoother_parameters,
                                            parameters.coarse_tolerance);
      }
  }



  template <int dim>
  void
  ExtendedMultigrid<dim>::vmult(VectorType        &z,
                                const VectorType  &r,
                                const unsigned int width,
                                const unsigned int n_columns) const
  {
    const auto &functions = mass.unknowns().unknown_functions();
    z                     = 0.;
    for (unsigned int c = 0; c < n_columns; ++c)
      {
        from = 0.;
        for (unsigned int u = 0; u < functions.size(); ++u)
          from.local_element(functions[u]) = r.local_element(u * width + c);
        groups[group_of[c % dim]].cycle->vmult(to, from);
        for (unsigned int u = 0; u < functions.size(); ++u)
          z.local_element(u * width + c) = to.local_element(functions[u]);
      }
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedMultigrid);
} // namespace greville
