// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/zeroed_array.h>
#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * A high-order filter for velocities of the grid that keeps explicit steps
   * with the consistent mass stable while points move through the grid.
   *
   * Central differences conserve an energy only as long as the basis functions
   * of the points do not change. Points that cross cells change their basis
   * functions and excite the highest modes of the grid (parametric resonance).
   * Lumped mass and FMPM damp these modes, the exact inverse of the mass matrix
   * does not.
   *
   * The filter acts on jumps of the p-th derivative across the knots. A run s
   * contains p + 2 consecutive coefficients in a grid line. The jump g_s . c is
   * a difference of order p + 1 of the coefficients c of a velocity component.
   * The correction is
   * @f[
   *   z = -\frac{1}{4^{p+1}} M_L^{-1}
   *       \sum_s w_s \, \theta_s \, g_s (g_s \cdot c),
   *   \qquad
   *   \theta_s = \min(1 / dim,
   *              \kappa \Delta t \max_{i \in s} \sum_d |v_{i,d}| / h_d).
   * @f]
   * The sum is over the runs of all lines in all directions. The absolute
   * values of the entries of g_s have the sum 2^(p+1), and w_s is the smallest
   * mass of the functions of a run, so the eigenvalues of c -> z are between -1
   * and 0. theta_s is the strength kappa (five times kappa for p = 1) times the
   * number of cells that a point crosses in the step, with the smallest cells
   * in the supports of the run's functions. Regions at rest are thus not
   * filtered. On uniform knots, each step multiplies a wave of angle k_d per
   * coefficient by
   * @f[ 1 - \theta \sum_d \sin(k_d / 2)^{2 (p + 1)}. @f]
   *
   * The jumps of splines of order p + 1 and of smooth fields are of order
   * h^(p+1), and the jumps of polynomials of order p are zero, so translation,
   * rotation and uniform strain are not affected, and the order p + 1 is
   * preserved. The sum of M_L z is zero: momentum is conserved. Extended
   * functions then take the corrections from the functions on which they
   * depend, see ExtendedMass::extend().
   *
   * The references are @ref Burman2004 "Burman and Hansbo, 2004", for jumps and
   * @ref Fischer2001 "Fischer and Mullen, 2001", for filters.
   */
  template <int dim>
  class VelocityFilter
  {
  public:
    /// Collective. The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// Collective. Set the lumped mass, a vector of the space. Runs that
    /// contain a function without mass are skipped.
    void
    set_mass(const VectorType &lumped);

    /// Collective. Compute the corrections z of all components for the velocity
    /// of a step of length @p dt, as vectors of the space.
    void
    apply(std::array<VectorType, dim>       &z,
          const std::array<VectorType, dim> &velocity,
          const double                       strength,
          const double                       dt) const;

  private:
    /// A grid line of coefficients in direction x. The coefficient number x,
    /// counted from the lower wall of the grid (if x is periodic, from p + 1
    /// functions before it), has the index place + x.
    struct Line
    {
      int begin = 0, end = 0; // empty if equal
      int place = 0;
      // The runs in each direction that begin in the line and have mass.
      std::array<int, dim> first_run{}, end_of_runs{};
    };

    /// Set the lines through @p functions and number their coefficients.
    void
    set_lines(const std::vector<MultiIndex<dim>> &functions);

    Line &
    line_of(const MultiIndex<dim> &i)
    {
      return lines[int(i[1]) - low_y +
                   (dim == 3 ? (int(i[dim - 1]) - low_z) * n_lines_y : 0)];
    }

    /// Copy a vector to the lines, including entries of other processes.
    void
    to_places(const ZeroedArray<double> &values,
              const VectorType          &vector) const;

    /// Return the distance, in lines, of consecutive coefficients in a
    /// direction.
    int
    line_step(const unsigned int direction) const
    {
      return direction == 0 ? 0 : direction == 1 ? 1 : n_lines_y;
    }

    /// Return the index of a line's functions in a direction other than x.
    int
    index_of_line(const unsigned int line, const unsigned int direction) const
    {
      return direction == 1 ? int(line % n_lines_y) + low_y
                            : int(line / n_lines_y) + low_z;
    }

    const SplineSpace<dim> *space = nullptr;

    // The entries of g_s by direction: entry k of all runs, for k from 0 to p +
    // 1, in the order of their first coefficients.
    std::array<std::vector<double>, dim> differences;

    // The size of the smallest cell of each function of a direction.
    std::array<std::vector<double>, dim> cell_sizes;

    // Functions of this process, and functions of others in the same runs.
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partitioner;
    std::vector<unsigned int> function_places; // of owned functions

    // Indices of functions of other processes and of periodic images, with the
    // local numbers of their values in the partitioner.
    std::vector<std::pair<unsigned int, unsigned int>> copies;

    std::vector<Line> lines; // of a box, y first
    int               n_lines_y = 0;
    int               low_y = 0, low_z = 0;
    std::size_t       n_places = 0;

    ZeroedArray<double>                  inverse_mass;
    std::array<ZeroedArray<double>, dim> run_mass; // w, at the first index
    mutable std::vector<double>          jumps, strengths; // of a line
    mutable VectorType                   exchanged;
  };
} // namespace greville
