// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2
// Debug: no

// Projects a smooth function from the material points of a disk, weighted by
// their masses. On extended B-splines, the errors of values and gradients at
// the points decrease with orders p + 1 and p, also for gradients at the
// surface. Also reports the errors of other mass treatments (written to a file
// if its name is given: doc/data/disk_projection.csv).

#include <greville/mass/fmpm.h>
#include <greville/mass/mass_operator.h>
#include <greville/multigrid/extended_mass_solver.h>
#include <greville/points/body.h>
#include <greville/points/point_transfer.h>

#include <filling.h>
#include <fstream>

namespace
{
  constexpr unsigned int dim = 2;

  double
  f(const Point<dim> &x)
  {
    return std::sin(5. * x[0] + 1.) * std::cos(4. * x[1]) + 0.5 * x[0] * x[1];
  }

  Tensor<1, dim>
  gradient(const Point<dim> &x)
  {
    Tensor<1, dim> g;
    g[0] = 5. * std::cos(5. * x[0] + 1.) * std::cos(4. * x[1]) + 0.5 * x[1];
    g[1] = -4. * std::sin(5. * x[0] + 1.) * std::sin(4. * x[1]) + 0.5 * x[0];
    return g;
  }
} // namespace



struct Errors
{
  double values = 0., gradients = 0., largest = 0.;
};



// Relative errors at the points: in the l2 norm, and the largest.
Errors
errors_of(const SplineSpace<dim>    &space,
          const MaterialPoints<dim> &points,
          VectorType                &u)
{
  const unsigned int                                p = space.degree();
  std::vector<std::array<std::vector<double>, dim>> N(2);
  for (auto &derivative : N)
    derivative.fill(std::vector<double>(p + 1));
  std::array<double, 4> sums{};
  std::array<double, 2> largest{};
  u.update_ghost_values();
  points.for_each([&](const unsigned int cell, const auto q) {
    const Point<dim> x     = q.position();
    const auto       index = space.box(cell).index;
    for (unsigned int d = 0; d < dim; ++d)
      for (const unsigned int k : {0, 1})
        space.knots(d).evaluate(index[d], x[d], k, make_array_view(N[k][d]));
    double         value = 0.;
    Tensor<1, dim> slope;
    const auto     functions = space.cell_functions(cell);
    for (unsigned int b = 0; b <= p; ++b)
      for (unsigned int a = 0; a <= p; ++a)
        {
          const double c = u.local_element(functions[b * (p + 1) + a]);
          value += c * N[0][0][a] * N[0][1][b];
          slope[0] += c * N[1][0][a] * N[0][1][b];
          slope[1] += c * N[0][0][a] * N[1][1][b];
        }
    sums[0] += std::pow(value - f(x), 2);
    sums[1] += std::pow(f(x), 2);
    sums[2] += (slope - gradient(x)).norm_square();
    sums[3] += gradient(x).norm_square();
    largest[0] = std::max(largest[0], (slope - gradient(x)).norm());
    largest[1] = std::max(largest[1], gradient(x).norm());
  });
  u.zero_out_ghost_values();
  for (double &sum : sums)
    sum = Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  return {std::sqrt(sums[0] / sums[1]),
          std::sqrt(sums[2] / sums[3]),
          max_all(largest[0]) / max_all(largest[1])};
}



class Projection
{
public:
  Projection(const unsigned int n, const unsigned int p)
    : box(MultiIndex<dim>{{n, 3 * n / 2}})
    , space(box.mesh, p)
    , weights(space, 2 * p + 1)
  {
    PointPlacement placement;
    placement.shape                = "ball(0.5, 0.5, 0.3)";
    placement.points_per_direction = {3};
    placement.jitter               = 0.5;
    points.reinit(space, PointLayout<dim>());
    std::vector<double> numbers(points.layout().size, 0.);
    const PointRef<dim> numbers_of_point(numbers.data());
    numbers_of_point.J() = 1.;
    for (const auto &point : place_points<dim>(placement, "Disk", space))
      {
        for (unsigned int d = 0; d < dim; ++d)
          numbers_of_point.position(d) = point.x[d];
        numbers_of_point.velocity(0) = f(point.x);
        numbers_of_point.mass() = numbers_of_point.volume0() = point.volume;
        points.insert(point.cell, make_array_view(numbers));
      }
    transfer.reinit(space);
    space.initialize_vector(lumped);
    for (unsigned int c = 0; c < dim; ++c)
      space.initialize_vector(momentum[c]);
    transfer.points_to_grid({&points}, &lumped, &momentum, nullptr);
    transfer.mass_weights({&points}, weights);
  }

