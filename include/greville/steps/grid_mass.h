// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/constraints.h>

namespace greville
{
  /**
   * Base class of the mass of the points on the grid and its inverse: M x = b
   * for vector fields, with constrained coefficients at walls. See LumpedMass
   * and ConsistentMass. Coefficients without mass are *inactive*: their x is
   * zero.
   *
   * If the mass is diagonal, a function may be constrained along a direction n
   * that is not an axis: x . n then keeps its value, and x equals b / m in
   * other directions.
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

    /// Return the orders that the solver uses.
    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /// Return the name of the solver.
    virtual std::string
    solver() const = 0;

    /// Return whether solve() applies the exact inverse of the points' mass
    /// matrix, and not an approximation, which loses part of the mapped field.
    virtual bool
    is_exact() const = 0;

    /// Return whether solve() divides by the lumped mass.
    virtual bool
    is_diagonal() const = 0;

    /// Return the memory for the filled parts of cells that update() needs,
    /// null if it needs none. PointTransfer::points_to_grid() must fill it
    /// before.
    virtual std::vector<double> *
    filled_parts()
    {
      return nullptr;
    }

    /// Collective. Set new masses: @p lumped from
    /// PointTransfer::points_to_grid() for these @p bodies. The points of their
    /// @p surfaces have no mass but bear loads. The list of bodies and the
    /// transfer are kept by reference.
    virtual void
    update(const VectorType                               &lumped,
           const std::vector<const MaterialPoints<dim> *> &bodies,
           const std::vector<const MaterialPoints<dim> *> &surfaces,
           const PointTransfer<dim>                       &transfer) = 0;

    /// Collective. Solve M x = b for pairs of fields. On entry, @p x contains
    /// initial guesses and the values of constrained coefficients. A right-hand
    /// side below @p shares[k] times the first one need not be solved for (see
    /// ExtendedMassSolver::solve()). Throws dealii::ExcMessage if the solver
    /// does not converge.
    virtual void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {}) = 0;

    /// Collective. Set constraints in addition to walls, in place of earlier
    /// ones. Throws dealii::ExcMessage for directions that are not axes unless
    /// the mass is diagonal.
    void
    constrain(const Constraints<dim> &more);

    /// Collective. Keep only the constraints of walls.
    void
    release();

    /// Return a vector at the owned function i without its constrained
    /// components, and without its part along constrained directions.
    dealii::Tensor<1, dim>
    free_part(const unsigned int i, dealii::Tensor<1, dim> vector) const;

    /// Return the constrained components (bits) of a local function.
    unsigned char
    constrained_components(const unsigned int function) const
    {
      return constrained[function];
    }

    unsigned char
    constrained_by_walls(const unsigned int function) const
    {
      return wall_constrained[function];
    }

    /// Return whether an owned function has points of bodies or surfaces.
    virtual bool
    has_points(const unsigned int function) const
    {
      return lumped_mass.local_element(function) > 0.;
    }

    /// Collective. Compute, as a velocity, the part of the momentum @p b of
    /// points that the solution @p x of M x = b does not represent because of
    /// constraints. At constrained coefficients, this is (b - M x)_i / m_i, or
    /// its part along constrained directions; elsewhere, it is zero.
    void
    constrained_residual(VectorField<dim>       &residual,
                         const VectorField<dim> &b,
                         const VectorField<dim> &x) const;

    /// Collective. Compute the momentum that constraints supply: at constrained
    /// coefficients, the rows of M x - b for the pair @p k of the last solve().
    /// For all masses, the sum of m_i x_i is then the sum of b_i and of these
    /// rows. Other entries may have any value.
    virtual void
    constrained_rows(VectorField<dim>       &rows,
                     const VectorField<dim> &x,
                     const VectorField<dim> &b,
                     const unsigned int      k) const = 0;

    /// Collective. Set coefficients of extended functions, see ExtendedMass.
    virtual void
    extend(VectorField<dim> &) const
    {}

    /// Return whether enough points determine the coefficient of an owned
    /// function.
    virtual bool
    is_stable(const unsigned int) const
    {
      return true;
    }

    /// Collective. Return the numbers of functions by class, see Extension.
    virtual typename Extension<dim>::Counts
    counts() const
    {
      return {};
    }

    /// Set the windows of cells, kept by reference; null for none. update()
    /// stores there which cells reach their neighbours by extended functions.
    virtual void
    set_windows(CellWindows<dim> *)
    {}

    /// Return whether update() changes windows.
    virtual bool
    has_windows() const
    {
      return false;
    }

    /// Return the largest number of iterations in the last solve().
    unsigned int
    n_iterations() const
    {
      return iterations;
    }

    /// Return whether functions with hardly any mass are extended for surfaces
    /// in contact, although solve() does not extend them. If so, loads of
    /// surfaces must be condensed, b = E^T b, and surfaces move with extended
    /// velocities, v = E v, with the matrix E of ExtendedUnknowns.
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

    /// Collective. In a refined grid with a lumped mass, replace sums over the
    /// functions of levels by the sums over the functions of the space,
    /// x = E^T x with the matrix E that joins the levels (see Extension). All
    /// later sums belong to these functions, and solve() needs them.
    virtual void
    condense_levels(VectorField<dim> &) const
    {}

    /// Collective. The same for the lumped mass and the momentum of bodies,
    /// whose affine velocities then refer to the functions of the space, too.
    virtual void
    condense_levels(VectorType &,
                    VectorField<dim> &,
                    const std::vector<const MaterialPoints<dim> *> &,
                    PointTransfer<dim> &) const
    {}

    /// Collective. The inverse: compute the coefficients of all functions of
    /// levels, x = E x.
    virtual void
    distribute_levels(VectorField<dim> &) const
    {}

    /// Forget the factorizations of earlier matrices. Results then depend on
    /// the points bitwise, not only within the solver's tolerance.
    virtual void
    forget()
    {}

    /// Return the number of factorizations so far.
    virtual unsigned int
    n_factorizations() const
    {
      return 0;
    }

    /// Collective. Return the number of cells in fragments (lumped mass).
    virtual std::uint64_t
    n_fragments() const
    {
      return 0;
    }

    /// Collective. Return n_fragments() over the number of cells with points.
    virtual double
    fragment_fraction() const
    {
      return 0.;
    }

    /// Collective. Return the number of active coefficients on all processes.
    std::uint64_t
    n_active() const;

    const VectorType &
    lumped() const
    {
      return lumped_mass;
    }

  protected:
    /// Collective. The orders are kept by reference; the walls are not needed
    /// afterwards.
    GridMass(const OrderHierarchy<dim> &orders, const Walls<dim> &walls);

    /// Collective. Update after a change of the constraints.
    virtual void
    update_constrained() = 0;

    /// Collective. Compute the rows of M x at constrained functions, for the
    /// given components; other entries may have any value.
    virtual void
    multiply_constrained_rows(
      VectorField<dim>            &rows,
      const VectorField<dim>      &x,
      const std::array<bool, dim> &components) const = 0;

    const OrderHierarchy<dim> &orders;
    // Bits of components, by local function: all constraints, and constraints
    // by walls.
    std::vector<unsigned char> constrained, wall_constrained;
    std::vector<ConstrainedDirections<dim>>
                 oblique; // in the order of functions
    VectorType   lumped_mass;
    unsigned int iterations = 0;

  private:
    /// Collective. Set the constraints of components and directions.
    void
    set_constrained(std::vector<unsigned char>              &components,
                    std::vector<ConstrainedDirections<dim>> &directions);

    /// Collective. Return the components of constrained functions with mass.
    std::array<bool, dim>
    constrained_components_with_mass() const;
  };



  /// Collective. Make the mass named SchemeParameters::mass. Orders, parameters
  /// and walls are kept by reference.
  template <int dim>
  std::unique_ptr<GridMass<dim>>
  make_grid_mass(const OrderHierarchy<dim>  &orders,
                 const SimulationParameters &parameters,
                 const Walls<dim>           &walls);
} // namespace greville
