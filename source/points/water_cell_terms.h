// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/water_tangents.h>

#include "gradients.h"
#include <array>
#include <cmath>
#include <memory>

namespace greville::internal
{
  using namespace dealii;

  /// Return det(1 + h) - 1, exact to round-off for small h.
  template <int dim>
  double
  change_of_volume(const Tensor<2, dim> &h)
  {
    double result = trace(h) + determinant(h);
    if constexpr (dim == 3)
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i + 1; j < 3; ++j)
          result += h[i][i] * h[j][j] - h[i][j] * h[j][i];
    return result;
  }



  /// The fields of the grid at a term, with gradients with respect to its x.
  template <int dim>
  struct WaterValues
  {
    Tensor<2, dim> slope;    // of the displacement
    double         u_r = 0.; // in axisymmetry
    double         p   = 0.;
    Tensor<1, dim> p_slope;
    // The sums of the absolute values of the terms in slope, p and the slope of
    // p, for round-off.
    double slope_size = 0., p_size = 0., p_slope_size = 0.;
  };



  /// The terms of a cell: fields at them, and sums over them. Null fields and
  /// sums are omitted. If the rows are null, the pressure is omitted, too.
  template <int dim>
  class CellTerms
  {
  public:
    virtual ~CellTerms() = default;

    virtual void
    begin(const unsigned int cell) = 0;

    virtual WaterValues<dim>
    evaluate(const Point<dim> &x) = 0;

    /// Add the contribution of the last evaluate().
    virtual void
    add(const typename WaterTerms<dim>::Sources &sources) = 0;

    virtual void
    end() = 0;

    /// The sums of the squares of the cell forces, and of the absolute values
    /// of the terms in the rows.
    std::array<double, 2> squares{};
  };



  template <int dim, int n>
  class CellTermsOfOrder : public CellTerms<dim>
  {
  public:
    CellTermsOfOrder(const typename WaterTangents<dim>::Fields &fields,
                     const bool                                 with_hoop)
      : fields(fields)
      , with_hoop(with_hoop)
    {}

    void
    begin(const unsigned int cell) override
    {
      of_u = CellGeometry<dim, n>(fields.displacements, cell);
      of_p = CellGeometry<dim, n>(fields.pressures, fields.parents[cell]);
      for (int i = 0; i < dim; ++i)
        for (int a = 0; a < n_functions; ++a)
          {
            f[i][a] = 0.;
            if (fields.u)
              u[i][a] = fields.u[std::size_t(of_u.functions[a]) * dim + i];
          }
      for (int a = 0; a < n_functions && fields.u; ++a)
        {
          u_size[a] = 0.;
          for (int i = 0; i < dim; ++i)
            u_size[a] += std::abs(u[i][a]);
        }
      for (int b = 0; b < n_functions; ++b)
        {
          r[b] = r_size[b] = 0.;
          if (fields.rows)
            p[b] = fields.p[of_p.functions[b]];
        }
    }

    WaterValues<dim>
    evaluate(const Point<dim> &x) override
    {
      WaterValues<dim> at;
      const auto       shape = evaluated(of_u, x);
      G                      = Gradients<dim, n>(shape);
      if (with_hoop)
        shape.multiply(N);
      if (fields.u)
        {
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              for (int a = 0; a < n_functions; ++a)
                at.slope[i][j] += u[i][a] * G.values[j][a];
          for (int a = 0; a < n_functions && with_hoop; ++a)
            at.u_r += u[0][a] * N[a];
          for (int a = 0; a < n_functions; ++a)
            at.slope_size += u_size[a] * size(G, a);
        }
      if (fields.rows)
        {
          q = ValuesAndGradients<dim, n>(of_p, x);
          for (int b = 0; b < n_functions; ++b)
            {
              at.p += p[b] * q.values[b];
              for (int j = 0; j < dim; ++j)
                at.p_slope[j] += p[b] * q.gradients.values[j][b];
              at.p_size += std::abs(p[b]) * q.values[b];
              at.p_slope_size += std::abs(p[b]) * size(q.gradients, b);
            }
        }
      return at;
    }

    void
    add(const typename WaterTerms<dim>::Sources &sources) override
    {
      if (fields.forces)
        {
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              for (int a = 0; a < n_functions; ++a)
                f[i][a] += sources.force[i][j] * G.values[j][a];
          for (int a = 0; a < n_functions && with_hoop; ++a)
            f[0][a] += sources.radial * N[a];
        }
      if (fields.rows)
        for (int b = 0; b < n_functions; ++b)
          {
            r[b] += sources.value * q.values[b];
            for (int j = 0; j < dim; ++j)
              r[b] += sources.gradient[j] * q.gradients.values[j][b];
            r_size[b] += sources.value_size * q.values[b] +
                         sources.gradient_size * size(q.gradients, b);
          }
    }

    void
    end() override
    {
      for (int a = 0; a < n_functions && fields.forces; ++a)
        for (int i = 0; i < dim; ++i)
          {
            fields.forces[std::size_t(of_u.functions[a]) * dim + i] += f[i][a];
            this->squares[0] += f[i][a] * f[i][a];
          }
      for (int b = 0; b < n_functions && fields.rows; ++b)
        {
          fields.rows[of_p.functions[b]] += r[b];
          this->squares[1] += r_size[b] * r_size[b];
        }
    }

  private:
    static constexpr int n_functions = power(n, dim);

    static double
    size(const Gradients<dim, n> &gradients, const int a)
    {
      double sum = 0.;
      for (int j = 0; j < dim; ++j)
        sum += std::abs(gradients.values[j][a]);
      return sum;
    }

    const typename WaterTangents<dim>::Fields fields;
    const bool                                with_hoop;
    CellGeometry<dim, n>                      of_u, of_p;
    double                                    u[dim][n_functions];
    double                                    u_size[n_functions];
    double                                    f[dim][n_functions];
    double                                    p[n_functions], r[n_functions];
    double                                    r_size[n_functions];
    // The gradients of the last evaluate().
    Gradients<dim, n>          G;
    ValuesAndGradients<dim, n> q;
    double                     N[n_functions];
  };



  template <int dim>
  std::unique_ptr<CellTerms<dim>>
  make_cell_terms(const typename WaterTangents<dim>::Fields &fields,
                  const bool                                 with_hoop)
  {
    std::unique_ptr<CellTerms<dim>> result;
    with_order(fields.displacements.space->degree(), [&](const auto size) {
      result = std::make_unique<CellTermsOfOrder<dim, decltype(size)::value>>(
        fields, with_hoop);
    });
    return result;
  }



  /// Add the contribution action(term, its WaterValues) of each term.
  template <int dim, typename Terms, typename Action>
  void
  sum_terms(CellTerms<dim> &of_cell, Terms &terms, const Action &action)
  {
    for (std::size_t k = 0; k < terms.size();)
      {
        const unsigned int cell = terms[k].cell;
        of_cell.begin(cell);
        for (; k < terms.size() && terms[k].cell == cell; ++k)
          of_cell.add(action(terms[k], of_cell.evaluate(terms[k].x)));
        of_cell.end();
      }
  }
} // namespace greville::internal
