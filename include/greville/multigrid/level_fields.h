// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_level_fields_h
#define greville_multigrid_level_fields_h

#include <greville/base/vector_field.h>
#include <greville/multigrid/level_operator.h>

/**
 * Between vector fields of the grid, with a vector of coefficients for each
 * component, and the interleaved vectors of a LevelOperator with dim
 * components, which are zero but for the active functions.
 */
namespace greville
{
  /**
   * Collective. E^T @p field, a right-hand side for @p level from sums over
   * points, such as forces.
   */
  template <int dim>
  VectorType
  condense_field(const LevelOperator<dim> &level, const VectorField<dim> &field)
  {
    AssertDimension(level.n_components(), dim);
    VectorType result, component;
    initialize_vector<dim>(result, level);
    for (unsigned int c = 0; c < dim; ++c)
      {
        component = field[c];
        level.condense(component, c);
        for (unsigned int i = 0; i < component.locally_owned_size(); ++i)
          result.local_element(i * dim + c) = component.local_element(i);
      }
    return result;
  }



  /**
   * Collective. E @p x, all coefficients of the field that a vector of the
   * @p level stands for.
   */
  template <int dim>
  VectorField<dim>
  distribute_field(const LevelOperator<dim> &level, const VectorType &x)
  {
    AssertDimension(level.n_components(), dim);
    VectorField<dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      {
        level.space().initialize_vector(result[c]);
        for (unsigned int i = 0; i < result[c].locally_owned_size(); ++i)
          result[c].local_element(i) = x.local_element(i * dim + c);
        level.distribute(result[c], c);
      }
    return result;
  }
} // namespace greville

#endif
