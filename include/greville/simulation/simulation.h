#ifndef greville_simulation_simulation_h
#define greville_simulation_simulation_h

#include <greville/particles/point_transport.h>
#include <greville/particles/points_copy.h>
#include <greville/particles/reconstruction.h>
#include <greville/simulation/critical_step.h>
#include <greville/simulation/energy_balance.h>
#include <greville/simulation/friction_contact.h>
#include <greville/simulation/loads.h>
#include <greville/simulation/obstacles.h>
#include <greville/simulation/statistics.h>
#include <greville/simulation/velocity_filter.h>

#include <map>
#include <optional>

namespace greville
{
  /**
   * What distinguishes the runs of a sweep.
   */
  struct SimulationCase
  {
    std::vector<unsigned int> cells;
    unsigned int              degree = 2;
    std::string               mass;
    std::string               quadrature;
  };



  /**
   * The material point method on a grid of B-splines. A step from t_n to
   * t_(n+1) = t_n + dt, with the sums of PointTransfer at the positions x_n, is
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
   * (D. Sulsky, Z. Chen, H. Schreyer, A particle method for history-dependent
   * materials, 1994; S. Bardenhagen, Energy conservation error in the material
   * point method for solid mechanics, 2002.)
   */
  template <int dim>
  class Simulation
  {
  public:
    /**
     * Collective. Makes grid and points. Parameters are kept by reference.
     * Throws dealii::ExcMessage where they are wrong.
     */
    Simulation(const SimulationParameters &parameters,
               const SimulationCase       &run_case,
               const MPI_Comm              comm = MPI_COMM_WORLD);

    /**
     * Collective. Mass and velocity of the grid from the points as they are:
     * for output before the first step.
     */
    void
    fill_grid();

    /**
     * Collective. One step; not beyond the end. Throws dealii::ExcMessage with
     * step, time and point where a point is lost or breaks; bodies() and time()
     * are then those of the last remembered good state.
     */
    void
    step();

    bool
    is_finished() const;

    /**
     * Collective.
     */
    Statistics<dim>
    statistics() const;

    double
    time() const
    {
      return t;
    }

    double
    last_step() const
    {
      return dt;
    }

    unsigned int
    n_steps() const
    {
      return steps;
    }

    const std::vector<Body<dim>> &
    bodies() const
    {
      return all_bodies;
    }

    /**
     * For programs that change points between steps.
     */
    std::vector<Body<dim>> &
    bodies()
    {
      return all_bodies;
    }

    const SplineSpace<dim> &
    space() const
    {
      return grid_mass->space();
    }

    const GridMass<dim> &
    mass() const
    {
      return *grid_mass;
    }

    /**
     * Null with other masses.
     */
    const ConsistentMass<dim> *
    consistent_mass() const
    {
      return consistent;
    }

    const VectorField<dim> &
    grid_velocity() const
    {
      return new_velocity;
    }

    /**
     * Points that have moved to another process, and that were removed outside
     * of the grid, so far, on all processes. Collective.
     */
    std::uint64_t
    n_sent() const;

    std::uint64_t
    n_removed() const;

    /**
     * The critical step, s: the last estimate, with consistent mass the
     * smallest of the last ones.
     */
    double
    critical() const
    {
      return critical_dt;
    }

    /**
     * Most iterations of a solve of the last step.
     */
    unsigned int
    n_iterations() const
    {
      return iterations;
    }

    /**
     * Iterations of all solves so far.
     */
    std::uint64_t
    n_all_iterations() const
    {
      return all_iterations;
    }

    /**
     * Warnings since the last call.
     */
    std::vector<std::string>
    take_warnings();

    /**
     * Seconds on this process by part of the step.
     */
    const std::map<std::string, double> &
    part_times() const
    {
      return seconds;
    }

    /**
     * Work of loads, walls and damping so far.
     */
    const EnergyBalance &
    energy_balance() const
    {
      return energy;
    }

    /**
     * Bytes of points and grid on this process.
     */
    std::size_t
    points_memory() const;

    DistributedTriangulation<dim> &
    triangulation()
    {
      return mesh;
    }

  private:
    class PartTimer;

    /**
     * A body without points.
     */
    Body<dim>
    make_body(const std::string &name) const;

    /**
     * Give each process the same share of points and cells.
     */
    void
    balance_load();

