#include <deal.II/base/quadrature_lib.h>

#include <greville/mass/mass_matrix.h>
#include <greville/mass/mass_operator.h>

#include <algorithm>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int lower = 0, length = 1;
  }



  template <int dim>
  void
  MassMatrix<dim>::reinit(const SplineSpace<dim> &space)
  {
    Assert(space.n_components() == 1,
           ExcMessage("The mass matrix is the same for all components; use a "
                      "space with one."));
    matrix.reset();
    extended_matrix.reset();
    spline_space = &space;
    find_row_boxes();

    const PetscInt n_owned = space.n_locally_owned_dofs();
    const MPI_Comm comm    = space.communicator();
    view_dst               = PetscVectorView(comm, n_owned);
    view_src               = PetscVectorView(comm, n_owned);

    const bool is_parallel = Utilities::MPI::n_mpi_processes(comm) > 1;
    make_parallel_pattern();

    Mat mat;
    check_petsc(MatCreateMPIAIJWithSplitArrays(
      comm,
      n_owned,
      n_owned,
      PETSC_DETERMINE,
      PETSC_DETERMINE,
      is_parallel ? diagonal_begin.data() : row_begin.data(),
      diagonal_columns.data(),
      is_parallel ? diagonal_values.data() : box_values.data(),
      remote_begin.data(),
      remote_columns.data(),
      remote_values.data(),
      &mat));
    matrix.reset(mat);
    check_petsc(MatSetOption(mat, MAT_SYMMETRIC, PETSC_TRUE));
    check_petsc(MatSetOption(mat, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  }



  template <int dim>
  void
  MassMatrix<dim>::find_row_boxes()
  {
    const SplineSpace<dim> &space   = *spline_space;
    const unsigned int      p       = space.degree();
    const auto             &extents = space.n_functions();

    boxes.assign(dim, {});
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < extents[d]; ++i)
        {
          const unsigned int begin = i - std::min(i, p);
          boxes[d][lower].push_back(begin);
          boxes[d][length].push_back(std::min(i + p + 1, extents[d]) - begin);
        }

    row_begin.assign(1, 0);
    for (const auto *functions :
         {&space.owned_functions(), &space.ghost_functions()})
      for (const std::uint64_t position : *functions)
        {
          const auto    index = multi_index<dim>(position, extents);
          std::uint64_t size  = 1;
          for (unsigned int d = 0; d < dim; ++d)
            size *= boxes[d][length][index[d]];
          AssertThrow(row_begin.back() + size <
                        std::uint64_t(std::numeric_limits<PetscInt>::max()),
                      ExcMessage("The matrix has more entries on a process "
                                 "than PETSc's integers can count."));
          row_begin.push_back(row_begin.back() + size);
        }
    box_values.assign(row_begin.back(), 0.);
  }



  template <int dim>
  void
  MassMatrix<dim>::make_parallel_pattern()
  {
    const SplineSpace<dim> &space   = *spline_space;
    const auto             &extents = space.n_functions();
    const auto             &owned   = space.owned_functions();
    const bool              is_parallel =
      Utilities::MPI::n_mpi_processes(space.communicator()) > 1;

    const auto for_each_column = [&](const std::uint64_t row,
                                     const auto         &visit) {
      const auto      index = multi_index<dim>(row, extents);
      MultiIndex<dim> box;
      for (unsigned int d = 0; d < dim; ++d)
        box[d] = boxes[d][length][index[d]];
      const unsigned int n_runs = [&] {
        unsigned int n = 1;
        for (unsigned int d = 1; d < dim; ++d)
          n *= box[d];
        return n;
      }();
      const unsigned int run_length = box[0];
      box[0]                        = 1;
      for (unsigned int r = 0; r < n_runs; ++r)
        {
          auto column = multi_index<dim>(r, box);
          for (unsigned int d = 0; d < dim; ++d)
            column[d] += boxes[d][lower][index[d]];
          const std::uint64_t start = lexicographic<dim>(column, extents);
          for (unsigned int k = 0; k < run_length; ++k)
            visit(start + k);
        }
    };

    diagonal_columns.clear();
    remote_begin.assign(owned.size() + 1, 0);
    remote_columns.clear();
    if (!is_parallel)
      {
        diagonal_columns.reserve(row_begin.back());
        for (const std::uint64_t row : owned)
          for_each_column(row, [&](const std::uint64_t column) {
            diagonal_columns.push_back(column);
          });
        // PETSc wants pointers even to empty arrays.
        remote_columns.reserve(1);
        remote_values.reserve(1);
        return;
      }

    // Numbers of the columns that are not owned: those of owned rows, and of
    // the functions on own cells, which ghost rows meet.
    std::vector<std::uint64_t> remote = space.ghost_functions();
    for (const std::uint64_t row : owned)
      for_each_column(row, [&](const std::uint64_t column) {
        if (!std::binary_search(owned.begin(), owned.end(), column))
          remote.push_back(column);
      });
    std::sort(remote.begin(), remote.end());
    remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
    const auto remote_numbers = space.global_numbers(remote);
    std::unordered_map<std::uint64_t, PetscInt> number_of;
    for (std::size_t k = 0; k < remote.size(); ++k)
      number_of[remote[k]] = remote_numbers[k];

    diagonal_begin.assign(1, 0);
    diagonal_source.clear();
    remote_begin.assign(1, 0);
    remote_source.clear();
    std::vector<std::pair<PetscInt, unsigned int>> remote_row;
    unsigned int                                   place = 0;
    for (const std::uint64_t row : owned)
      {
        remote_row.clear();
        for_each_column(row, [&](const std::uint64_t column) {
          const auto found = number_of.find(column);
          if (found != number_of.end())
            remote_row.emplace_back(found->second, place);
          else
            {
              diagonal_columns.push_back(
                std::lower_bound(owned.begin(), owned.end(), column) -
                owned.begin());
              diagonal_source.push_back(place);
            }
          ++place;
        });
        std::sort(remote_row.begin(), remote_row.end());
        for (const auto &entry : remote_row)
          {
            remote_columns.push_back(entry.first);
            remote_source.push_back(entry.second);
          }
        diagonal_begin.push_back(diagonal_columns.size());
        remote_begin.push_back(remote_columns.size());
      }

    const PetscInt first_owned = space.partitioner()->local_range().first;
    ghost_rows.clear();
    ghost_columns.clear();
    for (const std::uint64_t row : space.ghost_functions())
      {
        ghost_rows.push_back(number_of.at(row));
        for_each_column(row, [&](const std::uint64_t column) {
          const auto found = number_of.find(column);
          const auto local =
            std::lower_bound(owned.begin(), owned.end(), column);
          ghost_columns.push_back(found != number_of.end() ? found->second
                                  : local != owned.end() && *local == column
                                    ? first_owned + (local - owned.begin())
                                    : -1);
        });
      }

    // At least one entry: PETSc wants pointers even to empty arrays.
    for (auto *columns : {&diagonal_columns, &remote_columns})
      columns->reserve(1);
    diagonal_values.assign(std::max<std::size_t>(1, diagonal_source.size()),
                           0.);
    remote_values.assign(std::max<std::size_t>(1, remote_source.size()), 0.);
  }



  template <int dim>
  void
  MassMatrix<dim>::assemble(const DensityWeights<dim>       &weights,
                            const Constraints               &constraints,
                            const std::vector<unsigned int> &lumped)
  {
    std::fill(box_values.begin(), box_values.end(), 0.);
    switch (spline_space->degree())
      {
        case 1:
          add_cells<2>(weights);
          break;
        case 2:
          add_cells<3>(weights);
          break;
        case 3:
          add_cells<4>(weights);
          break;
        case 4:
          add_cells<5>(weights);
          break;
        case 5:
          add_cells<6>(weights);
          break;
        default:
          Assert(false, ExcInternalError());
      }
    finish(constraints, lumped);
  }



  namespace
  {
    /**
     * Products N_a(x_q) N_b(x_q) in the cells of one direction, as tables
     * [q][a][b]. Cells further than p from both walls share one table.
     */
    template <int n>
    class ProductTables
    {
    public:
      void
      reinit(const KnotVector &knots, const QGauss<1> &quadrature)
      {
        n_cells = knots.n_elements();
        size    = quadrature.size() * n * n;
        values.resize(std::min<unsigned int>(n_cells, 2 * n - 1) * size);
        std::vector<double> shape(n);
        for (unsigned int e = 0; e < n_cells; ++e)
          if (e < n || e + n > n_cells)
            for (unsigned int q = 0; q < quadrature.size(); ++q)
              {
                const double lower = knots.element_lower(e);
                const double h     = knots.element_upper(e) - lower;
                knots.evaluate(e,
                               lower + h * quadrature.point(q)(0),
                               0,
                               make_array_view(shape));
                for (unsigned int a = 0; a < n; ++a)
                  for (unsigned int b = 0; b < n; ++b)
                    values[kind(e) * size + (q * n + a) * n + b] =
                      shape[a] * shape[b];
              }
      }

      const double *
      operator[](const unsigned int cell) const
      {
        return values.data() + kind(cell) * size;
      }

    private:
      unsigned int
      kind(const unsigned int cell) const
      {
        if (n_cells < 2 * n - 1 || cell < n)
          return cell;
        return cell + n > n_cells ? cell + 2 * n - 1 - n_cells : n - 1;
      }

      unsigned int        n_cells = 0;
      unsigned int        size    = 0;
      std::vector<double> values;
    };
  } // namespace



  template <int dim>
  template <int n>
  void
  MassMatrix<dim>::add_cells(const DensityWeights<dim> &weights)
  {
    constexpr unsigned int  nn    = n * n;
    constexpr unsigned int  n_z   = dim == 3 ? n : 1;
    const SplineSpace<dim> &space = *spline_space;
    const unsigned int      n_q   = weights.n_points_1d();
    const unsigned int      width = CellBatches<dim>::width();
    const QGauss<1>         quadrature(n_q);

    std::array<ProductTables<n>, dim> products;
    for (unsigned int d = 0; d < dim; ++d)
      products[d].reinit(space.knots(d), quadrature);

    // in_z[a_z, b_z][q_y][q_x], then in_zy[a_z, b_z][a_y, b_y][q_x]
    std::vector<double> in_z(n_z * n_z * n_q * n_q);
    std::vector<double> in_zy(n_z * n_z * nn * n_q);

    for (std::size_t batch_number = 0; batch_number < weights.batches().size();
         ++batch_number)
      {
        const auto &batch = weights.batches()[batch_number];
        for (unsigned int lane = batch.first_lane; lane < batch.end_lane;
             ++lane)
          {
            MultiIndex<dim> cell = batch.index;
            cell[0] += lane;
            const double      *w    = weights[batch_number] + lane;
            const unsigned int n_xy = n_q * n_q;

            // Integrate over z (in 3D), then over y, for all pairs.
            if (dim == 3)
              {
                const double *table = products[dim - 1][cell[dim - 1]];
                for (unsigned int ab = 0; ab < nn; ++ab)
                  for (unsigned int q = 0; q < n_xy; ++q)
                    {
                      double sum = 0;
                      for (unsigned int q_z = 0; q_z < n_q; ++q_z)
                        sum +=
                          table[q_z * nn + ab] * w[(q_z * n_xy + q) * width];
                      in_z[ab * n_xy + q] = sum;
                    }
              }
            else
              for (unsigned int q = 0; q < n_xy; ++q)
                in_z[q] = w[q * width];

            const double *table_y = products[1][cell[1]];
            for (unsigned int z = 0; z < n_z * n_z; ++z)
              for (unsigned int ab = 0; ab < nn; ++ab)
                for (unsigned int q_x = 0; q_x < n_q; ++q_x)
                  {
                    double sum = 0;
                    for (unsigned int q_y = 0; q_y < n_q; ++q_y)
                      sum += table_y[q_y * nn + ab] *
                             in_z[z * n_xy + q_y * n_q + q_x];
                    in_zy[(z * nn + ab) * n_q + q_x] = sum;
                  }

            // Integrate over x and add an n x n block of rows and columns at
            // a time.
            const double       *table_x = products[0][cell[0]];
            const unsigned int *rows =
              space.cell_functions(batch.first_cell + lane).data();
            for (unsigned int a_z = 0; a_z < n_z; ++a_z)
              for (unsigned int a_y = 0; a_y < n; ++a_y)
                {
                  // For each row: where its first column of this cell lies.
                  double            *target[n];
                  const unsigned int i_y      = cell[1] + a_y;
                  const unsigned int length_y = boxes[1][length][i_y];
                  for (unsigned int a_x = 0; a_x < n; ++a_x)
                    {
                      const unsigned int i_x   = cell[0] + a_x;
                      unsigned int       start = cell[1] - boxes[1][lower][i_y];
                      if (dim == 3)
                        start += (cell[dim - 1] -
                                  boxes[dim - 1][lower][cell[dim - 1] + a_z]) *
                                 length_y;
                      target[a_x] = box_values.data() +
                                    row_begin[rows[(a_z * n + a_y) * n + a_x]] +
                                    start * boxes[0][length][i_x] + cell[0] -
                                    boxes[0][lower][i_x];
                    }
                  for (unsigned int b_z = 0; b_z < n_z; ++b_z)
                    for (unsigned int b_y = 0; b_y < n; ++b_y)
                      {
                        const double *moments =
                          &in_zy[((a_z * n_z + b_z) * nn + a_y * n + b_y) *
                                 n_q];
                        double block[nn];
                        for (unsigned int ab = 0; ab < nn; ++ab)
                          block[ab] = moments[0] * table_x[ab];
                        for (unsigned int q = 1; q < n_q; ++q)
                          for (unsigned int ab = 0; ab < nn; ++ab)
                            block[ab] += moments[q] * table_x[q * nn + ab];

                        for (unsigned int a_x = 0; a_x < n; ++a_x)
                          {
                            double *run =
                              target[a_x] + (b_z * length_y + b_y) *
                                              boxes[0][length][cell[0] + a_x];
                            for (unsigned int b_x = 0; b_x < n; ++b_x)
                              run[b_x] += block[a_x * n + b_x];
                          }
                      }
                }
          }
      }
  }



  template <int dim>
  void
  MassMatrix<dim>::finish(const Constraints               &constraints,
                          const std::vector<unsigned int> &lumped)
  {
    Mat                     mat   = matrix.get();
    const SplineSpace<dim> &space = *spline_space;

    if (Utilities::MPI::n_mpi_processes(space.communicator()) > 1)
      {
        for (std::size_t k = 0; k < diagonal_source.size(); ++k)
          diagonal_values[k] = box_values[diagonal_source[k]];
        for (std::size_t k = 0; k < remote_source.size(); ++k)
          remote_values[k] = box_values[remote_source[k]];

        // Rows of ghost functions go to their owners.
        const unsigned int n_owned = space.n_locally_owned_dofs();
        for (unsigned int k = 0; k < ghost_rows.size(); ++k)
          {
            const PetscInt begin = row_begin[n_owned + k];
            check_petsc(
              MatSetValues(mat,
                           1,
                           &ghost_rows[k],
                           row_begin[n_owned + k + 1] - begin,
                           ghost_columns.data() + begin - row_begin[n_owned],
                           box_values.data() + begin,
                           ADD_VALUES));
          }
      }
    check_petsc(MatAssemblyBegin(mat, MAT_FINAL_ASSEMBLY));
    check_petsc(MatAssemblyEnd(mat, MAT_FINAL_ASSEMBLY));

    const bool is_special =
      Utilities::MPI::max<unsigned int>(!lumped.empty(), space.communicator()) >
      0;
    if (is_special)
      lump(lumped);
    extended_matrix.reset();
    unsigned int has_entries = 0;
    for (const auto &line : constraints.get_lines())
      has_entries |= !line.entries.empty();
    has_entries = Utilities::MPI::max(has_entries, space.communicator());
    if (has_entries != 0)
      extend(constraints);
    mat = petsc();

    VectorType diagonal;
    space.initialize_vector(diagonal);
    view_dst.with(diagonal.begin(),
                  [&](Vec vec) { check_petsc(MatGetDiagonal(mat, vec)); });
    if (has_entries != 0)
      for (const auto &line : constraints.get_lines())
        if (space.locally_owned_dofs().is_element(line.index))
          diagonal(line.index) = 0.;
    const auto inactive = fill_inactive(diagonal, constraints);
    inactive_functions  = inactive.second;

    std::vector<PetscInt> rows;
    for (const unsigned int i : inactive.second)
      rows.push_back(space.partitioner()->local_range().first + i);
    check_petsc(MatZeroRowsColumns(
      mat, rows.size(), rows.data(), inactive.first, nullptr, nullptr));
  }



  template <int dim>
  VectorType
  MassMatrix<dim>::active_diagonal() const
  {
    VectorType diagonal;
    spline_space->initialize_vector(diagonal);
    view_dst.with(diagonal.begin(),
                  [&](Vec vec) { check_petsc(MatGetDiagonal(petsc(), vec)); });
    for (const unsigned int i : inactive_functions)
      diagonal.local_element(i) = 0.;
    return diagonal;
  }



  template <int dim>
  void
  MassMatrix<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    view_src.with(src.begin(), [&](Vec x) {
      view_dst.with(dst.begin(),
                    [&](Vec y) { check_petsc(MatMult(petsc(), x, y)); });
    });
  }



  template <int dim>
  std::size_t
  MassMatrix<dim>::memory_consumption() const
  {
    MatInfo info{};
    if (extended_matrix)
      check_petsc(MatGetInfo(extended_matrix.get(), MAT_LOCAL, &info));
    return info.memory + box_values.size() * sizeof(double) +
           (diagonal_values.size() + remote_values.size()) *
             (sizeof(double) + sizeof(unsigned int)) +
           (diagonal_columns.size() + remote_columns.size() +
            ghost_columns.size() + row_begin.size()) *
             sizeof(PetscInt);
  }



  template class MassMatrix<2>;
  template class MassMatrix<3>;
} // namespace greville
