// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3

// Checks host cells and function classes on drawings, and that extension
// reproduces polynomials, also at walls.

#include <filling.h>

// Characters of all functions or cells of the grid, rows from the top.
void
print_map(const std::vector<std::pair<std::uint64_t, char>> &own,
          const MultiIndex<2>                               &extents)
{
  std::vector<unsigned int> all(std::uint64_t{extents[0]} * extents[1], 0);
  for (const auto &entry : own)
    all[entry.first] = entry.second;
  Utilities::MPI::sum(all, MPI_COMM_WORLD, all);
  for (unsigned int y = extents[1]; y-- > 0;)
    {
      for (unsigned int x = 0; x < extents[0]; ++x)
        print() << char(all[y * extents[0] + x]);
      print() << std::endl;
    }
}



// Return whether a cell and its neighbours are well-filled in the drawing.
bool
is_core(const std::vector<std::string> &rows, const int x, const int y)
{
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (y + dy < 0 || y + dy >= int(rows.size()) || x + dx < 0 ||
          x + dx >= int(rows[0].size()) || rows[y + dy][x + dx] != '#')
        return false;
  return true;
}



// A number that stands for all pairs of a cell and a host of it, also if the
// drawing is turned by a right angle beforehand, and the pairs back afterwards.
double
sum_of_hosts(const std::vector<std::string> &rows, const bool turn)
{
  const unsigned int       n_x = rows[0].size(), n_y = rows.size();
  std::vector<std::string> turned(n_x, std::string(n_y, '.'));
  for (unsigned int x = 0; x < n_x; ++x)
    for (unsigned int row = 0; row < n_y; ++row)
      turned[n_x - 1 - x][row] = rows[row][x];
  Box<2> box(turn ? MultiIndex<2>{{n_y, n_x}} : MultiIndex<2>{{n_x, n_y}});
  const SplineSpace<2> space(box.mesh, 1);
  CellFilling<2>       filling(space);
  filling.update(fillings<2>(space, drawing(turn ? turned : rows)), 0.8);
  const auto back = [&](const std::uint64_t cell) {
    return turn ? cell / n_y + n_x * (n_y - 1 - cell % n_y) : cell;
  };
  double sum = 0.;
  for (const auto &entry : filling.hosts())
    sum += pseudo_random(n_x * n_y * back(space.owned_cells()[entry.first]) +
                         back(entry.second));
  return Utilities::MPI::sum(sum, MPI_COMM_WORLD);
}



// Hosts are #, other cells have the column of their hosts in base 36 as a
// letter or digit, * if these are in several columns, or ? without a host.
void
test_drawing(const std::vector<std::string> &rows, const unsigned int p)
{
  const MultiIndex<2> cells{
    {(unsigned int)rows[0].size(), (unsigned int)rows.size()}};
  Box<2>               box(cells);
  const SplineSpace<2> space(box.mesh, p);
  CellFilling<2>       filling(space);
  check("changed", filling.update(fillings<2>(space, drawing(rows)), 0.8));
  check("not changed", !filling.update(fillings<2>(space, drawing(rows)), 0.8));

  std::vector<std::pair<std::uint64_t, char>> map;
  for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
    map.emplace_back(space.owned_cells()[c], '.');
  for (const unsigned int c : filling.filled_cells())
    map[c].second = filling.is_host(c) ? '#' : '?';
  for (const auto &entry : filling.hosts())
    {
      const unsigned int column = entry.second % cells[0];
      const char         name = column < 10 ? '0' + column : 'a' + column - 10;
      char              &mark = map[entry.first].second;
      mark                    = mark == '?' || mark == name ? name : '*';
    }
  print() << "Hosts:" << std::endl;
  print_map(map, cells);

  // Cells inside the body host themselves, and cells around them have hosts
  // inside.
  const auto is_core_cell = [&](const std::uint64_t cell) {
    return is_core(rows, cell % cells[0], cells[1] - 1 - cell / cells[0]);
  };
  bool is_right = true;
  for (const auto &entry : filling.hosts())
    is_right = is_right && (rows.size() == 2 || is_core_cell(entry.second));
  for (const unsigned int c : filling.filled_cells())
    {
      const std::uint64_t cell = space.owned_cells()[c];
      const int x = cell % cells[0], y = cells[1] - 1 - cell / cells[0];
      bool      near_core = false;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          near_core = near_core || is_core(rows, x + dx, y + dy);
      is_right = is_right && (filling.is_host(c) || !is_core_cell(cell)) &&
                 (!near_core || map[c].second != '?');
    }
  check("cells near the inside have hosts there", max_all(!is_right), 0.);
  check("turned hosts",
        std::abs(sum_of_hosts(rows, true) - sum_of_hosts(rows, false)),
        1e-10);

  const Extension<2> extension(space, filling);
  map.clear();
  for (unsigned int f = 0; f < space.owned_functions().size(); ++f)
    map.emplace_back(space.owned_functions()[f], ".sel"[extension[f]]);
  print() << "Functions, p = " << p << ":" << std::endl;
  print_map(map, space.n_functions());
  const auto counts = extension.counts();
  print() << counts.stable << " stable, " << counts.extended << " extended, "
          << counts.lumped << " lumped; fragments: " << filling.n_fragments()
          << std::endl;
}



