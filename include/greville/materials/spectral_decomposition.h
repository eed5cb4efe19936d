// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/lanes.h>

#include <array>

namespace greville
{
  /**
   * The spectral decomposition A = sum_a values[a] n_a n_a^T of a symmetric
   * tensor with the entries (xx, yy, zz, xy, xz, yz), up to round-off of its
   * norm, also if values are close or equal. It takes one tensor (Number is
   * double) or several at once (Lanes), without iterations of variable length:
   *
   * Let m = tr(A) / 3, B = (A - m 1) / s with s such that B : B = 6. The values
   * t of B solve t^3 - 3 t = det B, |det B| <= 2. The one of largest magnitude
   * has sqrt(3) <= |t| <= 2, differs from the other two by at least sqrt(3),
   * and depends smoothly on det B. Newton's method finds it from the value of a
   * polynomial. The adjugate of B - t 1 is a multiple of n n^T, of norm 6 to 9,
   * so its largest column gives the direction n. The remaining tensor in the
   * plane normal to n is decomposed as below. (@ref Eberly2014 "Eberly, 2014",
   * does the same, beginning with the cosine.)
   *
   * Without xz and yz (plane strain), n is z and m need not be subtracted: with
   * m = (A_xx + A_yy) / 2, d = (A_xx - A_yy) / 2 and r = sqrt(d^2 + A_xy^2) the
   * values are m + r, m - r, A_zz, and 2 n_1 n_1^T - 1 = ((d, A_xy), (A_xy,
   * -d)) / r in the plane.
   *
   * Values have no order. Throws nothing; entries that are not finite give
   * values that are not finite. Tensors whose deviator is below 1e-150 count as
   * isotropic.
   */
  template <typename Number>
  class SpectralDecomposition
  {
  public:
    using Entries = std::array<Number, 6>;

    SpectralDecomposition(const Entries &A)
      : plane(is_true_everywhere(A[4] == 0.) && is_true_everywhere(A[5] == 0.))
    {
      if (plane)
        {
          decompose_in_plane(A[0], A[1], A[3]);
          values[2] = A[2];
        }
      else
        decompose(A);
    }

    /// Return the tensor sum_a v[a] n_a n_a^T.
    Entries
    assemble(const std::array<Number, 3> &v) const
    {
      const Number mean       = 0.5 * (v[0] + v[1]);
      const Number difference = 0.5 * (v[0] - v[1]);
      const Number c = difference * cosine, s = difference * sine;
      if (plane)
        return {{mean + c, mean - c, v[2], s, Number(0.), Number(0.)}};
      // mean (1 - n n^T) + v_2 n n^T + c (u u^T - w w^T) + s (u w^T + w u^T)
      // with u, w the directions 0 and 1 of the plane.
      const Number rest = v[2] - mean;
      Entries      A;
      for (unsigned int k = 0; k < 6; ++k)
        {
          const unsigned int i = entry_rows[k], j = entry_columns[k];
          A[k] = rest * n[i] * n[j] + (c * u[i] + s * w[i]) * u[j] +
                 (s * u[i] - c * w[i]) * w[j];
          if (k < 3)
            A[k] += mean;
        }
      return A;
    }

    /// Return the directions n_0, n_1, n_2, of unit length, up to their signs.
    std::array<std::array<Number, 3>, 3>
    directions() const
    {
      using std::sqrt;
      // Compute half the angle from the larger of its cosine and sine.
      const auto   near   = cosine >= 0.;
      const Number larger = sqrt(0.5 + 0.5 * choose(near, cosine, -cosine));
      const Number other  = 0.5 * sine / larger;
      const Number c      = choose(near, larger, other),
                   s      = choose(near, other, larger);
      const Number zero   = 0.;
      if (plane)
        return {{{{c, s, zero}}, {{-s, c, zero}}, {{zero, zero, Number(1.)}}}};
      return {
        {{{c * u[0] + s * w[0], c * u[1] + s * w[1], c * u[2] + s * w[2]}},
         {{c * w[0] - s * u[0], c * w[1] - s * u[1], c * w[2] - s * u[2]}},
         n}};
    }

    std::array<Number, 3> values;

