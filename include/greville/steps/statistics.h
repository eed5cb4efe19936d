// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_statistics_h
#define greville_steps_statistics_h

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
  /**
   * Work since the begin, J (2D: J / m). See EnergyBalance.
   */
  struct Work
  {
    double gravity  = 0.;
    double loads    = 0.; // on points
    double walls    = 0.; // that move
    double friction = 0.; // of friction walls
    double damping  = 0.; // Cundall's and kinetic
    /// In the order of Statistics::loads.
    std::vector<double> surfaces;
    /// By name, on both sides.
    std::map<std::string, double> contacts;
  };



  /**
   * Sums and extremes over the points of a body, see Statistics.
   */
  template <int dim>
  struct BodyStatistics
  {
    std::string            name;
    double                 kinetic     = 0.;
    double                 strain      = 0.;
    double                 dissipation = 0.;
    dealii::Tensor<1, dim> momentum;
    Largest                front, height;
  };



  /**
   * Sums and extremes over the points of all bodies and processes. Units: kg,
   * m, s, J; in 2D per metre of thickness.
   */
  template <int dim>
  struct Statistics
  {
    double                 time = 0.;
    double                 step = 0.;
    double                 mass = 0.;
    dealii::Tensor<1, dim> momentum;
    /// About the origin; with APIC including that of the affine matrices. In 2D
    /// the first entry.
    dealii::Tensor<1, 3> angular_momentum;
    /// With APIC including that of the affine matrices.
    double                 kinetic       = 0.;
    double                 strain        = 0.;
    double                 dissipation   = 0.;
    double                 gravitational = 0.;
    dealii::Tensor<1, dim> center;
    /// Largest x of a point above Output/Front above, and largest y, with half
    /// of its size; what front_quantile() gives.
    Largest       front, height, front_99;
    unsigned int  iterations    = 0;
    double        largest_speed = 0.;
    std::uint64_t active        = 0;
    /// Cells whose points see no well-filled cell (consistent mass).
    std::uint64_t fragments = 0;
    std::uint64_t n_points  = 0;
    /// Steps that have been done again with a shorter length, since the begin.
    std::uint64_t redone = 0;
    Work          work;
    /// Of walls in implicit steps. These are not among the columns().
    std::array<dealii::Tensor<1, dim>, 2 * dim> reactions;
    /// Loads on surfaces with their forces, N (2D: N / m).
    std::vector<std::pair<std::string, dealii::Tensor<1, dim>>> loads;
    std::vector<std::pair<std::string, ContactResult<dim>>>     contacts;
    std::vector<std::pair<std::string, RigidPosition<dim>>>     rigid_bodies;
    /// Among the columns() where there are several.
    std::vector<BodyStatistics<dim>> bodies;

    /**
     * The columns of statistics.csv with their names.
     */
    std::vector<std::pair<std::string, double>>
    columns() const;

    /**
     * The names, with those of the @p loads on surfaces, of @p contacts, of @p
     * rigid_bodies, and of the @p bodies.
     */
    static std::vector<std::string>
    names(const std::vector<std::string> &loads        = {},
          const std::vector<std::string> &bodies       = {},
          const std::vector<std::string> &contacts     = {},
          const std::vector<std::string> &rigid_bodies = {});

    std::vector<double>
    values() const;

    /**
     * Add those of other bodies, with their loads, at the same time. Of
     * front_99, which does not follow from those of parts, the larger one is
     * kept.
     */
    void
    add(const Statistics &other);
  };

  /**
   * The part of the mass that may lie beyond Statistics::front_99.
   */
  constexpr double beyond_front = 0.005;

  /**
   * Collective. Add what @p sums over the points of @p bodies give to a row,
   * which knows the rest. @p gravity is the acceleration of the potential
   * energy.
   */
  template <int dim>
  void
  add_sums(Statistics<dim>                 &row,
           const std::vector<Body<dim>>    &bodies,
           const std::vector<RowSums<dim>> &sums,
           const dealii::Tensor<1, dim>    &gravity,
           const MPI_Comm                   comm);

  /**
   * Collective. The smallest x beyond which there is no more than beyond_front
   * of the mass of all points that count for fronts, where x of a point is its
   * position with half of its size. Unlike the outermost point it does not
   * follow single points. @p sums have outer_points() of at least this mass.
   * Each process keeps its own points: histograms of masses, each within one
   * bar of the one before, find the point.
   */
  template <int dim>
  Largest
  front_quantile(const std::vector<const RowSums<dim> *> &sums,
                 const MPI_Comm                           comm);

  /**
   * Collective. Of all points above @p front_above.
   */
  template <int dim>
  Largest
  front_quantile(
    const BodyList<dim> &bodies,
    const MPI_Comm       comm,
    const double         front_above = std::numeric_limits<double>::lowest());

  /**
   * Collective. Kinetic and strain energy and dissipation of the bodies: what
   * EnergyBalance watches.
   */
  template <int dim>
  double
  energy_of_bodies(const std::vector<Body<dim>> &bodies,
                   const PointTransfer<dim>     &transfer,
                   const MPI_Comm                comm);

  /**
   * Collective. The largest distance of a point of these bodies from its
   * initial position, m.
   */
  template <int dim>
  double
  largest_displacement(const std::vector<Body<dim>> &bodies,
                       const MPI_Comm                comm);
} // namespace greville

#endif
