// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/coupled_cycle.h>
#include <greville/steps/implicit_scheme.h>
#include <greville/steps/time_integrator.h>
#include <greville/water/pore_water.h>

#include <array>
#include <optional>

namespace greville
{
  template <int dim>
  class CoupledSteps;
  template <int dim>
  class TrialContacts;

  /**
   * Implicit steps in the updated Lagrangian form. The basis functions are
   * evaluated at the x_n of the points, and the unknowns are the displacement u
   * of the grid. With the velocity v of the grid, M v = P, and its acceleration
   * a, M a = F - f, at x_n, u solves the equations of an ImplicitScheme by
   * Newton's method. Loads F that depend on the position of points follow u.
   * Then points take
   * @f[
   *   x_p \leftarrow x_p + u(x_p), \qquad F_p \leftarrow (1 + \nabla u) F_p,
   *   \qquad v_p \leftarrow v_p + (v' - v)(x_p),
   * @f]
   * or with PIC v_p = v'(x_p). A scheme that keeps its acceleration also
   * transfers it to the points, a_p = a'(x_p), and begins the next step with M
   * a = sum_p m_p a_p N; total Lagrangian steps keep it on the grid. M is the
   * consistent mass on extended B-splines or, with Scheme/Mass = lumped, its
   * row sums before the extension.
   *
   * If Newton's method fails, the step is repeated with half the length; after
   * easy steps, the length is doubled, up to the given one. The state does not
   * change before Newton's method has converged.
   */
  template <int dim>
  class ImplicitSteps : public TimeIntegrator<dim>
  {
  public:
    /// Throws dealii::ExcMessage for parameters that implicit steps do not
    /// support.
    ImplicitSteps(const std::string &name, const IntegratorParts<dim> &parts);

    double
    propose_step(State<dim> &state) override;

    /// Run Newton's method; the step is rejected if it does not converge. See
    /// CoupledSteps, which also take the steps of parts coupled by contacts.
    void
    try_step(State<dim> &state, const double dt) override;

    void
    advance(State<dim> &state, const double dt) override;

    void
    forget() override
    {
      system.forget();
      expected_iterations = 1;
    }

    std::vector<SolverLevel>
    solver_levels() const override;

    bool
    is_implicit() const override
    {
      return true;
    }

    ImplicitSteps<dim> *
    implicit_steps() override
    {
      return this;
    }

  private:
    friend class CoupledSteps<dim>;
    friend class TrialContacts<dim>;

    GridField<dim> &
    field() const
    {
      return discretization.field();
    }

    void
    check_parameters(const std::string          &name,
                     const IntegratorParts<dim> &parts) const;

    /// Throw if neither walls nor springs support a static body.
    void
    check_support(const State<dim> &state) const;

    /// Sum the loads at time t, with or without loads that depend on the
    /// position of points, taken at the start.
    void
    sum_loads(State<dim>       &state,
              const double      t,
              const bool        with_following,
              VectorField<dim> &loads);

    /// Find the acceleration of the grid at the start, without contacts. It is
    /// the acceleration kept by the scheme; in the first step, it follows from
    /// the forces.
    void
    find_acceleration(State<dim> &state);

    /// Collective. Find the acceleration by contact_load. Returns false if
    /// there is no contact load.
    bool
    find_contact_acceleration();

    /// Compute a' of the ImplicitScheme.
    void
    find_new_acceleration(VectorField<dim> &result, const double dt) const;

    /// Store the new acceleration in the state, and in updated Lagrangian
    /// steps in the field "acceleration" of points.
    void
    keep_acceleration(State<dim> &state, const double dt);

    void
    solve_mass(VectorField<dim> &x, const VectorField<dim> &b);

    /// Compute the data of the start of a step, and guess u.
    void
    begin_trial(State<dim> &state, const double dt);

    /// Set the bodies, with their strength at the end of the step.
    void
    take_bodies(const State<dim> &state, const double dt);

    /// Sum the mass and choose the unknowns anew if points have changed.
    void
    renew_mass(const State<dim> &state);

    void
    begin_water(State<dim> &state, const double dt);

    /// Sum old_force, the force of the stresses and the water pressure at the
    /// start, and the loads at the start and in the step.
    void
    sum_forces(State<dim> &state, const double dt);

    /// Subtract contact forces from old_force if the scheme has an
    /// acceleration: they act as impulses at the end of their steps.
    void
    set_contact_impulses_apart(const State<dim> &state);

    /// Return the times of walls at the start and the end of a step, each with
    /// an interval around it for the mean velocities of walls.
    std::array<WallTime, 2>
    wall_times(const double t, const double dt) const;

    /// Solve M v = P at the start.
    void
    map_velocity(const State<dim> &state, const double dt);

    /// Find the acceleration at the start, and its part in surface velocities.
    void
    map_acceleration(State<dim> &state, const double dt);

