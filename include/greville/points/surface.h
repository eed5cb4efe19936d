// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/fitted_points.h>
#include <greville/points/body.h>

#include <string>
#include <vector>

namespace greville
{
  /// The distance up to which surfaces in contact interact, in units of the
  /// cell size of the coarser grid.
  constexpr double farthest_gap_in_cells = 0.5;



  /// Points on a part of the surface of a body, which move and deform with it
  /// and bear one load. Their mass is their initial area dA0, m^2 (in 2D m, or
  /// m^2 per radian), so that sums over points treat their field "load" as a
  /// force per initial area, Pa. They have no volume, stress or material. F
  /// refers to the initial positions, and the field "normal" contains the
  /// outward normal there.
  template <int dim>
  struct Surface
  {
    std::string         name;
    MaterialPoints<dim> points;
    /// The number of the body.
    unsigned int body = 0;
    /// The contact that sets the load, empty if none. Its points store contact
    /// data: the fields "slip", "new_slip", "gap", "state", with water
    /// "pore_pressure" (see ContactPoint), and "before", x at the start of the
    /// last step. The gap is at most farthest_gap_in_cells, also without a near
    /// surface. If they are material points of the body, they also have a
    /// "radius" (m), "last_radius" at the start of the last step, their area as
    /// mass, and as normal the opposite of the other side's normal.
    std::string contact;
    /// Upper bounds of the derivatives of the load per initial area by
    /// displacement, Pa / m, and by velocity, Pa s / m. They limit explicit
    /// steps.
    double stiffness = 0., damping = 0.;
  };



  /// The state of a surface point at some time, as the argument of its load.
  template <int dim>
  struct SurfaceState
  {
    dealii::Point<dim> X, x;
    /// The normal in the initial configuration.
    dealii::Tensor<1, dim> normal;
    dealii::Tensor<2, dim> F;
    /// m / s
    dealii::Tensor<1, dim> velocity;
    bool                   is_axisymmetric = false;

    /// Return the current normal times the area over the initial one: J F^-T N.
    dealii::Tensor<1, dim>
    area_vector() const
    {
      dealii::Tensor<1, dim> result;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          if constexpr (dim == 2)
            result[i] += (i == j ? 1. : -1.) * F[1 - i][1 - j] * normal[j];
          else
            {
              const int a = (i + 1) % 3, b = (i + 2) % 3;
              const int c = (j + 1) % 3, d = (j + 2) % 3;
              result[i] += (F[a][c] * F[b][d] - F[a][d] * F[b][c]) * normal[j];
            }
      if (is_axisymmetric)
        result *= x[0] / X[0];
      return result;
    }
  };

  template <int dim>
  SurfaceState<dim>
  surface_state(const ConstPointRef<dim> p, const PointLayout<dim> &layout);



  /// Collective. Return the surface of the @p placed points of @p body that lie
  /// in the shape @p where (empty: all). They have the initial displacement and
  /// velocity of the body. @p section names the load or the contact. Throws
  /// dealii::ExcMessage if there are none.
  template <int dim>
  Surface<dim>
  make_surface(const std::string                    &name,
               const std::string                    &section,
               const std::string                    &where,
               const Body<dim>                      &body,
               const std::vector<SurfacePoint<dim>> &placed,
               const SplineSpace<dim>               &space,
               const std::string                    &contact = "");



  /// Return a surface, without points yet, for material points of @p body in a
  /// @p contact.
  template <int dim>
  Surface<dim>
  make_contactors(const std::string      &name,
                  const std::string      &contact,
                  const Body<dim>        &body,
                  const SplineSpace<dim> &space);
} // namespace greville
