// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/mass/mass_operator.h>
#include <greville/mass/sum_factorization.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int
    max_cell_size(const unsigned int dim)
    {
      constexpr unsigned int n = 2 * SplineSpace<2>::max_degree + 1;
      return dim == 1 ? n : n * max_cell_size(dim - 1);
    }
  } // namespace



  /// The part of an operator that belongs to one of the two spaces: its basis
  /// values, its kernels, and the layout of the coefficients of a batch in
  /// memory.
  template <int dim>
  struct CrossMassOperator<dim>::Side
  {
    Side(const SplineSpace<dim> &s, const DensityWeights<dim> &weights)
      : space(s)
      , tables(s, weights.n_points_1d())
      , kernels(cell_kernels<dim>(s.degree(), weights.n_points_1d()))
      , n(s.degree() + 1)
      , n_layer(Utilities::fixed_power<dim - 1>(n))
      , contiguous(weights.batches().size())
    {
      for (std::size_t b = 0; b < contiguous.size(); ++b)
        contiguous[b] = is_contiguous(weights.batches()[b]);
    }

    /// Return whether the coefficients of each row in x of the batch are
    /// contiguous in memory.
    bool
    is_contiguous(const typename CellBatches<dim>::Batch &batch) const
    {
      if (batch.end_lane < native_simd_width)
        return false;
      const auto first = space.cell_functions(batch.first_cell);
      for (unsigned int lane = 0; lane < native_simd_width; ++lane)
        {
          const auto numbers = space.cell_functions(batch.first_cell + lane);
          for (unsigned int r = 0; r < n_layer; ++r)
            for (unsigned int a = 0; a < n; ++a)
              if (numbers[r * n + a] != first[r * n] + lane + a)
                return false;
        }
      return true;
    }

    /// Gather the coefficients of one layer (with the same index in the last
    /// direction) of a batch.
    void
    gather_layer(const std::size_t                       b,
                 const typename CellBatches<dim>::Batch &batch,
                 const unsigned int                      layer,
                 const double                           *source,
                 NativeSimd                             *values) const
    {
      const unsigned int *first =
        space.cell_functions(batch.first_cell).data() + layer * n_layer;
      if (contiguous[b])
        kernels.gather_layer(first, source, values);
      else
        for (unsigned int i = 0; i < n_layer; ++i)
          {
            values[i] = 0.;
            for (unsigned int lane = 0; lane < batch.end_lane; ++lane)
              values[i][lane] = source[first[lane * n * n_layer + i]];
          }
    }

    void
    scatter_add_layer(const std::size_t                       b,
                      const typename CellBatches<dim>::Batch &batch,
                      const unsigned int                      layer,
                      const NativeSimd                       *values,
                      double                                 *target) const
    {
      const unsigned int *first =
        space.cell_functions(batch.first_cell).data() + layer * n_layer;
      if (contiguous[b])
        kernels.scatter_add_layer(first, values, target);
      else
        for (unsigned int i = 0; i < n_layer; ++i)
          for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
               ++lane)
            target[first[lane * n * n_layer + i]] += values[i][lane];
    }

    void
    gather(const std::size_t                       b,
           const typename CellBatches<dim>::Batch &batch,
           const double                           *source,
           NativeSimd                             *values) const
    {
      for (unsigned int layer = 0; layer < n; ++layer)
        gather_layer(b, batch, layer, source, values + layer * n_layer);
    }

    void
    scatter_add(const std::size_t                       b,
                const typename CellBatches<dim>::Batch &batch,
                const NativeSimd                       *values,
                double                                 *target) const
    {
      for (unsigned int layer = 0; layer < n; ++layer)
        scatter_add_layer(b, batch, layer, values + layer * n_layer, target);
    }

    /// Basis values of a batch.
    struct Tables
    {
      NativeSimd    x[ShapeTables<dim>::max_size];
      const double *y;
      const double *z;
    };

    void
    load_tables(const ShapeTables<dim>                 &shape,
                const typename CellBatches<dim>::Batch &batch,
                Tables                                 &result) const
    {
      shape.load_x(batch.index[0], result.x);
      result.y = shape.values(1, batch.index[1]);
      result.z =
        dim == 3 ? shape.values(dim - 1, batch.index[dim - 1]) : nullptr;
    }

    const SplineSpace<dim>    &space;
    ShapeTables<dim>           tables;
    CellKernels                kernels;
    unsigned int               n;
    unsigned int               n_layer;
    std::vector<unsigned char> contiguous;
  };



  template <int dim>
  CrossMassOperator<dim>::CrossMassOperator(const SplineSpace<dim>    &r,
                                            const SplineSpace<dim>    &c,
                                            const DensityWeights<dim> &w)
    : weights(&w)
    , rows(std::make_shared<Side>(r, w))
    , columns(&r == &c ? rows : std::make_shared<Side>(c, w))
  {}



  template <int dim>
  void
  CrossMassOperator<dim>::apply(const Side       &out,
                                const Side       &in,
                                VectorType       &dst,
                                const VectorType &src) const
  {
    Require(src.get_partitioner().get() == in.space.partitioner().get() &&
              dst.get_partitioner().get() == out.space.partitioner().get(),
            "Vectors have to be made by the space.");
    const bool communicate = src.get_partitioner()->n_mpi_processes() > 1;
    if (communicate)
      src.update_ghost_values();
    dst = 0.;

    // Neighbouring batches in a column share all layers of coefficients except
    // one. A layer is interpolated in the other directions when it enters the
    // column, and integrated when it leaves, once each.
    typename Side::Tables in_tables, out_tables;
    NativeSimd            coefficients[max_cell_size(dim - 1)];
    NativeSimd            in_memory[max_cell_size(dim)];
    NativeSimd            out_memory[max_cell_size(dim)];
    NativeSimd           *in_layers[max_cell_size(1)];
    NativeSimd           *out_layers[max_cell_size(1)];
    const unsigned int    n_layer_points =
      Utilities::fixed_power<dim - 1>(weights->n_points_1d());
    for (unsigned int k = 0; k < max_cell_size(1); ++k)
      {
        in_layers[k]  = in_memory + k * n_layer_points;
        out_layers[k] = out_memory + k * n_layer_points;
      }

    const ColumnKernel multiply_column =
      column_kernel<dim>(in.space.degree(),
                         weights->n_points_1d(),
                         out.space.degree());
    const auto &batches = weights->batches();
    for (std::size_t b = 0; b < batches.size(); ++b)
      {
        const auto &batch = batches[b];
        in.load_tables(in.tables, batch, in_tables);
        if (&in != &out)
          out.load_tables(out.tables, batch, out_tables);
        const auto &tables = &in == &out ? in_tables : out_tables;

        unsigned int n_new_in = in.n, n_new_out = out.n;
        if (batch.continues_column)
          {
            std::rotate(in_layers, in_layers + 1, in_layers + in.n);
            std::rotate(out_layers, out_layers + 1, out_layers + out.n);
            n_new_in = n_new_out = 1;
          }
        for (unsigned int layer = in.n - n_new_in; layer < in.n; ++layer)
          {
            in.gather_layer(b, batch, layer, src.begin(), coefficients);
            in.kernels.interpolate_layer(coefficients,
                                         in_tables.x,
                                         in_tables.y,
                                         nullptr,
                                         in_layers[layer]);
          }
        for (unsigned int layer = out.n - n_new_out; layer < out.n; ++layer)
          std::fill_n(out_layers[layer], n_layer_points, NativeSimd(0.));

        multiply_column(in_layers,
                        dim == 2 ? in_tables.y : in_tables.z,
                        (*weights)[b],
                        dim == 2 ? tables.y : tables.z,
                        out_layers);

        const bool is_last =
          b + 1 == batches.size() || !batches[b + 1].continues_column;
        for (unsigned int layer = 0; layer < (is_last ? out.n : 1); ++layer)
          {
            out.kernels.integrate_layer(
              out_layers[layer], tables.x, tables.y, nullptr, coefficients);
            out.scatter_add_layer(b, batch, layer, coefficients, dst.begin());
          }
      }

    if (communicate)
      {
        dst.compress(VectorOperation::add);
        src.zero_out_ghost_values();
      }
  }



  template <int dim>
  void
  CrossMassOperator<dim>::diagonal(VectorType &dst) const
  {
    dst                      = 0.;
    ShapeTables<dim> squares = rows->tables;
    squares.square();

    typename Side::Tables tables;
    NativeSimd            values[max_cell_size(dim)];
    NativeSimd            result[max_cell_size(dim)];
    for (std::size_t b = 0; b < weights->batches().size(); ++b)
      {
        const auto &batch = weights->batches()[b];
        rows->load_tables(squares, batch, tables);
        for (unsigned int q = 0; q < weights->n_points(); ++q)
          values[q] = load<NativeSimd>((*weights)[b] + q * native_simd_width);
        rows->kernels.integrate(values, tables.x, tables.y, tables.z, result);
        rows->scatter_add(b, batch, result, dst.begin());
      }
    dst.compress(VectorOperation::add);
  }



  template <int dim>
  void
  CrossMassOperator<dim>::integrate(VectorType          &dst,
                                    const Function<dim> &f) const
  {
    dst = 0.;
    const auto *constant =
      dynamic_cast<const Functions::ConstantFunction<dim> *>(&f);

    typename Side::Tables tables;
    NativeSimd            values[max_cell_size(dim)];
    NativeSimd            result[max_cell_size(dim)];
    std::vector<double>   f_values(weights->n_points());
    const auto            add_batch = [&](const std::size_t b) {
      const auto &batch = weights->batches()[b];
      rows->load_tables(rows->tables, batch, tables);
      for (unsigned int q = 0; q < weights->n_points(); ++q)
        values[q] = load<NativeSimd>((*weights)[b] + q * native_simd_width);
      if (constant != nullptr)
        for (unsigned int q = 0; q < weights->n_points(); ++q)
          values[q] *= constant->value(Point<dim>());
      else
        for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
             ++lane)
          {
            f.value_list(weights->points(
                           rows->space.box(batch.first_cell + lane)),
                         f_values);
            for (unsigned int q = 0; q < weights->n_points(); ++q)
              values[q][lane] = values[q][lane] * f_values[q];
          }
      rows->kernels.integrate(values, tables.x, tables.y, tables.z, result);
      rows->scatter_add(b, batch, result, dst.begin());
    };
    // A formula may fail at a point of one process.
    run_on_all(rows->space.communicator(), [&]() {
      for (std::size_t b = 0; b < weights->batches().size(); ++b)
        add_batch(b);
    });
    dst.compress(VectorOperation::add);
  }



  template <int dim>
  std::pair<double, double>
  CrossMassOperator<dim>::difference(const VectorType    &coefficients,
                                     const Function<dim> &f) const
  {
    coefficients.update_ghost_values();

    std::array<double, 2> sums{{0., 0.}};
    typename Side::Tables tables;
    NativeSimd            local[max_cell_size(dim)];
    NativeSimd            values[max_cell_size(dim)];
    std::vector<double>   f_values(weights->n_points());
    for (std::size_t b = 0; b < weights->batches().size(); ++b)
      {
        const auto &batch = weights->batches()[b];
        rows->load_tables(rows->tables, batch, tables);
        rows->gather(b, batch, coefficients.begin(), local);
        rows->kernels.interpolate(local, tables.x, tables.y, tables.z, values);
        for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
             ++lane)
          {
            f.value_list(weights->points(
                           rows->space.box(batch.first_cell + lane)),
                         f_values);
            for (unsigned int q = 0; q < weights->n_points(); ++q)
              {
                const double w = (*weights)[b][q * native_simd_width + lane];
                const double error = values[q][lane] - f_values[q];
                sums[0] += w * error * error;
                sums[1] += w * f_values[q] * f_values[q];
              }
          }
      }
    coefficients.zero_out_ghost_values();

    const MPI_Comm comm = rows->space.communicator();
    return {std::sqrt(Utilities::MPI::sum(sums[0], comm)),
            std::sqrt(Utilities::MPI::sum(sums[1], comm))};
  }



  std::pair<double, std::vector<unsigned int>>
  fill_inactive(VectorType &diagonal)
  {
    constexpr double round_off = 1e-15;
    const double     norm      = diagonal.linfty_norm();
    // If walls constrain all functions of a level, there is nothing to solve.
    // An example is order 1 in a single row of cells between two walls.
    const double              largest = norm > 0. ? norm : 1.;
    std::vector<unsigned int> inactive;
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      if (diagonal.local_element(i) <= round_off * largest)
        inactive.push_back(i);
    for (const unsigned int i : inactive)
      diagonal.local_element(i) = largest;
    return {largest, inactive};
  }



  template <int dim>
  MassOperator<dim>::MassOperator(const SplineSpace<dim>    &space,
                                  const DensityWeights<dim> &weights)
    : spline_space(&space)
    , cross(space, space, weights)
  {
    space.initialize_vector(matrix_diagonal);
    cross.diagonal(matrix_diagonal);
    std::tie(inactive_diagonal, inactive_functions) =
      fill_inactive(matrix_diagonal);
  }



  template <int dim>
  void
  MassOperator<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    // Rows and columns of functions without mass are zero.
    cross.vmult(dst, src);
    for (const unsigned int i : inactive_functions)
      dst.local_element(i) = inactive_diagonal * src.local_element(i);
  }



  GREVILLE_INSTANTIATE_CLASS(CrossMassOperator);
  GREVILLE_INSTANTIATE_CLASS(MassOperator);
} // namespace greville
