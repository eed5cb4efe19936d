// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks that points are neither lost, duplicated nor changed while they move
// between cells and processes.

#include "points.h"

#include <greville/points/points_copy.h>

// Insert, move, take out and sort points at random, beside a list of them.
template <int dim>
void
test_storage(const MultiIndex<dim> &cells)
{
  using Layout = PointLayout<dim>;
  Box<dim>               box(cells, MPI_COMM_SELF);
  const SplineSpace<dim> space(box.mesh, 2);
  const Layout           layout  = make_layout<dim>(3, true, true);
  const unsigned int     n_cells = space.owned_cells().size();
  MaterialPoints<dim>    points;
  points.reinit(space, layout);
  std::map<std::uint64_t, std::vector<double>> list;
  Random                                       random(dim);
  const auto                                   place = [&]() {
    Point<dim> x;
    for (unsigned int d = 0; d < dim; ++d)
      x[d] = space.upper_corner()[d] * (0.5 + 0.4999 * random());
    return x;
  };
  const auto cell_of = [&](const Point<dim> &x) { return space.find(x); };

  const auto insert_all = [&](const std::vector<double> &numbers) {
    for (std::size_t k = 0; k < numbers.size(); k += layout.size)
      {
        Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = numbers[k + d];
        points.insert(cell_of(x),
                      ArrayView<const double>(&numbers[k], layout.size));
      }
  };

  bool same = true, cells_ok = true, lanes = true, full = true;
  for (unsigned int step = 0; step < 40; ++step)
    {
      for (unsigned int k = 0; k < 20; ++k)
        {
          std::vector<double> values(layout.size);
          for (double &value : values)
            value = 2. + random();
          const Point<dim> x = place();
          for (unsigned int d = 0; d < dim; ++d)
            PointRef<dim>(values.data()).position(d) = x[d];
          PointRef<dim>(values.data()).id() = list.size();
          points.insert(cell_of(x), make_array_view(values));
          list[list.size()] = values;
        }

      // Some points get a new place, in some rounds all of a cell.
      std::vector<bool> left(n_cells, false);
      points.for_each([&](const unsigned int cell, const auto p) {
        if ((step % 4 == 1 && cell % 3 == step % 3) || random() > 0.5)
          {
            const Point<dim> x = place();
            for (unsigned int d = 0; d < dim; ++d)
              p.position(d) = list[p.id()][d] = x[d];
            left[cell] = true;
          }
      });
      const std::size_t   n = points.n_points();
      std::vector<double> leaving;
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        if (left[cell])
          points.remove_leaving(cell, leaving);
      full &= points.n_points() + leaving.size() / layout.size == n;
      insert_all(leaving);
      if (step % 7 == 6)
        points.defragment();

      same &= by_id(points) == list && points.n_points() == list.size();
      std::vector<unsigned int> counts(n_cells, 0);
      points.for_each([&](const unsigned int cell, const auto p) {
        ++counts[cell];
        cells_ok &=
          points.space().contains(cell, p.basis_position(points.layout()));
        cells_ok &= cell_of(p.position()) == cell;
      });
      std::vector<unsigned int> filled;
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        {
          if (counts[cell] > 0)
            filled.push_back(cell);
          cells_ok &= counts[cell] == points.n_points(cell);
        }
      cells_ok &= filled == points.cells();
      lanes &= empty_lanes_are_harmless(points);
    }
  const std::string name = std::to_string(dim) + "D, ";
  check(name + "the points of a list", on_all(same && full));
  check(name + "in their cells", on_all(cells_ok));
  check(name + "empty lanes are harmless", on_all(lanes));

  // Memory: sorted points take what freshly inserted ones take.
  MaterialPoints<dim> copy;
  copy.reinit(space, layout);
  points.for_each([&](const unsigned int cell, const auto p) {
    copy.insert(cell, make_array_view(numbers_of<dim>(points, p)));
  });
  copy.cells();
  copy.defragment();
  points.defragment();
  points.cells();
  check(name + "memory after sorting",
        on_all(points.memory_consumption() <= 1.2 * copy.memory_consumption()));
  // Groups are in the order of the cells.
  bool         sorted = true;
  unsigned int next   = 0;
  for (const unsigned int cell : points.cells())
    for (unsigned int g = points.first_group(cell);
         g != MaterialPoints<dim>::none;
         g = points.next_group(g))
      sorted &= g == next++;
  check(name + "groups are sorted", on_all(sorted));

  // A copy in single precision, which takes about half of the memory.
  PointsCopy<dim>     rounded;
  MaterialPoints<dim> restored;
  rounded.copy(points);
  restored.reinit(space, layout);
  rounded.restore(restored);
  std::map<double, std::vector<double>> originals;
  points.for_each([&](const unsigned int cell, const auto p) {
    std::vector<double> values = numbers_of<dim>(points, p);
    values.push_back(cell);
    originals[p.id()] = values;
  });
  double       rounding = 0.;
  bool         kept     = restored.n_points() == points.n_points();
  const double h        = space.cell_size(0);
  restored.for_each([&](const unsigned int cell, const auto p) {
    const auto &values = originals.at(p.id());
    kept &= cell == values.back() && p.mass() == values[Layout::mass] &&
            p.volume0() == values[Layout::volume0];
    for (unsigned int k = 0; k < layout.size; ++k)
      rounding = std::max(rounding,
                          std::abs(p[k] - values[k]) /
                            (k < dim ? h : std::max(1., std::abs(values[k]))));
  });
  check(name + "a rounded copy", on_all(kept));
  check(name + "  is as good as single precision", max_all(rounding), 1e-7);
  check(name + "  and takes little memory",
        on_all(rounded.memory_consumption() <=
               0.7 * points.memory_consumption()));

  // Groups that became empty are taken again.
  std::size_t most = 0;
  for (unsigned int step = 0; step < 20; ++step)
    {
      std::vector<double> leaving;
      points.for_each([&](const unsigned int, const auto p) {
        p.position(0) = space.upper_corner()[0] - p.position(0);
      });
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        points.remove_leaving(cell, leaving);
      insert_all(leaving);
      if (step < 2)
        most = std::max(most, points.memory_consumption());
    }
  check(name + "memory does not grow",
        on_all(points.memory_consumption() <= most &&
               points.n_points() == list.size()));
}



