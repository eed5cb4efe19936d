// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_benchmark_mass_problem_h
#define greville_benchmark_mass_problem_h

#include <greville/benchmark/problem_parameters.h>
#include <greville/paper/mass_solver.h>

#include <memory>
#include <string>

namespace greville
{
  /**
   * A mass matrix, a right-hand side M f with the acceleration f, and the error
   * of its solution.
   */
  template <int dim>
  class MassProblem
  {
  public:
    virtual ~MassProblem() = default;

    /**
     * Collective. The mass on all orders; operators are made by a MassSolver.
     */
    virtual std::unique_ptr<MassHierarchy<dim>>
    make_mass(const OrderHierarchy<dim> &orders) = 0;

    /**
     * Collective. For a @p level of make_mass() whose operators are made.
     */
    virtual void
    right_hand_side(VectorType &b, const AssembledMassLevel<dim> &level) = 0;

    /**
     * Collective. The distance of the solution @p x from f in the norm of the
     * mass, relative to f (absolute where f is zero).
     */
    virtual double
    error(const VectorType &x, const AssembledMassLevel<dim> &level) = 0;

    /**
     * Collective. The functions of an order by their class, where B-splines are
     * extended.
     */
    virtual typename Extension<dim>::Counts
    count_functions(const SplineSpace<dim> &space) const = 0;
  };



  /**
   * M_ij = int rho N_i N_j dx, by Gauss quadrature.
   */
  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_density_problem(const ProblemParameters &parameters);

  /**
   * Collective. M_ij = sum_p m_p N_i(x_p) N_j(x_p) of the material points of a
   * body, with extended B-splines where its parameters say so. Parameters and
   * triangulation are kept by reference. @p body is one of those that
   * 'Problem/Points' names, with @p n points per cell and direction.
   */
  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_point_problem(const ProblemParameters       &parameters,
                     const std::string             &body,
                     const unsigned int             n,
                     DistributedTriangulation<dim> &triangulation);
} // namespace greville

#endif
