// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_element_test_h
#define greville_materials_element_test_h

#include <deal.II/base/parameter_handler.h>

#include <greville/materials/material.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * What an element test begins with and how far it goes. Strains and stresses
   * are positive in compression, as in soil mechanics.
   */
  struct ElementTestParameters
  {
    static constexpr char section[] = "Element test";

    /**
     * Declare the section with these defaults in a file of simulations, which
     * have no use for its values.
     */
    static void
    declare_section(dealii::ParameterHandler &prm);

    /**
     * Those that a parameter file's @p text sets.
     */
    static ElementTestParameters
    from(const std::string &text);

    /// Axial and lateral, Pa; one number: both.
    std::vector<double> initial_stress = {1e5};
    /// Where the controlled strain turns or ends, one after the other.
    std::vector<double> strains = {0.2};
    /// From one of them to the next.
    unsigned int steps       = 200;
    double       strain_rate = 1e-2; // 1 / s
    /// At the start, of laws that have none of their own.
    double void_ratio = 0.7;
  };



  /**
   * The names of columns, and a row for the start and for each step.
   */
  struct ElementTestTable
  {
    std::vector<std::string>         names;
    std::vector<std::vector<double>> rows;

    /**
     * The values of a column.
     */
    std::vector<double>
    column(const std::string &name) const;
  };



  /**
   * The names of all tests, separated by '|'.
   */
  std::string
  element_test_names();



  /**
   * Lead a material point through a test of a soil laboratory. With F = S F_0
   * from the state at the start and z for the axis, a step sets S, and finds
   * what is unknown in it by Newton's method with Material::tangents():
   *
   * - isotropic: S = exp(-e / 3) 1 for the volumetric strain e;
   * - oedometer: S = diag(1, 1, exp(-e)) for the axial strain e;
   * - triaxial-drained: S = diag(l, l, exp(-e)), where l keeps the lateral
   *   stress;
   * - triaxial-undrained: S = diag(exp(e / 2), exp(e / 2), exp(-e)); the total
   *   lateral stress stays, and what the effective one, the law's, lacks is the
   *   pore pressure;
   * - simple-shear: S = 1 + e e_x e_z^T + (l - 1) e_z e_z^T for the shear e,
   *   where l keeps the axial stress, and lateral strains are zero.
   *
   * Columns: strain_axial = -ln S_zz, strain_volumetric = -ln(det S), and
   * strain_shear, which is 2 / 3 of the axial minus the lateral strain, or e of
   * simple shear; p = -tr(sigma) / 3, q, which is the axial minus the lateral
   * compression, or sqrt(3 J2) of simple shear, Pa; the void_ratio, of the law
   * if its history has one, else from det S with incompressible grains; the
   * pore_pressure, Pa; stress_axial (compression) and stress_shear, Pa; and the
   * history of the law.
   *
   * Throws dealii::ExcMessage with @p section, the section of the material, for
   * an unknown test, for parameters without a meaning, for a start that the law
   * cannot have, and where a step does not converge.
   */
  ElementTestTable
  run_element_test(const Material              &material,
                   const std::string           &section,
                   const std::string           &test,
                   const ElementTestParameters &parameters);
} // namespace greville

#endif
