// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/row_variants.h>
#include <greville/mass/extended_unknowns.h>
#include <greville/mass/stencil_matrix.h>

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
   * with the mass matrix M of its points and the Extension E. In the following,
   * M~ denotes @f$ \tilde M @f$. M~ does not couple the lumped functions of
   * fragments with other functions, but has the row sums of M, so that mass and
   * momentum are conserved.
   *
   * M~ is stored as a StencilMatrix, and A is applied as the product of the
   * three matrices, so that a step assembles M only. The entries of A are
   * computed only for factorizations.
   */
  template <int dim>
  class ExtendedMass
  {
  public:
    ExtendedMass()                     = default;
    ExtendedMass(const ExtendedMass &) = delete;
    ExtendedMass &
    operator=(const ExtendedMass &) = delete;

    /// The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// Set up another matrix with the unknowns of @p other, which must outlive
    /// it. Calls on these unknowns affect both matrices.
    void
    reinit(const ExtendedMass &other);

    /// Return the unknowns and E.
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

    /// Return the matrix M, to be filled between begin() and finish().
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

    /// Collective. Set M to zero. The @p extension, kept by reference, must
    /// belong to the points to be added; @p changed says whether it differs
    /// from the last call.
    void
    begin(const Extension<dim> &extension, const bool changed);

    /// Set M to zero, for a matrix that shares the unknowns of another matrix.
    /// Call begin() of the other matrix first.
    void
    begin(const bool changed);

    /// Finish M after all points have been added.
    void
    finish();

    /// Compute y = A x for @p width columns; constrained entries count as zero
    /// in x, and are zero in y. Ghost entries of x are updated. In single
    /// precision, y = A / unit x with the unit of StencilMatrix::make_single().
    template <typename Number>
    void
    vmult(VectorOf<Number>  &y,
          VectorOf<Number>  &x,
          const unsigned int width) const
    {
      E->template multiply<Number>(y,
                                   x,
                                   width,
                                   [&](Number *to, const Number *from) {
                                     points_mass.vmult(to, from, width);
                                   });
    }

    /// Subtract from @p rows the product E^T M~ E h for the constrained
    /// coefficients h of the fields, which may be nonzero.
    void
    subtract_constrained(VectorType                            &rows,
                         const std::vector<VectorField<dim> *> &fields,
                         const unsigned int                     width) const;

    /// Compute rows = E^T M~ field, component by component, as a vector of
    /// unknowns. Rows of M~ at constrained functions do not contribute, as in
    /// A.
    void
    multiply_field(VectorType &rows, const VectorField<dim> &field) const;

    /// Compute rows = M~ field at constrained functions, including extended
    /// ones; zero elsewhere.
    void
    multiply_constrained_rows(VectorField<dim>       &rows,
                              const VectorField<dim> &field) const;

    /// Collective. Compute rows = M~ field - b at the constrained functions;
    /// zero elsewhere. The rows include the contribution, by E^T, of
    /// unconstrained functions that depend on constrained unknowns. If the
    /// field solves the system with A, the sum of the rows is the sum of all
    /// entries of M~ field - b.
    void
    constrained_rows(VectorField<dim>       &rows,
                     const VectorField<dim> &field,
                     const VectorField<dim> &b) const;

    /// Return this process' contribution to the entries of A between its
    /// unknowns. Unknowns that are constrained in all @p components (bits) have
    /// only a diagonal entry; unknowns that are constrained in some components
    /// are treated as free. On one process, the result is A without the entries
    /// of M~ beyond @p reach, see StencilMatrix::for_each_entry().
    UpperTriangle
    local_entries(const unsigned int components, const int reach) const;

    /// The same with all entries.
    UpperTriangle
    local_entries(const unsigned int components) const;

    /// Collective. Return the rows of A that differ between components. They
    /// differ if the unknown, or an extended function that depends on it, is
    /// constrained in some components only. Variant 0 has the local_entries()
    /// of all components.
    RowVariants
    row_variants(const int reach) const;

    /// Collective. Approximate the diagonal of E^T M~ E. Entries of unknowns on
    /// which no extended function depends are exact, other entries are
    /// incomplete.
    void
    approximate_diagonal(VectorType &diagonal) const;

  private:
    class EntrySums;

    /// Collective. Return, for each local unknown, whether its row differs.
    std::vector<unsigned char>
    rows_that_differ(const int reach) const;

    /// Return the entry of the product M~ place_x at a place.
    double
    row(const std::size_t place) const;

    StencilMatrix<dim>                     points_mass;
    std::shared_ptr<ExtendedUnknowns<dim>> E;
  };
} // namespace greville
