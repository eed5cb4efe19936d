// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/vector_field.h>
#include <greville/linear_algebra/interleaved_layout.h>
#include <greville/mass/stencil_places.h>
#include <greville/spline/extension.h>

#include <array>
#include <functional>
#include <map>

namespace greville
{
  template <int dim>
  class ExtendedMass;



  /**
   * The *unknowns* of extended B-splines are the coefficients of the stable and
   * the lumped functions. The matrix E computes all coefficients from them (see
   * Extension). Unknowns are numbered without gaps in lexicographic order on
   * each process. Vectors of unknowns are interleaved: entry c of unknown i is
   * at i * width + c.
   *
   * Functions can be constrained to zero column by column (at walls); they are
   * then omitted from the columns of E. E is applied on StencilPlaces. Each
   * image has the row of its function.
   */
  template <int dim>
  class ExtendedUnknowns
  {
  public:
    /// The places are kept by reference.
    void
    reinit(const StencilPlaces<dim> &places);

    /// Collective. Number the unknowns of an extension, kept by reference, if
    /// it has @p changed or is the first one. Returns whether they were
    /// numbered.
    bool
    update(const Extension<dim> &extension, const bool changed);

    /// Collective. Constrain functions: bit c of @p constrained[f] constrains
    /// local function f in the columns c, c + dim, c + 2 dim, ...
    void
    constrain(const std::vector<unsigned char> &constrained);

    /// Return the components in which a function with mass is constrained on
    /// any process.
    const std::array<bool, dim> &
    has_constrained() const;

    /// Return the constrained components (bits) of the owned unknowns.
    std::vector<unsigned char>
    constrained_unknowns() const;

    /// Return the positions of owned unknowns, with zeros beyond @p dim.
    std::vector<std::array<int, 3>>
    unknown_positions() const;

    unsigned int
    n_owned_unknowns() const;

    MPI_Comm
    communicator() const;

    /// Return the places of the unknowns of this process, owned ones first and
    /// in ascending order. Ghost unknowns that only occur in E have
    /// invalid_unsigned_int.
    const std::vector<unsigned int> &
    unknown_places() const;

    /// Return the local numbers of the functions of the owned unknowns.
    const std::vector<unsigned int> &
    unknown_functions() const;

    /// Initialize a vector of @p width columns with the ghosts of multiply().
    template <typename Number>
    void
    initialize_vector(VectorOf<Number> &vector, const unsigned int width) const;

    /// Return the layout. It is the same object until the numbers change.
    const std::shared_ptr<const InterleavedLayout> &
    unknown_layout() const;

    /// Compute y = E^T B E x for @p width columns. @p product(y, x) computes y
    /// = B x for vectors on the places. Constrained entries of x count as zero,
    /// and are zero in y. Ghost entries of x are updated.
    template <typename Number>
    void
    multiply(
      VectorOf<Number>                                    &y,
      VectorOf<Number>                                    &x,
      const unsigned int                                   width,
      const std::function<void(Number *, const Number *)> &product) const;

    /// Call visit(u, E_iu) for the unknowns u of the function at place @p i.
    template <typename Visit>
    void
    for_each_unknown(const unsigned int i, const Visit &visit) const;

    /// Call visit(u, place) for the images of unknowns.
    template <typename Visit>
    void
    for_each_image_of_unknown(const Visit &visit) const;

    /// Copy the entries of unconstrained unknowns from a vector of levels,
    /// which has @p width interleaved components of all owned functions, to a
    /// vector of unknowns. write() copies them back and sets all other entries
    /// to zero.
    void
    read(VectorType        &unknowns,
         const VectorType  &x,
         const unsigned int width) const;

    void
    write(VectorType        &x,
          const VectorType  &unknowns,
          const unsigned int width) const;

    /// Collective. Compute x = E x for a @p component of the space, see
    /// LevelOperator.
    void
    distribute(VectorType &x, const unsigned int component) const;

    /// Collective. Compute x = E^T x for a @p component of the space.
    void
    condense(VectorType &x, const unsigned int component) const;

    /// Compute rows = E^T b for fields b of the space. Component c of field
    /// number k is column k dim + c.
    void
    restrict_fields(VectorType                                  &rows,
                    const std::vector<const VectorField<dim> *> &fields,
                    const unsigned int                           width) const;

    /// Set x to the coefficients of the unknowns in the fields.
    void
    read_fields(VectorType                                  &x,
                const std::vector<const VectorField<dim> *> &fields,
                const unsigned int                           width) const;

