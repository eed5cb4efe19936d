// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3

// Checks the fast path of simulations: ExtendedMass equals the dense matrix E^T
// M~ E, with fragments, constrained functions and any width; StencilMatrix
// equals MassOperator, filled from points and from weights; ExtendedMassSolver
// solves, even with an old factorization.

#include <greville/multigrid/extended_mass_solver.h>
#include <greville/points/point_transfer.h>

#include <dense.h>
#include <half_full_cells.h>
#include <numeric>

// Component c is constrained at the lower wall in direction c.
template <int dim>
bool
is_constrained_at_wall(const SplineSpace<dim> &space,
                       const std::uint64_t     position,
                       const unsigned int      c)
{
  return multi_index<dim>(position, space.n_functions())[c] == 0;
}



// Bit c: component c is constrained at the lower wall in direction c.
template <int dim>
std::vector<unsigned char>
constrained_bits(const SplineSpace<dim> &space)
{
  std::vector<unsigned char> constrained(space.owned_functions().size() +
                                         space.ghost_functions().size());
  for (unsigned int f = 0; f < constrained.size(); ++f)
    for (unsigned int c = 0; c < dim; ++c)
      if (is_constrained_at_wall(space, space.function_position(f), c))
        constrained[f] |= 1 << c;
  return constrained;
}



// Bodies, filling, extension and matrix together.
template <int dim>
struct Problem
{
  Problem(const MultiIndex<dim>       &cells,
          const unsigned int           p,
          const Filling<dim>          &is_filled,
          const std::array<bool, dim> &periodic = {})
    : box(cells, MPI_COMM_WORLD, periodic)
    , space(box.mesh, p)
    , filling(space)
  {
    transfer.reinit(space);
    mass.reinit(space);
    move_to(is_filled);
    begin(true);
  }

  void
  move_to(const Filling<dim> &is_filled)
  {
    filling.update(fillings<dim>(space, is_filled), 0.7);
    extension.reinit(space, filling);
    points = random_points<dim>(space, space.degree(), is_filled);
  }

  void
  begin(const bool changed)
  {
    mass.begin(extension, changed);
    transfer.add_mass_matrix({&points}, mass.matrix());
    mass.finish();
    if (changed)
      mass.unknowns().constrain(constrained);
  }

  void
  constrain()
  {
    constrained = constrained_bits(space);
    mass.unknowns().constrain(constrained);
  }

  double
  total_mass() const
  {
    double sum = 0.;
    points.for_each([&](const unsigned int, const auto q) { sum += q.mass(); });
    return Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }

  Box<dim>                   box;
  SplineSpace<dim>           space;
  CellFilling<dim>           filling;
  Extension<dim>             extension;
  MaterialPoints<dim>        points;
  PointTransfer<dim>         transfer;
  ExtendedMass<dim>          mass;
  std::vector<unsigned char> constrained = std::vector<unsigned char>(
    space.owned_functions().size() + space.ghost_functions().size());
};



