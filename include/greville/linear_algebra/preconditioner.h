// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/compatibility.h>

namespace greville
{
  /// An approximate inverse S of a matrix A, to be used as the smoother x += S
  /// (b - A x) or inside a Krylov method.
  class Preconditioner
  {
  public:
    virtual ~Preconditioner() = default;

    /// dst = S src.
    virtual void
    vmult(VectorType &dst, const VectorType &src) const = 0;

    /// dst = S^T src. The default is for symmetric S.
    virtual void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }
  };



  /// S = D^-1 for a diagonal matrix D: Jacobi's method if used in conjugate
  /// gradients.
  class DiagonalPreconditioner : public Preconditioner
  {
  public:
    DiagonalPreconditioner(const VectorType &diagonal)
      : inverse_diagonal(diagonal)
    {
      for (double &entry : inverse_diagonal)
        entry = 1. / entry;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      for (unsigned int i = 0; i < src.locally_owned_size(); ++i)
        dst.local_element(i) =
          inverse_diagonal.local_element(i) * src.local_element(i);
    }

  protected:
    VectorType inverse_diagonal;
  };
} // namespace greville
