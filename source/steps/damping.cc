// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/damping.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Damping<dim>::Damping(const LoadParameters      &parameters,
                        const Discretization<dim> &discretization)
    : parameters(parameters)
    , discretization(discretization)
  {}



  template <int dim>
  double
  Damping<dim>::taken(const VectorField<dim> &force,
                      const double            alpha,
                      const unsigned int      i,
                      const unsigned int      d) const
  {
    const double m = discretization.lumped_mass().local_element(i);
    const double P = discretization.momentum()[d].local_element(i);
    if (!(m > 0.) || P == 0. ||
        (discretization.mass().held_components(i) & (1 << d)))
      return 0.;
    return alpha * std::copysign(std::abs(force[d].local_element(i)) / m, P);
  }



  template <int dim>
  void
  Damping<dim>::damp(VectorField<dim>       &acceleration,
                     const VectorField<dim> &force) const
  {
    const double alpha = factor();
    if (alpha == 0.)
      return;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < force[d].locally_owned_size(); ++i)
        acceleration[d].local_element(i) -= taken(force, alpha, i, d);
  }



  template <int dim>
  double
  Damping<dim>::power(const VectorField<dim> &momenta,
                      const VectorField<dim> &force) const
  {
    const double alpha = factor();
    double       power = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < force[d].locally_owned_size(); ++i)
        power -= 0.5 * taken(force, alpha, i, d) * momenta[d].local_element(i);
    return power;
  }



  template class Damping<2>;
  template class Damping<3>;
} // namespace greville
