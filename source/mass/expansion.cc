#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/full_matrix.h>

#include <greville/mass/expansion.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Constraints
  merge_constraints(const Extension<dim> &extension, const Constraints &held)
  {
    const Constraints extended = extension.constraints();
    Constraints       result(extended.get_local_lines());
    for (const auto &line : held.get_lines())
      {
        Assert(line.entries.empty(),
               ExcMessage("Coefficients are held at zero."));
        result.add_line(line.index);
      }
    // Nobody may ask about lines that are not stored (without an index set, all
    // are).
    const IndexSet &stored   = held.get_local_lines();
    const auto      is_known = [&](const types::global_dof_index line) {
      return stored.size() == 0 || stored.is_element(line);
    };
    for (const auto &line : extended.get_lines())
      if (!(is_known(line.index) && held.is_constrained(line.index)))
        {
          result.add_line(line.index);
          result.add_entries(line.index, line.entries);
        }
    result.close();
    return result;
  }



  template <int dim>
  Expansion<dim>::Expansion(const SplineSpace<dim> &s,
                            const Constraints      &constraints)
    : space(&s)
  {
    const auto        &partitioner = *space->partitioner();
    const unsigned int n_owned     = space->n_locally_owned_dofs();
    const bool         is_parallel =
      Utilities::MPI::n_mpi_processes(space->communicator()) > 1;

    unsigned int n_extended = 0;
    VectorType   held;
    space->initialize_vector(held);
    for (const auto &line : constraints.get_lines())
      if (partitioner.in_local_range(line.index))
        {
          constrained.push_back(partitioner.global_to_local(line.index));
          if (line.entries.empty())
            held.local_element(constrained.back()) = 1.;
          else
            ++n_extended;
        }
    is_extended = Utilities::MPI::max(n_extended, space->communicator()) > 0;
    if (!is_extended)
      return;
    held.update_ghost_values();

    // By local numbers: owned functions come first.
    std::vector<std::pair<unsigned int, const Constraints::ConstraintLine *>>
      lines;
    for (const auto &line : constraints.get_lines())
      if (!line.entries.empty() && (partitioner.in_local_range(line.index) ||
                                    partitioner.is_ghost_entry(line.index)))
        {
          const unsigned int row = partitioner.global_to_local(line.index);
          if (held.local_element(row) == 0.)
            lines.emplace_back(row, &line);
        }
    std::sort(lines.begin(), lines.end());

    if (is_parallel)
      {
        std::vector<types::global_dof_index> remote;
        for (const auto &line : lines)
          for (const auto &entry : line.second->entries)
            if (!partitioner.in_local_range(entry.first))
              remote.push_back(entry.first);
        std::sort(remote.begin(), remote.end());
        remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
        IndexSet ghosts(space->n_dofs());
        ghosts.add_indices(remote.begin(), remote.end());
        ghosts.compress();
        exchange.reinit(space->locally_owned_dofs(),
                        ghosts,
                        space->communicator());
      }
    for (const auto &line : lines)
      {
        rows.push_back(line.first);
        n_owned_rows += line.first < n_owned;
        for (const auto &entry : line.second->entries)
          {
            columns.push_back(
              is_parallel
                ? exchange.get_partitioner()->global_to_local(entry.first)
                : entry.first);
            weights.push_back(entry.second);
          }
        begin.push_back(columns.size());
      }
  }



  template <int dim>
  void
  Expansion<dim>::distribute(VectorType &x) const
  {
    for (const unsigned int i : constrained)
      x.local_element(i) = 0.;
    if (!is_extended)
      return;
    const bool is_parallel = exchange.size() > 0;
    if (is_parallel)
      {
        exchange.copy_locally_owned_data_from(x);
        exchange.update_ghost_values();
      }
    const VectorType &source = is_parallel ? exchange : x;
    for (unsigned int k = 0; k < n_owned_rows; ++k)
      {
        double sum = 0.;
        for (std::size_t e = begin[k]; e < begin[k + 1]; ++e)
          sum += weights[e] * source.local_element(columns[e]);
        x.local_element(rows[k]) = sum;
      }
    if (is_parallel)
      exchange.zero_out_ghost_values();
  }



  template <int dim>
  void
  Expansion<dim>::condense(VectorType &x) const
  {
    if (is_extended)
      {
        const bool is_parallel = exchange.size() > 0;
        if (is_parallel)
          exchange = 0.;
        VectorType &target = is_parallel ? exchange : x;
        for (unsigned int k = 0; k < n_owned_rows; ++k)
          for (std::size_t e = begin[k]; e < begin[k + 1]; ++e)
            target.local_element(columns[e]) +=
              weights[e] * x.local_element(rows[k]);
        if (is_parallel)
          {
            exchange.compress(VectorOperation::add);
            for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
              x.local_element(i) += exchange.local_element(i);
          }
      }
    for (const unsigned int i : constrained)
      x.local_element(i) = 0.;
  }



  namespace
  {
    /**
     * The mass matrix of an owned cell.
     */
    template <int dim>
    class CellMass
    {
    public:
      CellMass(const SplineSpace<dim>    &space,
               const DensityWeights<dim> &weights)
        : space(space)
        , weights(weights)
        , quadrature(weights.n_points_1d())
        , batch_of_cell(space.owned_cells().size())
        , values(weights.n_points(), space.n_dofs_per_cell())
        , weighted(values)
      {
        for (unsigned int b = 0; b < weights.batches().size(); ++b)
          for (unsigned int lane = weights.batches()[b].first_lane;
               lane < weights.batches()[b].end_lane;
               ++lane)
            batch_of_cell[weights.batches()[b].first_cell + lane] = b;
      }

      void
      compute(const unsigned int cell, FullMatrix<double> &matrix)
      {
        const auto  &lattice = space.lattice();
        unsigned int n       = space.degree() + 1;
        const auto   index =
          multi_index<dim>(space.owned_cells()[cell], lattice.n_cells());
        std::array<std::vector<double>, dim> shape;
        for (unsigned int d = 0; d < dim; ++d)
          {
            shape[d].resize(quadrature.size() * n);
            const auto  &knots = space.knots(d);
            const double lower = knots.element_lower(index[d]);
            const double h     = knots.element_upper(index[d]) - lower;
            for (unsigned int q = 0; q < quadrature.size(); ++q)
              knots.evaluate(index[d],
                             lower + h * quadrature.point(q)(0),
                             0,
                             ArrayView<double>(&shape[d][q * n], n));
          }
        const unsigned int b = batch_of_cell[cell];
        const double *w = weights[b] + (cell - weights.batches()[b].first_cell);
        MultiIndex<dim> point_extents, extents;
        point_extents.fill(quadrature.size());
        extents.fill(n);
        for (unsigned int q = 0; q < values.m(); ++q)
          {
            const auto point = multi_index<dim>(q, point_extents);
            for (unsigned int a = 0; a < values.n(); ++a)
              {
                const auto function = multi_index<dim>(a, extents);
                double     N        = 1.;
                for (unsigned int d = 0; d < dim; ++d)
                  N *= shape[d][point[d] * n + function[d]];
                values(q, a)   = N;
                weighted(q, a) = w[q * CellBatches<dim>::width()] * N;
              }
          }
        values.Tmmult(matrix, weighted);
      }

    private:
      const SplineSpace<dim>    &space;
      const DensityWeights<dim> &weights;
      const QGauss<1>            quadrature;
      std::vector<unsigned int>  batch_of_cell;
      FullMatrix<double>         values, weighted;
    };
  } // namespace



  template <int dim>
  void
  Expansion<dim>::condense_diagonal(
    VectorType                      &diagonal,
    const DensityWeights<dim>       &mass_weights,
    const std::vector<unsigned int> &lumped) const
  {
    // For all functions of owned cells: whether lumped, the row if extended.
    const unsigned int n_local =
      space->owned_functions().size() + space->ghost_functions().size();
    constexpr unsigned int none = numbers::invalid_unsigned_int;
    VectorType             is_lumped;
    space->initialize_vector(is_lumped);
    for (const unsigned int i : lumped)
      is_lumped.local_element(i) = 1.;
    is_lumped.update_ghost_values();
    std::vector<unsigned int> row_of(n_local, none);
    for (unsigned int k = 0; k < rows.size(); ++k)
      row_of[rows[k]] = k;

    // Changes of the diagonal: of functions of owned cells by lumping, and of
    // those that rows refer to.
    VectorType by_lumping;
    space->initialize_vector(by_lumping);
    const bool is_parallel = exchange.size() > 0;
    VectorType by_rows;
    by_rows.reinit(is_parallel ? exchange : diagonal);

    const unsigned int        n = space->n_dofs_per_cell();
    CellMass<dim>             cell_mass(*space, mass_weights);
    FullMatrix<double>        mass(n, n);
    std::vector<double>       sums(n);
    std::vector<unsigned int> extended;
    std::vector<std::pair<unsigned int, std::pair<unsigned int, double>>>
                        entries; // column, (place in extended, weight)
    std::vector<double> column;
    for (unsigned int cell = 0; cell < space->owned_cells().size(); ++cell)
      {
        const auto functions  = space->cell_functions(cell);
        bool       has_lumped = false;
        extended.clear();
        for (unsigned int a = 0; a < n; ++a)
          {
            has_lumped |= is_lumped.local_element(functions[a]) != 0.;
            if (row_of[functions[a]] != none)
              extended.push_back(a);
          }
        if (extended.empty() && !has_lumped)
          continue;
        cell_mass.compute(cell, mass);

        if (has_lumped)
          {
            for (unsigned int a = 0; a < n; ++a)
              {
                const bool a_lumped =
                  is_lumped.local_element(functions[a]) != 0.;
                sums[a] = 0.;
                for (unsigned int b = 0; b < n; ++b)
                  if (b != a &&
                      (a_lumped || is_lumped.local_element(functions[b]) != 0.))
                    sums[a] += mass(a, b);
              }
            for (unsigned int a = 0; a < n; ++a)
              {
                for (unsigned int b = 0; b < n; ++b)
                  if (b != a && (is_lumped.local_element(functions[a]) != 0. ||
                                 is_lumped.local_element(functions[b]) != 0.))
                    mass(a, b) = 0.;
                mass(a, a) += sums[a];
                by_lumping.local_element(functions[a]) += sums[a];
              }
          }

        // For a column j of E with e_j in the cell, and others e in the rows of
        // extended functions: e^T M e + 2 e_j^T M e.
        entries.clear();
        for (unsigned int k = 0; k < extended.size(); ++k)
          {
            const unsigned int row = row_of[functions[extended[k]]];
            for (std::size_t e = begin[row]; e < begin[row + 1]; ++e)
              entries.emplace_back(columns[e], std::make_pair(k, weights[e]));
          }
        std::sort(entries.begin(), entries.end());
        for (std::size_t first = 0, last; first < entries.size(); first = last)
          {
            const unsigned int j = entries[first].first;
            for (last = first;
                 last < entries.size() && entries[last].first == j;)
              ++last;
            const auto global =
              is_parallel ? exchange.get_partitioner()->local_to_global(j) : j;
            unsigned int own         = none;
            const auto  &partitioner = *space->partitioner();
            if (partitioner.in_local_range(global) ||
                partitioner.is_ghost_entry(global))
              own = std::find(functions.begin(),
                              functions.end(),
                              partitioner.global_to_local(global)) -
                    functions.begin();
            double sum = 0.;
            for (std::size_t e = first; e < last; ++e)
              {
                const unsigned int a       = extended[entries[e].second.first];
                double             product = own < n ? 2. * mass(own, a) : 0.;
                for (std::size_t f = first; f < last; ++f)
                  product += mass(a, extended[entries[f].second.first]) *
                             entries[f].second.second;
                sum += entries[e].second.second * product;
              }
            by_rows.local_element(j) += sum;
          }
      }
    by_lumping.compress(VectorOperation::add);
    if (is_parallel)
      by_rows.compress(VectorOperation::add);
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      diagonal.local_element(i) +=
        by_lumping.local_element(i) + by_rows.local_element(i);
    for (const unsigned int i : constrained)
      diagonal.local_element(i) = 0.;
  }



  template <int dim>
  std::size_t
  Expansion<dim>::memory_consumption() const
  {
    return columns.size() * (sizeof(double) + sizeof(unsigned int)) +
           exchange.memory_consumption();
  }



  template Constraints
  merge_constraints<2>(const Extension<2> &, const Constraints &);
  template Constraints
  merge_constraints<3>(const Extension<3> &, const Constraints &);
  template class Expansion<2>;
  template class Expansion<3>;
} // namespace greville
