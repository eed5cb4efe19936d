// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_material.h>
#include <greville/points/trial_step.h>

#include "domains.h"
#include "gradients.h"
#include <cmath>
#include <optional>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Return the part of a 3D tensor in the plane of a 2D problem.
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
     * Set P and its derivative from the material's results at the end of a
     * step.
     */
    template <int dim>
    void
    set_end_stress(TrialPoint<dim>       &trial,
                   const Tensor<2, dim>  &f,
                   const MaterialPoint   &end,
                   const MaterialTangent *D)
    {
      auto                &hoop    = trial.hoop;
      const double         det     = determinant(f) * hoop.f;
      const Tensor<2, dim> inverse = invert(f);
      const Tensor<2, dim> sigma   = det * in_plane<dim>(end.stress);
      trial.P                      = sigma * transpose(inverse);
      hoop.P                       = det * end.stress[2][2] / hoop.f;
      if (!D)
        return;
      if (hoop.radius > 0.)
        {
          const double factor = det / hoop.f;
          hoop.A              = factor / hoop.f * (*D)[2][2][2][2];
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              {
                const double diagonal = i == j ? end.stress[2][2] : 0.;
                hoop.of[i][j]         = factor * ((*D)[2][2][i][j] + diagonal);
                hoop.by[i][j] = factor * ((*D)[i][j][2][2] + end.stress[i][j]);
              }
        }
      trial.map = inverse;
      if constexpr (dim == 3)
        {
          const double *from = &(*D)[0][0][0][0];
          double       *to   = &trial.A[0][0][0][0];
          for (unsigned int e = 0; e < Tensor<4, dim>::n_independent_components;
               ++e)
            to[e] = det * from[e];
        }
      else
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            for (unsigned int k = 0; k < dim; ++k)
              for (unsigned int l = 0; l < dim; ++l)
                trial.A[i][j][k][l] = det * (*D)[i][j][k][l];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int k = 0; k < dim; ++k)
            {
              trial.A[i][j][k][k] += sigma[i][j];
              trial.A[i][j][j][k] -= sigma[i][k];
            }
    }



    /// Return dP_iJ / df_kL.
    template <int dim>
    Tensor<4, dim>
    derivative(const TrialPoint<dim> &trial)
    {
      Tensor<4, dim> B, dP;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int J = 0; J < dim; ++J)
          for (unsigned int j = 0; j < dim; ++j)
            B[i][J] += trial.map[J][j] * trial.A[i][j];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int J = 0; J < dim; ++J)
          for (unsigned int k = 0; k < dim; ++k)
            dP[i][J][k] = trial.map * B[i][J][k];
      return dP;
    }



    /**
     * Replace P at the end of the step, and its derivative, by the
     * energy-consistent stress and its derivative, see TrialStep.
     */
    template <int dim>
    void
    make_energy_consistent(TrialPoint<dim>      &trial,
                           const Tensor<2, dim> &f,
                           const Tensor<2, dim> &stress_before,
                           const double          hoop_stress_before,
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
      Tensor<2, dim> S = 0.5 * (stress_before + end);
      // The zz entries of an axisymmetric point.
      auto        &hoop        = trial.hoop;
      const double hoop_strain = 0.5 * (hoop.f * hoop.f - 1.);
      const double hoop_end    = hoop.P / hoop.f;
      const double hoop_middle = 0.5 * (1. + hoop.f);
      double       hoop_S      = 0.5 * (hoop_stress_before + hoop_end);
      const double square =
        scalar_product(strain, strain) + hoop_strain * hoop_strain;
      // The correction is of the order of the square of the strain, and of
      // round-off of the energy over the strain: it is omitted for smaller
      // strains.
      constexpr double smallest = 6e-6; // the third root of round-off
      if (square > smallest * smallest)
        {
          const double factor = (change_of_energy - scalar_product(S, strain) -
                                 hoop_S * hoop_strain) /
                                square;
          S += factor * strain;
          hoop_S += factor * hoop_strain;
        }
      if (with_tangent)
        {
          // dP = df S / 2 + middle dS, dS = f^-1 (dP_end - df S_end) / 2.
          const Tensor<4, dim> dP_end = derivative(trial);
          const Tensor<2, dim> map    = 0.5 * middle * inverse;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int J = 0; J < dim; ++J)
              for (unsigned int k = 0; k < dim; ++k)
                for (unsigned int L = 0; L < dim; ++L)
                  {
                    double sum =
                      (i == k ? 0.5 * S[L][J] : 0.) - map[i][k] * end[L][J];
                    for (unsigned int m = 0; m < dim; ++m)
                      sum += map[i][m] * dP_end[m][J][k][L];
                    trial.A[i][J][k][L] = sum;
                  }
          if (hoop.radius > 0.)
            {
              const double hoop_map = 0.5 * hoop_middle / hoop.f;
              hoop.A  = 0.5 * hoop_S + hoop_map * (hoop.A - hoop_end);
              hoop.of = hoop_map * (hoop.of * transpose(trial.map));
              hoop.by = map * (hoop.by * transpose(trial.map));
            }
          trial.map = one;
        }
      trial.P = middle * S;
      hoop.P  = hoop_middle * hoop_S;
    }



    /**
     * Transform P, and its derivative by f, from gradients with respect to x_n
     * to gradients with respect to X.
     */
    template <int dim>
    void
    pull_back(TrialPoint<dim>      &trial,
              const Tensor<2, dim> &inverse,
              const bool            with_tangent)
    {
      trial.P = trial.P * transpose(inverse);
      if (with_tangent)
        trial.map = inverse * trial.map;
    }



    /// Report an invalid point.
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
      // Independent sums need not wait for one another.
      constexpr unsigned int n       = dim * dim;
      const double          *A       = &trial.A[0][0][0][0];
      double                 sums[n] = {};
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          sums[i * dim + j] = trial.P[i][j];
      for (unsigned int i = 0; i < n && with_tangent; ++i, A += n)
        for (unsigned int j = 0; j < n; ++j)
          sums[j] += A[j];
      double sum = trial.hoop.P + trial.hoop.A;
      for (unsigned int j = 0; j < n; ++j)
        sum += sums[j];
      return std::isfinite(sum);
    }



    /// The arguments of TrialStep::evaluate() that all points share.
    template <int dim>
    struct TrialArguments
    {
      const MaterialPoints<dim> &points;
      const Material            &material;
      double                     dt, time, strength_reduction;
      StepStress                 stress;
      bool                       with_tangents;
    };



    /**
     * The increments f of the points of a cell by a displacement of the grid,
     * at the points or as means over their domains.
     */
    template <int dim, int n>
    class CellIncrements
    {
    public:
      inline __attribute__((always_inline))
      CellIncrements(const MaterialPoints<dim>   &points,
                     const SpacePolynomials<dim> &tables,
                     const CellWindows<dim>      *windows,
                     const double                *u,
                     const double                *window_u,
                     const unsigned int           cell)
        : points(points)
        , layout(points.layout())
        , geometry(tables, cell)
      {
        for (int a = 0; a < n_functions; ++a)
          for (int i = 0; i < dim; ++i)
            coefficients[i][a] =
              u[std::size_t(geometry.functions[a]) * dim + i];
        if (windows && windows->reaches(cell))
          {
            window.emplace(tables, *windows, cell);
            read_window(*window, window_u, in_window);
          }
      }

      /// Return a point's increment, and set its position, domain and f_zz.
      inline __attribute__((always_inline)) Tensor<2, dim>
      evaluate(const ConstPointRef<dim> p, TrialPoint<dim> &trial) const
      {
        double radial = 0.; // displacement of axisymmetric points
        trial.x       = p.basis_position(layout);
        const Tensor<2, dim> f =
          window ? mean(p, trial, radial) : value(p, trial, radial);
        if (layout.is_axisymmetric())
          {
            trial.hoop.radius = radius_of_F<dim>(p, layout);
            trial.hoop.f      = (p.position(0) + radial) / trial.hoop.radius;
          }
        return f;
      }

    private:
      /// Return the increment at a point.
      inline __attribute__((always_inline)) Tensor<2, dim>
      value(const ConstPointRef<dim> p,
            const TrialPoint<dim>   &trial,
            double                  &radial) const
      {
        const auto shape = evaluated(geometry, trial.x);
        if (layout.is_axisymmetric())
          radial = value_of_component(shape, coefficients[0]);
        return increment_of_point<dim, n>(
          p, layout, Gradients<dim, n>(shape), coefficients, 1.);
      }

      /// Return the mean of the increment over the domain of a point.
      inline __attribute__((always_inline)) Tensor<2, dim>
      mean(const ConstPointRef<dim> p,
           TrialPoint<dim>         &trial,
           double                  &radial) const
      {
        trial.domain     = domain_of_point(points, p);
        const auto shape = evaluated(*window, trial.x, trial.domain);
        double     values[dim], H[dim][dim];
        shape.template evaluate_field<true>(in_window, values, H);
        radial = values[0];
        return unit_symmetric_tensor<dim>() + Tensor<2, dim>(H);
      }

      static constexpr int n_functions = power(n, dim);

      const MaterialPoints<dim>            &points;
      const PointLayout<dim>               &layout;
      const CellGeometry<dim, n>            geometry;
      double                                coefficients[dim][n_functions];
      std::optional<WindowGeometry<dim, n>> window;
      double in_window[WindowShape<dim, n>::n_functions * dim];
    };



    /// The points of a cell in a trial step, and their materials.
    template <int dim>
    class TrialCell
    {
    public:
      TrialCell(const TrialArguments<dim> &arguments,
                const double              *J_hat,
                PointReport               &report)
        : arguments(arguments)
        , points(arguments.points)
        , layout(points.layout())
        , J_hat(J_hat)
        , report(report)
      {}

      void
      begin()
      {
        n_points = 0;
      }

      /// Add a point, with its increment.
      template <int n>
      inline __attribute__((always_inline)) void
      add(const ConstPointRef<dim> p, const CellIncrements<dim, n> &increments)
      {
        if (trials.size() == n_points)
          trials.emplace_back();
        if (states.size() == n_points)
          {
            states.emplace_back();
            all_increments.emplace_back();
          }
        TrialPoint<dim> &trial = trials[n_points];
        trial.volume           = p.volume();
        const Tensor<2, dim> f = increments.evaluate(p, trial);
        set_state(p, f, trial.hoop.f, states[n_points]);
        all_increments[n_points] = f;
        ++n_points;
      }

      /// Update the materials and stresses of the points that have been added.
      __attribute__((noinline)) std::vector<TrialPoint<dim>> &
      evaluate(const unsigned int cell)
      {
        trials.resize(n_points);
        states.resize(n_points);
        update_materials();
        unsigned int k = 0;
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          set_stress(p, k++);
        });
        return trials;
      }

    private:
      /// Set the state that the material updates, for the increment f.
      inline __attribute__((always_inline)) void
      set_state(const ConstPointRef<dim> p,
                const Tensor<2, dim>    &f,
                const double             f_zz,
                MaterialPoint           &state)
      {
        const double theta = determinant(f) * f_zz;
        state              = MaterialPoint();
        load_material_point<dim>(p, layout, state);
        state.dt                 = arguments.dt;
        state.time               = arguments.time;
        state.strength_reduction = arguments.strength_reduction;
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            state.increment[i][j] = f[i][j];
        if (layout.is_axisymmetric())
          state.increment[2][2] = f_zz;
        const double J_before = state.J;
        state.J               = p.J() * theta;
        if (layout.projected_J != 0)
          {
            if (J_hat)
              state.J = *J_hat++;
            scale_volume<dim>(state.increment,
                              state.J / J_before / theta,
                              layout);
          }
        state.F = state.increment * state.F;
      }

      void
      update_materials()
      {
        // Tangents need the states at the start, too.
        if (arguments.with_tangents)
          ends = states;
        arguments.material.update(make_array_view(updated()));
        if (arguments.with_tangents)
          {
            tangents.resize(n_points);
            arguments.material.tangents(
              ArrayView<const MaterialPoint>(states.data(), states.size()),
              make_array_view(tangents),
              layout.is_axisymmetric() ? 3 : dim);
          }
      }

      /// Set the stress of point number @p k.
      void
      set_stress(const ConstPointRef<dim> p, const unsigned int k)
      {
        const bool       with_tangents = arguments.with_tangents;
        TrialPoint<dim> &trial         = trials[k];
        set_end_stress<dim>(trial,
                            all_increments[k],
                            updated()[k],
                            with_tangents ? &tangents[k] : nullptr);
        if (arguments.stress == StepStress::energy_consistent)
          {
            MaterialPoint before;
            load_material_point<dim>(p, layout, before);
            make_energy_consistent<dim>(trial,
                                        all_increments[k],
                                        in_plane<dim>(before.stress),
                                        before.stress[2][2],
                                        change_of_energy(updated()[k], before) /
                                          p.J(),
                                        with_tangents);
          }
        if (layout.is_total_lagrangian())
          pull_back<dim>(trial, inverse_F<dim>(p, layout), with_tangents);
        const double J = p.J() * determinant(all_increments[k]) * trial.hoop.f;
        if (!(J > 0.) || !is_finite(trial, with_tangents))
          report_bad_point<dim>(p, J, report);
      }

      double
      change_of_energy(const MaterialPoint &end,
                       const MaterialPoint &before) const
      {
        const Material &material = arguments.material;
        return material.strain_energy(end) + material.dissipation(end) -
               material.strain_energy(before) - material.dissipation(before);
      }

      std::vector<MaterialPoint> &
      updated()
      {
        return arguments.with_tangents ? ends : states;
      }

      const TrialArguments<dim>    arguments;
      const MaterialPoints<dim>   &points;
      const PointLayout<dim>      &layout;
      const double                *J_hat;
      PointReport                 &report;
      unsigned int                 n_points = 0;
      std::vector<TrialPoint<dim>> trials;
      std::vector<Tensor<2, dim>>  all_increments;
      std::vector<MaterialPoint>   states, ends;
      std::vector<MaterialTangent> tangents;
    };



    template <int dim, int n>
    __attribute__((noinline)) void
    evaluate_points(const MaterialPoints<dim>             &points,
                    const SpacePolynomials<dim>           &tables,
                    const CellWindows<dim>                *windows,
                    const double                          *u,
                    const double                          *window_u,
                    TrialCell<dim>                        &trial,
                    const typename TrialStep<dim>::Action &action)
    {
      for (const unsigned int cell : points.cells())
        {
          const CellIncrements<dim, n> increments(
            points, tables, windows, u, window_u, cell);
          trial.begin();
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            trial.add(p, increments);
          });
          action(cell, trial.evaluate(cell));
        }
    }
  } // namespace



  template <int dim>
  void
  TrialStep<dim>::reinit(const SplineSpace<dim> &space,
                         const CellWindows<dim> *given)
  {
    tables.reinit(space);
    windows = given;
  }



  template <int dim>
  PointReport
  TrialStep<dim>::evaluate(const MaterialPoints<dim> &points,
                           const Material            &material,
                           const VectorField<dim>    &u,
                           const double               dt,
                           const double               time,
                           const double               strength_reduction,
                           const StepStress           stress,
                           const bool                 with_tangents,
                           const double              *J_hat,
                           const Action              &action)
  {
    const SplineSpace<dim> &space = *tables.space;
    buffer.resize(
      (space.owned_functions().size() + space.ghost_functions().size()) * dim);
    for (unsigned int d = 0; d < dim; ++d)
      put_into_buffer(u[d], dim, d, buffer);
    const CellWindows<dim> *used_windows = windows_of(points, windows);
    if (used_windows)
      used_windows->read(u, window_buffer);
    PointReport    report;
    TrialCell<dim> trial(
      {points, material, dt, time, strength_reduction, stress, with_tangents},
      J_hat,
      report);
    with_order(space.degree(), [&](const auto size) {
      evaluate_points<dim, decltype(size)::value>(points,
                                                  tables,
                                                  used_windows,
                                                  buffer.data(),
                                                  window_buffer.data(),
                                                  trial,
                                                  action);
    });
    return report;
  }



  template class TrialStep<2>;
  template class TrialStep<3>;
} // namespace greville