template <int dim>
void
test_products(const MultiIndex<dim>       &cells,
              const unsigned int           p,
              const Filling<dim>          &is_filled,
              const std::string           &name,
              const std::array<bool, dim> &periodic = {})
{
  Problem<dim>            problem(cells, p, is_filled, periodic);
  const SplineSpace<dim> &space  = problem.space;
  ExtendedMass<dim>      &mass   = problem.mass;
  const auto              counts = problem.extension.counts();
  print() << dim << "D, p = " << p << ", " << name << ": " << counts.stable
          << " stable, " << counts.extended << " extended, " << counts.lumped
          << " lumped" << std::endl;
  const unsigned int n_unknowns =
    Utilities::MPI::sum(mass.unknowns().n_owned_unknowns(), MPI_COMM_WORLD);
  check("  unknowns", n_unknowns == counts.stable + counts.lumped);

  {
    DensityWeights<dim> weights(space, 2 * p + 1);
    problem.transfer.mass_weights({&problem.points}, weights);
    const MassOperator<dim> reference(space, weights);
    VectorType              x = pseudo_random_vector(space), y(x), z(x);
    for (const unsigned int i : reference.inactive())
      x.local_element(i) = 0.;
    reference.vmult(z, x);
    x.update_ghost_values();
    for (const bool from_weights : {false, true})
      {
        StencilMatrix<dim> stencil;
        stencil.reinit(space);
        std::vector<unsigned int> all(problem.constrained.size());
        std::iota(all.begin(), all.end(), 0);
        stencil.set_rows(all);
        if (from_weights)
          add_mass_matrix(stencil, weights);
        else
          problem.transfer.add_mass_matrix({&problem.points}, stencil);
        ZeroedArray<double> from(stencil.size()), to(stencil.size());
        for (const unsigned int f : all)
          from[stencil.place(f)] = x.local_element(f);
        for (const auto &[f, place] : stencil.images())
          from[place] = x.local_element(f);
        stencil.vmult(to.data(), from.data(), 1);
        y = 0.;
        for (const unsigned int f : all)
          y.local_element(f) = to[stencil.place(f)];
        for (const auto &[f, place] : stencil.images())
          y.local_element(f) += to[place];
        y.compress(VectorOperation::add);
        check("  StencilMatrix", difference(y, z), 1e-12);
      }
  }

  // Columns of components that are constrained at different walls, or not at
  // all.
  std::vector<std::vector<VectorType>> x(2), y(2);
  {
    Box<dim>               own_box(cells, MPI_COMM_SELF, periodic);
    const SplineSpace<dim> own_space(own_box.mesh, p);
    CellFilling<dim>       own_filling(own_space);
    own_filling.update(fillings<dim>(own_space, is_filled), 0.7);
    const Extension<dim>      own_extension(own_space, own_filling);
    const MaterialPoints<dim> own_points =
      random_points<dim>(own_space, p, is_filled);
    PointTransfer<dim> own_transfer;
    own_transfer.reinit(own_space);
    DensityWeights<dim> own_weights(own_space, 2 * p + 1);
    own_transfer.mass_weights({&own_points}, own_weights);
    for (const bool is_constrained : {false, true})
      {
        std::vector<FullMatrix<double>> exact;
        for (unsigned int c = 0; c < (is_constrained ? dim : 1); ++c)
          exact.push_back(
            dense<dim>(own_space,
                       own_weights,
                       own_extension,
                       [&](const std::uint64_t position) {
                         return is_constrained &&
                                is_constrained_at_wall(own_space, position, c);
                       }));
        for (unsigned int c = 0; c < 8; ++c)
          {
            const auto value = [&](const std::uint64_t position) {
              return std::sin((c + 1.) * 3. * pseudo_random(position));
            };
            const FullMatrix<double> &A = exact[is_constrained ? c % dim : 0];
            VectorType                column, product;
            space.initialize_vector(column);
            space.initialize_vector(product);
            for (unsigned int i = 0; i < column.locally_owned_size(); ++i)
              {
                const std::uint64_t row = space.owned_functions()[i];
                column.local_element(i) = value(row);
                for (unsigned int j = 0; j < A.n(); ++j)
                  product.local_element(i) += A(row, j) * value(j);
              }
            x[is_constrained].push_back(column);
            y[is_constrained].push_back(product);
          }
      }
  }

  const auto         &functions = mass.unknowns().unknown_functions();
  std::vector<double> errors;
  for (const bool is_constrained : {false, true})
    {
      if (is_constrained)
        problem.constrain();
      for (const unsigned int width : {1, 2, 4, 8})
        {
          VectorType from, to;
          mass.unknowns().initialize_vector(from, width);
          mass.unknowns().initialize_vector(to, width);
          for (unsigned int u = 0; u < functions.size(); ++u)
            for (unsigned int c = 0; c < width; ++c)
              from.local_element(u * width + c) =
                x[is_constrained][c].local_element(functions[u]);
          mass.unknowns().zero_constrained_unknowns(from, width);
          // Twice: vectors on places are not zero any more.
          mass.vmult(to, from, width);
          mass.vmult(to, from, width);
          double error = 0., size = 0.;
          for (unsigned int u = 0; u < functions.size(); ++u)
            for (unsigned int c = 0; c < width; ++c)
              {
                const bool zero =
                  (problem.constrained[functions[u]] >> (c % dim)) & 1;
                const double wanted =
                  zero ? 0. : y[is_constrained][c].local_element(functions[u]);
                size = std::max(size, std::abs(wanted));
                error =
                  std::max(error,
                           std::abs(wanted - to.local_element(u * width + c)));
              }
          check(std::string("  vmult, width ") + std::to_string(width) +
                  (is_constrained ? ", held" : ""),
                max_all(error) / max_all(size),
                1e-12);
        }

      // Component 0; constrained rows are unit rows.
      const UpperTriangle entries = std::as_const(mass).local_entries(1);
      VectorType          from, to;
      mass.unknowns().initialize_vector(from, 1);
      mass.unknowns().initialize_vector(to, 1);
      for (unsigned int u = 0; u < functions.size(); ++u)
        from.local_element(u) =
          x[is_constrained][0].local_element(functions[u]);
      mass.unknowns().zero_constrained_unknowns(from, 1);
      from.update_ghost_values();
      to = 0.;
      bool ascending =
        entries.size() == mass.unknowns().unknown_places().size();
      for (unsigned int i = 0; i < entries.size(); ++i)
        for (std::size_t e = entries.row_begin[i]; e < entries.row_begin[i + 1];
             ++e)
          {
            const unsigned int j = entries.columns[e];
            ascending =
              ascending &&
              (e == entries.row_begin[i] ? j == i : j > entries.columns[e - 1]);
            to.local_element(i) += entries.values[e] * from.local_element(j);
            if (j != i)
              to.local_element(j) += entries.values[e] * from.local_element(i);
          }
      to.compress(VectorOperation::add);
      double error = 0., size = 0.;
      for (unsigned int u = 0; u < functions.size(); ++u)
        {
          const double wanted =
            y[is_constrained][0].local_element(functions[u]);
          size  = std::max(size, std::abs(wanted));
          error = std::max(error, std::abs(wanted - to.local_element(u)));
        }
      check(std::string("  entries") + (is_constrained ? ", held" : ""),
            max_all(error) / max_all(size),
            1e-12);
      check("  columns ascend from the diagonal", max_all(!ascending), 0.);
    }
}