  // On extended B-splines, or on all with the threshold 0.
  Errors
  consistent(const double threshold, SolveResult &result)
  {
    SolverParameters parameters;
    parameters.tolerance      = 1e-12;
    parameters.max_iterations = 2000;

    CellFilling<dim>    filling(space);
    std::vector<double> parts;
    transfer.filling({&points}, parts);
    filling.update(parts, threshold);
    const Extension<dim> extension(space, filling);
    ExtendedMass<dim>    mass;
    mass.reinit(space);
    mass.begin(extension, true);
    transfer.add_mass_matrix({&points}, mass.matrix());
    mass.finish();
    ExtendedMassSolver<dim> solver(mass, parameters);
    double                  total = 0.;
    for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
      total += lumped.local_element(i);
    solver.update(Utilities::MPI::sum(total, MPI_COMM_WORLD));
    VectorField<dim> u;
    for (unsigned int c = 0; c < dim; ++c)
      space.initialize_vector(u[c]);
    result = solver.solve({&u}, {&momentum});
    return errors_of(space, points, u[0]);
  }

  Errors
  fmpm(const unsigned int order) const
  {
    const CrossMassOperator<dim> M(space, space, weights);
    VectorType                   term(momentum[0]), product, u;
    space.initialize_vector(product);
    space.initialize_vector(u);
    const auto divide = [&](VectorType &x) {
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        x.local_element(i) = lumped.local_element(i) > 0.
                               ? x.local_element(i) / lumped.local_element(i)
                               : 0.;
    };
    divide(term);
    u = 0.;
    for (unsigned int k = 0; k < order; ++k)
      {
        u += term;
        M.vmult(product, term);
        divide(product);
        term -= product;
      }
    return errors_of(space, points, u);
  }

private:
  Box<dim>            box;
  SplineSpace<dim>    space;
  MaterialPoints<dim> points;
  PointTransfer<dim>  transfer;
  VectorType          lumped;
  VectorField<dim>    momentum;
  DensityWeights<dim> weights;
};



void
test_main()
{
  std::ofstream csv;
  if (!test_arguments().empty() &&
      Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    csv.open(test_arguments()[0]);
  csv << "p,mass,cells,iterations,converged,error,gradient_error,"
         "largest_gradient_error\n";
  csv << std::setprecision(4);
  const std::vector<unsigned int> meshes = {20, 40, 80};
  for (unsigned int p = 2; p <= 4; ++p)
    {
      std::vector<std::unique_ptr<Projection>> projections;
      for (const unsigned int n : meshes)
        projections.push_back(std::make_unique<Projection>(n, p));
      for (const std::string treatment :
           {"extended", "raw", "lumped", "fmpm-2", "fmpm-8"})
        {
          std::vector<Errors> errors;
          for (unsigned int k = 0; k < meshes.size(); ++k)
            {
              SolveResult result;
              if (treatment == "extended" || treatment == "raw")
                {
                  if (treatment == "raw" && test_arguments().empty())
                    continue;
                  errors.push_back(projections[k]->consistent(
                    treatment == "extended" ? 0.7 : 0., result));
                  if (treatment == "extended")
                    check("p = " + std::to_string(p) + ", " +
                            std::to_string(meshes[k]) + " cells: converged",
                          result.converged);
                }
              else
                errors.push_back(projections[k]->fmpm(n_fmpm_terms(treatment)));
              const Errors &e = errors.back();
              csv << p << ',' << treatment << ',' << meshes[k] << ',';
              if (result.iterations)
                csv << *result.iterations << ',' << result.converged;
              else
                csv << ',';
              csv << ',' << e.values << ',' << e.gradients << ',' << e.largest
                  << '\n';
            }
          if (treatment == "raw")
            continue;
          const Errors &coarse = errors[0], &middle = errors[1],
                       &fine = errors[2];
          const auto order   = [](const double a, const double b) {
            return std::log2(a / b);
          };
          if (treatment == "extended")
            {
              check("  order of values p + 0.7 or more",
                    p + 0.7,
                    order(coarse.values, fine.values) / 2.);
              check("  order of gradients p - 0.3 or more",
                    p - 0.3,
                    order(coarse.gradients, fine.gradients) / 2.);
              check("  largest error of gradients falls",
                    fine.largest < middle.largest &&
                      middle.largest < coarse.largest);
            }
          else
            // First order or less in gradients, second in values.
            check("  " + treatment +
                    ": orders of values and gradients below "
                    "2.2 and 1.3",
                  order(coarse.values, fine.values) / 2. < 2.2 &&
                    order(coarse.gradients, fine.gradients) / 2. < 1.3);
        }
    }
}
