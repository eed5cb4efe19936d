// SPDX-License-Identifier: LGPL-2.1-or-later

// Gauss points that carry what was reconstructed from material points: exact
// for polynomials, and conservative. Cells that are not full keep their points.

#include <deal.II/base/quadrature_lib.h>

#include <greville/points/reconstruction.h>

#include "points.h"

// Some polynomial of degree 2, or 1, or one of x alone.
template <int dim>
double
polynomial(const Point<dim>  &x,
           const unsigned int k,
           const unsigned int degree,
           const bool         of_x = false)
{
  Random random(100 + k);
  double result = random();
  for (unsigned int d = 0; d < (of_x ? 1 : dim); ++d)
    {
      result += random() * x[d];
      for (unsigned int e = 0; e <= d && degree == 2; ++e)
        result += random() * x[d] * x[e];
    }
  return result;
}



// Mass and momentum of the cells.
template <int dim>
std::map<unsigned int, std::vector<double>>
sums_of_cells(const MaterialPoints<dim> &points)
{
  std::map<unsigned int, std::vector<double>> sums;
  points.for_each([&](const unsigned int cell, const auto p) {
    auto &sum = sums[cell];
    sum.resize(1 + dim, 0.);
    sum[0] += p.mass();
    for (unsigned int d = 0; d < dim; ++d)
      sum[1 + d] += p.mass() * p.velocity(d);
  });
  return sums;
}

template <int dim>
std::vector<double>
total(const MaterialPoints<dim> &points)
{
  std::vector<double> result(1 + dim, 0.);
  for (const auto &cell : sums_of_cells(points))
    for (unsigned int k = 0; k <= dim; ++k)
      result[k] += cell.second[k];
  Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
  return result;
}



template <int dim>
double
cell_volume(const SplineSpace<dim> &space)
{
  double volume = 1.;
  for (unsigned int d = 0; d < dim; ++d)
    volume *= space.lattice().cell_size(d);
  return volume;
}



// Whether the points of a cell are the Gauss points with the right volumes.
template <int dim>
bool
are_gauss_points(const MaterialPoints<dim> &points,
                 const unsigned int         cell,
                 const unsigned int         n)
{
  std::vector<double> moments(3, 0.);
  const auto         &space = points.space();
  const auto corner = space.lattice().cell_corner(index_of(space, cell));
  bool       inside = true;
  points.for_each([&](const unsigned int c, const auto p) {
    if (c != cell)
      return;
    const double V = p.volume0() * p.J();
    double       t = 1., t_sum = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double s = (p[d] - corner[d]) / space.lattice().cell_size(d);
        inside &= s > 0. && s < 1.;
        t *= std::pow(s, 2 * n - 1);
        t_sum += s;
      }
    moments[0] += V;
    moments[1] += V * t;
    moments[2] += V * t_sum;
  });
  const double V = cell_volume(space);
  return inside && points.n_points(cell) == Utilities::pow(n, dim) &&
         std::abs(moments[0] / V - 1.) < 1e-13 &&
         std::abs(moments[1] / V * std::pow(2. * n, dim) - 1.) < 1e-11 &&
         std::abs(moments[2] / V - 0.5 * dim) < 1e-13;
}



// Give points stresses that are polynomials.
template <int dim>
void
set_polynomials(MaterialPoints<dim> &points,
                const unsigned int   degree,
                const bool           of_x)
{
  using Layout = PointLayout<dim>;
  points.for_each([&](const unsigned int, const auto p) {
    for (unsigned int k = 0; k < Layout::n_stress; ++k)
      p.stress(k) = polynomial<dim>(p.position(), k, degree, of_x);
  });
}

template <int dim>
double
stress_error(const MaterialPoints<dim> &points,
             const unsigned int         degree,
             const bool                 of_x)
{
  using Layout = PointLayout<dim>;
  double error = 0.;
  points.for_each([&](const unsigned int, const auto p) {
    for (unsigned int k = 0; k < Layout::n_stress; ++k)
      error =
        std::max(error,
                 std::abs(p.stress(k) -
                          polynomial<dim>(p.position(), k, degree, of_x)));
  });
  return max_all(error);
}



