// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_extended_mass_h
#define greville_mass_extended_mass_h

#include <greville/base/vector_field.h>
#include <greville/linear_algebra/interleaved_layout.h>
#include <greville/linear_algebra/lower_triangle.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/spline/extension.h>

#include <array>

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
   * M~ is the second matrix. Lumped functions, those of fragments, are not
   * coupled with others in M~, which has the row sums of M: mass and momentum
   * are kept.
   *
   * The *unknowns* are the stable and the lumped functions only, numbered
   * without gaps in lexicographic order on each process. Vectors of unknowns
   * are interleaved: entry c of unknown i at i * width + c. M~ lives on the
   * places of a StencilMatrix and is applied as such, with E before and E^T
   * behind, so that a step assembles no more than M. The entries of A are made
   * where a factorization needs them.
   *
   * Functions can be held, column by column, at zero (walls): they are then
   * left out of the columns of E.
   */
  template <int dim>
  class ExtendedMass
  {
  public:
    /**
     * The space is kept by reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

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
     * M is complete.
     */
    void
    finish();

    /**
     * Collective. Hold functions: bit c of @p held[f] holds local function f in
     * the columns c, c + dim, c + 2 dim, ...
     */
    void
    hold(const std::vector<unsigned char> &held);

    /**
     * For each component the first one with the same E: held functions that
     * depend on others which are not held make a difference. The same on all
     * processes.
     */
    const std::array<unsigned int, dim> &
    alike() const
    {
      return first_alike;
    }

    /**
     * Number of calls of hold() so far.
     */
    unsigned int
    n_holds() const
    {
      return hold_counter;
    }

    /**
     * Whether any function that meets mass is held in a component, on any
     * process.
     */
    const std::array<bool, dim> &
    has_held() const
    {
      return component_has_held;
    }

    /**
     * The components (bits) in which the owned unknowns are held.
     */
    std::vector<unsigned char>
    held_unknowns() const;

    /**
     * The positions of the owned unknowns in the lattice of functions, with
     * zeros for directions beyond @p dim.
     */
    std::vector<std::array<int, 3>>
    unknown_positions() const;

    unsigned int
    n_owned_unknowns() const
    {
      return n_owned;
    }

    MPI_Comm
    communicator() const
    {
      return points_mass.space().communicator();
    }

    /**
     * The places of the unknowns of this process, the owned ones first,
     * ascending; invalid_unsigned_int for those of others that only E asks for.
     */
    const std::vector<unsigned int> &
    unknown_places() const
    {
      return unknowns;
    }

    /**
     * Local numbers of the functions of the owned unknowns.
     */
    const std::vector<unsigned int> &
    unknown_functions() const
    {
      return owned_unknown_functions;
    }

    /**
     * The layout of vectors of @p width columns. Ghost entries are those that
     * vmult() needs.
     */
    void
    initialize_vector(VectorType &vector, const unsigned int width) const
    {
      vector.reinit(layout->partitioner(width));
    }

    const std::shared_ptr<const InterleavedLayout> &
    unknown_layout() const
    {
      return layout;
    }

    /**
     * y = A x, of @p width columns; held entries give and get zero. Ghost
     * entries of x are updated.
     */
    void
    vmult(VectorType &y, VectorType &x, const unsigned int width) const;

    /**
     * Collective. values = E x for one column @p x of unknowns, that of
     * component 0: the coefficients of the owned functions of the space.
     */
    void
    distribute(VectorType &values, VectorType &x) const;

    /**
     * Collective. rows = E^T b for one column.
     */
    void
    condense(VectorType &rows, const VectorType &b) const;

    /**
     * rows = E^T b for fields b of the space, one behind the other: component c
     * of field k is column k dim + c.
     */
    void
    restrict_fields(VectorType                                  &rows,
                    const std::vector<const VectorField<dim> *> &fields,
                    const unsigned int                           width) const;

    /**
     * x = the coefficients of the unknowns in the fields.
     */
    void
    read_fields(VectorType                                  &x,
                const std::vector<const VectorField<dim> *> &fields,
                const unsigned int                           width) const;

    /**
     * fields = E x, where they are not held; zero where they are inactive. The
     * held entries of @p x become those of the fields.
     */
    void
    write_fields(const std::vector<VectorField<dim> *> &fields,
                 VectorType                            &x,
                 const unsigned int                     width) const;

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
     * owned unknowns and whatever is held; zero elsewhere.
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
     * Collective. Give extended functions the coefficients that E makes of
     * those of the others. The sum of the coefficients times @p weights, the
     * lumped mass, stays as it is: what an extended function gets is taken from
     * the functions that it depends on.
     */
    void
    extend(VectorField<dim> &field, const VectorType &weights) const;

    /**
     * Set the held entries of @p x to zero.
     */
    void
    zero_held_unknowns(VectorType &x, const unsigned int width) const;

    /**
     * The entries that this process contributes to A between its unknowns, with
     * the diagonal alone for those that are held in all @p components (bits),
     * and nothing held elsewhere. On one process it is A.
     */
    LowerTriangle
    local_entries(const unsigned int components);

    /**
     * Collective. The diagonal of E^T M~ E where E has the columns of unknowns
     * that no extended function depends on, and part of it where one does.
     */
    void
    approximate_diagonal(VectorType &diagonal) const;

  private:
    void
    number_unknowns();

    /**
     * Whether a held function is an extended one that depends on some that are
     * not held, in which components (bits).
     */
    unsigned int
    changes_extension(const unsigned int  place,
                      const unsigned char components) const;

    void
    expand(const double *x, const unsigned int width) const;

    void
    collect(double *y, const unsigned int width) const;

    /**
     * Copy a component of a field to the places, with the ghosts of others.
     */
    void
    to_places(const VectorType &component) const;

    void
    zero_held(double *values, const unsigned int width) const;

    /**
     * Call visit(f, place) for the first local functions that are active.
     */
    template <typename Visit>
    void
    for_each_active(const unsigned int n_functions, const Visit &visit) const;

    /**
     * restrict_fields() and write_fields() for columns.
     */
    void
    restrict_columns(VectorType                            &rows,
                     const std::vector<const VectorType *> &columns,
                     const unsigned int                     width) const;

    void
    write_columns(const std::vector<VectorType *> &columns,
                  VectorType                      &x,
                  const unsigned int               width) const;

    bool
    is_held(const unsigned int function, const unsigned int column) const
    {
      return (held_functions[function] >> (column % dim)) & 1;
    }

    unsigned int
    n_functions() const
    {
      return held_functions.size();
    }

    unsigned int
    n_owned_functions() const
    {
      return points_mass.space().owned_functions().size();
    }

    struct Entry
    {
      unsigned int unknown;
      double       weight;
    };

    const Extension<dim> *extension = nullptr;
    StencilMatrix<dim>    points_mass;

    // Whether the unknowns have been numbered, on all processes; this one may
    // have none of them.
    bool                      is_numbered = false;
    unsigned int              n_owned     = 0;
    std::vector<unsigned int> unknowns; // places
    std::vector<unsigned int> owned_unknown_functions;
    std::vector<unsigned int> extended;           // places
    std::vector<unsigned int> extended_functions; // local numbers
    std::vector<std::size_t>  extended_begin;
    std::vector<Entry>        extended_entries;
    std::vector<unsigned int> lumped; // places

    // By place: 1 + the unknown, or -1 - the extended function, or 0.
    ZeroedArray<int> roles;

    std::vector<unsigned char>                          held_functions;
    std::vector<std::pair<unsigned int, unsigned char>> held_places;
    std::array<bool, dim>                               component_has_held{};
    std::array<unsigned int, dim>                       first_alike{};
    unsigned int                                        hold_counter = 0;

    std::shared_ptr<const InterleavedLayout> layout;

    mutable ZeroedArray<double> place_x, place_y;
  };
} // namespace greville

#endif
