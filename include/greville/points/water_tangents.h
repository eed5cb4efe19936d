// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/spline_polynomials.h>
#include <greville/points/water_terms.h>

#include <vector>

namespace greville
{
  /**
   * The derivatives of the points' contributions to the sums of WaterPoints, in
   * the direction of a displacement u and a pressure q of the grid. Gradients
   * are taken at the end of the trial step. With h = grad u, the relative
   * change of volume e = tr h (in axisymmetry plus u_r / r), the volume V at
   * the end and w = grad p - rho_w g,
   * @f{align*}{
   *   df_a &= - \sum_p V \left((q + e p) \nabla N_a
   *            - p \, h^T \nabla N_a \right), \\
   *   dr_b &= \sum_p \left(V e + V_0 \tfrac{\phi}{K_w} q\right) q_b
   *         + dt \sum_p V \left(\kappa (e w + \nabla q - h^T \nabla p - h w)
   *         + (\kappa_J e + \kappa_p q) w\right) \cdot \nabla q_b,
   * @f}
   * with the derivatives kappa_J and kappa_p of the mobility by the relative
   * change of volume and by the pressure. Points are stored in groups of four,
   * cell by cell, with 15 numbers each in 2D and 22 in 3D. The last number is 1
   * / r in axisymmetry and 0 otherwise.
   */
  template <int dim>
  class WaterTangents
  {
  public:
    /// Set the points from the last trial step of @p terms; the terms of a cell
    /// are consecutive.
    void
    set(const WaterTerms<dim>                              &terms,
        const std::vector<typename WaterTerms<dim>::Point> &points);

    /// Fields and sums for the owned and ghost functions of the spaces, which
    /// have the same order. Cell c of the displacement lies in cell parents[c]
    /// of the pressure.
    struct Fields
    {
      const SpacePolynomials<dim>     &displacements, &pressures;
      const std::vector<unsigned int> &parents;
      const double                    *u; // [function][component]
      const double                    *p; // [function]
      double                          *forces, *rows;
    };

    /// Add df and dr. If the displacement is null, add only df with u = 0.
    void
    add_product(const Fields &fields) const;

  private:
    struct CellPoints
    {
      unsigned int cell;
      unsigned int n_points;
      std::size_t  first; // number
    };

    /// The positions of the numbers of a point.
    enum Number : unsigned int
    {
      x         = 0,
      map       = x + dim,
      volume    = map + dim * dim,
      work      = volume + 1, // times the pressure
      storage   = work + 1,
      flow      = storage + 1, // dt V kappa
      by_J      = flow + 1,
      by_p      = by_J + 1,
      weight    = by_p + 1,     // w
      curvature = weight + dim, // 1 / r
      n_numbers
    };

    template <int n, bool with_hoop>
    void
    multiply(const Fields &fields) const;

    bool                    is_axisymmetric = false;
    dealii::Tensor<1, dim>  weight_of_water;
    std::vector<CellPoints> cells;
    std::vector<double>     numbers; // [cell][group][number][lane]
  };
} // namespace greville
