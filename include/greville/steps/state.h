// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/rigid_motion.h>
#include <greville/points/point_transfer.h>
#include <greville/points/points_copy.h>
#include <greville/points/surface.h>
#include <greville/steps/energy_balance.h>
#include <greville/steps/partition.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace greville
{
  /// The largest speeds on all processes, on which the step length depends.
  struct Signals
  {
    /// The largest c + |v|, with the speed c of pressure waves, m / s.
    double fastest = 0.;
    /// The largest speed c of pressure waves, m / s.
    double wave = 0.;
    /// The number of cells that a point crosses per second.
    double crossing_rate = 0.;
  };



  /// The mode of the highest frequency. The next estimate of the critical step
  /// begins with it.
  template <int dim>
  struct HighestMode
  {
    bool             is_known = false;
    VectorField<dim> force;
    double           step = 0.; // critical step, s
  };



  /// Estimates of the critical step.
  struct StepEstimates
  {
    /// The smallest of the last estimates, s.
    double              critical = 0.;
    std::vector<double> last;
    /// The number of the step before which the next estimate is due, and the
    /// number of steps between estimates.
    unsigned int next = 0, n_between = 0;
    /// Signals::wave at the last estimate.
    double wave = 0.;
    /// The first automatic step of the stage, s.
    double first_step = 0.;
  };



  /// The accelerations of the grid in the last two steps, and the lengths of
  /// these steps, the latest first.
  template <int dim>
  struct AccelerationHistory
  {
    std::array<VectorField<dim>, 2> accelerations;
    std::array<double, 2>           steps{};
    unsigned int                    n = 0;
  };



  /// The data of a velocity field of the grid that a step passes to the next
  /// one, see GridField.
  template <int dim>
  struct FieldState
  {
    /// Coefficients after the last step: guesses for the next one.
    VectorField<dim> velocity, acceleration;

    AccelerationHistory<dim> history;
    HighestMode<dim>         mode;
  };



  /// The position of a rigid body, now and at the start of the last step.
  template <int dim>
  struct RigidBodyState
  {
    RigidPosition<dim> now, before;
  };



  /// The data that a step changes, besides the bodies.
  template <int dim>
  struct StateWithoutBodies
  {
    /// The time t, and the time to which velocities belong, s.
    double time = 0., velocity_time = 0.;
    /// The lengths of the last step in time and in velocity_time, s.
    double step = 0., velocity_step = 0.;

    /// The stage, see SimulationParameters::stages.
    unsigned int stage = 0;

    unsigned int  n_steps   = 0;
    std::uint64_t n_removed = 0; // points removed outside the grid
    std::uint64_t n_points  = 0; // points in the grid, of all processes
    std::uint64_t n_sent    = 0; // points that left this process

    /// largest_displacement() of the points, m, if 'Time/Largest displacement'
    /// requires it, otherwise 0.
    double displacement = 0.;

    /// The initial mass of the points, the mass removed before the last step,
    /// and the mass removed in it, kg (2D: kg / m).
    double mass = 0., removed_mass = 0., mass_removed_last = 0.;

    /// The largest number of iterations of a solve in the last step, and the
    /// sum over all solves.
    unsigned int  n_iterations     = 0;
    std::uint64_t n_all_iterations = 0;

    /// The number of rejections of the current step, and of all steps so far.
    unsigned int  n_rejections     = 0;
    std::uint64_t n_all_rejections = 0;

    /// For implicit steps: the fraction of the given step that is tried.
    double step_fraction = 1.;

    FieldState<dim> field;

    /// The states of GeneralParameters::rigid_bodies, the same in all parts of
    /// CoupledSimulations.
    std::vector<RigidBodyState<dim>> rigid_bodies;

    Signals       signals;
    double        first_signal = 0.; // Signals::fastest initially
    StepEstimates estimates;
    EnergyBalance energy;

    /// Forces of walls on the bodies in the last step, the share of this
    /// process, N (2D: N / m). A force is the momentum transferred in a step of
    /// velocities, divided by its length.
    std::array<dealii::Tensor<1, dim>, 2 * dim> reactions;

    /// Volumes of pore water since the start, the share of this process, m^3
    /// (2D: m^2): the inflow to the pores; and the outflow through all
    /// boundaries, through each wall, each surface, and the free surface.
    std::vector<double> water;
    /// The volumes of water in the last step, and its length, s; 0 if the last
    /// step belongs to another stage.
    std::vector<double> water_of_step;
    double              water_step = 0.;

    /// The distribution of cells among processes, the number of
    /// redistributions, and the imbalance() after the last one.
    std::shared_ptr<const Partition> partition;
    unsigned int                     n_partitions = 0;
    double                           imbalance    = 1.;

    /// For grids that change: the numbers of changes and of divided points, and
    /// whether 'Grid/Most cells' has been reached.
    unsigned int  n_adaptations = 0;
    std::uint64_t n_divided     = 0;
    bool          is_limited    = false;

    double warned_gain   = 0.; // of energy
    double time_to_share = 0.; // since share_volume()
  };



  /**
   * The state of a simulation between two steps, as a value. A copy can be
   * restored (exactly, on the same processes) or be used to try a step.
   *
   * All other data follow from the state (sums over the points), or change
   * results only within the tolerance of solvers (factorizations).
   */
  template <int dim>
  struct State : StateWithoutBodies<dim>
  {
    std::vector<Body<dim>> bodies;
    /// One surface for each of SurfaceLoads, in its order.
    std::vector<Surface<dim>> surfaces;

    /// A number that identifies positions and velocities of points. Sums over
    /// the points belong to a version. Copies of the state share it.
    std::uint64_t points_version = 0;

    /// Set a new version, to be called after points have been moved or kicked.
    void
    points_have_changed()
    {
      static std::atomic<std::uint64_t> last{0};
      points_version = ++last;
    }
  };



  /// Call @p action for the points of all bodies and surfaces of a state.
  template <typename StateType, typename Action>
  void
  for_all_points(StateType &state, const Action &action)
  {
    for (auto &body : state.bodies)
      action(body.points);
    for (auto &surface : state.surfaces)
      action(surface.points);
  }
} // namespace greville
