// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/contact.h>
#include <greville/steps/damping.h>
#include <greville/steps/fractional_step.h>
#include <greville/steps/step_size.h>
#include <greville/steps/velocity_filter.h>

namespace greville
{
  /**
   * Explicit steps, such as USL and MUSL. A step from t_n to
   * t_(n+1) = t_n + dt, with the sums of PointTransfer at the positions x_n, is
   * for each GridField
   *
   *   M, P, F     from the points                             (points to grid)
   *   M v  = P    the velocity of the grid
   *   M a  = F    with gravity, then damped, and with the pressure of pore
   *               water (see FractionalStep)
   *   v'   = v + dt' a, filtered (consistent mass, see VelocityFilter), and
   *          changed by each Contact
   *   points are kicked by a (FLIP, Taylor) or take v' (PIC, APIC), and are
   *   moved by v'
   *   F, J, stress from the gradient of w                     (grid to points)
   *
   * with the velocity w of the scheme. Coefficients at walls and in contacts
   * are constrained in all of these. The constrained v does not represent all
   * of the points' momentum. The kick removes the rest from the points, see
   * GridMass::constrained_residual(); otherwise, they would keep it forever.
   *
   * With velocities at half steps, v belongs to t_(n-1/2) and v' to t_(n+1/2),
   * and dt' is the mean of dt and the previous step, or dt / 2 in the first
   * step: central differences, of second order. With full steps, dt' = dt:
   * symplectic Euler, of first order.
   *
   * Automatic steps with consistent mass are rejected if they show a mode for
   * which they are too long: the critical step can fall from one step to the
   * next if points leave a hole.
   *
   * The references are @ref Sulsky1994 "Sulsky, Chen and Schreyer, 1994", and
   * @ref Bardenhagen2002 "Bardenhagen, 2002".
   */
  template <int dim>
  class CentralDifferences : public TimeIntegrator<dim>
  {
  public:
    explicit CentralDifferences(const IntegratorParts<dim> &parts);

    double
    propose_step(State<dim> &state) override;

    void
    try_step(State<dim> &state, const double dt) override;

    void
    advance(State<dim> &state, const double dt) override;

    void
    forget() override
    {
      for (const auto &contact : contacts)
        contact->forget();
    }

    bool
    velocities_are_late(const State<dim> &state) const override
    {
      return half_steps && state.velocity_time < state.time;
    }

    /// Apply the second half of the kick to velocities at half steps. Reactions
    /// do not change.
    void
    finish(State<dim> &state) override;

  protected:
    /// Return whether w is the velocity mapped from the points, not v'.
    virtual bool
    deforms_by_mapped_velocity() const = 0;

    /// Collective. Kick, deform and move the points.
    virtual void
    take_points(State<dim> &state) = 0;

    /// Solve M x = sum for pairs of fields; x holds guesses and values at
    /// walls.
    void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &sums,
          const std::vector<double>                   &shares = {});

    /// Call Contact::stop() of all contacts.
    void
    stop(VectorField<dim> &velocity) const
    {
      for (const auto &contact : contacts)
        contact->stop(velocity);
      if (!contacts.empty())
        field.mass->distribute_levels(velocity);
    }

    using Member = VectorField<dim> GridField<dim>::*;

    /// Do one pass over the points. Null arguments skip a task.
    void
    update(State<dim>  &state,
           const Member kick,
           const Member velocity,
           const Member deformation,
           const bool   move);

    /// Return the time of the velocity of walls: the end of the step, or the
    /// time of the state if nothing moves.
    WallTime
    wall_time(const State<dim> &state) const;

    const SimulationParameters &parameters;
    Discretization<dim>        &discretization;
    GridField<dim>             &field;
    const Walls<dim>           &walls;
    Loads<dim>                 &loads;
    StepLog                    &log;
    StepGuard<dim>             &guard;
    LateRow<dim>               &late_row;
    const bool                  apic, taylor, half_steps;

    std::vector<std::unique_ptr<Contact<dim>>> contacts;

