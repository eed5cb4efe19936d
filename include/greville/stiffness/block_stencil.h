// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/mass/stencil_matrix.h>
#include <greville/multigrid/half_stencil.h>

namespace greville
{
  /**
   * The part of a stiffness matrix, or another symmetric matrix of dim x dim
   * blocks @f$ B_{ij} @f$, that the cells of this process contribute, for
   * functions with @f$ |i_d - j_d| \le p @f$ in each direction d. A row is a
   * stencil of @f$ (2 p + 1)^\text{dim} @f$ blocks. Its half with j >= i in
   * lexicographic order is stored, without column numbers, on the places of a
   * StencilMatrix. The diagonal block is stored with half of each entry.
   *
   * Vectors on places are interleaved: component c of place i is entry i * dim
   * + c. @p Number is double, or float for preconditioners. Products in single
   * precision scale x by a power of two, so that vectors of any magnitude keep
   * their digits.
   */
  template <int dim, typename Number>
  class BlockStencil
  {
  public:
    /// @p matrix supplies the places; it is kept by reference.
    void
    reinit(const StencilMatrix<dim> &matrix);

    /// Set the matrix to zero and allocate the rows of the StencilMatrix.
    void
    clear();

    /// Add the matrix of an owned cell with n = (p + 1)^dim functions, numbered
    /// as in SplineSpace::cell_functions(). Blocks of components i <= k are
    /// stored in the order (0, 0), (0, 1), ..., (1, 1), ...: entry (a, i; b, k)
    /// of function a and function b is values[(block * n + a) * stride + b].
    void
    add_cell(const unsigned int cell,
             const Number      *values,
             const unsigned int stride);

    /// Set this matrix to another one on the same places.
    template <typename Other>
    void
    copy(const BlockStencil<dim, Other> &other);

    /// Add @p factor times a scalar matrix on the same places to all diagonal
    /// blocks.
    void
    add(const double factor, const StencilMatrix<dim> &scalar);

    /// Set a scalar matrix to the diagonal block of a component, or to the mean
    /// of the diagonal blocks of several @p components (bits).
    void
    diagonal_block(StencilMatrix<dim> &scalar,
                   const unsigned int  components) const;

    /// Compute y = B x. x must be zero at all places without a row. Some
    /// numbers after the stencil of a row are read and rewritten unchanged;
    /// they must be finite.
    void
    vmult(double *y, const double *x) const;

    /// Compute y = B x without a change of precision.
    void
    multiply(Number *y, const Number *x) const;

    /// Return the row of a place, in the memory of a HalfStencil.
    const Number *
    row(const unsigned int place) const
    {
      return values.data() + row_of[place] * row_size;
    }

    /// Return the diagonal entry of component c at a place.
    double
    diagonal(const unsigned int place, const unsigned int c) const
    {
      return 2. * row(place)[first_of_line + c * line_size + c];
    }

    /// Call visit(j, block) for all nonzero blocks of row @p i with j >= i,
    /// block[c * dim + d].
    template <typename Visit>
    void
    for_each_block(const unsigned int i, const Visit &visit) const;

  private:
    template <int, typename>
    friend class BlockStencil;

    template <int n>
    void
    add_cell_of_order(const unsigned int cell,
                      const Number      *values,
                      const unsigned int stride);

    template <int n>
    void
    multiply_rows(Number *y, const Number *x) const;

    /// Return the first entry of component c in neighbouring line number @p k
    /// of a row, counted from its own line. A line has (2 p + 1) * dim entries,
    /// [x][d].
    std::size_t
    line(const unsigned int k, const unsigned int c) const
    {
      return (std::size_t(k) * dim + c) * line_size;
    }

    Number *
    row(const unsigned int place)
    {
      return values.data() + row_of[place] * row_size;
    }

    const StencilMatrix<dim> *matrix        = nullptr;
    unsigned int              length        = 0; // 2 p + 1, blocks of a line
    unsigned int              n_lines       = 0; // of the half
    unsigned int              line_size     = 0; // with zeros, for full vectors
    unsigned int              first_of_line = 0; // of the block on the diagonal
    std::size_t               row_size      = 0; // [line][c][x][d]
    ZeroedArray<unsigned int> row_of;            // by place
    ZeroedArray<Number>       single_x, single_y; // of single precision
    std::vector<Number>       values;
  };



  template <int dim, typename Number>
  template <typename Visit>
  void
  BlockStencil<dim, Number>::for_each_block(const unsigned int i,
                                            const Visit       &visit) const
  {
    const Number      *entries = row(i);
    const unsigned int middle  = (2 * n_lines - 1) / 2;
    double             block[dim * dim];
    unsigned int       k = 0, x = 0;
    matrix->for_each_place(i, [&](const unsigned int j) {
      const bool is_stored = k >= middle && j >= i;
      bool       is_zero   = true;
      for (unsigned int c = 0; is_stored && c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          {
            block[c * dim + d] =
              (i == j ? 2. : 1.) * entries[line(k - middle, c) + x * dim + d];
            is_zero = is_zero && block[c * dim + d] == 0.;
          }
      if (++x == length)
        {
          x = 0;
          ++k;
        }
      if (!is_zero)
        visit(j, block);
    });
  }
} // namespace greville