// Triangle wave: x reflected at 0 and at length.
double
reflect(const double x, const double length)
{
  const double t = std::fmod(std::abs(x), 2. * length);
  return t <= length ? t : 2. * length - t;
}



template <int dim>
class Motion
{
public:
  using Layout = PointLayout<dim>;

  Motion(const MultiIndex<dim> &cells)
    : box(cells)
    , space(box.mesh, 1)
  {
    random_points<dim>(
      points, space, make_layout<dim>(2, true, true), cube<dim>(2), 0.9);
    const auto own = by_id(points);
    n_all = Utilities::MPI::sum<std::uint64_t>(own.size(), MPI_COMM_WORLD);
    // The numbers of all points, on each process (they are few).
    Box<dim>               own_box(cells, MPI_COMM_SELF);
    const SplineSpace<dim> own_space(own_box.mesh, 1);
    MaterialPoints<dim>    all;
    random_points<dim>(
      all, own_space, make_layout<dim>(2, true, true), cube<dim>(2), 0.9);
    list = by_id(all);
    transport.reinit(space);
  }

  // Give each point the position of a function of its id and its place in the
  // beginning, and move it there. Returns the numbers of points that moved and
  // that were sent.
  std::array<std::uint64_t, 2>
  go(const std::function<Point<dim>(const std::uint64_t, const Point<dim> &)>
       &place)
  {
    for (auto &point : list)
      {
        Point<dim> x0;
        for (unsigned int d = 0; d < dim; ++d)
          x0[d] = point.second[Layout::reference + d];
        const Point<dim> x = place(point.first, x0);
        for (unsigned int d = 0; d < dim; ++d)
          point.second[d] = x[d];
      }
    std::vector<unsigned int> left;
    points.for_each([&](const unsigned int cell, const auto p) {
      for (unsigned int d = 0; d < dim; ++d)
        p.position(d) = list.at(p.id())[d];
      if (!points.space().contains(cell, p.basis_position(points.layout())) &&
          (left.empty() || left.back() != cell))
        left.push_back(cell);
    });
    const auto result = transport.move(points, left);
    ok &= result.n_removed == 0 && result.outside == -1;
    verify();
    return {
      {Utilities::MPI::sum<std::uint64_t>(result.n_moved, MPI_COMM_WORLD),
       Utilities::MPI::sum<std::uint64_t>(result.n_sent, MPI_COMM_WORLD)}};
  }