    /// The step that is being tried.
    struct Trial
    {
      double               step = 0., velocity_step = 0.;
      PointMotion          motion;
      MomentumBalance<dim> momentum;
      unsigned int         n_iterations = 0, n_all_iterations = 0;
    };
    Trial trial;

  private:
    /// Return whether steps may be rejected: automatic steps with exact mass.
    bool
    may_reject() const
    {
      return field.mass->is_exact() && parameters.time.step.empty();
    }

    /// Apply contacts and loads at the start of the step.
    void
    begin_step(State<dim> &state);

    ContactStep<dim>
    contact_step(State<dim> &state);

    /// Set guesses with values at walls, and begin the balance of momentum. The
    /// accelerations of the field and of the state are swapped.
    void
    set_guesses(State<dim> &state);

    /// Apply the constraints of contacts, see Contact::constrain().
    void
    constrain(State<dim> &state);

    void
    add_gravity(const double t);

    /// Sum points to the grid, and solve for velocity and acceleration at once.
    void
    find_fields(State<dim> &state);

    /// Add the momentum that walls give in the step: @p factor times their
    /// contribution to the sum of the pair @p k of the last solve().
    void
    add_momentum_of_walls(const VectorField<dim> &x,
                          const VectorField<dim> &b,
                          const unsigned int      k,
                          const double            factor);

    /// Compute the acceleration at the start of the step.
    void
    find_acceleration(State<dim> &state);

    /// Return the FLIP share in this step; zero with APIC.
    double
    kept_share(const State<dim> &state) const
    {
      return apic ? 0. : discretization.flip_share(state, trial.velocity_step);
    }

    /// Collective. Add the effect of the pore pressure.
    void
    add_pressure(const State<dim> &state);

    /// Compute the new velocity, with contact, and the work in the step.
    void
    find_new_velocity(State<dim> &state);

    void
    inform_guard();

    /// Use the acceleration of the trial, or compute it if there is none.
    void
    take_acceleration(State<dim> &state, const double dt);

    /// Set the fields, times and counters of the state.
    void
    count_step(State<dim> &state, const double dt);

    /// Filter the new velocity, and change the acceleration accordingly.
    void
    filter_velocity();

    /// Let contacts change the new velocity and the acceleration.
    void
    add_contact(State<dim> &state);

    /// Remove the velocity of points that the constrained grid velocity does
    /// not represent: subtract it from the acceleration that kicks them.
    void
    take_constrained_residual(const State<dim> &state);

    /// Add the work of loads and walls, with half of the work of point loads.
    void
    add_work(State<dim> &state);

    /// Add half of the work of point loads, before or after the kick.
    void
    add_work_of_point_loads(State<dim> &state, const bool is_kicked);

    /// Add the work of Cundall's damping in this step.
    void
    add_work_of_damping(State<dim> &state);

    /// Update the points of surfaces. Dashpots require velocities at the end of
    /// the step: grid velocities at half steps are extrapolated to it.
    void
    update_surfaces(State<dim>             &state,
                    const PointUpdate<dim> &update,
                    PointMotion            &motion);

    /// Return the energy for StepGuard::set_energy_swing().
    double
    energy_swing(const State<dim> &state) const;

    /// Call LateRow::show with the state at the start of the step, for which
    /// points take a @p kick to their velocities at that time.
    void
    show(State<dim> &state, PointUpdate<dim> kick);

    /// Begin or complete the late row of this step, if it is requested.
    void
    begin_row(const State<dim> &state);

    void
    end_row(const State<dim> &state);

    /// Return the signals of the new state, over all processes.
    Signals
    signals() const;

    std::unique_ptr<FractionalStep<dim>> water; // null: none

    VelocityFilter<dim> filter; // consistent mass
    Damping<dim>        damping;
    StepSize<dim>       step_size;
    bool                have_constraints = false; // by contacts
    VectorField<dim>    work_field, surface_velocity;
    // Velocities and accelerations of surfaces if GridMass::extends_surfaces().
    std::array<VectorField<dim>, 3> surface_fields;
    LateRow<dim>                   *row = nullptr; // of this step
  };
} // namespace greville
