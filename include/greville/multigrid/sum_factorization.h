#ifndef greville_multigrid_sum_factorization_h
#define greville_multigrid_sum_factorization_h

#include <deal.II/base/aligned_vector.h>

#include <greville/base/simd.h>
#include <greville/spline/spline_space.h>

/**
 * The inner kernels of the cell-wise operators: sum factorization over a batch
 * of cells that are neighbours in x. Basis values in x differ from lane to lane
 * (near walls), those in y and z are the same in all lanes. To be included in
 * sources, not in headers.
 */
namespace greville
{
  /**
   * Values of the basis functions of a space at Gauss points, direction by
   * direction.
   */
  template <int dim>
  class ShapeTables
  {
  public:
    ShapeTables() = default;

    ShapeTables(const SplineSpace<dim> &space, const unsigned int n_points_1d);

    /**
     * Replace each value by its square: integration then gives the diagonal of
     * a mass matrix.
     */
    void
    square();

    /**
     * The table [point][function] of x for the lanes of a batch that begins at
     * cell @p first, written to @p table.
     */
    void
    load_x(const unsigned int first, Simd *table) const
    {
      for (unsigned int k = 0; k < table_size; ++k)
        table[k] = load(x.data() + k * x_stride + first);
    }

    /**
     * The table [point][function] of direction @p d (y or z) for @p cell.
     */
    const double *
    values(const unsigned int d, const unsigned int cell) const
    {
      return y_and_z[d - 1].data() + std::size_t(cell) * table_size;
    }

    /**
     * Largest number of entries of one table.
     */
    static constexpr unsigned int max_size =
      (SplineSpace<dim>::max_degree + 1) * (SplineSpace<dim>::max_degree + 1);

  private:
    unsigned int                                           table_size = 0;
    unsigned int                                           x_stride   = 0;
    dealii::AlignedVector<double>                          x;
    std::array<dealii::AlignedVector<double>, dim - 1> y_and_z;
  };



  /**
   * The two kernels for p + 1 functions and n_q points per direction.
   * - interpolate: (p + 1)^dim coefficients -> n_q^dim values at the points,
   * - integrate, its transpose: n_q^dim values -> (p + 1)^dim test functions.
   * Arrays are lexicographic, one SIMD vector per entry.
   */
  struct CellKernels
  {
    using Function = void (*)(const Simd *  in,
                              const Simd *  table_x,
                              const double *table_y,
                              const double *table_z,
                              Simd *        out);
    Function interpolate;
    Function integrate;
  };

  /**
   * Kernels are compiled for 1 <= p < n_q <= 6.
   */
  template <int dim>
  CellKernels
  cell_kernels(const unsigned int degree, const unsigned int n_points_1d);
} // namespace greville

#endif
