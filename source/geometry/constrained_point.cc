// SPDX-License-Identifier: LGPL-2.1-or-later

#include "constrained_point.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace internal
  {
    template <int dim>
    Derivatives<dim>
    derivatives(const LevelSet<dim> &level_set,
                const Point<dim>    &y,
                const double         length,
                const bool           with_hessian)
    {
      Derivatives<dim> result;
      result.value = level_set.value(y);
      if (level_set.kind == LevelSet<dim>::plane)
        result.gradient = level_set.as_plane.normal;
      else if (level_set.kind == LevelSet<dim>::quadric)
        {
          result.gradient =
            level_set.metric * (y - level_set.center) / level_set.radius;
          result.hessian = level_set.metric / level_set.radius;
        }
      else
        {
          // Of the first derivative of sixth and fourth order, of the second.
          constexpr double sixth[3]  = {3. / 4., -3. / 20., 1. / 60.};
          constexpr double fourth[3] = {2. / 3., -1. / 12., 0.};
          constexpr double second[3] = {3. / 2., -3. / 20., 1. / 90.};
          double           last      = std::numeric_limits<double>::max();
          double           step = 0.01 * length, best_step = step;
          for (unsigned int k = 0; k < 10; ++k, step /= 4.)
            {
              Tensor<1, dim> gradient, lower_order, curvature;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  for (int s = 1; s <= 3; ++s)
                    {
                      Point<dim> left = y, right = y;
                      left[d] -= s * step;
                      right[d] += s * step;
                      const double a = level_set.value(left),
                                   b = level_set.value(right);
                      gradient[d] += sixth[s - 1] * (b - a) / step;
                      lower_order[d] += fourth[s - 1] * (b - a) / step;
                      curvature[d] += second[s - 1] *
                                      (b + a - 2. * result.value) /
                                      (step * step);
                    }
                }
              const double error = (gradient - lower_order).norm();
              // Round-off grows with smaller steps.
              if (error >= last)
                break;
              result.gradient = gradient;
              best_step       = step;
              for (unsigned int d = 0; d < dim; ++d)
                result.hessian[d][d] = curvature[d];
              if (error <= 1e-9 * gradient.norm() || error > last / 4.)
                break;
              last = error;
            }
          if (with_hessian)
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int e = d + 1; e < dim; ++e)
                {
                  double sum = 0.;
                  for (const int i : {-1, 1})
                    for (const int j : {-1, 1})
                      {
                        Point<dim> shifted = y;
                        shifted[d] += i * best_step;
                        shifted[e] += j * best_step;
                        sum += i * j * level_set.value(shifted);
                      }
                  result.hessian[d][e] = sum / (4. * best_step * best_step);
                }
        }
      return result;
    }



    template <int dim>
    bool
    ConstrainedPoint<dim>::combine(
      const std::array<Tensor<1, dim>, dim> &gradients,
      const std::array<double, dim>         &products,
      std::array<double, dim>               &coefficients,
      Tensor<1, dim>                        &sum) const
    {
      // Cholesky's factors of the products of gradients.
      double factor[dim][dim] = {};
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          {
            double entry = gradients[i] * gradients[j];
            for (unsigned int k = 0; k < j; ++k)
              entry -= factor[i][k] * factor[j][k];
            if (i == j)
              {
                if (!(entry > 1e-14 * gradients[i].norm_square()))
                  return false;
                factor[i][i] = std::sqrt(entry);
              }
            else
              factor[i][j] = entry / factor[j][j];
          }
      coefficients = products;
      for (unsigned int i = 0; i < n; ++i)
        {
          for (unsigned int k = 0; k < i; ++k)
            coefficients[i] -= factor[i][k] * coefficients[k];
          coefficients[i] /= factor[i][i];
        }
      sum = 0.;
      for (unsigned int i = n; i-- > 0;)
        {
          for (unsigned int k = i + 1; k < n; ++k)
            coefficients[i] -= factor[k][i] * coefficients[k];
          coefficients[i] /= factor[i][i];
          sum += coefficients[i] * gradients[i];
        }
      return true;
    }



    template <int dim>
    bool
    ConstrainedPoint<dim>::restore(Point<dim> &y) const
    {
      std::array<Tensor<1, dim>, dim> gradients;
      std::array<double, dim>         values{}, coefficients{};
      const auto                      error_at = [&](const Point<dim> &z) {
        double error = 0.;
        for (unsigned int i = 0; i < n; ++i)
          {
            values[i] = level_sets[i]->value(z);
            error = std::max(error, std::abs(values[i]) / gradients[i].norm());
          }
        return error;
      };
      const double size = y.norm() + length;
      for (unsigned int iteration = 0; iteration < 50; ++iteration)
        {
          for (unsigned int i = 0; i < n; ++i)
            {
              gradients[i] =
                derivatives(*level_sets[i], y, length, false).gradient;
              if (!(gradients[i].norm() > 0.))
                return false;
            }
          const double error = error_at(y);
          if (error <= 1e-16 * size)
            return true;
          Tensor<1, dim> step;
          if (!combine(gradients, values, coefficients, step))
            return false;
          const double length_of_step = step.norm();
          if (length_of_step > size)
            step *= size / length_of_step;
          double             part  = 1.;
          unsigned int       halve = 0;
          const unsigned int most  = error <= 1e-14 * size ? 1 : 12;
          while (halve < most && !(error_at(y - part * step) < error))
            {
              part *= 0.5;
              ++halve;
            }
          if (halve == most)
            return error <= 1e-11 * size;
          y -= part * step;
        }
      return error_at(y) <= 1e-11 * size;
    }



    template <int dim>
    bool
    ConstrainedPoint<dim>::approach(const Point<dim> &x, Point<dim> &y) const
    {
      if (!restore(y))
        return false;
      const unsigned int n_free = dim - n;
      if (n_free == 0)
        return true;
      double last_length = std::numeric_limits<double>::max();
      for (unsigned int iteration = 0; iteration < 60; ++iteration)
        {
          std::array<Tensor<1, dim>, dim>   gradients;
          std::array<double, dim>           products{}, multipliers{};
          std::array<Derivatives<dim>, dim> at;
          for (unsigned int i = 0; i < n; ++i)
            {
              at[i]        = derivatives(*level_sets[i], y, length, true);
              gradients[i] = at[i].gradient;
              products[i]  = gradients[i] * (x - y);
            }
          Tensor<1, dim> normal_part;
          if (!combine(gradients, products, multipliers, normal_part))
            return false;

          // Directions in the tangential space.
          std::array<Tensor<1, dim>, dim> tangents;
          if constexpr (dim == 2)
            tangents[0] = cross_product_2d(gradients[0]);
          else if (n == 2)
            tangents[0] = cross_product_3d(gradients[0], gradients[1]);
          else
            {
              unsigned int smallest = 0;
              for (unsigned int d = 1; d < dim; ++d)
                if (std::abs(gradients[0][d]) <
                    std::abs(gradients[0][smallest]))
                  smallest = d;
              Tensor<1, dim> axis;
              axis[smallest] = 1.;
              tangents[0]    = cross_product_3d(gradients[0], axis);
              tangents[1]    = cross_product_3d(gradients[0], tangents[0]);
            }
          double matrix[2][2] = {}, right[2] = {}, solution[2] = {};
          for (unsigned int a = 0; a < n_free; ++a)
            {
              tangents[a] /= tangents[a].norm();
              right[a] = tangents[a] * (x - y);
            }
          for (unsigned int a = 0; a < n_free; ++a)
            for (unsigned int b = 0; b < n_free; ++b)
              {
                matrix[a][b] = a == b ? 1. : 0.;
                for (unsigned int i = 0; i < n; ++i)
                  matrix[a][b] += multipliers[i] *
                                  (tangents[a] * (at[i].hessian * tangents[b]));
              }
          const double determinant =
            n_free == 1
              ? matrix[0][0]
              : matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
          // Where the distance is no convex function, its gradient.
          const bool is_convex = matrix[0][0] > 1e-3 && determinant > 1e-6;
          if (!is_convex)
            std::copy(right, right + n_free, solution);
          else if (n_free == 1)
            solution[0] = right[0] / matrix[0][0];
          else
            {
              solution[0] =
                (matrix[1][1] * right[0] - matrix[0][1] * right[1]) /
                determinant;
              solution[1] =
                (matrix[0][0] * right[1] - matrix[1][0] * right[0]) /
                determinant;
            }
          Tensor<1, dim> step;
          for (unsigned int a = 0; a < n_free; ++a)
            step += solution[a] * tangents[a];

          const double size        = y.norm() + y.distance(x);
          const double step_length = step.norm();
          if (step_length <= 1e-15 * size)
            return true;
          // Distances do not show how small steps come closer.
          if (is_convex && step_length < 1e-6 * size)
            {
              if (step_length > 0.5 * last_length)
                return true;
              last_length  = step_length;
              Point<dim> z = y + step;
              if (!restore(z))
                return true;
              y = z;
              continue;
            }
          double       part = 1.;
          unsigned int halve;
          for (halve = 0; halve < 40; ++halve, part *= 0.5)
            {
              Point<dim> z = y + part * step;
              if (restore(z) && z.distance(x) < y.distance(x) &&
                  z.distance(y) < 4. * part * step_length)
                {
                  y = z;
                  break;
                }
            }
          if (halve == 40)
            return true;
        }
      return true;
    }



    template Derivatives<2>
    derivatives(const LevelSet<2> &, const Point<2> &, double, bool);
    template Derivatives<3>
    derivatives(const LevelSet<3> &, const Point<3> &, double, bool);
    template class ConstrainedPoint<2>;
    template class ConstrainedPoint<3>;
  } // namespace internal
} // namespace greville
