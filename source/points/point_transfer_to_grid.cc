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
      CellSums()
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
     * The fields of a function are mass and momentum (if with_momentum) and
     * force (if with_force). Where there are windows, the force begins a vector
     * of its own.
     */
    template <int dim, int n, bool with_momentum, bool with_force, bool affine>
    void
    add_points(const MaterialPoints<dim>   &points,
               const SpacePolynomials<dim> &tables,
               const CellWindows<dim>      *windows,
               double                      *buffer)
    {
      using Layout                     = PointLayout<dim>;
      const PointField  *field_of_load = points.layout().find("load");
      const unsigned int first_affine =
        affine ? points.layout().first("affine") : 0;
      constexpr int      first_force = with_momentum ? 1 + dim : 0;
      constexpr int      n_fields    = first_force + (with_force ? dim : 0);
      constexpr int      n_z         = dim == 3 ? n : 1;
      const bool         total       = points.layout().is_total_lagrangian();
      const bool         is_axisymmetric = points.layout().is_axisymmetric();
      const unsigned int initial_F       = points.layout().initial_F;
      using OfWindow = Sums<int(with_momentum) + int(with_force),
                            with_force ? int(with_momentum) : -1>;
      WindowFunctions<dim, n> functions(points, tables, windows, with_force);

      // Numbers that lie in front of those that no pass needs.
      const unsigned int n_read =
        total ? points.layout().size
              : (with_force ? Layout::stress + Layout::n_stress : Layout::J);

      const std::vector<unsigned int> &cells = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int                cell = cells[c];
          const CellGeometry<dim, n>        geometry(tables, cell);
          CellSums<power(n, dim), n_fields> cell_sums;
          unsigned int count = points.n_in_first_group(cell);
          if (!windows && c + 1 < cells.size())
            prefetch_functions<power(n, dim)>(
              tables.space->cell_functions(cells[c + 1]).data(),
              buffer,
              n_fields);
          if (windows)
            functions.begin(geometry, cell);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g), count = simd_width)
            {
              prefetch_next(points, c, g, n_read);
              const double *group = points.group(g);
              Simd          x[dim], v[dim];
              load_basis_positions(points, group, x);
              const Simd m = load(group + Layout::mass * simd_width);
              if constexpr (with_momentum)
                load_numbers<dim>(group, Layout::velocity, v);

              // - V sigma or - V0 P with P = J sigma F^-T, and the force of
              // loads
              Simd stress[dim][dim], load_force[dim];
              if constexpr (with_force)
                {
                  const Simd volume =
                    load(group + Layout::volume0 * simd_width) *
                    load(group + Layout::J * simd_width);
                  for (int i = 0; i < dim; ++i)
                    for (int j = 0; j < dim; ++j)
                      stress[i][j] =
                        -volume * load(group + (Layout::stress +
                                                Layout::stress_index(i, j)) *
                                                 simd_width);
                  if (total)
                    {
                      Simd sigma[dim][dim], inverse[dim][dim];
                      std::copy_n(stress[0], dim * dim, sigma[0]);
                      load_inverse_F<dim>(group, initial_F, inverse);
                      multiply_transposed<dim>(sigma, inverse, stress);
                    }
                  for (int i = 0; i < dim; ++i)
                    load_force[i] =
                      field_of_load
                        ? m * load(group +
                                   (field_of_load->first + i) * simd_width)
                        : Simd(0.);
                  // - V sigma_zz N / r, whatever the configuration of N is.
                  if (is_axisymmetric)
                    load_force[0] -=
                      volume *
                      load(group +
                           (Layout::stress + Layout::stress_index(2, 2)) *
                             simd_width) /
                      load(group + Layout::position * simd_width);
                }

              if (windows)
                {
                  constexpr int force = with_momentum ? simd_width : 0;
                  constexpr int slope = OfWindow::n_numbers;
                  Simd          sums[OfWindow::n_all(dim) * simd_width];
                  std::fill_n(sums,
                              OfWindow::n_all(dim) * simd_width,
                              Simd(0.));
                  if constexpr (with_momentum)
                    {
                      sums[0] = m;
                      for (int i = 0; i < dim; ++i)
                        sums[1 + i] = m * v[i];
                    }
                  if constexpr (with_force)
                    for (int i = 0; i < dim; ++i)
                      {
                        sums[force + i] = load_force[i];
                        for (int j = 0; j < dim; ++j)
                          sums[slope + j * simd_width + i] = stress[i][j];
                      }
                  functions.template scatter<OfWindow>(
                    group, count, x, sums, buffer);
                  continue;
                }

              ShapeValues<dim, n> shape;
              shape.template evaluate<with_force>(geometry, x);
              Simd C[dim][dim], distance[dim][n];
              if constexpr (affine)
                for (int i = 0; i < dim; ++i)
                  {
                    load_numbers<dim>(group, first_affine + i * dim, C[i]);
                    for (int a = 0; a < n; ++a)
                      distance[i][a] =
                        geometry.center[i] + geometry.offsets[i][a] - x[i];
                  }

              Simd *sums = cell_sums.sums;
              for (int a_z = 0; a_z < n_z; ++a_z)
                for (int a_y = 0; a_y < n; ++a_y)
                  {
                    // What a row in x has in common
                    Simd N_yz = shape.N[1][a_y];
                    Simd dy = 0., dz = 0.;
                    if constexpr (with_force)
                      dy = shape.dN[1][a_y];
                    if constexpr (dim == 3)
                      {
                        if constexpr (with_force)
                          {
                            dy *= shape.N[dim - 1][a_z];
                            dz = N_yz * shape.dN[dim - 1][a_z];
                          }
                        N_yz *= shape.N[dim - 1][a_z];
                      }
                    const Simd m_yz = m * N_yz;
                    Simd       momentum[dim], slope[dim];
                    if constexpr (with_momentum)
                      for (int i = 0; i < dim; ++i)
                        {
                          momentum[i] = v[i];
                          if constexpr (affine)
                            {
                              momentum[i] += C[i][1] * distance[1][a_y];
                              if constexpr (dim == 3)
                                momentum[i] +=
                                  C[i][dim - 1] * distance[dim - 1][a_z];
                              slope[i] = m_yz * C[i][0];
                            }
                          momentum[i] *= m_yz;
                        }
                    Simd along_x[dim], across_x[dim];
                    if constexpr (with_force)
                      for (int i = 0; i < dim; ++i)
                        {
                          along_x[i] = N_yz * stress[i][0];
                          across_x[i] =
                            dy * stress[i][1] + N_yz * load_force[i];
                          if constexpr (dim == 3)
                            across_x[i] += dz * stress[i][dim - 1];
                        }
                    for (int a = 0; a < n; ++a, sums += n_fields)
                      {
                        const Simd N = shape.N[0][a];
                        if constexpr (with_momentum)
                          {
                            sums[0] += N * m_yz;
                            for (int i = 0; i < dim; ++i)
                              if constexpr (affine)
                                sums[1 + i] +=
                                  N * (momentum[i] + slope[i] * distance[0][a]);
                              else
                                sums[1 + i] += N * momentum[i];
                          }
                        if constexpr (with_force)
                          for (int i = 0; i < dim; ++i)
                            sums[first_force + i] +=
                              shape.dN[0][a] * along_x[i] + N * across_x[i];
                      }
                  }
            }
          if (!windows)
            cell_sums.add_to(geometry.functions, buffer);
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
          add_points<dim, n, with_mass, with_force, apic>(*points,
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
