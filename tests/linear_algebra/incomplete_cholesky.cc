// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks IC(0): exact for a Kronecker product in lexicographic order, raised
// pivots, shifts, errors, and the same result for all vector widths.

#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/paper/assembled_mass_level.h>
#include <greville/paper/schwarz.h>

#include <tests.h>

UpperTriangle
upper_part(const std::vector<std::vector<double>> &rows)
{
  UpperTriangle result;
  for (unsigned int i = 0; i < rows.size(); ++i)
    {
      for (unsigned int j = i; j < rows.size(); ++j)
        if (rows[i][j] != 0. || i == j)
          {
            result.columns.push_back(j);
            result.values.push_back(rows[i][j]);
          }
      result.row_begin.push_back(result.columns.size());
    }
  return result;
}



std::vector<double>
multiply(const UpperTriangle &matrix, const std::vector<double> &x)
{
  std::vector<double> y(x.size(), 0.);
  for (unsigned int i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1]; ++e)
      {
        const unsigned int j = matrix.columns[e];
        y[i] += matrix.values[e] * x[j];
        if (j != i)
          y[j] += matrix.values[e] * x[i];
      }
  return y;
}



// The residual |b - M x| / |b| of one solve.
double
residual(const UpperTriangle &matrix, const IncompleteCholesky &factors)
{
  std::vector<double> x(matrix.size());
  for (unsigned int i = 0; i < x.size(); ++i)
    x[i] = pseudo_random(i);
  const auto b = multiply(matrix, x);
  x            = b;
  factors.solve(x.data(), 1);
  const auto y    = multiply(matrix, x);
  double     left = 0., all = 0.;
  for (unsigned int i = 0; i < x.size(); ++i)
    {
      left += std::pow(b[i] - y[i], 2);
      all += b[i] * b[i];
    }
  return std::sqrt(left / all);
}



template <int dim>
void
test_kronecker(const unsigned int n_cells, const unsigned int p)
{
  print() << dim << "D, p = " << p << std::endl;
  Box<dim>                               box(cube<dim>(n_cells));
  const SplineSpace<dim>                 space(box.mesh, p);
  const Functions::ConstantFunction<dim> one(1.);
  const DensityWeights<dim>              weights(space, p + 1, one);
  AssembledMassLevel<dim>                mass(space, weights);
  mass.assemble(true, true);
  Mat matrix;
  check_petsc(MatGetDiagonalBlock(mass.matrix(), &matrix));
  const UpperTriangle lower = upper_triangle(matrix);
  IncompleteCholesky  factors;
  factors.factorize(lower);
  // L is kept in single precision.
  check("  exact", residual(lower, factors), 1e-6);
  check("  no shift, no raised pivot",
        factors.shift() == 0. && factors.n_raised() == 0);

  const unsigned int               n = lower.size();
  std::vector<std::vector<double>> alone;
  double                           error = 0.;
  for (const unsigned int width : {1, 2, 4, 8})
    {
      std::vector<double> x(n * width);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int c = 0; c < width; ++c)
          x[i * width + c] = pseudo_random(8 * i + c);
      factors.solve(x.data(), width);
      for (unsigned int c = 0; c < width; ++c)
        {
          std::vector<double> y(n);
          for (unsigned int i = 0; i < n; ++i)
            y[i] = pseudo_random(8 * i + c);
          factors.solve(y.data(), 1);
          double largest = 0.;
          for (const double value : y)
            largest = std::max(largest, std::abs(value));
          for (unsigned int i = 0; i < n; ++i)
            error =
              std::max(error, std::abs(y[i] - x[i * width + c]) / largest);
        }
    }
  check("  widths", error, 1e-5);
}



void
test_fails(const std::string        &name,
           const UpperTriangle      &matrix,
           const CholeskyParameters &parameters = {})
{
  IncompleteCholesky factors;
  try
    {
      factors.factorize(matrix, parameters);
      print() << name << ": FAILED, no error" << std::endl;
    }
  catch (const std::exception &error)
    {
      print() << name << ": " << message_of(error) << std::endl;
    }
}



// A full matrix, whose IC(0) is exact: positive definite, of this size.
std::vector<std::vector<double>>
full_matrix(const unsigned int n)
{
  std::vector<std::vector<double>> rows(n, std::vector<double>(n));
  for (unsigned int i = 0; i < n; ++i)
    for (unsigned int j = 0; j < n; ++j)
      rows[i][j] = std::pow(0.6, std::abs(int(i) - int(j))) + (i == j);
  return rows;
}



