// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks sums with B-splines averaged over point domains, and increments of F,
// against loops over points and functions with numerically integrated means.

#include <deal.II/base/quadrature_lib.h>

#include <greville/points/point_transfer.h>

#include "points.h"

// The mean of a function of a direction, or of its derivative, over [lower,
// upper].
double
mean(const KnotVector  &knots,
     const unsigned int function,
     const unsigned int derivative,
     const double       lower,
     const double       upper)
{
  const QGauss<1>     quadrature(4);
  std::vector<double> values(knots.degree() + 1);
  double              sum = 0.;
  for (unsigned int e = 0; e < knots.n_elements(); ++e)
    {
      const double begin   = std::max(lower, knots.element_lower(e)),
                   end     = std::min(upper, knots.element_upper(e));
      const unsigned int a = function - knots.first_function(e);
      if (begin >= end || a > knots.degree())
        continue;
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          knots.evaluate(e,
                         begin + (end - begin) * quadrature.point(q)(0),
                         derivative,
                         make_array_view(values));
          sum += (end - begin) * quadrature.weight(q) * values[a];
        }
    }
  return sum / (upper - lower);
}



// Call action(position of a function, value, gradient) for all functions that a
// point sees.
template <int dim, typename Action>
void
for_each_function(const SplineSpace<dim>  &space,
                  const ConstPointRef<dim> p,
                  const PointLayout<dim>  &layout,
                  const bool               averages_values,
                  const Action            &action)
{
  const auto    &extents = space.n_functions();
  Tensor<1, dim> s;
  for (unsigned int i = 0; i < dim; ++i)
    {
      for (unsigned int j = 0; j < dim; ++j)
        s[i] += std::pow(p.F(i, j) * p[layout.domain + j], 2);
      s[i] = std::min(std::sqrt(s[i]), 0.5 * space.cell_size(i));
    }
  std::array<std::vector<std::array<double, 2>>, dim> means;
  for (unsigned int d = 0; d < dim; ++d)
    for (unsigned int i = 0; i < extents[d]; ++i)
      {
        const double x = p.position(d), tiny = 1e-7 * space.cell_size(d);
        const double lower = std::max(x - s[d], space.lower_corner()[d]),
                     upper = std::min(x + s[d], space.upper_corner()[d]);
        means[d].push_back(
          {{averages_values ? mean(space.knots(d), i, 0, lower, upper)
                            : mean(space.knots(d), i, 0, x - tiny, x + tiny),
            mean(space.knots(d), i, 1, lower, upper)}});
      }
  const unsigned int n =
    std::accumulate(extents.begin(), extents.end(), 1u, std::multiplies<>());
  for (unsigned int k = 0; k < n; ++k)
    {
      const auto     index = multi_index<dim>(k, extents);
      double         value = 1.;
      Tensor<1, dim> gradient;
      for (unsigned int d = 0; d < dim; ++d)
        {
          value *= means[d][index[d]][0];
          gradient[d] = 1.;
          for (unsigned int e = 0; e < dim; ++e)
            gradient[d] *= means[e][index[e]][e == d];
        }
      action(k, value, gradient);
    }
}