    /// Guess the displacement from the velocity, with the motion of walls.
    void
    guess_displacement(const State<dim> &state, const double dt);

    /// Compute the displacement, the forces of stresses and of loads, and the
    /// stiffness at x. Returns an error message about a point, or an empty
    /// text.
    std::string
    evaluate(const VectorType &x, const double dt, const bool with_stiffness);

    /// Compute the residual of the last evaluate() with the weighted contact
    /// force, which may be null and is kept by reference.
    void
    find_residual(VectorType             &r,
                  const double            dt,
                  const VectorField<dim> *of_contacts);

    /// Return the sum of the norms of inertia terms known at the start.
    double
    find_inertia_at_begin(const double dt);

    /// Estimate the round-off of the residual by the terms that cancel.
    double
    find_round_off() const;

    /// Find surface loads at the start, and prepare find_residual() for loads
    /// that depend on the displacement.
    void
    start_surfaces(const State<dim> &state, const double dt);

    /// Return the reason why the smallest step fails.
    std::string
    describe_failure(const State<dim> &state) const;

    /// Return the position of the largest entry of the last residual.
    std::string
    describe_residual() const;

    /// Set contact_load to the contact force of the trial divided by the
    /// scheme's contact weight, and find the acceleration that it causes.
    void
    take_contact_force();

    /// Find the forces of walls, and count the work.
    void
    find_reactions(State<dim> &state, const double dt);

    /// Subtract the weighted contact force from the @p reaction, and count its
    /// work. Returns this force.
    VectorField<dim>
    split_reaction(State<dim> &state, VectorField<dim> &reaction) const;

    /// Count the work of loads and of walls that move, with their @p reaction.
    void
    add_work(State<dim>             &state,
             const VectorField<dim> &reaction,
             const double            dt);

    /// Count the work of surface loads; the load at the end has this @p share.
    void
    add_work_of_surfaces(State<dim> &state, const double share);

    /// Kick the points so that they lose momentum that constrained velocities
    /// do not represent. Count it as momentum of walls.
    void
    take_constrained_momentum(State<dim> &state, const double dt);

    /// Set velocity and acceleration of the state to v' and (v' - v) / dt.
    void
    take_new_velocity(State<dim> &state, const double dt);

    void
    advance_water(State<dim> &state, const double dt);

    /// Kick the points, and move them by the displacement divided by dt.
    void
    move_points(State<dim> &state, const double dt);

    /// Set time, velocity time and counters of the state.
    void
    count_step(State<dim> &state, const double dt) const;

    const SimulationParameters &parameters;
    Discretization<dim>        &discretization;
    Loads<dim>                 &loads;
    StepLog                    &log;
    StepGuard<dim>             &guard;
    const ImplicitScheme        scheme;
    std::optional<Expression>   step_formula;
    TangentSystem<dim>          system;
    CoupledCycle<dim>           coupled_cycle; // if this is the first part
    bool                        is_symmetric = true;

    // The pore pressure and its force, null without pore water.
    std::unique_ptr<PoreWater<dim>> water;
    VectorField<dim>                water_force;

    // The bodies of the current state.
    std::vector<TrialBody<dim>>     bodies;
    std::vector<LoadedSurface<dim>> surfaces;
    SurfaceMotion<dim>              surface_motion;
    bool                            surfaces_are_symmetric = true;
    unsigned int                    expected_iterations    = 1; // of Newton
    std::uint64_t                   points_version         = 0; // of the mass

    VectorField<dim> velocity, acceleration, displacement;
    VectorField<dim> constrained_momentum; // of the mapped velocity
    VectorField<dim> old_force, old_loads, new_loads, force, work;
    // Fields for surfaces, and for bodies whose loads depend on the positions
    // of points: the part of their velocity that does not depend on the
    // displacement, and the loads. The loads at the start do not include loads
    // of bodies.
    VectorField<dim> surface_velocity, old_surface_loads, new_surface_loads;
    // If contacts act as impulses: the weighted force of TrialContacts; and the
    // contact load with the acceleration that it causes, which belong to the
    // start of the step and then to the trial.
    const VectorField<dim> *contact_force = nullptr;
    VectorField<dim>        contact_load, contact_acceleration;
    VectorType              last_residual;
    double force_scale = 0., unit_of_round_off = 0.; // of the last residual
    double inertia_at_begin = 0.;    // of known inertia terms, N
    bool   has_stiffness    = false; // of the last residual
    bool   forces_vanish    = false; // when Newton's method failed
    std::string rejection;

    // The numbers of iterations in the last trial: of Newton's method, and of
    // the linear solver, the largest per Newton iteration and the sum.
    unsigned int n_newton = 0, n_linear = 0, n_all_linear = 0;
  };
} // namespace greville
