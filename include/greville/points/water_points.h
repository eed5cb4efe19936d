// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_water_points_h
#define greville_points_water_points_h

#include <greville/base/vector_field.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/points/material_points.h>
#include <greville/points/spline_polynomials.h>
#include <greville/points/water_tangents.h>

#include <array>
#include <vector>

namespace greville
{
  /**
   * The terms of pore water in a step of length dt of implicit steps (u-p form,
   * @ref Zienkiewicz1980 "Zienkiewicz, Chang and Bettess, 1980"), as sums over
   * points. With a displacement u of the grid, functions N_a, and a pressure p
   * with functions q_b,
   * @f{align*}{
   *   f_a &= - \sum_p V p \, \nabla N_a, \\
   *   r_b &= \sum_p V_0 \left((J - J_n) + \tfrac{\phi}{K_w} (p - p_n)\right)
   *          q_b + dt \sum_p V \kappa \, w \cdot \nabla q_b \\
   *       &+ dt \int_\Gamma \kappa \left(- q_b \, w \cdot n
   *          - (p - \bar p) \, \nabla q_b \cdot n
   *          + \tfrac{\beta}{h} (p - \bar p) \, q_b \right) dA, \qquad
   *   w = \nabla p - \rho_w g,
   * @f}
   * where all gradients, V = J V_0 and areas are those at the end of the step.
   * The last line is Nitsche's method for the pressure of drained boundaries.
   * The flow outwards is \f$\kappa (\beta / h \, (p - \bar p) - w \cdot n)\f$
   * there. A seepage face has the positive part of it, times q_b, in place of
   * the line (@ref Chouly2015 "Chouly, Hild and Renard, 2015", theta = 0),
   * which is not less stable: its points change between drained and impervious
   * ones within Newton's method. Where a flow is given, that stands there. The
   * change of volume is summed at the points of the displacement, and the
   * storage is that per V_0.
   *
   * BDF2 has the same form, as a step of length (1 + s) / (1 + 2 s) dt whose r
   * is less s^2 / (1 + 2 s) of what has come to each point in the step before
   * (@ref Hairer1993 "Hairer, Norsett and Wanner, 1993", section III.5), where
   * s is the ratio of the lengths of both steps.
   *
   * The p_n is that which points keep, sampled at their places: where points
   * stay in the space of the pressure, as in total Lagrangian steps, this is
   * the same as its coefficients.
   *
   * Axisymmetric points have volumes and areas per radian. Their J has the
   * factor r / r_n, and forces have the part @f$- V p N_a / r@f$ along r.
   */
  template <int dim>
  class WaterPoints
  {
  public:
    /**
     * The spaces have the same order and are kept by reference. Cells of the
     * @p pressures are the @p parents of those of the @p displacements, which
     * have as many: owned cell c lies in owned cell parents[c].
     */
    void
    reinit(const SplineSpace<dim>          &displacements,
           const SplineSpace<dim>          &pressures,
           const std::vector<unsigned int> &parents,
           const bool                       is_axisymmetric = false);

    /**
     * The numbers of points that keep the pressure, Pa, and for BDF2 what water
     * has come in the last step per stress-free volume; invalid without it.
     */
    struct Numbers
    {
      unsigned int pressure, change;
    };

    /**
     * Begin a step of length @p dt (s) with the weight of water per volume (N /
     * m^3) without points. Of what has come in the step before the fraction
     * @p earlier counts.
     */
    void
    clear(const double                  dt,
          const dealii::Tensor<1, dim> &weight,
          const double                  earlier = 0.);

    /**
     * Add the points of a body at the start of the step.
     */
    void
    add(const MaterialPoints<dim> &points,
        const Numbers             &numbers,
        const WaterConstants      &constants);

    void
    add(const DrainedPoint<dim> &point);

    /**
     * Collective. f and r for a displacement in the step, m, and a pressure,
     * Pa.
     */
    void
    evaluate(const VectorField<dim> &u,
             const VectorType       &p,
             VectorField<dim>       &force,
             VectorType             &rows);

    /**
     * Collective. The derivatives of the last evaluate() in a direction.
     */
    void
    multiply(const VectorField<dim> &du,
             const VectorType       &dp,
             VectorField<dim>       &force,
             VectorType             &rows) const;

