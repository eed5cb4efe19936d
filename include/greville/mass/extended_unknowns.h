// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_extended_unknowns_h
#define greville_mass_extended_unknowns_h

#include <greville/base/vector_field.h>
#include <greville/linear_algebra/interleaved_layout.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/spline/extension.h>

#include <array>
#include <functional>

namespace greville
{
  template <int dim>
  class ExtendedMass;



  /**
   * The *unknowns* of extended B-splines, which are the stable and the lumped
   * functions only, and the matrix E that gives all functions from them (see
   * Extension). Unknowns are numbered without gaps in lexicographic order on
   * each process. Vectors of unknowns are interleaved: entry c of unknown i at
   * i * width + c.
   *
   * Functions can be held, column by column, at zero (walls): they are then
   * left out of the columns of E.
   * E is applied on the places of a StencilMatrix. It has a row for each image,
   * too, which is that of its function.
   */
  template <int dim>
  class ExtendedUnknowns
  {
  public:
    /// The matrix is kept by reference. It is asked for places only.
    void
    reinit(const StencilMatrix<dim> &matrix);

    /**
     * Collective. Number the unknowns of an extension, kept by reference, where
     * it has @p changed or is the first one. Returns whether it did.
     */
    bool
    update(const Extension<dim> &extension, const bool changed);

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
    alike() const;

    /// Number of calls of hold() so far.
    unsigned int
    n_holds() const;

    /// Whether any function with mass is held in a component, anywhere.
    const std::array<bool, dim> &
    has_held() const;

    /// The components (bits) in which the owned unknowns are held.
    std::vector<unsigned char>
    held_unknowns() const;

    /// Positions of owned unknowns in the lattice, zeros beyond @p dim.
    std::vector<std::array<int, 3>>
    unknown_positions() const;

    unsigned int
    n_owned_unknowns() const;

    MPI_Comm
    communicator() const;

    /**
     * The places of the unknowns of this process, the owned ones first,
     * ascending; invalid_unsigned_int for those of others that only E asks for.
     */
    const std::vector<unsigned int> &
    unknown_places() const;

    /// Local numbers of the functions of the owned unknowns.
    const std::vector<unsigned int> &
    unknown_functions() const;

    /// Layout of @p width columns; ghosts are those that multiply() needs.
    void
    initialize_vector(VectorType &vector, const unsigned int width) const;

    const std::shared_ptr<const InterleavedLayout> &
    unknown_layout() const;

    /**
     * y = E^T B E x, of @p width columns, for a matrix B between the places:
     * @p product(y, x) gives y = B x. Held entries give and get zero. Ghost
     * entries of x are updated.
     */
    void
    multiply(
      VectorType                                          &y,
      VectorType                                          &x,
      const unsigned int                                   width,
      const std::function<void(double *, const double *)> &product) const;

    /// Call visit(u, E_iu) for the unknowns u of the function at place @p i.
    template <typename Visit>
    void
    for_each_unknown(const unsigned int i, const Visit &visit) const;

    /// Call visit(u, place) for the images of unknowns.
    template <typename Visit>
    void
    for_each_image_of_unknown(const Visit &visit) const;

    /**
     * Vectors of levels have @p width components of all owned functions,
     * interleaved. Copy the entries at unknowns, where they are not held, to a
     * vector of unknowns, and all of these back; others become zero.
     */
    void
    read(VectorType        &unknowns,
         const VectorType  &x,
         const unsigned int width) const;

    void
    write(VectorType        &x,
          const VectorType  &unknowns,
          const unsigned int width) const;

    /// Collective. See LevelOperator: x = E x for a @p component of the space.
    void
    distribute(VectorType &x, const unsigned int component) const;

    /// Collective. The same with the transpose of E.
    void
    condense(VectorType &x, const unsigned int component) const;

