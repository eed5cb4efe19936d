// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/full_matrix.h>

#include <greville/mass/density_weights.h>
#include <greville/mass/stencil_places.h>

namespace greville
{
  /**
   * The part of a matrix @f$ M_{ij} @f$ that the cells of this process
   * contribute, for functions with @f$ |i_d - j_d| \le p @f$ in each direction;
   * the mass matrix is the sum over all processes. The matrix is symmetric in
   * each direction separately, as are sums @f$ \sum_p m_p N_i(x_p) N_j(x_p) @f$
   * over products of splines: @f$ M_{ij} @f$ depends on @f$ \min(i_d, j_d) @f$
   * and @f$ |i_d - j_d| @f$ only. The row of the function min(i, j) stores
   * these @f$ (p + 1)^\text{dim} @f$ entries, without column numbers. Another
   * symmetric matrix loses the part that is antisymmetric in a direction: its
   * entries that share a number are replaced by their mean.
   *
   * Vectors are on StencilPlaces. Each line stores the entries from its first
   * row to its last one, so that the matrix needs little more memory than its
   * rows. In periodic directions the matrix is @f$ P^T B P @f$ with the stored
   * matrix B, where P gives images the value of their function.
   */
  template <int dim>
  class StencilMatrix : public StencilPlaces<dim>
  {
  public:
    /// The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// The entries of a line of functions of a cell: begin[k * stride + x * (p
    /// + 1) + dx] couples function x = 0, 1, ... of the line with the function
    /// at the distance dx = 0, ..., p in line k = dy + dz (p + 1).
    struct CellLine
    {
      double     *begin;
      std::size_t stride;
    };

    /// Set the n^(dim - 1) lines of a cell, n = p + 1, whose functions have
    /// rows.
    template <int n>
    void
    find_lines(const unsigned int cell, CellLine *lines);

    /// Set the matrix to zero and allocate the rows of @p functions (local
    /// numbers) and of their images. They must contain the functions of all
    /// cells that will be added; no other entries are stored.
    void
    set_rows(const std::vector<unsigned int> &functions);

    /// Set the rows to zero.
    void
    clear();

    /// Add the mass matrix of an owned cell. Pairs (a, b), a <= b, of its
    /// functions in one direction are numbered (0, 0), (0, 1), ..., (1, 1), ...
    /// @p sums contains @f$ \sum_p m_p N_a(x_p) N_b(x_p) @f$ for all
    /// combinations of pairs of the directions, x fastest.
    void
    add_cell(const unsigned int cell, const double *sums);

    /// Add a symmetric @p matrix of the (p + 1)^dim functions of an owned cell.
    /// Only its entries (a, b), a <= b, are read.
    void
    add_cell(const unsigned int cell, const dealii::FullMatrix<double> &matrix);

    /// Remove the entries that couple the function at @p place with others, and
    /// add them to both diagonal entries, so that row sums do not change.
    void
    decouple(const unsigned int place);

    /// Add all entries of the rows to the diagonal, and set the others to zero.
    void
    lump();

    /// Raise the diagonal entry at @p place to at least @p smallest.
    void
    raise_diagonal(const unsigned int place, const double smallest);

    double
    diagonal(const unsigned int place) const
    {
      return values[first_entry(place)];
    }

    /// Call visit(j, M_ij) for all places j of row @p i with @f$ |i_d - j_d|
    /// \le @f$ @p reach, ascending.
    template <typename Visit>
    void
    for_each_entry(const unsigned int i,
                   const Visit       &visit,
                   const int          reach) const;

    /// Call visit(j, M_ij) for all places j of row @p i, ascending.
    template <typename Visit>
    void
    for_each_entry(const unsigned int i, const Visit &visit) const;

    /// Call visit(j, M_ij) for the places j >= i only, ascending.
    template <typename Visit>
    void
    for_each_upper_entry(const unsigned int i,
                         const Visit       &visit,
                         const int          reach) const;

    /// Return the full stencil of a row, [line][x].
    void
    get_row(const unsigned int i, double *stencil) const;

    /// Add the entries with j >= i of a full stencil.
    void
    add_row(const unsigned int i, const double *stencil);

    /// Compute y = M x for @p width (1, 2, 3, 4 or 8) interleaved vectors,
    /// which must be zero at all places without a row. If @p width is 3, up to
    /// three numbers after the stencil of a row are read and rewritten
    /// unchanged.
    void
    vmult(double *y, const double *x, const unsigned int width) const;

    /// Store the entries divided by @p unit in single precision, for products y
    /// = M / unit x of 2, 4 or 8 vectors.
    void
    make_single(const double unit);

    void
    vmult(float *y, const float *x, const unsigned int width) const;

  private:
    /// An entry M_ij that is stored but counts as zero.
    struct DecoupledEntry
    {
      unsigned int i, j;
      double       value;
    };

    using StencilPlaces<dim>::spline_space;
    using StencilPlaces<dim>::n_places;
    using StencilPlaces<dim>::line_begin;
    using StencilPlaces<dim>::line_of;
    using StencilPlaces<dim>::n_lines_y;
    using StencilPlaces<dim>::segments;
    using typename StencilPlaces<dim>::Segment;

    /// Call visit(j, e) for the places j of row @p i in @p reach, or only for j
    /// >= i, ascending; e is the number of the stored entry.
    template <bool upper, typename Visit>
    void
    visit_places(const unsigned int i,
                 const int          reach,
                 const Visit       &visit) const;

    template <int n, int width, typename Number>
    void
    multiply(Number       *y,
             const Number *x,
             const Number *entries,
             const double  unit) const;

    /// The stored rows of a line. Places without a row may be between them.
    struct LineRows
    {
      unsigned int begin = 0, size = 0; // the first place, and places
      std::size_t  entry = 0;           // the first stored entry
    };

    /// Return the number of the diagonal entry of a place with a row.
    std::size_t
    first_entry(const unsigned int place) const
    {
      const LineRows &line = line_rows[line_of[place]];
      Assert(place - line.begin < line.size, dealii::ExcInternalError());
      return line.entry +
             std::size_t(place - line.begin) * (spline_space->degree() + 1);
    }

    /// Return whether a stored entry counts.
    bool
    is_coupled(const unsigned int i, const unsigned int j) const
    {
      return decoupled_places.empty() || i == j ||
             !(is_decoupled[i] || is_decoupled[j]);
    }

    /// Return the number of entries with j >= i that share the stored entry of
    /// M_ij at a @p distance (of (p + 1)^dim, x fastest).
    unsigned int
    n_equal(unsigned int distance) const;

    // The entries of a line are [k][x][dx] with k as in CellLine, and x counted
    // from its first row. Entry 0 is zero, and stands for all that are not
    // stored.
    std::vector<LineRows>       line_rows; // by line
    std::vector<double>         values;
    std::vector<float>          single_values;
    double                      single_unit = 1.;
    ZeroedArray<unsigned char>  is_decoupled; // by place
    std::vector<unsigned int>   decoupled_places;
    std::vector<DecoupledEntry> decoupled_entries;
  };



  /// Add the mass matrix of weights at Gauss points. All functions of cells
  /// with mass must have a row.
  template <int dim>
  void
  add_mass_matrix(StencilMatrix<dim>        &matrix,
                  const DensityWeights<dim> &weights);
} // namespace greville

#include <greville/mass/stencil_matrix.templates.h>
