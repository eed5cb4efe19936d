// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/free_surface.h>

#include "gradients.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  FreeSurface<dim>::FreeSurface(const SplineSpace<dim>          &displacements,
                                const SplineSpace<dim>          &pressures,
                                const std::vector<unsigned int> &given_parents,
                                const bool                       axisymmetric,
                                const std::string               &pressure,
                                const std::string               &parameter)
    : parents(given_parents)
    , is_axisymmetric(axisymmetric)
    , formula(pressure, parameter, variables_of<dim>("xt"))
  {
    displacement_tables.reinit(displacements);
    pressure_tables.reinit(pressures);
    neighbors.reinit(displacements);
    inverse_squares.assign(displacements.owned_cells().size(), 0.);
    for (VectorType &component : outer_force)
      displacements.initialize_vector(component);
    pressures.initialize_vector(part);
  }



  template <int dim>
  void
  FreeSurface<dim>::find_layer(const std::vector<double> &filled)
  {
    // Cells with a smaller filled fraction leak as with this fraction.
    constexpr double smallest_part = 0.1;

    std::vector<double> of_cells(neighbors.positions().size(), 0.);
    std::copy(filled.begin(), filled.end(), of_cells.begin());
    neighbors.exchange(of_cells);
    for (unsigned int c = 0; c < inverse_squares.size(); ++c)
      {
        inverse_squares[c] = 0.;
        if (filled[c] <= 0.)
          continue;
        const double part = std::min(1., std::max(filled[c], smallest_part));
        const Tensor<1, dim> h = displacement_tables.space->box(c).size;
        for (unsigned int d = 0; d < dim; ++d)
          {
            bool is_free = false;
            for (const unsigned int side : {2 * d, 2 * d + 1})
              {
                const unsigned int n = neighbors.neighbor(c, side);
                is_free = is_free || (n != numbers::invalid_unsigned_int &&
                                      of_cells[n] <= 0.);
              }
            if (is_free)
              inverse_squares[c] += 1. / Utilities::fixed_power<2>(part * h[d]);
          }
      }
  }



  template <int dim>
  void
  FreeSurface<dim>::clear(const double new_dt, const double new_time)
  {
    dt   = new_dt;
    time = new_time;
    terms.clear();
    const SplineSpace<dim> &space = *displacement_tables.space;
    force_buffer.assign(dim * n_local_functions(space), 0.);
  }



  template <int dim>
  double
  FreeSurface<dim>::outside(const Point<dim> &x) const
  {
    std::array<double, dim + 1> arguments;
    for (unsigned int d = 0; d < dim; ++d)
      arguments[d] = x[d];
    arguments[dim] = time;
    return formula(arguments);
  }



  template <int dim>
  void
  FreeSurface<dim>::add(const MaterialPoints<dim> &of_body,
                        const WaterConstants      &constants)
  {
    constexpr double        c      = 1.2;
    const PointLayout<dim> &layout = of_body.layout();
    with_order(displacement_tables.space->degree(), [&](const auto size) {
      constexpr int n = decltype(size)::value, n_u = power(n, dim);
      for (const unsigned int cell : of_body.cells())
        {
          const CellGeometry<dim, n> geometry(displacement_tables, cell);
          const Tensor<1, dim> h = displacement_tables.space->box(cell).size;
          double               f[dim][n_u] = {};
          of_body.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            const Point<dim> x      = p.position();
            const double     value  = outside(x);
            const double     volume = p.volume();
            if (is_in_layer(cell))
              {
                double mobility =
                  constants.mobility *
                  relative_conductivity(value, constants.suction)[0];
                if (constants.solid > 0.)
                  mobility *=
                    kozeny_carman(volume / p.volume0(), constants.solid)[0];
                terms.push_back(
                  {cell,
                   p.basis_position(layout),
                   dt * volume * c * mobility * inverse_squares[cell],
                   value});
              }
            // The slope makes the sum exact for water at rest.
            Tensor<1, dim> slope;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const double step   = 0.25 * h[d];
                Point<dim>   before = x, behind = x;
                before[d] -= step;
                behind[d] += step;
                slope[d] = (outside(behind) - outside(before)) / (2. * step);
              }
            const auto shape = evaluated(geometry, p.basis_position(layout));
            const Gradients<dim, n> G(shape);
            double                  N[n_u];
            shape.multiply(N);
            for (int a = 0; a < n_u; ++a)
              for (int i = 0; i < dim; ++i)
                f[i][a] += volume * (value * G.values[i][a] + N[a] * slope[i]);
            for (int a = 0; a < n_u && is_axisymmetric; ++a)
              f[0][a] += volume * value * N[a] / x[0];
          });
          for (int a = 0; a < n_u; ++a)
            for (int i = 0; i < dim; ++i)
              force_buffer[std::size_t(geometry.functions[a]) * dim + i] +=
                f[i][a];
        }
    });
  }



  template <int dim>
  void
  FreeSurface<dim>::finish()
  {
    for (unsigned int d = 0; d < dim; ++d)
      take_from_buffer(force_buffer, dim, d, outer_force[d]);
  }



  template <int dim>
  double
  FreeSurface<dim>::sum(const VectorType &p,
                        VectorType       &rows,
                        const bool        with_outside) const
  {
    const SplineSpace<dim> &space       = *pressure_tables.space;
    const std::size_t       n_functions = n_local_functions(space);
    p_buffer.resize(n_functions);
    put_into_buffer(p, 1, 0, p_buffer);
    row_sums.assign(n_functions, 0.);
    double result = 0.;
    with_order(space.degree(), [&](const auto size) {
      constexpr int m = decltype(size)::value, n_q = power(m, dim);
      for (const Term &term : terms)
        {
          const CellGeometry<dim, m> geometry(pressure_tables,
                                              parents[term.cell]);
          double                     q[n_q], value = 0.;
          evaluated(geometry, term.x).multiply(q);
          for (int b = 0; b < n_q; ++b)
            value += p_buffer[geometry.functions[b]] * q[b];
          if (with_outside)
            value -= term.outside;
          value *= term.leak;
          result += value;
          for (int b = 0; b < n_q; ++b)
            row_sums[geometry.functions[b]] += value * q[b];
        }
    });
    take_from_buffer(row_sums, 1, 0, part);
    rows += part;
    return result;
  }



  template <int dim>
  void
  FreeSurface<dim>::add_schur_complement(const SpacePolynomials<dim> &functions,
                                         StencilMatrix<dim> &matrix) const
  {
    with_order(functions.space->degree(), [&](const auto size) {
      constexpr int      m = decltype(size)::value, n_q = power(m, dim);
      FullMatrix<double> of_cell(n_q, n_q);
      for (std::size_t k = 0; k < terms.size();)
        {
          const unsigned int         cell = terms[k].cell;
          const CellGeometry<dim, m> geometry(functions, parents[cell]);
          of_cell = 0.;
          for (; k < terms.size() && terms[k].cell == cell; ++k)
            {
              double q[n_q];
              evaluated(geometry, terms[k].x).multiply(q);
              for (int a = 0; a < n_q; ++a)
                for (int b = a; b < n_q; ++b)
                  of_cell(a, b) += terms[k].leak * q[a] * q[b];
            }
          matrix.add_cell(parents[cell], of_cell);
        }
    });
  }



  GREVILLE_INSTANTIATE_CLASS(FreeSurface);
} // namespace greville
