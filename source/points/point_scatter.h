// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "cell_columns.h"

/// The sums of PointTransfer::points_to_grid() over groups of points, with
/// functions at the points. To be included in sources.
namespace greville
{
  namespace internal
  {
    /// The fields that points add to functions: mass and momentum, or force, or
    /// both. With APIC, the momentum varies over the functions of a point.
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
      /// Positions at which the basis functions are evaluated.
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



    /// Compute the force of loads, and of the stress sigma_zz of axisymmetric
    /// points, - V sigma_zz / r, which holds in any configuration of N.
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



    /// Sums of groups of points, with functions at the points.
    template <int dim, int n, typename Fields>
    class PointScatter
    {
    public:
      PointScatter(const MaterialPoints<dim> &points,
                   const SpacePolynomials<dim> &,
                   const CellWindows<dim> *,
                   double *buffer)
        : points(points)
        , first_load(first_of_field(points.layout(), "load"))
        , first_affine(Fields::apic ? first_of_field(points.layout(), "affine")
                                    : 0)
        , sums(buffer)
      {}

      /// Begin a cell, see MovingCell::go_to().
      inline __attribute__((always_inline)) void
      begin(const CellGeometry<dim, n> &geometry,
            const unsigned int,
            const bool is_next)
      {
        sums.begin(geometry.functions, is_next);
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
        for (int a_z = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y)
            add_row(values, shape, affine, a_y, a_z);
      }

      /// End the last cell.
      void
      end()
      {
        sums.end();
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
      inline __attribute__((always_inline)) void
      add_row(const PointValues<dim>    &values,
              const ShapeValues<dim, n> &shape,
              const AffineVelocity      &affine,
              const int                  a_y,
              const int                  a_z)
      {
        Row row;
        set_factors(shape, a_y, a_z, row);
        if constexpr (Fields::momentum)
          set_momentum(values, affine, a_y, a_z, row);
        if constexpr (Fields::force)
          set_force(values, row);
        for (int a = 0; a < n; ++a)
          {
            Simd      *sum = sums(a, a_z * n + a_y);
            const Simd N   = shape.N[0][a];
            if constexpr (Fields::momentum)
              {
                sum[0] += N * row.mass;
                for (int i = 0; i < dim; ++i)
                  if constexpr (Fields::apic)
                    sum[1 + i] += N * (row.momentum[i] +
                                       row.slope[i] * affine.distance[0][a]);
                  else
                    sum[1 + i] += N * row.momentum[i];
              }
            if constexpr (Fields::force)
              for (int i = 0; i < dim; ++i)
                {
                  Simd &force = sum[Fields::first_force + i];
                  // Two fused operations. A sum of both products would take
                  // three.
                  force =
                    (force + shape.dN[0][a] * row.along[i]) + N * row.across[i];
                }
          }
      }

      const MaterialPoints<dim>           &points;
      const unsigned int                   first_load;
      const unsigned int                   first_affine;
      ColumnSums<dim, n, Fields::n_fields> sums;
    };
  } // namespace internal
} // namespace greville