    /**
     * rows = E^T b for fields b of the space, one behind the other: component c
     * of field k is column k dim + c.
     */
    void
    restrict_fields(VectorType                                  &rows,
                    const std::vector<const VectorField<dim> *> &fields,
                    const unsigned int                           width) const;

    /// x = the coefficients of the unknowns in the fields.
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
     * Collective. Give extended functions the coefficients that E makes of
     * those of the others. The sum of the coefficients times @p weights, the
     * lumped mass, stays as it is: what an extended function gets is taken from
     * the functions that it depends on.
     */
    void
    extend(VectorField<dim> &field, const VectorType &weights) const;

    /// Set the held entries of @p x to zero.
    void
    zero_held_unknowns(VectorType &x, const unsigned int width) const;

  private:
    friend class ExtendedMass<dim>;

    struct Entry
    {
      unsigned int unknown;
      double       weight;
    };

    /**
     * Collective. rows = E^T b for @p columns b, of the @p component and those
     * that follow it: ..., dim - 1, 0, ...; columns = E x where not held.
     */
    void
    restrict_columns(VectorType                            &rows,
                     const std::vector<const VectorType *> &columns,
                     const unsigned int                     width,
                     const unsigned int component = 0) const;

    void
    write_columns(const std::vector<VectorType *> &columns,
                  VectorType                      &x,
                  const unsigned int               width,
                  const unsigned int               component = 0) const;

    /// place_x = E x, at all places.
    void
    expand(const double *x, const unsigned int width) const;

    /// y = E^T place_y.
    void
    collect(double *y, const unsigned int width) const;

    /// Copy a component of a field to the places, with the ghosts of others.
    void
    to_places(const VectorType &component) const;

    void
    zero_held(double *values, const unsigned int width) const;

    /// Call visit(f, place) for the first local functions that are active.
    template <typename Visit>
    void
    for_each_active(const unsigned int n_functions, const Visit &visit) const;

    /**
     * Call visit(f, place) for all places of all local functions that are
     * active, those of images last.
     */
    template <typename Visit>
    void
    for_each_active_place(const Visit &visit) const;

    template <typename Visit>
    void
    for_each_active_image(const Visit &visit) const;

    bool
    is_held(const unsigned int function, const unsigned int column) const;

    /**
     * Whether a function at a place is an extended one that depends on unknowns
     * that are held in a column, or on some that this process does not know.
     */
    bool
    may_extend_held(const unsigned int place, const unsigned int column) const;

    unsigned int
    n_owned_functions() const;

    unsigned int              n_owned = 0;
    std::vector<unsigned int> unknowns; // places
    std::vector<unsigned int> owned_unknown_functions;
    std::vector<unsigned int> lumped;   // places, with images
    std::vector<unsigned int> extended; // places, images of all kinds last
    std::vector<std::size_t>  extended_begin;
    std::vector<Entry>        extended_entries;

    // By place: 1 + the unknown, or -1 - the extended function, or 0.
    ZeroedArray<int> roles;

    std::vector<unsigned char>                          held_functions;
    std::vector<std::pair<unsigned int, unsigned char>> held_places;
    std::array<bool, dim>                               component_has_held{};

    mutable ZeroedArray<double> place_x, place_y;
    mutable VectorType          column; // of unknowns

    void
    number_unknowns();

    /**
     * Whether a held function is an extended one that depends on some that are
     * not held, in which components (bits).
     */
    unsigned int
    changes_extension(const unsigned int  place,
                      const unsigned char components) const;

    const StencilMatrix<dim> *places    = nullptr;
    const Extension<dim>     *extension = nullptr;

    // Whether the unknowns have been numbered, on all processes; this one may
    // have none of them.
    bool                          is_numbered = false;
    std::vector<unsigned int>     extended_functions; // local numbers
    std::array<unsigned int, dim> first_alike{};
    unsigned int                  hold_counter = 0;

    std::shared_ptr<const InterleavedLayout> layout;
  };
} // namespace greville

#include <greville/mass/extended_unknowns.templates.h>

#endif
