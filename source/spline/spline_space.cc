// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.templates.h>
#include <deal.II/base/mpi_consensus_algorithms.h>
#include <deal.II/fe/fe_bernstein.h>

#include <greville/base/index_limits.h>
#include <greville/spline/spline_space.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  SplineSpace<dim>::SplineSpace(DistributedTriangulation<dim> &triangulation,
                                const unsigned int             degree,
                                const bool                     on_parents)
  {
    reinit(triangulation, degree, on_parents);
  }



  template <int dim>
  void
  SplineSpace<dim>::reinit(DistributedTriangulation<dim> &triangulation,
                           const unsigned int             degree,
                           const bool                     on_parents)
  {
    Require(degree >= 1 && degree <= max_degree,
            "A spline space has an order from 1 to " +
              std::to_string(max_degree) + ", not " + std::to_string(degree) +
              ".");

    SpaceCells<dim>::reinit(triangulation, on_parents);
    p                  = degree;
    functions_per_cell = Utilities::fixed_power<dim>(p + 1);

    for (unsigned int d = 0; d < dim; ++d)
      make_knots(d);
    count_functions();

    element = std::make_unique<FE_Bernstein<dim>>(p);

    find_owned_functions();
    number_functions();
    make_partitioner();
  }



  template <int dim>
  void
  SplineSpace<dim>::make_knots(const unsigned int d)
  {
    const unsigned int n = mesh_lattice.n_cells()[d];
    if (mesh_lattice.is_periodic(d))
      {
        Require(n > p,
                "A grid that is periodic in " + std::string(1, "xyz"[d]) +
                  " needs at least order + 1 = " + std::to_string(p + 1) +
                  " cells in this direction; it has " + std::to_string(n) +
                  ".");
        knot_vectors[d] = KnotVector::periodic_uniform(p,
                                                       n,
                                                       mesh_lattice.lower()[d],
                                                       mesh_lattice.upper()[d]);
        extents[d]      = n;
        anchor_cells[d].resize(n);
        for (unsigned int i = 0; i < n; ++i)
          anchor_cells[d][i] = (i + n - p / 2) % n;
        return;
      }
    extents[d] = n + p;
    anchor_cells[d].assign(extents[d], numbers::invalid_unsigned_int);
    const std::vector<double> &edges = mesh_lattice.edges(d);
    if (edges.empty())
      {
        knot_vectors[d] = KnotVector::open_uniform(p,
                                                   n,
                                                   mesh_lattice.lower()[d],
                                                   mesh_lattice.upper()[d]);

        // Greville abscissae in units of cells, in exact integer arithmetic.
        for (unsigned int i = 0; i < extents[d]; ++i)
          {
            unsigned int sum = 0;
            for (unsigned int k = i + 1; k <= i + p; ++k)
              sum += std::min(k - std::min(k, p), n);
            anchor_cells[d][i] = std::min(sum / p, n - 1);
          }
        return;
      }
    std::vector<unsigned int> begin = {0}, size = {n};
    if (const CellHierarchy<dim> *levels = mesh_lattice.hierarchy())
      {
        begin.resize(levels->n_levels());
        size.resize(levels->n_levels());
        for (unsigned int l = 0; l < levels->n_levels(); ++l)
          {
            begin[l] = levels->offset(l)[d];
            size[l]  = levels->n_cells(l)[d];
          }
      }
    knot_vectors[d] = KnotVector::of_levels(p, edges, begin, size);
    for (unsigned int l = 0; l < begin.size(); ++l)
      for (unsigned int i = begin[l]; i < begin[l] + size[l] + p; ++i)
        {
          const auto first = edges.begin() + begin[l];
          anchor_cells[d][i] =
            std::upper_bound(first + 1,
                             first + size[l],
                             knot_vectors[d].greville_abscissa(i)) -
            edges.begin() - 1;
        }
  }



  template <int dim>
  MultiIndex<dim>
  SplineSpace<dim>::anchor_cell(const MultiIndex<dim> &function) const
  {
    MultiIndex<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = anchor_cells[d][function[d]];
    const CellHierarchy<dim> *levels = mesh_lattice.hierarchy();
    if (!levels || levels->is_active(result))
      return result;
    MultiIndex<dim> local_extents, nearest = result;
    local_extents.fill(p + 1);
    unsigned int smallest = numbers::invalid_unsigned_int;
    for (unsigned int k = 0; k < functions_per_cell; ++k)
      {
        const auto      offset = multi_index<dim>(k, local_extents);
        MultiIndex<dim> cell   = function;
        unsigned int    square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            cell[d] -= offset[d];
            square += Utilities::fixed_power<2>(int(cell[d]) - int(result[d]));
          }
        if (square < smallest && levels->is_active(cell))
          {
            smallest = square;
            nearest  = cell;
          }
      }
    return nearest;
  }



  template <int dim>
  void
  SplineSpace<dim>::append_functions_of(const MultiIndex<dim> &cell)
  {
    // Without levels, the functions of a cell form a contiguous range in each
    // direction, also in a periodic one.
    MultiIndex<dim> begin = cell, length;
    length.fill(p + 1);
    for (unsigned int d = 0; d < dim && !mesh_lattice.hierarchy(); ++d)
      {
        if (mesh_lattice.is_periodic(d))
          {
            begin[d]  = wrapped(cell[d] + p / 2, d);
            length[d] = 1;
            continue;
          }
        const auto range = std::equal_range(anchor_cells[d].begin(),
                                            anchor_cells[d].end(),
                                            cell[d]);
        begin[d]         = range.first - anchor_cells[d].begin();
        length[d]        = range.second - range.first;
      }
    const std::uint64_t n = std::accumulate(length.begin(),
                                            length.end(),
                                            std::uint64_t(1),
                                            std::multiplies<std::uint64_t>());
    for (std::uint64_t k = 0; k < n; ++k)
      {
        MultiIndex<dim> function = multi_index<dim>(k, length);
        for (unsigned int d = 0; d < dim; ++d)
          function[d] += begin[d];
        if (!mesh_lattice.hierarchy() || anchor_cell(function) == cell)
          owned.push_back(lexicographic<dim>(function, extents));
      }
  }



  template <int dim>
  void
  SplineSpace<dim>::find_owned_functions()
  {
    owned.clear();
    for (const std::uint64_t position : cells)
      append_functions_of(multi_index<dim>(position, mesh_lattice.n_cells()));
    std::sort(owned.begin(), owned.end());

    first_owned = sum_before(owned.size(), comm);
    if (mesh_lattice.hierarchy())
      n_all = checked_index<types::global_dof_index>(
        Utilities::MPI::sum(std::uint64_t(owned.size()), comm),
        "functions of a grid");
  }



  template <int dim>
  void
  SplineSpace<dim>::number_functions()
  {
    // The functions of a cell are runs of p + 1 in x, which continue at 0 if x
    // is periodic. Owned parts of a run are contiguous in owned, so one search
    // per run mostly suffices.
    const unsigned int n_runs = functions_per_cell / (p + 1);
    MultiIndex<dim>    runs;
    runs.fill(p + 1);
    runs[0] = 1;

    cell_function_numbers.resize(cells.size() * functions_per_cell);
    std::vector<std::pair<std::size_t, std::uint64_t>> others; // with positions
    std::size_t                                        slot = 0;
    for (const std::uint64_t c : cells)
      {
        const auto cell = multi_index<dim>(c, mesh_lattice.n_cells());
        for (unsigned int r = 0; r < n_runs; ++r)
          {
            MultiIndex<dim> function = multi_index<dim>(r, runs);
            for (unsigned int d = 1; d < dim; ++d)
              function[d] = wrapped(function[d] + cell[d], d);
            const std::uint64_t line = lexicographic<dim>(function, extents);
            auto                hint = owned.end();
            for (unsigned int a = 0; a <= p; ++a, ++slot)
              {
                const unsigned int  x        = wrapped(cell[0] + a, 0);
                const std::uint64_t position = line + x;
                if (a == 0 || x == 0)
                  hint = std::lower_bound(owned.begin(), owned.end(), position);
                if (hint != owned.end() && *hint == position)
                  cell_function_numbers[slot] = hint++ - owned.begin();
                else
                  others.emplace_back(slot, position);
              }
          }
      }

    std::vector<std::uint64_t> positions;
    for (const auto &entry : others)
      positions.push_back(entry.second);
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()),
                    positions.end());
    const auto place_of = [&](const std::uint64_t position) {
      return std::lower_bound(positions.begin(), positions.end(), position) -
             positions.begin();
    };

    // Ghosts are sorted by their global numbers, as in a Partitioner.
    const auto numbers = global_numbers(positions);
    std::vector<std::pair<types::global_dof_index, std::uint64_t>> order;
    for (unsigned int k = 0; k < positions.size(); ++k)
      order.emplace_back(numbers[k], positions[k]);
    std::sort(order.begin(), order.end());
    ghosts.clear();
    ghost_numbers.clear();
    std::vector<unsigned int> place(positions.size());
    for (const auto &entry : order)
      {
        place[place_of(entry.second)] = owned.size() + ghosts.size();
        ghost_numbers.push_back(entry.first);
        ghosts.push_back(entry.second);
      }
    for (const auto &entry : others)
      cell_function_numbers[entry.first] = place[place_of(entry.second)];
  }



  template <int dim>
  void
  SplineSpace<dim>::make_partitioner()
  {
    IndexSet owned_set(n_dofs());
    owned_set.add_range(first_owned, first_owned + n_locally_owned_dofs());
    IndexSet ghost_set(n_dofs());
    ghost_set.add_indices(ghost_numbers.begin(), ghost_numbers.end());
    ghost_set.compress();

    partition = std::make_shared<const Utilities::MPI::Partitioner>(owned_set,
                                                                    ghost_set,
                                                                    comm);
  }



  template <int dim>
  void
  SplineSpace<dim>::count_functions()
  {
    // Each factor has 32 bits, the product of two of them fits into 64.
    constexpr std::uint64_t largest_index = types::global_dof_index(-1);
    std::uint64_t           n             = 1;
    for (unsigned int d = 0; d < dim && !mesh_lattice.hierarchy(); ++d)
      {
        n *= extents[d];
        Require(
          n < largest_index,
          "The grid has more functions than this deal.II can number, at most " +
            std::to_string(largest_index) +
            ": use a coarser grid, or a deal.II with 64-bit indices "
            "(DEAL_II_WITH_64BIT_INDICES).");
      }
    n_all = n;
  }



  template <int dim>
  bool
  SplineSpace<dim>::exists(const std::uint64_t position) const
  {
    const CellHierarchy<dim> *levels = mesh_lattice.hierarchy();
    return !levels ||
           levels->is_active(anchor_cell(multi_index<dim>(position, extents)));
  }



  template <int dim>
  std::vector<unsigned int>
  SplineSpace<dim>::owners_of_functions(
    const std::vector<std::uint64_t> &positions) const
  {
    std::vector<unsigned int> owners;
    for (const std::uint64_t position : positions)
      {
        const MultiIndex<dim> cell =
          anchor_cell(multi_index<dim>(position, extents));
        owners.push_back(
          this->owner(lexicographic<dim>(cell, mesh_lattice.n_cells())));
      }
    return owners;
  }



  template <int dim>
  std::vector<types::global_dof_index>
  SplineSpace<dim>::global_numbers(
    const std::vector<std::uint64_t> &positions) const
  {
    const auto number_of = [this](const std::uint64_t position) {
      const auto place = std::lower_bound(owned.begin(), owned.end(), position);
      AssertThrow(place != owned.end() && *place == position,
                  ExcInternalError());
      return first_owned + types::global_dof_index(place - owned.begin());
    };

    const unsigned int me     = Utilities::MPI::this_mpi_process(comm);
    const auto         owners = owners_of_functions(positions);

    std::vector<types::global_dof_index>               result(positions.size());
    std::map<unsigned int, std::vector<std::size_t>>   places;
    std::map<unsigned int, std::vector<std::uint64_t>> questions;
    for (std::size_t k = 0; k < positions.size(); ++k)
      if (owners[k] == me)
        result[k] = number_of(positions[k]);
      else
        {
          places[owners[k]].push_back(k);
          questions[owners[k]].push_back(positions[k]);
        }

    const auto received = exchange_lists(comm, questions);
    std::map<unsigned int, std::vector<types::global_dof_index>> answers;
    for (const auto &question : received)
      for (const std::uint64_t position : question.second)
        answers[question.first].push_back(number_of(position));
    for (const auto &answer : exchange_lists(comm, answers))
      for (std::size_t k = 0; k < answer.second.size(); ++k)
        result[places[answer.first][k]] = answer.second[k];
    return result;
  }



  template <int dim>
  void
  SplineSpace<dim>::cell_dof_indices(
    const CellIterator                   &cell,
    std::vector<types::global_dof_index> &indices) const
  {
    indices.resize(n_dofs_per_cell());
    auto out = indices.begin();
    for (const unsigned int number : cell_functions(this->cell_number(cell)))
      *out++ = number < owned.size() ? first_owned + number
                                     : ghost_numbers[number - owned.size()];
  }



  template <int dim>
  FullMatrix<double>
  SplineSpace<dim>::extraction(const CellIterator &cell) const
  {
    const auto index = mesh_lattice.find_cell(cell->center());

    std::array<FullMatrix<double>, dim> matrices;
    MultiIndex<dim>                     local_extents;
    local_extents.fill(p + 1);
    for (unsigned int d = 0; d < dim; ++d)
      matrices[d] = knot_vectors[d].extraction_matrix(index[d]);

    FullMatrix<double> result(functions_per_cell, functions_per_cell);
    for (unsigned int i = 0; i < functions_per_cell; ++i)
      for (unsigned int j = 0; j < functions_per_cell; ++j)
        {
          const auto a = multi_index<dim>(i, local_extents);
          const auto b = multi_index<dim>(j, local_extents);
          result(i, j) = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            result(i, j) *= matrices[d](a[d], b[d]);
        }
    return result;
  }



  template <int dim>
  void
  SplineSpace<dim>::extract(const VectorType      &coefficients,
                            const DoFHandler<dim> &dof_handler,
                            VectorType            &bernstein) const
  {
    Require(dof_handler.get_fe() == fe(),
            "The DoFHandler has to carry the space's fe().");

    VectorType ghosted;
    initialize_vector(ghosted);
    ghosted.copy_locally_owned_data_from(coefficients);
    ghosted.update_ghost_values();

    const auto to_lexicographic =
      FE_Bernstein<dim>(p).get_poly_space_numbering();

    const unsigned int                   n = functions_per_cell;
    std::vector<types::global_dof_index> dofs(n_dofs_per_cell());
    const auto                           own = dof_handler.locally_owned_dofs();
    bernstein                                = 0.;

    // The 1D matrices repeat from cell to cell and are computed once.
    std::array<std::vector<FullMatrix<double>>, dim> matrices;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int e = 0; e < mesh_lattice.n_cells()[d]; ++e)
        matrices[d].push_back(knot_vectors[d].extraction_matrix(e));

    std::vector<double> in(n), out(n);
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const auto index    = mesh_lattice.find_cell(cell->center());
          const auto function = cell_functions(this->cell_number(cell));
          for (unsigned int a = 0; a < n; ++a)
            in[a] = ghosted.local_element(function[a]);
          for (unsigned int d = 0, stride = 1; d < dim; ++d, stride *= p + 1)
            {
              const FullMatrix<double> &matrix = matrices[d][index[d]];
              std::fill(out.begin(), out.end(), 0.);
              for (unsigned int i = 0; i < n; ++i)
                {
                  const unsigned int a     = (i / stride) % (p + 1);
                  const unsigned int start = i - a * stride;
                  for (unsigned int b = 0; b <= p; ++b)
                    out[start + b * stride] += matrix(a, b) * in[i];
                }
              in.swap(out);
            }

          cell->get_dof_indices(dofs);
          for (unsigned int i = 0; i < dofs.size(); ++i)
            if (own.is_element(dofs[i]))
              bernstein(dofs[i]) = in[to_lexicographic[i]];
        }

    // The owner of a dof owns one of its cells: all owned entries are set.
    bernstein.update_ghost_values();
  }



  template <int dim>
  Point<dim>
  SplineSpace<dim>::greville_point(const unsigned int function) const
  {
    const auto i = multi_index<dim>(function_position(function), extents);
    Point<dim> x;
    for (unsigned int d = 0; d < dim; ++d)
      x[d] = knot_vectors[d].greville_abscissa(i[d]);
    return x;
  }



  template <int dim>
  double
  SplineSpace<dim>::smallest_cell_of(const unsigned int i,
                                     const unsigned int d) const
  {
    if (mesh_lattice.edges(d).empty())
      return mesh_lattice.cell_size(d);
    const std::vector<double> &t = knot_vectors[d].knots();
    double                     h = t[i + p + 1] - t[i];
    for (unsigned int k = i; k <= i + p; ++k)
      if (t[k] < t[k + 1])
        h = std::min(h, t[k + 1] - t[k]);
    return h;
  }



  template <int dim>
  bool
  SplineSpace<dim>::on_side(const unsigned int function,
                            const unsigned int side) const
  {
    const unsigned int d = side / 2;
    if (mesh_lattice.is_periodic(d))
      return false;
    const unsigned int i =
      multi_index<dim>(function_position(function), extents)[d];
    const std::vector<double> &t = knot_vectors[d].knots();
    return side % 2 == 0 ? t[i + p] == mesh_lattice.lower()[d]
                         : t[i + 1] == mesh_lattice.upper()[d];
  }



  GREVILLE_INSTANTIATE_CLASS(SplineSpace);
} // namespace greville