    /**
     * Collective. That of the force in the direction of a pressure alone.
     */
    void
    spread(const VectorType &dp, VectorField<dim> &force) const;

    /**
     * Collective. f at the start of the step, with the pressures that points
     * keep.
     */
    void
    begin_force(VectorField<dim> &force) const;

    /**
     * Collective. The displacement @p u, m^2 s^2 / kg times Pa, by which the
     * forces of the pressure 1 move a body that has nothing but its mass M, M u
     * = - f: it is not zero where the body can move at its surface.
     * add_schur_complement() needs it for bodies with inertia.
     */
    void
    set_free_motion(const VectorField<dim> &u);

    /**
     * Add the derivative of r by p at the start of the step, and what a
     * displacement that follows the pressure adds: the Schur complement. With
     * @p kick = 0 the latter is that of stiff soil without inertia, the sum
     * of V q q over the modulus of pressure waves of each point; else that of
     * soil that has nothing but its mass times @p kick (s^2), the sum
     * of V / rho grad q . grad q and, at free surfaces, of V div u q q with the
     * u of set_free_motion(). The functions are those of any order on the same
     * cells as the pressures.
     */
    void
    add_schur_complement(const SpacePolynomials<dim> &functions,
                         const double                 kick,
                         StencilMatrix<dim>          &matrix) const;

    /**
     * Collective. The mean of the pressure at the start around each function of
     * the pressure, 0 where there are no points.
     */
    void
    average_old_pressure(VectorType &p) const;

    /**
     * Give the points of all bodies, in the order in which they were added,
     * the numbers of the last evaluate().
     */
    void
    store(const std::vector<std::pair<MaterialPoints<dim> *, Numbers>> &bodies)
      const;

    /**
     * Of the last evaluate() on this process: the volume of water that the step
     * has brought to the pores, that which has left through all boundaries, and
     * through each of them, m^3 (2D: m^2).
     */
    const std::vector<double> &
    volumes() const
    {
      return water_volumes;
    }

    /**
     * The work of the pressure on the soil of this process in the step of the
     * last evaluate(), with the mean of its values at both ends, J (2D: J / m).
     */
    double
    work() const
    {
      return pressure_work;
    }

    /**
     * The sums of squares of the forces that the cells of this process gave to
     * the last evaluate(), and of the absolute values of what their rows are
     * the sums of, to which round-off is relative.
     */
    const std::array<double, 2> &
    squares() const
    {
      return cell_squares;
    }

    /**
     * The sums of V and of V times the modulus of pressure waves over the
     * points of this process.
     */
    const std::array<double, 2> &
    moduli() const
    {
      return sums_of_moduli;
    }

    /// The mass of the points of this process, kg (2D: kg / m).
    double
    mass() const
    {
      return sum_of_masses;
    }

  private:
    using PointTerm   = typename WaterTerms<dim>::Point;
    using DrainedTerm = typename WaterTerms<dim>::Drained;
    using Sources     = typename WaterTerms<dim>::Sources;
    using Change      = typename WaterTerms<dim>::Change;

    /**
     * Fields, if they are not null, and zeros for sums, function by function.
     * The latter are null if they are left out.
     */
    typename WaterTangents<dim>::Fields
    begin_pass(const VectorField<dim> *u,
               const VectorType       *p,
               const bool              with_force,
               const bool              with_rows) const;

    /**
     * Collective. The sums of all processes.
     */
    void
    end_pass(VectorField<dim> &force, VectorType *rows) const;

    /// Add to volumes() and work().
    void
    count(const PointTerm &term, const double volume);
    void
    count(const DrainedTerm &term, const double volume);

    SpacePolynomials<dim>     displacement_tables, pressure_tables;
    std::vector<unsigned int> parents;

    WaterTerms<dim>          terms;
    WaterTangents<dim>       tangents;
    std::vector<PointTerm>   points;
    std::vector<DrainedTerm> drained;
    double                   pressure_work = 0., sum_of_masses = 0.;
    double                   part_of_earlier = 0.;
    std::vector<double>      water_volumes;
    std::array<double, 2>    cell_squares{}, sums_of_moduli{};

    mutable std::vector<double> u_buffer, p_buffer, forces, row_sums;
  };
} // namespace greville

#endif
