// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/compatibility.h>

#include <string>

namespace greville
{
  /// The name of FMPM(K) in lists of masses.
  constexpr const char *fmpm_in_lists = "fmpm-K (K = 1, 2, ...)";

  /// Return K for the mass "fmpm-K", 1 for "lumped", 0 for other names.
  inline unsigned int
  n_fmpm_terms(const std::string &name)
  {
    if (name == "lumped")
      return 1;
    const std::string prefix = "fmpm-";
    const std::string number =
      name.substr(std::min(prefix.size(), name.size()));
    if (name.compare(0, prefix.size(), prefix) != 0 || number.empty() ||
        number.size() > 6 ||
        number.find_first_not_of("0123456789") != std::string::npos)
      return 0;
    return std::stoi(number);
  }



  /**
   * Extend @f$ x = M_L^{-1} b @f$, with the lumped mass @f$ M_L @f$, to the
   * series FMPM(K) of K = @p n_terms terms,
   * @f[ x = \sum_{j<K} (1 - M_L^{-1} M)^j M_L^{-1} b, @f]
   * by K - 1 steps @f$ x \leftarrow x + M_L^{-1} (b - M x) @f$ (@ref Nairn2021
   * "Nairn and Hammerquist, 2021"). Coefficients with a zero entry of
   * @p inverse_lumped do not change. @p matrix must have a vmult().
   *
   * Returns M times the sum of the first K - 1 terms, empty for K = 1. The sum
   * of the entries of M_L x is the sum of b at coefficients that change, plus
   * the sum of this product at coefficients that do not.
   */
  template <typename Matrix>
  VectorType
  add_fmpm_terms(VectorType        &x,
                 const VectorType  &b,
                 const Matrix      &matrix,
                 const VectorType  &inverse_lumped,
                 const unsigned int n_terms)
  {
    VectorType product;
    if (n_terms > 1)
      product.reinit(x, true);
    for (unsigned int j = 1; j < n_terms; ++j)
      {
        matrix.vmult(product, x);
        for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
          x.local_element(i) += inverse_lumped.local_element(i) *
                                (b.local_element(i) - product.local_element(i));
      }
    return product;
  }
} // namespace greville
