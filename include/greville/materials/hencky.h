#ifndef greville_materials_hencky_h
#define greville_materials_hencky_h

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <cmath>

/**
 * Logarithmic (Hencky) strains of symmetric 3D tensors. Left Cauchy-Green
 * tensors b = F F^T are kept as e = b - 1, which holds small strains to full
 * precision: the principal logarithmic strains are ln(1 + e_a) / 2.
 */
namespace greville
{
  /**
   * Three principal values.
   */
  using Principal = std::array<double, 3>;



  /**
   * The spectral decomposition A = sum_a values[a] n_a n_a^T of a symmetric
   * tensor, to round-off of its norm, also where values are close or equal.
   *
   * Without xz and yz (plane strain) it is closed: with m = (A_xx + A_yy) / 2,
   * d = (A_xx - A_yy) / 2 and r = sqrt(d^2 + A_xy^2) the values are m + r,
   * m - r, A_zz, and 2 n_1 n_1^T - 1 = ((d, A_xy), (A_xy, -d)) / r in the
   * plane. Else by Jacobi's cyclic rotations (Golub, Van Loan, Matrix
   * Computations, section 8.5). Values are in no order. Throws nothing; entries
   * that are not finite give values that are not finite.
   */
  class SpectralDecomposition
  {
  public:
    SpectralDecomposition(const dealii::SymmetricTensor<2, 3> &A)
      : plane(A.access_raw_entry(4) == 0. && A.access_raw_entry(5) == 0.)
    {
      if (plane)
        {
          const double mean =
            0.5 * (A.access_raw_entry(0) + A.access_raw_entry(1));
          const double difference =
            0.5 * (A.access_raw_entry(0) - A.access_raw_entry(1));
          const double xy     = A.access_raw_entry(3);
          const double radius = std::sqrt(difference * difference + xy * xy);
          values = {{mean + radius, mean - radius, A.access_raw_entry(2)}};
          if (radius > 0.)
            {
              const double inverse = 1. / radius;
              cosine               = difference * inverse;
              sine                 = xy * inverse;
            }
        }
      else
        diagonalize(A);
    }

    /**
     * The tensor sum_a v[a] n_a n_a^T.
     */
    dealii::SymmetricTensor<2, 3>
    assemble(const Principal &v) const
    {
      dealii::SymmetricTensor<2, 3> A;
      if (plane)
        {
          const double mean       = 0.5 * (v[0] + v[1]);
          const double difference = 0.5 * (v[0] - v[1]);
          A.access_raw_entry(0)   = mean + difference * cosine;
          A.access_raw_entry(1)   = mean - difference * cosine;
          A.access_raw_entry(2)   = v[2];
          A.access_raw_entry(3)   = difference * sine;
        }
      else
        for (unsigned int a = 0; a < 3; ++a)
          {
            const double x = vectors[0][a], y = vectors[1][a],
                         z = vectors[2][a];
            A.access_raw_entry(0) += v[a] * x * x;
            A.access_raw_entry(1) += v[a] * y * y;
            A.access_raw_entry(2) += v[a] * z * z;
            A.access_raw_entry(3) += v[a] * x * y;
            A.access_raw_entry(4) += v[a] * x * z;
            A.access_raw_entry(5) += v[a] * y * z;
          }
      return A;
    }

    Principal values;

  private:
    void
    diagonalize(const dealii::SymmetricTensor<2, 3> &A)
    {
      double a[3][3];
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          {
            a[i][j]       = A[i][j];
            vectors[i][j] = (i == j);
          }
      const double bound = 1e-32 * (A * A);
      for (unsigned int sweep = 0; sweep < 20; ++sweep)
        {
          if (!(a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2] >
                bound))
            break;
          rotate<0, 1>(a);
          rotate<0, 2>(a);
          rotate<1, 2>(a);
        }
      values = {{a[0][0], a[1][1], a[2][2]}};
    }

