// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/particles/trial_step.h>

#include "gradients.h"
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * The part of a 3D tensor in the plane of a 2D problem.
     */
    template <int dim, typename Full>
    Tensor<2, dim>
    in_plane(const Full &A)
    {
      Tensor<2, dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] = A[i][j];
      return result;
    }



    /**
     * P and dP / df from what the material gives for the end of a step.
     */
    template <int dim>
    void
    set_end_stress(TrialPoint<dim>       &trial,
                   const Tensor<2, dim>  &f,
                   const MaterialPoint   &end,
                   const MaterialTangent *D)
    {
      const double         det     = determinant(f);
      const Tensor<2, dim> inverse = invert(f);
      const Tensor<2, dim> sigma   = in_plane<dim>(end.stress);
      trial.P                      = det * sigma * transpose(inverse);
      if (!D)
        return;
      // A_ijkl, then pulled back index by index.
      Tensor<4, dim> B;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int k = 0; k < dim; ++k)
            {
              Tensor<1, dim> A;
              for (unsigned int l = 0; l < dim; ++l)
                A[l] = det * ((*D)[i][j][k][l] + (k == l ? sigma[i][j] : 0.) -
                              (j == k ? sigma[i][l] : 0.));
              for (unsigned int L = 0; L < dim; ++L)
                {
                  double sum = 0.;
                  for (unsigned int l = 0; l < dim; ++l)
                    sum += A[l] * inverse[L][l];
                  B[i][j][k][L] = sum;
                }
            }
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int J = 0; J < dim; ++J)
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int L = 0; L < dim; ++L)
              {
                double sum = 0.;
                for (unsigned int j = 0; j < dim; ++j)
                  sum += inverse[J][j] * B[i][j][k][L];
                trial.dP[i][J][k][L] = sum;
              }
    }



    /**
     * Change P at the end of the step, and its derivative, to those of the
     * energy-consistent stress, see TrialStep.
     */
    template <int dim>
    void
    make_energy_consistent(TrialPoint<dim>      &trial,
                           const Tensor<2, dim> &f,
                           const Tensor<2, dim> &stress_before,
                           const double          change_of_energy,
                           const bool            with_tangent)
    {
      const Tensor<2, dim> one     = unit_symmetric_tensor<dim>();
      const Tensor<2, dim> inverse = invert(f);
      const Tensor<2, dim> middle  = 0.5 * (one + f);
      const Tensor<2, dim> end     = inverse * trial.P;
      const Tensor<2, dim> grad    = f - one;
      const Tensor<2, dim> strain =
        0.5 * (grad + transpose(grad) + transpose(grad) * grad);
      Tensor<2, dim> S      = 0.5 * (stress_before + end);
      const double   square = scalar_product(strain, strain);
      // The correction is of the order of the square of the strain, and
      // round-off of the energy over the strain: smaller strains do without.
      constexpr double smallest = 6e-6; // the third root of round-off
      if (square > smallest * smallest)
        S += ((change_of_energy - scalar_product(S, strain)) / square) * strain;
      if (with_tangent)
        {
          // dP = df S / 2 + middle dS, dS = f^-1 (dP_end - df S_end) / 2.
          Tensor<4, dim>       dP;
          const Tensor<2, dim> map = 0.5 * middle * inverse;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int J = 0; J < dim; ++J)
              for (unsigned int k = 0; k < dim; ++k)
                for (unsigned int L = 0; L < dim; ++L)
                  {
                    double sum =
                      (i == k ? 0.5 * S[L][J] : 0.) - map[i][k] * end[L][J];
                    for (unsigned int m = 0; m < dim; ++m)
                      sum += map[i][m] * trial.dP[m][J][k][L];
                    dP[i][J][k][L] = sum;
                  }
          trial.dP = dP;
        }
      trial.P = middle * S;
    }



    /**
     * Change P, and its derivative by f, which belong to gradients with respect
     * to x_n, to what belongs to those with respect to X.
     */
    template <int dim>
    void
    pull_back(TrialPoint<dim>      &trial,
              const Tensor<2, dim> &inverse,
              const bool            with_tangent)
    {
      trial.P = trial.P * transpose(inverse);
      if (!with_tangent)
        return;
      Tensor<4, dim> A, B;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int J = 0; J < dim; ++J)
          for (unsigned int j = 0; j < dim; ++j)
            A[i][J] += inverse[J][j] * trial.dP[i][j];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int J = 0; J < dim; ++J)
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int L = 0; L < dim; ++L)
              for (unsigned int l = 0; l < dim; ++l)
                B[i][J][k][L] += inverse[L][l] * A[i][J][k][l];
      trial.dP = B;
    }



    /**
     * Name what is wrong with a point.
     */
    template <int dim>
    void
    report_bad_point(const ConstPointRef<dim> p,
                     const double             J,
                     PointReport             &report)
    {
      if (report.bad_point >= 0)
        return;
      report.bad_point = std::int64_t(p.id());
      std::ostringstream reason;
      if (J <= 0.)
        reason << "its volume becomes negative (J = " << J << ")";
      else
        reason << "its stress or tangent becomes infinite or NaN (J = " << J
               << ")";
      report.bad_reason = reason.str();
    }



    template <int dim>
    bool
    is_finite(const TrialPoint<dim> &trial, const bool with_tangent)
    {
      // Sums side by side do not wait for one another.
      Tensor<1, dim> sums;
      for (unsigned int i = 0; i < dim; ++i)
        {
          sums += trial.P[i];
          if (with_tangent)
            for (unsigned int j = 0; j < dim; ++j)
              for (unsigned int k = 0; k < dim; ++k)
                sums += trial.dP[i][j][k];
        }
      double sum = 0.;
      for (unsigned int i = 0; i < dim; ++i)
        sum += sums[i];
      return std::isfinite(sum);
    }



    template <int dim, int n>
    void
    evaluate_points(const MaterialPoints<dim>             &points,
                    const Material                        &material,
                    const SpacePolynomials<dim>           &tables,
                    const double                          *u,
                    const double                           dt,
                    const double                           strength_reduction,
                    const StepStress                       stress,
                    const bool                             with_tangents,
                    const double                          *factors,
                    PointReport                           &report,
                    const typename TrialStep<dim>::Action &action)
    {
      const PointLayout<dim>      &layout      = points.layout();
      constexpr int                n_functions = power(n, dim);
      std::vector<TrialPoint<dim>> trials;
      std::vector<Tensor<2, dim>>  increments;
      std::vector<MaterialPoint>   states, ends;
      std::vector<MaterialTangent> tangents;
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(tables, cell);
          double                     coefficients[dim][n_functions];
          for (int a = 0; a < n_functions; ++a)
            for (int i = 0; i < dim; ++i)
              coefficients[i][a] =
                u[std::size_t(geometry.functions[a]) * dim + i];

          trials.clear();
          increments.clear();
          states.clear();
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            TrialPoint<dim> &trial = trials.emplace_back();
            trial.x                = p.basis_position(layout);
            trial.volume           = p.volume();
            const Gradients<dim, n> gradients(geometry, trial.x);
            const Tensor<2, dim>    f = increment_of_point<dim, n>(
              p, layout, gradients, coefficients, 1.);
            const Tensor<2, dim> projected = factors ? *factors++ * f : f;
            MaterialPoint        state;
            load_material_point<dim>(p, layout, state);
            state.dt                 = dt;
            state.strength_reduction = strength_reduction;
            for (int i = 0; i < dim; ++i)
              for (int j = 0; j < dim; ++j)
                state.increment[i][j] = projected[i][j];
            state.F = state.increment * state.F;
            state.J *= determinant(projected);
            increments.push_back(f);
            states.push_back(state);
          });

          ends = states;
          material.update(make_array_view(ends));
          if (with_tangents)
            {
              tangents.resize(states.size());
              material.tangents(ArrayView<const MaterialPoint>(states.data(),
                                                               states.size()),
                                make_array_view(tangents),
                                dim);
            }
          unsigned int k = 0;
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            TrialPoint<dim> &trial = trials[k];
            set_end_stress<dim>(trial,
                                increments[k],
                                ends[k],
                                with_tangents ? &tangents[k] : nullptr);
            if (stress == StepStress::energy_consistent)
              {
                MaterialPoint before;
                load_material_point<dim>(p, layout, before);
                const double change = (material.strain_energy(ends[k]) +
                                       material.dissipation(ends[k]) -
                                       material.strain_energy(before) -
                                       material.dissipation(before)) /
                                      p.J();
                make_energy_consistent<dim>(trial,
                                            increments[k],
                                            in_plane<dim>(before.stress),
                                            change,
                                            with_tangents);
              }
            if (layout.is_total_lagrangian())
              pull_back<dim>(trial, inverse_F<dim>(p, layout), with_tangents);
            if (!(ends[k].J > 0.) || !is_finite(trial, with_tangents))
              report_bad_point<dim>(p, ends[k].J, report);
            ++k;
          });
          action(cell, trials);
        }
    }
  } // namespace



  template <int dim>
  void
  TrialStep<dim>::reinit(const SplineSpace<dim> &space)
  {
    tables.space = &space;
    for (unsigned int d = 0; d < dim; ++d)
      tables.directions[d].reinit(space.knots(d));
  }



  template <int dim>
  PointReport
  TrialStep<dim>::evaluate(const MaterialPoints<dim> &points,
                           const Material            &material,
                           const VectorField<dim>    &u,
                           const double               dt,
                           const double               strength_reduction,
                           const StepStress           stress,
                           const bool                 with_tangents,
                           VolumeProjection<dim>     *projection,
                           const Action              &action)
  {
    const double *factors =
      projection ? projection->factors(points, u, 1.).data() : nullptr;
    const SplineSpace<dim> &space = *tables.space;
    buffer.resize(
      (space.owned_functions().size() + space.ghost_functions().size()) * dim);
    for (unsigned int d = 0; d < dim; ++d)
      put_into_buffer(u[d], dim, d, buffer);
    PointReport report;
    with_order(space.degree(), [&](const auto size) {
      evaluate_points<dim, decltype(size)::value>(points,
                                                  material,
                                                  tables,
                                                  buffer.data(),
                                                  dt,
                                                  strength_reduction,
                                                  stress,
                                                  with_tangents,
                                                  factors,
                                                  report,
                                                  action);
    });
    return report;
  }



  template <int dim>
  void
  TrialSums<dim>::reinit(const SplineSpace<dim> &space)
  {
    tables.space = &space;
    for (unsigned int d = 0; d < dim; ++d)
      tables.directions[d].reinit(space.knots(d));
    const std::size_t n = Utilities::fixed_power<dim>(space.degree() + 1) * dim;
    matrix.resize(n * n);
    clear();
  }



  template <int dim>
  void
  TrialSums<dim>::clear()
  {
    square = 0.;
    sums.assign((tables.space->owned_functions().size() +
                 tables.space->ghost_functions().size()) *
                  dim,
                0.);
  }



  namespace
  {
    template <int dim, int n>
    double
    add_force_of_cell(const CellGeometry<dim, n>         &geometry,
                      const std::vector<TrialPoint<dim>> &points,
                      double                             *sums)
    {
      constexpr int n_functions             = power(n, dim);
      double        force[dim][n_functions] = {};
      for (const TrialPoint<dim> &point : points)
        {
          const Gradients<dim, n> gradients(geometry, point.x);
          for (int i = 0; i < dim; ++i)
            for (int J = 0; J < dim; ++J)
              {
                const double P = point.volume * point.P[i][J];
                for (int a = 0; a < n_functions; ++a)
                  force[i][a] += P * gradients.values[J][a];
              }
        }
      double square = 0.;
      for (int a = 0; a < n_functions; ++a)
        for (int i = 0; i < dim; ++i)
          {
            sums[std::size_t(geometry.functions[a]) * dim + i] += force[i][a];
            square += force[i][a] * force[i][a];
          }
      return square;
    }



    template <int dim, int n>
    void
    stiffness_of_cell(const CellGeometry<dim, n>         &geometry,
                      const std::vector<TrialPoint<dim>> &points,
                      double                             *matrix)
    {
      constexpr int n_functions = power(n, dim);
      std::fill_n(matrix, n_functions * dim * n_functions * dim, 0.);
      for (const TrialPoint<dim> &point : points)
        {
          const Gradients<dim, n> gradients(geometry, point.x);
          double                  A[dim][dim][dim][dim];
          for (int i = 0; i < dim; ++i)
            for (int J = 0; J < dim; ++J)
              for (int k = 0; k < dim; ++k)
                for (int L = 0; L < dim; ++L)
                  A[i][J][k][L] = point.volume * point.dP[i][J][k][L];
          double *row = matrix;
          for (int a = 0; a < n_functions; ++a)
            for (int i = 0; i < dim; ++i)
              for (int k = 0; k < dim; ++k, row += n_functions)
                for (int L = 0; L < dim; ++L)
                  {
                    double factor = 0.;
                    for (int J = 0; J < dim; ++J)
                      factor += gradients.values[J][a] * A[i][J][k][L];
                    for (int b = 0; b < n_functions; ++b)
                      row[b] += factor * gradients.values[L][b];
                  }
        }
    }
  } // namespace



  template <int dim>
  void
  TrialSums<dim>::add_force(const unsigned int                  cell,
                            const std::vector<TrialPoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      square += add_force_of_cell<dim, n>(geometry, points, sums.data());
    });
  }



  template <int dim>
  void
  TrialSums<dim>::take_force(VectorField<dim> &force) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      take_from_buffer(sums, dim, d, force[d]);
  }



  template <int dim>
  const double *
  TrialSums<dim>::stiffness(const unsigned int                  cell,
                            const std::vector<TrialPoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      stiffness_of_cell<dim, n>(geometry, points, matrix.data());
    });
    return matrix.data();
  }



  namespace
  {
    template <int dim, int n>
    double
    add_force_of_surface(const CellGeometry<dim, n>                &geometry,
                         const std::vector<TrialSurfacePoint<dim>> &points,
                         double                                    *sums)
    {
      double square                    = 0.;
      double force[power(n, dim)][dim] = {};
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          for (int a = 0; a < power(n, dim); ++a)
            for (int i = 0; i < dim; ++i)
              force[a][i] += point.area * point.load[i] * N.values[a];
        }
      for (int a = 0; a < power(n, dim); ++a)
        for (int i = 0; i < dim; ++i)
          {
            sums[std::size_t(geometry.functions[a]) * dim + i] += force[a][i];
            square += force[a][i] * force[a][i];
          }
      return square;
    }



    template <int dim, int n>
    void
    stiffness_of_surface(const CellGeometry<dim, n>                &geometry,
                         const std::vector<TrialSurfacePoint<dim>> &points,
                         double                                    *matrix)
    {
      constexpr int n_functions = power(n, dim);
      std::fill_n(matrix, n_functions * dim * n_functions * dim, 0.);
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          double                          *row = matrix;
          for (int a = 0; a < n_functions; ++a)
            for (int i = 0; i < dim; ++i)
              for (int k = 0; k < dim; ++k, row += n_functions)
                {
                  const double factor = -point.area * N.values[a];
                  for (int b = 0; b < n_functions; ++b)
                    {
                      double sum = point.by_displacement[i][k] * N.values[b];
                      for (int L = 0; L < dim; ++L)
                        sum +=
                          point.by_gradient[i][k][L] * N.gradients.values[L][b];
                      row[b] += factor * sum;
                    }
                }
        }
    }
  } // namespace



  template <int dim>
  void
  TrialSums<dim>::add_force(const unsigned int                         cell,
                            const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      square += add_force_of_surface<dim, n>(geometry, points, sums.data());
    });
  }



  template <int dim>
  const double *
  TrialSums<dim>::stiffness(const unsigned int                         cell,
                            const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      stiffness_of_surface<dim, n>(geometry, points, matrix.data());
    });
    return matrix.data();
  }



  template class TrialStep<2>;
  template class TrialStep<3>;
  template class TrialSums<2>;
  template class TrialSums<3>;
} // namespace greville
