// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/material.h>
#include <greville/points/point_ref.h>

namespace greville
{
  /// Multiply the determinant of a deformation gradient by @p ratio; in plane
  /// strain, the thickness does not change.
  template <int dim>
  inline void
  scale_volume(dealii::Tensor<2, 3>   &F,
               const double            ratio,
               const PointLayout<dim> &layout)
  {
    const bool   is_plane = dim == 2 && !layout.is_axisymmetric();
    const double factor   = is_plane ? std::sqrt(ratio) : std::cbrt(ratio);
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        F[i][j] *= factor;
    if (dim == 2 && !is_plane)
      F[2][2] *= factor;
  }



  /// Return the reference radius of the increment of F_zz of an axisymmetric
  /// point: a step that moves the point to the radius r has the increment r
  /// over this radius.
  template <int dim>
  inline double
  radius_of_F(const ConstPointRef<dim> p, const PointLayout<dim> &layout)
  {
    return p[layout.radius0] * p.F(2, 2);
  }



  /// Fill @p point, a new MaterialPoint with the increment 1, from the numbers
  /// of a point. A projected J replaces J, and F is scaled to it.
  template <int dim>
  inline void
  load_material_point(const ConstPointRef<dim> p,
                      const PointLayout<dim>  &layout,
                      MaterialPoint           &point)
  {
    for (unsigned int d = 0; d < 3; ++d)
      point.increment[d][d] = 1.;
    point.F      = p.F();
    point.J      = p.J();
    point.stress = p.stress();
    if (layout.projected_J != 0)
      {
        point.J = p[layout.projected_J];
        scale_volume<dim>(point.F, point.J / p.J(), layout);
      }
    for (unsigned int d = 0; d < dim; ++d)
      point.position[d] = p.position(d);
    point.dim                      = dim;
    constexpr unsigned int n_first = History<double>::n_first;
    for (unsigned int k = 0; k < layout.n_state && k < n_first; ++k)
      point.state.first[k] = p[layout.state + k];
    point.state.resize(layout.n_state);
    for (unsigned int k = n_first; k < layout.n_state; ++k)
      point.state.more[k - n_first] = p[layout.state + k];
  }



  /// Store the results of Material::update().
  template <int dim>
  inline void
  store_material_point(const MaterialPoint    &point,
                       const PointRef<dim>     p,
                       const PointLayout<dim> &layout)
  {
    p.set_stress(point.stress);
    p.wave_modulus()               = point.wave_modulus;
    constexpr unsigned int n_first = History<double>::n_first;
    for (unsigned int k = 0; k < layout.n_state && k < n_first; ++k)
      p[layout.state + k] = point.state.first[k];
    for (unsigned int k = n_first; k < layout.n_state; ++k)
      p[layout.state + k] = point.state.more[k - n_first];
  }
} // namespace greville
