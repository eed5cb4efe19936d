// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_central_differences_h
#define greville_steps_central_differences_h

#include <greville/steps/damping.h>
#include <greville/steps/friction_contact.h>
#include <greville/steps/move_points.h>
#include <greville/steps/obstacles.h>
#include <greville/steps/step_size.h>
#include <greville/steps/time_integrator.h>
#include <greville/steps/velocity_filter.h>

namespace greville
{
  /**
   * Explicit steps. A step from t_n to t_(n+1) = t_n + dt, with the sums of
   * PointTransfer at the positions x_n, is
   *
   *   M, P, F     from the points                             (points to grid)
   *   M v  = P    the velocity of the grid
   *   M a  = F    with gravity, then damped
   *   v'   = v + dt' a, filtered (consistent mass, see VelocityFilter), and
   *          contact with friction walls
   *   points are kicked by a (FLIP) or take v' (PIC, APIC), and are moved by v'
   *   F, J, stress from the gradient of w                     (grid to points)
   *
   * with w = v' (USL); w = M^-1 P', P' from the velocities of the kicked points
   * at x_n (MUSL); or w = v, before F is summed up (USF). Coefficients at walls
   * and at obstacles, see Obstacles, are held in all of these. What v leaves
   * out of the points' momentum there, since it is held, is taken from the
   * points with the kick, see GridMass::held_residual(): else they would keep
   * it for ever.
   *
   * With velocities at half steps, dt' is the mean of dt and the step before
   * it, in the first step dt / 2: central differences, of second order, where
   * v belongs to t_(n-1/2), v' to t_(n+1/2). USF then deforms over the step
   * before, to which v belongs: F, J and stress of a finished step are those of
   * t_n. With full steps dt' = dt: symplectic Euler, of first order.
   *
   * Automatic steps with consistent mass (not USF, which has updated the points
   * by then) are rejected where they show a mode that they are too long for:
   * the critical step can fall from one step to the next, where points have
   * left a hole.
   *
   * The references are
   * @ref Sulsky1994 "Sulsky, Chen and Schreyer, 1994", and
   * @ref Bardenhagen2002 "Bardenhagen, 2002".
   */
  template <int dim>
  class CentralDifferences : public TimeIntegrator<dim>
  {
  public:
    CentralDifferences(const StressUpdate          order,
                       const IntegratorParts<dim> &parts);

    double
    propose_step(State<dim> &state) override;

    /**
     * Finds the acceleration. Automatic steps with consistent mass are rejected
     * where it shows that they are too long.
     */
    void
    try_step(State<dim> &state, const double dt) override;

    void
    advance(State<dim> &state, const double dt) override;

    /**
     * Where contacts with friction slide, solves begin with the last step.
     */
    void
    forget() override
    {
      if (contact)
        contact->set_loads();
    }

    bool
    velocities_lag(const State<dim> &state) const override
    {
      return half_steps && state.step > 0.;
    }

    /**
     * Velocities at half steps get the other half of their kick; USF deforms
     * the points to the end of the last step. Reactions stay.
     */
    void
    finish(State<dim> &state) override;

  private:
    /**
     * Whether steps look at accelerations before they are taken: not given
     * ones, and not those of USF, which deforms the points for its acceleration
     * already.
     */
    bool
    may_reject() const;

    /**
     * When walls have their velocity at the end of the step, or at the time
     * of the state where nothing moves.
     */
    WallTime
    wall_time(const State<dim> &state) const;

    /**
     * The velocity that the acceleration leads to, with contact, and the work
     * in the step.
     */
    void
    find_new_velocity(State<dim> &state);

    /**
     * Points to grid, and the solves for velocity and acceleration.
     */
    void
    find_acceleration(State<dim> &state);

    /**
     * Tell the guard what came of the points.
     */
    void
    tell_guard(const State<dim> &state);

    /**
     * Find what touches obstacles, and hold it: guesses of velocity and
     * acceleration get the values there. Without @p with_force, the forces of
     * the points are not known yet.
     */
    void
    touch_obstacles(const State<dim> &state, const bool with_force);

    void
    add_gravity(const double t);

    /**
     * M field = sum for pairs of them; the fields hold guesses and the values
     * at walls.
     */
    void
    solve(const std::vector<VectorField<dim> *>       &fields,
          const std::vector<const VectorField<dim> *> &sums,
          const std::vector<double>                   &shares = {});