template <int dim>
double
norm(const VectorField<dim> &field)
{
  double square = 0.;
  for (const VectorType &component : field)
    square += component.norm_sqr();
  return std::sqrt(square);
}



template <int dim>
void
test_solver(const MultiIndex<dim>       &cells,
            const unsigned int           p,
            const Filling<dim>          &is_filled,
            const Filling<dim>          &is_filled_later,
            const bool                   is_constrained,
            const std::array<bool, dim> &periodic = {})
{
  print() << dim << "D, p = " << p << ": solver"
          << (is_constrained ? ", held" : "") << std::endl;
  SolverParameters parameters;
  parameters.tolerance = 1e-10;

  Problem<dim>       problem(cells, p, is_filled, periodic);
  ExtendedMass<dim> &mass = problem.mass;
  if (is_constrained)
    problem.constrain();
  ExtendedMassSolver<dim> solver(mass, parameters);
  solver.update(problem.total_mass());

  std::array<VectorField<dim>, 2> b, x;
  VectorType                      lumped;
  problem.space.initialize_vector(lumped);
  for (VectorType &component : b[0])
    problem.space.initialize_vector(component);
  problem.transfer.points_to_grid({&problem.points}, &lumped, &b[0], nullptr);
  for (unsigned int k = 0; k < 2; ++k)
    for (unsigned int c = 0; c < dim; ++c)
      {
        problem.space.initialize_vector(b[k][c]);
        for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
          b[k][c].local_element(i) =
            lumped.local_element(i) *
            std::cos((k + 2. * c + 1.) *
                     pseudo_random(problem.space.owned_functions()[i]));
        problem.space.initialize_vector(x[k][c]);
      }

  // The residual, relative; and the largest sum of one of its columns.
  const auto residual = [&](const unsigned int n_fields) {
    const unsigned int width = n_fields * dim <= 2   ? 2
                               : n_fields * dim <= 4 ? 4
                                                     : 8;
    VectorType         rows, unknowns, product;
    for (VectorType *vector : {&rows, &unknowns, &product})
      mass.unknowns().initialize_vector(*vector, width);
    std::vector<const VectorField<dim> *> right, left;
    std::vector<VectorField<dim> *>       fields;
    for (unsigned int k = 0; k < n_fields; ++k)
      {
        right.push_back(&b[k]);
        left.push_back(&x[k]);
        fields.push_back(&x[k]);
      }
    mass.unknowns().restrict_fields(rows, right, width);
    mass.subtract_constrained(rows, fields, width);
    mass.unknowns().read_fields(unknowns, left, width);
    mass.vmult(product, unknowns, width);
    const double size = rows.l2_norm();
    product.sadd(-1., 1., rows);
    std::vector<double> sums(width, 0.), sizes(width, 0.);
    for (unsigned int i = 0; i < product.locally_owned_size(); ++i)
      {
        sums[i % width] += product.local_element(i);
        sizes[i % width] += std::abs(rows.local_element(i));
      }
    Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
    Utilities::MPI::sum(sizes, MPI_COMM_WORLD, sizes);
    double sum = 0.;
    for (unsigned int c = 0; c < n_fields * dim; ++c)
      sum = std::max(sum, std::abs(sums[c]) / sizes[c]);
    return std::make_pair(product.l2_norm() / size, sum);
  };
  const auto clear = [&]() {
    for (auto &field : x)
      for (unsigned int c = 0; c < dim; ++c)
        {
          field[c] = 0.;
          // Constrained coefficients need not be zero.
          for (unsigned int f = 0; f < problem.space.owned_functions().size();
               ++f)
            if ((problem.constrained[f] >> c) & 1)
              field[c].local_element(f) = 0.5;
        }
  };

  clear();
  const auto first = solver.solve({&x[0], &x[1]}, {&b[0], &b[1]});
  check("  two fields", first.converged ? residual(2).first : 1., 1e-9);
  check_range("  iterations", *first.iterations, 1, 60);
  const double size = norm<dim>(x[0]);
  print() << "  |x| = " << std::setprecision(3) << size << std::endl;

  // A new factorization that does not serve is not made and tried again.
  const auto both           = x;
  parameters.max_iterations = 1;
  ExtendedMassSolver<dim> impatient(mass, parameters);
  impatient.update(problem.total_mass());
  clear();
  const auto given_up = impatient.solve({&x[0], &x[1]}, {&b[0], &b[1]});
  check("  one try",
        *first.iterations == 1 ||
          (!given_up.converged && *given_up.iterations == 1));
  parameters.max_iterations = 1000;

  // The same one by one.
  clear();
  solver.solve({&x[0]}, {&b[0]});
  solver.solve({&x[1]}, {&b[1]});
  double error = 0.;
  for (unsigned int k = 0; k < 2; ++k)
    for (unsigned int c = 0; c < dim; ++c)
      error = std::max(error, difference(x[k][c], both[k][c]));
  check("  one by one", error, 1e-7);

  // A guess near the solution, and the solution.
  for (auto &field : x)
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int f = 0; f < problem.space.owned_functions().size(); ++f)
        if (!((problem.constrained[f] >> c) & 1))
          field[c].local_element(f) *= 1. + 1e-8 * pseudo_random(f);
  const auto warm = solver.solve({&x[0], &x[1]}, {&b[0], &b[1]});
  check("  a good guess saves iterations",
        warm.converged && *warm.iterations < *first.iterations);
  check("  one factorization", solver.n_factorizations() == 1);

  // Momentum does not depend on the tolerance.
  if (!is_constrained)
    {
      parameters.tolerance = 1e-3;
      clear();
      solver.solve({&x[0], &x[1]}, {&b[0], &b[1]});
      check("  sum of the residual", residual(2).second, 1e-12);
      parameters.tolerance = 1e-10;
    }

  // The factorization serves similar masses, but not others.
  const auto change_masses = [&](const double change, const bool back) {
    problem.points.for_each([&](const unsigned int, const auto q) {
      const double factor = 1. + change * (1. + pseudo_random(q.id()));
      q.mass() *= back ? 1. / factor : factor;
    });
    problem.begin(false);
  };
  problem.points.for_each([&](const unsigned int, const auto q) {
    q.mass() *= 1. + 0.02 * pseudo_random(q.id());
  });
  for (const double change : {0., 1000.})
    {
      change_masses(change, false);
      solver.update(problem.total_mass());
      SolveResult other;
      for (unsigned int n = 0; n < 2; ++n)
        {
          clear();
          other = solver.solve({&x[0], &x[1]}, {&b[0], &b[1]});
          check("  other masses",
                other.converged ? residual(2).first : 1.,
                1e-9);
        }
      check("  factorizations",
            change > 0. ? solver.n_factorizations() == 2 ||
                            *other.iterations < *first.iterations + 8
                        : solver.n_factorizations() == 1);
    }
  change_masses(1000., true);

  // Other unknowns.
  const unsigned int n_before = solver.n_factorizations();
  problem.move_to(is_filled_later);
  problem.begin(true);
  solver.update(problem.total_mass());
  clear();
  const auto third = solver.solve({&x[0], &x[1]}, {&b[0], &b[1]});
  check("  factorizations", solver.n_factorizations() == n_before + 1);
  check("  other unknowns", third.converged ? residual(2).first : 1., 1e-9);
  print() << "  |x| = " << std::setprecision(3) << norm<dim>(x[0]) << std::endl;
}



