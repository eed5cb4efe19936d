// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/boundary/constrained_functions.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<unsigned char>
  with_ghosts(const SplineSpace<dim>           &space,
              const std::vector<unsigned char> &owned)
  {
    VectorType values;
    space.initialize_vector(values);
    for (unsigned int i = 0; i < owned.size(); ++i)
      values.local_element(i) = owned[i];
    values.update_ghost_values();
    std::vector<unsigned char> result(space.owned_functions().size() +
                                      space.ghost_functions().size());
    for (unsigned int f = 0; f < result.size(); ++f)
      result[f] = static_cast<unsigned char>(values.local_element(f));
    return result;
  }



  template <int dim>
  std::vector<unsigned char>
  constrained_at_walls(const SplineSpace<dim> &space,
                       const Walls<dim>       &walls,
                       const unsigned int      component)
  {
    std::vector<unsigned char> constrained(space.owned_functions().size(), 0);
    for (const unsigned int i : walls.constrained_functions(space, component))
      constrained[i] = 1;
    return with_ghosts(space, constrained);
  }



  template <int dim>
  std::vector<unsigned char>
  constrained_components_at_walls(const SplineSpace<dim> &space,
                                  const Walls<dim>       &walls)
  {
    std::vector<unsigned char> bits(space.owned_functions().size() +
                                      space.ghost_functions().size(),
                                    0);
    for (unsigned int c = 0; c < dim; ++c)
      {
        const auto constrained = constrained_at_walls(space, walls, c);
        for (unsigned int f = 0; f < bits.size(); ++f)
          bits[f] |= constrained[f] << c;
      }
    return bits;
  }



  GREVILLE_INSTANTIATE(with_ghosts);
  template decltype(constrained_at_walls<2>) constrained_at_walls<2>;
  GREVILLE_INSTANTIATE(constrained_components_at_walls);
  template decltype(constrained_at_walls<3>) constrained_at_walls<3>;
} // namespace greville
