// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_particles_gradients_h
#define greville_source_particles_gradients_h

#include "point_kernels.h"

namespace greville
{
  namespace internal
  {
    /**
     * Gradients of the functions of a cell at a point: [direction][function].
     */
    template <int dim, int n>
    struct Gradients
    {
      static constexpr int n_functions = power(n, dim);

      Gradients(const CellGeometry<dim, n> &cell, const dealii::Point<dim> &x)
      {
        double N[3][n], dN[3][n];
        for (int d = 0; d < dim; ++d)
          {
            const double  t = (x[d] - cell.center[d]) * cell.inverse_h[d];
            const double *c = cell.polynomials[d];
            for (int a = 0; a < n; ++a)
              {
                double value = c[a * n + n - 1], slope = 0.;
                for (int k = n - 2; k >= 0; --k)
                  {
                    slope = slope * t + value;
                    value = value * t + c[a * n + k];
                  }
                N[d][a]  = value;
                dN[d][a] = slope * cell.inverse_h[d];
              }
          }
        for (int a_z = 0, a = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y, a += n)
            {
              const double N_z  = dim == 3 ? N[2][a_z] : 1.;
              const double yz   = N[1][a_y] * N_z;
              const double dy_z = dN[1][a_y] * N_z;
              for (int a_x = 0; a_x < n; ++a_x)
                {
                  values[0][a + a_x] = dN[0][a_x] * yz;
                  values[1][a + a_x] = N[0][a_x] * dy_z;
                  if constexpr (dim == 3)
                    values[2][a + a_x] = N[0][a_x] * N[1][a_y] * dN[2][a_z];
                }
            }
      }

      double values[dim][n_functions];
    };



    /**
     * 1 + dt grad w of a field with @p coefficients [component][function].
     */
    template <int dim, int n>
    dealii::Tensor<2, dim>
    increment_at(const Gradients<dim, n> &gradients,
                 const double (&coefficients)[dim][power(n, dim)],
                 const double dt)
    {
      dealii::Tensor<2, dim> f = dealii::unit_symmetric_tensor<dim>();
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            double sum = 0.;
            for (int a = 0; a < power(n, dim); ++a)
              sum += coefficients[i][a] * gradients.values[j][a];
            f[i][j] += dt * sum;
          }
      return f;
    }
  } // namespace internal
} // namespace greville

#endif
