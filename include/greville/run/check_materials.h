// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>
#include <greville/points/body_list.h>

#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /// Return the largest pure shear stress, Pa, of @p material at rest under the
  /// @p pressure, Pa: the largest that Material::initialize() accepts, to 0.1
  /// %. Infinite if it exceeds half of the shear modulus, and zero for fluids
  /// and for soil without cohesion and pressure.
  double
  shear_strength(const Material &material, const double pressure = 0.);

  /// Write density, speeds of pressure and shear waves, ((K + 4 G / 3) /
  /// rho)^(1/2) and (G / rho)^(1/2), and shear_strength() of the materials of
  /// @p bodies.
  template <int dim>
  void
  print_materials(std::ostream &out, const BodyList<dim> &bodies);

  /// Return the largest difference between Material::tangents() and finite
  /// differences of update(), relative to the norm of the differences. The path
  /// is compression and shear by @p strain in @p dim dimensions from the state
  /// @p point, in ten steps of length MaterialPoint::dt.
  double
  tangent_error(const Material    &material,
                MaterialPoint      point,
                const double       strain,
                const unsigned int dim);

  /// Collective. Write tangent_error() along a path of 1 % strain in ten steps
  /// of 0.1 s from the initial state of a point of each body with the law Umat.
  /// Throws on all processes if the law throws a UmatFault.
  template <int dim>
  void
  print_tangents(std::ostream        &out,
                 const BodyList<dim> &bodies,
                 const MPI_Comm       comm);

  /**
   * Collective. Return a sentence for each input that may not be intended:
   * - values that may be in another unit: a density below 500 kg / m^3 with a
   *   gravity of 9 to 11 m / s^2; a weight rho g H over the height H of a body
   *   above a fifth of K + 4 G / 3; a nonzero strength below a thousandth of
   *   this weight; and a strength that grows with pressure like a friction
   *   angle of 0.1 to 0.9 degrees (0.1 to 0.9 radians are 6 to 52 degrees);
   * - a gravity of 9 to 11 m / s^2 without a negative component;
   * - a body with K0 that carries bodies without K0 on its 'Surface'.
   *
   * The check uses gravity at the end, because stages often let the weight
   * grow, and for K0 gravity at the start.
   */
  template <int dim>
  std::vector<std::string>
  input_notes(const BodyList<dim>        &bodies,
              const SimulationParameters &parameters,
              const MPI_Comm              comm);

  /// Return a sentence for each parameter that @p file gives twice with
  /// different values. The last value counts.
  std::vector<std::string>
  repeated_parameters(const std::string &file);
} // namespace greville