    // The rotation in the plane (p, q) that makes a[p][q] zero.
    template <unsigned int p, unsigned int q>
    void
    rotate(double (&a)[3][3])
    {
      constexpr unsigned int r   = 3 - p - q;
      const double           apq = a[p][q];
      if (!(apq * apq > 0.)) // may underflow
        return;
      const double theta = 0.5 * (a[q][q] - a[p][p]);
      const double root  = std::sqrt(theta * theta + apq * apq);
      const double t     = apq / (theta + std::copysign(root, theta));
      const double c = 1. / std::sqrt(1. + t * t), s = t * c;
      a[p][p] -= t * apq;
      a[q][q] += t * apq;
      a[p][q] = a[q][p] = 0.;
      const double arp = a[r][p], arq = a[r][q];
      a[r][p] = a[p][r] = c * arp - s * arq;
      a[r][q] = a[q][r] = s * arp + c * arq;
      for (unsigned int i = 0; i < 3; ++i)
        {
          const double vp = vectors[i][p], vq = vectors[i][q];
          vectors[i][p] = c * vp - s * vq;
          vectors[i][q] = s * vp + c * vq;
        }
    }

    const bool plane;
    double     cosine = 1., sine = 0.; // of twice the angle of n_1
    double     vectors[3][3];          // columns; not used in the plane
  };



  /**
   * b - 1 for the left Cauchy-Green tensor b = F F^T.
   */
  inline dealii::SymmetricTensor<2, 3>
  left_cauchy_green_less_one(const dealii::Tensor<2, 3> &F)
  {
    // Squares less one as (F_ii - 1) (F_ii + 1), without cancellation.
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



  /**
   * f b f^T - 1 from @p e = b - 1: the elastic left Cauchy-Green tensor at the
   * end of a step without plastic flow (less 1).
   */
  inline dealii::SymmetricTensor<2, 3>
  push_forward(const dealii::Tensor<2, 3>          &f,
               const dealii::SymmetricTensor<2, 3> &e)
  {
    // f (1 + e) f^T - 1 = f e f^T + (f f^T - 1).
    dealii::SymmetricTensor<2, 3> result = left_cauchy_green_less_one(f);
    const double xx = e.access_raw_entry(0), yy = e.access_raw_entry(1),
                 zz = e.access_raw_entry(2), xy = e.access_raw_entry(3),
                 xz = e.access_raw_entry(4), yz = e.access_raw_entry(5);
    if (f[0][2] == 0. && f[1][2] == 0. && f[2][0] == 0. && f[2][1] == 0. &&
        xz == 0. && yz == 0.)
      {
        const double x0 = f[0][0] * xx + f[0][1] * xy,
                     x1 = f[0][0] * xy + f[0][1] * yy,
                     y0 = f[1][0] * xx + f[1][1] * xy,
                     y1 = f[1][0] * xy + f[1][1] * yy;
        result.access_raw_entry(0) += x0 * f[0][0] + x1 * f[0][1];
        result.access_raw_entry(1) += y0 * f[1][0] + y1 * f[1][1];
        result.access_raw_entry(2) += f[2][2] * f[2][2] * zz;
        result.access_raw_entry(3) += x0 * f[1][0] + x1 * f[1][1];
        return result;
      }
    double m[3][3];
    for (unsigned int i = 0; i < 3; ++i)
      {
        m[i][0] = f[i][0] * xx + f[i][1] * xy + f[i][2] * xz;
        m[i][1] = f[i][0] * xy + f[i][1] * yy + f[i][2] * yz;
        m[i][2] = f[i][0] * xz + f[i][1] * yz + f[i][2] * zz;
      }
    const auto entry = [&](const unsigned int i, const unsigned int j) {
      return m[i][0] * f[j][0] + m[i][1] * f[j][1] + m[i][2] * f[j][2];
    };
    result.access_raw_entry(0) += entry(0, 0);
    result.access_raw_entry(1) += entry(1, 1);
    result.access_raw_entry(2) += entry(2, 2);
    result.access_raw_entry(3) += entry(0, 1);
    result.access_raw_entry(4) += entry(0, 2);
    result.access_raw_entry(5) += entry(1, 2);
    return result;
  }



  /**
   * Principal logarithmic strains ln(1 + e_a) / 2 from those of b - 1.
   */
  inline Principal
  logarithmic_strains(const Principal &e)
  {
    return {{0.5 * std::log1p(e[0]),
             0.5 * std::log1p(e[1]),
             e[2] == 0. ? 0. : 0.5 * std::log1p(e[2])}};
  }



  /**
   * The inverse: exp(2 strain) - 1.
   */
  inline Principal
  stretches_less_one(const Principal &strains)
  {
    return {{std::expm1(2. * strains[0]),
             std::expm1(2. * strains[1]),
             std::expm1(2. * strains[2])}};
  }
} // namespace greville

#endif
