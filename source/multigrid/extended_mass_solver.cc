// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/extended_mass_solver.h>

#include <algorithm>
#include <cmath>
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
    const SolverParameters     &parameters,
    const SmootherParameters   &smoother_parameters,
    const ColumnPreconditioner &preconditioner)
    : mass(mass)
    , parameters(parameters)
    , smoother_parameters(smoother_parameters)
    , other_preconditioner(preconditioner)
  {}



  template <int dim>
  void
  ExtendedMassSolver<dim>::update(const bool   unknowns_changed,
                                  const double new_total_mass)
  {
    total_mass = new_total_mass;
    if (other_preconditioner)
      return;
    const auto &first_equal = mass.unknowns().first_equal_components();
    if (is_due || smoother_parameters.reuse == 0 ||
        !std::equal(first_equal.begin(),
                    first_equal.end(),
                    factor_components.begin(),
                    factor_components.end()))
      factorize();
    else if (unknowns_changed)
      {
        match_unknowns();
        if (is_due)
          factorize();
      }
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::factorize()
  {
    factor_places.assign(mass.unknowns().unknown_places().begin(),
                         mass.unknowns().unknown_places().begin() +
                           mass.unknowns().n_owned_unknowns());
    factor_rows.clear();
    factor_components.assign(mass.unknowns().first_equal_components().begin(),
                             mass.unknowns().first_equal_components().end());
    factors.clear();
    const auto constrained = mass.unknowns().constrained_unknowns();
    const auto positions   = mass.unknowns().unknown_positions();
    for (unsigned int c = 0; c < dim; ++c)
      {
        if (factor_components[c] < c)
          continue;
        Factors     &part       = factors.emplace_back();
        unsigned int components = 0;
        for (unsigned int d = c; d < dim; ++d)
          if (factor_components[d] == c)
            {
              part.components.push_back(d);
              components |= 1 << d;
            }
        std::vector<bool> is_constrained_in_some(constrained.size());
        for (unsigned int u = 0; u < constrained.size(); ++u)
          is_constrained_in_some[u] =
            (constrained[u] & components) != 0 &&
            (constrained[u] & components) != components;
        part.cholesky.factorize(mass.local_entries(components),
                                mass.unknowns().unknown_layout(),
                                positions,
                                is_constrained_in_some,
                                mass.matrix().space().degree(),
                                smoother_parameters.shift);
      }
    constrain();
    ++factorizations;
    is_due   = false;
    is_fresh = true;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::match_unknowns()
  {
    const auto        &now = mass.unknowns().unknown_places();
    const unsigned int n   = mass.unknowns().n_owned_unknowns();
    mass.approximate_diagonal(diagonal);
    factor_rows.assign(n, -1);
    unsigned int k = 0, n_matches = 0;
    for (unsigned int u = 0; u < n; ++u)
      {
        while (k < factor_places.size() && factor_places[k] < now[u])
          ++k;
        if (k < factor_places.size() && factor_places[k] == now[u])
          {
            factor_rows[u] = k;
            ++n_matches;
          }
      }
    const unsigned int n_changes = n + factor_places.size() - 2 * n_matches;
    is_due = Utilities::MPI::sum(n_changes, mass.unknowns().communicator()) >
             smoother_parameters.reuse;
    n_constrain_calls = 0;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::constrain()
  {
    n_constrain_calls      = mass.unknowns().n_constrain_calls();
    const auto constrained = mass.unknowns().constrained_unknowns();
    for (Factors &part : factors)
      {
        const unsigned int         n = part.components.size();
        std::vector<unsigned char> of_factors(factor_places.size(), 0);
        for (unsigned int u = 0; u < constrained.size(); ++u)
          {
            const int row = factor_rows.empty() ? int(u) : factor_rows[u];
            for (unsigned int k = 0; k < n && row >= 0; ++k)
              of_factors[row] |= ((constrained[u] >> part.components[k]) & 1)
                                 << k;
          }
        part.cholesky.constrain(of_factors, n);
      }
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::precondition(VectorType        &z,
                                        const VectorType  &r,
                                        const unsigned int width,
                                        const unsigned int n_columns) const
  {
    if (other_preconditioner)
      {
        other_preconditioner(z, r, width, n_columns);
        mass.unknowns().zero_constrained_unknowns(z, width);
        return;
      }
    if (factors.size() == 1 && factor_rows.empty())
      {
        std::copy_n(r.begin(), r.locally_owned_size(), z.begin());
        factors[0].cholesky.solve(z.begin(), width);
        return;
      }
    for (const Factors &part : factors)
      {
        std::vector<unsigned int> columns;
        for (unsigned int first = 0; first < n_columns; first += dim)
          for (const unsigned int c : part.components)
            columns.push_back(first + c);
        precondition(part, z, r, width, columns);
      }
    for (unsigned int u = 0; u < factor_rows.size(); ++u)
      if (factor_rows[u] < 0)
        for (unsigned int c = 0; c < width; ++c)
          z.local_element(u * width + c) =
            r.local_element(u * width + c) / diagonal.local_element(u);
    mass.unknowns().zero_constrained_unknowns(z, width);
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::precondition(
    const Factors                   &part,
    VectorType                      &z,
    const VectorType                &r,
    const unsigned int               width,
    const std::vector<unsigned int> &columns) const
  {
    const unsigned int n = columns.size(), part_width = width_for(n);
    work.assign(factor_places.size() * part_width, 0.);
    const unsigned int n_unknowns = mass.unknowns().n_owned_unknowns();
    const auto         for_each   = [&](const auto &visit) {
      for (unsigned int u = 0; u < n_unknowns; ++u)
        {
          const int row = factor_rows.empty() ? int(u) : factor_rows[u];
          if (row >= 0)
            for (unsigned int k = 0; k < n; ++k)
              visit(std::size_t(row) * part_width + k, u * width + columns[k]);
        }
    };
    for_each([&](const std::size_t to, const unsigned int from) {
      work[to] = r.local_element(from);
    });
    part.cholesky.solve(work.data(), part_width);
    for_each([&](const std::size_t from, const unsigned int to) {
      z.local_element(to) = work[from];
    });
  }



  namespace
  {
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
    mass.unknowns().initialize_vector(unknowns, width);
    mass.unknowns().initialize_vector(rows, width);
    const auto run = [&](const unsigned int max_iterations) {
      mass.unknowns().restrict_fields(rows, b, width);
      mass.subtract_constrained(rows, x, width);
      return width == 2
               ? iterate<2>(unknowns, rows, x.size(), shares, max_iterations)
             : width == 4
               ? iterate<4>(unknowns, rows, x.size(), shares, max_iterations)
               : iterate<8>(unknowns, rows, x.size(), shares, max_iterations);
    };
    mass.unknowns().read_fields(unknowns,
                                std::vector<const VectorField<dim> *>(x.begin(),
                                                                      x.end()),
                                width);
    if (n_constrain_calls != mass.unknowns().n_constrain_calls() &&
        !other_preconditioner)
      constrain();
    const bool  was_fresh = is_fresh || other_preconditioner;
    SolveResult result =
      run(was_fresh ? parameters.max_iterations
                    : std::min(parameters.max_iterations,
                               most_iterations_with_old_factors()));
    unsigned int n_wasted = 0;
    if (!result.converged && !was_fresh)
      {
        // The factorization is too old: continue with a new one.
        n_wasted = *result.iterations;
        factorize();
        result = run(parameters.max_iterations);
      }
    judge_factorization(*result.iterations);
    *result.iterations += n_wasted;
    mass.unknowns().write_fields(x, unknowns, width);
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
    const MPI_Comm comm = mass.unknowns().communicator();
    VectorType     p, q, z;
    for (VectorType *vector : {&p, &q, &z})
      mass.unknowns().initialize_vector(*vector, width);
    Columns<width> ones, minus_ones;
    ones.fill(1.);
    minus_ones.fill(-1.);

    // Compute squared norms field by field.
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

    // A guess that is worse than zero is discarded.
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
    Columns<width> rho{}, alpha{};
    while (ratio > parameters.tolerance && std::isfinite(ratio) &&
           k < max_iterations)
      {
        precondition(z, r, width, n_fields * dim);
        const auto     new_rho = dot<width>(r, z, comm);
        Columns<width> beta, minus_alpha;
        for (int c = 0; c < width; ++c)
          beta[c] = rho[c] > 0. ? new_rho[c] / rho[c] : 0.;
        if (other_preconditioner && k > 0)
          {
            // The preconditioner may change between iterations: use the beta of
            // Polak and Ribiere, with r - alpha q for the new residual.
            const auto change = dot<width>(q, z, comm);
            for (int c = 0; c < width; ++c)
              beta[c] = rho[c] > 0. ? -alpha[c] * change[c] / rho[c] : 0.;
          }
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

    // Make the remaining residual orthogonal to constants.
    const auto    &is_constrained = mass.unknowns().has_constrained();
    Columns<width> sums{};
    for (unsigned int i = 0; i < r.locally_owned_size(); i += width)
      for (int c = 0; c < width; ++c)
        sums[c] += r.local_element(i + c);
    Utilities::MPI::sum(ArrayView<const double>(sums.data(), width),
                        comm,
                        ArrayView<double>(sums.data(), width));
    for (unsigned int c = 0; c < n_fields * dim; ++c)
      if (!is_constrained[c % dim] && total_mass > 0.)
        for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
          x.local_element(i + c) += sums[c] / total_mass;

    return result;
  }



  template class ExtendedMassSolver<2>;
  template class ExtendedMassSolver<3>;
} // namespace greville
