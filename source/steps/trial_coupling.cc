// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/trial_contacts.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::unique_ptr<LatticeCoupling<dim>>
  TrialContacts<dim>::coupling() const
  {
    using Weight = typename LatticeCoupling<dim>::Weight;
    auto result  = std::make_unique<LatticeCoupling<dim>>();
    for (unsigned int c = 0; c < tangents.size(); ++c)
      {
        const ContactTangent<dim> &tangent = tangents[c];
        if (!tangent.has_keys())
          continue;
        std::vector<Tensor<2, dim>> stiffness;
        for (const auto &key : tangent.own_keys())
          stiffness.push_back(weight * share * key.symmetric);
        result->add_keys(stiffness);
        for (const Side &side : sides)
          {
            if (side.contact != c)
              continue;
            const TangentSystem<dim> &system = steps[side.part]->system;
            const InterleavedLayout  &layout =
              *system.finest().extended().unknowns().unknown_layout();
            std::vector<Weight> weights;
            system.surfaces().for_each_weight(
              points_of(side),
              system.finest(),
              [&](const std::size_t   s,
                  const unsigned int  u,
                  const double        N,
                  const unsigned char constrained) {
                tangent.for_each_share(
                  side.begin + s,
                  [&](const std::uint64_t key, const double of_key) {
                    weights.push_back(
                      {key, layout.global_number(u), of_key * N, constrained});
                  });
              });
            std::vector<double> factors;
            for (const auto &key : tangent.own_keys())
              factors.push_back((side.side == 0 ? 1. : -1.) *
                                key.inverse_weights[side.side]);
            result->add_weights(side.part, layout, weights, factors);
          }
      }
    return result;
  }



  template <int dim>
  double
  TrialContacts<dim>::sum_of_stiffness() const
  {
    double sum = 0.;
    for (const ContactTangent<dim> &tangent : tangents)
      for (const auto &key : tangent.own_keys())
        sum += trace(key.symmetric);
    return Utilities::MPI::sum(sum, contacts.comm);
  }



  GREVILLE_INSTANTIATE_CLASS(TrialContacts);
} // namespace greville
