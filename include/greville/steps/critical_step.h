// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/grid_mass.h>
#include <greville/steps/state.h>

namespace greville
{
  /// The properties of a time step on which its stability depends.
  struct StepScheme
  {
    /// True if points are deformed by their velocity, mapped to the grid
    /// (MUSL), false if by the new velocity of the grid (USL).
    bool deforms_by_mapped_velocity = false;
    /// 1: FLIP, 0: PIC.
    double flip = 1.;
    /// True for APIC and Taylor.
    bool has_affine = false;
    /// The factor alpha of Cundall's damping, 0 if it does not act.
    double damping = 0.;
  };



  /**
   * An estimate of the critical step, the step dt for which the largest
   * eigenvalue of
   * @f[ B \left(\frac{\Delta t^2}{4} K + \frac{\Delta t}{2} C\right) @f]
   * is one. K is the stiffness matrix of the bodies, with the moduli of their
   * materials scaled by the wave moduli of the points. C is the matrix of their
   * largest viscosities. They do not depend on the state of a point: a torn
   * fluid has no pressure, but keeps its viscosity. Without viscosity, dt
   * is 2 / omega with the largest eigenvalue omega^2 of B K; without stiffness,
   * 2 / gamma with the largest eigenvalue gamma of B C. K and C must be
   * combined: separate estimates would give too short a step for a stiff body
   * beside a viscous one.
   *
   * With the exact mass, B = M^-1. Otherwise, velocities of points that are
   * mapped to the grid by an approximate inverse A of M (lumped, FMPM) are
   * reduced by A M. For a mode with the eigenvalues k of dt^2 A K and s <= 1 of
   * A M, and with the FLIP share f, sigma = f + (1 - f) s, a step has the
   * characteristic polynomial
   * @f{align*}{
   *   & z^2 - (1 + \sigma - k) z + \sigma - k (\sigma - s) && \text{(USL)},
   *   \\
   *   & z^2 - (1 + \sigma - k s) z + \sigma && \text{(MUSL)},
   * @f}
   * which is stable for k (1 + sigma - s) <= 2 (1 + sigma) and k s <= 2 (1 +
   * sigma). B is a polynomial in s, times A, that is an upper bound of 4 / k
   * from these conditions, and equal to it for f = 1 and at s = 0 and 1:
   * @f[
   *   (2 - s) A \quad \text{(USL)}, \qquad
   *   \frac{2 s - (1 - f) s^2}{1 + f} A \quad \text{(MUSL)}.
   * @f]
   * APIC is PIC with an s that is nearer to one: (2 - s) A (USL), A (MUSL).
   * With Taylor, points have their velocity u and the gradient of a grid
   * velocity g, and v = s u + r g; inside a grid, r >= 0 and s + r <= 1. For
   * f = 1, the conditions are
   * @f{align*}{
   *   k (2 - s) &< 4 (1 + r) && \text{(USL)}, \\
   *   k (s + 2 r - s r) &< 4 (1 + r^2) && \text{(MUSL)},
   * @f}
   * so that the same bounds hold.
   * For the highest frequency, s is near 0. Compared with the step of A K, the
   * step of lumped USL is then shorter by up to the root of 2, and the step of
   * lumped MUSL is longer. Cundall's damping multiplies forces by at most 1 +
   * alpha; so the stiffness is multiplied by 1 + alpha with lumped mass, and by
   * (1 + alpha)^2 with other masses. There, the damping changes its signs from
   * step to step, and a block that slides on its base would repeatedly gain
   * strain energy with the factor 1 + alpha.
   *
   * The eigenvalue is computed by largest_eigenvalue(), until it changes by
   * less than 1 % per iteration. It converges from below, so the result needs a
   * safety factor. An estimate begins with the last eigenvector plus some
   * noise. The mass of a linear B-spline at the rim of a body vanishes with the
   * distance of the outermost point, but its stiffness does not. For p = 1,
   * functions with less than 1 % of the largest mass are therefore omitted.
   *
   * (T. Belytschko, W. K. Liu, B. Moran, Nonlinear finite elements for continua
   * and structures, section 6.2, derive the critical step of a damped mode.)
   */
  template <int dim>
  class CriticalStep
  {
  public:
    /// Collective. Return the critical step; infinite without stiffness and
    /// viscosity. @p mass belongs to the current positions of @p bodies, and to
    /// @p mass_points. Springs and dashpots of the loads on @p surfaces are
    /// included. The iteration begins with the last @p mode and overwrites it.
    double
    estimate(GridMass<dim>                                  &mass,
             PointTransfer<dim>                             &transfer,
             const std::vector<Body<dim>>                   &bodies,
             const std::vector<Surface<dim>>                &surfaces,
             const std::vector<const MaterialPoints<dim> *> &mass_points,
             const StepScheme                               &scheme,
             HighestMode<dim>                               &mode);

  private:
    /// Choose the functions that take part, and the initial force.
    void
    choose_unknowns(const GridMass<dim> &mass, const HighestMode<dim> &mode);

    void
    read_field(std::vector<double>    &values,
               const VectorField<dim> &field) const;

    void
    write_field(VectorField<dim>          &field,
                const std::vector<double> &values) const;

    /// Compute x = B b.
    void
    multiply_by_B(std::vector<double>                            &x,
                  const std::vector<double>                      &b,
                  GridMass<dim>                                  &mass,
                  PointTransfer<dim>                             &transfer,
                  const std::vector<const MaterialPoints<dim> *> &mass_points,
                  const StepScheme                               &scheme);

    /// Compute y = factor (elastic K + viscous C) x.
    void
    multiply_by_stiffness(std::vector<double>                  &y,
                          const std::vector<double>            &x,
                          const double                          elastic,
                          const double                          viscous,
                          const double                          factor,
                          GridMass<dim>                        &mass,
                          PointTransfer<dim>                   &transfer,
                          const std::vector<const Body<dim> *> &bodies,
                          const std::vector<Surface<dim>>      &surfaces);

    // The owned functions that take part, by component; and fields and arrays
    // of their values, one component after the other.
    std::array<std::vector<unsigned int>, dim> unknowns;
    VectorField<dim>    source, target, product, extended;
    std::vector<double> start;
  };
} // namespace greville
