// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_check_materials_h
#define greville_run_check_materials_h

#include <greville/parameters/simulation_parameters.h>
#include <greville/points/body_list.h>

#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The largest pure shear stress, Pa, that @p material has at rest with the
   * @p pressure, Pa: what Material::initialize() accepts, found to 0.1 %.
   * Infinite where half of the shear modulus is below it, and zero for fluids
   * and for soil without cohesion and pressure.
   */
  double
  shear_strength(const Material &material, const double pressure = 0.);

  /**
   * Write density, speeds of pressure and shear waves,
   * ((K + 4 G / 3) / rho)^(1/2) and (G / rho)^(1/2), and shear_strength() of
   * the materials of @p bodies.
   */
  template <int dim>
  void
  print_materials(std::ostream &out, const BodyList<dim> &bodies);

  /**
   * The largest difference between Material::tangents() and differences of
   * update(), over the norm of the latter, along a path of compression and
   * shear of @p strain in ten steps in @p dim dimensions from the state
   * @p point, each of length MaterialPoint::dt.
   */
  double
  tangent_error(const Material    &material,
                MaterialPoint      point,
                const double       strain,
                const unsigned int dim);

  /**
   * Collective. Write tangent_error() along a path of 1 % strain in ten
   * steps of 0.1 s from the initial state of a point of each body with the law
   * Umat. Throws on all processes if the law does what no law may (UmatFault).
   */
  template <int dim>
  void
  print_tangents(std::ostream        &out,
                 const BodyList<dim> &bodies,
                 const MPI_Comm       comm);

  /**
   * Collective. What may not be meant as it stands, a sentence each:
   * - numbers that look like ones in another unit: a density below
   *   500 kg / m^3 with a gravity of 9 to 11 m / s^2; a weight rho g H over the
   *   height H of a body that is more than a fifth of K + 4 G / 3; a strength
   *   that is not zero, and less than a thousandth of this weight; and one that
   *   grows with pressure as by a friction angle of 0.1 to 0.9 degrees, which
   *   are 6 to 52 degrees in radians;
   * - a gravity of 9 to 11 m / s^2 without a negative component;
   * - a body with K0 that has others, without K0, on its 'Surface'.
   *
   * Gravity is that at the end, as stages often let the weight grow, and for K0
   * that at the start.
   */
  template <int dim>
  std::vector<std::string>
  input_notes(const BodyList<dim>        &bodies,
              const SimulationParameters &parameters,
              const MPI_Comm              comm);

  /**
   * A sentence for each parameter that @p file gives twice, with different
   * values: the last one counts.
   */
  std::vector<std::string>
  repeated_parameters(const std::string &file);
} // namespace greville

#endif
