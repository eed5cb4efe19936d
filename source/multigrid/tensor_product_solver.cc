// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.templates.h>
#include <deal.II/base/mpi_consensus_algorithms.h>

#include <greville/base/simd.h>
#include <greville/multigrid/tensor_product_solver.h>

#include <map>

namespace greville
{
  using namespace dealii;

  Redistribution::Redistribution(
    const std::vector<std::uint64_t>                       &positions,
    const std::vector<unsigned int>                        &owners,
    const std::function<unsigned int(const std::uint64_t)> &place_of,
    const MPI_Comm                                          comm)
    : comm(comm)
  {
    const unsigned int me = Utilities::MPI::this_mpi_process(comm);
    std::map<unsigned int, std::vector<std::uint64_t>> to;
    std::map<unsigned int, std::vector<unsigned int>>  places;
    for (unsigned int k = 0; k < positions.size(); ++k)
      if (owners[k] == me)
        {
          own_source.push_back(k);
          own_target.push_back(place_of(positions[k]));
        }
      else
        {
          to[owners[k]].push_back(positions[k]);
          places[owners[k]].push_back(k);
        }

    const auto from = Utilities::MPI::some_to_some(comm, to);
    for (const auto &message : places)
      sends.push_back({message.first, message.second});
    for (const auto &message : from)
      {
        receives.push_back({message.first, {}});
        for (const std::uint64_t position : message.second)
          receives.back().places.push_back(place_of(position));
      }
    for (const auto *messages : {&sends, &receives})
      for (const auto &message : *messages)
        buffers.emplace_back(message.places.size());
  }



  void
  Redistribution::execute(const double *source, double *target) const
  {
    std::vector<MPI_Request> requests(sends.size() + receives.size());
    const int                tag = 4711;
    for (unsigned int m = 0; m < receives.size(); ++m)
      {
        auto     &buffer = buffers[sends.size() + m];
        const int ierr   = MPI_Irecv(buffer.data(),
                                   buffer.size(),
                                   MPI_DOUBLE,
                                   receives[m].process,
                                   tag,
                                   comm,
                                   &requests[sends.size() + m]);
        AssertThrowMPI(ierr);
      }
    for (unsigned int m = 0; m < sends.size(); ++m)
      {
        auto &buffer = buffers[m];
        for (unsigned int k = 0; k < buffer.size(); ++k)
          buffer[k] = source[sends[m].places[k]];
        const int ierr = MPI_Isend(buffer.data(),
                                   buffer.size(),
                                   MPI_DOUBLE,
                                   sends[m].process,
                                   tag,
                                   comm,
                                   &requests[m]);
        AssertThrowMPI(ierr);
      }
    for (unsigned int k = 0; k < own_source.size(); ++k)
      target[own_target[k]] = source[own_source[k]];
    const int ierr =
      MPI_Waitall(requests.size(), requests.data(), MPI_STATUSES_IGNORE);
    AssertThrowMPI(ierr);
    for (unsigned int m = 0; m < receives.size(); ++m)
      {
        const auto &buffer = buffers[sends.size() + m];
        for (unsigned int k = 0; k < buffer.size(); ++k)
          target[receives[m].places[k]] = buffer[k];
      }
  }



  std::size_t
  Redistribution::bytes_sent() const
  {
    std::size_t n = 0;
    for (const auto &message : sends)
      n += message.places.size() * sizeof(double);
    return n;
  }



  template <int dim>
  TensorProductSolver<dim>::TensorProductSolver(const SplineSpace<dim> &s)
    : space(&s)
  {
    for (unsigned int d = 0; d < dim; ++d)
      factors[d] = factorize(s.knots(d));

    const MPI_Comm     comm        = s.communicator();
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    if (n_processes == 1)
      return;
    const unsigned int me = Utilities::MPI::this_mpi_process(comm);

    // Pencils of direction d are numbered lexicographically and dealt out in
    // equal runs. Entries are stored with the pencil as the faster index.
    const auto &extents   = s.n_functions();
    const auto  pencil_of = [&](const std::uint64_t position,
                               const unsigned int  d) {
      const auto    index  = multi_index<dim>(position, extents);
      std::uint64_t pencil = 0;
      for (int e = dim - 1; e >= 0; --e)
        if (e != int(d))
          pencil = pencil * extents[e] + index[e];
      return pencil;
    };

    std::vector<std::uint64_t> positions = s.owned_functions();
    std::uint64_t              begin     = 0;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const std::uint64_t n        = s.n_dofs() / extents[d];
        const auto          first_of = [=](const unsigned int process) {
          return n * process / n_processes;
        };
        std::vector<unsigned int> owners;
        for (const std::uint64_t position : positions)
          {
            const std::uint64_t pencil = pencil_of(position, d);
            unsigned int        owner  = pencil * n_processes / n;
            while (first_of(owner) > pencil)
              --owner;
            while (first_of(owner + 1) <= pencil)
              ++owner;
            owners.push_back(owner);
          }
        begin         = first_of(me);
        n_pencils[d]  = first_of(me + 1) - begin;
        to_pencils[d] = Redistribution(
          positions,
          owners,
          [&](const std::uint64_t position) {
            return multi_index<dim>(position, extents)[d] * n_pencils[d] +
                   pencil_of(position, d) - begin;
          },
          comm);

        positions.resize(std::size_t(extents[d]) * n_pencils[d]);
        for (unsigned int l = 0; l < n_pencils[d]; ++l)
          {
            MultiIndex<dim> index{};
            std::uint64_t   pencil = begin + l;
            for (unsigned int e = 0; e < dim; ++e)
              if (e != d)
                {
                  index[e] = pencil % extents[e];
                  pencil /= extents[e];
                }
            for (unsigned int i = 0; i < extents[d]; ++i)
              {
                index[d] = i;
                positions[std::size_t(i) * n_pencils[d] + l] =
                  lexicographic<dim>(index, extents);
              }
          }
      }

