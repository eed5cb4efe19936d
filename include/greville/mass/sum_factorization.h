// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/aligned_vector.h>

#include <greville/base/simd.h>
#include <greville/spline/spline_space.h>

/// Kernels of the cell-wise operators: sum factorization over a batch of cells
/// that are neighbours in x. Basis values in x differ between lanes (near
/// walls); basis values in y and z are equal in all lanes. To be included in
/// sources, not in headers.
namespace greville
{
  /// Values of the basis functions of a space at Gauss points, direction by
  /// direction.
  template <int dim>
  class ShapeTables
  {
  public:
    ShapeTables() = default;

    ShapeTables(const SplineSpace<dim> &space, const unsigned int n_points_1d);

    /// Replace each value by its square: integration then gives the diagonal of
    /// a mass matrix.
    void
    square();

    /// Write the table [point][function] of x for the lanes of a batch that
    /// begins at cell @p first to @p table.
    void
    load_x(const unsigned int first, NativeSimd *table) const
    {
      for (unsigned int k = 0; k < table_size; ++k)
        table[k] = load<NativeSimd>(x.data() + k * x_stride + first);
    }

    /// Return the table [point][function] of direction @p d (y or z) for
    /// @p cell.
    const double *
    values(const unsigned int d, const unsigned int cell) const
    {
      return y_and_z[d - 1].data() + std::size_t(cell) * table_size;
    }

    /// Largest number of entries of one table.
    static constexpr unsigned int max_size =
      (SplineSpace<dim>::max_degree + 1) *
      (2 * SplineSpace<dim>::max_degree + 1);

  private:
    unsigned int                                       table_size = 0;
    unsigned int                                       x_stride   = 0;
    dealii::AlignedVector<double>                      x;
    std::array<dealii::AlignedVector<double>, dim - 1> y_and_z;
  };



  /// The kernels of one space, for n = p + 1 functions and n_q points per
  /// direction. Arrays are lexicographic, one SIMD vector per entry.
  struct CellKernels
  {
    /// interpolate: n^dim coefficients -> n_q^dim values at the points,
    /// integrate, its transpose: n_q^dim values -> n^dim test functions.
    using Function = void (*)(const NativeSimd *in,
                              const NativeSimd *table_x,
                              const double     *table_y,
                              const double     *table_z,
                              NativeSimd       *out);
    Function interpolate;
    Function integrate;

    /// The same kernels for one layer of coefficients or points, without the
    /// last direction and its table.
    Function interpolate_layer;
    Function integrate_layer;

    /// Copy between the vector of coefficients and the n^(dim - 1) values of a
    /// layer in which the coefficients of each row in x are contiguous in
    /// memory. @p numbers are the local numbers of the layer's functions on the
    /// first cell.
    void (*gather_layer)(const unsigned int *numbers,
                         const double       *source,
                         NativeSimd         *values);
    void (*scatter_add_layer)(const unsigned int *numbers,
                              const NativeSimd   *values,
                              double             *target);
  };

  /// The last direction of a cross mass matrix: interpolate the n_in layers to
  /// the points, multiply by the @p weights (n_q^dim vectors), integrate and
  /// add to the n_out layers. Layers have n_q^(dim - 1) entries; @p in and
  /// @p out are pointers to them.
  using ColumnKernel = void (*)(const NativeSimd *const *in,
                                const double            *table_in,
                                const double            *weights,
                                const double            *table_out,
                                NativeSimd *const       *out);

  /// Return the kernels of an order. Kernels are compiled for pairs of
  /// consecutive orders of an OrderHierarchy, with n_q = p + 1 and n_q = 2 p +
  /// 1, p being the higher order.
  template <int dim>
  CellKernels
  cell_kernels(const unsigned int degree, const unsigned int n_points_1d);

  template <int dim>
  ColumnKernel
  column_kernel(const unsigned int degree_in,
                const unsigned int n_points_1d,
                const unsigned int degree_out);
} // namespace greville
