// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks sums over points and back against loops over points and functions of
// KnotVector. They conserve mass and momentum, and are exact for polynomials.

#include <greville/materials/linear_elastic.h>
#include <greville/points/point_transfer.h>

#include "points.h"

template <int dim>
VectorField<dim>
make_field(const SplineSpace<dim> &space)
{
  VectorField<dim> field;
  for (VectorType &component : field)
    space.initialize_vector(component);
  return field;
}



// Coefficients from a function of component, position in the space and Greville
// point.
template <int dim>
VectorField<dim>
make_field(
  const SplineSpace<dim>                                          &space,
  const std::function<double(
    const unsigned int, const std::uint64_t, const Point<dim> &)> &coefficient)
{
  VectorField<dim> field = make_field(space);
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    {
      const std::uint64_t position = space.owned_functions()[i];
      const Point<dim>    xi       = space.greville_point(i);
      for (unsigned int c = 0; c < dim; ++c)
        field[c].local_element(i) = coefficient(c, position, xi);
    }
  return field;
}



template <int dim>
double
random_coefficient(const unsigned int  seed,
                   const unsigned int  component,
                   const std::uint64_t position)
{
  return Random(100 * position + 10 * seed + component)();
}

template <int dim>
VectorField<dim>
random_field(const SplineSpace<dim> &space, const unsigned int seed)
{
  return make_field<dim>(space,
                         [&](const unsigned int  c,
                             const std::uint64_t position,
                             const Point<dim> &) {
                           return random_coefficient<dim>(seed, c, position);
                         });
}



template <int dim>
VectorField<dim>
linear_field(const SplineSpace<dim> &space,
             const Tensor<2, dim>   &A,
             const Tensor<1, dim>   &b)
{
  return make_field<dim>(space,
                         [&](const unsigned int c,
                             const std::uint64_t,
                             const Point<dim> &xi) {
                           return A[c] * xi + b[c];
                         });
}



// Some matrix and vector.
template <int dim>
Tensor<2, dim>
some_matrix(const std::uint64_t seed)
{
  Random         random(seed);
  Tensor<2, dim> A;
  for (unsigned int i = 0; i < dim; ++i)
    for (unsigned int j = 0; j < dim; ++j)
      A[i][j] = random();
  return A;
}



template <int dim>
double
sum(const VectorType &vector)
{
  double result = 0.;
  for (unsigned int i = 0; i < vector.locally_owned_size(); ++i)
    result += vector.local_element(i);
  return Utilities::MPI::sum(result, MPI_COMM_WORLD);
}



template <int dim>
double
largest(const VectorField<dim> &field)
{
  double result = 0.;
  for (const VectorType &component : field)
    result = std::max(result, component.linfty_norm());
  return result;
}



