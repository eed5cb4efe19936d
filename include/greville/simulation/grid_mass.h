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
   * solved by a MassSolver, or its row sums M_L (lumped), or FMPM's series
   *   x = sum_(j<K) (1 - M_L^-1 M)^j M_L^-1 b.
   * Components with the same walls share a matrix. Lumped mass and FMPM have
   * the row sums of the points themselves and so conserve momentum whatever
   * functions see of the body; the matrix of a MassSolver leaves out functions
   * whose diagonal entry is below round-off.
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
      return fmpm_order == 1;
    }

    /**
     * Whether solve() has the inverse of the consistent matrix and not of an
     * approximation.
     */
    bool
    is_consistent() const
    {
      return fmpm_order == 0;
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
     * Collective. b = M x with the consistent matrix, zero where coefficients
     * are held. prepare_product() has to be called after update().
     */
    void
    multiply(VectorField<dim> &b, const VectorField<dim> &x) const;

    /**
     * Collective.
     */
    void
    prepare_product(const std::vector<const MaterialPoints<dim> *> &bodies,
                    const PointTransfer<dim>                       &transfer);

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

    void
    make_groups();

    /**
     * Lumped mass and FMPM.
     */
    void
    solve_series(VectorField<dim> &x, const VectorField<dim> &b) const;

    void
    solve_component(const Group &group, VectorType &x, const VectorType &b);

    unsigned int                fmpm_order = 0; // 1: lumped, 0: a MassSolver
    std::string                 solver_name;
    const SimulationParameters &parameters;
    const Walls<dim>           &walls;
    OrderHierarchy<dim>         orders;
    std::vector<Group>          groups;
    DensityWeights<dim>         product_weights;
    std::unique_ptr<CrossMassOperator<dim>> product; // without constraints
    VectorType                              lumped_mass, inverse_lumped;
    VectorField<dim>                        is_free; // 1, or 0 where held
    unsigned int                            iterations = 0;
  };
} // namespace greville

#endif