    // Back home: the places of positions are asked of the space.
    const auto                numbers     = s.global_numbers(positions);
    const auto               &partitioner = *s.partitioner();
    std::vector<unsigned int> owners(numbers.size());
    {
      // Ownership is contiguous: the first number of each process tells the
      // owner (one number per process).
      const auto firsts =
        Utilities::MPI::all_gather(comm, partitioner.local_range().first);
      for (std::size_t k = 0; k < numbers.size(); ++k)
        owners[k] = std::upper_bound(firsts.begin(), firsts.end(), numbers[k]) -
                    firsts.begin() - 1;
    }
    const auto &own = s.owned_functions();
    to_owners       = Redistribution(
      positions,
      owners,
      [&](const std::uint64_t position) {
        return std::lower_bound(own.begin(), own.end(), position) - own.begin();
      },
      comm);

    std::size_t size = 0;
    for (unsigned int d = 0; d < dim; ++d)
      size = std::max(size, std::size_t(extents[d]) * n_pencils[d]);
    buffer.resize(size);
    other_buffer.resize(size);
  }



  template <int dim>
  typename TensorProductSolver<dim>::Factor
  TensorProductSolver<dim>::factorize(const KnotVector &knots)
  {
    const BandedMatrix mass = cross_matrix(knots, knots);
    Factor             factor;
    factor.n             = knots.n_functions();
    factor.p             = knots.degree();
    const unsigned int p = factor.p;
    factor.rows.assign(factor.n * (p + 1), 0.);

    const auto row = [&](const unsigned int i) {
      return factor.rows.data() + i * (p + 1);
    };
    for (unsigned int i = 0; i < factor.n; ++i)
      {
        factor.diagonal.push_back(mass(i, i));
        for (unsigned int j = i - std::min(i, p); j <= i; ++j)
          {
            double sum = mass(i, j);
            for (unsigned int k = i - std::min(i, p); k < j; ++k)
              sum -= row(i)[k + p - i] * (k + p >= j ? row(j)[k + p - j] : 0.);
            row(i)[j + p - i] = i == j ? 1. / std::sqrt(sum) : sum * row(j)[p];
          }
      }
    return factor;
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve_lines(const Factor      &factor,
                                        double            *x,
                                        const std::size_t  stride,
                                        const unsigned int n_lines)
  {
    const unsigned int n = factor.n, p = factor.p;

    // Some lines at a time, so that a line stays in the cache and the
    // recurrences of several lines hide their latency.
    const auto solve_some = [&](const unsigned int line, const auto n_simd) {
      constexpr unsigned int n_vectors = decltype(n_simd)::value;
      double                *begin     = x + line;
      for (unsigned int i = 0; i < n; ++i)
        {
          const double *row = factor.rows.data() + i * (p + 1);
          Simd          values[n_vectors];
          for (unsigned int v = 0; v < n_vectors; ++v)
            values[v] = load(begin + i * stride + v * simd_width);
          for (unsigned int k = p - std::min(i, p); k < p; ++k)
            for (unsigned int v = 0; v < n_vectors; ++v)
              values[v] -=
                row[k] * load(begin + (i + k - p) * stride + v * simd_width);
          for (unsigned int v = 0; v < n_vectors; ++v)
            store(values[v] * row[p], begin + i * stride + v * simd_width);
        }
      for (unsigned int i = n; i-- > 0;)
        {
          Simd values[n_vectors];
          for (unsigned int v = 0; v < n_vectors; ++v)
            values[v] = load(begin + i * stride + v * simd_width);
          for (unsigned int j = i + 1; j <= std::min(i + p, n - 1); ++j)
            for (unsigned int v = 0; v < n_vectors; ++v)
              values[v] -= factor.rows[j * (p + 1) + i + p - j] *
                           load(begin + j * stride + v * simd_width);
          for (unsigned int v = 0; v < n_vectors; ++v)
            store(values[v] * factor.rows[i * (p + 1) + p],
                  begin + i * stride + v * simd_width);
        }
    };

    unsigned int line = 0;
    for (; line + 4 * simd_width <= n_lines; line += 4 * simd_width)
      solve_some(line, std::integral_constant<unsigned int, 4>());
    for (; line + simd_width <= n_lines; line += simd_width)
      solve_some(line, std::integral_constant<unsigned int, 1>());
    for (; line < n_lines; ++line)
      {
        for (unsigned int i = 0; i < n; ++i)
          {
            const double *row   = factor.rows.data() + i * (p + 1);
            double        value = x[i * stride + line];
            for (unsigned int k = p - std::min(i, p); k < p; ++k)
              value -= row[k] * x[(i + k - p) * stride + line];
            x[i * stride + line] = value * row[p];
          }
        for (unsigned int i = n; i-- > 0;)
          {
            double value = x[i * stride + line];
            for (unsigned int j = i + 1; j <= std::min(i + p, n - 1); ++j)
              value -=
                factor.rows[j * (p + 1) + i + p - j] * x[j * stride + line];
            x[i * stride + line] = value * factor.rows[i * (p + 1) + p];
          }
      }
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve_on_one_process(double *x) const
  {
    const auto       &extents = space->n_functions();
    const std::size_t n_x     = extents[0];
    const std::size_t n_rows  = space->n_dofs() / n_x;

    // Lines in x lie one behind the other: transpose some at a time.
    constexpr unsigned int n_at_once = 4 * simd_width;
    buffer.resize(n_x * n_at_once);
    for (std::size_t row = 0; row < n_rows; row += n_at_once)
      {
        const unsigned int n = std::min<std::size_t>(n_at_once, n_rows - row);
        for (unsigned int l = 0; l < n; ++l)
          for (unsigned int i = 0; i < n_x; ++i)
            buffer[i * n_at_once + l] = x[(row + l) * n_x + i];
        solve_lines(factors[0], buffer.data(), n_at_once, n);
        for (unsigned int l = 0; l < n; ++l)
          for (unsigned int i = 0; i < n_x; ++i)
            x[(row + l) * n_x + i] = buffer[i * n_at_once + l];
      }

    const std::size_t n_xy = n_x * extents[1];
    for (std::size_t plane = 0; plane < space->n_dofs() / n_xy; ++plane)
      solve_lines(factors[1], x + plane * n_xy, n_x, n_x);
    if (dim == 3)
      solve_lines(factors[dim - 1], x, n_xy, n_xy);
  }



  template <int dim>
  void
  TensorProductSolver<dim>::solve(VectorType &x) const
  {
    if (Utilities::MPI::n_mpi_processes(space->communicator()) == 1)
      {
        solve_on_one_process(x.begin());
        return;
      }
    const double *source = x.begin();
    for (unsigned int d = 0; d < dim; ++d)
      {
        to_pencils[d].execute(source, buffer.data());
        solve_lines(factors[d], buffer.data(), n_pencils[d], n_pencils[d]);
        buffer.swap(other_buffer);
        source = other_buffer.data();
      }
    to_owners.execute(source, x.begin());
  }



  template <int dim>
  double
  TensorProductSolver<dim>::diagonal(const unsigned int i) const
  {
    const auto index =
      multi_index<dim>(space->owned_functions()[i], space->n_functions());
    double result = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      result *= factors[d].diagonal[index[d]];
    return result;
  }



  template <int dim>
  std::size_t
  TensorProductSolver<dim>::bytes_sent() const
  {
    std::size_t n = to_owners.bytes_sent();
    for (const auto &redistribution : to_pencils)
      n += redistribution.bytes_sent();
    return n;
  }



  template <int dim>
  TensorProductPreconditioner<dim>::TensorProductPreconditioner(
    const TensorProductSolver<dim>  &s,
    const VectorType                &all_diagonals,
    const std::vector<unsigned int> &inactive_functions)
    : solver(&s)
    , inactive(&inactive_functions)
  {
    const unsigned int n = solver->n_unknowns();
    const unsigned int n_components =
      n > 0 ? all_diagonals.locally_owned_size() / n : 1;
    for (unsigned int i = 0; i < n; ++i)
      {
        diagonal.push_back(all_diagonals.local_element(i * n_components));
        scaling.push_back(std::sqrt(solver->diagonal(i) / diagonal[i]));
      }
    for (const unsigned int i : *inactive)
      scaling[i] = 0.;
  }



  template <int dim>
  void
  TensorProductPreconditioner<dim>::vmult(VectorType       &dst,
                                          const VectorType &src) const
  {
    for (unsigned int i = 0; i < scaling.size(); ++i)
      dst.local_element(i) = scaling[i] * src.local_element(i);
    solver->solve(dst);
    for (unsigned int i = 0; i < scaling.size(); ++i)
      dst.local_element(i) *= scaling[i];
    for (const unsigned int i : *inactive)
      dst.local_element(i) = src.local_element(i) / diagonal[i];
  }



  template class TensorProductSolver<2>;
  template class TensorProductSolver<3>;
  template class TensorProductPreconditioner<2>;
  template class TensorProductPreconditioner<3>;
} // namespace greville
