// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>

#include "domains.h"
#include "group_gradients.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Evaluate the functions of a window at a group of points.
    template <int dim, int n>
    __attribute__((noinline)) void
    evaluate_window(const MaterialPoints<dim>    &points,
                    const double                 *group,
                    const WindowGeometry<dim, n> &geometry,
                    WindowShape<dim, n>          &shape)
    {
      Simd x[dim], s[dim];
      load_basis_positions(points, group, x);
      load_domains(points, group, geometry, s);
      shape.evaluate(geometry, x, s);
    }



    /// The functions of a cell at a group of points, with values for the hoop
    /// strain in 2D.
    template <int dim, int n>
    using CellShape = GroupGradients<dim, n, dim, dim == 2>;



    /// Compute y += K x on this process, for values stored function by
    /// function. product(group, shape, u, sums) adds the contribution of a
    /// group of points to K x for the values u of its cell. Cells that reach
    /// their neighbours by the windows @p without are skipped.
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
              CellShape<dim, n> shape;
              shape.template evaluate<derivatives>(geometry, x);
              product(group, shape, u, sums);
            }
          for (int k = 0; k < n_values; ++k)
            target[std::size_t(geometry.functions[k / dim]) * dim + k % dim] +=
              reduce(sums[k]);
        }
    }



    /// Compute y += K x for the cells that reach their neighbours, whose points
    /// use windows.
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
                const double       *group = points.group(g);
                WindowShape<dim, n> shape;
                evaluate_window(points, group, geometry, shape);
                product(group, shape, u, sums);
              }
            for (int k = 0; k < n_values; ++k)
              target[std::size_t(geometry.functions[k / dim]) * dim +
                     k % dim] += reduce(sums[k]);
          }
    }



    /// The stress of a Stiffness for displacement gradients, times the volume.
    template <int dim>
    class StiffnessStress
    {
    public:
      StiffnessStress(const PointLayout<dim> &layout,
                      const Stiffness        &stiffness)
        : layout(layout)
        , stiffness(stiffness)
      {
        const double wave_modulus = stiffness.lambda + 2. * stiffness.shear;
        inverse_modulus =
          wave_modulus > 0. ? stiffness.elastic_factor / wave_modulus : 0.;
      }

      /// Compute the stress for the gradient @p H, which is transformed to
      /// current positions. Axisymmetric points also have the strain u_r / r:
      /// on entry, @p hoop is u_r; on return, it is the factor of the values of
      /// functions in the force of the hoop stress.
      inline __attribute__((always_inline)) void
      evaluate(const double *group,
               Simd (&H)[dim][dim],
               Simd &hoop,
               Simd (&stress)[dim][dim]) const
      {
        Simd lambda, shear, radius = 1., inverse[dim][dim];
        load_moduli(group, lambda, shear);
        if (layout.is_axisymmetric())
          {
            radius = load(group + PointLayout<dim>::position * simd_width);
            hoop   = hoop / radius;
          }
        if (layout.is_total_lagrangian())
          {
            Simd reference[dim][dim];
            std::copy_n(H[0], dim * dim, reference[0]);
            load_inverse_F<dim>(group, layout.initial_F, inverse);
            multiply<dim>(reference, inverse, H);
          }
        multiply_gradient(lambda, shear, radius, H, hoop, stress);
        if (layout.is_total_lagrangian())
          {
            Simd sigma[dim][dim];
            std::copy_n(stress[0], dim * dim, sigma[0]);
            multiply_transposed<dim>(sigma, inverse, stress);
          }
      }

    private:
      /// Load Lame's parameters, times the volume.
      inline __attribute__((always_inline)) void
      load_moduli(const double *group, Simd &lambda, Simd &shear) const
      {
        using Layout      = PointLayout<dim>;
        const Simd volume = load(group + Layout::volume0 * simd_width) *
                            load(group + Layout::J * simd_width);
        const Simd scale =
          load(group + Layout::wave_modulus * simd_width) * inverse_modulus;
        lambda = volume * (scale * stiffness.lambda + stiffness.viscous_lambda);
        shear  = volume * (scale * stiffness.shear + stiffness.viscous_shear);
      }

      /// Compute the stress, and the force of the strain @p hoop on values.
      inline __attribute__((always_inline)) void
      multiply_gradient(const Simd lambda,
                        const Simd shear,
                        const Simd radius,
                        const Simd (&H)[dim][dim],
                        Simd &hoop,
                        Simd (&stress)[dim][dim]) const
      {
        Simd trace = H[0][0];
        for (int i = 1; i < dim; ++i)
          trace += H[i][i];
        if (layout.is_axisymmetric())
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
      }

      const PointLayout<dim> &layout;
      const Stiffness        &stiffness;
      double                  inverse_modulus;
    };



    /// The product of a stiffness with the values of a cell at a group.
    template <int dim, int n>
    class StiffnessProduct
    {
    public:
      StiffnessProduct(const PointLayout<dim> &layout,
                       const Stiffness        &stiffness)
        : layout(layout)
        , stress_of(layout, stiffness)
      {}

      inline __attribute__((always_inline)) void
      operator()(const double            *group,
                 const CellShape<dim, n> &shape,
                 const double            *u,
                 Simd                    *sums) const
      {
        Simd pairs[CellShape<dim, n>::n_pairs], H[dim][dim], stress[dim][dim];
        shape.gradient(u, pairs);
        std::copy_n(pairs, dim * dim, H[0]);
        Simd hoop = dim == 2 ? pairs[CellShape<dim, n>::n_pairs - 1] : Simd(0.);
        stress_of.evaluate(group, H, hoop, stress);
        std::copy_n(stress[0], dim * dim, pairs);
        if constexpr (dim == 2)
          pairs[dim * dim] = layout.is_axisymmetric() ? hoop : Simd(0.);
        shape.add_divergence(pairs, sums);
      }

      void
      operator()(const double              *group,
                 const WindowShape<dim, n> &shape,
                 const double              *u,
                 Simd                      *sums) const
      {
        Simd H[dim][dim], stress[dim][dim], values[dim];
        shape.template evaluate_field<true>(u, values, H);
        Simd hoop[dim] = {values[0]};
        stress_of.evaluate(group, H, hoop[0], stress);
        shape.add_divergence(stress, sums);
        if (layout.is_axisymmetric())
          shape.add_values(hoop, sums);
      }

    private:
      const PointLayout<dim>    &layout;
      const StiffnessStress<dim> stress_of;
    };



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
      const StiffnessProduct<dim, n> product(points.layout(), stiffness);
      multiply_cells<dim, n, true>(
        points, tables, source, target, product, windows);
      multiply_windows<dim, n>(
        points, tables, windows, window_source, window_target, product);
    }



    /// Collective. Compute y = K x or y += K x. multiply(size, x, y) is the
    /// product on this process, for values stored function by function.
    template <int dim, typename Multiply>
    void
    multiply_fields(const SplineSpace<dim> &space,
                    AlignedVector<double>  &source,
                    const VectorField<dim> &x,
                    VectorField<dim>       &y,
                    const bool              overwrite,
                    const Multiply         &multiply)
    {
      const std::size_t   n_functions = n_local_functions(space);
      std::vector<double> target(n_functions * dim);
      source.resize_fast(n_functions * dim);
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
      numbers,
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
                         numbers,
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



  namespace
  {
    /// Add m N c with the numbers c at @p first to the functions of a cell.
    template <int dim, int n>
    void
    add_momentum_of_cell(const MaterialPoints<dim>  &points,
                         const CellGeometry<dim, n> &geometry,
                         const unsigned int          cell,
                         const std::array<int, dim> &first,
                         double                     *target)
    {
      for (unsigned int g = points.first_group(cell);
           g != MaterialPoints<dim>::none;
           g = points.next_group(g))
        {
          const double *group = points.group(g);
          const Simd mass = load(group + PointLayout<dim>::mass * simd_width);
          Simd       x[dim], momentum[dim];
          load_basis_positions(points, group, x);
          for (unsigned int d = 0; d < dim; ++d)
            momentum[d] = mass * load(group + first[d] * simd_width);
          ShapeValues<dim, n> shape;
          shape.template evaluate<false>(geometry, x);
          for (int k = 0; k < power(n, dim); ++k)
            {
              Simd N = shape.N[0][k % n] * shape.N[1][k / n % n];
              if constexpr (dim == 3)
                N *= shape.N[2][k / (n * n)];
              for (unsigned int d = 0; d < dim; ++d)
                target[std::size_t(geometry.functions[k]) * dim + d] +=
                  reduce(N * momentum[d]);
            }
        }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::affine_momentum(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const unsigned int                              column,
    const std::vector<bool>                        &is_used,
    VectorField<dim>                               &y)
  {
    Require(!windows, "APIC and Taylor do not support domains.");
    resize_numbers(dim);
    std::fill(numbers.begin(), numbers.end(), 0.);
    for (const MaterialPoints<dim> *points : bodies)
      {
        const PointField *affine = points->layout().find("affine");
        if (!affine)
          continue;
        std::array<int, dim> first;
        for (unsigned int d = 0; d < dim; ++d)
          first[d] = affine->first + d * dim + column;
        with_order(tables.space->degree(), [&](const auto size) {
          constexpr int n = decltype(size)::value;
          for (const unsigned int cell : points->cells())
            if (is_used[cell])
              add_momentum_of_cell<dim, n>(*points,
                                           CellGeometry<dim, n>(tables, cell),
                                           cell,
                                           first,
                                           numbers.data());
        });
      }
    for (unsigned int d = 0; d < dim; ++d)
      write_number(d, y[d]);
    numbers.clear();
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



  GREVILLE_INSTANTIATE_CLASS(PointTransfer);
} // namespace greville
