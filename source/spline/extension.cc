#include <greville/spline/extension.h>

#include <algorithm>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  Extension<dim>::reinit(const SplineSpace<dim> &space,
                         const CellFilling<dim> &filling)
  {
    if (spline_space != &space)
      for (VectorType *vector : {&seen, &distances, &best_hosts})
        space.initialize_vector(*vector);
    spline_space               = &space;
    cell_filling               = &filling;
    const unsigned int p       = space.degree();
    const auto        &lattice = space.lattice();
    const auto        &extents = space.n_functions();
    const unsigned int n_local =
      space.owned_functions().size() + space.ghost_functions().size();
    const bool is_parallel =
      Utilities::MPI::n_mpi_processes(space.communicator()) > 1;

    // Numbers of cells: well-filled ones count as well_filled, others that hold
    // points as 1.
    constexpr double well_filled = 1024.;
    seen.zero_out_ghost_values();
    seen = 0.;
    for (const unsigned int cell : filling.filled_cells())
      {
        const double add = filling.is_host(cell) ? well_filled : 1.;
        for (const unsigned int f : space.cell_functions(cell))
          seen.local_element(f) += add;
      }
    if (is_parallel)
      {
        seen.compress(VectorOperation::add);
        seen.update_ghost_values();
      }

    // The nearest host: squared distances of centres in halves of a cell.
    constexpr double far           = std::numeric_limits<float>::max();
    const auto       for_each_host = [&](const auto &visit) {
      for (const unsigned int cell : filling.filled_cells())
        {
          if (filling.is_host(cell) ||
              filling.host(cell) == CellFilling<dim>::none)
            continue;
          const std::uint64_t host = filling.host(cell);
          const auto          index = multi_index<dim>(host, lattice.n_cells());
          for (const unsigned int f : space.cell_functions(cell))
            if (seen.local_element(f) < well_filled)
              {
                const auto i =
                  multi_index<dim>(space.function_position(f), extents);
                std::int64_t distance = 0;
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    const std::int64_t difference =
                      2 * std::int64_t(i[d]) - p - 2 * std::int64_t(index[d]);
                    distance += difference * difference;
                  }
                visit(f, double(distance), double(host));
              }
        }
    };
    for (VectorType *vector : {&distances, &best_hosts})
      for (unsigned int f = 0; f < n_local; ++f)
        vector->local_element(f) = far;
    for_each_host(
      [&](const unsigned int f, const double distance, const double) {
        distances.local_element(f) =
          std::min(distances.local_element(f), distance);
      });
    if (is_parallel)
      {
        distances.compress(VectorOperation::min);
        distances.update_ghost_values();
      }
    for_each_host(
      [&](const unsigned int f, const double distance, const double host) {
        if (distance == distances.local_element(f))
          best_hosts.local_element(f) =
            std::min(best_hosts.local_element(f), host);
      });
    if (is_parallel)
      {
        best_hosts.compress(VectorOperation::min);
        best_hosts.update_ghost_values();
      }

    classes.resize(n_local);
    extended_numbers.clear();
    hosts.clear();
    for (unsigned int f = 0; f < n_local; ++f)
      {
        const double n = seen.local_element(f);
        classes[f]     = n == 0.                            ? inactive
                         : n >= well_filled                 ? stable
                         : distances.local_element(f) < far ? extended
                                                            : lumped;
        if (classes[f] == extended)
          {
            extended_numbers.push_back(f);
            hosts.push_back(best_hosts.local_element(f));
          }
      }
    if (is_parallel)
      for (VectorType *vector : {&distances, &best_hosts})
        vector->zero_out_ghost_values();
  }



  template <int dim>
  void
  Extension<dim>::row(const unsigned int          function,
                      std::vector<std::uint64_t> &positions,
                      std::vector<double>        &weights) const
  {
    const SplineSpace<dim> &space   = *spline_space;
    const unsigned int      p       = space.degree();
    const auto             &extents = space.n_functions();
    const auto              place   = std::lower_bound(extended_numbers.begin(),
                                        extended_numbers.end(),
                                        function);
    Assert(place != extended_numbers.end() && *place == function,
           ExcMessage("The function is not extended."));
    const auto host = multi_index<dim>(hosts[place - extended_numbers.begin()],
                                       space.lattice().n_cells());
    const auto i = multi_index<dim>(space.function_position(function), extents);

    double factors[dim][SplineSpace<dim>::max_degree + 1];
    for (unsigned int d = 0; d < dim; ++d)
      space.knots(d).blossom(
        host[d],
        ArrayView<const double>(space.knots(d).knots().data() + i[d] + 1, p),
        ArrayView<double>(factors[d], p + 1));

    MultiIndex<dim> local_extents;
    local_extents.fill(p + 1);
    const unsigned int n = space.n_dofs_per_cell() / space.n_components();
    positions.resize(n);
    weights.resize(n);
    for (unsigned int k = 0; k < n; ++k)
      {
        auto a     = multi_index<dim>(k, local_extents);
        weights[k] = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            weights[k] *= factors[d][a[d]];
            a[d] += host[d];
          }
        positions[k] = lexicographic<dim>(a, extents);
      }
  }



  template <int dim>
  AffineConstraints<double>
  Extension<dim>::constraints() const
  {
    const SplineSpace<dim> &space = *spline_space;
    Assert(space.n_components() == 1, ExcNotImplemented());
    std::vector<std::uint64_t> all_positions, positions;
    std::vector<double>        all_weights, weights;
    for (const unsigned int f : extended_numbers)
      {
        row(f, positions, weights);
        all_positions.insert(all_positions.end(),
                             positions.begin(),
                             positions.end());
        all_weights.insert(all_weights.end(), weights.begin(), weights.end());
      }
    const auto numbers = space.global_numbers(all_positions);

    IndexSet lines = space.locally_relevant_dofs();
    {
      auto sorted = numbers;
      std::sort(sorted.begin(), sorted.end());
      sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
      lines.add_indices(sorted.begin(), sorted.end());
      lines.compress();
    }
    AffineConstraints<double> result(lines);
    const std::size_t         n = extended_numbers.empty()
                                    ? 0
                                    : all_positions.size() / extended_numbers.size();
    for (unsigned int k = 0; k < extended_numbers.size(); ++k)
      {
        const auto line =
          space.partitioner()->local_to_global(extended_numbers[k]);
        result.add_line(line);
        for (std::size_t e = k * n; e < (k + 1) * n; ++e)
          if (all_weights[e] != 0.)
            result.add_entry(line, numbers[e], all_weights[e]);
      }
    result.close();
    return result;
  }



  template <int dim>
  typename Extension<dim>::Counts
  Extension<dim>::counts() const
  {
    Counts        result;
    std::uint64_t n[4] = {0, 0, 0, 0};
    for (unsigned int f = 0; f < spline_space->owned_functions().size(); ++f)
      ++n[classes[f]];
    Utilities::MPI::sum(ArrayView<const std::uint64_t>(n, 4),
                        spline_space->communicator(),
                        ArrayView<std::uint64_t>(n, 4));
    result.stable   = n[stable];
    result.extended = n[extended];
    result.lumped   = n[lumped];
    return result;
  }



  template class Extension<2>;
  template class Extension<3>;
} // namespace greville
