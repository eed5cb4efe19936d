// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/damping.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Damping<dim>::Damping(const LoadParameters &parameters)
    : parameters(parameters)
  {}



  template <int dim>
  Tensor<1, dim>
  Damping<dim>::taken(const GridField<dim> &field, const unsigned int i) const
  {
    Tensor<1, dim> result;
    const double   m = field.lumped_mass.local_element(i);
    if (!(m > 0.))
      return result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double P = field.momentum[d].local_element(i);
        if (P != 0.)
          result[d] =
            factor() *
            std::copysign(std::abs(field.force[d].local_element(i)) / m, P);
      }
    return field.mass->free_part(i, result);
  }



  template <int dim>
  void
  Damping<dim>::damp(GridField<dim> &field) const
  {
    if (factor() == 0.)
      return;
    for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size(); ++i)
      {
        const Tensor<1, dim> change = taken(field, i);
        for (unsigned int d = 0; d < dim; ++d)
          field.acceleration[d].local_element(i) -= change[d];
      }
    field.mass->distribute_levels(field.acceleration);
  }



  template <int dim>
  double
  Damping<dim>::power(const GridField<dim>   &field,
                      const VectorField<dim> &momenta) const
  {
    double power = 0.;
    for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size(); ++i)
      power -= 0.5 * (taken(field, i) * values_at<dim>(momenta, i));
    return power;
  }



  GREVILLE_INSTANTIATE_CLASS(Damping);
} // namespace greville