// Mass, momentum, internal force and force of loads against direct sums.
template <int dim>
void
test_points_to_grid(const SplineSpace<dim> &space, const bool affine)
{
  // Two bodies of different layouts.
  MaterialPoints<dim> a, b, nothing;
  random_points<dim>(
    a, space, make_layout<dim>(1, affine, true), cube<dim>(2), 0.95, 1, 0.25);
  random_points<dim>(
    b, space, make_layout<dim>(0, false, false), cube<dim>(2), 0.5, 2, 0.6);
  nothing.reinit(space, make_layout<dim>(0, affine, false));
  PointTransfer<dim> transfer;
  transfer.reinit(space);

  DirectSums<dim>     sums(space, 1 + 3 * dim);
  std::vector<double> totals(1 + 2 * dim, 0.);
  for (const MaterialPoints<dim> *points : {&a, &b})
    points->for_each([&](const unsigned int, const auto values) {
      const auto      &layout = points->layout();
      const Point<dim> x      = values.position();
      const double     m      = values.mass();
      const double     V      = values.volume0() * values.J();
      const auto       sigma  = values.stress();
      totals[0] += m;
      for (unsigned int i = 0; i < dim; ++i)
        {
          totals[1 + i] += m * values.velocity(i);
          if (layout.find("load"))
            totals[1 + dim + i] += m * values[layout.first("load") + i];
        }
      for_each_function<dim>(
        space,
        x,
        [&](const std::uint64_t   f,
            const Point<dim>     &xi,
            const double          N,
            const Tensor<1, dim> &dN) {
          sums(f, 0) += m * N;
          for (unsigned int i = 0; i < dim; ++i)
            {
              double v        = values.velocity(i);
              double internal = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                {
                  if (layout.find("affine"))
                    v += values[layout.first("affine") + i * dim + j] *
                         (xi[j] - x[j]);
                  internal -= V * sigma[i][j] * dN[j];
                }
              sums(f, 1 + i) += m * v * N;
              double load = internal;
              if (layout.find("load"))
                load += m * N * values[layout.first("load") + i];
              sums(f, 1 + dim + i) += load;
            }
        });
    });
  sums.add_processes();
  Utilities::MPI::sum(totals, MPI_COMM_WORLD, totals);

  VectorType mass;
  space.initialize_vector(mass);
  VectorField<dim> momentum = random_field(space, 5);
  VectorField<dim> force    = random_field(space, 6);
  // Earlier values are overwritten, also in ghost entries.
  mass = 3.;
  mass.update_ghost_values();
  transfer.points_to_grid({&a, &nothing, &b}, &mass, &momentum, &force);
  double error       = sums.difference(mass, 0);
  double error_force = 0.;
  double total       = std::abs(sum<dim>(mass) / totals[0] - 1.);
  double zero        = 0.;
  for (unsigned int i = 0; i < dim; ++i)
    {
      error = std::max(error, sums.difference(momentum[i], 1 + i));
      error_force =
        std::max(error_force, sums.difference(force[i], 1 + dim + i));
      total =
        std::max(total,
                 std::abs(sum<dim>(momentum[i]) - totals[1 + i]) / totals[0]);
      // Internal forces have the sum zero: that of loads remains.
      zero = std::max(zero,
                      std::abs(sum<dim>(force[i]) - totals[1 + dim + i]) /
                        largest<dim>(force));
    }
  const std::string name = std::string("    ") + (affine ? "affine, " : "");
  check(name + "mass and momentum", error, 1e-13);
  check(name + "force", error_force, 1e-13);
  check(name + "sums of mass, momentum", total, 1e-13);
  check(name + "and force", zero, 1e-12);

  // Only some of the sums.
  VectorType mass_2;
  space.initialize_vector(mass_2);
  VectorField<dim> momentum_2 = make_field(space), force_2 = make_field(space);
  transfer.points_to_grid({&a, &b}, &mass_2, &momentum_2, nullptr);
  transfer.points_to_grid({&b, &a}, nullptr, nullptr, &force_2);
  error = difference(mass_2, mass);
  for (unsigned int i = 0; i < dim; ++i)
    error = std::max({error,
                      difference(momentum_2[i], momentum[i]),
                      difference(force_2[i], force[i])});
  check(name + "parts of it", error, 1e-13);

  // Bodies add up.
  transfer.points_to_grid({&a}, &mass_2, &momentum_2, &force_2);
  VectorType mass_3;
  space.initialize_vector(mass_3);
  VectorField<dim> momentum_3 = make_field(space), force_3 = make_field(space);
  transfer.points_to_grid({&b}, &mass_3, &momentum_3, &force_3);
  mass_2 += mass_3;
  error = difference(mass_2, mass);
  for (unsigned int i = 0; i < dim; ++i)
    {
      momentum_2[i] += momentum_3[i];
      force_2[i] += force_3[i];
      error = std::max({error,
                        difference(momentum_2[i], momentum[i]),
                        difference(force_2[i], force[i])});
    }
  transfer.points_to_grid({}, &mass_3, &momentum_3, &force_3);
  check(name + "bodies add up",
        std::max(error, mass_3.l2_norm() + force_3[0].l2_norm()),
        1e-13);
}



