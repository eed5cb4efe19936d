// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_stencil_matrix_h
#define greville_mass_stencil_matrix_h

#include <deal.II/lac/full_matrix.h>

#include <greville/base/zeroed_array.h>
#include <greville/mass/density_weights.h>

namespace greville
{
  /**
   * The part of a matrix @f$ M_{ij} @f$ that the cells of this process
   * contribute, for functions with @f$ |i_d - j_d| \le p @f$ in each direction:
   * the mass matrix is the sum over all processes. The matrix is symmetric in
   * each direction separately, as sums @f$ \sum_p m_p N_i(x_p) N_j(x_p) @f$
   * over products of splines are: @f$ M_{ij} @f$ depends on @f$ \min(i_d, j_d)
   * @f$ and @f$ |i_d - j_d| @f$ only. The row of the function min(i, j) stores
   * these @f$ (p + 1)^\text{dim} @f$ entries, without column numbers. Entries
   * of another symmetric matrix are replaced by the mean of those that share a
   * number, which leaves out what is antisymmetric in a direction.
   *
   * Functions have *places* in memory: the functions of a line in x have
   * consecutive places, padded such that neighbours are found by arithmetic
   * without tests for walls. Vectors on places are interleaved, entry c of
   * place i at i * width + c. Rows and vector entries that are never written
   * use no memory.
   *
   * If a direction of n functions is periodic, the functions with @f$ i_d < p
   * @f$ have a second place, an *image*, at @f$ n + i_d @f$, for cells at the
   * upper end. The matrix is @f$ P^T B P @f$ with the stored matrix B, where P
   * gives images the value of their function (see ExtendedUnknowns).
   */
  template <int dim>
  class StencilMatrix
  {
  public:
    /**
     * The space is kept by reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /// Return the number of places.
    std::size_t
    size() const
    {
      return n_places;
    }

    /**
     * Return the place of a function with a local number. Places ascend with
     * the lexicographic position.
     */
    unsigned int
    place(const unsigned int function) const
    {
      return place_of[function];
    }

    /**
     * Return the place of function (@p x, @p line) of an owned cell: x and the
     * number of the line among its (p + 1)^(dim - 1) lines.
     */
    unsigned int
    cell_place(const unsigned int cell,
               const unsigned int x,
               const unsigned int line) const
    {
      const unsigned int n = spline_space->degree() + 1;
      const unsigned int first =
        place_of[spline_space->cell_functions(cell)[0]];
      const unsigned int start = line_of[first];
      return line_begin[start + line % n + line / n * n_lines_y] + x +
             (first - line_begin[start]);
    }

    /**
     * The entries of the functions of a line of a cell: x = 0, 1, ..., with a
     * line at distance number k = dy + dz (p + 1), for the distances dx = 0,
     * ..., p in x, are begin[k * stride + x * (p + 1) + dx].
     */
    struct CellLine
    {
      double     *begin;
      std::size_t stride;
    };

    /// Set the n^(dim - 1) lines of a cell, n = p + 1.
    template <int n>
    void
    find_lines(const unsigned int cell, CellLine *lines) const
    {
      const unsigned int place =
        place_of[spline_space->cell_functions(cell)[0]];
      const unsigned int first = line_of[place];
      for (unsigned int z = 0; z < (dim == 3 ? n : 1); ++z)
        for (unsigned int y = 0; y < n; ++y)
          {
            const unsigned int line = first + y + z * n_lines_y;
            const std::size_t  x    = int(place) - line_begin[first] +
                                  line_begin[line] - int(line_places[line]);
            *lines++ = {values.data() + entries_begin[line] + x * n,
                        std::size_t(line_size[line]) * n};
          }
    }

    /// Return the images of local functions: function and place.
    const std::vector<std::pair<unsigned int, unsigned int>> &
    images() const
    {
      return image_places;
    }

    /**
     * Set the matrix to zero and allocate the rows of these functions (local
     * numbers) and of their images: the functions of all cells that will be
     * added.
     */
    void
    set_rows(const std::vector<unsigned int> &functions);

    /**
     * Set the rows to zero.
     */
    void
    clear();

    /**
     * Add the mass matrix of an owned cell. With the pairs (a, b), a <= b, of
     * its functions in one direction, numbered (0, 0), (0, 1), ..., (1, 1),
     * ..., @p sums contains @f$ \sum_p m_p N_a(x_p) N_b(x_p) @f$ for all
     * combinations of pairs of the directions, x fastest.
     */
    void
    add_cell(const unsigned int cell, const double *sums);

    /**
     * Add a symmetric @p matrix of the (p + 1)^dim functions of an owned cell,
     * of which the entries (a, b), a <= b, are read.
     */
    void
    add_cell(const unsigned int cell, const dealii::FullMatrix<double> &matrix);

    /**
     * Remove the entries that couple the function at @p place with others and
     * add them to both diagonal entries, which keeps all row sums.
     */
    void
    decouple(const unsigned int place);

    /**
     * Add all entries of the rows to the diagonal, and set the others to zero.
     */
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

    /**
     * Call visit(j, M_ij) for all places j of row @p i with @f$ |i_d - j_d|
     * \le @f$ @p reach, ascending.
     */
    template <typename Visit>
    void
    for_each_entry(const unsigned int i,
                   const Visit       &visit,
                   const int          reach) const;

    /// The same for all entries.
    template <typename Visit>
    void
    for_each_entry(const unsigned int i, const Visit &visit) const;

    /// Call visit(j, M_ij) for the places j >= i only, ascending.
    template <typename Visit>
    void
    for_each_upper_entry(const unsigned int i,
                         const Visit       &visit,
                         const int          reach) const;