void
test_main()
{
  // A body at two walls with a fringe, a strip, and a fragment.
  const Filling<2> drawn = drawing({"..........++",
                                    "##++.....+++",
                                    "####++..+++.",
                                    "#####+......",
                                    "#####+...+#.",
                                    "#####+...+#.",
                                    "####++....#."});
  const Filling<2> later = drawing({"..........++",
                                    "#+++.....+++",
                                    "#####+..+++.",
                                    "######......",
                                    "####++...+#.",
                                    "####++...+#.",
                                    "###++.....#."});
  for (unsigned int p = 1; p <= 5; ++p)
    test_products<2>({{12, 7}}, p, drawn, "drawing");
  for (unsigned int p = 1; p <= 2; ++p)
    test_products<3>(cube<3>(6), p, ball<3>(6, 2.5, 1.8), "ball");
  for (unsigned int p = 1; p <= 3; ++p)
    for (const bool is_constrained : {false, true})
      if (p < 3 || !is_constrained)
        test_solver<2>({{12, 7}}, p, drawn, later, is_constrained);
  for (const bool is_constrained : {false, true})
    test_solver<3>(
      cube<3>(6), 2, ball<3>(6, 1., 3.3), ball<3>(6, 2., 3.3), is_constrained);

  // Where functions at both ends are neighbours, or meet twice.
  for (unsigned int p = 1; p <= 5; ++p)
    for (const bool both : {false, true})
      test_products<2>({{12, 7}},
                       p,
                       drawn,
                       both ? "periodic in x and y" : "periodic in x",
                       {{true, both}});
  for (unsigned int p = 1; p <= 2; ++p)
    test_products<3>(cube<3>(6),
                     p,
                     ball<3>(6, 1.5, 1.8),
                     "periodic in y and z",
                     {{false, true, true}});
  for (const bool is_constrained : {false, true})
    {
      test_solver<2>(
        {{12, 7}}, 2, drawn, later, is_constrained, {{true, false}});
      test_solver<2>({{12, 7}}, 3, drawn, later, false, {{true, true}});
      test_solver<3>(cube<3>(6),
                     2,
                     ball<3>(6, 2., 2.1),
                     ball<3>(6, 2., 2.4),
                     is_constrained,
                     {{true, false, true}});
    }
}
