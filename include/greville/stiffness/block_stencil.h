// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_stiffness_block_stencil_h
#define greville_stiffness_block_stencil_h

#include <greville/mass/stencil_matrix.h>

namespace greville
{
  /**
   * The part of a matrix of dim x dim blocks B_ij that the cells of this
   * process contribute, for functions with |i_d - j_d| <= p in each direction
   * d: a stiffness matrix, symmetric or not. A row of blocks is a full stencil
   * of (2 p + 1)^dim of them, without column numbers, on the places of a
   * StencilMatrix.
   *
   * Vectors on places are interleaved: component c of place i is entry i * dim
   * + c.
   */
  template <int dim>
  class BlockStencil
  {
  public:
    /**
     * The stencil has the places; it is kept by reference.
     */
    void
    reinit(const StencilMatrix<dim> &places);

    /**
     * Set the matrix to zero and let it have the rows that the places have.
     */
    void
    clear();

    /**
     * Add the matrix of an owned cell with n = (p + 1)^dim functions, numbered
     * as in SplineSpace::cell_functions(): entry (a, i; b, k) of component i of
     * function a and component k of function b is values[((a * dim + i) * dim +
     * k) * n + b].
     */
    void
    add_cell(const unsigned int cell, const double *values);

    /**
     * Add @p factor times a scalar matrix on the same places to all diagonal
     * blocks.
     */
    void
    add(const double factor, const StencilMatrix<dim> &scalar);

    /**
     * Set a scalar matrix to the mean of the diagonals of the blocks, which
     * stands for each of the components: that of i and j >= i.
     */
    void
    mean(StencilMatrix<dim> &scalar) const;

    /**
     * y = B x, with x zero at all places without a row.
     */
    void
    vmult(double *y, const double *x) const;

    /**
     * The diagonal entry of component c at a place.
     */
    double
    diagonal(const unsigned int place, const unsigned int c) const;

    /**
     * Call visit(j, block) for all places j of row @p i with a block that is
     * not zero, block[c * dim + d].
     */
    template <typename Visit>
    void
    for_each_block(const unsigned int i, const Visit &visit) const;

    /**
     * Bytes of the entries on this process.
     */
    std::size_t
    memory_consumption() const
    {
      return n_rows * row_size * sizeof(double);
    }

  private:
    template <int n>
    void
    add_cell_of_order(const unsigned int cell, const double *values);

    template <int n>
    void
    multiply(double *y, const double *x) const;

    /**
     * Entry (c, d) of block number @p k of a row.
     */
    std::size_t
    index(const unsigned int k,
          const unsigned int c,
          const unsigned int d) const
    {
      return (std::size_t(c) * n_blocks + k) * dim + d;
    }

    double *
    row(const unsigned int place)
    {
      return values.data() + row_of[place] * row_size;
    }

    const double *
    row(const unsigned int place) const
    {
      return values.data() + row_of[place] * row_size;
    }

    const StencilMatrix<dim> *places   = nullptr;
    unsigned int              n_blocks = 0; // of a row
    std::size_t               row_size = 0; // [c][block][d]
    std::size_t               n_rows   = 0;
    ZeroedArray<std::size_t>  row_of; // by place
    std::vector<double>       values;
  };



  template <int dim>
  template <typename Visit>
  void
  BlockStencil<dim>::for_each_block(const unsigned int i,
                                    const Visit       &visit) const
  {
    const double *entries = row(i);
    double        block[dim * dim];
    unsigned int  k = 0;
    places->for_each_place(i, [&](const unsigned int j, const std::size_t) {
      bool is_zero = true;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          {
            block[c * dim + d] = entries[index(k, c, d)];
            is_zero            = is_zero && block[c * dim + d] == 0.;
          }
      ++k;
      if (!is_zero)
        visit(j, block);
    });
  }
} // namespace greville

#endif
