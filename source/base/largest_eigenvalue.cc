// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/eigenvectors.h>
#include <greville/base/largest_eigenvalue.h>

#include <array>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// A direction x with b = B^-1 x and S x.
    struct Direction
    {
      explicit Direction(const std::size_t n)
        : x(n)
        , b(n)
        , S_x(n)
      {}

      std::vector<double> x, b, S_x;
    };



    using Matrix3 = std::array<std::array<double, 3>, 3>;

    /// Return the largest eigenvalue of A c = theta G c and its vector c, for
    /// the first @p n rows. Linearly dependent directions are left out.
    double
    largest_ritz_value(const Matrix3         &A,
                       const Matrix3         &G,
                       const unsigned int     n,
                       std::array<double, 3> &c)
    {
      // The inverse of the Cholesky factor of G orthonormalizes the directions:
      // rows of Q.
      Matrix3 Q{};
      for (unsigned int i = 0; i < n; ++i)
        {
          if (!(G[i][i] > 0.))
            continue;
          std::array<double, 3> row{};
          row[i] = 1. / std::sqrt(G[i][i]);
          // Repeat for orthogonality to round-off.
          for (unsigned int repeat = 0; repeat < 2; ++repeat)
            for (unsigned int j = 0; j < i; ++j)
              {
                double product = 0.;
                for (unsigned int k = 0; k < n; ++k)
                  for (unsigned int l = 0; l < n; ++l)
                    product += row[k] * G[k][l] * Q[j][l];
                for (unsigned int k = 0; k < n; ++k)
                  row[k] -= product * Q[j][k];
              }
          double square = 0.;
          for (unsigned int k = 0; k < n; ++k)
            for (unsigned int l = 0; l < n; ++l)
              square += row[k] * G[k][l] * row[l];
          if (square > 1e-14)
            for (unsigned int k = 0; k < n; ++k)
              Q[i][k] = row[k] / std::sqrt(square);
        }
      SymmetricTensor<2, 3> projected;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = i; j < n; ++j)
          {
            double entry = 0.;
            for (unsigned int k = 0; k < n; ++k)
              for (unsigned int l = 0; l < n; ++l)
                entry += Q[i][k] * 0.5 * (A[k][l] + A[l][k]) * Q[j][l];
            projected[i][j] = entry;
          }
      const auto best =
        eigenvectors(projected, SymmetricTensorEigenvectorMethod::jacobi)[0];
      c = {};
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int k = 0; k < n; ++k)
          c[k] += best.second[i] * Q[i][k];
      return best.first;
    }
  } // namespace



  LargestEigenvalue
  largest_eigenvalue(const LinearAction        &multiply_by_S,
                     const LinearAction        &multiply_by_B,
                     const std::vector<double> &start,
                     const double               tolerance,
                     const unsigned int         max_products,
                     const MPI_Comm             comm)
  {
    // The vector, its residual and the last direction.
    const std::size_t        n = start.size();
    std::array<Direction, 3> directions{
      {Direction(n), Direction(0), Direction(0)}};
    Direction &vector = directions[0], &residual = directions[1],
              &last = directions[2];
    LargestEigenvalue result;

    // Compute the products of directions by G = B^-1 and by S.
    const auto find_products = [&](Matrix3 &A, Matrix3 &G) {
      std::vector<double> sums(12);
      for (std::size_t u = 0; u < n; ++u)
        for (unsigned int i = 0, k = 0; i < 3; ++i)
          for (unsigned int j = i; j < 3; ++j, k += 2)
            {
              sums[k] += directions[i].x[u] * directions[j].S_x[u];
              sums[k + 1] += directions[i].x[u] * directions[j].b[u];
            }
      Utilities::MPI::sum(sums, comm, sums);
      for (unsigned int i = 0, k = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j, k += 2)
          {
            A[i][j] = A[j][i] = sums[k];
            G[i][j] = G[j][i] = sums[k + 1];
          }
    };

    vector.b = start;
    multiply_by_B(vector.x, vector.b);
    multiply_by_S(vector.S_x, vector.x);
    result.n_products = 1;
    // The first product may need much memory to factorize a matrix.
    residual = last = Direction(n);

    unsigned int          n_directions = 1, n_small_changes = 0;
    std::array<double, 3> c{};
    while (true)
      {
        Matrix3 A, G;
        find_products(A, G);
        if (!(G[0][0] > 0.))
          break;
        const double before = result.value;
        result.value        = largest_ritz_value(A, G, n_directions, c);
        for (std::size_t u = 0; u < n; ++u)
          {
            const auto combine = [&](std::vector<double> Direction::*part) {
              double &x = (vector.*part)[u], &p = (last.*part)[u];
              p = c[1] * (residual.*part)[u] + c[2] * p;
              x = c[0] * x + p;
            };
            combine(&Direction::x);
            combine(&Direction::b);
            combine(&Direction::S_x);
          }
        n_directions = std::min(n_directions + 1, 3u);

        const double change = std::abs(result.value - before);
        n_small_changes =
          change <= tolerance * result.value ? n_small_changes + 1 : 0;
        result.converged = n_small_changes >= 2;
        if (result.converged || result.n_products >= max_products)
          break;

        for (std::size_t u = 0; u < n; ++u)
          residual.b[u] = vector.S_x[u] - result.value * vector.b[u];
        multiply_by_B(residual.x, residual.b);
        multiply_by_S(residual.S_x, residual.x);
        ++result.n_products;
      }
    result.x = std::move(vector.x);
    result.b = std::move(vector.b);
    return result;
  }
} // namespace greville