template <int dim>
void
test(const unsigned int p, const bool averages_values)
{
  const std::string name =
    std::to_string(dim) + "D, p = " + std::to_string(p) +
    (averages_values ? ", all averaged" : ", derivatives averaged");
  Box<dim>               box(cube<dim>(dim == 2 ? 5 : 3));
  const SplineSpace<dim> space(box.mesh, p);
  CellWindows<dim>       windows;
  windows.reinit(space, averages_values);
  windows.reach_all_neighbors();
  PointTransfer<dim> transfer;
  transfer.reinit(space, &windows);

  PointLayout<dim> layout = make_layout<dim>(0, false, true);
  layout.add("domain", dim);
  MaterialPoints<dim> points;
  random_points<dim>(points, space, layout, cube<dim>(2), 0.9, 5, 0.3);
  points.for_each([&](const unsigned int, const auto q) {
    Random random(q.id());
    q.mass()    = 1.5 + 0.5 * random();
    q.volume0() = 1.5 + 0.5 * random();
    q.J()       = 1. + 0.2 * random();
    for (unsigned int d = 0; d < dim; ++d)
      q[layout.domain + d] = space.cell_size(d) * (0.25 + 0.2 * random());
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        q.F(i, j) = (i == j) + 0.3 * random();
  });

  // Mass, momentum and force, field by field
  const unsigned int  n_fields    = 1 + 2 * dim;
  const unsigned int  n_functions = space.n_dofs();
  const unsigned int  load        = layout.find("load")->first;
  std::vector<double> sums(n_functions * n_fields);
  points.for_each([&](const unsigned int, const auto q) {
    const auto stress = q.stress();
    for_each_function<dim>(
      space,
      q,
      layout,
      averages_values,
      [&](const unsigned int k, const double N, const Tensor<1, dim> &grad) {
        double *of_function = &sums[k * n_fields];
        of_function[0] += q.mass() * N;
        for (unsigned int i = 0; i < dim; ++i)
          {
            of_function[1 + i] += q.mass() * q.velocity(i) * N;
            double force = q.mass() * q[load + i] * N;
            for (unsigned int j = 0; j < dim; ++j)
              force -= q.volume() * stress[i][j] * grad[j];
            of_function[1 + dim + i] += force;
          }
      });
  });
  Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  VectorType       mass;
  VectorField<dim> momentum, force, w;
  space.initialize_vector(mass);
  for (auto *field : {&momentum, &force, &w})
    for (VectorType &component : *field)
      space.initialize_vector(component);
  transfer.points_to_grid({&points}, &mass, &momentum, &force);
  std::array<double, 3> errors{}, sizes{};
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    {
      const double *expected = &sums[space.owned_functions()[i] * n_fields];
      for (unsigned int k = 0; k < n_fields; ++k)
        {
          const unsigned int kind  = k == 0 ? 0 : 1 + (k - 1) / dim;
          const double       found = k == 0     ? mass.local_element(i)
                                     : k <= dim ? momentum[k - 1].local_element(i)
                                                : force[k - 1 - dim].local_element(i);
          errors[kind] = std::max(errors[kind], std::abs(found - expected[k]));
          sizes[kind]  = std::max(sizes[kind], std::abs(expected[k]));
        }
    }
  // The value at a point is a mean over a small box here.
  check(name + ", mass", max_all(errors[0]) / max_all(sizes[0]), 1e-9);
  check(name + ", momentum", max_all(errors[1]) / max_all(sizes[1]), 1e-9);
  check(name + ", force", max_all(errors[2]) / max_all(sizes[2]), 1e-9);

  // The increment of F
  std::vector<double> coefficients;
  for (unsigned int k = 0; k < n_functions * dim; ++k)
    coefficients.push_back(0.01 * Random(k)());
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    for (unsigned int d = 0; d < dim; ++d)
      w[d].local_element(i) =
        coefficients[space.owned_functions()[i] * dim + d];
  std::map<std::uint64_t, Tensor<2, dim>> expected;
  points.for_each([&](const unsigned int, const auto q) {
    Tensor<2, dim> increment = unit_symmetric_tensor<dim>();
    for_each_function<dim>(
      space,
      q,
      layout,
      averages_values,
      [&](const unsigned int k, const double, const Tensor<1, dim> &grad) {
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            increment[i][j] += coefficients[k * dim + i] * grad[j];
      });
    expected[q.id()] = increment * q.matrix(PointLayout<dim>::F);
  });
  PointUpdate<dim> update;
  update.deformation = &w;
  update.step        = 1.;
  transfer.grid_to_points(points, update);
  double error = 0.;
  points.for_each([&](const unsigned int, const auto q) {
    error =
      std::max(error,
               (q.matrix(PointLayout<dim>::F) - expected.at(q.id())).norm());
  });
  check(name + ", F", max_all(error), 1e-9);
}



void
test_main()
{
  for (const bool averages_values : {false, true})
    {
      for (const unsigned int p : {1, 2, 3})
        test<2>(p, averages_values);
      test<3>(2, averages_values);
    }
}
