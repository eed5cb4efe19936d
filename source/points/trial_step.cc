// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_tangents.h>
#include <greville/points/trial_step.h>

#include "domains.h"
#include "group_gradients.h"
#include "group_trial.h"
#include <cmath>
#include <optional>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// The arguments of TrialStep::evaluate() that all groups share.
    template <int dim>
    struct TrialArguments
    {
      const MaterialPoints<dim> &points;
      const Material            &material;
      double                     dt, time, strength_reduction;
      StepStress                 stress;
      PointTangents<dim>        *tangents;
    };



    /// The groups of points of a body in a trial step, and their material.
    template <int dim>
    class TrialPoints
    {
    public:
      TrialPoints(const TrialArguments<dim> &arguments,
                  const double              *J_hat,
                  PointReport               &report)
        : arguments(arguments)
        , points(arguments.points)
        , layout(points.layout())
        , lanes_law(dynamic_cast<const LanesMaterial *>(&arguments.material))
        , symmetric(arguments.tangents && arguments.tangents->is_symmetric())
        , lanes(make_material_lanes<dim>(layout))
        , J_hat(J_hat)
        , report(report)
      {}

      /// Evaluate group number @p g with the displacement gradient H and, in
      /// axisymmetry, the radial displacement. @p result already contains the
      /// positions.
      void
      evaluate(const unsigned int g,
               const unsigned int count,
               const Simd (&H)[dim][dim],
               const Simd      &radial,
               TrialGroup<dim> &result)
      {
        const bool is_energy_consistent =
          arguments.stress == StepStress::energy_consistent;
        GroupTrial<dim> trial;
        trial.number = g;
        trial.count  = count;
        trial.n_used = dim * dim + (layout.is_axisymmetric() ? 1 : 0);
        set_deformation(trial, H, radial);
        load_material_lanes<dim>(layout, points.group(g), count, lanes);
        if (is_energy_consistent)
          keep_start(trial);
        deform(trial);
        update_material(trial);
        set_end_stress(trial,
                       lanes.stress,
                       arguments.tangents ? &D : nullptr,
                       symmetric);
        if (is_energy_consistent)
          {
            trial.change_of_energy =
              (energy() - trial.energy_before) /
              load(points.group(g) + PointLayout<dim>::J * simd_width);
            make_energy_consistent(trial, arguments.tangents);
          }
        write(trial, result);
      }

    private:
      /// Set f and the volume.
      inline __attribute__((always_inline)) void
      set_deformation(GroupTrial<dim> &trial,
                      const Simd (&H)[dim][dim],
                      const Simd &radial) const
      {
        using Layout        = PointLayout<dim>;
        const double *group = points.group(trial.number);
        const auto    at    = [&](const unsigned int number) {
          return load(group + number * simd_width);
        };
        const Simd is_used(
          [&](const auto lane) { return lane < trial.count ? 1. : 0.; });
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            trial.f[i][j] = is_used * H[i][j];
        if (layout.is_total_lagrangian())
          {
            Simd gradient[dim][dim];
            std::copy_n(trial.f[0], dim * dim, gradient[0]);
            load_inverse_F<dim>(group, layout.initial_F, reference_map);
            multiply<dim>(gradient, reference_map, trial.f);
          }
        for (int i = 0; i < dim; ++i)
          trial.f[i][i] += 1.;
        trial.theta  = invert<dim>(trial.f, trial.inverse);
        trial.volume = at(Layout::volume0) * at(Layout::J);
        if (layout.is_axisymmetric())
          {
            trial.radius =
              at(layout.radius0) * at(Layout::F + Layout::F_index(2, 2));
            trial.f_zz =
              (at(Layout::position) + is_used * radial) / trial.radius;
            trial.theta *= trial.f_zz;
          }
      }

      /// Keep stress and energy before the step.
      void
      keep_start(GroupTrial<dim> &trial)
      {
        using Layout        = PointLayout<dim>;
        const double *group = points.group(trial.number);
        for (unsigned int k = 0; k < Layout::n_stress; ++k)
          lanes.stress[k] = load(group + (Layout::stress + k) * simd_width);
        for (unsigned int k = Layout::n_stress; k < 6; ++k)
          lanes.stress[k] = 0.;
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            trial.stress_before[i][j] = lanes.stress[number_of_entry[i][j]];
        trial.stress_before_zz = lanes.stress[2];
        trial.energy_before    = energy();
      }

      /// Return the energy per stress-free volume.
      Simd
      energy() const
      {
        const EnergyLanes energies = arguments.material.energies(lanes);
        return energies.strain + energies.dissipation;
      }

      /// Set F, J and the increment of the material.
      inline __attribute__((always_inline)) void
      deform(const GroupTrial<dim> &trial)
      {
        const Simd J_before = lanes.J;
        const Simd J        = trial.theta * load(points.group(trial.number) +
                                          PointLayout<dim>::J * simd_width);
        lanes.J             = J;
        Simd factor         = 1.;
        if (layout.projected_J != 0)
          {
            if (J_hat)
              for (unsigned int lane = 0; lane < trial.count; ++lane)
                lanes.J[lane] = *J_hat++;
            const Simd ratio = lanes.J / J_before / trial.theta;
            for (unsigned int lane = 0; lane < trial.count; ++lane)
              factor[lane] = dim == 2 && !layout.is_axisymmetric()
                               ? std::sqrt(ratio[lane])
                               : std::cbrt(ratio[lane]);
          }
        Simd increment[dim][dim], F[dim][dim], new_F[dim][dim];
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            {
              increment[i][j]            = factor * trial.f[i][j];
              lanes.increment[3 * i + j] = increment[i][j];
              F[i][j]                    = lanes.F[3 * i + j];
            }
        multiply<dim>(increment, F, new_F);
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            lanes.F[3 * i + j] = new_F[i][j];
        if (layout.is_axisymmetric())
          {
            lanes.increment[8] = factor * trial.f_zz;
            lanes.F[8] *= lanes.increment[8];
          }
        lanes.dt                 = arguments.dt;
        lanes.strength_reduction = arguments.strength_reduction;
      }

      /// Compute the stress, the state and D at the end of the step.
      inline __attribute__((always_inline)) void
      update_material(const GroupTrial<dim> &trial)
      {
        if (!lanes_law)
          {
            update_points(trial);
            return;
          }
        if (arguments.tangents)
          lanes_law->tangent_lanes(lanes,
                                   D,
                                   layout.is_axisymmetric() ? 3 : dim);
        lanes_law->update_lanes(lanes);
      }

      /// Do the same for laws that update single points.
      void
      update_points(const GroupTrial<dim> &trial)
      {
        std::array<MaterialPoint, simd_width>   states, ends;
        std::array<MaterialTangent, simd_width> of_points;
        for (unsigned int lane = 0; lane < trial.count; ++lane)
          {
            MaterialPoint &state = states[lane];
            load_material_point<dim>(points.point(trial.number, lane),
                                     layout,
                                     state);
            state.dt                 = arguments.dt;
            state.time               = arguments.time;
            state.strength_reduction = arguments.strength_reduction;
            state.J                  = lanes.J[lane];
            for (unsigned int k = 0; k < 9; ++k)
              {
                state.increment[k / 3][k % 3] = lanes.increment[k][lane];
                state.F[k / 3][k % 3]         = lanes.F[k][lane];
              }
          }
        ends = states;
        arguments.material.update(
          ArrayView<MaterialPoint>(ends.data(), trial.count));
        if (arguments.tangents)
          arguments.material.tangents(
            ArrayView<const MaterialPoint>(states.data(), trial.count),
            ArrayView<MaterialTangent>(of_points.data(), trial.count),
            layout.is_axisymmetric() ? 3 : dim);
        for (unsigned int lane = 0; lane < simd_width; ++lane)
          {
            for (unsigned int e = 0; e < 6; ++e)
              {
                lanes.stress[e][lane] = ends[lane].stress.access_raw_entry(e);
                const auto &of_entry =
                  of_points[lane][entry_rows[e]][entry_columns[e]];
                for (unsigned int k = 0; k < 9 && arguments.tangents; ++k)
                  D[e][k][lane] = of_entry[k / 3][k % 3];
              }
            for (unsigned int k = 0; k < layout.n_state && lane < trial.count;
                 ++k)
              lanes.state[k][lane] = ends[lane].state[k];
          }
      }

      /// Write the stress and its derivative. In total Lagrangian steps,
      /// gradients are with respect to X.
      inline __attribute__((always_inline)) void
      write(GroupTrial<dim> &trial, TrialGroup<dim> &result)
      {
        if (layout.is_total_lagrangian())
          {
            Simd P[dim][dim], map[dim][dim];
            std::copy_n(trial.P[0], dim * dim, P[0]);
            std::copy_n(trial.map[0], dim * dim, map[0]);
            multiply_transposed<dim>(P, reference_map, trial.P);
            multiply<dim>(reference_map, map, trial.map);
          }
        Simd sum = 0.;
        for (int r = 0; r < dim * dim; ++r)
          {
            result.stress[r] = trial.volume * trial.P[r / dim][r % dim];
            sum += result.stress[r];
          }
        if constexpr (dim == 2)
          result.stress[4] = layout.is_axisymmetric()
                               ? trial.volume * trial.P_zz / trial.radius
                               : Simd(0.);
        if (arguments.tangents)
          sum += write_tangent(trial, result);
        const Simd J = trial.theta * load(points.group(trial.number) +
                                          PointLayout<dim>::J * simd_width);
        if (!all_of(J > 0.) || !all_of(isfinite(sum + trial.P_zz)))
          report_bad_points(trial, J, sum + trial.P_zz);
      }

      /// Write the derivative, and return the sum of its entries.
      inline __attribute__((always_inline)) Simd
      write_tangent(GroupTrial<dim> &trial, TrialGroup<dim> &result) const
      {
        result.compression = result.shear = 0.;
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            (i == j ? result.compression : result.shear) +=
              trial.A[i * dim + j][i * dim + j];
        result.compression *= trial.volume * (1. / dim);
        result.shear *= trial.volume * (1. / (dim * (dim - 1)));

        const Simd inverse_radius = 1. / trial.radius;
        map_tangent(trial, inverse_radius, trial.volume, symmetric);
        if (layout.projected_J != 0)
          {
            Simd back[dim][dim];
            invert<dim>(trial.map, back);
            for (int k = 0; k < dim; ++k)
              for (int L = 0; L < dim; ++L)
                {
                  result.expansion[k * dim + L] = back[k][L];
                  result.dual[k * dim + L]      = trial.map[L][k];
                }
            if constexpr (dim == 2)
              {
                result.expansion[4] = trial.f_zz * trial.radius;
                result.dual[4]      = 1. / result.expansion[4];
              }
          }
        // Use independent sums, which need not wait for one another.
        Simd    sums[3] = {0., 0., 0.};
        double *to      = result.tangent;
        for (int r = 0; r < trial.n_used; ++r)
          for (int s = symmetric ? r : 0; s < trial.n_used; ++s)
            {
              store(trial.A[r][s], to);
              to += simd_width;
              sums[s % 3] += trial.A[r][s];
            }
        return sums[0] + sums[1] + sums[2];
      }

      /// Report the first invalid point of a group.
      __attribute__((noinline)) void
      report_bad_points(const GroupTrial<dim> &trial,
                        const Simd            &J,
                        const Simd            &sum) const
      {
        for (unsigned int lane = 0; lane < trial.count && report.bad_point < 0;
             ++lane)
          {
            if (J[lane] > 0. && std::isfinite(sum[lane]))
              continue;
            report.bad_point =
              std::int64_t(points.point(trial.number, lane).id());
            std::ostringstream reason;
            if (J[lane] <= 0.)
              reason << "its volume becomes negative (J = " << J[lane] << ")";
            else
              reason << "its stress or tangent becomes infinite or NaN (J = "
                     << J[lane] << ")";
            report.bad_reason = reason.str();
          }
      }

      const TrialArguments<dim>  arguments;
      const MaterialPoints<dim> &points;
      const PointLayout<dim>    &layout;
      const LanesMaterial       *lanes_law; // null for other laws
      const bool                 symmetric;
      MaterialLanes              lanes;
      TangentLanes               D;
      const double              *J_hat;
      PointReport               &report;
      // In total Lagrangian steps, the inverse of the deformation before the
      // step.
      mutable Simd reference_map[dim][dim];
    };



    /// The functions of a cell and the grid displacement there. Gradients are
    /// taken at points, or as means over their domains.
    template <int dim, int n>
    class CellDisplacement
    {
    public:
      inline __attribute__((always_inline))
      CellDisplacement(const MaterialPoints<dim>   &points,
                       const SpacePolynomials<dim> &tables,
                       const CellWindows<dim>      *windows,
                       const double                *u,
                       const double                *window_u,
                       const unsigned int           cell)
        : points(points)
        , geometry(tables, cell)
      {
        for (int a = 0; a < power(n, dim); ++a)
          std::copy_n(u + std::size_t(geometry.functions[a]) * dim,
                      dim,
                      coefficients + a * dim);
        if (windows && windows->reaches(cell))
          {
            window.emplace(tables, *windows, cell);
            read_window(*window, window_u, in_window);
          }
      }

      /// Compute the gradient at a group of points, and return the component r
      /// of the displacement. Sets the positions and domains.
      inline __attribute__((always_inline)) Simd
      evaluate(const double    *group,
               TrialGroup<dim> &result,
               Simd (&H)[dim][dim]) const
      {
        load_basis_positions(points, group, result.x);
        if (window)
          {
            load_domains(points, group, *window, result.domain);
            WindowShape<dim, n> shape;
            Simd                values[dim];
            shape.evaluate(*window, result.x, result.domain);
            shape.template evaluate_field<true>(in_window, values, H);
            return values[0];
          }
        using Shape = GroupGradients<dim, n, dim, dim == 2>;
        Shape shape;
        Simd  pairs[Shape::n_pairs];
        shape.template evaluate<true>(geometry, result.x);
        shape.gradient(coefficients, pairs);
        std::copy_n(pairs, dim * dim, H[0]);
        return dim == 2 ? pairs[Shape::n_pairs - 1] : Simd(0.);
      }

    private:
      const MaterialPoints<dim>            &points;
      const CellGeometry<dim, n>            geometry;
      double                                coefficients[power(n, dim) * dim];
      std::optional<WindowGeometry<dim, n>> window;
      double in_window[WindowShape<dim, n>::n_functions * dim];
    };



    template <int dim, int n>
    __attribute__((noinline)) void
    evaluate_points(const TrialArguments<dim>             &arguments,
                    const SpacePolynomials<dim>           &tables,
                    const CellWindows<dim>                *windows,
                    const double                          *u,
                    const double                          *window_u,
                    TrialPoints<dim>                      &trial,
                    const typename TrialStep<dim>::Action &action)
    {
      const MaterialPoints<dim>       &points   = arguments.points;
      PointTangents<dim>              *tangents = arguments.tangents;
      const std::vector<unsigned int> &cells    = points.cells();
      std::vector<TrialGroup<dim>>     groups;
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int             cell = cells[c];
          const CellDisplacement<dim, n> displacement(
            points, tables, windows, u, window_u, cell);
          double *tangent = tangents
                              ? tangents->add_cell(cell, points.n_points(cell))
                              : nullptr;
          groups.resize((points.n_points(cell) + simd_width - 1) / simd_width);
          unsigned int count = points.n_in_first_group(cell);
          unsigned int g     = points.first_group(cell);
          for (TrialGroup<dim> &group : groups)
            {
              prefetch_next(points, c, g, points.layout().size);
              Simd       H[dim][dim];
              const Simd radial =
                displacement.evaluate(points.group(g), group, H);
              if (tangents)
                {
                  store_numbers<dim>(group.x, 0, tangent);
                  group.tangent = tangent + dim * simd_width;
                  tangent += tangents->group_size();
                }
              trial.evaluate(g, count, H, radial, group);
              g     = points.next_group(g);
              count = simd_width;
            }
          action(cell, groups);
          if (tangents)
            tangents->finish_cell();
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
                           PointTangents<dim>        *tangents,
                           const double              *J_hat,
                           const Action              &action)
  {
    const SplineSpace<dim> &space = *tables.space;
    buffer.resize(n_local_functions(space) * dim);
    for (unsigned int d = 0; d < dim; ++d)
      put_into_buffer(u[d], dim, d, buffer);
    const CellWindows<dim> *used_windows = windows_of(points, windows);
    if (used_windows)
      used_windows->read(u, window_buffer);
    PointReport               report;
    const TrialArguments<dim> arguments{
      points, material, dt, time, strength_reduction, stress, tangents};
    TrialPoints<dim> trial(arguments, J_hat, report);
    with_order(space.degree(), [&](const auto size) {
      evaluate_points<dim, decltype(size)::value>(arguments,
                                                  tables,
                                                  used_windows,
                                                  buffer.data(),
                                                  window_buffer.data(),
                                                  trial,
                                                  action);
    });
    return report;
  }



  GREVILLE_INSTANTIATE_CLASS(TrialStep);
} // namespace greville
