// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>

#include "point_scatter.h"
#include "window_functions.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// The vectors that each function has: mass and momentum, and force.
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
      begin(const CellGeometry<dim, n> &geometry,
            const unsigned int          cell,
            const bool)
      {
        functions.begin(geometry, cell);
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
      end() const
      {}

    private:
      const MaterialPoints<dim> &points;
      double                    *buffer;
      const unsigned int         first_load;
      WindowFunctions<dim, n>    functions;
    };



    /// Add the points of a body to the fields of the functions in a buffer, and
    /// to @p filled_parts of cells unless null.
    template <int dim,
              int n,
              typename Fields,
              template <int, int, typename>
              class Scatter>
    __attribute__((noinline)) void
    add_points(const MaterialPoints<dim>   &points,
               const SpacePolynomials<dim> &tables,
               const CellWindows<dim>      *windows,
               double                      *buffer,
               double                      *filled_parts)
    {
      // A local object tells the compiler that its sums alias no other memory.
      Scatter<dim, n, Fields> scatter(points, tables, windows, buffer);
      using Layout         = PointLayout<dim>;
      const Layout &layout = points.layout();
      // The number of doubles at the start of a point that the passes read.
      const unsigned int n_read =
        layout.is_total_lagrangian()
          ? layout.size
          : (Fields::force ? Layout::stress + Layout::n_stress : Layout::J);
      MovingCell<dim, n>    geometry(tables);
      PrefetchedGroups<dim> ahead(points, n_read);
      for (const unsigned int cell : points.cells())
        {
          const bool is_next = geometry.go_to(cell);
          scatter.begin(geometry, cell, is_next);
          unsigned int count  = points.n_in_first_group(cell);
          Simd         volume = 0.;
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g), count = simd_width)
            {
              ahead.advance();
              scatter.add(geometry, points.group(g), count);
              if (filled_parts)
                volume += filling_volume(layout, points.group(g));
            }
          if (filled_parts)
            filled_parts[cell] +=
              reduce(volume) / cell_volume<dim>(*tables.space, cell, layout);
        }
      scatter.end();
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::points_to_grid(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    VectorType                                     *mass,
    VectorField<dim>                               *momentum,
    VectorField<dim>                               *force,
    std::vector<double>                            *filled_parts,
    const bool                                      with_affine)
  {
    Require((mass == nullptr) == (momentum == nullptr),
            "Mass and momentum go together.");
    if (!mass && !force)
      return;
    const unsigned int n_vector = windows ? simd_width : 0;
    const unsigned int first_force =
      !mass ? 0 : std::max<unsigned int>(1 + dim, n_vector);
    resize_numbers(first_force +
                   (!force ? 0 : std::max<unsigned int>(dim, n_vector)));
    std::fill(numbers.begin(), numbers.end(), 0.);
    if (filled_parts)
      filled_parts->assign(tables.space->owned_cells().size(), 0.);

    for (const MaterialPoints<dim> *points : bodies)
      with_order(tables.space->degree(), [&](const auto size) {
        constexpr int n      = decltype(size)::value;
        const bool    affine = with_affine && points->layout().find("affine");
        Require(!affine || !windows, "APIC and Taylor do not support domains.");
        double *const parts = filled_parts ? filled_parts->data() : nullptr;
        const auto    run   = [&](auto with_mass, auto with_force, auto apic) {
          using Fields = AddedFields<dim, with_mass, with_force, apic>;
          if constexpr (!Fields::apic)
            if (windows)
              return add_points<dim, n, Fields, DomainScatter>(
                *points, tables, windows, numbers.data(), parts);
          add_points<dim, n, Fields, PointScatter>(
            *points, tables, windows, numbers.data(), parts);
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
    numbers.clear();
  }



  namespace
  {
    /// The Lagrange polynomials of the n Gauss points of the unit interval as
    /// polynomials of t = x - 1/2, in the layout of SplinePolynomials.
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
      const auto            lagrange = lagrange_polynomials<n>();
      constexpr int         n_z      = dim == 3 ? n : 1;
      constexpr int         size     = (power(n, dim) + 3) / 4 * 4;
      PrefetchedGroups<dim> ahead(points, PointLayout<dim>::volume0);
      for (const unsigned int cell : points.cells())
        {
          CellGeometry<dim, n> geometry(tables, cell);
          for (unsigned int d = 0; d < dim; ++d)
            geometry.polynomials[d] = lagrange.data();
          Simd cell_sums[size];
          std::fill_n(cell_sums, size, Simd(0.));
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              ahead.advance();
              const double *group = points.group(g);
              Simd          x[dim];
              load_basis_positions(points, group, x);
              const Simd m = load(group + PointLayout<dim>::mass * simd_width);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              Simd *sums = cell_sums;
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
          double totals[size];
          for (int q = 0; q < size; q += simd_width)
            store(reduce_four(cell_sums + q), totals + q);
          double            *target = weights.at_cell(cell);
          const unsigned int width  = CellBatches<dim>::width();
          for (int q = 0; q < power(n, dim); ++q)
            target[q * width] += totals[q];
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



  GREVILLE_INSTANTIATE_CLASS(PointTransfer);
} // namespace greville