// A field and its gradient at a point, from coefficients by their seed.
template <int dim>
std::pair<Tensor<1, dim>, Tensor<2, dim>>
evaluate(const SplineSpace<dim> &space,
         const unsigned int      seed,
         const Point<dim>       &x)
{
  Tensor<1, dim> value;
  Tensor<2, dim> gradient;
  for_each_function<dim>(space,
                         x,
                         [&](const std::uint64_t f,
                             const Point<dim> &,
                             const double          N,
                             const Tensor<1, dim> &dN) {
                           for (unsigned int c = 0; c < dim; ++c)
                             {
                               const double u =
                                 random_coefficient<dim>(seed, c, f);
                               value[c] += N * u;
                               gradient[c] += u * dN;
                             }
                         });
  return {value, gradient};
}



// One way through grid_to_points() against formulas with directly evaluated
// fields (numbers 1: v, 2: w, 3: a), and against one pass for each.
template <int dim>
double
test_pass(const MaterialPoints<dim> &start,
          const Material            &material,
          const bool                 kick,
          const bool                 move,
          const bool                 deform,
          const bool                 same,
          const bool                 apic,
          double                    &separate_error,
          bool                      &left_is_right)
{
  using Layout                   = PointLayout<dim>;
  const SplineSpace<dim> &space  = start.space();
  const Layout            layout = start.layout();
  PointTransfer<dim>      transfer;
  transfer.reinit(space);
  const VectorField<dim> v = random_field(space, 1);
  const VectorField<dim> w = random_field(space, 2);
  const VectorField<dim> a = random_field(space, 3);

  PointUpdate<dim> update;
  update.velocity      = kick || move || same ? &v : nullptr;
  update.acceleration  = kick ? &a : nullptr;
  update.deformation   = deform ? (same ? &v : &w) : nullptr;
  update.move          = move;
  update.velocity_step = 0.07;
  update.step          = 0.05;
  update.flip          = 0.8;
  update.apic          = apic;
  update.material      = deform ? &material : nullptr;
  MaterialPoints<dim> points(start);
  const PointReport   report = transfer.grid_to_points(points, update);

  const auto                before = by_id(start);
  double                    error  = 0.;
  double                    signal = 0.;
  std::vector<unsigned int> left;
  points.for_each([&](const unsigned int cell, const auto p) {
    std::vector<double> expected = before.at(p.id());
    const PointRef<dim> e(expected.data());
    const Point<dim>    x       = e.position();
    const auto          field_v = evaluate(space, 1, x);
    const auto          field_w = same ? field_v : evaluate(space, 2, x);
    const auto          field_a = evaluate(space, 3, x);
    Tensor<1, dim>      D;
    Tensor<2, dim>      B;
    for_each_function<dim>(space,
                           x,
                           [&](const std::uint64_t f,
                               const Point<dim>   &xi,
                               const double        N,
                               const Tensor<1, dim> &) {
                             for (unsigned int j = 0; j < dim; ++j)
                               {
                                 D[j] += N * (xi[j] - x[j]) * (xi[j] - x[j]);
                                 for (unsigned int i = 0; i < dim; ++i)
                                   B[i][j] += N *
                                              random_coefficient<dim>(1, i, f) *
                                              (xi[j] - x[j]);
                               }
                           });
    error = std::max(error, (transfer.spread(cell, x) - D).norm() / D.norm());

    Tensor<1, dim> velocity;
    for (unsigned int i = 0; i < dim; ++i)
      {
        double &v_i = e.velocity(i);
        if (kick)
          v_i = apic ? field_v.first[i]
                     : 0.8 * (v_i + 0.07 * field_a.first[i]) +
                         0.2 * field_v.first[i];
        velocity[i] = v_i;
        if (move)
          e.position(i) += 0.05 * field_v.first[i];
        if (kick && apic)
          for (unsigned int j = 0; j < dim; ++j)
            expected[layout.first("affine") + i * dim + j] = B[i][j] / D[j];
      }
    if (deform)
      {
        MaterialPoint state;
        state.increment = unit_symmetric_tensor<3>();
        state.F         = e.F();
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            state.increment[i][j] += 0.05 * field_w.second[i][j];
        state.F  = state.increment * state.F;
        state.J  = determinant(state.increment) * e.J();
        state.dt = 0.05;
        e.set_F(state.F);
        e.J() = state.J;
        material.update(ArrayView<MaterialPoint>(&state, 1));
        e.set_stress(state.stress);
        e.wave_modulus() = state.wave_modulus;
        signal           = std::max(signal,
                          std::sqrt(state.wave_modulus * state.J * e.volume0() /
                                    e.mass()) +
                            velocity.norm());
      }
    for (unsigned int k = 0; k < layout.size; ++k)
      {
        const bool is_stress =
          (k >= Layout::stress && k < Layout::stress + Layout::n_stress) ||
          k == Layout::wave_modulus;
        const bool is_affine =
          k >= layout.first("affine") && k < layout.first("load");
        // Stress relative to Young's modulus; D, and so C, has the accuracy
        // that the distances to Greville points allow.
        const double scale =
          is_stress ? 1e6
          : is_affine && apic
            ? std::max(1., 1. / D[(k - layout.first("affine")) % dim])
            : 1.;
        error = std::max(error, std::abs(p[k] - expected[k]) / scale);
      }
    if (!points.space().contains(cell, p.basis_position(points.layout())) &&
        (left.empty() || left.back() != cell))
      left.push_back(cell);
  });
  error =
    std::max(error,
             std::abs(report.fastest_signal - signal) / std::max(signal, 1.));
  error = std::max(error, empty_lanes_are_harmless(points) ? 0. : 1e300);
  error = std::max(error, report.bad_point == -1 ? 0. : 1e300);
  if (move)
    {
      left_is_right = left_is_right && report.left_cells == left;
      if (Utilities::MPI::sum(left.size(), MPI_COMM_WORLD) == 0)
        left_is_right = false;
    }
  else
    left_is_right = left_is_right && report.left_cells.empty();

  // The same one after the other. Positions have to change last.
  MaterialPoints<dim> others(start);
  if (kick)
    {
      PointUpdate<dim> part(update);
      part.deformation = nullptr;
      part.move        = false;
      transfer.grid_to_points(others, part);
    }
  if (deform)
    {
      PointUpdate<dim> part(update);
      part.acceleration = nullptr;
      part.apic         = false;
      transfer.grid_to_points(others, part);
    }
  // Stress in units of Young's modulus
  for (auto *set : {&points, &others})
    set->for_each([&](const unsigned int, const auto p) {
      for (unsigned int k = 0; k < Layout::n_stress; ++k)
        p.stress(k) *= 1e-6;
      p.wave_modulus() *= 1e-6;
    });
  separate_error = std::max(separate_error, difference(points, others));
  return max_all(error);
}



template <int dim>
void
test_grid_to_points(const SplineSpace<dim> &space, const Material &material)
{
  MaterialPoints<dim> points;
  random_points<dim>(
    points, space, make_layout<dim>(2, true, true), cube<dim>(2), 1., 3, 0.2);
  double error = 0., separate_error = 0.;
  bool   left = true;
  // kick, move, deform, deform by v, APIC
  const bool passes[][5] = {{true, true, true, true, false},
                            {true, true, true, true, true},
                            {true, false, false, false, false},
                            {true, false, false, false, true},
                            {false, true, true, false, false},
                            {false, true, true, true, false},
                            {false, false, true, false, false},
                            {false, false, true, true, false}};
  for (const auto &k : passes)
    error = std::max(
      error,
      test_pass(
        points, material, k[0], k[1], k[2], k[3], k[4], separate_error, left));
  check("    grid to points, all passes", error, 1e-12);
  check("    separate passes are the same", max_all(separate_error), 1e-13);
  check("    cells that points leave", on_all(left));
}



// Linear fields and monomials of order p.
template <int dim>
void
test_exactness(const SplineSpace<dim> &space, const Material &material)
{
  using Layout         = PointLayout<dim>;
  const unsigned int p = space.degree();
  const double       T = 0.1;
  PointTransfer<dim> transfer;
  transfer.reinit(space);
  const Tensor<2, dim> A = some_matrix<dim>(1), A2 = some_matrix<dim>(2);
  const Tensor<1, dim> b = some_matrix<dim>(3)[0], b2 = some_matrix<dim>(4)[0];
  const VectorField<dim> v = linear_field(space, A, b);
  const VectorField<dim> a = linear_field(space, A2, b2);

  double              blend = 0., gradient = 0., volume = 0., affine = 0.;
  MaterialPoints<dim> start;
  random_points<dim>(
    start, space, make_layout<dim>(0, true, false), cube<dim>(2), 0.9);
  const auto before = by_id(start);
  for (const double flip : {0., 0.3, 1.})
    {
      MaterialPoints<dim> points(start);
      PointUpdate<dim>    update;
      update.acceleration = &a;
      update.velocity = update.deformation = &v;
      update.move                          = true;
      update.velocity_step                 = 0.25;
      update.step                          = T;
      update.flip                          = flip;
      update.material                      = &material;
      transfer.grid_to_points(points, update);
      points.for_each([&](const unsigned int, const auto q) {
        const auto    &old = before.at(q.id());
        Point<dim>     x;
        Tensor<2, dim> F;
        for (unsigned int i = 0; i < dim; ++i)
          {
            x[i] = old[i];
            for (unsigned int j = 0; j < dim; ++j)
              F[i][j] = old[Layout::F + i * dim + j];
          }
        const Tensor<1, dim> v_x = A * x + b, a_x = A2 * x + b2;
        Tensor<2, dim>       f = T * A;
        for (unsigned int i = 0; i < dim; ++i)
          f[i][i] += 1.;
        for (unsigned int i = 0; i < dim; ++i)
          {
            blend = std::max(blend,
                             std::abs(q.velocity(i) -
                                      flip * (old[Layout::velocity + i] +
                                              0.25 * a_x[i]) -
                                      (1. - flip) * v_x[i]));
            blend =
              std::max(blend, std::abs(q.position(i) - x[i] - T * v_x[i]));
          }
        gradient = std::max(gradient, (q.matrix(Layout::F) - f * F).norm());
        volume =
          std::max(volume, std::abs(q.J() - determinant(f) * old[Layout::J]));
        // J stays the determinant of F.
        volume = std::max(volume, std::abs(q.J() - determinant(q.F())));
      });
    }
  check("    linear fields, FLIP and PIC", max_all(blend), 1e-13);
  check("    F of a linear velocity", max_all(gradient), 1e-12);
  check("    J of a linear velocity", max_all(volume), 1e-12);

  // C is the gradient.
  {
    MaterialPoints<dim> points(start);
    PointUpdate<dim>    update;
    update.acceleration = &a;
    update.velocity     = &v;
    update.apic         = true;
    transfer.grid_to_points(points, update);
    points.for_each([&](const unsigned int, const auto q) {
      affine = std::max(affine,
                        (q.matrix(points.layout().first("affine")) - A).norm());
      affine = std::max(affine, (A * q.position() + b - q.velocity()).norm());
    });
  }
  check("    APIC: C of a linear velocity", max_all(affine), 1e-11);

  // Taylor has the gradient at the new position.
  double taylor = 0.;
  for (const bool move : {false, true})
    {
      MaterialPoints<dim> points(start);
      PointUpdate<dim>    update;
      update.acceleration = &a;
      update.velocity     = &v;
      update.deformation  = move ? &v : nullptr;
      update.move         = move;
      update.step         = T;
      update.taylor       = true;
      update.material     = &material;
      transfer.grid_to_points(points, update);
      const Tensor<2, dim> one = unit_symmetric_tensor<dim>();
      const Tensor<2, dim> C   = move ? A * invert(one + T * A) : A;
      points.for_each([&](const unsigned int, const auto q) {
        taylor =
          std::max(taylor,
                   (q.matrix(points.layout().first("affine")) - C).norm());
      });
    }
  check("    Taylor: C of a linear velocity", max_all(taylor), 1e-11);

  // v_c = (c + 1) (x y z)^p: its coefficients are products of inner knots.
  VectorField<dim> monomial = make_field(space);
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    {
      const auto index =
        multi_index<dim>(space.owned_functions()[i], space.n_functions());
      double product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 1; k <= p; ++k)
          product *= space.knots(d).knots()[index[d] + k];
      for (unsigned int c = 0; c < dim; ++c)
        monomial[c].local_element(i) = (c + 1.) * product;
    }
  MaterialPoints<dim> points(start);
  PointUpdate<dim>    update;
  update.velocity = update.deformation = &monomial;
  update.move                          = true;
  update.step                          = 0.01;
  update.material                      = &material;
  transfer.grid_to_points(points, update);
  double error = 0., slope = 0.;
  points.for_each([&](const unsigned int, const auto q) {
    const auto    &old = before.at(q.id());
    Tensor<2, dim> F, f;
    double         value = 1.;
    for (unsigned int i = 0; i < dim; ++i)
      value *= std::pow(old[i], p);
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        {
          F[i][j] = old[Layout::F + i * dim + j];
          f[i][j] = 0.01 * (i + 1.) * p * value / old[j] + (i == j ? 1. : 0.);
        }
    for (unsigned int i = 0; i < dim; ++i)
      error =
        std::max(error,
                 std::abs(q.position(i) - old[i] - 0.01 * (i + 1.) * value));
    slope = std::max(slope, (q.matrix(Layout::F) - f * F).norm());
  });
  check("    monomials of order p", max_all(error), 1e-13);
  check("    and their gradients", max_all(slope), 1e-12);
}



