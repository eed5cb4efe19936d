// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <greville/materials/spectral_decomposition.h>

/// Logarithmic (Hencky) strains of symmetric 3D tensors. Left Cauchy-Green
/// tensors b = F F^T are stored as e = b - 1, which keeps small strains at full
/// precision. The principal logarithmic strains are ln(1 + e_a) / 2.
namespace greville
{
  using Principal = std::array<double, 3>;



  /// Return b - 1 for the left Cauchy-Green tensor b = F F^T.
  inline dealii::SymmetricTensor<2, 3>
  left_cauchy_green_less_one(const dealii::Tensor<2, 3> &F)
  {
    // Compute squares less one as (F_ii - 1) (F_ii + 1), without cancellation.
    dealii::SymmetricTensor<2, 3> e;
    const double h0 = F[0][0] - 1., h1 = F[1][1] - 1., h2 = F[2][2] - 1.;
    e.access_raw_entry(0) =
      h0 * (F[0][0] + 1.) + F[0][1] * F[0][1] + F[0][2] * F[0][2];
    e.access_raw_entry(1) =
      h1 * (F[1][1] + 1.) + F[1][0] * F[1][0] + F[1][2] * F[1][2];
    e.access_raw_entry(2) =
      h2 * (F[2][2] + 1.) + F[2][0] * F[2][0] + F[2][1] * F[2][1];
    e.access_raw_entry(3) =
      F[0][0] * F[1][0] + F[0][1] * F[1][1] + F[0][2] * F[1][2];
    e.access_raw_entry(4) =
      F[0][0] * F[2][0] + F[0][1] * F[2][1] + F[0][2] * F[2][2];
    e.access_raw_entry(5) =
      F[1][0] * F[2][0] + F[1][1] * F[2][1] + F[1][2] * F[2][2];
    return e;
  }



  /// Return the principal logarithmic strains ln(1 + e_a) / 2 from the
  /// principal values e_a of b - 1, for one or several points.
  template <typename Number>
  std::array<Number, 3>
  logarithmic_strains(const std::array<Number, 3> &e)
  {
    return {{0.5 * log_of_one_plus(e[0]),
             0.5 * log_of_one_plus(e[1]),
             0.5 * log_of_one_plus(e[2])}};
  }



  /// Return the inverse function: exp(2 strain) - 1.
  template <typename Number>
  std::array<Number, 3>
  stretches_less_one(const std::array<Number, 3> &strains)
  {
    return {{exp_less_one(Number(2. * strains[0])),
             exp_less_one(Number(2. * strains[1])),
             exp_less_one(Number(2. * strains[2]))}};
  }



  /// The spectral decomposition of one symmetric tensor.
  class Spectrum : public SpectralDecomposition<double>
  {
  public:
    Spectrum(const dealii::SymmetricTensor<2, 3> &A)
      : SpectralDecomposition<double>(entries_of(A))
    {}

    /// Return the tensor with other values and the same directions.
    dealii::SymmetricTensor<2, 3>
    tensor(const Principal &v) const
    {
      dealii::SymmetricTensor<2, 3> A;
      const Entries                 entries = assemble(v);
      for (unsigned int i = 0; i < 6; ++i)
        A.access_raw_entry(i) = entries[i];
      return A;
    }

  private:
    static Entries
    entries_of(const dealii::SymmetricTensor<2, 3> &A)
    {
      Entries entries;
      for (unsigned int i = 0; i < 6; ++i)
        entries[i] = A.access_raw_entry(i);
      return entries;
    }
  };
} // namespace greville
