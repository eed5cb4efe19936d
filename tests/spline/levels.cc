// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks refined grids: the rules of refinement, functions of a cell, smooth
// splines between levels, and polynomials, also at cut surfaces that cross
// levels.

#include <filling.h>
#include <refined_box.h>

// The value at x in an owned cell of a derivative in one direction of a spline
// with coefficients by local function.
template <int dim>
double
evaluate(const SplineSpace<dim>    &space,
         const std::vector<double> &coefficients,
         const unsigned int         cell,
         const Point<dim>          &x,
         const unsigned int         direction,
         const unsigned int         derivative)
{
  const unsigned int               n     = space.degree() + 1;
  const auto                       index = space.box(cell).index;
  std::vector<std::vector<double>> values(dim, std::vector<double>(n));
  for (unsigned int d = 0; d < dim; ++d)
    space.knots(d).evaluate(index[d],
                            x[d],
                            d == direction ? derivative : 0,
                            make_array_view(values[d]));
  double result = 0.;
  for (unsigned int k = 0; k < space.n_dofs_per_cell(); ++k)
    {
      double value = coefficients[space.cell_functions(cell)[k]];
      for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= n)
        value *= values[d][rest % n];
      result += value;
    }
  return result;
}



// The largest jump of a derivative of order below p between neighbours.
template <int dim>
double
largest_jump(const SplineSpace<dim>    &space,
             const std::vector<double> &coefficients,
             const std::vector<double> &parts)
{
  double result = 0.;
  for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
    for (unsigned int d = 0; d < dim; ++d)
      {
        const CellBox<dim> box = space.box(cell);
        Point<dim>         x   = box.lower;
        for (unsigned int e = 0; e < dim; ++e)
          x[e] += e == d ? 0. : 0.37 * box.size[e];
        for (const double side : {0., 1.})
          {
            Point<dim> at = x, beyond = x;
            at[d] += side * box.size[d];
            beyond[d] = at[d] + (side - 0.5) * 0.01 * box.size[d];
            const unsigned int other = space.find(beyond);
            if (beyond[d] < 0. || beyond[d] > 1. || parts[cell] < 1. ||
                other == numbers::invalid_unsigned_int || parts[other] < 1.)
              continue;
            double scale = 1.;
            for (unsigned int k = 0; k < std::min(space.degree(), 3u);
                 ++k, scale *= box.size[d])
              result =
                std::max(result,
                         scale *
                           std::abs(
                             evaluate(space, coefficients, cell, at, d, k) -
                             evaluate(space, coefficients, other, at, d, k)));
          }
      }
  return result;
}