// APIC to the grid and back.
template <int dim>
void
test_round_trip(const SplineSpace<dim> &space)
{
  MaterialPoints<dim> points;
  random_points<dim>(
    points, space, make_layout<dim>(0, true, false), cube<dim>(2), 0.9, 4, 0.2);
  PointTransfer<dim> transfer;
  transfer.reinit(space);

  // Momentum, and angular momentum with xy, xz, yz.
  const auto momenta = [&]() {
    std::vector<double> result(dim + 3, 0.);
    points.for_each([&](const unsigned int cell, const auto p) {
      const Point<dim> x = p.position();
      const auto       D = transfer.spread(cell, x);
      const auto       C = p.matrix(points.layout().first("affine"));
      const double     m = p.mass();
      for (unsigned int i = 0; i < dim; ++i)
        {
          const double v_i = p.velocity(i);
          result[i] += m * v_i;
          for (unsigned int j = 0; j < i; ++j)
            result[dim + i + j - 1] += m * (x[j] * v_i - x[i] * p.velocity(j) +
                                            D[j] * C[i][j] - D[i] * C[j][i]);
        }
    });
    Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
    return result;
  };
  const auto before = momenta();

  VectorType mass;
  space.initialize_vector(mass);
  VectorField<dim> velocity = make_field(space);
  transfer.points_to_grid({&points}, &mass, &velocity, nullptr);
  double total = sum<dim>(mass);
  for (VectorType &component : velocity)
    for (unsigned int i = 0; i < component.locally_owned_size(); ++i)
      if (mass.local_element(i) > 0.)
        component.local_element(i) /= mass.local_element(i);
  PointUpdate<dim> update;
  update.acceleration = update.velocity = &velocity;
  update.apic                           = true;
  transfer.grid_to_points(points, update);
  const auto after  = momenta();
  double     linear = 0., angular = 0., size = 0.;
  for (unsigned int k = 0; k < dim; ++k)
    linear = std::max(linear, std::abs(after[k] - before[k]) / total);
  for (unsigned int k = dim; k < dim + 3; ++k)
    {
      angular = std::max(angular, std::abs(after[k] - before[k]) / total);
      size    = std::max(size, std::abs(before[k]) / total);
    }
  check("    APIC keeps momentum", linear, 1e-13);
  check("    and angular momentum", angular, 1e-13);
  check("      (which is not zero)", size > 1e-3);
}



