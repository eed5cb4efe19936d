// SPDX-License-Identifier: LGPL-2.1-or-later

#include "domains.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * y += K x on this process, where values lie function by function and
     * product(group, shape, u, sums) adds what a group of points has of K x for
     * the values u of its cell. Cells that reach their neighbours by the
     * windows
     * @p without are left out.
     */
    template <int dim, int n, bool derivatives, typename Product>
    void
    multiply_cells(const MaterialPoints<dim>   &points,
                   const SpacePolynomials<dim> &tables,
                   const double                *source,
                   double                      *target,
                   const Product               &product,
                   const CellWindows<dim>      *without = nullptr)
    {
      constexpr int n_values = power(n, dim) * dim;
      constexpr int n_read =
        derivatives ? PointLayout<dim>::F : PointLayout<dim>::volume0;
      const std::vector<unsigned int> &cells = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int cell = cells[c];
          if (without && without->reaches(cell))
            continue;
          const CellGeometry<dim, n> geometry(tables, cell);
          double                     u[n_values];
          Simd                       sums[n_values];
          for (int k = 0; k < n_values; ++k)
            {
              u[k]    = source[std::size_t(geometry.functions[k / dim]) * dim +
                            k % dim];
              sums[k] = 0.;
            }
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              prefetch_next(points, c, g, n_read);
              const double *group = points.group(g);
              Simd          x[dim];
              load_basis_positions(points, group, x);
              ShapeValues<dim, n> shape;
              shape.template evaluate<derivatives>(geometry, x);
              product(group, shape, u, sums);
            }
          for (int k = 0; k < n_values; ++k)
            target[std::size_t(geometry.functions[k / dim]) * dim + k % dim] +=
              reduce(sums[k]);
        }
    }



    /**
     * The same for the cells that reach their neighbours, whose points see
     * windows.
     */
    template <int dim, int n, typename Product>
    void
    multiply_windows(const MaterialPoints<dim>   &points,
                     const SpacePolynomials<dim> &tables,
                     const CellWindows<dim>      *windows,
                     const double                *source,
                     double                      *target,
                     const Product               &product)
    {
      constexpr int n_values = WindowShape<dim, n>::n_functions * dim;
      for (const unsigned int cell : points.cells())
        if (windows && windows->reaches(cell))
          {
            const WindowGeometry<dim, n> geometry(tables, *windows, cell);
            double                       u[n_values];
            Simd                         sums[n_values];
            read_window(geometry, source, u);
            std::fill_n(sums, n_values, Simd(0.));
            for (unsigned int g = points.first_group(cell);
                 g != MaterialPoints<dim>::none;
                 g = points.next_group(g))
              {
                const double *group = points.group(g);
                Simd          x[dim], s[dim];
                load_basis_positions(points, group, x);
                load_domains(points, group, s);
                WindowShape<dim, n> shape;
                shape.evaluate(geometry, x, s);
                product(group, shape, u, sums);
              }
            for (int k = 0; k < n_values; ++k)
              target[std::size_t(geometry.functions[k / dim]) * dim +
                     k % dim] += reduce(sums[k]);
          }
    }



    template <int dim, int n>
    void
    multiply_stiffness(const MaterialPoints<dim>   &points,
                       const SpacePolynomials<dim> &tables,
                       const Stiffness             &stiffness,
                       const CellWindows<dim>      *windows,
                       const double                *source,
                       double                      *target,
                       const double                *window_source,
                       double                      *window_target)
    {
      using Layout             = PointLayout<dim>;
      constexpr int      n_z   = dim == 3 ? n : 1;
      const bool         total = points.layout().is_total_lagrangian();
      const bool         is_axisymmetric = points.layout().is_axisymmetric();
      const unsigned int initial_F       = points.layout().initial_F;
      const double       wave_modulus = stiffness.lambda + 2. * stiffness.shear;
      const double       inverse =
        wave_modulus > 0. ? stiffness.elastic_factor / wave_modulus : 0.;
      // The stress, times the volume, of a gradient, and of the radial value
      // the force on values.
      const auto stress_of = [&](const double *group,
                                 Simd(&H)[dim][dim],
                                 Simd &hoop,
                                 Simd(&stress)[dim][dim]) {
        const Simd volume = load(group + Layout::volume0 * simd_width) *
                            load(group + Layout::J * simd_width);
        const Simd scale =
          load(group + Layout::wave_modulus * simd_width) * inverse;
        const Simd lambda =
          volume * (scale * stiffness.lambda + stiffness.viscous_lambda);
        const Simd shear =
          volume * (scale * stiffness.shear + stiffness.viscous_shear);

        // An axisymmetric point has the further strain u_r / r, whose stress
        // acts on values.
        Simd radius = 1.;
        if (is_axisymmetric)
          {
            radius = load(group + Layout::position * simd_width);
            hoop   = hoop / radius;
          }
        Simd inverse[dim][dim];
        if (total)
          {
            Simd reference[dim][dim];
            std::copy_n(H[0], dim * dim, reference[0]);
            load_inverse_F<dim>(group, initial_F, inverse);
            multiply<dim>(reference, inverse, H);
          }
        Simd trace = H[0][0];
        for (int i = 1; i < dim; ++i)
          trace += H[i][i];
        if (is_axisymmetric)
          {
            trace += hoop;
            hoop = (2. * shear * hoop + lambda * trace) / radius;
          }
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            {
              stress[i][j] = shear * (H[i][j] + H[j][i]);
              if (i == j)
                stress[i][j] += lambda * trace;
            }
        if (total)
          {
            Simd sigma[dim][dim];
            std::copy_n(stress[0], dim * dim, sigma[0]);
            multiply_transposed<dim>(sigma, inverse, stress);
          }
      };
      const auto product = [&](const double              *group,
                               const ShapeValues<dim, n> &shape,
                               const double              *u,
                               Simd                      *sums) {
        // A row of functions along x has the factors of y and z, and
        // their derivatives, in common.
        const auto for_each_row = [&](const auto &action) {
          int first = 0;
          for (int a_z = 0; a_z < n_z; ++a_z)
            for (int a_y = 0; a_y < n; ++a_y, first += n * dim)
              {
                Simd factors[dim];
                factors[0] = shape.N[1][a_y];
                factors[1] = shape.dN[1][a_y];
                if constexpr (dim == 3)
                  {
                    factors[2] = factors[0] * shape.dN[2][a_z];
                    factors[0] *= shape.N[2][a_z];
                    factors[1] *= shape.N[2][a_z];
                  }
                action(first, factors);
              }
        };

        Simd H[dim][dim], hoop = 0.; // u_r, and then the force on values
        for (auto &row : H)
          for (Simd &entry : row)
            entry = 0.;
        for_each_row([&](const int first, const Simd *factors) {
          Simd values[dim], slopes[dim];
          for (int i = 0; i < dim; ++i)
            {
              values[i] = shape.N[0][0] * u[first + i];
              slopes[i] = shape.dN[0][0] * u[first + i];
            }
          for (int a = 1; a < n; ++a)
            for (int i = 0; i < dim; ++i)
              {
                values[i] += shape.N[0][a] * u[first + a * dim + i];
                slopes[i] += shape.dN[0][a] * u[first + a * dim + i];
              }
          for (int i = 0; i < dim; ++i)
            {
              H[i][0] += factors[0] * slopes[i];
              for (int j = 1; j < dim; ++j)
                H[i][j] += factors[j] * values[i];
            }
          if (is_axisymmetric)
            hoop += factors[0] * values[0];
        });
        Simd stress[dim][dim];
        stress_of(group, H, hoop, stress);
        for_each_row([&](const int first, const Simd *factors) {
          for (int i = 0; i < dim; ++i)
            {
              const Simd along  = factors[0] * stress[i][0];
              Simd       across = factors[1] * stress[i][1];
              if constexpr (dim == 3)
                across += factors[2] * stress[i][2];
              if (is_axisymmetric && i == 0)
                across += factors[0] * hoop;
              for (int a = 0; a < n; ++a)
                sums[first + a * dim + i] +=
                  shape.dN[0][a] * along + shape.N[0][a] * across;
            }
        });
      };
      multiply_cells<dim, n, true>(
        points, tables, source, target, product, windows);

      multiply_windows<dim, n>(points,
                               tables,
                               windows,
                               window_source,
                               window_target,
                               [&](const double              *group,
                                   const WindowShape<dim, n> &shape,
                                   const double              *u,
                                   Simd                      *sums) {
                                 Simd H[dim][dim], stress[dim][dim];
                                 Simd values[dim];
                                 shape.template evaluate_field<true>(u,
                                                                     values,
                                                                     H);
                                 Simd hoop[dim] = {values[0]};
                                 stress_of(group, H, hoop[0], stress);
                                 shape.add_divergence(stress, sums);
                                 if (is_axisymmetric)
                                   shape.add_values(hoop, sums);
                               });
    }



    /**
     * Collective. y = K x or y += K x, where multiply(size, x, y) is the
     * product on this process, of values that lie function by function.
     */
    template <int dim, typename Multiply>
    void
    multiply_fields(const SplineSpace<dim> &space,
                    std::vector<double>    &source,
                    const VectorField<dim> &x,
                    VectorField<dim>       &y,
                    const bool              overwrite,
                    const Multiply         &multiply)
    {
      const std::size_t n_functions =
        space.owned_functions().size() + space.ghost_functions().size();
      std::vector<double> target(n_functions * dim);
      source.resize(n_functions * dim);
      for (unsigned int d = 0; d < dim; ++d)
        put_into_buffer(x[d], dim, d, source);
      with_order(space.degree(), [&](const auto size) {
        multiply(size, source.data(), target.data());
      });
      for (unsigned int d = 0; d < dim; ++d)
        if (overwrite)
          take_from_buffer(target, dim, d, y[d]);
        else
          {
            VectorType sum;
            sum.reinit(y[d], true);
            take_from_buffer(target, dim, d, sum);
            y[d] += sum;
          }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::add_stiffness(const MaterialPoints<dim> &points,
                                    const Stiffness           &stiffness,
                                    const VectorField<dim>    &u,
                                    VectorField<dim>          &k,
                                    const bool                 overwrite)
  {
    const CellWindows<dim> *used_windows  = windows_of(points, windows);
    std::vector<double>     window_target = read_windows(used_windows, u);
    multiply_fields<dim>(
      *tables.space,
      buffer,
      u,
      k,
      overwrite,
      [&](const auto size, const double *source, double *target) {
        multiply_stiffness<dim, decltype(size)::value>(points,
                                                       tables,
                                                       stiffness,
                                                       used_windows,
                                                       source,
                                                       target,
                                                       window_buffer.data(),
                                                       window_target.data());
      });
    if (used_windows)
      used_windows->add_to(k, window_target);
  }



  namespace
  {
    template <int dim, int n>
    void
    multiply_mass_matrix(const MaterialPoints<dim>   &points,
                         const SpacePolynomials<dim> &tables,
                         const CellWindows<dim>      *windows,
                         const double                *source,
                         double                      *target,
                         const double                *window_source,
                         double                      *window_target)
    {
      constexpr int n_rows  = power(n, dim - 1);
      const auto    product = [&](const double              *group,
                               const ShapeValues<dim, n> &shape,
                               const double              *u,
                               Simd                      *sums) {
        Simd       momentum[dim], factors[n_rows];
        const Simd mass = load(group + PointLayout<dim>::mass * simd_width);
        for (int row = 0; row < n_rows; ++row)
          {
            factors[row] = shape.N[1][row % n];
            if constexpr (dim == 3)
              factors[row] *= shape.N[2][row / n];
          }
        for (int i = 0; i < dim; ++i)
          {
            momentum[i] = 0.;
            for (int row = 0; row < n_rows; ++row)
              {
                Simd value = shape.N[0][0] * u[row * n * dim + i];
                for (int a = 1; a < n; ++a)
                  value += shape.N[0][a] * u[(row * n + a) * dim + i];
                momentum[i] += factors[row] * value;
              }
            momentum[i] *= mass;
            for (int row = 0; row < n_rows; ++row)
              {
                const Simd share = factors[row] * momentum[i];
                for (int a = 0; a < n; ++a)
                  sums[(row * n + a) * dim + i] += shape.N[0][a] * share;
              }
          }
      };
      multiply_cells<dim, n, false>(
        points, tables, source, target, product, windows);
      multiply_windows<dim, n>(
        points,
        tables,
        windows,
        window_source,
        window_target,
        [&](const double              *group,
            const WindowShape<dim, n> &shape,
            const double              *u,
            Simd                      *sums) {
          Simd       values[dim], none[dim][dim];
          const Simd mass = load(group + PointLayout<dim>::mass * simd_width);
          shape.template evaluate_field<false>(u, values, none);
          for (Simd &value : values)
            value *= mass;
          shape.add_values(values, sums);
        });
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::multiply_mass(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const VectorField<dim>                         &x,
    VectorField<dim>                               &y)
  {
    const CellWindows<dim> *used_windows =
      windows && windows->averages_values() ? windows : nullptr;
    std::vector<double> window_target = read_windows(used_windows, x);
    multiply_fields<dim>(*tables.space,
                         buffer,
                         x,
                         y,
                         true,
                         [&](const auto    size,
                             const double *source,
                             double       *target) {
                           for (const MaterialPoints<dim> *points : bodies)
                             multiply_mass_matrix<dim, decltype(size)::value>(
                               *points,
                               tables,
                               windows_of(*points, used_windows),
                               source,
                               target,
                               window_buffer.data(),
                               window_target.data());
                         });
    if (used_windows)
      used_windows->add_to(y, window_target);
  }



  template <int dim>
  std::vector<double>
  PointTransfer<dim>::read_windows(const CellWindows<dim> *used_windows,
                                   const VectorField<dim> &field)
  {
    if (!used_windows)
      return {};
    used_windows->read(field, window_buffer);
    return std::vector<double>(window_buffer.size());
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville
