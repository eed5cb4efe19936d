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
    const ColumnPreconditioner &preconditioner)
    : mass(mass)
    , parameters(parameters)
    , other_preconditioner(preconditioner)
  {}



  template <int dim>
  void
  ExtendedMassSolver<dim>::update(const bool   unknowns_changed,
                                  const double new_total_mass)
  {
    total_mass = new_total_mass;
    age        = unknowns_changed ? max_age : age + 1;
  }



  namespace
  {
    /**
     * Return parameters with which conjugate gradients need the least time
     * (doc/results/mass_solvers.md).
     */
    CholeskyParameters
    parameters_for(const int dim, const unsigned int degree)
    {
      if (dim == 2)
        return {0.005, degree <= 2 ? 0.02 : degree == 3 ? 0.01 : 0.005};
      return degree <= 2 ? CholeskyParameters{0.003, 0.003}
                         : CholeskyParameters{0.001, 0.001};
    }
  } // namespace



  template <int dim>
  void
  ExtendedMassSolver<dim>::factorize() const
  {
    factors.factorize(mass.local_entries((1u << dim) - 1),
                      mass.unknowns().unknown_layout(),
                      mass.unknowns().unknown_positions(),
                      mass.matrix().space().degree(),
                      1,
                      parameters_for(dim, mass.matrix().space().degree()));
    ++factorizations;
    age = 0;
  }



  template <int dim>
  void
  ExtendedMassSolver<dim>::precondition(VectorType        &z,
                                        const VectorType  &r,
                                        const unsigned int width,
                                        const unsigned int n_columns) const
  {
    if (other_preconditioner)
      other_preconditioner(z, r, width, n_columns);
    else
      {
        if (age >= max_age)
          factorize();
        std::copy_n(r.begin(), r.locally_owned_size(), z.begin());
        factors.solve(z.begin(), width);
      }
    mass.unknowns().zero_constrained_unknowns(z, width);
  }



  namespace
  {
    template <int width>
    using Columns = std::array<double, width>;

    template <int width>
    void
    add_up(Columns<width> &sums, const MPI_Comm comm)
    {
      if (Utilities::MPI::n_mpi_processes(comm) > 1)
        Utilities::MPI::sum(ArrayView<const double>(sums.data(), width),
                            comm,
                            ArrayView<double>(sums.data(), width));
    }



    template <int width>
    Columns<width>
    dot(const VectorType &a, const VectorType &b, const MPI_Comm comm)
    {
      Columns<width> sums{};
      const double  *x = a.begin(), *y = b.begin();
      for (unsigned int i = 0; i < a.locally_owned_size(); i += width)
        for (int c = 0; c < width; ++c)
          sums[c] += x[i + c] * y[i + c];
      add_up<width>(sums, comm);
      return sums;
    }



    /// y = s y + x, column by column.
    template <int width>
    void
    scale_and_add(VectorType &y, const Columns<width> &s, const VectorType &x)
    {
      double       *out = y.begin();
      const double *in  = x.begin();
      for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
        for (int c = 0; c < width; ++c)
          out[i + c] = s[c] * out[i + c] + in[i + c];
    }



    /// x += alpha p, r -= alpha q. Returns the squares of r, column by column.
    template <int width>
    Columns<width>
    make_step(VectorType           &x,
              VectorType           &r,
              const VectorType     &p,
              const VectorType     &q,
              const Columns<width> &alpha,
              const MPI_Comm        comm)
    {
      Columns<width> squares{};
      double        *x_i = x.begin(), *r_i = r.begin();
      const double  *p_i = p.begin(), *q_i = q.begin();
      for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
        for (int c = 0; c < width; ++c)
          {
            x_i[i + c] += alpha[c] * p_i[i + c];
            r_i[i + c] -= alpha[c] * q_i[i + c];
            squares[c] += r_i[i + c] * r_i[i + c];
          }
      add_up<width>(squares, comm);
      return squares;
    }



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
        if (!std::isfinite(reference[k]))
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
    // Old factors may be useless after a sudden change of the mass.
    const bool is_old = !other_preconditioner && age > 0 && age < max_age;
    const unsigned int n_before = factorizations;
    SolveResult        result =
      run(is_old ? std::min(parameters.max_iterations, 2 * fresh_iterations + 5)
                 : parameters.max_iterations);
    if (!result.converged && is_old)
      {
        const unsigned int n_wasted = *result.iterations;
        forget();
        result = run(parameters.max_iterations);
        *result.iterations += n_wasted;
      }
    else if (factorizations > n_before)
      fresh_iterations = *result.iterations;
    mass.unknowns().write_fields(x, unknowns, width);
    return result;
  }



  template <int dim>
  template <int width>
  FieldNorms
  ExtendedMassSolver<dim>::begin(VectorType        &x,
                                 VectorType        &r,
                                 const unsigned int n_fields,
                                 const FieldNorms  &right_hand_sides) const
  {
    VectorType q;
    mass.unknowns().initialize_vector(q, width);
    mass.vmult(q, x, width);
    q.sadd(-1., 1., r);
    const MPI_Comm comm = mass.unknowns().communicator();
    FieldNorms norms = norms_of<width>(dot<width>(q, q, comm), n_fields, dim);
    for (unsigned int k = 0; k < n_fields; ++k)
      if (!(norms[k] <= right_hand_sides[k]))
        {
          norms[k] = right_hand_sides[k];
          for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
            for (unsigned int c = k * dim; c < (k + 1) * dim; ++c)
              {
                x.local_element(i + c) = 0.;
                q.local_element(i + c) = r.local_element(i + c);
              }
        }
    r.swap(q);
    return norms;
  }



  template <int dim>
  template <int width>
  SolveResult
  ExtendedMassSolver<dim>::iterate(VectorType                &x,
                                   VectorType                &r,
                                   const unsigned int         n_fields,
                                   const std::vector<double> &shares,
                                   const unsigned int max_iterations) const
  {
    const MPI_Comm comm = mass.unknowns().communicator();
    VectorType     p, q, z;
    for (VectorType *vector : {&p, &q, &z})
      mass.unknowns().initialize_vector(*vector, width);
    FieldNorms target = norms_of<width>(dot<width>(r, r, comm), n_fields, dim);
    FieldNorms now    = begin<width>(x, r, n_fields, target);
    for (unsigned int k = 0; k < shares.size(); ++k)
      target[k] = std::max(target[k], shares[k] * shares[k] * target[0]);

    double         ratio = largest_ratio(now, target, n_fields);
    unsigned int   k     = 0;
    Columns<width> rho{}, alpha{}, beta{};
    for (; ratio > parameters.tolerance && std::isfinite(ratio) &&
           k < max_iterations;
         ++k)
      {
        precondition(z, r, width, n_fields * dim);
        const auto new_rho = dot<width>(r, z, comm);
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
        scale_and_add<width>(p, beta, z);
        mass.vmult(q, p, width);
        const auto curvature = dot<width>(p, q, comm);
        for (int c = 0; c < width; ++c)
          alpha[c] = curvature[c] > 0. ? rho[c] / curvature[c] : 0.;
        now   = norms_of<width>(make_step<width>(x, r, p, q, alpha, comm),
                              n_fields,
                              dim);
        ratio = largest_ratio(now, target, n_fields);
      }
    remove_mean_residual<width>(x, r, n_fields);

    SolveResult result;
    result.iterations = k;
    result.reduction  = ratio;
    result.converged  = ratio <= parameters.tolerance;
    if (!result.converged)
      result.reason = reason_of_failure(ratio, k, target);
    return result;
  }



  template <int dim>
  template <int width>
  void
  ExtendedMassSolver<dim>::remove_mean_residual(
    VectorType &x, const VectorType &r, const unsigned int n_fields) const
  {
    const auto    &is_constrained = mass.unknowns().has_constrained();
    Columns<width> sums{};
    for (unsigned int i = 0; i < r.locally_owned_size(); i += width)
      for (int c = 0; c < width; ++c)
        sums[c] += r.local_element(i + c);
    add_up<width>(sums, mass.unknowns().communicator());
    for (unsigned int c = 0; c < n_fields * dim; ++c)
      if (!is_constrained[c % dim] && total_mass > 0.)
        for (unsigned int i = 0; i < x.locally_owned_size(); i += width)
          x.local_element(i + c) += sums[c] / total_mass;
  }



  template class ExtendedMassSolver<2>;
  template class ExtendedMassSolver<3>;
} // namespace greville
