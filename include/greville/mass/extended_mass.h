// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_extended_mass_h
#define greville_mass_extended_mass_h

#include <greville/linear_algebra/lower_triangle.h>
#include <greville/mass/extended_unknowns.h>

#include <memory>

namespace greville
{
  /**
   * The consistent mass matrix of a body on extended B-splines,
   * @f[
   *   A = E^T \tilde M E, \qquad
   *   \tilde M = M + \sum_{\{i, j\}: i \text{ or } j \text{ lumped}}
   *              M_{ij} (e_i - e_j)(e_i - e_j)^T,
   * @f]
   * with the mass matrix M of its points and the Extension E. In the following
   * M~ is @f$ \tilde M @f$. It does not couple lumped functions, those of
   * fragments, with others, but has the row sums of M: mass and momentum are
   * kept.
   *
   * M~ is stored on the places of a StencilMatrix and applied as such, with E
   * before and @f$ E^T @f$ behind it, so that a step assembles M only. The
   * entries of A are computed where a factorization needs them.
   */
  template <int dim>
  class ExtendedMass
  {
  public:
    ExtendedMass()                     = default;
    ExtendedMass(const ExtendedMass &) = delete;
    ExtendedMass &
    operator=(const ExtendedMass &) = delete;

    /**
     * The space is kept by reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Another matrix with the unknowns of @p other, which has to live as long:
     * what is said to these holds for both.
     */
    void
    reinit(const ExtendedMass &other);

    /**
     * The unknowns and E.
     */
    ExtendedUnknowns<dim> &
    unknowns()
    {
      return *E;
    }

    const ExtendedUnknowns<dim> &
    unknowns() const
    {
      return *E;
    }

    /**
     * The matrix M, to be filled between begin() and finish().
     */
    StencilMatrix<dim> &
    matrix()
    {
      return points_mass;
    }

    const StencilMatrix<dim> &
    matrix() const
    {
      return points_mass;
    }

    /**
     * Collective. Set M to zero. The extension, kept by reference, is that of
     * the points to come; @p changed tells whether it differs from that of the
     * last call.
     */
    void
    begin(const Extension<dim> &extension, const bool changed);

    /**
     * The same for a matrix with the unknowns of another one, whose begin() has
     * come before.
     */
    void
    begin(const bool changed);

    /**
     * M is complete.
     */
    void
    finish();

    /**
     * y = A x, of @p width columns; held entries give and get zero. Ghost
     * entries of x are updated.
     */
    void
    vmult(VectorType &y, VectorType &x, const unsigned int width) const;

    /**
     * Subtract from @p rows what the held coefficients h of the fields, which
     * need not be zero, contribute: E^T M~ (E h).
     */
    void
    subtract_held(VectorType                            &rows,
                  const std::vector<VectorField<dim> *> &fields,
                  const unsigned int                     width) const;

    /**
     * rows = E^T M~ field, component by component, at the functions of the
     * owned unknowns, without what rows of held functions give, as rows of A
     * are; zero elsewhere.
     */
    void
    multiply_field(VectorField<dim> &rows, const VectorField<dim> &field) const;

    /**
     * rows = M~ field at the functions that are held, extended ones too; zero
     * elsewhere.
     */
    void
    multiply_at_held(VectorField<dim>       &rows,
                     const VectorField<dim> &field) const;

    /**
     * Collective. rows = M~ field - b at the functions that are held; zero
     * elsewhere. With what E^T adds of functions that are not held, but
     * extended by such that are: the sum of all entries of M~ field - b is that
     * of rows where A solves for the field.
     */
    void
    rows_of_held(VectorField<dim>       &rows,
                 const VectorField<dim> &field,
                 const VectorField<dim> &b) const;

    /**
     * The entries that this process contributes to A between its unknowns, with
     * the diagonal alone for those that are held in all @p components (bits),
     * and nothing held elsewhere. On one process it is A.
     */
    LowerTriangle
    local_entries(const unsigned int components) const;

    /**
     * Collective. The diagonal of E^T M~ E where E has the columns of unknowns
     * that no extended function depends on, and part of it where one does.
     */
    void
    approximate_diagonal(VectorType &diagonal) const;

  private:
    /**
     * The entry of M~ place_x at a place.
     */
    double
    row(const std::size_t place) const;

    StencilMatrix<dim>                     points_mass;
    std::shared_ptr<ExtendedUnknowns<dim>> E;
  };
} // namespace greville

#endif
