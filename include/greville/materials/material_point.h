// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_material_point_h
#define greville_materials_material_point_h

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <greville/materials/history.h>

namespace greville
{
  /**
   * What a material sees of one point in one time step. Tensors are 3D; in
   * plane strain the displacement along z is zero.
   */
  struct MaterialPoint
  {
    /// f = F_(n+1) F_n^-1 = 1 + dt grad v.
    dealii::Tensor<2, 3> increment;
    /// The deformation gradient F_(n+1) from the stress-free state.
    dealii::Tensor<2, 3> F;
    /// Its determinant, the ratio of volumes V / V0.
    double J = 1.;
    /// The length of the step, s.
    double dt = 0.;
    /// Material::strength_reduction() at the end of the step.
    double strength_reduction = 1.;
    /// The Cauchy stress, Pa: before, and after update() at the end of the
    /// step.
    dealii::SymmetricTensor<2, 3> stress;
    /// History, see Material::state_names(): before, and after update() at the
    /// end of the step.
    History<double> state{};
    /// Written by update(): the modulus K + 4 G / 3 of pressure waves, Pa.
    double wave_modulus = 0.;
    /// Where the point is, m, the time at the end of the step, s, and the
    /// dimension of the simulation, 2 or 3, for laws that users bring.
    dealii::Point<3> position;
    double           time = 0.;
    unsigned int     dim  = 3;
  };
} // namespace greville

#endif
