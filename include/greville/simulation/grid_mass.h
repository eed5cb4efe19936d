#ifndef greville_simulation_grid_mass_h
#define greville_simulation_grid_mass_h

#include <greville/multigrid/extended_mass_solver.h>
#include <greville/particles/point_transfer.h>
#include <greville/simulation/walls.h>

#include <optional>

namespace greville
{
  /**
   * The mass of the points on the grid, and its inverse: M x = b for vector
   * fields, with coefficients at walls held. M is
   * - consistent: the mass matrix M_ij = sum_p m_p N_i(x_p) N_j(x_p) on
   * extended B-splines, see Extension and ExtendedMass. With the coarsening
   * "auto" all components of the fields are solved together by an
   * ExtendedMassSolver; with others, and for a solver by name, one after the
   * other by MassSolvers, one for each set of walls,
   * - lumped: its row sums M_L, or FMPM's series
   *     x = sum_(j<K) (1 - M_L^-1 M)^j M_L^-1 b,
   *   both on all functions that meet mass.
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
     * Collective. Solve M x = b for pairs of fields. On entry the @p x have
     * initial guesses and the values of held coefficients. Right-hand sides
     * need not be solved for where they are below @p shares[k] times the first
     * one (see ExtendedMassSolver::solve()). Throws dealii::ExcMessage where
     * the solver does not converge.
     */
    void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {});

    /**
     * Collective. The same for one pair, where more coefficients are held: bit
     * c of @p more[i] holds component c of the owned function i. Consistent
     * mass only.
     */
    void
    solve_held(VectorField<dim>                 &x,
               const VectorField<dim>           &b,
               const std::vector<unsigned char> &more);

    /**
     * Collective. Hold more coefficients than walls do, until the next call:
     * bit c of @p more[i] holds component c of the owned function i. Not for
     * solvers by name.
     */
    void
    hold(const std::vector<unsigned char> &more);

    /**
     * Components (bits) that are held of a local function.
     */
    unsigned char
    held_components(const unsigned int function) const
    {
      return held[function];
    }

    unsigned char
    held_by_walls(const unsigned int function) const
    {
      return wall_held[function];
    }

    /**
     * Collective. The momentum @p b of points that a velocity @p x, the
     * solution of M x = b, leaves out since it is held, as a velocity: (b - M
     * x)_i / m_i where coefficients are held, zero elsewhere.
     */
    void
    held_residual(VectorField<dim>       &residual,
                  const VectorField<dim> &b,
                  const VectorField<dim> &x) const;

    /**
     * Collective. The rows of M x at all unknowns, held ones too: what walls
     * have to give. Consistent mass only.
     */
    void
    reactions(VectorField<dim> &rows, const VectorField<dim> &x) const
    {
      extended_mass.multiply_field(rows, x);
    }

    /**
     * Collective. Give the extended functions of a field the coefficients that
     * they depend on, see ExtendedMass::extend(). Consistent mass only.
     */
    void
    extend(VectorField<dim> &field) const
    {
      extended_mass.extend(field, lumped_mass);
    }

    /**
     * Bytes of the Gauss weights of products with the consistent matrix: none
     * where nobody has asked for them.
     */
    std::size_t
    memory_of_product() const
    {
      return product ? product->memory_consumption() : 0;
    }

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

    /**
     * The extended B-splines of a consistent matrix.
     */
    const Extension<dim> &
    extension() const
    {
      return extensions.back();
    }

    /**
     * Cells of fragments. Collective.
     */
    std::uint64_t
    n_fragments() const
    {
      return is_consistent() ? filling.n_fragments() : 0;
    }

    /**
     * Cells of fragments as a fraction of those with points. Collective.
     */
    double
    fragment_fraction() const;

    /**
     * Factorizations so far of the solver of all components.
     */
    unsigned int
    n_factorizations() const
    {
      return solver_of_all ? solver_of_all->n_factorizations() : 0;
    }

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

    void
    prepare_product(const std::vector<const MaterialPoints<dim> *> &bodies,
                    const PointTransfer<dim>                       &transfer);

    /**
     * Collective. The components in which functions with mass are held.
     */
    std::array<bool, dim>
    held_meet_mass() const;

    /**
     * Collective. Bits of owned functions, for all local ones.
     */
    std::vector<unsigned char>
    for_local_functions(const std::vector<unsigned char> &owned) const;

    /**
     * Throw where a solver did not converge.
     */
    void
    check(const SolveResult &result);

    /**
     * Lumped mass and FMPM.
     */
    void
    solve_series(VectorField<dim> &x, const VectorField<dim> &b) const;

    /**
     * By the MassSolvers of the groups.
     */
    SolveResult
    solve_components(const std::vector<VectorField<dim> *>       &x,
                     const std::vector<const VectorField<dim> *> &b);

    /**
     * Classify cells and functions by the points.
     */
    bool
    update_extensions(const std::vector<const MaterialPoints<dim> *> &bodies,
                      const PointTransfer<dim>                       &transfer);

    void
    update_groups(const std::vector<const MaterialPoints<dim> *> &bodies,
                  const PointTransfer<dim>                       &transfer,
                  const bool unknowns_changed);

    unsigned int                fmpm_order = 0; // 1: lumped, 0: a MassSolver
    std::string                 solver_name;
    const SimulationParameters &parameters;
    const Walls<dim>           &walls;
    OrderHierarchy<dim>         orders;
    std::vector<Group>          groups;
    std::vector<double>         filled_part; // of owned cells
    CellFilling<dim>            filling;
    std::vector<Extension<dim>> extensions; // by level
    ExtendedMass<dim>           extended_mass;
    // Bits of components, by local function: all that are held, and by walls.
    std::vector<unsigned char>               held, wall_held;
    std::unique_ptr<ExtendedMassSolver<dim>> solver_of_all;
    std::unique_ptr<ExtendedMassSolver<dim>> solver_of_held; // solve_held()
    bool                                     held_solver_is_behind = true;
    std::optional<DensityWeights<dim>>       product_weights;
    std::unique_ptr<CrossMassOperator<dim>>  product; // without constraints
    VectorType                               lumped_mass, inverse_lumped;
    double                                   total_mass = 0.;
    VectorField<dim>                         is_free; // 1, or 0 where held
    unsigned int                             iterations = 0;
  };
} // namespace greville

#endif
