// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>
#include <greville/steps/statistics.h>

#include <optional>

namespace greville
{
  /**
   * Relative distance between a run and an exact solution, with sums over
   * points:
   *   l2  = sqrt(sum_p V0_p |u_p - u|^2 / sum_p V0_p |u|^2),
   *   max = max_p |u_p - u| / max_p |u|,
   * If the exact solution vanishes, the errors are absolute, and l2 is divided
   * by the root of the volume.
   */
  struct Errors
  {
    double l2  = 0.;
    double max = 0.;
  };



  /// Errors of displacement, velocity and stress; empty if the exact solution
  /// is not known.
  struct ExactErrors
  {
    std::optional<Errors> displacement, velocity, stress;
  };



  /// The exact solution of a parameter file.
  template <int dim>
  class ExactSolution
  {
  public:
    /// Throws dealii::ExcMessage for wrong formulas.
    ExactSolution(const ExactParameters &parameters);

    /// Collective. Return the errors of velocity at time @p t_velocity and of
    /// displacement and stress at @p t.
    ExactErrors
    errors(const BodyList<dim> &bodies,
           const double         t,
           const double         t_velocity,
           const MPI_Comm       comm) const;

  private:
    VectorExpression<dim>                        displacement, velocity;
    VectorExpression<PointLayout<dim>::n_stress> stress;
  };



  /// Throw dealii::ExcMessage if a file of measured data is missing, or if the
  /// quantity of a series is no column of statistics.csv. The Python module
  /// greville.measured compares the data with the results.
  template <int dim>
  void
  check_reference(const ReferenceParameters &parameters);
} // namespace greville