template <int dim>
void
test_polynomials(const unsigned int  n,
                 const unsigned int  p,
                 const Filling<dim> &is_filled,
                 const std::string  &name)
{
  Box<dim>               box(cube<dim>(n));
  const SplineSpace<dim> space(box.mesh, p);
  CellFilling<dim>       filling(space);
  filling.update(fillings<dim>(space, is_filled), 0.8);
  const Extension<dim> extension(space, filling);
  const auto           counts = extension.counts();
  print() << dim << "D, p = " << p << ", " << name << ": " << counts.stable
          << " stable, " << counts.extended << " extended, " << counts.lumped
          << " lumped" << std::endl;

  double                     error = 0., sum = 0., size = 0.;
  bool                       hosts_are_stable = true;
  std::vector<std::uint64_t> positions;
  std::vector<double>        weights;
  unsigned int               n_owned = 0;
  std::vector<bool>          is_owned_stable(space.n_dofs(), false);
  for (unsigned int f = 0; f < space.owned_functions().size(); ++f)
    is_owned_stable[space.owned_functions()[f]] =
      extension[f] == Extension<dim>::stable;
  for (const unsigned int f : extension.extended_functions())
    {
      extension.row(f, positions, weights);
      const std::uint64_t position = space.function_position(f);
      const double        wanted   = coefficient(space, position);
      double              value = 0., scale = 1e-3;
      for (unsigned int k = 0; k < positions.size(); ++k)
        {
          const double term = weights[k] * coefficient(space, positions[k]);
          value += term;
          scale = std::max(scale, std::abs(term));
        }
      error = std::max(error, std::abs(value - wanted) / scale);
      if (f >= space.owned_functions().size())
        continue;
      ++n_owned;
      for (unsigned int k = 0; k < positions.size(); ++k)
        {
          if (std::binary_search(space.owned_functions().begin(),
                                 space.owned_functions().end(),
                                 positions[k]))
            hosts_are_stable =
              hosts_are_stable && is_owned_stable[positions[k]];
          sum += weights[k] * pseudo_random(31 * position + positions[k]);
          size += std::abs(weights[k]);
        }
    }
  check("  polynomials", max_all(error), 1e-12);
  check("  hosts have stable functions only", max_all(!hosts_are_stable), 0.);
  sum  = Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  size = Utilities::MPI::sum(size, MPI_COMM_WORLD);
  print() << "  mean of all weights at random: " << std::setprecision(5)
          << sum / size << std::endl;
}



void
test_main()
{
  // A body with a fringe, and a second one behind a gap of an empty cell, whose
  // cells are all cut.
  test_drawing({"+++++.......",
                "+####.......",
                "+####.++....",
                "+####.++....",
                ".+##+......."},
               2);
  // Chains of cut cells, one longer than hosts reach; a host across a corner.
  test_drawing({"###+++++..", "###.......", "###......+", "...+......"}, 1);
  test_drawing({"++..+..###", "+...+..###", "....++.###", "......+..."}, 3);
  // A hole, a cross, and strips less than three cells wide.
  test_drawing({".+++++++..#+.....",
                "+########.###.###",
                "+########..#+.###",
                "+###.####......#.",
                "+########.##...#.",
                ".+#####++.##...#.",
                "..##+............"},
               2);
  // A box of two cells has no surface there.
  test_drawing({"########", "########"}, 2);

  for (unsigned int p = 1; p <= 5; ++p)
    {
      test_polynomials<2>(12, p, ball<2>(12, 6., 3.6), "disk");
      test_polynomials<2>(8, p, ball<2>(8, 4., 3.2), "disk at walls");
      test_polynomials<2>(8, p, ball<2>(8, 0., 3.2), "disk in a corner");
    }
  for (unsigned int p = 1; p <= 5; ++p)
    test_polynomials<3>(5, p, ball<3>(5, 1.5, 1.6), "ball");
}