    /// Set fields = E x, except at constrained functions. Inactive functions
    /// become zero. The constrained entries of @p x are read from the fields.
    void
    write_fields(const std::vector<VectorField<dim> *> &fields,
                 VectorType                            &x,
                 const unsigned int                     width) const;

    /// Collective. Set the coefficients of extended functions to their values
    /// by E. The sum of the coefficients times @p weights, the lumped mass, is
    /// conserved: the changes of extended functions are subtracted from the
    /// functions on which they depend.
    void
    extend(VectorField<dim> &field, const VectorType &weights) const;

    /// Set the constrained entries of @p x to zero.
    template <typename Number>
    void
    zero_constrained_unknowns(VectorOf<Number>  &x,
                              const unsigned int width) const;

  private:
    friend class ExtendedMass<dim>;

    struct Entry
    {
      unsigned int unknown;
      double       weight;
    };

    /// Collective. Compute rows = E^T b for @p columns b. They belong to the
    /// @p component and the following ones: ..., dim - 1, 0, ...
    /// write_columns() sets columns = E x, except at constrained functions.
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

    /// Compute @p values = E x at the places.
    template <typename Number>
    void
    expand(const Number *x, const unsigned int width, Number *values) const;

    /// Compute y = E^T @p values.
    template <typename Number>
    void
    collect(Number *y, const unsigned int width, const Number *values) const;

    /// Copy a component of a field to the places, with ghost values.
    void
    to_places(const VectorType &component) const;

    template <typename Number>
    void
    zero_constrained(Number *values, const unsigned int width) const;

    /// Call visit(f, place) for the active ones of the first @p n_functions
    /// local functions.
    template <typename Visit>
    void
    for_each_active(const unsigned int n_functions, const Visit &visit) const;

    /// Call visit(f, place) for all places of active local functions, images
    /// last.
    template <typename Visit>
    void
    for_each_active_place(const Visit &visit) const;

    template <typename Visit>
    void
    for_each_active_image(const Visit &visit) const;

    bool
    is_constrained(const unsigned int function,
                   const unsigned int column) const;

    /// Return whether the function at a place is extended and depends on
    /// unknowns that are constrained in a column or not stored on this process.
    bool
    may_extend_constrained(const unsigned int place,
                           const unsigned int column) const;

    unsigned int
    n_owned_functions() const;

    unsigned int              n_owned = 0;
    std::vector<unsigned int> unknowns; // places
    std::vector<unsigned int> owned_unknown_functions;
    std::vector<unsigned int> lumped;   // places, with images
    std::vector<unsigned int> extended; // places, images of all kinds last
    std::vector<std::size_t>  extended_begin;
    std::vector<Entry>        extended_entries;

    // By place: 1 + its unknown, or -1 - its extended function, or 0.
    ZeroedArray<int> signed_numbers;

    std::vector<unsigned char>                          constrained_functions;
    std::vector<std::pair<unsigned int, unsigned char>> constrained_places;
    std::array<bool, dim> component_has_constrained{};
    // True if some, but not all functions are constrained in the component.
    std::array<bool, dim> component_is_partly_constrained{};

    // Work arrays of products. Products in single precision also use the memory
    // of place_y.
    mutable ZeroedArray<double> place_x, place_y;
    mutable ZeroedArray<float>  single_x;
    mutable VectorType          column; // of unknowns

    /// Collective. Number the unknowns and set E.
    void
    number_unknowns();

    /// Set owned unknowns and lumped places. Returns whether unknowns changed.
    bool
    choose_unknowns();

    /// Collective. Append the unknowns of other processes: functions of owned
    /// cells, and functions without places that occur in E. Sets the layout if
    /// numbers change, and returns the numbers of ghosts by position.
    std::map<std::uint64_t, unsigned int>
    number_ghost_unknowns(const std::vector<std::uint64_t> &positions_in_E,
                          const bool                        owned_changed);

    /// Copy the rows of E to the images of their functions.
    void
    add_rows_of_images();

    const StencilPlaces<dim> *stencil   = nullptr;
    const Extension<dim>     *extension = nullptr;

    // True if the unknowns have been numbered on all processes, even if this
    // process has none.
    bool                      is_numbered = false;
    std::vector<unsigned int> extended_functions; // local numbers

    std::shared_ptr<const InterleavedLayout> layout;
    std::vector<std::uint64_t> ghost_positions; // in the order of numbers
  };
} // namespace greville

#include <greville/mass/extended_unknowns.templates.h>