  private:
    // Compute the first two values and their directions.
    void
    decompose_in_plane(const Number &xx, const Number &yy, const Number &xy)
    {
      using std::sqrt;
      const Number mean       = 0.5 * (xx + yy);
      const Number difference = 0.5 * (xx - yy);
      const Number square     = difference * difference + xy * xy;
      const Number radius     = sqrt(square);
      const Number inverse    = 1. / choose(radius > 0., radius, Number(1.));
      cosine    = choose(radius > 0., difference * inverse, Number(1.));
      sine      = xy * inverse;
      values[0] = mean + radius;
      values[1] = mean - radius;
    }

    void
    decompose(const Entries &A)
    {
      using std::abs;
      using std::sqrt;
      const Number mean = (A[0] + A[1] + A[2]) * (1. / 3.);
      Entries      B    = A;
      for (unsigned int k = 0; k < 3; ++k)
        B[k] -= mean;
      const Number square = (B[0] * B[0] + B[1] * B[1] + B[2] * B[2]) * 0.5 +
                            B[3] * B[3] + B[4] * B[4] + B[5] * B[5];
      const Number scale =
        choose(square < 1e-300, Number(1.), sqrt(square * (1. / 3.)));
      const Number inverse_scale = 1. / scale;
      for (Number &entry : B)
        entry *= inverse_scale;

      // t^3 - 3 t = |det B|. The polynomial through t = sqrt(3) and t = 2 has
      // an error below 1e-2; each step squares the error and divides it by 2.
      const Number determinant = B[0] * (B[1] * B[2] - B[5] * B[5]) -
                                 B[3] * (B[3] * B[2] - B[5] * B[4]) +
                                 B[4] * (B[3] * B[5] - B[1] * B[4]);
      const Number h = abs(determinant);
      Number t = 1.7320508075688772 + h * (1. / 6. - h * 0.016346035225553);
      for (unsigned int i = 0; i < 3; ++i)
        t -= ((t * t - 3.) * t - h) / (3. * (t * t - 1.));
      t = choose(determinant < 0., -t, t);

      // Take the largest column of the adjugate of B - t 1.
      const Number x = B[0] - t, y = B[1] - t, z = B[2] - t;
      const Number xx = y * z - B[5] * B[5], yy = x * z - B[4] * B[4],
                   zz = x * y - B[3] * B[3], xy = B[4] * B[5] - B[3] * z,
                   xz = B[3] * B[5] - B[4] * y, yz = B[3] * B[4] - B[5] * x;
      const auto first    = xx >= yy && xx >= zz;
      const auto second   = yy >= zz;
      n[0]                = choose(first, xx, choose(second, xy, xz));
      n[1]                = choose(first, xy, choose(second, yy, yz));
      n[2]                = choose(first, xz, choose(second, yz, zz));
      const Number length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
      const Number factor = 1. / sqrt(choose(length > 0., length, Number(1.)));
      for (Number &entry : n)
        entry *= factor;
      n[2] = choose(length == 0., Number(1.), n[2]); // isotropic

      // Two directions normal to n (T. Duff et al., Building an Orthonormal
      // Basis, Revisited, 2017).
      const Number sign = choose(n[2] < 0., Number(-1.), Number(1.));
      const Number a = -1. / (sign + n[2]), b = n[0] * n[1] * a;
      u = {{1. + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}};
      w = {{b, sign + n[1] * n[1] * a, -n[1]}};
      const auto times = [&](const std::array<Number, 3> &v) {
        return std::array<Number, 3>{{B[0] * v[0] + B[3] * v[1] + B[4] * v[2],
                                      B[3] * v[0] + B[1] * v[1] + B[5] * v[2],
                                      B[4] * v[0] + B[5] * v[1] + B[2] * v[2]}};
      };
      const auto dot = [](const std::array<Number, 3> &p,
                          const std::array<Number, 3> &q) {
        return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
      };
      const auto Bu = times(u), Bw = times(w);
      decompose_in_plane(dot(u, Bu), dot(w, Bw), dot(u, Bw));
      values[2] = dot(n, times(n));
      for (Number &value : values)
        value = mean + scale * value;
    }

    const bool plane;
    Number cosine, sine; // cosine and sine of twice the angle of direction 0
    std::array<Number, 3> n, u, w; // not used in the plane
  };
} // namespace greville
