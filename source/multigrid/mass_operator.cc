#include <greville/multigrid/mass_operator.h>
#include <greville/multigrid/sum_factorization.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int
    max_cell_size(const unsigned int dim)
    {
      return dim == 2 ? 36 : 216;
    }
  } // namespace



  /**
   * What one of the two spaces adds to an operator: its basis values, kernels,
   * and how the coefficients of a batch lie in memory.
   */
  template <int dim>
  struct CrossMassOperator<dim>::Side
  {
    Side(const SplineSpace<dim> &s, const DensityWeights<dim> &weights)
      : space(s)
      , tables(s, weights.n_points_1d())
      , kernels(cell_kernels<dim>(s.degree(), weights.n_points_1d()))
      , n(s.degree() + 1)
      , n_rows(Utilities::fixed_power<dim - 1>(n))
      , contiguous(weights.batches().size())
    {
      for (std::size_t b = 0; b < contiguous.size(); ++b)
        contiguous[b] = is_contiguous(weights.batches()[b]);
    }

    /**
     * Whether the coefficients of each row in x of the batch follow each other
     * in memory.
     */
    bool
    is_contiguous(const typename CellBatches<dim>::Batch &batch) const
    {
      if (batch.end_lane < simd_width)
        return false;
      const auto first = space.cell_functions(batch.first_cell);
      for (unsigned int lane = 0; lane < simd_width; ++lane)
        {
          const auto numbers = space.cell_functions(batch.first_cell + lane);
          for (unsigned int r = 0; r < n_rows; ++r)
            for (unsigned int a = 0; a < n; ++a)
              if (numbers[r * n + a] != first[r * n] + lane + a)
                return false;
        }
      return true;
    }

    void
    gather(const std::size_t                        b,
           const typename CellBatches<dim>::Batch &batch,
           const double *                           source,
           Simd *                                   values) const
    {
      const unsigned int *first =
        space.cell_functions(batch.first_cell).data();
      if (contiguous[b])
        for (unsigned int r = 0; r < n_rows; ++r)
          for (unsigned int a = 0; a < n; ++a)
            values[r * n + a] = load(source + first[r * n] + a);
      else
        for (unsigned int i = 0; i < n * n_rows; ++i)
          {
            values[i] = 0.;
            for (unsigned int lane = 0; lane < batch.end_lane; ++lane)
              values[i][lane] = source[first[lane * n * n_rows + i]];
          }
    }

    void
    scatter_add(const std::size_t                        b,
                const typename CellBatches<dim>::Batch &batch,
                const Simd *                             values,
                double *                                 target) const
    {
      const unsigned int *first =
        space.cell_functions(batch.first_cell).data();
      if (contiguous[b])
        // Neighbouring functions of a row overlap in memory: go through the
        // rows first, so that a load does not wait for the store before it.
        for (unsigned int a = 0; a < n; ++a)
          for (unsigned int r = 0; r < n_rows; ++r)
            {
              double *address = target + first[r * n] + a;
              store(load(address) + values[r * n + a], address);
            }
      else
        for (unsigned int i = 0; i < n * n_rows; ++i)
          for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
               ++lane)
            target[first[lane * n * n_rows + i]] += values[i][lane];
    }

    /**
     * Basis values of a batch.
     */
    struct Tables
    {
      Simd          x[ShapeTables<dim>::max_size];
      const double *y;
      const double *z;
    };

    void
    load_tables(const ShapeTables<dim> &                 shape,
                const typename CellBatches<dim>::Batch &batch,
                Tables &                                 result) const
    {
      shape.load_x(batch.index[0], result.x);
      result.y = shape.values(1, batch.index[1]);
      result.z = dim == 3 ? shape.values(dim - 1, batch.index[dim - 1]) :
                            nullptr;
    }

    const SplineSpace<dim> &   space;
    ShapeTables<dim>           tables;
    CellKernels                kernels;
    unsigned int               n;
    unsigned int               n_rows;
    std::vector<unsigned char> contiguous;
  };



  template <int dim>
  CrossMassOperator<dim>::CrossMassOperator() = default;

  template <int dim>
  CrossMassOperator<dim>::~CrossMassOperator() = default;

  template <int dim>
  CrossMassOperator<dim>::CrossMassOperator(CrossMassOperator &&) noexcept =
    default;

  template <int dim>
  CrossMassOperator<dim> &
  CrossMassOperator<dim>::operator=(CrossMassOperator &&) noexcept = default;



  template <int dim>
  CrossMassOperator<dim>::CrossMassOperator(const SplineSpace<dim> &r,
                                            const SplineSpace<dim> &c,
                                            const DensityWeights<dim> &w)
    : weights(&w)
    , rows(std::make_unique<Side>(r, w))
    , columns(&r == &c ? nullptr : std::make_unique<Side>(c, w))
  {}



  template <int dim>
  void
  CrossMassOperator<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    apply(*rows, columns ? *columns : *rows, dst, src);
  }



  template <int dim>
  void
  CrossMassOperator<dim>::Tvmult(VectorType &dst, const VectorType &src) const
  {
    apply(columns ? *columns : *rows, *rows, dst, src);
  }



  template <int dim>
  void
  CrossMassOperator<dim>::apply(const Side &      out,
                                const Side &      in,
                                VectorType &      dst,
                                const VectorType &src) const
  {
    Assert(src.get_partitioner().get() == in.space.partitioner().get() &&
             dst.get_partitioner().get() == out.space.partitioner().get(),
           ExcMessage("Vectors have to be made by the space."));
    const bool communicate = src.get_partitioner()->n_mpi_processes() > 1;
    if (communicate)
      src.update_ghost_values();
    dst = 0.;

    const unsigned int    n_points = weights->n_points();
    typename Side::Tables in_tables, out_tables;
    Simd                  coefficients[max_cell_size(dim)];
    Simd                  values[max_cell_size(dim)];
    for (std::size_t b = 0; b < weights->batches().size(); ++b)
      {
        const auto &  batch = weights->batches()[b];
        const double *w     = (*weights)[b];

        in.load_tables(in.tables, batch, in_tables);
        in.gather(b, batch, src.begin(), coefficients);
        in.kernels.interpolate(
          coefficients, in_tables.x, in_tables.y, in_tables.z, values);
        for (unsigned int q = 0; q < n_points; ++q)
          values[q] *= load(w + q * simd_width);
        if (&in != &out)
          out.load_tables(out.tables, batch, out_tables);
        const auto &tables = &in == &out ? in_tables : out_tables;
        out.kernels.integrate(
          values, tables.x, tables.y, tables.z, coefficients);
        out.scatter_add(b, batch, coefficients, dst.begin());
      }

    if (communicate)
      {
        dst.compress(VectorOperation::add);
        src.zero_out_ghost_values();
      }
  }



  template <int dim>
  void
  CrossMassOperator<dim>::row_sums(VectorType &dst) const
  {
    integrate(dst, Functions::ConstantFunction<dim>(1.));
  }



  template <int dim>
  void
  CrossMassOperator<dim>::diagonal(VectorType &dst) const
  {
    dst                      = 0.;
    ShapeTables<dim> squares = rows->tables;
    squares.square();

    typename Side::Tables tables;
    Simd                  values[max_cell_size(dim)];
    Simd                  result[max_cell_size(dim)];
    for (std::size_t b = 0; b < weights->batches().size(); ++b)
      {
        const auto &batch = weights->batches()[b];
        rows->load_tables(squares, batch, tables);
        for (unsigned int q = 0; q < weights->n_points(); ++q)
          values[q] = load((*weights)[b] + q * simd_width);
        rows->kernels.integrate(values, tables.x, tables.y, tables.z, result);
        rows->scatter_add(b, batch, result, dst.begin());
      }
    dst.compress(VectorOperation::add);
  }



  template <int dim>
  void
  CrossMassOperator<dim>::integrate(VectorType &         dst,
                                    const Function<dim> &f) const
  {
    dst = 0.;
    const auto *constant =
      dynamic_cast<const Functions::ConstantFunction<dim> *>(&f);

    typename Side::Tables tables;
    Simd                  values[max_cell_size(dim)];
    Simd                  result[max_cell_size(dim)];
    std::vector<double>   f_values(weights->n_points());
    for (std::size_t b = 0; b < weights->batches().size(); ++b)
      {
        const auto &batch = weights->batches()[b];
        rows->load_tables(rows->tables, batch, tables);
        for (unsigned int q = 0; q < weights->n_points(); ++q)
          values[q] = load((*weights)[b] + q * simd_width);
        if (constant != nullptr)
          for (unsigned int q = 0; q < weights->n_points(); ++q)
            values[q] *= constant->value(Point<dim>());
        else
          for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
               ++lane)
            {
              MultiIndex<dim> cell = batch.index;
              cell[0] += lane;
              f.value_list(weights->points(rows->space, cell), f_values);
              for (unsigned int q = 0; q < weights->n_points(); ++q)
                values[q][lane] = values[q][lane] * f_values[q];
            }
        rows->kernels.integrate(values, tables.x, tables.y, tables.z, result);
        rows->scatter_add(b, batch, result, dst.begin());
      }
    dst.compress(VectorOperation::add);
  }



  template <int dim>
  std::pair<double, double>
  CrossMassOperator<dim>::difference(const VectorType &   coefficients,
                                     const Function<dim> &f) const
  {
    coefficients.update_ghost_values();

    std::array<double, 2> sums{{0., 0.}};
    typename Side::Tables tables;
    Simd                  local[max_cell_size(dim)];
    Simd                  values[max_cell_size(dim)];
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
            MultiIndex<dim> cell = batch.index;
            cell[0] += lane;
            f.value_list(weights->points(rows->space, cell), f_values);
            for (unsigned int q = 0; q < weights->n_points(); ++q)
              {
                const double w     = (*weights)[b][q * simd_width + lane];
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



  template <int dim>
  std::size_t
  CrossMassOperator<dim>::memory_consumption() const
  {
    return weights->batches().size() * weights->n_points() * simd_width *
           sizeof(double);
  }



  std::pair<double, std::vector<unsigned int>>
  fill_inactive(VectorType &diagonal)
  {
    std::vector<unsigned int> inactive;
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      if (diagonal.local_element(i) == 0.)
        inactive.push_back(i);
    const double largest = diagonal.linfty_norm();
    AssertThrow(largest > 0,
                ExcMessage("The density is zero everywhere: the mass matrix "
                           "has no active coefficient."));
    for (const unsigned int i : inactive)
      diagonal.local_element(i) = largest;
    return {largest, inactive};
  }



  template <int dim>
  void
  MassOperator<dim>::reinit(const SplineSpace<dim> &    space,
                            const DensityWeights<dim> &weights)
  {
    Assert(space.n_components() == 1,
           ExcMessage("The mass matrix is the same for all components; use a "
                      "space with one."));
    spline_space = &space;
    cross        = CrossMassOperator<dim>(space, space, weights);
    space.initialize_vector(matrix_diagonal);
    cross.diagonal(matrix_diagonal);
    std::tie(inactive_diagonal, inactive_functions) =
      fill_inactive(matrix_diagonal);
  }



  template <int dim>
  void
  MassOperator<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    cross.vmult(dst, src);
    for (const unsigned int i : inactive_functions)
      dst.local_element(i) = inactive_diagonal * src.local_element(i);
  }



  template <int dim>
  VectorType
  MassOperator<dim>::lumped() const
  {
    VectorType sums;
    initialize_dof_vector(sums);
    cross.row_sums(sums);
    for (const unsigned int i : inactive_functions)
      sums.local_element(i) = inactive_diagonal;
    return sums;
  }



  template <int dim>
  types::global_dof_index
  MassOperator<dim>::n_active() const
  {
    return Utilities::MPI::sum(types::global_dof_index(
                                 spline_space->n_locally_owned_dofs() -
                                 inactive_functions.size()),
                               spline_space->communicator());
  }



  template class CrossMassOperator<2>;
  template class CrossMassOperator<3>;
  template class MassOperator<2>;
  template class MassOperator<3>;
} // namespace greville