    void
    make_bodies();

    /**
     * Collective. Throw where two bodies fill the same cells: by half a cell or
     * more.
     */
    void
    check_overlap() const;

    /**
     * The first of some bodies that has points in a cell.
     */
    unsigned int
    body_at(const unsigned int cell, const unsigned int n_bodies) const;

    /**
     * Of a cell, m.
     */
    double
    smallest_edge() const;

    /**
     * The next step, after an estimate of the critical one if it is wanted and
     * asked for.
     */
    void
    choose_step(const bool estimate);

    /**
     * What time steps depend on, for messages: the materials, and where the
     * step is being chosen, the numbers that it is made of.
     */
    std::string
    what_sets_the_step(const bool is_chosen) const;

    /**
     * Points to grid, and the solves for velocity and acceleration.
     */
    void
    find_acceleration();

    /**
     * Whether the accelerations of this step and the two before it show a mode
     * that the step is too long for. Undamped, a'' = -M^-1 K a, so their second
     * difference is a step of the power method, which sees an unstable mode
     * from its first steps on. Accelerations that change speeds by less than
     * 1e-8 of @p signal (c + |v|) in a step are noise and show nothing.
     * Consistent mass with automatic steps: there the critical step can fall
     * from one step to the next, where points have left a hole. Collective.
     */
    bool
    shows_faster_mode(const double signal) const;

    void
    remember_acceleration();

    /**
     * Whether the critical step is to be estimated now: in the first step, then
     * every so often, and where the stiffest point has got stiffer.
     */
    bool
    is_estimate_due() const;

    void
    estimate_critical_step();

    /**
     * Mass and momentum of the points on the grid, unless they are there.
     */
    void
    sum_mass();

    /**
     * What integrals are summed over: the points, or their reconstruction.
     */
    const std::vector<const MaterialPoints<dim> *> &
    quadrature_points();

    /**
     * Find what touches obstacles, and hold it: guesses of velocity and
     * acceleration get the values there. Without @p with_force, the forces of
     * the points are not known yet.
     */
    void
    touch_obstacles(const bool with_force);

    /**
     * Points shall not keep what the held velocity leaves out of theirs: add
     * it, with the opposite sign, to the acceleration that kicks them.
     */
    void
    take_held_residual();

    /**
     * Gravity.
     */
    void
    add_grid_forces();

    /**
     * The factor of Cundall's damping that acts now.
     */
    double
    damping() const;

    /**
     * Cundall's damping, a_i -= alpha |f_i| / m_i sign(P_i) with the lumped
     * mass m_i: it takes alpha sum |f_i| |P_i| / m_i out of the kinetic energy
     * of the points per time, with any mass. To damp the force before the solve
     * is the same for a lumped mass; an inverse that is not diagonal amplifies
     * changes of sign from one function to the next.
     */
    void
    damp_acceleration();

    /**
     * What that takes from component @p d of the acceleration of function @p i
     * of this process.
     */
    double
    taken_by_damping(const unsigned int i, const unsigned int d) const;

    /**
     * M field = sum for pairs of them; the fields hold guesses and the values
     * at walls.
     */
    void
    solve(const std::vector<VectorField<dim> *>       &fields,
          const std::vector<const VectorField<dim> *> &sums,
          const std::vector<double>                   &shares = {});

    /**
     * Friction walls change the new velocity and the acceleration.
     */
    void
    add_contact();

    /**
     * The initial energy.
     */
    void
    start_energy();

    /**
     * Work that loads, walls and obstacles do in this step.
     */
    void
    add_work();

    /**
     * Work of Cundall's damping in this step. A kick dt' a adds
     * dt' a . (P + P') / 2 to the kinetic energy of the points, with their
     * momentum P before and P' after it; damping has its part of a in that.
     */
    void
    add_work_of_damping();

    /**
     * Warn, or throw, where energy has come from nothing.
     */
    void
    check_energy();

    /**
     * Warn where much of the bodies is too thin for the exact mass.
     */
    void
    check_fragments();

    /**
     * The fraction of the velocity that FLIP keeps in this step.
     */
    double
    flip_share() const;

    /**
     * Agree on the fastest signal, and on the largest number of cells that a
     * point crosses in a second. Collective.
     */
    void
    find_crossing_rate();

