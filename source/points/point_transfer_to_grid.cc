// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include "window_functions.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * The sums over the points of a cell and of all its functions, n_fields
     * numbers per function, of which each lane has its part.
     */
    template <int n_functions, int n_fields>
    struct CellSums
    {
      void
      clear()
      {
        for (Simd &sum : sums)
          sum = 0.;
      }

      void
      add_to(const unsigned int *functions, double *buffer) const
      {
        double totals[n_vectors];
        for (int k = 0; k < n_vectors; k += simd_width)
          store(reduce_four(sums + k), totals + k);
        for (int a = 0; a < n_functions; ++a)
          for (int k = 0; k < n_fields; ++k)
            buffer[std::size_t(functions[a]) * n_fields + k] +=
              totals[a * n_fields + k];
      }

      static constexpr int n_vectors =
        (n_functions * n_fields + simd_width - 1) / simd_width * simd_width;
      Simd sums[n_vectors];
    };



    /**
     * The fields that points add to functions: mass and momentum, or force, or
     * both. With APIC, the momentum varies over the functions of a point.
     */
    template <int dim, bool momentum_, bool force_, bool apic_>
    struct AddedFields
    {
      static constexpr bool momentum = momentum_;
      static constexpr bool force    = force_;
      static constexpr bool apic     = apic_;

      static constexpr int first_force = momentum ? 1 + dim : 0;
      static constexpr int n_fields    = first_force + (force ? dim : 0);
    };



    /// The numbers of a group of points that are added to functions.
    template <int dim>
    struct PointValues
    {
      /// Positions for the basis functions.
      Simd x[dim];
      Simd mass, velocity[dim];
      /// The factors of N and grad N in the force.
      Simd load[dim], stress[dim][dim];
    };



    /// Return the first number of a field of points, 0 if there is none.
    template <int dim>
    __attribute__((noinline)) unsigned int
    first_of_field(const PointLayout<dim> &layout, const char *name)
    {
      const PointField *field = layout.find(name);
      return field ? field->first : 0;
    }



    /// Compute - V sigma, or - V0 P = - V sigma F^-T.
    template <int dim>
    inline __attribute__((always_inline)) void
    load_stress(const PointLayout<dim> &layout,
                const double           *group,
                const Simd              volume,
                Simd (&stress)[dim][dim])
    {
      using Layout = PointLayout<dim>;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          stress[i][j] =
            -volume *
            load(group +
                 (Layout::stress + Layout::stress_index(i, j)) * simd_width);
      if (layout.is_total_lagrangian())
        {
          Simd sigma[dim][dim], inverse[dim][dim];
          std::copy_n(stress[0], dim * dim, sigma[0]);
          load_inverse_F<dim>(group, layout.initial_F, inverse);
          multiply_transposed<dim>(sigma, inverse, stress);
        }
    }



    /**
     * Compute the force of loads, and of the stress sigma_zz of axisymmetric
     * points: - V sigma_zz / r, in any configuration of N.
     */
    template <int dim>
    inline __attribute__((always_inline)) void
    load_force(const PointLayout<dim> &layout,
               const unsigned int      first_load,
               const double           *group,
               const Simd              mass,
               const Simd              volume,
               Simd (&force)[dim])
    {
      using Layout = PointLayout<dim>;
      for (int i = 0; i < dim; ++i)
        force[i] = first_load != 0
                     ? mass * load(group + (first_load + i) * simd_width)
                     : Simd(0.);
      if (layout.is_axisymmetric())
        force[0] -= volume *
                    load(group + (Layout::stress + Layout::stress_index(2, 2)) *
                                   simd_width) /
                    load(group + Layout::position * simd_width);
    }



    /// Load the numbers of a group.
    template <int dim, typename Fields>
    inline __attribute__((always_inline)) void
    load_values(const MaterialPoints<dim> &points,
                const unsigned int         first_load,
                const double              *group,
                PointValues<dim>          &values)
    {
      using Layout = PointLayout<dim>;
      load_basis_positions(points, group, values.x);
      values.mass = load(group + Layout::mass * simd_width);
      if constexpr (Fields::momentum)
        load_numbers<dim>(group, Layout::velocity, values.velocity);
      if constexpr (Fields::force)
        {
          const Simd volume = load(group + Layout::volume0 * simd_width) *
                              load(group + Layout::J * simd_width);
          load_stress<dim>(points.layout(), group, volume, values.stress);
          load_force<dim>(points.layout(),
                          first_load,
                          group,
                          values.mass,
                          volume,
                          values.load);
        }
    }



    /// Prefetch the functions of cell number @p c of points.cells(), if any.
    template <int dim, int n>
    __attribute__((noinline)) void
    prefetch_cell(const MaterialPoints<dim>   &points,
                  const SpacePolynomials<dim> &tables,
                  const std::size_t            c,
                  const double                *buffer,
                  const unsigned int           n_fields)
    {
      if (c < points.cells().size())
        prefetch_functions<power(n, dim)>(
          tables.space->cell_functions(points.cells()[c]).data(),
          buffer,
          n_fields);
    }



    /// Sums of groups of points, with functions at the points.
    template <int dim, int n, typename Fields>
    class PointScatter
    {
    public:
      PointScatter(const MaterialPoints<dim>   &points,
                   const SpacePolynomials<dim> &tables,
                   const CellWindows<dim> *,
                   double *buffer)
        : points(points)
        , tables(tables)
        , buffer(buffer)
        , first_load(first_of_field(points.layout(), "load"))
        , first_affine(Fields::apic ? first_of_field(points.layout(), "affine")
                                    : 0)
      {}

      /// Begin cell number @p c of points.cells().
      inline __attribute__((always_inline)) void
      begin(const CellGeometry<dim, n> &, const std::size_t c)
      {
        prefetch_cell<dim, n>(points, tables, c + 1, buffer, Fields::n_fields);
        cell_sums.clear();
      }

      inline __attribute__((always_inline)) void
      add(const CellGeometry<dim, n> &geometry,
          const double               *group,
          const unsigned int)
      {
        PointValues<dim> values;
        load_values<dim, Fields>(points, first_load, group, values);
        ShapeValues<dim, n> shape;
        shape.template evaluate<Fields::force>(geometry, values.x);
        AffineVelocity affine;
        if constexpr (Fields::apic)
          affine.load(geometry, group, first_affine, values.x);
        Simd *sums = cell_sums.sums;
        for (int a_z = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y, sums += n * Fields::n_fields)
            add_row(values, shape, affine, a_y, a_z, sums);
      }

      /// End a cell.
      void
      end(const CellGeometry<dim, n> &geometry) const
      {
        cell_sums.add_to(geometry.functions, buffer);
      }

    private:
      /// The matrix C of APIC, and the distances of the Greville points.
      struct AffineVelocity
      {
        inline __attribute__((always_inline)) void
        load(const CellGeometry<dim, n> &geometry,
             const double               *group,
             const unsigned int          first_affine,
             const Simd (&x)[dim])
        {
          for (int i = 0; i < dim; ++i)
            {
              load_numbers<dim>(group, first_affine + i * dim, C[i]);
              for (int a = 0; a < n; ++a)
                distance[i][a] =
                  geometry.center[i] + geometry.offsets[i][a] - x[i];
            }
        }

        Simd C[dim][dim], distance[dim][n];
      };

      /// The factors that all functions of a row along x share.
      struct Row
      {
        Simd N, dy, dz; // products of N_y and N_z, and derivatives
        Simd mass, momentum[dim], slope[dim];
        Simd along[dim], across[dim]; // forces
      };

      /// Compute the products of N_y, N_z and their derivatives.
      static inline __attribute__((always_inline)) void
      set_factors(const ShapeValues<dim, n> &shape,
                  const int                  a_y,
                  const int                  a_z,
                  Row                       &row)
      {
        row.N  = shape.N[1][a_y];
        row.dy = row.dz = 0.;
        if constexpr (Fields::force)
          row.dy = shape.dN[1][a_y];
        if constexpr (dim == 3)
          {
            if constexpr (Fields::force)
              {
                row.dy *= shape.N[dim - 1][a_z];
                row.dz = row.N * shape.dN[dim - 1][a_z];
              }
            row.N *= shape.N[dim - 1][a_z];
          }
      }

      static inline __attribute__((always_inline)) void
      set_momentum(const PointValues<dim> &values,
                   const AffineVelocity   &affine,
                   const int               a_y,
                   const int               a_z,
                   Row                    &row)
      {
        row.mass = values.mass * row.N;
        for (int i = 0; i < dim; ++i)
          {
            row.momentum[i] = values.velocity[i];
            if constexpr (Fields::apic)
              {
                row.momentum[i] += affine.C[i][1] * affine.distance[1][a_y];
                if constexpr (dim == 3)
                  row.momentum[i] +=
                    affine.C[i][dim - 1] * affine.distance[dim - 1][a_z];
                row.slope[i] = row.mass * affine.C[i][0];
              }
            row.momentum[i] *= row.mass;
          }
      }

      static inline __attribute__((always_inline)) void
      set_force(const PointValues<dim> &values, Row &row)
      {
        for (int i = 0; i < dim; ++i)
          {
            row.along[i] = row.N * values.stress[i][0];
            row.across[i] =
              row.dy * values.stress[i][1] + row.N * values.load[i];
            if constexpr (dim == 3)
              row.across[i] += row.dz * values.stress[i][dim - 1];
          }
      }

      /// Add to the sums of the functions of a row along x.
      static inline __attribute__((always_inline)) void
      add_row(const PointValues<dim>    &values,
              const ShapeValues<dim, n> &shape,
              const AffineVelocity      &affine,
              const int                  a_y,
              const int                  a_z,
              Simd                      *sums)
      {
        Row row;
        set_factors(shape, a_y, a_z, row);
        if constexpr (Fields::momentum)
          set_momentum(values, affine, a_y, a_z, row);
        if constexpr (Fields::force)
          set_force(values, row);
        for (int a = 0; a < n; ++a, sums += Fields::n_fields)
          {
            const Simd N = shape.N[0][a];
            if constexpr (Fields::momentum)
              {
                sums[0] += N * row.mass;
                for (int i = 0; i < dim; ++i)
                  if constexpr (Fields::apic)
                    sums[1 + i] += N * (row.momentum[i] +
                                        row.slope[i] * affine.distance[0][a]);
                  else
                    sums[1 + i] += N * row.momentum[i];
              }
            if constexpr (Fields::force)
              for (int i = 0; i < dim; ++i)
                sums[Fields::first_force + i] +=
                  shape.dN[0][a] * row.along[i] + N * row.across[i];
          }
      }

      const MaterialPoints<dim>                &points;
      const SpacePolynomials<dim>              &tables;
      double                                   *buffer;
      const unsigned int                        first_load;
      const unsigned int                        first_affine;
      CellSums<power(n, dim), Fields::n_fields> cell_sums;
    };



    /// The vectors of a function: mass and momentum, and force.
    template <typename Fields>
    using KindOfSums = Sums<int(Fields::momentum) + int(Fields::force),
                            Fields::force ? int(Fields::momentum) : -1>;



    /// Load the numbers of a group in the order of scatter().
    template <int dim, typename Fields>
    inline __attribute__((always_inline)) void
    load_sums(const MaterialPoints<dim> &points,
              const unsigned int         first_load,
              const double              *group,
              PointValues<dim>          &values,
              Simd                      *sums)
    {
      using Kind                = KindOfSums<Fields>;
      constexpr int first_force = Fields::momentum ? simd_width : 0;
      load_values<dim, Fields>(points, first_load, group, values);
      std::fill_n(sums, Kind::n_all(dim) * simd_width, Simd(0.));
      if constexpr (Fields::momentum)
        {
          sums[0] = values.mass;
          for (int i = 0; i < dim; ++i)
            sums[1 + i] = values.mass * values.velocity[i];
        }
      if constexpr (Fields::force)
        for (int i = 0; i < dim; ++i)
          {
            sums[first_force + i] = values.load[i];
            for (int j = 0; j < dim; ++j)
              sums[Kind::n_numbers + j * simd_width + i] = values.stress[i][j];
          }
    }



    /// Sums of groups of points, with functions averaged over their domains.
    template <int dim, int n, typename Fields>
    class DomainScatter
    {
    public:
      DomainScatter(const MaterialPoints<dim>   &points,
                    const SpacePolynomials<dim> &tables,
                    const CellWindows<dim>      *windows,
                    double                      *buffer)
        : points(points)
        , buffer(buffer)
        , first_load(first_of_field(points.layout(), "load"))
        , functions(points, tables, windows, Fields::force)
      {}

      void
      begin(const CellGeometry<dim, n> &geometry, const std::size_t c)
      {
        functions.begin(geometry, points.cells()[c]);
      }

      void
      add(const CellGeometry<dim, n> &,
          const double      *group,
          const unsigned int count)
      {
        using Kind = KindOfSums<Fields>;
        PointValues<dim> values;
        Simd             sums[Kind::n_all(dim) * simd_width];
        load_sums<dim, Fields>(points, first_load, group, values, sums);
        functions.template scatter<Kind>(group, count, values.x, sums, buffer);
      }

      void
      end(const CellGeometry<dim, n> &) const
      {}

    private:
      const MaterialPoints<dim> &points;
      double                    *buffer;
      const unsigned int         first_load;
      WindowFunctions<dim, n>    functions;
    };



    /// Add the points of a body to the fields of the functions in a buffer.
    template <int dim,
              int n,
              typename Fields,
              template <int, int, typename>
              class Scatter>
    __attribute__((noinline)) void
    add_points(const MaterialPoints<dim>   &points,
               const SpacePolynomials<dim> &tables,
               const CellWindows<dim>      *windows,
               double                      *buffer)
    {
      // A local object: the compiler knows that its sums overlap nothing else.
      Scatter<dim, n, Fields> scatter(points, tables, windows, buffer);
      using Layout         = PointLayout<dim>;
      const Layout &layout = points.layout();
      // Numbers that lie in front of those that no pass needs.
      const unsigned int n_read =
        layout.is_total_lagrangian()
          ? layout.size
          : (Fields::force ? Layout::stress + Layout::n_stress : Layout::J);
      const std::vector<unsigned int> &cells = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const CellGeometry<dim, n> geometry(tables, cells[c]);
          scatter.begin(geometry, c);
          unsigned int count = points.n_in_first_group(cells[c]);
          for (unsigned int g = points.first_group(cells[c]);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g), count = simd_width)
            {
              prefetch_next(points, c, g, n_read);
              scatter.add(geometry, points.group(g), count);
            }
          scatter.end(geometry);
        }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::points_to_grid(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    VectorType                                     *mass,
    VectorField<dim>                               *momentum,
    VectorField<dim>                               *force)
  {
    AssertThrow((mass == nullptr) == (momentum == nullptr),
                ExcMessage("Mass and momentum go together."));
    if (!mass && !force)
      return;
    const unsigned int n_vector = windows ? simd_width : 0;
    const unsigned int first_force =
      !mass ? 0 : std::max<unsigned int>(1 + dim, n_vector);
    resize_numbers(first_force +
                   (!force ? 0 : std::max<unsigned int>(dim, n_vector)));
    std::fill(numbers.begin(), numbers.end(), 0.);

    for (const MaterialPoints<dim> *points : bodies)
      with_order(tables.space->degree(), [&](const auto size) {
        constexpr int n      = decltype(size)::value;
        const bool    affine = points->layout().find("affine");
        AssertThrow(!affine || !windows,
                    ExcMessage("APIC does not support domains."));
        const auto run = [&](auto with_mass, auto with_force, auto apic) {
          using Fields = AddedFields<dim, with_mass, with_force, apic>;
          if constexpr (!Fields::apic)
            if (windows)
              return add_points<dim, n, Fields, DomainScatter>(*points,
                                                               tables,
                                                               windows,
                                                               numbers.data());
          add_points<dim, n, Fields, PointScatter>(*points,
                                                   tables,
                                                   windows,
                                                   numbers.data());
        };
        constexpr std::true_type  yes;
        constexpr std::false_type no;
        if (mass && force)
          affine ? run(yes, yes, yes) : run(yes, yes, no);
        else if (mass)
          affine ? run(yes, no, yes) : run(yes, no, no);
        else
          run(no, yes, no);
      });

    if (mass)
      {
        write_number(0, *mass);
        for (unsigned int d = 0; d < dim; ++d)
          write_number(1 + d, (*momentum)[d]);
      }
    if (force)
      for (unsigned int d = 0; d < dim; ++d)
        write_number(first_force + d, (*force)[d]);
  }



  namespace
  {
    /**
     * The Lagrange polynomials of the n Gauss points of the unit interval as
     * polynomials of t = x - 1/2, in the layout of SplinePolynomials.
     */
    template <int n>
    std::array<double, n * n>
    lagrange_polynomials()
    {
      const QGauss<1>           nodes(n);
      std::array<double, n * n> c{};
      for (int a = 0; a < n; ++a)
        {
          // Multiply out the linear factors.
          c[a * n]      = 1.;
          double scale  = 1.;
          int    degree = 0;
          for (int b = 0; b < n; ++b)
            if (b != a)
              {
                const double root = nodes.point(b)(0) - 0.5;
                scale /= nodes.point(a)(0) - nodes.point(b)(0);
                ++degree;
                for (int k = degree; k >= 0; --k)
                  c[a * n + k] = (k > 0 ? c[a * n + k - 1] : 0.) -
                                 root * (k < degree ? c[a * n + k] : 0.);
              }
          for (int k = 0; k < n; ++k)
            c[a * n + k] *= scale;
        }
      return c;
    }



    template <int dim, int n>
    void
    add_moments(const MaterialPoints<dim>   &points,
                const SpacePolynomials<dim> &tables,
                DensityWeights<dim>         &weights)
    {
      const auto                       lagrange = lagrange_polynomials<n>();
      constexpr int                    n_z      = dim == 3 ? n : 1;
      const std::vector<unsigned int> &cells    = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int   cell = cells[c];
          CellGeometry<dim, n> geometry(tables, cell);
          for (unsigned int d = 0; d < dim; ++d)
            geometry.polynomials[d] = lagrange.data();
          CellSums<power(n, dim), 1> cell_sums;
          cell_sums.clear();
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              prefetch_next(points, c, g, PointLayout<dim>::volume0);
              const double *group = points.group(g);
              Simd          x[dim];
              load_basis_positions(points, group, x);
              const Simd m = load(group + PointLayout<dim>::mass * simd_width);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              Simd *sums = cell_sums.sums;
              for (int a_z = 0; a_z < n_z; ++a_z)
                for (int a_y = 0; a_y < n; ++a_y)
                  {
                    Simd m_yz = m * shape.N[1][a_y];
                    if constexpr (dim == 3)
                      m_yz *= shape.N[dim - 1][a_z];
                    for (int a = 0; a < n; ++a, ++sums)
                      *sums += m_yz * shape.N[0][a];
                  }
            }
          double            *target = weights.at_cell(cell);
          const unsigned int width  = CellBatches<dim>::width();
          for (int q = 0; q < power(n, dim); ++q)
            target[q * width] += reduce(cell_sums.sums[q]);
        }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::mass_weights(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    DensityWeights<dim>                            &weights) const
  {
    weights.clear();
    for (const MaterialPoints<dim> *points : bodies)
      with_order(weights.n_points_1d() / 2, [&](const auto size) {
        constexpr int n = 2 * decltype(size)::value;
        if (weights.n_points_1d() % 2 == 1)
          add_moments<dim, n - 1>(*points, tables, weights);
        else
          add_moments<dim, n - 2>(*points, tables, weights);
      });
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville
