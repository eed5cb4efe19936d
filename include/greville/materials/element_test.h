// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/materials/material.h>

#include <string>
#include <vector>

namespace greville
{
  /// The parameters of an element test: its initial state and its path. Strains
  /// and stresses are positive in compression, as in soil mechanics.
  struct ElementTestParameters
  {
    static constexpr char section[] = "Element test";

    void
    declare(dealii::ParameterHandler &prm);

    /// The axial and lateral stress, Pa; one number sets both.
    std::vector<double> initial_stress = {1e5};
    /// The values at which the controlled strain reverses or ends, in order.
    std::vector<double> strains = {0.2};
    /// The number of steps between two values of strains.
    unsigned int steps       = 200;
    double       strain_rate = 1e-2; // 1 / s
    /// The initial void ratio, for laws without a void ratio of their own.
    double void_ratio = 0.7;
  };



  /// The results: the names of columns, a row for the start, and a row for each
  /// step.
  struct ElementTestTable
  {
    std::vector<std::string>         names;
    std::vector<std::vector<double>> rows;

    /// Return the values of a column.
    std::vector<double>
    column(const std::string &name) const;
  };



  /// Return the names of all tests, separated by '|'.
  std::string
  element_test_names();



  /**
   * Apply the strain path of a soil laboratory test to a material point. With F
   * = S F_0 from the state at the start and z for the axis, a step sets S. It
   * finds the unknown entry of S by Newton's method with Material::tangents():
   *
   * - isotropic: S = exp(-e / 3) 1 for the volumetric strain e;
   * - oedometer: S = diag(1, 1, exp(-e)) for the axial strain e;
   * - triaxial-drained: S = diag(l, l, exp(-e)), where l keeps the lateral
   *   stress;
   * - triaxial-undrained: S = diag(exp(e / 2), exp(e / 2), exp(-e)); the total
   *   lateral stress is constant, and the pore pressure is the difference
   * between the total and the effective stress, which is the stress of the law;
   * - simple-shear: S = 1 + e e_x e_z^T + (l - 1) e_z e_z^T for the shear e,
   *   where l keeps the axial stress, and lateral strains are zero.
   *
   * Columns: strain_axial = -ln S_zz, strain_volumetric = -ln(det S), and
   * strain_shear, which is 2 / 3 of the axial minus the lateral strain, or e in
   * simple shear; p = -tr(sigma) / 3; q, which is the axial minus the lateral
   * compression, or sqrt(3 J2) in simple shear, Pa; the void_ratio, taken from
   * the history of the law if it has one, otherwise from det S with
   * incompressible grains; the pore_pressure, Pa; stress_axial (compression)
   * and stress_shear, Pa; and the history of the law.
   *
   * Throws dealii::ExcMessage, with the @p section of the material, for an
   * unknown test, for invalid parameters, for an initial state that the law
   * does not allow, and if a step does not converge.
   */
  ElementTestTable
  run_element_test(const Material              &material,
                   const std::string           &section,
                   const std::string           &test,
                   const ElementTestParameters &parameters);
} // namespace greville
