// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/multigrid/extended_mass_solver.h>

#include "column_products.h"
#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Return the number of stored columns: blocks of 1, 2, 4 or 8.
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
    const ColumnPreconditioner &preconditioner,
    const double                first_tolerance)
    : mass(mass)
    , parameters(parameters)
    , other_preconditioner(preconditioner)
    , first_tolerance(first_tolerance)
  {}



  template <int dim>
  void
  ExtendedMassSolver<dim>::update(const double      new_total_mass,
                                  const VectorType *new_lumped_mass)
  {
    total_mass  = new_total_mass;
    lumped_mass = new_lumped_mass;
    is_fresh    = false;
    is_old      = true;
    if (factorized != mass.unknowns().unknown_layout())
      factorized = nullptr;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::factorize() const
  {
    // Kronecker products of band matrices remain positive definite without the
    // outermost diagonals. The factorization then costs less than half. In
    // refined grids, the weights of some functions are too large for that. In
    // other grids some matrices are ill-conditioned, and their factors need the
    // outermost diagonals and smaller entries; a larger shift would not help.
    const SplineSpace<dim> &space   = mass.matrix().space();
    const int               degree  = space.degree();
    const auto              attempt = [&](const int                 reach,
                             const CholeskyParameters &cholesky) {
      factors.factorize(mass.local_entries((1u << dim) - 1, reach),
                        *mass.unknowns().unknown_layout(),
                        mass.unknowns().unknown_positions(),
                        reach,
                        1,
                        cholesky,
                        mass.row_variants(reach));
    };
    CholeskyParameters cholesky = ict_parameters(degree);
    cholesky.largest_shift      = cholesky.shift;
    try
      {
        attempt(space.hierarchy() ? degree : std::max(1, degree - 1), cholesky);
      }
    catch (const ErrorOnAll &)
      {
        attempt(degree, {0.1 * cholesky.shift, 0.1 * cholesky.drop_tolerance});
      }
    ++factorizations;
    factorized        = mass.unknowns().unknown_layout();
    is_fresh          = true;
    fresh_iterations  = 0;
    excess_iterations = 0;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::prepare()
  {
    if (!is_old)
      return;
    const double n = mass.unknowns().unknown_layout()->partitioner(1)->size();
    unit           = total_mass > 0. ? total_mass / n : 1.;
    mass.matrix().make_single(unit);
    is_old = false;

    const auto &is_constrained = mass.unknowns().has_constrained();
    const auto  free =
      std::find(is_constrained.begin(), is_constrained.end(), false);
    if (lumped_mass && free != is_constrained.end())
      {
        row_sums = *lumped_mass;
        mass.unknowns().condense(row_sums, free - is_constrained.begin());
      }
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::precondition(VectorOf<float>       &z,
                                        const VectorOf<float> &r,
                                        const unsigned int     width,
                                        const unsigned int     n_columns) const
  {
    const std::size_t n = r.locally_owned_size();
    if (other_preconditioner)
      {
        VectorType from, to;
        for (VectorType *vector : {&from, &to})
          mass.unknowns().initialize_vector(*vector, width);
        std::copy_n(r.begin(), n, from.begin());
        other_preconditioner(to, from, width, n_columns);
        for (std::size_t i = 0; i < n; ++i)
          z.local_element(i) = unit * to.local_element(i);
      }
    else
      {
        if (!factorized)
          factorize();
        std::copy_n(r.begin(), n, z.begin());
        factors.solve(z.begin(), width, unit);
      }
    mass.unknowns().zero_constrained_unknowns(z, width);
  }



  namespace
  {
    using FieldNorms = std::array<double, 8>;

    /// Return the squared norms of fields from the squares of their columns.
    template <int width>
    FieldNorms
    norms_of(const Columns<width> &squares,
             const unsigned int    n_fields,
             const int             dim)
    {
      FieldNorms sums{};
      for (unsigned int c = 0; c < n_fields * dim; ++c)
        sums[c / dim] += squares[c];
      return sums;
    }



    /// Return the largest ratio of two norms of a field.
    double
    largest_ratio(const FieldNorms  &now,
                  const FieldNorms  &reference,
                  const unsigned int n_fields)
    {
      double ratio = 0.;
      for (unsigned int k = 0; k < n_fields; ++k)
        if (!std::isfinite(reference[k]) || !std::isfinite(now[k]))
          ratio = std::numeric_limits<double>::infinity();
        else if (reference[k] > 0.)
          ratio = std::max(ratio, std::sqrt(now[k] / reference[k]));
        else if (!(now[k] <= 0.))
          ratio = std::numeric_limits<double>::infinity();
      return ratio;
    }



    std::string
    reason_of_failure(const double       ratio,
                      const unsigned int n_iterations,
                      const FieldNorms  &right_hand_sides)
    {
      if (!std::all_of(right_hand_sides.begin(),
                       right_hand_sides.end(),
                       [](const double norm) { return std::isfinite(norm); }))
        return "has a right-hand side that is infinite or NaN";
      std::ostringstream text;
      text << (std::isfinite(ratio) ? "did not converge in "
                                    : "met an infinite number or NaN after ")
           << n_iterations << " iterations; the residual is " << ratio
           << " times the right-hand side";
      return text.str();
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
    Require(columns <= 8,
            "At most 8 components are solved for together, not " +
              std::to_string(columns) + ".");
    const auto &partitioner =
      mass.unknowns().unknown_layout()->partitioner(width);
    for (VectorType *vector : {&unknowns, &rows, &residual_rows})
      if (vector->get_partitioner() != partitioner)
        vector->reinit(partitioner);
    for (VectorOf<float> *vector : {&e, &r, &p, &s, &u, &w})
      if (vector->get_partitioner() != partitioner)
        vector->reinit(partitioner);
    unknowns = 0.; // also in columns that are not used
    prepare();
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
    // Old factors may be useless after a sudden change of the mass.
    const bool  has_old_factors = factorized && !is_fresh;
    SolveResult result =
      run(has_old_factors
            ? std::min(parameters.max_iterations, 2 * fresh_iterations + 5)
            : parameters.max_iterations);
    const unsigned int n_iterations = *result.iterations;
    if (!result.converged && has_old_factors)
      {
        forget();
        result           = run(parameters.max_iterations);
        fresh_iterations = *result.iterations;
        *result.iterations += n_iterations;
      }
    else if (is_fresh)
      fresh_iterations = std::max(fresh_iterations, n_iterations);
    else if (has_old_factors)
      excess_iterations +=
        n_iterations - std::min(fresh_iterations, n_iterations);
    if (excess_iterations >= iterations_of_factorization)
      factorized = nullptr;
    mass.unknowns().write_fields(x, unknowns, width);
    return result;
  }



  template <int dim>
  template <int width>
  typename ExtendedMassSolver<dim>::template ResidualSums<width>
  ExtendedMassSolver<dim>::residual(VectorType       &r,
                                    VectorType       &x,
                                    const VectorType &b,
                                    const bool        in_single) const
  {
    if (in_single)
      {
        std::copy_n(x.begin(), x.locally_owned_size(), u.begin());
        mass.vmult(w, u, width);
        for (std::size_t i = 0; i < b.locally_owned_size(); ++i)
          r.local_element(i) = unit * w.local_element(i);
      }
    else
      mass.vmult(r, x, width);
    ResidualSums<width> sums{};

    double       *r_i = r.begin();
    const double *b_i = b.begin(), *x_i = x.begin();
    for (std::size_t i = 0; i < b.locally_owned_size(); i += width)
      for (int c = 0; c < width; ++c)
        {
          r_i[i + c] = b_i[i + c] - r_i[i + c];
          sums[0][c] += r_i[i + c] * r_i[i + c];
          sums[1][c] += b_i[i + c] * b_i[i + c];
          sums[2][c] += x_i[i + c] * x_i[i + c];
          sums[3][c] += r_i[i + c];
        }
    // A times a constant vector gives the row sums.
    if (in_single)
      {
        sums[3]               = {};
        const auto &functions = mass.unknowns().unknown_functions();
        for (std::size_t u = 0; u < functions.size(); ++u)
          for (int c = 0; c < width; ++c)
            sums[3][c] +=
              b_i[u * width + c] -
              row_sums.local_element(functions[u]) * x_i[u * width + c];
      }
    add_up(sums, mass.unknowns().communicator());
    return sums;
  }



  template <int dim>
  template <int width>
  SolveResult
  ExtendedMassSolver<dim>::iterate(VectorType                &x,
                                   const VectorType          &b,
                                   const unsigned int         n_fields,
                                   const std::vector<double> &shares,
                                   const unsigned int max_iterations) const
  {
    VectorType &r          = residual_rows;
    bool        knows_sums = row_sums.size() > 0;
    const bool  in_single  = knows_sums && parameters.tolerance >= reduction;
    auto        sums       = residual<width>(r, x, b, in_single);
    FieldNorms  target     = norms_of<width>(sums[1], n_fields, dim);
    FieldNorms  now        = norms_of<width>(sums[0], n_fields, dim);
    const auto  guess      = norms_of<width>(sums[2], n_fields, dim);
    double      tolerance  = parameters.tolerance;
    bool        is_precise = true;
    // Single precision does not resolve the errors of a uniform motion.
    constexpr double smallest_in_single = 1e-5;
    for (unsigned int k = 0; k < n_fields; ++k)
      {
        if (guess[k] == 0. && target[k] > 0.)
          tolerance = std::min(tolerance, first_tolerance);
        is_precise = is_precise && std::sqrt(now[k]) >
                                     smallest_in_single * std::sqrt(target[k]);
      }
    if (in_single && (tolerance < reduction || !is_precise))
      {
        sums = residual<width>(r, x, b, false);
        now  = norms_of<width>(sums[0], n_fields, dim);
      }
    // Discard a guess that is worse than zero.
    for (unsigned int k = 0; k < n_fields; ++k)
      if (!(now[k] <= target[k]))
        for (unsigned int c = k * dim; c < (k + 1) * dim; ++c)
          {
            for (std::size_t i = c; i < x.locally_owned_size(); i += width)
              {
                x.local_element(i) = 0.;
                r.local_element(i) = b.local_element(i);
              }
            sums[0][c] = sums[1][c];
            now[k]     = target[k];
            knows_sums = false;
          }
    for (unsigned int k = 0; k < shares.size(); ++k)
      target[k] = std::max(target[k], shares[k] * shares[k] * target[0]);

    double       ratio = largest_ratio(now, target, n_fields);
    unsigned int k = 0, n_vain = 0;
    while (ratio > tolerance && std::isfinite(ratio) && n_vain < 3 &&
           k < max_iterations)
      {
        const double start = ratio;
        const double goal  = std::max(0.8 * tolerance, reduction * start);
        ratio =
          correct<width>(x, r, sums, target, n_fields, goal, max_iterations, k);
        // Single precision resolves this residual well enough.
        if (knows_sums && n_trusted > 0 && ratio <= tolerance &&
            goal >= 2. * reduction * start)
          {
            --n_trusted;
            break;
          }
        // The result must not depend on this check.
        const Columns<width> column_sums = sums[3];
        sums                             = residual<width>(r, x, b, false);
        if (knows_sums)
          sums[3] = column_sums;
        ratio     = largest_ratio(norms_of<width>(sums[0], n_fields, dim),
                              target,
                              n_fields);
        n_trusted = ratio <= tolerance ? max_trusted : 0;
        n_vain += ratio > 0.5 * start;
        // If the residual consists of round-off, accept it.
        if (ratio > 0.1 * start && ratio < 1e-11)
          ratio = std::min(ratio, tolerance);
      }
    // Make the residual orthogonal to constants.
    const auto &is_constrained = mass.unknowns().has_constrained();
    for (unsigned int c = 0; c < n_fields * dim; ++c)
      if (!is_constrained[c % dim] && total_mass > 0.)
        for (std::size_t i = c; i < x.locally_owned_size(); i += width)
          x.local_element(i) += sums[3][c] / total_mass;

    SolveResult result;
    result.iterations = k;
    result.reduction  = ratio;
    result.converged  = ratio <= tolerance;
    if (!result.converged)
      result.reason = reason_of_failure(ratio, k, target);
    return result;
  }



  template <int dim>
  template <int width>
  double
  ExtendedMassSolver<dim>::correct(VectorType          &x,
                                   const VectorType    &residual,
                                   ResidualSums<width> &sums,
                                   const FieldNorms    &target,
                                   const unsigned int   n_fields,
                                   const double         goal,
                                   const unsigned int   max_iterations,
                                   unsigned int        &k) const
  {
    const Columns<width> &squares = sums[0];
    const std::size_t     n       = x.locally_owned_size();
    const MPI_Comm        comm    = mass.unknowns().communicator();
    for (VectorOf<float> *vector : {&e, &p, &s})
      std::fill_n(vector->begin(), n, 0.f);
    // Scale entries to order 1.
    Columns<width> scale{}, rr{};
    for (int c = 0; c < width; ++c)
      if (squares[c] > 0.)
        {
          rr[c]    = x.size() / width;
          scale[c] = std::sqrt(rr[c] / squares[c]);
        }
    for (std::size_t i = 0; i < n; ++i)
      r.local_element(i) = scale[i % width] * residual.local_element(i);

    double         ratio = std::numeric_limits<double>::infinity();
    Columns<width> alpha{}, beta{}, gamma{}, curvature{}, ss{};
    for (unsigned int first = k; ratio > goal && k < max_iterations;)
      {
        precondition(u, r, width, n_fields * dim);
        mass.vmult(w, u, width);
        const auto     dot = dots<width>(r, u, w, s, comm);
        Columns<width> squares_now{};
        for (int c = 0; c < width; ++c)
          {
            const double ru = dot[r_u][c];
            // A preconditioner that may change between iterations needs the
            // beta of Polak and Ribiere.
            beta[c]      = gamma[c] <= 0. ? 0.
                           : other_preconditioner
                             ? -alpha[c] * dot[u_s][c] / gamma[c]
                             : ru / gamma[c];
            curvature[c] = dot[u_w][c] + 2. * beta[c] * dot[u_s][c] +
                           beta[c] * beta[c] * curvature[c];
            alpha[c] = curvature[c] > 0. ? ru / curvature[c] : 0.;
            gamma[c] = ru;
            ss[c]    = dot[w_w][c] + 2. * beta[c] * dot[w_s][c] +
                    beta[c] * beta[c] * ss[c];
            if (k > first)
              rr[c] = dot[r_r][c];
            // The difference has round-off of single precision.
            const double rs = dot[r_w][c] + beta[c] * dot[r_s][c];
            const double new_rr =
              rr[c] + alpha[c] * (alpha[c] * ss[c] - 2. * rs);
            if (scale[c] > 0.)
              squares_now[c] =
                std::max(new_rr, 1e-5 * rr[c]) / (scale[c] * scale[c]);
            if (std::isnan(new_rr))
              squares_now[c] = new_rr;
          }
        make_step<width>(e, r, p, s, u, w, alpha, beta);
        ++k;
        ratio = largest_ratio(norms_of<width>(squares_now, n_fields, dim),
                              target,
                              n_fields);
        if (!std::isfinite(ratio))
          break;
      }
    // A times a constant vector gives the row sums.
    std::array<Columns<width>, 1> change{};
    const auto &functions = mass.unknowns().unknown_functions();
    const bool  has_sums  = row_sums.size() > 0;
    for (std::size_t u = 0; u < functions.size(); ++u)
      for (int c = 0; c < width; ++c)
        if (scale[c] > 0.)
          {
            const double correction =
              e.local_element(u * width + c) / (unit * scale[c]);
            x.local_element(u * width + c) += correction;
            if (has_sums)
              change[0][c] += row_sums.local_element(functions[u]) * correction;
          }
    if (has_sums)
      add_up(change, comm);
    for (int c = 0; c < width; ++c)
      sums[3][c] -= change[0][c];
    return ratio;
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedMassSolver);
} // namespace greville