    /**
     * Filter the new velocity, and add what that takes to the acceleration.
     */
    void
    filter_velocity();

    /**
     * One pass over the points of all bodies. Null pointers leave out a part.
     */
    void
    update_points(const VectorField<dim> *acceleration,
                  const VectorField<dim> *velocity,
                  const VectorField<dim> *deformation,
                  const bool              move);

    void
    transport_points();

    /**
     * Points of fluids share their changes of volume.
     */
    void
    share_volume();

    void
    damp_kinetically();

    void
    remember_state();

    /**
     * Collective. Go back to the remembered state and throw where any process
     * has a message, with what time steps depend on if that can be the cause.
     */
    void
    check(const std::string message, const bool with_materials = true);

    const SimulationParameters           &parameters;
    const SimulationCase                  run_case;
    MPI_Comm                              comm;
    DistributedTriangulation<dim>         mesh;
    Walls<dim>                            walls;
    Loads<dim>                            loads;
    std::unique_ptr<GridMass<dim>>        grid_mass;
    ConsistentMass<dim>                  *consistent = nullptr; // if it is one
    std::unique_ptr<FrictionContact<dim>> contact; // consistent mass
    std::unique_ptr<Obstacles<dim>>       obstacles;
    VelocityFilter<dim>                   filter; // consistent mass
    PointTransfer<dim>                    transfer;
    PointTransport<dim>                   transport;
    Reconstruction<dim>                   reconstruction;
    CriticalStep<dim>                     critical_step;
    std::vector<Body<dim>>                all_bodies;
    std::optional<Expression>             step_formula;

    // Points that integrals are summed over.
    std::vector<MaterialPoints<dim>>         reconstructed;
    std::vector<const MaterialPoints<dim> *> summed_points;

    // Fields of the grid. The mass is that of all functions, M v = P.
    VectorType       lumped_mass;
    VectorField<dim> momentum, force;
    VectorField<dim> velocity, acceleration, new_velocity, mapped_velocity;
    VectorField<dim> held_residual;

    // Of the last steps, the latest first.
    std::array<VectorField<dim>, 2> last_accelerations;
    std::array<double, 2>           last_steps{};
    unsigned int                    n_last_accelerations = 0;

    double        t              = 0.;
    double        dt             = 0.; // of the last step
    double        deformation_dt = 0.; // USF: of the deformation
    double        velocity_time  = 0.; // that of the points' velocities
    double        velocity_dt    = 0.;
    double        critical_dt    = 0.;
    double        fastest_signal = 0.;
    double        fastest_wave   = 0.;
    double        estimated_wave = 0.; // that of the last estimate
    double        last_kinetic   = 0.;
    EnergyBalance energy;
    double        warned_gain    = 0.; // of energy
    double        first_signal   = 0.; // fastest in the initial state
    double        crossing_rate  = 0.; // cells per second, of the fastest
    double        time_to_share  = 0.; // since share_volume()
    unsigned int  steps          = 0;
    unsigned int  iterations     = 0;
    std::uint64_t all_iterations = 0;
    std::uint64_t n_all_points = 0, n_all_removed = 0, n_own_sent = 0;
    std::uint64_t n_free_points = 0; // of bodies that feel forces
    std::vector<std::vector<unsigned int>> left_cells; // per body
    std::string                            problem;    // of this process
    std::vector<double>                    estimates;  // of the critical step
    double                                 last_estimate    = 0.;
    unsigned int                           next_estimate    = 0; // step
    unsigned int                           n_between        = 0; // estimates
    bool                                   sums_are_current = false;
    std::vector<std::string>               warnings;
    std::map<std::string, double>          seconds;

    struct Remembered
    {
      double                       t = 0., dt = 0., velocity_time = 0.;
      double                       last_kinetic = 0., velocity_dt = 0.;
      double                       critical_dt    = 0.;
      double                       fastest_signal = 0., crossing_rate = 0.;
      double                       fastest_wave = 0., estimated_wave = 0.;
      unsigned int                 next_estimate = 0, n_between = 0;
      double                       last_estimate = 0.;
      std::vector<double>          estimates;
      EnergyBalance                energy;
      std::uint64_t                n_removed = 0, n_free = 0;
      unsigned int                 steps = 0;
      std::vector<PointsCopy<dim>> points;
    };
    Remembered remembered;
  };
} // namespace greville

#endif
