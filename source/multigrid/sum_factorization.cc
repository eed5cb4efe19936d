#include <deal.II/base/quadrature_lib.h>

#include <greville/multigrid/sum_factorization.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ShapeTables<dim>::ShapeTables(const SplineSpace<dim> &space,
                                const unsigned int      n_points_1d)
    : table_size((space.degree() + 1) * n_points_1d)
  {
    const unsigned int  n = space.degree() + 1;
    const QGauss<1>     quadrature(n_points_1d);
    std::vector<double> values(n);
    for (unsigned int d = 0; d < dim; ++d)
      {
        const KnotVector & knots   = space.knots(d);
        const unsigned int n_cells = knots.n_elements();
        if (d == 0)
          {
            x_stride = n_cells + simd_width;
            x.resize(table_size * x_stride, 0.);
          }
        else
          y_and_z[d - 1].resize(std::size_t(n_cells) * table_size);

        for (unsigned int e = 0; e < n_cells; ++e)
          for (unsigned int q = 0; q < n_points_1d; ++q)
            {
              const double lower = knots.element_lower(e);
              const double h     = knots.element_upper(e) - lower;
              knots.evaluate(e,
                             lower + h * quadrature.point(q)(0),
                             0,
                             make_array_view(values));
              for (unsigned int a = 0; a < n; ++a)
                if (d == 0)
                  x[(q * n + a) * x_stride + e] = values[a];
                else
                  y_and_z[d - 1][std::size_t(e) * table_size + q * n + a] =
                    values[a];
            }
      }
  }



  template <int dim>
  void
  ShapeTables<dim>::square()
  {
    for (double &value : x)
      value *= value;
    for (auto &table : y_and_z)
      for (double &value : table)
        value *= value;
  }



  namespace
  {
    /**
     * out(outer, j, inner) = sum_i matrix(j, i) in(outer, i, inner), or with
     * the transpose of the matrix, which is stored as [point][function].
     */
    template <int  n_functions,
              int  n_points,
              bool transpose,
              int  n_outer,
              int  n_inner,
              typename Number>
    inline __attribute__((always_inline)) void
    contract(const Number *matrix, const Simd *in, Simd *out)
    {
      constexpr int n_in  = transpose ? n_points : n_functions;
      constexpr int n_out = transpose ? n_functions : n_points;
      for (int outer = 0; outer < n_outer; ++outer)
        for (int inner = 0; inner < n_inner; ++inner)
          {
            Simd values[n_in];
#pragma GCC unroll 8
            for (int i = 0; i < n_in; ++i)
              values[i] = in[(outer * n_in + i) * n_inner + inner];
#pragma GCC unroll 8
            for (int j = 0; j < n_out; ++j)
              {
                Simd sum =
                  matrix[transpose ? j : j * n_functions] * values[0];
#pragma GCC unroll 8
                for (int i = 1; i < n_in; ++i)
                  sum += matrix[transpose ? i * n_functions + j :
                                            j * n_functions + i] *
                         values[i];
                out[(outer * n_out + j) * n_inner + inner] = sum;
              }
          }
    }



    template <int dim, int n, int q>
    void
    interpolate(const Simd *  in,
                const Simd *  table_x,
                const double *table_y,
                const double *table_z,
                Simd *        out)
    {
      (void)table_z;
      if constexpr (dim == 2)
        {
          Simd a[n * q];
          contract<n, q, false, n, 1>(table_x, in, a);
          contract<n, q, false, 1, q>(table_y, a, out);
        }
      else
        {
          Simd a[n * n * q], b[n * q * q];
          contract<n, q, false, n * n, 1>(table_x, in, a);
          contract<n, q, false, n, q>(table_y, a, b);
          contract<n, q, false, 1, q * q>(table_z, b, out);
        }
    }



    template <int dim, int n, int q>
    void
    integrate(const Simd *  in,
              const Simd *  table_x,
              const double *table_y,
              const double *table_z,
              Simd *        out)
    {
      (void)table_z;
      if constexpr (dim == 2)
        {
          Simd a[n * q];
          contract<n, q, true, 1, q>(table_y, in, a);
          contract<n, q, true, n, 1>(table_x, a, out);
        }
      else
        {
          Simd a[n * q * q], b[n * n * q];
          contract<n, q, true, 1, q * q>(table_z, in, a);
          contract<n, q, true, n, q>(table_y, a, b);
          contract<n, q, true, n * n, 1>(table_x, b, out);
        }
    }



    template <int dim, int n, int q>
    CellKernels
    select(const unsigned int degree, const unsigned int n_points_1d)
    {
      if (degree + 1 == n && n_points_1d == q)
        return {&interpolate<dim, n, q>, &integrate<dim, n, q>};
      if constexpr (n < q)
        return select<dim, n + 1, q>(degree, n_points_1d);
      else if constexpr (q < SplineSpace<dim>::max_degree + 1)
        return select<dim, 2, q + 1>(degree, n_points_1d);
      else
        {
          AssertThrow(false,
                      ExcMessage("No kernel for order " +
                                 std::to_string(degree) + " and " +
                                 std::to_string(n_points_1d) +
                                 " points per direction."));
          return {};
        }
    }
  } // namespace



  template <int dim>
  CellKernels
  cell_kernels(const unsigned int degree, const unsigned int n_points_1d)
  {
    return select<dim, 2, 2>(degree, n_points_1d);
  }



  template class ShapeTables<2>;
  template class ShapeTables<3>;
  template CellKernels
  cell_kernels<2>(const unsigned int, const unsigned int);
  template CellKernels
  cell_kernels<3>(const unsigned int, const unsigned int);
} // namespace greville