template <int dim>
void
test_full_cells(const MultiIndex<dim> &cells,
                const MultiIndex<dim> &n,
                const unsigned int     degree,
                const bool             of_x,
                const bool             in_cells)
{
  Box<dim>               box(cells);
  const SplineSpace<dim> space(box.mesh, 2);
  MaterialPoints<dim>    points, result;
  random_points<dim>(points, space, make_layout<dim>(1, true, true), n, 0.6);
  // A single point across lies in the middle, like that of a body.
  points.for_each([&](const unsigned int cell, const auto p) {
    const auto center = space.lattice().cell_center(index_of(space, cell));
    for (unsigned int d = 0; d < dim; ++d)
      if (n[d] == 1)
        p[d] = center[d];
  });
  set_polynomials(points, degree, of_x);
  // Densities near each other, so that all cells are full.
  points.for_each([&](const unsigned int, const auto p) {
    p.volume0() /= p.J();
    p.mass() = p.volume0() * p.J() * (5. + 0.3 * p.velocity(0));
  });
  const unsigned int        n_q = 3;
  const Reconstruction<dim> reconstruction(n_q, in_cells, 0.6);
  reconstruction.reconstruct(points, result);

  print() << dim << "D, points " << n[0];
  for (unsigned int d = 1; d < dim; ++d)
    print() << " x " << n[d];
  print() << (in_cells ? ", Taylor least squares" : ", least squares")
          << std::endl;
  bool gauss = result.cells() == points.cells() &&
               result.cells().size() == space.owned_cells().size();
  for (const unsigned int cell : result.cells())
    gauss &= are_gauss_points(result, cell, n_q);
  check("  all cells are full", on_all(gauss));
  check("  stress of degree " + std::to_string(degree),
        stress_error(result, degree, of_x),
        1e-11);
  const auto before = total(points), after = total(result);
  double     error = 0.;
  for (unsigned int k = 0; k <= dim; ++k)
    error = std::max(error, std::abs(after[k] - before[k]) / before[0]);
  check("  mass and momentum", error, 1e-13);
  auto   of_cells = sums_of_cells(points), of_new_cells = sums_of_cells(result);
  double cell_error = 0.;
  for (const unsigned int cell : points.cells())
    for (unsigned int k = 0; k <= dim; ++k)
      cell_error =
        std::max(cell_error,
                 std::abs(of_cells[cell][k] - of_new_cells[cell][k]) /
                   of_cells[cell][0]);
  cell_error = max_all(cell_error);
  if (in_cells)
    check("  of each cell", cell_error, 1e-13);
  else
    // Jittered points: cells have more or less than before.
    check("  not of each cell", cell_error > 1e-6);

  // A second time gives the same, into what was filled before.
  const auto first = result;
  reconstruction.reconstruct(points, result);
  bool                same = first.n_points() == result.n_points();
  std::vector<double> values;
  first.for_each([&](const unsigned int, const auto p) {
    const auto numbers = numbers_of<dim>(first, p);
    values.insert(values.end(), numbers.begin(), numbers.end());
  });
  std::size_t k = 0;
  result.for_each([&](const unsigned int, const auto p) {
    for (const double number : numbers_of<dim>(result, p))
      same &= k < values.size() && values[k++] == number;
  });
  check("  again", on_all(same && k == values.size()));
}



// Gauss points with exact volumes as material points: the sums of mass are
// right, so that density, velocity and loads are exact as well.
template <int dim>
void
test_all_quantities(const bool in_cells)
{
  using Layout = PointLayout<dim>;
  Box<dim>               box(cube<dim>(3));
  const SplineSpace<dim> space(box.mesh, 1);
  const Layout           layout = make_layout<dim>(0, false, true);
  MaterialPoints<dim>    points, result;
  points.reinit(space, layout);
  const QGauss<dim>   quadrature(4);
  std::vector<double> values(layout.size, 0.);
  const PointRef<dim> p(values.data());
  const auto          density = [](const Point<dim> &x) {
    return 3. + x[0] - 0.5 * x[1];
  };
  for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        Point<dim> x = space.lattice().cell_corner(index_of(space, cell));
        for (unsigned int d = 0; d < dim; ++d)
          {
            x[d] += space.lattice().cell_size(d) * quadrature.point(q)[d];
            values[d] = x[d];
          }
        for (unsigned int d = 0; d < dim; ++d)
          {
            // Momentum and force per volume have degree 2.
            p.velocity(d)                    = polynomial<dim>(x, d, 1);
            values[layout.first("load") + d] = polynomial<dim>(x, 10 + d, 1);
          }
        p.J()       = 1.25;
        p.volume0() = quadrature.weight(q) * cell_volume(space) / 1.25;
        p.mass()    = density(x) * quadrature.weight(q) * cell_volume(space);
        points.insert(cell, make_array_view(values));
      }
  const Reconstruction<dim> reconstruction(2, in_cells, 0.99);
  reconstruction.reconstruct(points, result);
  double error = 0.;
  bool   gauss =
    result.n_points() == space.owned_cells().size() * Utilities::pow(2, dim);
  result.for_each([&](const unsigned int, const auto p) {
    const Point<dim> x = p.position();
    const double     V = p.volume0() * p.J();
    error              = std::max(error, std::abs(p.mass() / V - density(x)));
    for (unsigned int d = 0; d < dim; ++d)
      {
        error =
          std::max(error, std::abs(p.velocity(d) - polynomial<dim>(x, d, 1)));
        error = std::max(error,
                         std::abs(p[result.layout().first("load") + d] -
                                  polynomial<dim>(x, 10 + d, 1)));
      }
  });
  check(std::to_string(dim) + "D, density, velocity and load" +
          (in_cells ? ", Taylor least squares" : ", least squares"),
        on_all(gauss) ? max_all(error) : 1e300,
        1e-12);
}



