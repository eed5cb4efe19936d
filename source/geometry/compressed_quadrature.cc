// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/compatibility.h>
#include <greville/geometry/compressed_quadrature.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Normalized Legendre polynomials on the box of the points. Entry i of
    /// value(x) is the i-th polynomial of total degree at most q.
    template <int dim>
    class Polynomials
    {
    public:
      Polynomials(const std::vector<WeightedPoint<dim>> &points,
                  const unsigned int                     degree)
        : degree(degree)
      {
        lower = upper = points[0].x;
        for (const auto &point : points)
          for (unsigned int d = 0; d < dim; ++d)
            {
              lower[d] = std::min(lower[d], point.x[d]);
              upper[d] = std::max(upper[d], point.x[d]);
            }
        for (unsigned int d = 0; d < dim; ++d)
          one_dimensional[d].resize(degree + 1);
      }

      void
      evaluate(const Point<dim> &x, double *values)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double half = 0.5 * (upper[d] - lower[d]);
            const double t =
              half > 0. ? (x[d] - 0.5 * (lower[d] + upper[d])) / half : 0.;
            auto &P = one_dimensional[d];
            P[0]    = 1.;
            if (degree > 0)
              P[1] = t;
            for (unsigned int k = 1; k < degree; ++k)
              P[k + 1] = ((2 * k + 1) * t * P[k] - k * P[k - 1]) / (k + 1);
            for (unsigned int k = 0; k <= degree; ++k)
              P[k] *= std::sqrt(2. * k + 1.);
          }
        for (unsigned int k = 0; k <= (dim == 3 ? degree : 0); ++k)
          for (unsigned int j = 0; j + k <= degree; ++j)
            for (unsigned int i = 0; i + j + k <= degree; ++i)
              *values++ = one_dimensional[0][i] * one_dimensional[1][j] *
                          (dim == 3 ? one_dimensional[dim - 1][k] : 1.);
      }

    private:
      unsigned int                         degree;
      Point<dim>                           lower, upper;
      std::array<std::vector<double>, dim> one_dimensional;
    };



    /// Return the product of two vectors from entry @p begin on, by eight sums
    /// at a time.
    double
    product(const std::vector<double> &a,
            const std::vector<double> &b,
            const std::size_t          begin = 0)
    {
      std::array<double, 8> sums{};
      std::size_t           i = begin;
      for (; i + 8 <= a.size(); i += 8)
        for (unsigned int k = 0; k < 8; ++k)
          sums[k] += a[i + k] * b[i + k];
      for (; i < a.size(); ++i)
        sums[0] += a[i] * b[i];
      return ((sums[0] + sums[1]) + (sums[2] + sums[3])) +
             ((sums[4] + sums[5]) + (sums[6] + sums[7]));
    }

    void
    add(std::vector<double>       &a,
        const double               factor,
        const std::vector<double> &b,
        const std::size_t          begin = 0)
    {
      for (std::size_t i = begin; i < a.size(); ++i)
        a[i] += factor * b[i];
    }



    /// Return an orthonormal basis of the orthogonal complement of the
    /// @p vectors, by Householder reflections. There are fewer vectors than
    /// entries in each. The vectors are overwritten.
    std::vector<std::vector<double>>
    orthogonal_complement(std::vector<std::vector<double>> &vectors)
    {
      const std::size_t n = vectors[0].size(), m = vectors.size();
      for (std::size_t k = 0; k < m; ++k)
        {
          // Replace vector k by the reflection that maps it to e_k.
          auto &v = vectors[k];
          std::fill(v.begin(), v.begin() + k, 0.);
          const double norm = std::sqrt(product(v, v));
          if (norm == 0.)
            continue;
          v[k] += v[k] < 0. ? -norm : norm;
          const double scale = std::sqrt(2. / product(v, v));
          for (double &entry : v)
            entry *= scale;
          for (std::size_t l = k + 1; l < m; ++l)
            add(vectors[l], -product(v, vectors[l], k), v, k);
        }
      std::vector<std::vector<double>> result(n - m, std::vector<double>(n));
      for (std::size_t i = 0; i < result.size(); ++i)
        {
          result[i][m + i] = 1.;
          for (std::size_t k = m; k-- > 0;)
            add(result[i], -product(vectors[k], result[i], k), vectors[k], k);
        }
      return result;
    }
  } // namespace



  template <int dim>
  unsigned int
  n_polynomials(const unsigned int degree)
  {
    return dim == 2 ? (degree + 1) * (degree + 2) / 2
                    : (degree + 1) * (degree + 2) * (degree + 3) / 6;
  }



  template <int dim>
  void
  compress_quadrature(std::vector<WeightedPoint<dim>> &points,
                      const unsigned int               degree)
  {
    const std::size_t m = n_polynomials<dim>(degree);
    if (points.size() <= m)
      return;
    Polynomials<dim>    polynomials(points, degree);
    std::vector<double> values(m);
    // Remove several points at a time, from the end.
    while (points.size() > m)
      {
        const std::size_t                n     = std::min(points.size(), 2 * m);
        const std::size_t                first = points.size() - n;
        std::vector<std::vector<double>> moments(m, std::vector<double>(n));
        for (std::size_t i = 0; i < n; ++i)
          {
            polynomials.evaluate(points[first + i].x, values.data());
            for (std::size_t k = 0; k < m; ++k)
              moments[k][i] = values[k];
          }
        auto complement = orthogonal_complement(moments);
        for (std::size_t l = 0; l < complement.size(); ++l)
          {
            const auto &direction = complement[l];
            std::size_t next      = n;
            double      smallest  = 0.;
            for (std::size_t i = 0; i < n; ++i)
              if (points[first + i].weight > 0. && direction[i] != 0.)
                {
                  const double step =
                    points[first + i].weight / std::abs(direction[i]);
                  if (next == n || step < smallest)
                    {
                      next     = i;
                      smallest = step;
                    }
                }
            if (next == n)
              continue;
            const double step = points[first + next].weight / direction[next];
            for (std::size_t i = 0; i < n; ++i)
              points[first + i].weight =
                std::max(0., points[first + i].weight - step * direction[i]);
            points[first + next].weight = 0.;
            for (std::size_t other = l + 1; other < complement.size(); ++other)
              {
                const double factor = complement[other][next] / direction[next];
                add(complement[other], -factor, direction);
                complement[other][next] = 0.;
              }
          }
        points.erase(std::remove_if(points.begin() + first,
                                    points.end(),
                                    [](const auto &point) {
                                      return point.weight <= 0.;
                                    }),
                     points.end());
        if (points.size() == first + n)
          break; // only if weights are not finite
      }
  }



  GREVILLE_INSTANTIATE(n_polynomials);
  GREVILLE_INSTANTIATE(compress_quadrature);
} // namespace greville