// The stiffness is symmetric, and the derivative of forces.
template <int dim>
void
test_stiffness(const SplineSpace<dim> &space, const Material &material)
{
  using Layout               = PointLayout<dim>;
  const Moduli        moduli = material.moduli();
  const double        lambda = moduli.bulk - 2. / 3. * moduli.shear;
  MaterialPoints<dim> start;
  random_points<dim>(
    start, space, make_layout<dim>(0, false, false), cube<dim>(2), 0.9, 5, 0.2);
  start.for_each([&](const unsigned int, const auto p) {
    p.wave_modulus() = lambda + 2. * moduli.shear;
    for (unsigned int k = 0; k < Layout::n_stress; ++k)
      p.stress(k) = 0.;
    p.set_F(unit_symmetric_tensor<3>());
    p.J() = 1.;
  });
  PointTransfer<dim> transfer;
  transfer.reinit(space);
  const VectorField<dim> u = random_field(space, 1), w = random_field(space, 2);
  VectorField<dim>       Ku = random_field(space, 3), Kw = make_field(space);
  transfer.add_stiffness(start, {lambda, moduli.shear}, u, Ku, true);
  transfer.add_stiffness(start, {lambda, moduli.shear}, w, Kw, true);
  double wKu = 0., uKw = 0., norm = 0.;
  for (unsigned int d = 0; d < dim; ++d)
    {
      wKu += w[d] * Ku[d];
      uKw += u[d] * Kw[d];
      norm += Ku[d].l2_norm() * w[d].l2_norm();
    }
  check("    stiffness is symmetric", std::abs(wKu - uKw) / norm, 1e-14);

  // J V0 sigma of +u and -u; V0 of the layout is random.
  const double     epsilon    = 1e-5;
  VectorField<dim> derivative = make_field(space);
  for (const double side : {-1., 1.})
    {
      MaterialPoints<dim> points(start);
      PointUpdate<dim>    update;
      update.deformation = &u;
      update.step        = side * epsilon;
      update.material    = &material;
      transfer.grid_to_points(points, update);
      VectorField<dim> force = make_field(space);
      transfer.points_to_grid({&points}, nullptr, nullptr, &force);
      for (unsigned int d = 0; d < dim; ++d)
        derivative[d].add(-0.5 * side / epsilon, force[d]);
    }
  double error = 0., twice = 0.;
  for (unsigned int d = 0; d < dim; ++d)
    error = std::max(error, difference(derivative[d], Ku[d]));
  check("    and the derivative of forces", error, 1e-6);

  // It adds where asked for.
  VectorField<dim> sum(Ku);
  transfer.add_stiffness(start, {lambda, moduli.shear}, w, sum, false);
  for (unsigned int d = 0; d < dim; ++d)
    {
      Ku[d] += Kw[d];
      twice = std::max(twice, difference(sum[d], Ku[d]));
    }
  check("    added", twice, 1e-14);

  // Points that got stiffer count as much.
  start.for_each(
    [&](const unsigned int, const auto p) { p.wave_modulus() *= 3.; });
  transfer.add_stiffness(start, {lambda, moduli.shear}, u, sum, true);
  transfer.add_stiffness(start, {3. * lambda, 3. * moduli.shear}, u, Ku, true);
  double scaled = 0.;
  for (unsigned int d = 0; d < dim; ++d)
    scaled = std::max(scaled, difference(sum[d], Ku[d]));
  check("    in proportion to wave moduli", scaled, 1e-14);

  // Viscosity is the same at all of them.
  transfer.add_stiffness(start,
                         {lambda, moduli.shear, 3. * lambda, 3. * moduli.shear},
                         u,
                         sum,
                         true);
  double viscous = 0.;
  for (unsigned int d = 0; d < dim; ++d)
    {
      Ku[d] *= 2.;
      viscous = std::max(viscous, difference(sum[d], Ku[d]));
    }
  check("    viscosity is not", viscous, 1e-14);

  // The mass matrix gives the momentum of points that have the velocity u.
  VectorType       mass;
  VectorField<dim> momentum = make_field(space);
  space.initialize_vector(mass);
  MaterialPoints<dim>    points(start);
  PointUpdate<dim>       update;
  const VectorField<dim> zero = make_field(space);
  update.velocity             = &u;
  update.acceleration         = &zero;
  update.flip                 = 0.;
  transfer.grid_to_points(points, update);
  transfer.points_to_grid({&points}, &mass, &momentum, nullptr);
  transfer.multiply_mass({&start}, u, Ku);
  double product = 0.;
  for (unsigned int d = 0; d < dim; ++d)
    product = std::max(product, difference(Ku[d], momentum[d]));
  check("    mass matrix", product, 1e-14);
}



