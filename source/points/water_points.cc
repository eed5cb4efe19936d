// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/water_points.h>

#include "gradients.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  void
  WaterPoints<dim>::reinit(const SplineSpace<dim>          &displacements,
                           const SplineSpace<dim>          &pressures,
                           const std::vector<unsigned int> &given_parents,
                           const bool                       axisymmetric)
  {
    displacement_tables.reinit(displacements);
    pressure_tables.reinit(pressures);
    parents               = given_parents;
    terms.is_axisymmetric = axisymmetric;
    AssertThrow(parents.size() == displacements.owned_cells().size(),
                ExcDimensionMismatch(parents.size(),
                                     displacements.owned_cells().size()));
  }



  template <int dim>
  void
  WaterPoints<dim>::clear(const double          new_dt,
                          const Tensor<1, dim> &new_weight,
                          const double          earlier)
  {
    part_of_earlier = earlier;
    terms.dt        = new_dt;
    terms.weight    = new_weight;
    points.clear();
    drained.clear();
    water_volumes.assign(2, 0.);
    sums_of_moduli = {};
    sum_of_masses  = 0.;
  }



  template <int dim>
  void
  WaterPoints<dim>::add(const MaterialPoints<dim> &of_body,
                        const Numbers             &numbers,
                        const WaterConstants      &constants)
  {
    const PointLayout<dim> &layout = of_body.layout();
    for (const unsigned int cell : of_body.cells())
      of_body.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
        PointTerm term;
        term.cell     = cell;
        term.x        = p.basis_position(layout);
        term.to_basis = layout.is_total_lagrangian()
                          ? inverse_F<dim>(p, layout)
                          : Tensor<2, dim>(unit_symmetric_tensor<dim>());
        if (terms.is_axisymmetric)
          {
            term.radius      = p.position(0);
            term.radius_of_F = radius_of_F<dim>(p, layout);
          }
        term.volume     = p.volume();
        term.storage    = p.volume0() * constants.storage;
        term.mobility   = p.volume() * constants.mobility;
        term.compliance = p.volume() / p.wave_modulus();
        term.of_mass    = p.volume() * p.volume() / p.mass();
        term.old_p      = p[numbers.pressure];
        if (part_of_earlier > 0.)
          term.earlier = part_of_earlier * p.volume0() * p[numbers.change];
        term.old_J   = p.volume() / p.volume0();
        term.solid   = constants.solid;
        term.suction = constants.suction;
        term.p       = term.old_p;
        points.push_back(term);
        sums_of_moduli[0] += p.volume();
        sums_of_moduli[1] += p.volume() * p.wave_modulus();
        sum_of_masses += p.mass();
      });
  }



  template <int dim>
  void
  WaterPoints<dim>::add(const DrainedPoint<dim> &point)
  {
    DrainedTerm term;
    term.cell     = point.cell;
    term.kind     = point.kind;
    term.x        = point.x;
    term.to_basis = point.to_basis;
    term.area     = point.area;
    term.radius = term.radius_of_F = point.radius;
    term.value                     = point.value;
    term.mobility                  = point.mobility;
    term.solid                     = point.solid;
    term.old_J                     = point.old_J;
    term.penalty                   = point.penalty;
    term.boundary                  = point.boundary;
    drained.push_back(term);
    water_volumes.resize(std::max<std::size_t>(water_volumes.size(),
                                               3 + point.boundary),
                         0.);
  }



  template <int dim>
  void
  WaterPoints<dim>::count(const PointTerm &term, const double volume)
  {
    water_volumes[0] += volume + term.earlier;
    pressure_work += 0.5 * (term.old_p + term.p) * term.volume * term.change;
  }



  template <int dim>
  void
  WaterPoints<dim>::count(const DrainedTerm &term, const double volume)
  {
    water_volumes[1] += volume;
    water_volumes[2 + term.boundary] += volume;
  }



  namespace
  {
    /**
     * det(1 + h) - 1, exact to round-off where h is small.
     */
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
  } // namespace



  template <int dim>
  template <int                             n,
            int                             m,
            typename WaterPoints<dim>::Pass pass,
            typename Self,
            typename Terms>
  void
  WaterPoints<dim>::sum_terms(Self &self, Terms &of_terms)
  {
    constexpr int  n_u = power(n, dim), n_p = power(m, dim);
    constexpr bool with_rows = pass == Pass::evaluate || pass == Pass::multiply;
    constexpr bool with_u    = with_rows || pass == Pass::free_motion;
    constexpr bool with_force      = pass != Pass::free_motion;
    const bool     is_axisymmetric = self.terms.is_axisymmetric;
    for (std::size_t k = 0; k < of_terms.size();)
      {
        const unsigned int         cell = of_terms[k].cell;
        const CellGeometry<dim, n> of_u(self.displacement_tables, cell);
        const CellGeometry<dim, m> of_p(self.pressure_tables,
                                        self.parents[cell]);
        double                     u[dim][n_u], p[n_p];
        double                     f[dim][n_u] = {}, r[n_p] = {};
        for (int a = 0; a < n_u && with_u; ++a)
          for (int i = 0; i < dim; ++i)
            u[i][a] = self.u_buffer[std::size_t(of_u.functions[a]) * dim + i];
        for (int b = 0; b < n_p && with_rows; ++b)
          p[b] = self.p_buffer[of_p.functions[b]];
        for (; k < of_terms.size() && of_terms[k].cell == cell; ++k)
          {
            auto                            &term  = of_terms[k];
            const auto                       shape = evaluated(of_u, term.x);
            const Gradients<dim, n>          G(shape);
            const ValuesAndGradients<dim, m> q(of_p, term.x);
            double                           N[n_u], u_r = 0.;
            if (is_axisymmetric)
              {
                shape.multiply(N);
                for (int a = 0; a < n_u && with_u; ++a)
                  u_r += u[0][a] * N[a];
              }
            Tensor<2, dim> slope; // of u
            Change         change;
            for (int a = 0; a < n_u && with_u; ++a)
              for (int i = 0; i < dim; ++i)
                for (int j = 0; j < dim; ++j)
                  slope[i][j] += u[i][a] * G.values[j][a];
            Tensor<1, dim> p_slope;
            for (int b = 0; b < n_p && with_rows; ++b)
              {
                change.p += p[b] * q.values[b];
                for (int j = 0; j < dim; ++j)
                  p_slope[j] += p[b] * q.gradients.values[j][b];
              }
            Sources sources;
            if constexpr (pass == Pass::evaluate)
              {
                const Tensor<2, dim> h = slope * term.to_basis;
                const Tensor<2, dim> inverse =
                  invert(Tensor<2, dim>(unit_symmetric_tensor<dim>()) + h);
                term.change = change_of_volume(h);
                if (is_axisymmetric)
                  {
                    term.end_radius = term.radius + u_r;
                    term.change += (1. + term.change) *
                                   (term.radius - term.radius_of_F + u_r) /
                                   term.radius_of_F;
                  }
                term.J        = 1. + term.change;
                term.map      = term.to_basis * inverse;
                term.p        = change.p;
                term.gradient = transpose(term.map) * p_slope;
                self.terms.finish(term, inverse);
                sources = self.terms.sources(term);
              }
            else if constexpr (pass == Pass::begin)
              {
                sources.force =
                  -term.volume * term.old_p * transpose(term.to_basis);
                if (is_axisymmetric)
                  sources.radial = -term.volume * term.old_p / term.radius;
              }
            else if constexpr (pass == Pass::free_motion)
              {
                term.of_surface = term.volume * trace(slope * term.to_basis);
                if (is_axisymmetric)
                  term.of_surface += term.volume * u_r / term.radius;
              }
            else
              {
                if (is_axisymmetric)
                  change.hoop = u_r / term.end_radius;
                change.h        = slope * term.map;
                change.gradient = transpose(term.map) * p_slope;
                sources         = self.terms.derivative(term, change);
              }
            for (int a = 0; a < n_u && with_force; ++a)
              for (int i = 0; i < dim; ++i)
                for (int j = 0; j < dim; ++j)
                  f[i][a] += sources.force[i][j] * G.values[j][a];
            for (int a = 0; a < n_u && is_axisymmetric; ++a)
              f[0][a] += sources.radial * N[a];
            for (int b = 0; b < n_p && with_rows; ++b)
              {
                r[b] += sources.value * q.values[b];
                for (int j = 0; j < dim; ++j)
                  r[b] += sources.gradient[j] * q.gradients.values[j][b];
              }
            if constexpr (pass == Pass::evaluate)
              self.count(term, sources.value);
          }
        for (int a = 0; a < n_u && with_force; ++a)
          for (int i = 0; i < dim; ++i)
            {
              self.forces[std::size_t(of_u.functions[a]) * dim + i] += f[i][a];
              if constexpr (pass == Pass::evaluate)
                self.cell_squares[0] += f[i][a] * f[i][a];
            }
        for (int b = 0; b < n_p && with_rows; ++b)
          {
            self.row_sums[of_p.functions[b]] += r[b];
            if constexpr (pass == Pass::evaluate)
              self.cell_squares[1] += r[b] * r[b];
          }
      }
  }



  template <int dim>
  template <typename WaterPoints<dim>::Pass pass, typename Self>
  void
  WaterPoints<dim>::run(Self                   &self,
                        const VectorField<dim> *u,
                        const VectorType       *p,
                        VectorField<dim>       *force,
                        VectorType             *rows)
  {
    const auto n_functions = [](const SpacePolynomials<dim> &tables) {
      return tables.space->owned_functions().size() +
             tables.space->ghost_functions().size();
    };
    const std::size_t n_u = n_functions(self.displacement_tables);
    const std::size_t n_p = n_functions(self.pressure_tables);
    self.u_buffer.resize(n_u * dim);
    for (unsigned int d = 0; d < dim && u; ++d)
      put_into_buffer((*u)[d], dim, d, self.u_buffer);
    self.p_buffer.resize(n_p);
    if (p)
      put_into_buffer(*p, 1, 0, self.p_buffer);
    self.forces.assign(n_u * dim, 0.);
    self.row_sums.assign(n_p, 0.);
    // The points of bodies have their derivatives in groups.
    constexpr bool of_groups = pass == Pass::multiply || pass == Pass::spread;
    if constexpr (of_groups)
      {
        const typename WaterTangents<dim>::Fields fields{
          self.displacement_tables,
          self.pressure_tables,
          self.parents,
          self.u_buffer.data(),
          self.p_buffer.data(),
          self.forces.data(),
          self.row_sums.data()};
        if constexpr (pass == Pass::multiply)
          self.tangents.add_product(fields);
        else
          self.tangents.add_spread(fields);
      }
    with_orders(self.displacement_tables.space->degree(),
                self.pressure_tables.space->degree(),
                [&](const auto size_u, const auto size_p) {
                  constexpr int n = decltype(size_u)::value;
                  constexpr int m = decltype(size_p)::value;
                  if constexpr (!of_groups)
                    sum_terms<n, m, pass>(self, self.points);
                  if constexpr (pass == Pass::evaluate ||
                                pass == Pass::multiply)
                    sum_terms<n, m, pass>(self, self.drained);
                });
    for (unsigned int d = 0; d < dim && force; ++d)
      take_from_buffer(self.forces, dim, d, (*force)[d]);
    if (rows)
      take_from_buffer(self.row_sums, 1, 0, *rows);
  }



  template <int dim>
  void
  WaterPoints<dim>::evaluate(const VectorField<dim> &u,
                             const VectorType       &p,
                             VectorField<dim>       &force,
                             VectorType             &rows)
  {
    std::fill(water_volumes.begin(), water_volumes.end(), 0.);
    pressure_work = 0.;
    cell_squares  = {};
    run<Pass::evaluate>(*this, &u, &p, &force, &rows);
    tangents.set(terms, points);
  }



  template <int dim>
  void
  WaterPoints<dim>::multiply(const VectorField<dim> &du,
                             const VectorType       &dp,
                             VectorField<dim>       &force,
                             VectorType             &rows) const
  {
    run<Pass::multiply>(*this, &du, &dp, &force, &rows);
  }



  template <int dim>
  void
  WaterPoints<dim>::spread(const VectorType &dp, VectorField<dim> &force) const
  {
    run<Pass::spread>(*this, nullptr, &dp, &force, nullptr);
  }



  template <int dim>
  void
  WaterPoints<dim>::begin_force(VectorField<dim> &force) const
  {
    run<Pass::begin>(*this, nullptr, nullptr, &force, nullptr);
  }



  template <int dim>
  void
  WaterPoints<dim>::set_free_motion(const VectorField<dim> &u)
  {
    run<Pass::free_motion>(*this, &u, nullptr, nullptr, nullptr);
  }



  template <int dim>
  void
  WaterPoints<dim>::add_schur_complement(const SpacePolynomials<dim> &functions,
                                         const double                 kick,
                                         StencilMatrix<dim> &matrix) const
  {
    // Where the points themselves make the divergence of the free motion, as
    // they are not Gauss points, it is small.
    const auto  &lattice  = pressure_tables.space->lattice();
    const double smallest = 0.1 / std::pow(lattice.smallest_cell_size(), 2);
    with_order(functions.space->degree(), [&](const auto size) {
      constexpr int      m = decltype(size)::value, n_q = power(m, dim);
      FullMatrix<double> of_cell(n_q, n_q);
      // Gradients of all functions at the start, and the action on them.
      const auto for_each = [&](const auto &of_terms, const auto &action) {
        for (std::size_t k = 0; k < of_terms.size();)
          {
            const unsigned int         cell = of_terms[k].cell;
            const CellGeometry<dim, m> geometry(functions, parents[cell]);
            of_cell = 0.;
            for (; k < of_terms.size() && of_terms[k].cell == cell; ++k)
              {
                const ValuesAndGradients<dim, m> q(geometry, of_terms[k].x);
                double                           slopes[n_q][dim];
                for (int b = 0; b < n_q; ++b)
                  for (int j = 0; j < dim; ++j)
                    {
                      slopes[b][j] = 0.;
                      for (int J = 0; J < dim; ++J)
                        slopes[b][j] +=
                          of_terms[k].to_basis[J][j] * q.gradients.values[J][b];
                    }
                action(of_terms[k], q.values, slopes);
              }
            matrix.add_cell(parents[cell], of_cell);
          }
      };
      for_each(points,
               [&](const PointTerm &term, const double *q, const auto &slopes) {
                 double mass = term.storage;
                 double flow = terms.dt * terms.mobility(term).value;
                 if (kick == 0.)
                   mass += term.compliance;
                 else
                   {
                     flow += kick * term.of_mass;
                     if (term.of_surface > smallest * term.of_mass)
                       mass += kick * term.of_surface;
                   }
                 for (int a = 0; a < n_q; ++a)
                   for (int b = a; b < n_q; ++b)
                     {
                       double sum = mass * q[a] * q[b];
                       for (int j = 0; j < dim; ++j)
                         sum += flow * slopes[a][j] * slopes[b][j];
                       of_cell(a, b) += sum;
                     }
               });
      for_each(
        drained,
        [&](const DrainedTerm &term, const double *q, const auto &slopes) {
          // The form that is symmetric, of seepage faces, too.
          using Kind = typename DrainedPoint<dim>::Kind;
          if (term.kind == Kind::flux ||
              (term.kind == Kind::seepage && terms.outflow(term) <= 0.))
            return;
          const double flow    = terms.dt * terms.mobility(term).value;
          const double penalty = flow * term.penalty * term.area.norm();
          double       normal[n_q];
          for (int a = 0; a < n_q; ++a)
            {
              normal[a] = 0.;
              for (int j = 0; j < dim; ++j)
                normal[a] += flow * slopes[a][j] * term.area[j];
            }
          for (int a = 0; a < n_q; ++a)
            for (int b = a; b < n_q; ++b)
              of_cell(a, b) +=
                penalty * q[a] * q[b] - q[a] * normal[b] - q[b] * normal[a];
        });
    });
  }



  template <int dim>
  void
  WaterPoints<dim>::average_old_pressure(VectorType &p) const
  {
    const SplineSpace<dim> &space = *pressure_tables.space;
    const std::size_t       n =
      space.owned_functions().size() + space.ghost_functions().size();
    std::vector<double> sums(n, 0.), volumes(n, 0.);
    with_order(space.degree(), [&](const auto size) {
      constexpr int m = decltype(size)::value, n_q = power(m, dim);
      for (const PointTerm &term : points)
        {
          const CellGeometry<dim, m> of_p(pressure_tables, parents[term.cell]);
          const ValuesAndGradients<dim, m> q(of_p, term.x);
          for (int b = 0; b < n_q; ++b)
            {
              const double part = term.volume * q.values[b];
              volumes[of_p.functions[b]] += part;
              sums[of_p.functions[b]] += part * term.old_p;
            }
        }
    });
    VectorType weights;
    space.initialize_vector(weights);
    take_from_buffer(volumes, 1, 0, weights);
    take_from_buffer(sums, 1, 0, p);
    for (unsigned int i = 0; i < p.locally_owned_size(); ++i)
      if (weights.local_element(i) > 0.)
        p.local_element(i) /= weights.local_element(i);
  }



  template <int dim>
  void
  WaterPoints<dim>::store(
    const std::vector<std::pair<MaterialPoints<dim> *, Numbers>> &bodies) const
  {
    auto term = points.begin();
    for (const auto &body : bodies)
      {
        const Numbers n = body.second;
        body.first->for_each([&](const unsigned int, const PointRef<dim> p) {
          p[n.pressure] = term->p;
          if (n.change != numbers::invalid_unsigned_int)
            p[n.change] =
              (terms.sources(*term).value + term->earlier) / p.volume0();
          ++term;
        });
      }
  }



  template class WaterPoints<2>;
  template class WaterPoints<3>;
} // namespace greville
