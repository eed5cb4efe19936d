// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// The momentum balance of bodies in a step: the share of this process, N s
  /// (2D: N s / m).
  template <int dim>
  struct MomentumBalance
  {
    /// The expected momentum of the points after the step.
    dealii::Tensor<1, dim> expected;

    /// Add @p factor times the sum of the owned coefficients of @p field.
    void
    add(const VectorField<dim> &field, const double factor);

    /// Add @p factor times the sum of the @p field times the @p mass of its
    /// functions.
    void
    add(const VectorType       &mass,
        const VectorField<dim> &field,
        const double            factor);

    void
    add(const dealii::Tensor<1, dim> &momentum)
    {
      expected += momentum;
    }
  };



  /**
   * A check of each step, which throws StepFailed unless
   * - no point is lost, except those that have left the grid;
   * - the mass of the points is unchanged;
   * - mass and momentum are finite (stresses and J are checked where laws
   *   compute them);
   * - J is within plausible bounds;
   * - explicit steps: no point crosses more than a cell, no pressure wave more
   *   than three;
   * - the momentum of the points is their previous momentum plus the impulse of
   *   forces and walls. In explicit steps, this impulse is computed on the
   *   grid; in implicit steps, it is the momentum that the grid gives to the
   *   points, because forces come from Newton's method. This is not checked
   *   with constraining contacts or Cundall's damping.
   * The sums are computed in the passes over points and grid of the step
   * itself.
   *
   * Every hundred steps, and after the last one, it checks the EnergyBalance of
   * the state (in explicit steps, of the state before the step), and warns or
   * stops the run if there is spurious energy.
   */
  template <int dim>
  class StepGuard
  {
  public:
    /// All arguments are kept by reference.
    StepGuard(const SimulationParameters &parameters,
              const Discretization<dim>  &discretization,
              StepLog                    &log);

    /// Collective. Store the initial energy and mass.
    void
    start(State<dim> &state) const;

    /// Collective. Store the mass of points that have been read from a file.
    void
    weigh(State<dim> &state) const;

    /// Pass the results for the points of this process in the current step.
    /// Integrators call this; check() resets the results.
    void
    set(const PointMotion &motion);

    /// Pass the balance of momentum. Integrators call this; check() resets it.
    void
    set(const MomentumBalance<dim> &balance);

    /// Set dt^2 / 8 a^T M a of this process, J (2D: J / m), if there is a
    /// LateRow. In linear vibrations, central differences conserve the energy E
    /// of finished states minus this value. E itself oscillates more if modes
    /// are closer to their critical step. Integrators call this; check() resets
    /// it.
    void
    set_energy_swing(const double energy)
    {
      energy_swing = energy;
    }

    /// Collective. Check a state after a step. Data that the integrator has not
    /// passed are not checked. Throws StepFailed.
    void
    check(State<dim> &state, const bool is_implicit);

    /// Return whether check_energy() is due after this number of steps: every
    /// hundred steps, and after the last one if there are more than a hundred.
    bool
    looks_at_energy(const unsigned int n_steps,
                    const bool         is_last = false) const;

    /// Collective. Check the balance of energy; @p now belongs to a finished
    /// state. Most of the oscillation set by set_energy_swing() is subtracted.
    /// Subtracting all of it would also hide modes beyond their critical step.
    /// Warns, or throws StepFailed.
    void
    check_energy(State<dim> &state, const EnergyTotals &now) const;

  private:
    /// Return a text about the point of all processes with the largest or NaN
    /// @p measure(body, point): "point 12 of the body 'disk' at (0.1, 0.2) m,
    /// in the cell (3, 4)".
    template <typename Measure>
    std::string
    worst_point(const State<dim> &state, const Measure &measure) const;

    void
    check_count(const State<dim> &state) const;

    void
    check_points(const State<dim> &state,
                 const double      mass,
                 const bool        is_implicit) const;

    void
    check_momentum(const dealii::Tensor<1, dim> &expected,
                   const dealii::Tensor<1, dim> &found,
                   const double                  size,
                   const State<dim>             &state,
                   const bool                    is_implicit) const;

    /// Collective. Return the name of a surface whose force acts on functions
    /// without mass, empty if there is none.
    std::string
    surface_without_mass(const State<dim> &state) const;

    const SimulationParameters &parameters;
    const Discretization<dim>  &discretization;
    StepLog                    &log;

    // The sums of the current step.
    PointSums                           sums;
    double                              wave         = 0.; // speed, m / s
    double                              energy_swing = 0.; // energy, J
    bool                                has_sums     = false;
    std::optional<MomentumBalance<dim>> balance;
  };
} // namespace greville