    /**
     * Call visit(j, e) for all places j of the full stencil of row @p i,
     * ascending, where e is the number of the stored entry. Entries of
     * decoupled functions are stored, but count as zero.
     */
    template <typename Visit>
    void
    for_each_place(const unsigned int i, const Visit &visit) const;

    /**
     * Call visit(i) for all places with a row, ascending.
     */
    template <typename Visit>
    void
    for_each_row(const Visit &visit) const
    {
      for (const Segment &segment : segments)
        for (unsigned int i = segment.begin; i < segment.end; ++i)
          visit(i);
    }

    /**
     * Call visit(begin, end, distance) for all ranges of rows at consecutive
     * places of a line; distance(k) is the distance to the place with the same
     * x in line number k of the neighbours.
     */
    template <typename Visit>
    void
    for_each_segment(const Visit &visit) const
    {
      for (const Segment &segment : segments)
        visit(segment.begin, segment.end, [&](const unsigned int k) {
          return distance(segment.line, k);
        });
    }

    /// Return the full stencil of a row, [line][x].
    void
    get_row(const unsigned int i, double *stencil) const;

    /// Add the entries with j >= i of a full stencil.
    void
    add_row(const unsigned int i, const double *stencil);

    /**
     * Compute y = M x for @p width (1, 2, 3, 4 or 8) interleaved vectors, which
     * must be zero at all places without a row. If @p width is 3, up to three
     * numbers behind the stencil of a row are read and written without being
     * changed.
     */
    void
    vmult(double *y, const double *x, const unsigned int width) const;

    /**
     * Copy the entries divided by @p unit in single precision, for products y =
     * M / unit x of 2, 4 or 8 vectors.
     */
    void
    make_single(const double unit);

    void
    vmult(float *y, const float *x, const unsigned int width) const;

  private:
    /// Rows at consecutive places of a line.
    struct Segment
    {
      unsigned int begin, end; // places
      unsigned int line;
    };

    /// An entry M_ij that is stored but counts as zero.
    struct DecoupledEntry
    {
      unsigned int i, j;
      double       value;
    };

    /// A function or an image, numbered without periodicity.
    struct Function
    {
      unsigned int         number;
      std::array<int, dim> index;
    };

    std::vector<Function>
    functions_and_images() const;

    /// Set the lines in a box around functions, and their places.
    void
    make_lines(const std::vector<Function> &functions);

    unsigned int
    line_number(const std::array<int, dim> &index) const
    {
      return index[1] - lowest[1] +
             (dim == 3 ? (index[dim - 1] - lowest[dim - 1]) * int(n_lines_y)
                       : 0);
    }

    /// for_each_place(), or for j >= i only.
    template <bool upper, typename Visit>
    void
    visit_places(const unsigned int i,
                 const int          reach,
                 const Visit       &visit) const;

    /// Call visit(begin, n) for ranges of entries of the rows.
    template <typename Visit>
    void
    for_each_range(const Visit &visit) const;

    template <int n, int width, typename Number>
    void
    multiply(Number       *y,
             const Number *x,
             const Number *entries,
             const double  unit) const;

    /**
     * Return the distance from a place in @p line to the place with the same x
     * in line number @p k of its (2 p + 1)^(dim - 1) neighbours.
     */
    int
    distance(const unsigned int line, const unsigned int k) const
    {
      return line_begin[line + neighbor_lines[k]] - line_begin[line];
    }

    /// Return the number of the diagonal entry of a place.
    std::size_t
    first_entry(const unsigned int place) const
    {
      const unsigned int line = line_of[place];
      return entries_begin[line] +
             (place - line_places[line]) * (spline_space->degree() + 1);
    }

    /// Return whether a stored entry counts.
    bool
    is_coupled(const unsigned int i, const unsigned int j) const
    {
      return decoupled_places.empty() || i == j ||
             !(is_decoupled[i] || is_decoupled[j]);
    }

    /// Return the number of entries with j >= i that share a number with the
    /// entry M_ij at a distance, (p + 1)^dim, x fastest.
    unsigned int
    n_equal(unsigned int distance) const;

    const SplineSpace<dim> *spline_space = nullptr;
    std::size_t             n_places     = 0;

    // Lines are counted in a box around the lines of this process. A function
    // at x in a line has the place line_begin[line] + x. The entries of a line
    // are [k][x][dx] with k as in CellLine, of line_size[line] places from
    // line_places[line] on.
    std::array<int, dim>      lowest{};
    std::vector<int>          line_begin;
    std::vector<int>          neighbor_lines; // distances of line numbers
    unsigned int              n_lines_y = 0;
    std::vector<unsigned int> line_places;
    std::vector<unsigned int> line_size;
    std::vector<std::size_t>  entries_begin; // by line
    std::vector<unsigned int> place_of;      // by local number

    std::vector<std::pair<unsigned int, unsigned int>> image_places;

    std::vector<Segment>        segments;
    ZeroedArray<double>         values;
    ZeroedArray<float>          single_values;
    double                      single_unit = 1.;
    ZeroedArray<unsigned>       line_of;      // by place
    ZeroedArray<unsigned char>  is_decoupled; // by place
    std::vector<unsigned int>   decoupled_places;
    std::vector<DecoupledEntry> decoupled_entries;
  };



  /**
   * Add the mass matrix of weights at Gauss points. All functions of cells with
   * mass must have a row.
   */
  template <int dim>
  void
  add_mass_matrix(StencilMatrix<dim>        &matrix,
                  const DensityWeights<dim> &weights);
} // namespace greville

#include <greville/mass/stencil_matrix.templates.h>

#endif
