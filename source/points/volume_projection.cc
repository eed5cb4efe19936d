// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/point_material.h>
#include <greville/points/volume_projection.h>

#include "gradients.h"
#include <algorithm>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// The factors of Richardson iterations with the lumped mass, for n
    /// functions per direction. The eigenvalues lie between 0 and 1. The
    /// iterations multiply an error by the product of (1 - factor_k
    /// eigenvalue). Factors of one reduce smooth errors, the others all other
    /// errors. The product is below one for all eigenvalues, so that the
    /// operator is positive.
    template <int n>
    constexpr std::array<double, 7> relaxation_factors = {
      {1., 1., 1., 1., 1.5, 3., 6.}};
    template <>
    constexpr std::array<double, 4> relaxation_factors<2> = {{1., 1., 1.6, 4.}};
    template <>
    constexpr std::array<double, 1> relaxation_factors<1> = {{1.}};



    /// Return the volume of a point in the reference configuration of the
    /// projection over its stress-free volume.
    template <int dim>
    double
    initial_J(const ConstPointRef<dim> p, const PointLayout<dim> &layout)
    {
      if (layout.initial_F == 0)
        return 1.;
      const double hoop =
        layout.is_axisymmetric() ? p.reference(0) / p.position(0) : 1.;
      return p.J() * determinant(inverse_F<dim>(p, layout)) * hoop;
    }
  } // namespace



  template <int dim>
  void
  VolumeProjection<dim>::reinit(const SplineSpace<dim>        &space,
                                DistributedTriangulation<dim> &triangulation,
                                const bool                     coarse)
  {
    tables.reinit(space);
    coarsening                 = coarse ? 2 : 1;
    q                          = space.degree() - (coarse ? 0 : 1);
    const unsigned int n_cells = space.owned_cells().size();
    functions.clear();
    if (coarse)
      number_coarse_functions();
    else if (q == 0)
      {
        // Each cell has one function, which vanishes elsewhere.
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          functions.push_back(cell);
        weight.reinit(std::make_shared<const Utilities::MPI::Partitioner>(
          n_cells, 0, space.communicator()));
      }
    else
      {
        const SplineSpace<dim> lower(triangulation, q);
        for (unsigned int d = 0; d < dim; ++d)
          polynomials[d].reinit(lower.knots(d));
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          for (const unsigned int function : lower.cell_functions(cell))
            functions.push_back(function);
        lower.initialize_vector(weight);
      }
    weighted.reinit(weight);
  }



  template <int dim>
  void
  VolumeProjection<dim>::number_coarse_functions()
  {
    const SplineSpace<dim> &space = *tables.space;
    MultiIndex<dim>         extents;
    std::uint64_t           n_functions = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int n     = space.cells_per_direction()[d];
        const unsigned int n_all = (n + 1) / 2;
        // If the number of cells is odd, the last cell is extended to two.
        edges[d].clear();
        for (unsigned int k = 0; k <= n; k += 2)
          edges[d].push_back(space.edge(d, k));
        if (n % 2 == 1)
          edges[d].push_back(edges[d].back() + 2. * space.cell_size(d, n - 1));
        const bool wraps = space.is_periodic(d);
        Require(!wraps || (n % 2 == 0 && n_all > q),
                "'Scheme/Volumetric projection' = coarse mesh joins two cells "
                "in each direction: the number of 'Grid/Cells' in a periodic "
                "direction has to be even, and " +
                  std::to_string(2 * q + 2) + " at least; it is " +
                  std::to_string(n) + ".");
        extents[d] = wraps ? n_all : n_all + q;
        n_functions *= extents[d];
        polynomials[d].reinit(wraps
                                ? KnotVector::periodic_uniform(
                                    q, n_all, edges[d].front(), edges[d].back())
                                : KnotVector::open(q, edges[d]));
      }

    // Cells of the coarse mesh may have children on several processes.
    // Processes own equal ranges of the lexicographic numbers, so all know the
    // owners.
    MultiIndex<dim> local;
    local.fill(q + 1);
    const unsigned int n_local = Utilities::fixed_power<dim>(q + 1);
    std::vector<types::global_dof_index> numbers;
    numbers.reserve(space.owned_cells().size() * n_local);
    for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
      {
        const MultiIndex<dim> cell = space.box(c).index;
        for (unsigned int a = 0; a < n_local; ++a)
          {
            MultiIndex<dim> function = multi_index<dim>(a, local);
            for (unsigned int d = 0; d < dim; ++d)
              function[d] = (function[d] + cell[d] / 2) % extents[d];
            numbers.push_back(lexicographic<dim>(function, extents));
          }
      }
    const MPI_Comm     comm        = space.communicator();
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    const unsigned int me          = Utilities::MPI::this_mpi_process(comm);
    IndexSet           owned(n_functions), relevant(n_functions);
    owned.add_range(n_functions * me / n_processes,
                    n_functions * (me + 1) / n_processes);
    std::vector<types::global_dof_index> sorted = numbers;
    std::sort(sorted.begin(), sorted.end());
    relevant.add_indices(sorted.begin(), sorted.end());
    const auto partition =
      std::make_shared<const Utilities::MPI::Partitioner>(owned,
                                                          relevant,
                                                          comm);
    for (const types::global_dof_index number : numbers)
      functions.push_back(partition->global_to_local(number));
    weight.reinit(partition);
  }



  template <int dim>
  const std::vector<double> &
  VolumeProjection<dim>::project(const MaterialPoints<dim> &points,
                                 const VectorField<dim>    &w,
                                 const double               dt,
                                 const VectorField<dim>    *direction,
                                 const bool                 moves)
  {
    AssertThrow(points.layout().projected_J != 0, ExcInternalError());
    const SplineSpace<dim> &space    = *tables.space;
    const unsigned int      n_fields = direction ? 2 : 1;
    buffer.resize(n_local_functions(space) * dim * n_fields);
    for (unsigned int d = 0; d < dim; ++d)
      {
        put_into_buffer(w[d], dim * n_fields, d, buffer);
        if (direction)
          put_into_buffer((*direction)[d], dim * n_fields, dim + d, buffer);
      }
    with_order(space.degree(), [&](const auto size) {
      constexpr int n = decltype(size)::value;
      find_J<n>(points, dt, direction != nullptr, moves);
      if (coarsening == 2)
        project_J<n>(points);
      else
        project_J<n - 1>(points);
    });
    return J;
  }



  template <int dim>
  const std::vector<double> &
  VolumeProjection<dim>::differentiate(const MaterialPoints<dim> &points,
                                       const VectorField<dim>    &u,
                                       const VectorField<dim>    &du,
                                       const std::vector<double> &J_hat,
                                       const double               share)
  {
    project(points, u, 1., &du);
    for (std::size_t k = 0; k < J.size(); ++k)
      J[k] = J[k] / J_hat[k] - share * rates[k];
    return J;
  }



  template <int dim>
  template <int n>
  void
  VolumeProjection<dim>::find_J(const MaterialPoints<dim> &points,
                                const double               dt,
                                const bool                 with_direction,
                                const bool                 moves)
  {
    constexpr int           n_functions = power(n, dim);
    const std::size_t       stride      = with_direction ? 2 * dim : dim;
    const PointLayout<dim> &layout      = points.layout();
    J.clear();
    J.reserve(points.n_points());
    rates.clear();
    for (const unsigned int cell : points.cells())
      {
        const CellGeometry<dim, n> geometry(tables, cell);
        double coefficients[dim][n_functions], changes[dim][n_functions];
        for (int a = 0; a < n_functions; ++a)
          for (int i = 0; i < dim; ++i)
            {
              const double *w    = &buffer[geometry.functions[a] * stride + i];
              coefficients[i][a] = w[0];
              if (with_direction)
                changes[i][a] = w[dim];
            }
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          const auto shape = evaluated(geometry, p.basis_position(layout));
          const Gradients<dim, n> gradients(shape);
          const Tensor<2, dim>    f =
            increment_of_point<dim, n>(p, layout, gradients, coefficients, dt);
          J.push_back(p.J() * determinant(f));
          double radius = 0.; // of axisymmetric points
          if (layout.is_axisymmetric())
            {
              radius = p.position(0);
              if (moves)
                radius += dt * value_of_component(shape, coefficients[0]);
              J.back() *= radius / radius_of_F<dim>(p, layout);
            }
          if (!with_direction)
            return;
          // The trace of df f^-1; 1 + df is the increment of the direction.
          const Tensor<2, dim> inverse = invert(f);
          rates.push_back(scalar_product(increment_of_point<dim, n>(
                                           p, layout, gradients, changes, 1.),
                                         transpose(inverse)) -
                          trace(inverse));
          if (layout.is_axisymmetric())
            rates.back() += value_of_component(shape, changes[0]) / radius;
          J.back() *= rates.back();
        });
      }
  }



  template <int dim>
  template <int n>
  void
  VolumeProjection<dim>::project_J(const MaterialPoints<dim> &points)
  {
    const SplineSpace<dim> &space   = *tables.space;
    const PointLayout<dim> &layout  = points.layout();
    constexpr double        one     = 1.;
    constexpr int           n_local = power(n, dim);
    const unsigned int      n_functions =
      weight.locally_owned_size() + weight.get_partitioner()->n_ghost_indices();
    // Call action(functions, N, number of the point, point).
    const auto for_each = [&](const auto &action) {
      std::size_t                 k = 0;
      CellGeometry<dim, n>        geometry;
      ShapeValues<dim, n, double> shape;
      double                      N[n_local];
      for (const unsigned int cell : points.cells())
        {
          const CellBox<dim> box = space.box(cell);
          for (unsigned int d = 0; d < dim; ++d)
            {
              const unsigned int i = box.index[d] / coarsening;
              const double lower = coarsening == 1 ? box.lower[d] : edges[d][i],
                           h     = coarsening == 1 ? box.size[d]
                                                   : edges[d][i + 1] - lower;
              geometry.center[d] = lower + 0.5 * h;
              geometry.inverse_h[d] = 1. / h;
              geometry.polynomials[d] =
                n == 1 ? &one : polynomials[d].coefficients(i);
            }
          const unsigned int *f =
            functions.data() + std::size_t(cell) * n_local;
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            const Point<dim> x = p.basis_position(layout);
            shape.template evaluate<false>(geometry, x.begin_raw());
            shape.multiply(N);
            action(f, N, k++, p);
          });
        }
    };

    // The volumes V in the initial configuration, and J relative to it.
    std::vector<double> volumes(J.size()), projected(J.size(), 0.);
    sums.assign(2 * n_functions, 0.);
    for_each([&](const unsigned int      *f,
                 const double            *N,
                 const std::size_t        k,
                 const ConstPointRef<dim> p) {
      const double J_0 = initial_J<dim>(p, layout);
      volumes[k]       = p.volume0() * J_0;
      J[k] /= J_0;
      for (int a = 0; a < n_local; ++a)
        {
          sums[2 * f[a]] += N[a] * volumes[k];
          sums[2 * f[a] + 1] += N[a] * volumes[k] * J[k];
        }
    });
    take_from_buffer(sums, 2, 0, weight);
    take_from_buffer(sums, 2, 1, weighted);
    const auto &factors = relaxation_factors<n>;
    for (unsigned int pass = 0; pass < factors.size(); ++pass)
      {
        for (unsigned int i = 0; i < weight.locally_owned_size(); ++i)
          if (weight.local_element(i) > 0.)
            weighted.local_element(i) *=
              factors[pass] / weight.local_element(i);
        buffer.resize(n_functions);
        put_into_buffer(weighted, 1, 0, buffer);
        sums.assign(n_functions, 0.);
        for_each([&](const unsigned int *f,
                     const double       *N,
                     const std::size_t   k,
                     const ConstPointRef<dim>) {
          for (int a = 0; a < n_local; ++a)
            projected[k] += N[a] * buffer[f[a]];
          const double rest = volumes[k] * (J[k] - projected[k]);
          for (int a = 0; a < n_local; ++a)
            sums[f[a]] += N[a] * rest;
        });
        if (pass + 1 < factors.size())
          take_from_buffer(sums, 1, 0, weighted);
      }
    for_each([&](const unsigned int *,
                 const double *,
                 const std::size_t        k,
                 const ConstPointRef<dim> p) {
      J[k] = projected[k] * initial_J<dim>(p, layout);
    });
  }



  GREVILLE_INSTANTIATE_CLASS(VolumeProjection);
} // namespace greville
