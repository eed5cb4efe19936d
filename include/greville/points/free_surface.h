// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/expression.h>
#include <greville/base/vector_field.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/points/material_points.h>
#include <greville/points/spline_polynomials.h>
#include <greville/points/water_terms.h>
#include <greville/spline/cell_neighbors.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Water of a given pressure @f$\bar p@f$ around all bodies. The surface is
   * defined by the points only. It lies in the *layer*: the cells with points
   * that share a face with a cell without points. Walls of the grid are not
   * such faces.
   *
   * The pores of the layer leak into the water outside. To the balance of water
   * of WaterPoints, r, and its force f are added
   * @f{align*}{
   *   r_b &+= dt \sum_{p\ in\ the\ layer} V \frac{c \kappa}{\delta^2}
   *          (p - \bar p) \, q_b, \\
   *   f_a &+= \sum_p V \left(\bar p \, \nabla N_a + N_a \nabla \bar p\right),
   * @f}
   * with V, the conductivity kappa and the gradients at the start of the step.
   * Delta is the thickness of the layer, the filled fraction of a cell times
   * its size. From p at its inner side to the pressure @f$\bar p@f$ at the
   * surface, the layer has the flow @f$\kappa (p - \bar p) / \delta@f$. This
   * requires c = 2 if the pressure is linear in the layer, and c = 1.44 if it
   * is the solution with the leak. As the pressure is a spline, neither holds;
   * c = 1.2 has the smallest mean error. A much stronger leak would fix the
   * pressure in all cells over which the spline is extended to the surface, not
   * only in the layer.
   *
   * The force is the force of @f$\bar p@f$ on the surface, by Gauss's theorem.
   * Together with the force of WaterPoints, it is the force of @f$p - \bar p@f$
   * and the buoyancy @f$-\nabla \bar p@f$. Errors of the sums over points
   * therefore do not move soil in water at rest.
   */
  template <int dim>
  class FreeSurface
  {
  public:
    /// Collective. See WaterPoints::reinit(). The pressure is a formula of x, y
    /// (, z) and t, Pa. Throws dealii::ExcMessage if the formula is invalid.
    FreeSurface(const SplineSpace<dim>          &displacements,
                const SplineSpace<dim>          &pressures,
                const std::vector<unsigned int> &parents,
                const bool                       is_axisymmetric,
                const std::string               &pressure,
                const std::string               &parameter);

    /// Collective. Find the layer from the filled fractions of the owned cells
    /// of the displacement.
    void
    find_layer(const std::vector<double> &filled);

    /// Begin a step of length @p dt (s), which ends at @p time (s), and remove
    /// all points.
    void
    clear(const double dt, const double time);

    /// Add the points of a body. Throws dealii::ExcMessage if the formula has
    /// no value.
    void
    add(const MaterialPoints<dim> &points, const WaterConstants &constants);

    /// Collective. Compute f after all points have been added.
    void
    finish();

    /// Return f.
    const VectorField<dim> &
    force() const
    {
      return outer_force;
    }

    /// Collective. Add the leak at the pressure @p p, Pa, to r.
    void
    add_rows(const VectorType &p, VectorType &rows)
    {
      volume_out = sum(p, rows, true);
    }

    /// Collective. Add the derivative of r in the direction @p dp.
    void
    add_derivative(const VectorType &dp, VectorType &rows) const
    {
      sum(dp, rows, false);
    }

    /// Add the derivative of r by the coefficients of functions of any order on
    /// the cells of the pressure.
    void
    add_schur_complement(const SpacePolynomials<dim> &functions,
                         StencilMatrix<dim>          &matrix) const;

    /// Return the volume of water that left on this process in the last
    /// add_rows(), m^3 (2D: m^2).
    double
    outflow() const
    {
      return volume_out;
    }

    /// Return whether an owned cell belongs to the layer.
    bool
    is_in_layer(const unsigned int cell) const
    {
      return inverse_squares[cell] > 0.;
    }

  private:
    /// A point of the layer.
    struct Term
    {
      unsigned int       cell;
      dealii::Point<dim> x;
      double             leak;    // m^3 / Pa (2D: m^2 / Pa)
      double             outside; // Pa
    };

    /// Add leak * (p - outside), or leak * p, to the rows. Returns the sum.
    double
    sum(const VectorType &p, VectorType &rows, const bool with_outside) const;

    double
    outside(const dealii::Point<dim> &x) const;

    SpacePolynomials<dim>     displacement_tables, pressure_tables;
    std::vector<unsigned int> parents;
    bool                      is_axisymmetric;
    Expression                formula;
    CellNeighbors<dim>        neighbors;
    std::vector<double>       inverse_squares; // of delta; 0 inside

    double                      dt = 0., time = 0., volume_out = 0.;
    std::vector<Term>           terms;
    std::vector<double>         force_buffer;
    VectorField<dim>            outer_force;
    mutable VectorType          part;
    mutable std::vector<double> p_buffer, row_sums;
  };
} // namespace greville