    /**
     * Filter the new velocity, and add what that takes to the acceleration.
     */
    void
    filter_velocity();

    /**
     * Friction walls change the new velocity and the acceleration.
     */
    void
    add_contact(State<dim> &state);

    /**
     * Points shall not keep what the held velocity leaves out of theirs: add
     * it, with the opposite sign, to the acceleration that kicks them.
     */
    void
    take_held_residual(const State<dim> &state);

    /**
     * The momentum that walls give in the step: @p factor times what they
     * add to the sum of the pair @p k of the last solve(), or what contact
     * gives.
     */
    void
    add_momentum_of_walls(const VectorField<dim> &x,
                          const VectorField<dim> &b,
                          const unsigned int      k,
                          const double            factor);

    void
    add_momentum_of_walls(const WallSums<dim> &momentum,
                          const double         factor = 1.);

    /**
     * Work that loads, walls and obstacles do in this step; of loads on points
     * half of it, with their velocities before the kick.
     */
    void
    add_work(State<dim> &state);

    /**
     * Half of the work of loads on points, with the velocities that they have
     * before the kick or after it.
     */
    void
    add_work_of_point_loads(State<dim> &state, const bool is_kicked);

    /**
     * Work of contact that has changed the new velocity from what work_field
     * has, with lumped mass.
     */
    void
    add_work_of_friction(State<dim> &state);

    /**
     * Work of Cundall's damping in this step.
     */
    void
    add_work_of_damping(State<dim> &state);

    /**
     * One pass over the points. Null pointers leave out a part.
     */
    void
    update(State<dim>             &state,
           const VectorField<dim> *kick,
           const VectorField<dim> *velocity,
           const VectorField<dim> *deformation,
           const bool              move);

    /**
     * Likewise over those of surfaces, whose velocity is that at the end of the
     * step, to which grid velocities at half steps are extrapolated: dashpots
     * need it.
     */
    void
    update_surfaces(State<dim>             &state,
                    const PointUpdate<dim> &update,
                    PointMotion            &motion);

    /**
     * See StepGuard::set_swing().
     */
    double
    swing(const State<dim> &state) const;

    /**
     * Begin the late row, if it is wanted, with the state before the step; and
     * after all of it has been summed up.
     */
    void
    begin_row(const State<dim> &state);

    void
    end_row(const State<dim> &state);

    /**
     * MUSL: the velocity of the points that have been kicked.
     */
    void
    map_kicked_points(State<dim> &state);

    /**
     * Those of the new state, of all processes.
     */
    Signals
    signals() const;

    /**
     * The fraction of the velocity that FLIP keeps in a step.
     */
    double
    flip_share(const State<dim> &state, const double velocity_step) const;

    /**
     * That of the step that is being tried; none with APIC.
     */
    double
    kept_share(const State<dim> &state) const;

    const StressUpdate          order;
    const SimulationParameters &parameters;
    Discretization<dim>        &discretization;
    GridMass<dim>              &mass;
    ConsistentMass<dim> *const  consistent; // if the mass is
    const Walls<dim>           &walls;
    Loads<dim>                 &loads;
    StepLog                    &log;
    StepGuard<dim>             &guard;
    LateRow<dim>               &late_row;
    const bool                  apic, half_steps;

    std::unique_ptr<FrictionContact<dim>> contact; // consistent mass
    std::unique_ptr<Obstacles<dim>>       obstacles;
    VelocityFilter<dim>                   filter; // consistent mass
    Damping<dim>                          damping;
    StepSize<dim>                         step_size;

    /**
     * The step that is being tried.
     */
    struct Trial
    {
      double               step = 0., velocity_step = 0., deformation_step = 0.;
      VectorField<dim>     force, velocity, acceleration, new_velocity;
      WallSums<dim>        momentum_of_walls;
      PointMotion          motion;
      MomentumBalance<dim> momentum;
      unsigned int         n_iterations = 0, n_all_iterations = 0;
    };
    Trial            trial;
    VectorField<dim> work_field, surface_velocity;
    LateRow<dim>    *row = nullptr; // that the step sums up
  };
} // namespace greville

#endif
