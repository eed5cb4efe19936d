// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_comparison_h
#define greville_run_comparison_h

#include <greville/parameters/simulation_parameters.h>
#include <greville/points/body_list.h>
#include <greville/steps/statistics.h>

#include <optional>
#include <tuple>

namespace greville
{
  /**
   * Distance between a run and an exact solution: with sums over points,
   *   l2  = sqrt(sum_p V0_p |u_p - u|^2 / sum_p V0_p |u|^2),
   *   max = max_p |u_p - u| / max_p |u|,
   * relative; absolute (l2 divided by the root of the volume) where the exact
   * solution vanishes.
   */
  struct Errors
  {
    double l2  = 0.;
    double max = 0.;
  };



  /**
   * Those of displacement, velocity and stress; empty where nothing is known.
   */
  struct ExactErrors
  {
    std::optional<Errors> displacement, velocity, stress;
  };



  /**
   * The exact solution of a parameter file.
   */
  template <int dim>
  class ExactSolution
  {
  public:
    /**
     * Throws dealii::ExcMessage for wrong formulas.
     */
    ExactSolution(const ExactParameters &parameters);

    /**
     * Collective. Errors of velocity at time @p t_velocity, of all else at @p
     * t.
     */
    ExactErrors
    errors(const BodyList<dim> &bodies,
           const double         t,
           const double         t_velocity,
           const MPI_Comm       comm) const;

  private:
    VectorExpression<dim>                        displacement, velocity;
    VectorExpression<PointLayout<dim>::n_stress> stress;
  };



  /**
   * Mean and largest distance to measured data, in the unit of the data.
   */
  struct Distance
  {
    double mean    = 0.;
    double largest = 0.;
    /// Number of data that could be compared.
    unsigned int n = 0;
    /// Surface: mean over the mean of the data; series: mean of the relative
    /// distances.
    double relative = 0.;
    /// Surface: front_99 of the run less the largest x of the data, m.
    double front = 0.;
  };



  /**
   * A CSV file with a header and columns of numbers; lines with # are
   * comments. Throws dealii::ExcMessage with file and line where it is wrong.
   */
  std::vector<std::vector<double>>
  read_columns(const std::string &file,
               const std::string &parameter,
               const unsigned int n_columns);



  /**
   * Measured data, read when made, so that a missing file stops a run before it
   * begins.
   */
  template <int dim>
  class MeasuredData
  {
  public:
    MeasuredData(const ReferenceParameters &parameters);

    /**
     * Add a value of the quantity of the series.
     */
    void
    add(const Statistics<dim> &statistics);

    /**
     * What has been added and is needed: times, and values of the quantity.
     * Of those between two neighbouring measured times there are the first and
     * the last at most.
     */
    std::pair<std::vector<double>, std::vector<double>>
    added() const
    {
      return {times, values};
    }

    void
    set_added(const std::pair<std::vector<double>, std::vector<double>> &added)
    {
      std::tie(times, values) = added;
    }

    bool
    has_series() const
    {
      return !series.empty();
    }

    bool
    has_surface() const
    {
      return !surface.empty();
    }

    bool
    has_failure_line() const
    {
      return !failure_line.empty();
    }

    /**
     * |value - measured| at the measured times that the run has reached, in the
     * unit of the values.
     */
    Distance
    series_distance() const;

    /**
     * Collective. Vertical distance (m) between the measured surface and the
     * uppermost point (with half of its size) within half a cell @p h of its x.
     * Where the body has ended, its surface is at the bottom @p floor: the
     * distance to the measured front of @p front_99 says how far that is off.
     */
    Distance
    surface_distance(const BodyList<dim> &bodies,
                     const double         h,
                     const double         floor,
                     const double         front_99,
                     const MPI_Comm       comm) const;

    /**
     * Collective. Mean distance (m) in 2D between the measured failure line and
     * that of the run: the area between them over the length of the measured
     * one. The area is that of the points which were above the line and have
     * not failed, or below and have, where the line has an x.
     */
    double
    failure_line_distance(const BodyList<dim> &bodies,
                          const MPI_Comm       comm) const;

  private:
    const ReferenceParameters        parameters;
    std::vector<std::vector<double>> surface, failure_line, series;
    unsigned int                     quantity = 0;
    std::vector<double>              times, values;
  };
} // namespace greville

#endif
