// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_check_materials_h
#define greville_simulation_check_materials_h

#include <greville/particles/body_list.h>

#include <ostream>

namespace greville
{
  /**
   * The largest pure shear stress, Pa, that @p material has at rest without
   * pressure: what Material::initialize() accepts, found to 0.1 %. Infinite
   * where half of the shear modulus is below it, and zero for fluids and for
   * soil without cohesion.
   */
  double
  shear_strength(const Material &material);

  /**
   * Collective. Write density, speeds of pressure and shear waves,
   * ((K + 4 G / 3) / rho)^(1/2) and (G / rho)^(1/2), and shear_strength() of
   * the materials of @p bodies; and, where a number looks like one in another
   * unit, why it does: a density below 500 kg / m^3 with a @p gravity of 9 to
   * 11 m / s^2; a weight rho g H over the height H of a body that is more than
   * a fifth of K + 4 G / 3; or a strength that is not zero, and less than a
   * thousandth of this weight.
   */
  template <int dim>
  void
  check_materials(std::ostream                 &out,
                  const BodyList<dim>          &bodies,
                  const dealii::Tensor<1, dim> &gravity,
                  const MPI_Comm                comm);
} // namespace greville

#endif
