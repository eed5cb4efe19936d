// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/coarsest_solver.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the number of functions of order 1 of a lattice.
    template <typename Lattice>
    std::uint64_t
    n_functions_of_order_1(const Lattice &lattice)
    {
      std::uint64_t result = 1;
      for (const NestedKnots &direction : lattice)
        if (direction.degree() > 0)
          result *= direction.n_cells() + !direction.is_periodic();
      return result;
    }
  } // namespace



  template <int dim>
  std::uint64_t
  CoarsestSolver<dim>::n_rows(const LatticeLevel<dim> &lattice,
                              const bool               lowers_order)
  {
    return lattice.n_components() *
           (lowers_order
              ? n_functions_of_order_1(lattice.lattice())
              : Utilities::MPI::sum(std::uint64_t(lattice.layout().n_owned()),
                                    lattice.layout().communicator()));
  }



  template <int dim>
  template <typename Add>
  void
  CoarsestSolver<dim>::for_each_column(const LatticeMatrix<dim> &lattice,
                                       const bool                lowers_order,
                                       const unsigned int        unknown,
                                       const unsigned int        component,
                                       const Add                &add)
  {
    const unsigned int n = lattice.n_components();
    if (!lowers_order)
      {
        add(lattice.layout().global_number(unknown) * n + component, 1.);
        return;
      }
    const auto  knots    = lattice.lattice();
    const auto &position = lattice.unknowns().positions()[unknown];
    std::vector<std::pair<unsigned int, double>> terms{{0, 1.}}, product;
    for (unsigned int d = 3; d-- > 0;)
      {
        if (knots[d].degree() == 0)
          continue;
        const unsigned int n_values =
          knots[d].n_cells() + !knots[d].is_periodic();
        const auto [cell, part] = knots[d].greville_point(position[d]);
        product.clear();
        for (const auto &[number, weight] : terms)
          {
            product.emplace_back(number * n_values + cell,
                                 weight * (1. - part));
            if (part > 0.)
              product.emplace_back(number * n_values + (cell + 1) % n_values,
                                   weight * part);
          }
        terms.swap(product);
      }
    for (const auto &[number, weight] : terms)
      add(number * n + component, weight);
  }



  template <int dim>
  void
  CoarsestSolver<dim>::reinit(
    const std::vector<const LatticeMatrix<dim> *> &lattices,
    const bool                                     lowers_order,
    const LatticeCoupling<dim>                    *coupling,
    const unsigned int                             level,
    const double                                   unit)
  {
    matrix.reinit(0, 0);
    columns.assign(lattices.size(), Columns());
    comm = lattices.front()->layout().communicator();
    std::vector<unsigned int> begin{0};
    for (const LatticeMatrix<dim> *lattice : lattices)
      begin.push_back(begin.back() + n_rows(*lattice, lowers_order));
    const unsigned int n = begin.back();
    if (n > largest_size)
      return;
    std::vector<double> entries(std::size_t(n) * n, 0.);
    for (unsigned int part = 0; part < lattices.size(); ++part)
      {
        const LatticeMatrix<dim> &lattice = *lattices[part];
        const auto                of_part =
          [&](const unsigned int u, const unsigned int c, const auto &add) {
            for_each_column(lattice, lowers_order, u, c, add);
          };
        for (unsigned int u = 0; u < lattice.layout().n_owned(); ++u)
          for (unsigned int c = 0; c < lattice.n_components(); ++c)
            {
              if (!lattice.unknowns().is_constrained(u, c))
                of_part(
                  u, c, [&](const unsigned int column, const double weight) {
                    columns[part].entries.emplace_back(begin[part] + column,
                                                       weight);
                  });
              columns[part].begin.push_back(columns[part].entries.size());
            }
        const unsigned int n_of_part = begin[part + 1] - begin[part];
        const auto         block = lattice.reduced_entries(n_of_part, of_part);
        for (unsigned int i = 0; i < n_of_part; ++i)
          std::copy_n(block.begin() + std::size_t(i) * n_of_part,
                      n_of_part,
                      entries.begin() + std::size_t(begin[part] + i) * n +
                        begin[part]);
      }
    values.reinit(n);
    if (coupling)
      add_coupling(entries, *coupling, level, unit);
    factorize(entries);
  }



  template <int dim>
  void
  CoarsestSolver<dim>::add_coupling(std::vector<double>        &entries,
                                    const LatticeCoupling<dim> &coupling,
                                    const unsigned int          level,
                                    const double                unit) const
  {
    const unsigned int n = values.size();
    // The columns of all unknowns, in the order of their global numbers.
    std::vector<Columns> all(columns.size());
    for (unsigned int part = 0; part < columns.size(); ++part)
      {
        const auto &own    = columns[part];
        const auto  begins = Utilities::MPI::all_gather(comm, own.begin);
        const auto  lists  = Utilities::MPI::all_gather(comm, own.entries);
        for (unsigned int process = 0; process < begins.size(); ++process)
          {
            const std::size_t first = all[part].entries.size();
            for (std::size_t k = 1; k < begins[process].size(); ++k)
              all[part].begin.push_back(first + begins[process][k]);
            all[part].entries.insert(all[part].entries.end(),
                                     lists[process].begin(),
                                     lists[process].end());
          }
      }
    std::vector<double> sums(entries.size(), 0.), gaps(n * std::size_t(dim));
    std::vector<unsigned int> used[dim];
    coupling.for_each_key(
      level, [&](const Tensor<2, dim> &K, const auto &of_key) {
        for (const auto &entry : of_key)
          {
            const auto &[begin, terms] = all[entry.part];
            for (std::size_t k = begin[entry.column];
                 k < begin[entry.column + 1];
                 ++k)
              {
                used[entry.component].push_back(terms[k].first);
                gaps[entry.component * n + terms[k].first] +=
                  entry.weight * terms[k].second;
              }
          }
        for (std::vector<unsigned int> &of_component : used)
          {
            std::sort(of_component.begin(), of_component.end());
            of_component.erase(std::unique(of_component.begin(),
                                           of_component.end()),
                               of_component.end());
          }
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            for (const unsigned int i : used[c])
              for (const unsigned int j : used[d])
                sums[std::size_t(i) * n + j] += gaps[std::size_t(c) * n + i] *
                                                K[c][d] / unit *
                                                gaps[std::size_t(d) * n + j];
        for (unsigned int c = 0; c < dim; ++c)
          {
            for (const unsigned int i : used[c])
              gaps[std::size_t(c) * n + i] = 0.;
            used[c].clear();
          }
      });
    Utilities::MPI::sum(sums, comm, sums);
    for (std::size_t k = 0; k < sums.size(); ++k)
      entries[k] += sums[k];
  }



  template <int dim>
  void
  CoarsestSolver<dim>::factorize(const std::vector<double> &entries)
  {
    // Functions can be linearly dependent, and tangents indefinite: raise the
    // diagonal as far as necessary.
    constexpr double   smallest_shift = 1e-6, largest_shift = 10., growth = 30.;
    const unsigned int n = values.size();
    for (double shift = smallest_shift; shift < largest_shift; shift *= growth)
      {
        matrix.reinit(n, n);
        matrix.set_property(LAPACKSupport::symmetric);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            matrix(i, j) = entries[std::size_t(i) * n + j];
        for (unsigned int i = 0; i < n; ++i)
          if (entries[std::size_t(i) * n + i] > 0.)
            matrix(i, i) *= 1. + shift;
          else
            matrix(i, i) = 1.;
        try
          {
            matrix.compute_cholesky_factorization();
            return;
          }
        catch (const ExceptionBase &)
          {}
      }
    matrix.reinit(0, 0);
  }



  template <int dim>
  void
  CoarsestSolver<dim>::add_solution(Blocks &x, const Blocks &b) const
  {
    values = 0.;
    for (unsigned int part = 0; part < columns.size(); ++part)
      {
        const auto &[begin, entries] = columns[part];
        for (unsigned int i = 0; i < b[part].locally_owned_size(); ++i)
          for (std::size_t k = begin[i]; k < begin[i + 1]; ++k)
            values[entries[k].first] +=
              entries[k].second * b[part].local_element(i);
      }
    if (Utilities::MPI::n_mpi_processes(comm) > 1)
      Utilities::MPI::sum(values, comm, values);
    matrix.solve(values);
    for (unsigned int part = 0; part < columns.size(); ++part)
      {
        const auto &[begin, entries] = columns[part];
        for (unsigned int i = 0; i < x[part].locally_owned_size(); ++i)
          {
            double sum = 0.;
            for (std::size_t k = begin[i]; k < begin[i + 1]; ++k)
              sum += entries[k].second * values[entries[k].first];
            x[part].local_element(i) += float(sum);
          }
      }
  }



  GREVILLE_INSTANTIATE_CLASS(CoarsestSolver);
} // namespace greville
