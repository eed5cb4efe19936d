// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/volume_projection.h>

#include "cell_columns.h"
#include "group_deformation.h"
#include "window_functions.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Set the diagonals of the second moments of the functions at points.
    template <int dim, int n, typename Pass>
    inline __attribute__((always_inline)) void
    set_inertia(const CellGeometry<dim, n> &geometry,
                const ShapeValues<dim, n>  &shape,
                GridValues<dim, Pass>      &grid)
    {
      for (int j = 0; j < dim; ++j)
        {
          const Simd t    = grid.x[j] - geometry.center[j];
          grid.inertia[j] = 0.;
          for (int a = 0; a < n; ++a)
            {
              const Simd distance = geometry.offsets[j][a] - t;
              grid.inertia[j] += shape.N[j][a] * distance * distance;
            }
        }
    }



    template <int dim, int n, typename Pass>
    __attribute__((noinline)) void
    set_inertia(const CellGeometry<dim, n> &geometry,
                GridValues<dim, Pass>      &grid)
    {
      ShapeValues<dim, n> shape;
      shape.template evaluate<false>(geometry, grid.x);
      set_inertia(geometry, shape, grid);
    }



    /// Fields, and their gradients and moments, at groups of points.
    template <int dim, int n, typename Pass>
    class PointGather
    {
    public:
      PointGather(const MaterialPoints<dim> &points,
                  const SpacePolynomials<dim> &,
                  const CellWindows<dim> *,
                  const double *buffer)
        : points(points)
        , buffer(buffer)
      {}

      /// Begin a cell, see MovingCell::go_to().
      inline __attribute__((always_inline)) void
      begin(const CellGeometry<dim, n> &geometry,
            const unsigned int,
            const bool is_next)
      {
        if (is_next)
          {
            columns.rotate();
            read_column(geometry.functions, n - 1);
          }
        else
          for (int a = 0; a < n; ++a)
            read_column(geometry.functions, a);
      }

      inline __attribute__((always_inline)) void
      evaluate(const CellGeometry<dim, n> &geometry,
               const Group<dim>           &group,
               GridValues<dim, Pass>      &grid) const
      {
        load_basis_positions(points, group.numbers, grid.x);
        ShapeValues<dim, n> shape;
        shape.template evaluate<Pass::gradient>(geometry, grid.x);
        for (int k = 0; k < n_fields; ++k)
          grid.fields[k] = 0.;
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            {
              grid.gradient[i][j] = 0.;
              grid.moments[i][j]  = 0.;
            }
        for (int a_z = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y)
            add_row(geometry, shape, a_y, a_z, grid);
        if constexpr (Pass::apic)
          center_moments(geometry, shape, grid);
      }

    private:
      static constexpr int n_fields = Pass::n_fields * dim;
      static constexpr int n_rows   = power(n, dim - 1);

      inline __attribute__((always_inline)) void
      read_column(const unsigned int *functions, const int a)
      {
        for (int row = 0; row < n_rows; ++row)
          std::copy_n(buffer + std::size_t(functions[row * n + a]) * n_fields,
                      n_fields,
                      columns[a] + row * n_fields);
      }

      /// Add the functions of a row along x.
      inline __attribute__((always_inline)) void
      add_row(const CellGeometry<dim, n> &geometry,
              const ShapeValues<dim, n>  &shape,
              const int                   a_y,
              const int                   a_z,
              GridValues<dim, Pass>      &grid) const
      {
        Simd rows[n_fields], slopes[dim], first_moments[dim];
        for (int k = 0; k < n_fields; ++k)
          rows[k] = 0.;
        for (int i = 0; i < dim; ++i)
          {
            slopes[i]        = 0.;
            first_moments[i] = 0.;
          }
        for (int a = 0; a < n; ++a)
          {
            const double *c = columns[a] + (a_z * n + a_y) * n_fields;
            for (int k = 0; k < n_fields; ++k)
              rows[k] += shape.N[0][a] * c[k];
            if constexpr (Pass::gradient)
              for (int i = 0; i < dim; ++i)
                slopes[i] += shape.dN[0][a] * c[i];
            if constexpr (Pass::apic)
              for (int i = 0; i < dim; ++i)
                first_moments[i] +=
                  shape.N[0][a] * c[i] * geometry.offsets[0][a];
          }
        Simd N_yz = shape.N[1][a_y];
        if constexpr (dim == 3)
          N_yz *= shape.N[dim - 1][a_z];
        for (int k = 0; k < n_fields; ++k)
          grid.fields[k] += N_yz * rows[k];
        if constexpr (Pass::gradient)
          {
            Simd dy = shape.dN[1][a_y], dz = 0.;
            if constexpr (dim == 3)
              {
                dy *= shape.N[dim - 1][a_z];
                dz = shape.N[1][a_y] * shape.dN[dim - 1][a_z];
              }
            for (int i = 0; i < dim; ++i)
              {
                grid.gradient[i][0] += N_yz * slopes[i];
                grid.gradient[i][1] += dy * rows[i];
                if constexpr (dim == 3)
                  grid.gradient[i][dim - 1] += dz * rows[i];
              }
          }
        if constexpr (Pass::apic)
          for (int i = 0; i < dim; ++i)
            {
              grid.moments[i][0] += N_yz * first_moments[i];
              grid.moments[i][1] += N_yz * rows[i] * geometry.offsets[1][a_y];
              if constexpr (dim == 3)
                grid.moments[i][dim - 1] +=
                  N_yz * rows[i] * geometry.offsets[dim - 1][a_z];
            }
      }

      /// Refer moments to the points: x_i - x is the offset of x_i from the
      /// center of the cell minus the offset of x.
      static inline __attribute__((always_inline)) void
      center_moments(const CellGeometry<dim, n> &geometry,
                     const ShapeValues<dim, n>  &shape,
                     GridValues<dim, Pass>      &grid)
      {
        set_inertia(geometry, shape, grid);
        for (int j = 0; j < dim; ++j)
          {
            const Simd t = grid.x[j] - geometry.center[j];
            for (int i = 0; i < dim; ++i)
              grid.moments[i][j] -= t * grid.fields[i];
          }
      }

      const MaterialPoints<dim>                &points;
      const double                             *buffer;
      CellColumns<n, n_rows * n_fields, double> columns;
    };



    /// Means of fields, and of their gradients, over the domains of points.
    template <int dim, int n, typename Pass>
    class DomainGather
    {
    public:
      DomainGather(const MaterialPoints<dim>   &points,
                   const SpacePolynomials<dim> &tables,
                   const CellWindows<dim>      *windows,
                   const double                *buffer)
        : points(points)
        , buffer(buffer)
        , functions(points, tables, windows)
      {}

      void
      begin(const CellGeometry<dim, n> &geometry,
            const unsigned int          cell,
            const bool)
      {
        functions.begin(geometry, cell);
      }

      void
      evaluate(const CellGeometry<dim, n> &,
               const Group<dim>      &group,
               GridValues<dim, Pass> &grid)
      {
        constexpr int stride = field_stride<dim>;
        using Kind =
          Sums<n_field_vectors<dim>(Pass::n_fields), Pass::deform ? 0 : -1>;
        Simd sums[Kind::n_all(dim) * simd_width];
        load_basis_positions(points, group.numbers, grid.x);
        functions.template gather<Kind>(
          group.numbers, group.count, grid.x, buffer, sums);
        for (int k = 0; k < Pass::n_fields * dim; ++k)
          grid.fields[k] = sums[k / dim * stride + k % dim];
        if constexpr (Pass::deform)
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              grid.gradient[i][j] = sums[Kind::n_numbers + j * 4 + i];
      }

    private:
      const MaterialPoints<dim> &points;
      const double              *buffer;
      WindowFunctions<dim, n>    functions;
    };



    template <int dim, int n, typename Pass, typename Gather>
    void
    update_points(MaterialPoints<dim>         &points,
                  const SpacePolynomials<dim> &tables,
                  Gather                     &&gather,
                  const PointUpdate<dim>      &update,
                  const double                *projected,
                  PointReport                 &report)
    {
      const PointLayout<dim> &layout   = points.layout();
      const bool              is_total = layout.is_total_lagrangian();
      const unsigned int      first_affine =
        Pass::apic || update.taylor ? layout.first("affine") : 0;
      // Without deformation, numbers after the mass are not read; without
      // additional fields, numbers after F are not read.
      const unsigned int n_read =
        is_total || layout.size > PointLayout<dim>::n_fixed
          ? layout.size
          : (Pass::deform ? PointLayout<dim>::reference
                          : PointLayout<dim>::volume0);
      PointTotals<dim>      totals;
      MaterialLanes         lanes = make_material_lanes<dim>(layout);
      MovingCell<dim, n>    geometry(tables);
      PrefetchedGroups<dim> ahead(points, n_read);
      for (const unsigned int cell : points.cells())
        {
          const bool is_next = geometry.go_to(cell);
          gather.begin(geometry, cell, is_next);
          totals.is_left     = false;
          unsigned int count = points.n_in_first_group(cell);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g), count = simd_width)
            {
              ahead.advance();
              // Empty lanes do not change.
              Simd is_used;
              for (unsigned int lane = 0; lane < simd_width; ++lane)
                is_used[lane] = lane < count ? 1. : 0.;
              const Group<dim> group{cell,
                                     g,
                                     count,
                                     is_used,
                                     points.group(g),
                                     geometry.center,
                                     geometry.inverse_h};
              if constexpr (Pass::kick)
                if (update.row)
                  update.row->add_group(points, group.numbers, count);
              GridValues<dim, Pass> grid;
              gather.evaluate(geometry, group, grid);
              Simd v[dim];
              if constexpr (Pass::apic)
                kick_affine<dim>(update, group, grid, first_affine, v);
              else if constexpr (Pass::kick)
                {
                  if (update.row && first_affine != 0)
                    set_inertia<dim, n>(geometry, grid);
                  kick<dim>(layout, update, group, grid, first_affine, v);
                }
              else
                load_numbers<dim>(group.numbers, PointLayout<dim>::velocity, v);
              if constexpr (Pass::gradient && !Pass::apic)
                if (first_affine != 0)
                  store_gradient<dim>(group,
                                      grid.gradient,
                                      update.move && !is_total ? update.step
                                                               : 0.,
                                      first_affine);
              if constexpr (Pass::deform)
                {
                  if (Pass::kick || update.move)
                    move<dim>(update, group, grid, is_total, v, totals);
                  deform_and_stress<dim>(points,
                                         update,
                                         group,
                                         grid.gradient,
                                         is_total,
                                         projected,
                                         lanes,
                                         totals,
                                         report);
                }
            }
          if (totals.is_left)
            report.left_cells.push_back(cell);
        }
      totals.write(report);
    }
  } // namespace



  template <int dim>
  PointReport
  PointTransfer<dim>::grid_to_points(MaterialPoints<dim>    &points,
                                     const PointUpdate<dim> &update)
  {
    const bool kick   = update.acceleration != nullptr;
    const bool deform = update.deformation != nullptr;
    const bool same = !update.velocity || update.deformation == update.velocity;
    [[maybe_unused]] const bool is_flip =
      !update.apic && !update.taylor && update.flip == 1.;
    Require(update.velocity || !(update.move || (kick && !is_flip)),
            "Points that move, and kicks of PIC, APIC and Taylor, need a "
            "velocity of the grid.");
    const bool is_affine = update.apic || update.taylor;
    AssertThrow(!is_affine || points.layout().find("affine"),
                ExcInternalError());
    Require(!is_affine || !windows, "APIC and Taylor do not support domains.");
    Require(kick ? (deform ? same && update.move : !update.move) : deform,
            "No pass over points has this combination of updates.");

    // The first field is the one whose gradient deforms points. A kick of FLIP
    // does not use the velocity, but reserves its position in the buffer.
    std::vector<const VectorField<dim> *> fields;
    if (deform)
      fields.push_back(update.deformation);
    if (deform ? !same : kick)
      fields.push_back(update.velocity ? update.velocity : update.acceleration);
    if (kick && !update.apic)
      fields.push_back(update.acceleration);

    const unsigned int stride = windows ? field_stride<dim> : dim;
    resize_numbers(windows ? n_field_vectors<dim>(fields.size()) * simd_width
                           : fields.size() * dim);
    if (windows)
      std::fill(numbers.begin(), numbers.end(), 0.);
    for (unsigned int f = 0; f < fields.size(); ++f)
      for (unsigned int d = 0; d < dim; ++d)
        read_number((*fields[f])[d], f * stride + d);

    const double *projected = deform && update.projection
                                ? update.projection
                                    ->project(points,
                                              *update.deformation,
                                              update.step,
                                              nullptr,
                                              update.move)
                                    .data()
                                : nullptr;
    PointReport   report;
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int n   = decltype(size)::value;
      const auto    run = [&](const auto pass) {
        using Kind      = std::decay_t<decltype(pass)>;
        const auto with = [&](auto &&gather) {
          update_points<dim, n, Kind>(
            points, tables, gather, update, projected, report);
        };
        if constexpr (!Kind::apic && Kind::gradient == Kind::deform)
          if (windows)
            return with(DomainGather<dim, n, Kind>(
              points, tables, windows, numbers.data()));
        with(
          PointGather<dim, n, Kind>(points, tables, windows, numbers.data()));
      };
      if (kick && deform)
        update.apic ? run(Pass<true, true, false, true>())
                    : run(Pass<true, true, true, false>());
      else if (kick)
        {
          if (update.apic)
            run(Pass<true, false, false, true>());
          else if (update.taylor)
            run(Pass<true, false, true, false, true>());
          else
            run(Pass<true, false, true, false>());
        }
      else
        same ? run(Pass<false, true, false, false>())
             : run(Pass<false, true, true, false>());
    });
    numbers.clear();
    return report;
  }



  GREVILLE_INSTANTIATE_CLASS(PointTransfer);
} // namespace greville
