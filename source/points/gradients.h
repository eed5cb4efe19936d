// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "point_kernels.h"

namespace greville
{
  namespace internal
  {
    /// Return the univariate functions of a cell at a point.
    template <int dim, int n>
    ShapeValues<dim, n, double>
    evaluated(const CellGeometry<dim, n> &cell, const dealii::Point<dim> &x)
    {
      ShapeValues<dim, n, double> shape;
      shape.template evaluate<true>(cell, x.begin_raw());
      return shape;
    }



    /// Gradients of the functions of a cell at a point: [direction][function].
    template <int dim, int n>
    struct Gradients
    {
      static constexpr int n_functions = power(n, dim);

      Gradients() = default;

      Gradients(const CellGeometry<dim, n> &cell, const dealii::Point<dim> &x)
        : Gradients(evaluated(cell, x))
      {}

      Gradients(const ShapeValues<dim, n, double> &shape)
      {
        const auto &N = shape.N, &dN = shape.dN;
        for (int a_z = 0, a = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y, a += n)
            {
              const double N_z  = dim == 3 ? N[dim - 1][a_z] : 1.;
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



    /// Gradients and values of the functions.
    template <int dim, int n>
    struct ValuesAndGradients
    {
      ValuesAndGradients() = default;

      ValuesAndGradients(const CellGeometry<dim, n> &cell,
                         const dealii::Point<dim>   &x)
        : ValuesAndGradients(evaluated(cell, x))
      {}

      ValuesAndGradients(const ShapeValues<dim, n, double> &shape)
        : gradients(shape)
      {
        shape.multiply(values);
      }

      Gradients<dim, n> gradients;
      double            values[power(n, dim)];
    };



    /// Return the value of a field with these coefficients of one component.
    template <int dim, int n>
    double
    value_of_component(const ShapeValues<dim, n, double> &shape,
                       const double                      *coefficients)
    {
      double values[power(n, dim)], sum = 0.;
      shape.multiply(values);
      for (int a = 0; a < power(n, dim); ++a)
        sum += coefficients[a] * values[a];
      return sum;
    }



    /// Return the inverse of the deformation of a point since the initial
    /// configuration; in 2D only the part in the plane.
    template <int dim>
    dealii::Tensor<2, dim>
    inverse_F(const ConstPointRef<dim> p, const PointLayout<dim> &layout)
    {
      const dealii::Tensor<2, dim> inverse =
        dealii::invert(p.matrix(PointLayout<dim>::F));
      return layout.initial_F == 0 ? inverse
                                   : p.matrix(layout.initial_F) * inverse;
    }



    /// Return the increment f = 1 + dt grad w of the deformation of a point,
    /// for a field with @p coefficients [component][function]. The gradient is
    /// with respect to the position at the start of the step.
    template <int dim, int n>
    dealii::Tensor<2, dim>
    increment_of_point(const ConstPointRef<dim> p,
                       const PointLayout<dim>  &layout,
                       const Gradients<dim, n> &gradients,
                       const double (&coefficients)[dim][power(n, dim)],
                       const double dt)
    {
      dealii::Tensor<2, dim> gradient;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          for (int a = 0; a < power(n, dim); ++a)
            gradient[i][j] += coefficients[i][a] * gradients.values[j][a];
      if (layout.is_total_lagrangian())
        gradient = gradient * inverse_F<dim>(p, layout);
      return dealii::unit_symmetric_tensor<dim>() + dt * gradient;
    }
  } // namespace internal
} // namespace greville
