#ifndef greville_simulation_grid_mass_h
#define greville_simulation_grid_mass_h

#include <greville/multigrid/mass_solver.h>
#include <greville/particles/point_transfer.h>
#include <greville/simulation/walls.h>

namespace greville
{
  /**
   * The mass of the points on the grid, and its inverse: M x = b for vector
   * fields, with coefficients at walls held. M is the consistent mass matrix
   *   M_ij = sum_p m_p N_i(x_p) N_j(x_p),
   * solved by a MassSolver, or its row sums (lumped), or what FMPM makes of
   * both. Components with the same walls share a matrix.
   *
   * Coefficients without mass are *inactive*: their x is zero.
   */
  template <int dim>
  class GridMass
  {
  public:
    /**
     * Collective. Parameters, triangulation and walls are kept by reference.
     * @p mass is a name of SchemeParameters::mass.
     */
    GridMass(const std::string             &mass,
             const unsigned int             degree,
             DistributedTriangulation<dim> &triangulation,
             const SimulationParameters    &parameters,
             const Walls<dim>              &walls);

    const SplineSpace<dim> &
    space() const
    {
      return orders.finest();
    }

    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    bool
    is_lumped() const
    {
      return solver_name == "lumped";
    }

    /**
     * The name of the solver.
     */
    const std::string &
    solver() const
    {
      return solver_name;
    }

    /**
     * Collective. New masses: @p lumped as PointTransfer::points_to_grid()
     * gives it, for these @p bodies.
     */
    void
    update(const VectorType                               &lumped,
           const std::vector<const MaterialPoints<dim> *> &bodies,
           const PointTransfer<dim>                       &transfer);

    /**
     * Collective. Solve M x = b; @p x has the values of held coefficients.
     * Throws dealii::ExcMessage where the solver does not converge.
     */
    void
    solve(VectorField<dim> &x, const VectorField<dim> &b);

    /**
     * Most iterations of a component in the last solve().
     */
    unsigned int
    n_iterations() const
    {
      return iterations;
    }

    /**
     * Active coefficients of all processes. Collective.
     */
    std::uint64_t
    n_active() const;

    const VectorType &
    lumped() const
    {
      return lumped_mass;
    }

  private:
    /**
     * Components that share their constraints.
     */
    struct Group
    {
      std::vector<unsigned int>           components;
      std::unique_ptr<MassHierarchy<dim>> mass;
      std::unique_ptr<MassSolver<dim>>    solver;
    };

    std::string                        solver_name;
    const SimulationParameters        &parameters;
    const Walls<dim>                  &walls;
    OrderHierarchy<dim>                orders;
    std::vector<Group>                 groups;
    std::unique_ptr<MassOperator<dim>> free_mass; // without constraints
    VectorType                         lumped_mass, inverse_lumped;
    VectorField<dim>                   is_free; // lumped: 1, 0 where held
    unsigned int                       iterations = 0;
  };
} // namespace greville

#endif