  // Each point is on one process, with all its numbers, in its cell.
  void
  verify()
  {
    std::vector<double> found(n_all, 0.);
    points.for_each([&](const unsigned int cell, const auto p) {
      const std::uint64_t id = p.id();
      ok &= id < n_all;
      if (id < n_all)
        found[id] += 1.;
      ok &= points.space().contains(cell, p.basis_position(points.layout()));
      ok &= numbers_of<dim>(points, p) == list.at(id);
    });
    Utilities::MPI::sum(found, MPI_COMM_WORLD, found);
    for (const double n : found)
      ok &= n == 1.;
    ok &= Utilities::MPI::sum<std::uint64_t>(points.n_points(),
                                             MPI_COMM_WORLD) == n_all;
    ok &= empty_lanes_are_harmless(points);
  }

  Box<dim>                                     box;
  SplineSpace<dim>                             space;
  MaterialPoints<dim>                          points;
  PointTransport<dim>                          transport;
  std::map<std::uint64_t, std::vector<double>> list;
  std::uint64_t                                n_all;
  bool                                         ok = true;
};



template <int dim>
void
test_motion(const MultiIndex<dim> &cells)
{
  Motion<dim> motion(cells);
  const auto &space      = motion.space;
  const bool  alone      = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
  const std::string name = std::to_string(dim) + "D, ";
  print() << name << "cells " << motion.box.mesh.n_global_active_cells()
          << ", points " << motion.n_all << std::endl;

  // Less than a cell per step: every process has neighbours to send to.
  std::uint64_t n_moved = 0, n_sent = 0, fewest_sent = -1;
  for (unsigned int step = 1; step <= 60; ++step)
    {
      const auto n =
        motion.go([&](const std::uint64_t id, const Point<dim> &x0) {
          Random     random(id);
          Point<dim> x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = reflect(x0[d] + 0.9 * step * random() * space.cell_size(d),
                           space.upper_corner()[d]);
          return x;
        });
      n_moved += n[0];
      n_sent += n[1];
      fewest_sent = std::min(fewest_sent, n[1]);
      if (step == 30)
        motion.points.defragment();
    }
  check("  steps below a cell", on_all(motion.ok));
  print() << "    moved " << n_moved << std::endl;
  check("    all steps cross borders of processes",
        alone ? n_sent == 0 : fewest_sent > 0);

  // Anywhere: owners of cells far away have to be asked for.
  n_moved     = 0;
  fewest_sent = -1;
  for (unsigned int step = 1; step <= 20; ++step)
    {
      const auto n = motion.go([&](const std::uint64_t id, const Point<dim> &) {
        Random     random(1000 * step + id);
        Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = space.upper_corner()[d] * (0.5 + 0.5 * random());
        return x;
      });
      n_moved += n[0];
      fewest_sent = std::min(fewest_sent, n[1]);
    }
  check("  far jumps", on_all(motion.ok));
  print() << "    moved " << n_moved << std::endl;
  check("    all steps cross borders of processes",
        alone || fewest_sent > motion.n_all / 8);

  // One process only has a point that jumps far.
  motion.go([&](const std::uint64_t, const Point<dim> &x0) { return x0; });
  const auto one = motion.go([&](const std::uint64_t id, const Point<dim> &x0) {
    Point<dim> x = x0;
    if (id == 0)
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = space.upper_corner()[d] - x[d];
    return x;
  });
  check("  a single jump",
        on_all(motion.ok) && one[0] == 1 && one[1] == (alone ? 0 : 1));

  // All into one cell and back.
  motion.go([&](const std::uint64_t id, const Point<dim> &) {
    Random     random(id);
    Point<dim> x;
    for (unsigned int d = 0; d < dim; ++d)
      x[d] =
        space.upper_corner()[d] - (0.5 + 0.4 * random()) * space.cell_size(d);
    return x;
  });
  check("  all in one cell",
        on_all(motion.ok) && Utilities::MPI::sum(motion.points.cells().size(),
                                                 MPI_COMM_WORLD) == 1);

  // On the walls, and on the faces between cells.
  motion.go([&](const std::uint64_t id, const Point<dim> &x0) {
    Point<dim> x = x0;
    for (unsigned int d = 0; d < dim; ++d)
      if ((id >> d) % 2 == 0)
        x[d] =
          (id / 8) % 3 == 0 ? space.lower_corner()[d] : space.upper_corner()[d];
    return x;
  });
  check("  on the walls", on_all(motion.ok));
  motion.go([&](const std::uint64_t id, const Point<dim> &x0) {
    Point<dim> x = x0;
    for (unsigned int d = 0; d < dim; ++d)
      if ((id >> d) % 2 == 0)
        x[d] = space.knots(d).element_lower(
          multi_index<dim>(space.cell_position(x0),
                           space.cells_per_direction())[d]);
    return x;
  });
  check("  on faces", on_all(motion.ok));
  motion.go([&](const std::uint64_t, const Point<dim> &x0) { return x0; });
  check("  back to the beginning", on_all(motion.ok));

  // A bit outside: they are put back.
  for (const int side : {-1, 1})
    {
      const double h = space.cell_size(1);
      motion.points.for_each([&](const unsigned int, const auto p) {
        p.position(1) = side < 0 ? space.lower_corner()[1] - 1e-12 * h
                                 : space.upper_corner()[1] + 1e-12 * h;
      });
      bool outside = true;
      motion.points.for_each([&](const unsigned int cell, const auto p) {
        outside &= !motion.points.space().contains(
          cell, p.basis_position(motion.points.layout()));
      });
      for (auto &point : motion.list)
        point.second[1] =
          side < 0 ? space.lower_corner()[1] : space.upper_corner()[1];
      const auto result =
        motion.transport.move(motion.points, motion.points.cells());
      motion.ok &= outside && result.n_removed == 0;
      motion.verify();
    }
  check("  1e-12 cells outside", on_all(motion.ok));

  // Outside: removed and reported.
  unsigned int              wrong = 0;
  const std::uint64_t       n     = motion.n_all;
  const double              nan   = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> targets[3] = {
    {space.upper_corner()[0] + 1e-7 * space.cell_size(0)},
    {space.lower_corner()[0] - 5. * space.cell_size(0)},
    {nan}};
  for (unsigned int k = 0; k < 3; ++k)
    {
      const std::uint64_t gone = (n / 2 + 17 * k) % n;
      double              y    = 0.;
      motion.points.for_each([&](const unsigned int, const auto p) {
        if (p.id() == gone)
          {
            p.position(0) = targets[k][0];
            y             = p.position(1);
          }
      });
      const auto result =
        motion.transport.move(motion.points,
                              std::vector<unsigned int>(motion.points.cells()));
      if (result.outside >= 0)
        {
          const double x = result.outside_position[0];
          wrong += std::uint64_t(result.outside) != gone ||
                   result.n_removed != 1 ||
                   !(x == targets[k][0] || (k == 2 && x != x)) ||
                   result.outside_position[1] != y;
        }
      else
        wrong += result.n_removed != 0;
      wrong += Utilities::MPI::sum<unsigned int>(result.n_removed,
                                                 MPI_COMM_WORLD) != 1;
      wrong += Utilities::MPI::sum<std::uint64_t>(motion.points.n_points(),
                                                  MPI_COMM_WORLD) != n - k - 1;
      wrong += by_id(motion.points).count(gone);
    }
  check("  points outside are removed and named", on_all(wrong == 0));
}



void
test_main()
{
  test_storage<2>({{3, 4}});
  test_storage<3>({{2, 3, 2}});
  test_motion<2>({{8, 12}});
  test_motion<2>({{9, 11}});
  test_motion<3>({{4, 6, 4}});
  test_motion<3>({{3, 5, 4}});
}
