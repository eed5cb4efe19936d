// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <greville/materials/history.h>

namespace greville
{
  /// The data of one point in one time step that a material reads and writes.
  /// Tensors are 3D; in plane strain the displacement along z is zero.
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
    /// The Cauchy stress, Pa, at the beginning of the step; after update(), at
    /// its end.
    dealii::SymmetricTensor<2, 3> stress;
    /// The history at the beginning of the step; after update(), at its end.
    /// See Material::state_names().
    History<double> state{};
    /// The modulus K + 4 G / 3 of pressure waves, Pa, written by update().
    double wave_modulus = 0.;
    /// For user-defined laws: the position, m, the time at the end of the step,
    /// s, and the dimension of the simulation, 2 or 3.
    dealii::Point<3> position;
    double           time = 0.;
    unsigned int     dim  = 3;
  };
} // namespace greville