template <int dim>
void
test(const std::string                               &name,
     const unsigned int                               p,
     const std::shared_ptr<const CellHierarchy<dim>> &levels,
     const std::function<double(const Point<dim> &)> &part_at)
{
  RefinedBox<dim>        box(levels);
  const SplineSpace<dim> space(box.mesh, p);
  std::vector<double>    parts;
  for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
    parts.push_back(part_at(space.box(c).center));
  CellFilling<dim> filling(space);
  filling.update(parts, 0.8);
  const Extension<dim> extension(space, filling);
  const auto           counts = extension.counts();
  print() << dim << "D, p = " << p << ", " << name << ": "
          << box.mesh.n_global_active_cells() << " cells, " << counts.stable
          << " stable, " << counts.extended << " extended, " << counts.lumped
          << " lumped" << std::endl;

  const unsigned int n_local =
    space.owned_functions().size() + space.ghost_functions().size();
  std::vector<double> wanted(n_local), found(n_local), noise(n_local);
  const auto          noise_at = [&](const std::uint64_t position) {
    return pseudo_random(position);
  };
  for (unsigned int f = 0; f < n_local; ++f)
    {
      const std::uint64_t position = space.function_position(f);
      wanted[f] = found[f] = coefficient(space, position);
      noise[f]             = noise_at(position);
    }
  double                     error = 0., largest_weight = 0., sum_error = 0.;
  std::vector<std::uint64_t> positions;
  std::vector<double>        weights;
  for (const unsigned int f : extension.extended_functions())
    {
      extension.row(f, positions, weights);
      found[f] = noise[f] = 0.;
      double sum          = 0.;
      for (unsigned int k = 0; k < positions.size(); ++k)
        {
          found[f] += weights[k] * coefficient(space, positions[k]);
          noise[f] += weights[k] * noise_at(positions[k]);
          sum += weights[k];
          largest_weight = std::max(largest_weight, std::abs(weights[k]));
        }
      error     = std::max(error, std::abs(found[f] - wanted[f]));
      sum_error = std::max(sum_error, std::abs(sum - 1.));
    }
  largest_weight = max_all(largest_weight);
  check("  polynomials", max_all(error), 1e-12 * std::max(1., largest_weight));
  check("  sums of weights", max_all(sum_error), 1e-11);
  check("  smooth between cells",
        max_all(largest_jump(space, noise, parts)),
        1e-10 * std::max(1., largest_weight));

  // The functions of cells.
  unsigned int most = 0;
  for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
    if (parts[c] == 1.)
      {
        std::set<std::uint64_t> functions;
        for (const unsigned int f : space.cell_functions(c))
          if (extension[f] == Extension<dim>::extended)
            {
              extension.row(f, positions, weights);
              functions.insert(positions.begin(), positions.end());
            }
          else
            functions.insert(space.function_position(f));
        most = std::max<unsigned int>(most, functions.size());
      }
  most = Utilities::MPI::max(most, MPI_COMM_WORLD);
  print() << "  largest weight " << std::setprecision(4) << largest_weight;
  // At surfaces, round-off chooses between hosts at the same distance, which
  // have different functions.
  if (counts.lumped == 0)
    print() << ", most functions of a full cell " << most;
  else
    check_range("  most functions of a full cell", most, 8, 39);
  print() << std::endl;
}



template <int dim>
double
disk(const Point<dim> &x, const double radius)
{
  Point<dim> center;
  for (unsigned int d = 0; d < dim; ++d)
    center[d] = 0.5 + 0.01 * d;
  const double r = x.distance(center) - radius;
  return r < 0. ? 1. : r < 0.04 ? 0.3 : 0.;
}



void
test_main()
{
  const auto full = [](const auto &) { return 1.; };
  for (unsigned int p = 1; p <= 3; ++p)
    {
      const auto ball = [](const unsigned int l, const Point<2> &x) {
        return x.distance(Point<2>(0.5, 0.45)) < (l == 0 ? 0.2 : 0.1);
      };
      test<2>("ball", p, hierarchy<2>(12, 2, p, ball), full);
      const auto stripe = [](const unsigned int, const Point<2> &x) {
        return std::abs(x[0] - 0.7 * x[1] - 0.1) < 0.03;
      };
      test<2>("oblique layer", p, hierarchy<2>(8, 3, p, stripe), full);
      const auto half = [](const unsigned int, const Point<2> &x) {
        return x[0] > 0.5;
      };
      test<2>("disk, half of it refined",
              p,
              hierarchy<2>(16, 1, p, half),
              [](const Point<2> &x) { return disk<2>(x, 0.31); });
      const auto low = [](const unsigned int l, const Point<2> &x) {
        return x[1] < (l == 0 ? 0.5 : 0.3);
      };
      test<2>("disk on two levels",
              p,
              hierarchy<2>(20, 2, p, low),
              [](const Point<2> &x) { return disk<2>(x, 0.37); });
    }
  const auto corner = [](const unsigned int, const Point<3> &x) {
    return x.norm() < 0.4;
  };
  test<3>("corner", 2, hierarchy<3>(8, 1, 2, corner), full);
  test<3>("ball in a corner",
          2,
          hierarchy<3>(8, 1, 2, corner),
          [](const auto &x) { return disk<3>(x, 0.4); });
}
