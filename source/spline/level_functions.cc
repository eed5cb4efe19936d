// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/spline/level_functions.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Smaller weights of a row are round-off.
    constexpr double smallest_weight = 1e-13;
  } // namespace



  template <int dim>
  void
  LevelFunctions<dim>::reinit(
    const SplineSpace<dim>                        &space,
    const std::function<bool(const unsigned int)> &is_filled)
  {
    spline_space = &space;
    hierarchy    = space.lattice().hierarchy();
    kinds.assign(space.owned_functions().size() +
                   space.ghost_functions().size(),
                 active);
    std::map<std::uint64_t, bool> refined;
    for (unsigned int l = 0; l < hierarchy->n_levels(); ++l)
      {
        find_kinds(l, refined, is_filled);
        if (l + 1 < hierarchy->n_levels())
          refined = find_cells_that_count(l);
      }
  }



  template <int dim>
  unsigned int
  LevelFunctions<dim>::level(const unsigned int function) const
  {
    return hierarchy->level_of_function(
      spline_space->function_position(function) %
      spline_space->n_functions()[0]);
  }



  template <int dim>
  template <typename Visit>
  void
  LevelFunctions<dim>::for_each_cell(const unsigned int function,
                                     const unsigned int l,
                                     const Visit       &visit) const
  {
    const auto i = multi_index<dim>(spline_space->function_position(function),
                                    spline_space->n_functions());
    const unsigned int own = level(function), p = spline_space->degree();
    const auto         n = hierarchy->n_cells(own);
    MultiIndex<dim>    first, size;
    std::uint64_t      n_visits = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int at    = i[d] - hierarchy->offset(own)[d];
        const unsigned int begin = (at - std::min(at, p)) >> (own - l),
                           end   = std::min(at, n[d] - 1) >> (own - l);
        first[d]                 = hierarchy->offset(l)[d] + begin;
        size[d]                  = end - begin + 1;
        n_visits *= size[d];
      }
    for (std::uint64_t k = 0; k < n_visits; ++k)
      {
        auto cell = multi_index<dim>(k, size);
        for (unsigned int d = 0; d < dim; ++d)
          cell[d] += first[d];
        visit(cell);
      }
  }



  template <int dim>
  void
  LevelFunctions<dim>::find_kinds(
    const unsigned int                             l,
    const std::map<std::uint64_t, bool>           &counts,
    const std::function<bool(const unsigned int)> &is_filled)
  {
    const auto &extents = spline_space->lattice().n_cells();
    for (unsigned int f = 0; f < kinds.size(); ++f)
      {
        if (level(f) != l)
          continue;
        if (l > 0)
          for_each_cell(f, l - 1, [&](const MultiIndex<dim> &cell) {
            if (hierarchy->is_refined(cell))
              return;
            const auto found = counts.find(lexicographic<dim>(cell, extents));
            if (found == counts.end() || !found->second)
              kinds[f] = tied;
          });
        if (kinds[f] == active)
          for_each_cell(f, l, [&](const MultiIndex<dim> &cell) {
            if (hierarchy->is_refined(cell))
              kinds[f] = is_filled(f) ? at_refined : released;
          });
      }
  }



  template <int dim>
  bool
  LevelFunctions<dim>::counts_as_refined(const unsigned int cell) const
  {
    const auto functions = spline_space->cell_functions(cell);
    return std::any_of(functions.begin(),
                       functions.end(),
                       [&](const unsigned int f) {
                         return kinds[f] == released;
                       });
  }



  template <int dim>
  std::vector<std::uint64_t>
  LevelFunctions<dim>::cells_to_refine() const
  {
    std::vector<std::uint64_t> result;
    for (unsigned int cell = 0; cell < spline_space->owned_cells().size();
         ++cell)
      if (counts_as_refined(cell))
        result.push_back(spline_space->owned_cells()[cell]);
    return result;
  }



  template <int dim>
  std::map<std::uint64_t, bool>
  LevelFunctions<dim>::find_cells_that_count(const unsigned int l) const
  {
    // Cells that are not refined, but lie in the support of a function of the
    // next level.
    const auto                   &extents = spline_space->lattice().n_cells();
    std::map<std::uint64_t, bool> result;
    for (unsigned int f = 0; f < kinds.size(); ++f)
      if (level(f) == l + 1)
        for_each_cell(f, l, [&](const MultiIndex<dim> &cell) {
          if (hierarchy->is_active(cell))
            result[lexicographic<dim>(cell, extents)] = false;
        });
    std::map<unsigned int, std::vector<std::uint64_t>> questions;
    for (auto &entry : result)
      {
        const unsigned int cell = spline_space->find(entry.first);
        if (cell != numbers::invalid_unsigned_int)
          entry.second = counts_as_refined(cell);
        else
          questions[spline_space->owner(entry.first)].push_back(entry.first);
      }
    const MPI_Comm comm = spline_space->communicator();
    if (Utilities::MPI::n_mpi_processes(comm) == 1)
      return result;
    std::map<unsigned int, std::vector<std::uint64_t>> answers;
    for (const auto &question : exchange_lists(comm, questions))
      for (const std::uint64_t position : question.second)
        if (counts_as_refined(spline_space->find(position)))
          answers[question.first].push_back(position);
    for (const auto &answer : exchange_lists(comm, answers))
      for (const std::uint64_t position : answer.second)
        result[position] = true;
    return result;
  }



  template <int dim>
  typename LevelFunctions<dim>::Row
  LevelFunctions<dim>::tie(const unsigned int function) const
  {
    const unsigned int p = spline_space->degree(), l = level(function);
    const auto        &extents = spline_space->n_functions();
    const auto         i =
      multi_index<dim>(spline_space->function_position(function), extents);
    // A cell of the level before in the middle of the support.
    MultiIndex<dim> cell, local_extents;
    double          factors[dim][SplineSpace<dim>::max_degree + 1];
    for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int at = i[d] - hierarchy->offset(l)[d];
        const unsigned int middle =
          std::min(at - std::min(at, p / 2), hierarchy->n_cells(l)[d] - 1);
        cell[d] = hierarchy->offset(l - 1)[d] + middle / 2;
        spline_space->knots(d).blossom(
          cell[d],
          ArrayView<const double>(&spline_space->knots(d).knots()[i[d] + 1], p),
          ArrayView<double>(factors[d], p + 1));
        local_extents[d] = p + 1;
      }
    Row result;
    for (unsigned int k = 0; k < spline_space->n_dofs_per_cell(); ++k)
      {
        auto   j      = multi_index<dim>(k, local_extents);
        double weight = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            weight *= factors[d][j[d]];
            j[d] += cell[d];
          }
        if (std::abs(weight) > smallest_weight)
          result.emplace_back(lexicographic<dim>(j, extents), weight);
      }
    return result;
  }



  namespace
  {
    void
    add_up(std::vector<std::pair<std::uint64_t, double>> &row)
    {
      std::sort(row.begin(), row.end());
      std::size_t n = 0;
      for (const auto &entry : row)
        if (n > 0 && row[n - 1].first == entry.first)
          row[n - 1].second += entry.second;
        else
          row[n++] = entry;
      row.resize(n);
    }
  } // namespace



  template <int dim>
  void
  LevelFunctions<dim>::resolve(std::vector<Row> &rows) const
  {
    const SplineSpace<dim> &space  = *spline_space;
    const MPI_Comm          comm   = space.communicator();
    const auto             &owned  = space.owned_functions();
    const auto              row_of = [&](const std::uint64_t position) -> Row {
      const auto place = std::lower_bound(owned.begin(), owned.end(), position);
      AssertThrow(place != owned.end() && *place == position,
                  ExcInternalError());
      const unsigned int f = place - owned.begin();
      return kinds[f] == tied ? tie(f) : Row();
    };
    // The rows of tied functions; empty ones for other functions.
    std::map<std::uint64_t, Row> known;
    for (unsigned int round = 0; round < hierarchy->n_levels(); ++round)
      {
        std::vector<std::uint64_t> unknown;
        for (const Row &row : rows)
          for (const auto &entry : row)
            if (known.emplace(entry.first, Row()).second)
              unknown.push_back(entry.first);
        std::map<unsigned int, std::vector<std::uint64_t>> questions;
        const auto owners = space.owners_of_functions(unknown);
        for (unsigned int k = 0; k < unknown.size(); ++k)
          if (owners[k] == Utilities::MPI::this_mpi_process(comm))
            known[unknown[k]] = row_of(unknown[k]);
          else
            questions[owners[k]].push_back(unknown[k]);
        // Answers are the number of entries and the entries, in the order of
        // the questions.
        std::map<unsigned int, std::vector<double>> answers;
        if (Utilities::MPI::n_mpi_processes(comm) > 1)
          {
            for (const auto &question : exchange_lists(comm, questions))
              for (const std::uint64_t position : question.second)
                {
                  auto     &answer = answers[question.first];
                  const Row row    = row_of(position);
                  answer.push_back(row.size());
                  for (const auto &entry : row)
                    answer.insert(answer.end(),
                                  {double(entry.first), entry.second});
                }
            for (const auto &[process, answer] : exchange_lists(comm, answers))
              {
                auto value = answer.begin();
                for (const std::uint64_t position : questions.at(process))
                  {
                    Row &row = known[position];
                    row.resize(std::size_t(*value++));
                    for (auto &entry : row)
                      {
                        entry.first  = std::uint64_t(*value++);
                        entry.second = *value++;
                      }
                  }
              }
          }
        bool has_ties = false;
        for (Row &row : rows)
          {
            Row next;
            for (const auto &entry : row)
              {
                const Row &of_entry = known.at(entry.first);
                has_ties            = has_ties || !of_entry.empty();
                if (of_entry.empty())
                  next.push_back(entry);
                for (const auto &parent : of_entry)
                  next.emplace_back(parent.first, entry.second * parent.second);
              }
            add_up(next);
            row = std::move(next);
          }
        if (!Utilities::MPI::logical_or(has_ties, comm))
          return;
      }
  }



  GREVILLE_INSTANTIATE_CLASS(LevelFunctions);
} // namespace greville
