// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_material.h>
#include <greville/points/water_points.h>

#include "water_cell_terms.h"
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
    AssertThrow(displacements.degree() == pressures.degree(),
                ExcDimensionMismatch(displacements.degree(),
                                     pressures.degree()));
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
  WaterPoints<dim>::add(const DrainedTerm &term)
  {
    drained.push_back(term);
    drained.back().radius_of_F = term.radius;
    water_volumes.resize(std::max<std::size_t>(water_volumes.size(),
                                               3 + term.boundary),
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



  template <int dim>
  typename WaterTangents<dim>::Fields
  WaterPoints<dim>::begin_pass(const VectorField<dim> *u,
                               const VectorType       *p,
                               const bool              with_force,
                               const bool              with_rows) const
  {
    const auto n_functions = [](const SpacePolynomials<dim> &tables) {
      return n_local_functions(*tables.space);
    };
    const std::size_t n_u = n_functions(displacement_tables);
    const std::size_t n_p = n_functions(pressure_tables);
    u_buffer.resize(n_u * dim);
    for (unsigned int d = 0; d < dim && u; ++d)
      put_into_buffer((*u)[d], dim, d, u_buffer);
    p_buffer.resize(n_p);
    if (p)
      put_into_buffer(*p, 1, 0, p_buffer);
    forces.assign(n_u * dim, 0.);
    row_sums.assign(n_p, 0.);
    return {displacement_tables,
            pressure_tables,
            parents,
            u ? u_buffer.data() : nullptr,
            p ? p_buffer.data() : nullptr,
            with_force ? forces.data() : nullptr,
            with_rows ? row_sums.data() : nullptr};
  }



  template <int dim>
  void
  WaterPoints<dim>::end_pass(VectorField<dim> &force, VectorType *rows) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      take_from_buffer(forces, dim, d, force[d]);
    if (rows)
      take_from_buffer(row_sums, 1, 0, *rows);
  }



  template <int dim>
  void
  WaterPoints<dim>::evaluate(const VectorField<dim> &u,
                             const VectorType       &p,
                             VectorField<dim>       &force,
                             VectorType             &rows)
  {
    std::fill(water_volumes.begin(), water_volumes.end(), 0.);
    pressure_work       = 0.;
    const auto of_cells = make_cell_terms<dim>(begin_pass(&u, &p, true, true),
                                               terms.is_axisymmetric);
    const auto sources  = [&](auto &term, const WaterValues<dim> &at) {
      const Tensor<2, dim> h = at.slope * term.to_basis;
      const Tensor<2, dim> inverse =
        invert(Tensor<2, dim>(unit_symmetric_tensor<dim>()) + h);
      term.change      = change_of_volume(h);
      term.change_size = at.slope_size * term.to_basis.norm();
      if (terms.is_axisymmetric)
        {
          term.change_size += 1. + term.radius / term.radius_of_F;
          term.end_radius = term.radius + at.u_r;
          term.change += (1. + term.change) *
                         (term.radius - term.radius_of_F + at.u_r) /
                         term.radius_of_F;
        }
      term.J             = 1. + term.change;
      term.map           = term.to_basis * inverse;
      term.p             = at.p;
      term.gradient      = transpose(term.map) * at.p_slope;
      term.p_size        = at.p_size;
      term.gradient_size = at.p_slope_size * term.map.norm();
      terms.finish(term, inverse);
      const Sources result = terms.sources(term);
      count(term, result.value);
      return result;
    };
    sum_terms(*of_cells, points, sources);
    sum_terms(*of_cells, drained, sources);
    cell_squares = of_cells->squares;
    end_pass(force, &rows);
    tangents.set(terms, points);
  }



  template <int dim>
  void
  WaterPoints<dim>::multiply(const VectorField<dim> &du,
                             const VectorType       &dp,
                             VectorField<dim>       &force,
                             VectorType             &rows) const
  {
    const auto fields = begin_pass(&du, &dp, true, true);
    // The derivatives of bodies' points are stored in groups.
    tangents.add_product(fields);
    sum_terms(*make_cell_terms<dim>(fields, terms.is_axisymmetric),
              drained,
              [&](const DrainedTerm &term, const WaterValues<dim> &at) {
                Change change;
                change.p = at.p;
                if (terms.is_axisymmetric)
                  change.hoop = at.u_r / term.end_radius;
                change.h        = at.slope * term.map;
                change.gradient = transpose(term.map) * at.p_slope;
                return terms.derivative(term, change);
              });
    end_pass(force, &rows);
  }



  template <int dim>
  void
  WaterPoints<dim>::spread(const VectorType &dp, VectorField<dim> &force) const
  {
    tangents.add_product(begin_pass(nullptr, &dp, true, false));
    end_pass(force, nullptr);
  }



  template <int dim>
  void
  WaterPoints<dim>::begin_force(VectorField<dim> &force) const
  {
    sum_terms(*make_cell_terms<dim>(begin_pass(nullptr, nullptr, true, false),
                                    terms.is_axisymmetric),
              points,
              [&](const PointTerm &term, const WaterValues<dim> &) {
                Sources sources;
                sources.force =
                  -term.volume * term.old_p * transpose(term.to_basis);
                if (terms.is_axisymmetric)
                  sources.radial = -term.volume * term.old_p / term.radius;
                return sources;
              });
    end_pass(force, nullptr);
  }



  template <int dim>
  void
  WaterPoints<dim>::set_free_motion(const VectorField<dim> &u)
  {
    sum_terms(*make_cell_terms<dim>(begin_pass(&u, nullptr, false, false),
                                    terms.is_axisymmetric),
              points,
              [&](PointTerm &term, const WaterValues<dim> &at) {
                term.of_surface = term.volume * trace(at.slope * term.to_basis);
                if (terms.is_axisymmetric)
                  term.of_surface += term.volume * at.u_r / term.radius;
                return Sources();
              });
  }



  template <int dim>
  void
  WaterPoints<dim>::add_schur_complement(const SpacePolynomials<dim> &functions,
                                         const double                 kick,
                                         StencilMatrix<dim> &matrix) const
  {
    // A smaller divergence of the free motion results only from points that are
    // not Gauss points.
    const double smallest =
      0.1 / std::pow(pressure_tables.space->smallest_cell_size(), 2);
    with_order(functions.space->degree(), [&](const auto size) {
      constexpr int      m = decltype(size)::value, n_q = power(m, dim);
      FullMatrix<double> of_cell(n_q, n_q);
      // Evaluate all functions and their gradients at the start for each term,
      // and call an action that adds the term to the matrix of its cell.
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
          // Use the symmetric form of Nitsche's method, also for seepage faces.
          using Kind = typename DrainedTerm::Kind;
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
    const std::size_t       n     = n_local_functions(space);
    std::vector<double>     sums(n, 0.), volumes(n, 0.);
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
        body.first->for_each([&](const PointRef<dim> p) {
          p[n.pressure] = term->p;
          if (n.change != numbers::invalid_unsigned_int)
            p[n.change] =
              (terms.sources(*term).value + term->earlier) / p.volume0();
          ++term;
        });
      }
  }



  GREVILLE_INSTANTIATE_CLASS(WaterPoints);
} // namespace greville