// Cells keep their points that have too little volume, too few points or
// densities that would become negative.
template <int dim>
void
test_other_cells(const bool in_cells)
{
  Box<dim>               box(cube<dim>(4));
  const SplineSpace<dim> space(box.mesh, 2);
  MaterialPoints<dim>    points, result;
  random_points<dim>(
    points, space, make_layout<dim>(0, false, true), cube<dim>(3), 0.5);
  points.for_each([&](const unsigned int, const auto p) {
    p.volume0() = cell_volume(space) / Utilities::pow(3, dim) / p.J();
    p.mass()    = 4. * p.volume0() * p.J();
  });
  const auto kind = [&](const unsigned int cell) {
    return space.owned_cells()[cell] % 5;
  };
  // 1: volumes just below and 2: just above the limit of 0.8 of the cell, 3:
  // as many points as polynomials, 4: nearly all mass on one side.
  MaterialPoints<dim> given;
  given.reinit(space, points.layout());
  points.for_each([&](const unsigned int cell, const auto p) {
    auto                values = numbers_of<dim>(points, p);
    const PointRef<dim> v(values.data());
    const double        t =
      (p.position(0) - space.lattice().cell_center(index_of(space, cell))[0]) /
      space.lattice().cell_size(0);
    if (kind(cell) == 1)
      v.volume0() *= 0.79;
    else if (kind(cell) == 2)
      v.volume0() *= 0.81;
    else if (kind(cell) == 4)
      v.mass() *= t > 0.2 ? 1. : 1e-3;
    if (kind(cell) == 3)
      {
        // Points in all rows and columns: 5 of 9, 9 of 27.
        unsigned int sum = 0;
        for (unsigned int k = 0, rest = p.id(); k < dim; ++k, rest /= 3)
          sum += rest % 3;
        if (sum % dim != 0)
          return;
        v.volume0() *= 3.;
      }
    given.insert(cell, make_array_view(values));
  });
  const Reconstruction<dim> reconstruction(3, in_cells, 0.8);
  reconstruction.reconstruct(given, result);

  const auto before = by_id(given);
  bool       kept = true, gauss = true, harmless = true;
  for (const unsigned int cell : given.cells())
    {
      const bool full = kind(cell) == 0 || kind(cell) == 2;
      if (full)
        gauss &= are_gauss_points(result, cell, 3);
      else
        kept &= result.n_points(cell) == given.n_points(cell);
    }
  result.for_each([&](const unsigned int cell, const auto p) {
    if (kind(cell) == 0 || kind(cell) == 2)
      return;
    const auto found = before.find(p.id());
    kept &=
      found != before.end() && found->second == numbers_of<dim>(result, p);
  });
  harmless = empty_lanes_are_harmless(result);
  const std::string name =
    std::to_string(dim) + "D, " +
    (in_cells ? "Taylor least squares, " : "least squares, ");
  check(name + "full cells", on_all(gauss && harmless));
  check(name + "other cells", on_all(kept));
  const auto sum = total(given), new_sum = total(result);
  double     error = 0.;
  for (unsigned int k = 0; k <= dim; ++k)
    error = std::max(error, std::abs(sum[k] - new_sum[k]) / sum[0]);
  check(name + "mass and momentum", error, 1e-13);
}



void
test_main()
{
  for (const bool in_cells : {true, false})
    {
      test_full_cells<2>({{5, 4}}, {{3, 3}}, 1, false, in_cells);
      test_full_cells<2>({{5, 4}}, {{4, 3}}, 2, false, in_cells);
      test_full_cells<3>({{3, 2, 3}}, {{3, 3, 3}}, 2, false, in_cells);
      // A column: one point per cell across.
      test_full_cells<2>({{7, 1}}, {{4, 1}}, 2, true, in_cells);
      test_full_cells<2>({{6, 4}}, {{5, 1}}, 1, true, in_cells);
      test_full_cells<3>({{4, 2, 2}}, {{4, 1, 1}}, 2, true, in_cells);
      test_all_quantities<2>(in_cells);
      test_all_quantities<3>(in_cells);
      test_other_cells<2>(in_cells);
      test_other_cells<3>(in_cells);
    }

  // No points at all.
  Box<2>               box(cube<2>(4));
  const SplineSpace<2> space(box.mesh, 2);
  MaterialPoints<2>    points, result;
  points.reinit(space, PointLayout<2>());
  Reconstruction<2>(3, false, 0.5).reconstruct(points, result);
  check("no points", on_all(result.n_points() == 0));
}
