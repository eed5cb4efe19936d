// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_grid_mass_h
#define greville_steps_grid_mass_h

#include <greville/mass/extended_mass.h>
#include <greville/points/point_transfer.h>
#include <greville/spline/order_hierarchy.h>
#include <greville/steps/constraints.h>

namespace greville
{
  /**
   * The mass of the points on the grid, and its inverse: M x = b for vector
   * fields, with coefficients at walls held. See LumpedMass and ConsistentMass.
   * Coefficients without mass are *inactive*: their x is zero.
   *
   * A function may be constrained along a direction n that is not an axis where
   * the mass is diagonal: then x . n keeps its value, and the part of x across
   * n is that of b / m.
   */
  template <int dim>
  class GridMass
  {
  public:
    virtual ~GridMass() = default;

    const SplineSpace<dim> &
    space() const
    {
      return orders.finest();
    }

    /**
     * The orders that the solver makes use of.
     */
    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /**
     * The name of the solver.
     */
    virtual std::string
    solver() const = 0;

    /**
     * Whether solve() has the inverse of the mass matrix of the points, and
     * not of an approximation, which loses part of what it maps.
     */
    virtual bool
    is_exact() const = 0;

    /**
     * Whether solve() divides by the lumped mass.
     */
    virtual bool
    is_diagonal() const = 0;

    /**
     * Collective. New masses: @p lumped as PointTransfer::points_to_grid()
     * gives it, for these @p bodies, and points of their @p surfaces, which
     * have no mass but bear loads. The list of bodies and the transfer are kept
     * by reference.
     */
    virtual void
    update(const VectorType                               &lumped,
           const std::vector<const MaterialPoints<dim> *> &bodies,
           const std::vector<const MaterialPoints<dim> *> &surfaces,
           const PointTransfer<dim>                       &transfer) = 0;

    /**
     * Collective. Solve M x = b for pairs of fields. On entry the @p x have
     * initial guesses and the values of held coefficients. Right-hand sides
     * need not be solved for where they are below @p shares[k] times the first
     * one (see ExtendedMassSolver::solve()). Throws dealii::ExcMessage where
     * the solver does not converge.
     */
    virtual void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {}) = 0;

    /**
     * Collective. Hold more than walls do, until the next call. Throws
     * dealii::ExcMessage for directions that are not axes where the mass is not
     * diagonal.
     */
    void
    hold(const Constraints<dim> &more);

    /**
     * Collective. Hold what walls do.
     */
    void
    release();

    /**
     * What is free of a vector at the owned function i: without components that
     * are held, and without its part along constrained directions.
     */
    dealii::Tensor<1, dim>
    free_part(const unsigned int i, dealii::Tensor<1, dim> vector) const;

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
     * Whether points of bodies or surfaces see an owned function.
     */
    virtual bool
    is_seen(const unsigned int function) const
    {
      return lumped_mass.local_element(function) > 0.;
    }

    /**
     * Collective. The momentum @p b of points that a velocity @p x, the
     * solution of M x = b, leaves out since it is held, as a velocity: (b - M
     * x)_i / m_i where coefficients are held, its part along constrained
     * directions, and zero elsewhere.
     */
    void
    held_residual(VectorField<dim>       &residual,
                  const VectorField<dim> &b,
                  const VectorField<dim> &x) const;

    /**
     * Collective. What held coefficients give to the momentum: at each of them
     * the row of M x - b for the pair @p k of the last solve(), so that the sum
     * of m_i x_i is that of b_i and of these rows, for all masses. Other
     * entries may have any value.
     */
    virtual void
    rows_of_held(VectorField<dim>       &rows,
                 const VectorField<dim> &x,
                 const VectorField<dim> &b,
                 const unsigned int      k) const = 0;

    /**
     * Collective. Give functions that are no unknowns the coefficients that
     * depend on those of unknowns, see ExtendedMass::extend().
     */
    virtual void
    extend(VectorField<dim> &) const
    {}

    /**
     * Return whether the points determine an owned function: its coefficient
     * does not depend on few points.
     */
    virtual bool
    is_stable(const unsigned int) const
    {
      return true;
    }

    /**
     * Collective. Return the numbers of functions by their class, see
     * Extension.
     */
    virtual typename Extension<dim>::Counts
    counts() const
    {
      return {};
    }

    /**
     * Let windows of cells know which of them reach their neighbours by
     * extended functions. They are kept by reference; null: none.
     */
    virtual void
    set_windows(CellWindows<dim> *)
    {}

    /**
     * Return whether update() changes windows.
     */
    virtual bool
    has_windows() const
    {
      return false;
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
     * Return whether functions with hardly any mass are extended for surfaces
     * in contact, although not for solve(). If so, loads of surfaces are to be
     * condensed, b = E^T b, and they move with distributed velocities, v = E v.
     * E is the matrix of ExtendedUnknowns.
     */
    virtual bool
    extends_surfaces() const
    {
      return false;
    }

    /// Collective.
    virtual void
    condense(VectorField<dim> &) const
    {}

    virtual void
    distribute(VectorField<dim> &) const
    {}

    /**
     * Forget the factorizations of earlier matrices: results then depend on the
     * points alone, to the bit and not only to the tolerance of the solver.
     */
    virtual void
    forget()
    {}

    /**
     * Factorizations so far.
     */
    virtual unsigned int
    n_factorizations() const
    {
      return 0;
    }

    /**
     * Cells of fragments, which have lumped mass. Collective.
     */
    virtual std::uint64_t
    n_fragments() const
    {
      return 0;
    }

    /**
     * Collective. Return the cells of fragments as a fraction of the cells with
     * points.
     */
    virtual double
    fragment_fraction() const
    {
      return 0.;
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

  protected:
    /**
     * Collective. The orders are kept by reference; the walls are not needed
     * afterwards.
     */
    GridMass(const OrderHierarchy<dim> &orders, const Walls<dim> &walls);

    /**
     * What is held has changed. Collective.
     */
    virtual void
    change_held() = 0;

    /**
     * Collective. The rows of M x at functions that are held, for the given
     * components; others may have any value.
     */
    virtual void
    multiply_at_held(VectorField<dim>            &rows,
                     const VectorField<dim>      &x,
                     const std::array<bool, dim> &components) const = 0;

    const OrderHierarchy<dim> &orders;
    // Bits of components, by local function: all that are held, and by walls.
    std::vector<unsigned char> held, wall_held;
    std::vector<ConstrainedDirections<dim>>
                 oblique; // in the order of functions
    VectorType   lumped_mass;
    unsigned int iterations = 0;

  private:
    /**
     * Collective. Hold these components, and the directions.
     */
    void
    set_held(std::vector<unsigned char>              &components,
             std::vector<ConstrainedDirections<dim>> &directions);

    /**
     * Collective. The components in which functions with mass are held.
     */
    std::array<bool, dim>
    held_meet_mass() const;
  };



  /**
   * Collective. Make the mass of the name SchemeParameters::mass. Orders,
   * parameters and walls are kept by reference.
   */
  template <int dim>
  std::unique_ptr<GridMass<dim>>
  make_grid_mass(const OrderHierarchy<dim>  &orders,
                 const SimulationParameters &parameters,
                 const Walls<dim>           &walls);
} // namespace greville

#endif