// ICT: fill is kept, and small entries are dropped, which the error follows.
void
test_drop_tolerance()
{
  // A Laplacian on a grid, whose factors have fill between the bands.
  constexpr unsigned int           n = 12;
  std::vector<std::vector<double>> rows(n * n, std::vector<double>(n * n));
  for (unsigned int i = 0; i < n * n; ++i)
    {
      rows[i][i] = 4.;
      if (i % n > 0)
        rows[i][i - 1] = rows[i - 1][i] = -1.;
      if (i >= n)
        rows[i][i - n] = rows[i - n][i] = -1.;
    }
  const UpperTriangle matrix = upper_part(rows);
  IncompleteCholesky  factors;
  factors.factorize(matrix);
  const std::size_t n_of_ic0 = factors.n_entries();
  check("entries of IC(0)", n_of_ic0 == 2 * n * (n - 1));
  std::size_t last = n_of_ic0;
  for (const double tolerance : {0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-8})
    {
      factors.factorize(matrix, {0., tolerance});
      check("ICT: residual / tolerance",
            residual(matrix, factors) / std::max(tolerance, 2e-7),
            5.);
      check("  more entries", factors.n_entries() > last || tolerance == 0.3);
      check("  no shift", factors.shift() == 0.);
      last = factors.n_entries();
    }
  check("entries of the whole factor", last > 5 * n_of_ic0);
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    test_kronecker<2>(9, p);
  for (unsigned int p = 1; p <= 3; ++p)
    test_kronecker<3>(4, p);

  {
    // Scaled, the second pivot is 1e-7, the others are 1.
    const UpperTriangle matrix =
      upper_part({{4., 2., 0.}, {2., 1. + 1e-7, 0.}, {0., 0., 9.}});
    IncompleteCholesky factors;
    factors.factorize(matrix);
    print() << "Raised pivots: " << factors.n_raised() << ", shift "
            << factors.shift() << std::endl;
    std::vector<double> x{0., 1., 9.};
    factors.solve(x.data(), 1);
    print() << "  1 / raised pivot " << std::setprecision(6) << x[1]
            << ", other row " << x[2] << std::endl;
  }
  {
    // D. Kershaw's matrix (1978): positive definite, but the last pivot of
    // IC(0) is -5 / 3 of its diagonal entry.
    const UpperTriangle matrix = upper_part({{3., -2., 0., 2.},
                                             {-2., 3., -2., 0.},
                                             {0., -2., 3., -2.},
                                             {2., 0., -2., 3.}});
    IncompleteCholesky  factors;
    factors.factorize(matrix);
    print() << "Shift: " << factors.shift() << ", raised pivots "
            << factors.n_raised() << std::endl;
    // Positive definite: x^T P^-1 x > 0.
    double least = 1e300;
    for (unsigned int k = 0; k < 100; ++k)
      {
        std::vector<double> x(4), y;
        for (unsigned int i = 0; i < 4; ++i)
          x[i] = pseudo_random(4 * k + i);
        y = x;
        factors.solve(y.data(), 1);
        double product = 0.;
        for (unsigned int i = 0; i < 4; ++i)
          product += x[i] * y[i];
        least = std::min(least, product);
      }
    check("  positive", least > 0.);
    const double found = factors.shift();
    factors.factorize(matrix, {2. * found, 0.});
    check("  a shift that is asked for", factors.shift() == 2. * found);
    test_fails("No larger shift", matrix, {0.1, 0., 0.1});
  }
  {
    // The unit of mass does not matter, as small as it may be.
    const std::vector<std::vector<double>> rows  = {{4., 2., 0.},
                                                    {2., 3., 1e-5},
                                                    {0., 1e-5, 1e-8}};
    double                                 error = 0.;
    std::vector<double>                    first;
    for (const double unit : {1., 1e-42, 1e-90, 1e60})
      {
        auto scaled = rows;
        for (auto &row : scaled)
          for (double &entry : row)
            entry *= unit;
        IncompleteCholesky factors;
        factors.factorize(upper_part(scaled));
        std::vector<double> x{unit, -unit, 1e-4 * unit};
        factors.solve(x.data(), 1);
        if (first.empty())
          first = x;
        for (unsigned int i = 0; i < 3; ++i)
          {
            const double difference = std::abs(x[i] / first[i] - 1.);
            error = difference <= error ? error : // also not a number
                      std::isfinite(difference) ? difference
                                                : 1e300;
          }
      }
    check("the unit of mass does not matter", error, 1e-5);
  }
  test_drop_tolerance();
  test_fails("Not definite", upper_part({{1., 100.}, {100., 1.}}));
  test_fails("Negative diagonal", upper_part({{1., 0.}, {0., -1.}}));
  test_fails("Zero diagonal", upper_part({{0.}}));
}
