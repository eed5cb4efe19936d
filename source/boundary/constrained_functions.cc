// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/boundary/constrained_functions.h>

namespace greville
{
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
  constrained_components_at_walls(const SplineSpace<dim> &space,
                                  const Walls<dim>       &walls)
  {
    std::vector<unsigned char> owned(space.owned_functions().size(), 0);
    for (unsigned int c = 0; c < dim; ++c)
      for (const unsigned int i : walls.constrained_functions(space, c))
        owned[i] |= 1 << c;
    return with_ghosts(space, owned);
  }



  template <int dim>
  std::vector<unsigned char>
  constrained_at_walls(const SplineSpace<dim> &space,
                       const Walls<dim>       &walls,
                       const unsigned int      component)
  {
    auto result = constrained_components_at_walls(space, walls);
    for (unsigned char &components : result)
      components = (components >> component) & 1;
    return result;
  }



  GREVILLE_INSTANTIATE(with_ghosts);
  GREVILLE_INSTANTIATE(constrained_at_walls);
  GREVILLE_INSTANTIATE(constrained_components_at_walls);
} // namespace greville
