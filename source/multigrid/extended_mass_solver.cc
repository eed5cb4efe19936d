#include <greville/base/errors.h>
#include <greville/multigrid/extended_mass_solver.h>

#include <petscmat.h>

#include <cmath>
#include <numeric>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * Columns are stored in blocks of 1, 2, 4 or 8.
     */
    unsigned int
    width_for(const unsigned int n_columns)
    {
      return n_columns <= 1 ? 1 : n_columns <= 2 ? 2 : n_columns <= 4 ? 4 : 8;
    }
  } // namespace



  template <int dim>
  ExtendedMassSolver<dim>::ExtendedMassSolver(
    ExtendedMass<dim>          &mass,
    const MassSolverParameters &parameters,
    const SmootherParameters   &smoother_parameters)
    : mass(mass)
    , parameters(parameters)
    , smoother_parameters(smoother_parameters)
  {}



  template <int dim>
  void
  ExtendedMassSolver<dim>::update(const bool   unknowns_changed,
                                  const double new_total_mass)
  {
    total_mass = new_total_mass;
    const bool is_parallel =
      Utilities::MPI::n_mpi_processes(mass.communicator()) > 1;
    if (is_due || smoother_parameters.reuse == 0 ||
        mass.alike() != factor_alike || (unknowns_changed && is_parallel))
      factorize();
    else if (unknowns_changed && match_unknowns() > smoother_parameters.reuse)
      factorize();
  }



  namespace
  {
    /**
     * The matrix that processes contribute to, as an MPIAIJ matrix. Numbers of
     * unknowns are those of @p layout.
     */
    PetscMatrix
    assemble(const LowerTriangle               &lower,
             const Utilities::MPI::Partitioner &layout,
             const MPI_Comm                     comm)
    {
      const unsigned int n = lower.size();

      // Both triangles.
      std::vector<PetscInt> begin(n + 1, 0);
      for (unsigned int i = 0; i < n; ++i)
        for (std::size_t e = lower.row_begin[i]; e < lower.row_begin[i + 1];
             ++e)
          {
            ++begin[i + 1];
            if (lower.columns[e] != i)
              ++begin[lower.columns[e] + 1];
          }
      std::partial_sum(begin.begin(), begin.end(), begin.begin());
      std::vector<PetscInt> columns(begin.back() + 1);
      std::vector<double>   values(begin.back() + 1);
      auto                  next = begin;
      const auto            enter =
        [&](const unsigned int i, const unsigned int j, const double value) {
          columns[next[i]]  = j;
          values[next[i]++] = value;
        };
      // Row by row, so that columns ascend.
      for (unsigned int i = 0; i < n; ++i)
        for (std::size_t e = lower.row_begin[i]; e < lower.row_begin[i + 1];
             ++e)
          {
            enter(i, lower.columns[e], lower.values[e]);
            if (lower.columns[e] != i)
              enter(lower.columns[e], i, lower.values[e]);
          }

      Mat local;
      check_petsc(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF,
                                            n,
                                            n,
                                            begin.data(),
                                            columns.data(),
                                            values.data(),
                                            &local));
      const PetscMatrix     local_owner(local);
      std::vector<PetscInt> numbers(n + 1);
      for (unsigned int i = 0; i < n; ++i)
        numbers[i] = layout.local_to_global(i);
      ISLocalToGlobalMapping map;
      check_petsc(ISLocalToGlobalMappingCreate(
        comm, 1, n, numbers.data(), PETSC_COPY_VALUES, &map));
      Mat            sum;
      const PetscInt n_owned = layout.locally_owned_size();
      check_petsc(MatCreateIS(comm,
                              1,
                              n_owned,
                              n_owned,
                              PETSC_DETERMINE,
                              PETSC_DETERMINE,
                              map,
                              map,
                              &sum));
      const PetscMatrix sum_owner(sum);
      check_petsc(ISLocalToGlobalMappingDestroy(&map));
      check_petsc(MatISSetLocalMat(sum, local));
      check_petsc(MatAssemblyBegin(sum, MAT_FINAL_ASSEMBLY));
      check_petsc(MatAssemblyEnd(sum, MAT_FINAL_ASSEMBLY));
      Mat result;
      check_petsc(MatConvert(sum, MATMPIAIJ, MAT_INITIAL_MATRIX, &result));
      return PetscMatrix(result);
    }
  } // namespace



  template <int dim>
  void
  ExtendedMassSolver<dim>::factorize()
  {
    const MPI_Comm comm = mass.communicator();
    factor_alike        = mass.alike();
    factor_places       = mass.unknown_places();
    factor_rows.clear();
    factors.clear();
    for (unsigned int c = 0; c < dim; ++c)
      {
        if (factor_alike[c] < c)
          continue;
        Factors part;
        for (unsigned int d = c; d < dim; ++d)
          if (factor_alike[d] == c)
            part.alike.push_back(d);
        LowerTriangle lower = mass.local_entries(c);
        PetscMatrix   matrix;
        if (Utilities::MPI::n_mpi_processes(comm) > 1)
          {
            VectorType layout;
            mass.initialize_vector(layout, 1);
            matrix      = assemble(lower, *layout.get_partitioner(), comm);
            part.domain = std::make_unique<OverlappingDomain<dim>>(
              matrix.get(),
              comm,
              mass.unknown_positions(),
              smoother_parameters.overlap,
              SchwarzCombination::symmetric,
              "lexicographic");
            lower = lower_triangle(part.domain->matrix());
          }
        run_on_all(
          [&]() { part.cholesky.factorize(lower, smoother_parameters.shift); },
          comm);
        if (part.domain)
          part.domain->release_matrix();
        factors.push_back(std::move(part));
      }
    ++factorizations;
    is_due   = false;
    is_fresh = true;
  }



  template <int dim>
  unsigned int
  ExtendedMassSolver<dim>::match_unknowns()
  {
    const auto &now = mass.unknown_places();
    factor_rows.assign(now.size(), -1);
    inverse_diagonal.assign(now.size(), 0.);
    unsigned int k = 0, n_matches = 0;
    for (unsigned int u = 0; u < now.size(); ++u)
      {
        while (k < factor_places.size() && factor_places[k] < now[u])
          ++k;
        if (k < factor_places.size() && factor_places[k] == now[u])
          {
            factor_rows[u] = k;
            ++n_matches;
          }
        else
          inverse_diagonal[u] = 1. / mass.matrix().diagonal(now[u]);
      }
    return now.size() + factor_places.size() - 2 * n_matches;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::apply(const Factors     &part,
                                 VectorType        &r,
                                 const unsigned int width) const
  {
    if (part.domain)
      {
        part.domain->restrict_to(work, r, false, width);
        part.cholesky.solve(work.data(), width);
        part.domain->prolongate_from(work, r, false, width);
      }
    else if (factor_rows.empty())
      part.cholesky.solve(r.begin(), width);
    else
      {
        work.assign(std::size_t(part.cholesky.size()) * width, 0.);
        for (unsigned int u = 0; u < factor_rows.size(); ++u)
          for (unsigned int c = 0; c < width; ++c)
            if (factor_rows[u] >= 0)
              work[std::size_t(factor_rows[u]) * width + c] =
                r.local_element(u * width + c);
        part.cholesky.solve(work.data(), width);
        for (unsigned int u = 0; u < factor_rows.size(); ++u)
          for (unsigned int c = 0; c < width; ++c)
            r.local_element(u * width + c) =
              factor_rows[u] >= 0
                ? work[std::size_t(factor_rows[u]) * width + c]
                : inverse_diagonal[u] * r.local_element(u * width + c);
      }
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::precondition(VectorType        &z,
                                        const VectorType  &r,
                                        const unsigned int width,
                                        const unsigned int n_columns) const
  {
    if (factors.size() == 1)
      {
        std::copy_n(r.begin(), r.locally_owned_size(), z.begin());
        apply(factors[0], z, width);
      }
    else
      for (const Factors &part : factors)
        {
          std::vector<unsigned int> columns;
          for (unsigned int first = 0; first < n_columns; first += dim)
            for (const unsigned int c : part.alike)
              columns.push_back(first + c);
          const unsigned int part_width = width_for(columns.size());
          VectorType        &x          = part_vectors[part_width];
          mass.initialize_vector(x, part_width);
          const unsigned int n = mass.n_owned_unknowns();
          for (unsigned int u = 0; u < n; ++u)
            for (unsigned int k = 0; k < columns.size(); ++k)
              x.local_element(u * part_width + k) =
                r.local_element(u * width + columns[k]);
          apply(part, x, part_width);
          for (unsigned int u = 0; u < n; ++u)
            for (unsigned int k = 0; k < columns.size(); ++k)
              z.local_element(u * width + columns[k]) =
                x.local_element(u * part_width + k);
        }
    mass.zero_held_unknowns(z, width);
  }



  namespace
  {
    // With an old factorization no solve is worth more iterations, unless the
    // first one needed half as many.
    constexpr unsigned int most_iterations_if_old = 25;

    template <int width>
    using Columns = std::array<double, width>;

    template <int width>
    Columns<width>
    dot(const VectorType &a, const VectorType &b, const MPI_Comm comm)
    {
      Columns<width> sum{};
      const double  *x = a.begin(), *y = b.begin();
      for (unsigned int i = 0; i < a.locally_owned_size(); i += width)
        for (int c = 0; c < width; ++c)
          sum[c] += x[i + c] * y[i + c];
      if (Utilities::MPI::n_mpi_processes(comm) > 1)
        Utilities::MPI::sum(ArrayView<const double>(sum.data(), width),
                            comm,
                            ArrayView<double>(sum.data(), width));
      return sum;
    }



    /**
     * y = s y + f x, column by column.
     */
    template <int width>
    void
    scale_and_add(VectorType           &y,
                  const Columns<width> &s,
                  const Columns<width> &f,
                  const VectorType     &x)
    {
      double       *out = y.begin();
      const double *in  = x.begin();
      for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
        for (int c = 0; c < width; ++c)
          out[i + c] = s[c] * out[i + c] + f[c] * in[i + c];
    }
  } // namespace



  template <int dim>
  SolveResult
  ExtendedMassSolver<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                                 const std::vector<const VectorField<dim> *> &b,
                                 const std::vector<double> &shares)
  {
    const unsigned int columns = x.size() * dim;
    const unsigned int width   = std::max(2u, width_for(columns));
    AssertThrow(columns <= 8,
                ExcMessage(
                  "At most 8 components are solved for together, not " +
                  std::to_string(columns) + "."));
    VectorType unknowns, rows;
    mass.initialize_vector(unknowns, width);
    mass.initialize_vector(rows, width);
    const auto run = [&](const unsigned int max_iterations) {
      mass.restrict_fields(rows, b, width);
      mass.subtract_held(rows, x, width);
      return width == 2
               ? iterate<2>(unknowns, rows, x.size(), shares, max_iterations)
             : width == 4
               ? iterate<4>(unknowns, rows, x.size(), shares, max_iterations)
               : iterate<8>(unknowns, rows, x.size(), shares, max_iterations);
    };
    mass.read_fields(unknowns,
                     std::vector<const VectorField<dim> *>(x.begin(), x.end()),
                     width);
    const bool  was_fresh = is_fresh;
    SolveResult result =
      run(was_fresh
            ? parameters.max_iterations
            : std::min(parameters.max_iterations,
                       std::max(most_iterations_if_old, 2 * fresh_iterations)));
    if (!result.converged && !was_fresh)
      {
        // The factorization is too old: go on with a new one.
        const unsigned int n = *result.iterations;
        factorize();
        result = run(parameters.max_iterations);
        *result.iterations += n;
      }
    mass.write_fields(x, unknowns, width);
    return result;
  }



  template <int dim>
  template <int width>
  SolveResult
  ExtendedMassSolver<dim>::iterate(VectorType                &x,
                                   VectorType                &r,
                                   const unsigned int         n_fields,
                                   const std::vector<double> &shares,
                                   const unsigned int         max_iterations)
  {
    const MPI_Comm comm = mass.communicator();
    VectorType     p, q, z;
    for (VectorType *vector : {&p, &q, &z})
      mass.initialize_vector(*vector, width);
    Columns<width> ones, minus_ones;
    ones.fill(1.);
    minus_ones.fill(-1.);

    // Squared norms field by field.
    const auto norms = [&](const VectorType &vector) {
      const auto            squares = dot<width>(vector, vector, comm);
      std::array<double, 8> sum{};
      for (unsigned int c = 0; c < n_fields * dim; ++c)
        sum[c / dim] += squares[c];
      return sum;
    };
    const auto largest_ratio = [&](const auto &now, const auto &reference) {
      double ratio = 0.;
      for (unsigned int k = 0; k < n_fields; ++k)
        if (!std::isfinite(reference[k]))
          ratio = std::numeric_limits<double>::infinity();
        else if (reference[k] > 0.)
          ratio = std::max(ratio, std::sqrt(now[k] / reference[k]));
        else if (!(now[k] <= 0.))
          ratio = std::numeric_limits<double>::infinity();
      return ratio;
    };

    // A guess that is worse than zero is none.
    auto target = norms(r);
    mass.vmult(q, x, width);
    q.sadd(-1., 1., r);
    {
      const auto start = norms(q);
      for (unsigned int k = 0; k < n_fields; ++k)
        if (!(start[k] <= target[k]))
          for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
            for (unsigned int c = k * dim; c < (k + 1) * dim; ++c)
              {
                x.local_element(i + c) = 0.;
                q.local_element(i + c) = r.local_element(i + c);
              }
    }
    r.swap(q);
    for (unsigned int k = 0; k < shares.size(); ++k)
      target[k] = std::max(target[k], shares[k] * shares[k] * target[0]);

    SolveResult    result;
    auto           now   = norms(r);
    const double   start = largest_ratio(now, target);
    double         ratio = start;
    unsigned int   k     = 0;
    Columns<width> rho{};
    while (ratio > parameters.tolerance && std::isfinite(ratio) &&
           k < max_iterations)
      {
        precondition(z, r, width, n_fields * dim);
        const auto     new_rho = dot<width>(r, z, comm);
        Columns<width> beta, alpha, minus_alpha;
        for (int c = 0; c < width; ++c)
          beta[c] = rho[c] > 0. ? new_rho[c] / rho[c] : 0.;
        rho = new_rho;
        scale_and_add<width>(p, beta, ones, z);
        mass.vmult(q, p, width);
        const auto curvature = dot<width>(p, q, comm);
        for (int c = 0; c < width; ++c)
          {
            alpha[c]       = curvature[c] > 0. ? rho[c] / curvature[c] : 0.;
            minus_alpha[c] = -alpha[c];
          }
        scale_and_add<width>(x, ones, alpha, p);
        scale_and_add<width>(r, ones, minus_alpha, q);
        now   = norms(r);
        ratio = largest_ratio(now, target);
        ++k;
      }
    result.iterations = k;
    result.reduction  = ratio;
    result.converged  = ratio <= parameters.tolerance;
    if (!result.converged)
      {
        std::ostringstream text;
        if (!std::all_of(target.begin(), target.end(), [](const double t) {
              return std::isfinite(t);
            }))
          text << "has a right-hand side that is infinite or NaN";
        else
          text << (std::isfinite(ratio)
                     ? "did not converge in "
                     : "met an infinite number or NaN after ")
               << k << " iterations; the residual is " << ratio
               << " times the right-hand side";
        result.reason = text.str();
      }

    // What is left of the residual pushes no column as a whole.
    const auto     is_held = mass.has_held();
    Columns<width> sums{};
    for (unsigned int i = 0; i < r.locally_owned_size(); i += width)
      for (int c = 0; c < width; ++c)
        sums[c] += r.local_element(i + c);
    Utilities::MPI::sum(ArrayView<const double>(sums.data(), width),
                        comm,
                        ArrayView<double>(sums.data(), width));
    for (unsigned int c = 0; c < n_fields * dim; ++c)
      if (!is_held[c % dim] && total_mass > 0.)
        for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
          x.local_element(i + c) += sums[c] / total_mass;

    // Does the factorization still serve?
    if (is_fresh)
      {
        fresh_iterations  = k;
        excess_iterations = 0;
      }
    else if (k > fresh_iterations)
      excess_iterations += k - fresh_iterations;
    is_fresh = false;
    is_due   = excess_iterations > smoother_parameters.reuse;
    return result;
  }



  template <int dim>
  std::size_t
  ExtendedMassSolver<dim>::memory_consumption() const
  {
    std::size_t n = 0;
    for (const Factors &part : factors)
      n += part.cholesky.memory_consumption() +
           (part.domain ? part.domain->memory_consumption() : 0);
    return n;
  }



  template class ExtendedMassSolver<2>;
  template class ExtendedMassSolver<3>;
} // namespace greville
