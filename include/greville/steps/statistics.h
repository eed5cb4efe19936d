// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/averaged_contact.h>
#include <greville/geometry/rigid_motion.h>
#include <greville/points/body_list.h>
#include <greville/points/point_transfer.h>
#include <greville/points/row_sums.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// Work since the start, J (2D: J / m). See EnergyBalance.
  struct Work
  {
    double gravity  = 0.;
    double loads    = 0.; // by loads on points
    double walls    = 0.; // by moving walls
    double friction = 0.; // by friction walls
    double damping  = 0.; // Cundall's and kinetic damping
    /// The work of each of Statistics::loads, in their order.
    std::vector<double> surfaces;
    /// The work of contacts by name, on both sides.
    std::map<std::string, double> contacts;
  };



  /// Sums and extremes over the points of a body, see Statistics.
  template <int dim>
  struct BodyStatistics
  {
    std::string            name;
    double                 kinetic     = 0.;
    double                 strain      = 0.;
    double                 dissipation = 0.;
    dealii::Tensor<1, dim> momentum;
    Largest                runout, height;
  };



  /// Sums and extremes over the points of all bodies and processes. Units: kg,
  /// m, s, J; in 2D per metre of thickness.
  template <int dim>
  struct Statistics
  {
    double                 time = 0.;
    double                 step = 0.;
    double                 mass = 0.;
    dealii::Tensor<1, dim> momentum;
    /// The angular momentum about the origin, with APIC including the affine
    /// matrices. In 2D, only the first entry is used.
    dealii::Tensor<1, 3> angular_momentum;
    /// The kinetic energy, with APIC including the affine matrices.
    double                 kinetic       = 0.;
    double                 strain        = 0.;
    double                 dissipation   = 0.;
    double                 gravitational = 0.;
    dealii::Tensor<1, dim> center;
    /// The largest x of a point above Output/Front above, the largest y (both
    /// plus half of the point's size), and the result of runout_quantile().
    Largest       runout, height, runout_99;
    unsigned int  iterations    = 0;
    double        largest_speed = 0.;
    std::uint64_t active        = 0;
    /// The number of cells whose points have no host (consistent mass).
    std::uint64_t fragments = 0;
    std::uint64_t n_points  = 0;
    /// The number of steps repeated with a shorter length, since the start.
    std::uint64_t redone = 0;
    Work          work;
    /// Reactions of walls in implicit steps, which are not among the columns().
    std::array<dealii::Tensor<1, dim>, 2 * dim> reactions;
    /// Loads on surfaces with their forces, N (2D: N / m).
    std::vector<std::pair<std::string, dealii::Tensor<1, dim>>> loads;
    std::vector<std::pair<std::string, ContactResult<dim>>>     contacts;
    std::vector<std::pair<std::string, RigidPosition<dim>>>     rigid_bodies;
    /// The statistics of bodies, which are among the columns() if there are
    /// several.
    std::vector<BodyStatistics<dim>> bodies;

    /// Return the columns of statistics.csv with their names.
    std::vector<std::pair<std::string, double>>
    columns() const;

    /// Return the names, including those for the @p loads on surfaces,
    /// @p contacts, @p rigid_bodies and @p bodies.
    static std::vector<std::string>
    names(const std::vector<std::string> &loads        = {},
          const std::vector<std::string> &bodies       = {},
          const std::vector<std::string> &contacts     = {},
          const std::vector<std::string> &rigid_bodies = {});

    std::vector<double>
    values() const;

    /// Add the statistics of other bodies, with their loads, at the same time.
    /// runout_99 cannot be computed from both values; it becomes the larger
    /// one.
    void
    add(const Statistics &other);
  };

  /// The fraction of the mass that may lie beyond Statistics::runout_99.
  constexpr double mass_beyond_runout = 0.005;

  /// Collective. Add the @p sums over the points of @p bodies to a row that
  /// contains all other quantities. @p gravity is the acceleration for the
  /// potential energy.
  template <int dim>
  void
  add_sums(Statistics<dim>                 &row,
           const std::vector<Body<dim>>    &bodies,
           const std::vector<RowSums<dim>> &sums,
           const dealii::Tensor<1, dim>    &gravity,
           const MPI_Comm                   comm);

  /// Collective. Return the smallest x beyond which at most the fraction
  /// mass_beyond_runout of the mass lies. The mass is the mass of all points
  /// that count for the run-out; the x of a point is its position plus half of
  /// its size. Unlike the outermost point, this quantile does not depend on
  /// single points. @p sums have outer_points() of at least this mass. Points
  /// are not sent: nested histograms of masses find the quantile, each within
  /// one bar of the previous one.
  template <int dim>
  Largest
  runout_quantile(const std::vector<const RowSums<dim> *> &sums,
                  const MPI_Comm                           comm);

  /// Collective. Return the same quantile for all points above @p runout_above.
  template <int dim>
  Largest
  runout_quantile(
    const BodyList<dim> &bodies,
    const MPI_Comm       comm,
    const double         runout_above = std::numeric_limits<double>::lowest());

  /// Collective. Return kinetic and strain energy plus dissipation.
  template <int dim>
  double
  energy_of_bodies(const std::vector<Body<dim>> &bodies,
                   const PointTransfer<dim>     &transfer,
                   const MPI_Comm                comm);

  /// Collective. Return the largest displacement of a point, m.
  template <int dim>
  double
  largest_displacement(const std::vector<Body<dim>> &bodies,
                       const MPI_Comm                comm);
} // namespace greville
