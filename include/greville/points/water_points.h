// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/vector_field.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/points/material_points.h>
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
   * where all gradients, V = J V_0 and areas belong to the end of the step. The
   * last line is Nitsche's method for the pressure of drained boundaries, with
   * the outflow \f$\kappa (\beta / h \, (p - \bar p) - w \cdot n)\f$. On a
   * seepage face, the positive part of the outflow times q_b replaces this line
   * (@ref Chouly2015 "Chouly, Hild and Renard, 2015", theta = 0), which is not
   * less stable: its points switch between drained and impervious within
   * Newton's method. A given flow replaces this line, too. The change of volume
   * is summed at the points of the displacement, and the storage is per V_0.
   *
   * BDF2 has the same form. Its step has the length (1 + s) / (1 + 2 s) dt, and
   * s^2 / (1 + 2 s) times each point's inflow in the previous step is
   * subtracted from r, where s is the ratio of the lengths of both steps
   * (@ref Hairer1993 "Hairer, Norsett and Wanner, 1993", section III.5).
   *
   * p_n is the pressure stored in the points, sampled at their positions: if
   * points do not move in the space of the pressure, as in total Lagrangian
   * steps, this is equivalent to storing its coefficients.
   *
   * Axisymmetric points have volumes and areas per radian. Their J includes the
   * factor r / r_n, and forces have the additional term @f$- V p N_a / r@f$
   * along r.
   */
  template <int dim>
  class WaterPoints
  {
  public:
    /// The spaces have the same order and are kept by reference. Cells of the
    /// @p pressures may be larger: owned cell c of the @p displacements lies in
    /// owned cell parents[c], with the @p parents.
    void
    reinit(const SplineSpace<dim>          &displacements,
           const SplineSpace<dim>          &pressures,
           const std::vector<unsigned int> &parents,
           const bool                       is_axisymmetric = false);

    /// The positions of a point's numbers for the pressure, Pa, and for the
    /// inflow of water in the last step per stress-free volume. Without BDF2,
    /// the position of the inflow is invalid.
    struct Numbers
    {
      unsigned int pressure, change;
    };

    /// Begin a step of length @p dt (s), and remove all points. @p weight is
    /// the weight of water per volume (N / m^3), and @p earlier the factor of
    /// the inflow in the previous step.
    void
    clear(const double                  dt,
          const dealii::Tensor<1, dim> &weight,
          const double                  earlier = 0.);

    /// Add the points of a body at the start of the step.
    void
    add(const MaterialPoints<dim> &points,
        const Numbers             &numbers,
        const WaterConstants      &constants);

    void
    add(const typename WaterTerms<dim>::Drained &term);

    /// Collective. Compute f and r for a displacement in the step, m, and a
    /// pressure, Pa.
    void
    evaluate(const VectorField<dim> &u,
             const VectorType       &p,
             VectorField<dim>       &force,
             VectorType             &rows);

    /// Collective. Compute derivatives of the last evaluate().
    void
    multiply(const VectorField<dim> &du,
             const VectorType       &dp,
             VectorField<dim>       &force,
             VectorType             &rows) const;

    /// Collective. Compute the derivative of the force by the pressure.
    void
    spread(const VectorType &dp, VectorField<dim> &force) const;

    /// Collective. Compute f at the start from the pressures of the points.
    void
    begin_force(VectorField<dim> &force) const;

    /// Collective. Set the displacement @p u, m^2 s^2 / kg times Pa, with M u =
    /// -f for the mass M and the force f of a unit pressure. This is the motion
    /// of a body without stiffness; it is not zero if the body can move at its
    /// surface. add_schur_complement() needs it for bodies with inertia.
    void
    set_free_motion(const VectorField<dim> &u);

    /// Add the Schur complement: the derivative of r by p at the start of the
    /// step, and the effect of the displacement that p causes. With @p kick =
    /// 0, the displacement is computed for stiff soil without inertia: the
    /// effect is the sum of V q q over the modulus of pressure waves of each
    /// point. Otherwise, it is computed for soil without stiffness: the effect
    /// is @p kick (s^2) times the sum of V / rho grad q . grad q and, at free
    /// surfaces, of V div u q q with the u of set_free_motion(). The functions
    /// may have any order on the same cells as the pressures.
    void
    add_schur_complement(const SpacePolynomials<dim> &functions,
                         const double                 kick,
                         StencilMatrix<dim>          &matrix) const;

    /// Collective. Compute the mean of the pressure at the start around each
    /// function of the pressure; 0 if there are no points.
    void
    average_old_pressure(VectorType &p) const;

    /// Store the numbers of the last evaluate() in the points of all bodies, in
    /// the order in which they were added.
    void
    store(const std::vector<std::pair<MaterialPoints<dim> *, Numbers>> &bodies)
      const;

    /// Return volumes of water on this process in the last evaluate(), m^3 (2D:
    /// m^2): the inflow to the pores in the step, and the outflow through all
    /// boundaries and through each boundary.
    const std::vector<double> &
    volumes() const
    {
      return water_volumes;
    }

    /// Return the work of the pressure on the soil of this process in the step
    /// of the last evaluate(), J (2D: J / m). It uses the mean of the pressures
    /// at both ends of the step.
    double
    work() const
    {
      return pressure_work;
    }

    /// Return two sums for the last evaluate() on this process, to which
    /// round-off is relative: of the squares of the cell forces, and of the
    /// absolute values of the terms in the rows.
    const std::array<double, 2> &
    squares() const
    {
      return cell_squares;
    }

    /// Return the sums of V and of V times the modulus of pressure waves over
    /// the points of this process.
    const std::array<double, 2> &
    moduli() const
    {
      return sums_of_moduli;
    }

    /// Return the mass of the points of this process, kg (2D: kg / m).
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

    /// Begin a pass with the given fields, unless null. Sums by function are
    /// set to zero if requested, otherwise to null.
    typename WaterTangents<dim>::Fields
    begin_pass(const VectorField<dim> *u,
               const VectorType       *p,
               const bool              with_force,
               const bool              with_rows) const;

    /// Collective. Compute the sums over all processes.
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