template <int dim>
void
test_bad_points(const SplineSpace<dim> &space, const Material &material)
{
  using Layout = PointLayout<dim>;
  PointTransfer<dim> transfer;
  transfer.reinit(space);
  MaterialPoints<dim> start;
  random_points<dim>(
    start, space, make_layout<dim>(0, false, false), cube<dim>(2), 0.9, 6, 0.3);
  start.for_each([&](const unsigned int, const auto p) { p.J() = 1.; });
  Tensor<2, dim> A;
  A[0][0]                  = 1.;
  const VectorField<dim> u = linear_field(space, A, Tensor<1, dim>());
  PointUpdate<dim>       update;
  update.deformation = &u;
  update.material    = &material;

  // All points: each process has one to report.
  MaterialPoints<dim> points(start);
  update.step        = -1.5;
  PointReport report = transfer.grid_to_points(points, update);
  check("    " + report.bad_reason,
        on_all(report.bad_point >= 0 &&
               report.bad_reason.substr(0, 41) ==
                 "its volume has become negative (J = -0.5)"));

  // A single one, at last a number that is none.
  update.step              = 0.1;
  const std::uint64_t last = Utilities::MPI::max<std::uint64_t>(
    start.n_points() > 0 ? by_id(start).rbegin()->first : 0, MPI_COMM_WORLD);
  for (const double value : {-3., std::numeric_limits<double>::quiet_NaN()})
    for (const unsigned int k : {Layout::J, Layout::F, Layout::position})
      if (k == Layout::J || value != -3.)
        {
          points       = start;
          bool is_here = false;
          points.for_each([&](const unsigned int, const auto p) {
            if (p.id() == last)
              {
                p[k]    = value;
                is_here = true;
              }
          });
          update.velocity = &u;
          update.move     = true;
          report          = transfer.grid_to_points(points, update);
          check("    number " + std::to_string(k) + " of a point",
                on_all(report.bad_point ==
                         (is_here ? std::int64_t(last) : -1) &&
                       report.bad_reason.empty() != is_here));
        }
}



template <int dim>
void
test(const MultiIndex<dim> &cells, const Material &material)
{
  for (unsigned int p = 1; p <= 5; ++p)
    {
      Box<dim>               box(cells);
      const SplineSpace<dim> space(box.mesh, p);
      print() << dim << "D, p = " << p << std::endl;
      test_points_to_grid(space, false);
      test_points_to_grid(space, true);
      test_grid_to_points(space, material);
      test_exactness(space, material);
      if (p == 2 || p == 3)
        test_round_trip(space);
      if (dim == 2 || p <= 3)
        test_stiffness(space, material);
      if (p == 2)
        test_bad_points(space, material);
    }
}



void
test_main()
{
  LinearElastic material;
  material.reinit("Material");
  test<2>({{4, 5}}, material);
  test<3>({{3, 2, 3}}, material);
}
