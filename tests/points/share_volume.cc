// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks points that share their volume changes with neighbours: the volume is
// conserved, differences decrease, and J follows from the definition, sum by
// sum.

#include <greville/points/point_transfer.h>

#include "points.h"

// The value of a function of the space at a point of a cell.
template <int dim>
double
function_value(const SplineSpace<dim> &space,
               const unsigned int      cell,
               const unsigned int      a,
               const Point<dim>       &x)
{
  const unsigned int  n     = space.degree() + 1;
  const auto          index = space.box(cell).index;
  std::vector<double> values(n);
  double              result = 1.;
  unsigned int        rest   = a;
  for (unsigned int d = 0; d < dim; ++d, rest /= n)
    {
      space.knots(d).evaluate(index[d], x[d], 0, make_array_view(values));
      result *= values[rest % n];
    }
  return result;
}



template <int dim>
void
test(const unsigned int p)
{
  using Layout           = PointLayout<dim>;
  const std::string name = std::to_string(dim) + "D, p = " + std::to_string(p);
  Box<dim>          box(cube<dim>(dim == 2 ? 7 : 4));
  const SplineSpace<dim> space(box.mesh, p);
  PointTransfer<dim>     transfer;
  transfer.reinit(space);
  MaterialPoints<dim> points;
  random_points<dim>(points,
                     space,
                     make_layout<dim>(1, false, false),
                     cube<dim>(2),
                     0.9,
                     3,
                     0.3);
  points.for_each([](const unsigned int, const auto q) {
    q.volume0() = 1.5 + q.volume0() / 10.;
    q.J()       = 1.01;
  });
  const auto sums = [&]() {
    std::array<double, 3> result{};
    points.for_each([&](const unsigned int, const auto q) {
      const double V = q.volume0(), J = q.J();
      result[0] += V * J;
      result[1] += V * J * J;
      result[2] = std::max(result[2], std::abs(J - 1.01));
    });
    return std::array<double, 3>{
      {Utilities::MPI::sum(result[0], MPI_COMM_WORLD),
       Utilities::MPI::sum(result[1], MPI_COMM_WORLD),
       max_all(result[2])}};
  };
  transfer.share_volume(points, 0.7);
  check(name + ", the same everywhere stays", sums()[2], 1e-15);

  // Uniform compression is not changed.
  points.for_each([](const unsigned int, const auto q) {
    q.J() = 0.9 + 0.1 * pseudo_random(q.id());
  });
  const auto compressed = by_id(points);
  transfer.share_volume(points, 0.7);
  check(name + ", compressed points keep theirs",
        on_all(by_id(points) == compressed));

  points.for_each([](const unsigned int, const auto q) {
    q.J() = 1. + 0.2 * pseudo_random(q.id());
  });
  const auto before = by_id(points);
  const auto start  = sums();

  // J_i by the definition.
  VectorType volumes, changes, torn, sizes;
  for (VectorType *vector : {&volumes, &changes, &torn, &sizes})
    space.initialize_vector(*vector);
  const unsigned int n_functions =
    Utilities::pow<unsigned int>(p + 1, int(dim));
  points.for_each([&](const unsigned int cell, const auto q) {
    for (unsigned int a = 0; a < n_functions; ++a)
      {
        const unsigned int i = space.cell_functions(cell)[a];
        const double       V =
          q.volume0() * function_value(space, cell, a, q.position());
        volumes.local_element(i) += V;
        const double J = q.J();
        changes.local_element(i) += V * J;
        torn.local_element(i) += V * std::max(J - 1., 0.);
        sizes.local_element(i) += V * std::abs(J - 1.);
      }
  });
  for (VectorType *vector : {&volumes, &changes, &torn, &sizes})
    vector->compress(VectorOperation::add);
  for (unsigned int i = 0; i < volumes.locally_owned_size(); ++i)
    if (volumes.local_element(i) > 0.)
      {
        changes.local_element(i) /= volumes.local_element(i);
        torn.local_element(i) /= sizes.local_element(i);
      }
  changes.update_ghost_values();
  torn.update_ghost_values();

  transfer.share_volume(points, 0.3);
  double error = 0.;
  bool   same  = true;
  points.for_each([&](const unsigned int cell, const auto q) {
    const auto &old = before.at(q.id());
    double      J   = old[Layout::J];
    for (unsigned int a = 0; a < n_functions; ++a)
      {
        const unsigned int i = space.cell_functions(cell)[a];
        J += 0.3 * torn.local_element(i) *
             (changes.local_element(i) - old[Layout::J]) *
             function_value(space, cell, a, q.position());
      }
    error = std::max(error, std::abs(q.J() - J));
    for (unsigned int k = 0; k < points.layout().size; ++k)
      same &= k == Layout::J || q[k] == old[k];
  });
  check(name + ", J as defined", max_all(error), 1e-13);
  check(name + ", nothing else changes", on_all(same));
  const auto end = sums();
  check(name + ", the volume is kept", std::abs(end[0] / start[0] - 1.), 1e-14);
  check(name + ", differences fall", on_all(end[1] < start[1]));
  check(name + ", empty lanes are harmless",
        on_all(empty_lanes_are_harmless(points)));
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    test<2>(p);
  for (unsigned int p = 1; p <= 3; ++p)
    test<3>(p);
}
