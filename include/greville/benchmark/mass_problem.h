// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_benchmark_mass_problem_h
#define greville_benchmark_mass_problem_h

#include <greville/multigrid/mass_solver.h>

#include <memory>
#include <string>

namespace greville
{
  /**
   * The body: a box, its density or its material points, and its acceleration.
   */
  struct MassProblemParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /**
     * Check what the patterns of the parameters cannot.
     */
    void
    check(const unsigned int dim) const;

    std::vector<double>       lower        = {0., 0., 0.};
    std::vector<double>       upper        = {1., 1., 1.};
    std::vector<unsigned int> cell_ratio   = {1, 1, 1};
    std::string               density      = "1";
    std::string               acceleration = "-9.81";
    std::vector<std::string>  bodies;
    std::vector<unsigned int> points_per_direction = {2};
    double                    jitter               = 0.5;
    double                    filling_threshold    = 0.45;
    bool                      extend               = true;
  };



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
    right_hand_side(VectorType &b, const MassLevel<dim> &level) = 0;

    /**
     * Collective. The distance of the solution @p x from f in the norm of the
     * mass, relative to f (absolute where f is zero).
     */
    virtual double
    error(const VectorType &x, const MassLevel<dim> &level) = 0;

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
  make_density_problem(const MassProblemParameters &parameters);

  /**
   * Collective. M_ij = sum_p m_p N_i(x_p) N_j(x_p) of the material points of a
   * body, with extended B-splines where its parameters say so. Parameters and
   * triangulation are kept by reference. @p body is one of those that
   * 'Problem/Points' names, with @p n points per cell and direction.
   */
  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_point_problem(const MassProblemParameters   &parameters,
                     const std::string             &body,
                     const unsigned int             n,
                     DistributedTriangulation<dim> &triangulation);
} // namespace greville

#endif
