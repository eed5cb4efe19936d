// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/aligned_vector.h>

#include <greville/base/index_limits.h>
#include <greville/stiffness/tangent_level.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TangentLevel<dim>::TangentLevel(const SplineSpace<dim>           &space,
                                  const std::vector<unsigned char> &constrained)
    // The quadrature is exact for products with functions of lower order.
    : ExtendedLevel<dim>(space, dim, constrained, 2 * space.degree())
  {
    block.reinit(this->extended_mass);
    blocks.reinit(this->extended_mass.matrix());
  }



  template <int dim>
  void
  TangentLevel<dim>::begin(const CellFilling<dim> &filling, const bool changed)
  {
    this->begin_level(filling, changed);
    block.begin(changed);
  }



  template <int dim>
  void
  TangentLevel<dim>::finish_mass(const bool lump)
  {
    if (lump)
      mass().lump();
    this->extended_mass.finish();
  }



  template <int dim>
  void
  TangentLevel<dim>::begin_tangent()
  {
    blocks.clear();
  }



  template <int dim>
  void
  TangentLevel<dim>::finish_tangent(const double mass_factor)
  {
    if (mass_factor != 0.)
      blocks.add(mass_factor, this->extended_mass.matrix());

    // The products with the unknowns, without the contributions of extended
    // functions.
    VectorType &result   = this->result;
    result               = 0.;
    const auto &unknowns = this->extended_mass.unknowns();
    const auto &places   = unknowns.unknown_places();
    for (unsigned int u = 0; u < places.size(); ++u)
      if (places[u] != numbers::invalid_unsigned_int)
        for (unsigned int c = 0; c < dim; ++c)
          result.local_element(u * dim + c) = blocks.diagonal(places[u], c);
    unknowns.for_each_image_of_unknown(
      [&](const unsigned int u, const std::size_t place) {
        for (unsigned int c = 0; c < dim; ++c)
          result.local_element(u * dim + c) += blocks.diagonal(place, c);
      });
    this->set_diagonal();
  }



  template <int dim>
  void
  TangentLevel<dim>::multiply_at_places(
    VectorType                                            &dst,
    const VectorType                                      &src,
    const std::function<void(double *y, const double *x)> &product) const
  {
    this->multiply_unknowns(dst, src, [&]() {
      this->extended_mass.unknowns().multiply(this->result,
                                              this->source,
                                              dim,
                                              product);
    });
  }



  template <int dim>
  std::unique_ptr<ExtendedLattice<dim>>
  TangentLevel<dim>::make_lattice() const
  {
    using Lattice  = ExtendedLattice<dim>;
    using Position = typename Lattice::Position;

    class TangentLattice : public Lattice
    {
    public:
      TangentLattice(const TangentLevel<dim> &level)
        : Lattice(level.extended_mass,
                  level.spline_extension,
                  level.constrained,
                  level.largest_diagonal())
        , level(level)
      {}

      unsigned int
      n_components() const override
      {
        return dim;
      }

      void
      for_each_row(const std::function<void(const Position &, const double *)>
                     &visit) const override
      {
        std::vector<double> row(level.blocks.size_of_row());
        this->for_each_place([&](const Position &i, const unsigned int place) {
          std::copy_n(level.blocks.row(place), row.size(), row.begin());
          visit(i, row.data());
        });
      }

      void
      multiply(SingleVector &y, SingleVector &x) const override
      {
        level.extended_mass.unknowns().template multiply<float>(
          y, x, dim, [&](float *to, const float *from) {
            level.blocks.multiply(to, from);
          });
      }

      std::vector<OverlappingCholesky>
      factorize(const CholeskyParameters &parameters,
                const bool                by_components) const override
      {
        return level.factorize(parameters, by_components);
      }

    private:
      const TangentLevel<dim> &level;
    };

    return std::make_unique<TangentLattice>(*this);
  }



  template <int dim>
  void
  TangentLevel<dim>::multiply_mass(VectorType &dst, const VectorType &src) const
  {
    this->extended_mass.unknowns().read(this->source, src, dim);
    this->extended_mass.vmult(this->result, this->source, dim);
    this->extended_mass.unknowns().write(dst, this->result, dim);
  }



  template <int dim>
  const ExtendedMass<dim> &
  TangentLevel<dim>::diagonal_block(const unsigned int components) const
  {
    blocks.diagonal_block(block.matrix(), components);
    return block;
  }



  namespace
  {
    template <int dim>
    struct Block
    {
      unsigned int                 column; // local unknown
      std::array<float, dim * dim> values;
    };



    /// Blocks by rows: row u begins at begin[u] and has size[u] blocks.
    template <int dim>
    struct BlockRows
    {
      std::vector<std::size_t>  begin;
      std::vector<unsigned int> size;
      AlignedVector<Block<dim>> blocks;
    };



    /**
     * Return the blocks of E^T B E that this process contributes, by rows of
     * local unknowns, with ascending columns and without constrained rows and
     * columns. @p constrained contains components (bits) of local functions and
     * of local unknowns.
     */
    template <int dim>
    BlockRows<dim>
    extended_blocks(const BlockStencil<dim, float>   &blocks,
                    const ExtendedMass<dim>          &extended,
                    const std::vector<unsigned char> &constrained,
                    const std::vector<unsigned char> &constrained_unknowns)
    {
      const unsigned int         n = constrained_unknowns.size();
      std::vector<unsigned char> constrained_at(extended.matrix().size(),
                                                0); // place
      for (unsigned int f = 0; f < constrained.size(); ++f)
        constrained_at[extended.matrix().place(f)] = constrained[f];
      for (const auto &[f, place] : extended.matrix().images())
        constrained_at[place] = constrained[f];

      // Call visit(u, v, place_u, place_v, weight, entry_of) for pairs of
      // unknowns, with the entries entry_of(c, d) of their components.
      const auto for_each_entry = [&](const auto &visit) {
        const auto add = [&](const unsigned int i,
                             const unsigned int j,
                             const auto        &entry_of) {
          extended.unknowns().for_each_unknown(
            i, [&](const unsigned int u, const double weight_u) {
              extended.unknowns().for_each_unknown(
                j, [&](const unsigned int v, const double weight_v) {
                  visit(u, v, i, j, weight_u * weight_v, entry_of);
                });
            });
        };
        extended.matrix().for_each_row([&](const unsigned int i) {
          blocks.for_each_block(i,
                                [&](const unsigned int j, const double *block) {
                                  add(i, j, [&](const int c, const int d) {
                                    return block[c * dim + d];
                                  });
                                  if (j != i)
                                    add(j, i, [&](const int c, const int d) {
                                      return block[d * dim + c];
                                    });
                                });
        });
      };
      BlockRows<dim> rows;
      rows.begin.assign(n + 1, 0);
      rows.size.assign(n, 0);
      for_each_entry(
        [&](const unsigned int u, const auto &...) { ++rows.begin[u + 1]; });
      std::partial_sum(rows.begin.begin(),
                       rows.begin.end(),
                       rows.begin.begin());
      rows.blocks.resize_fast(rows.begin[n]);
      for_each_entry([&](const unsigned int u,
                         const unsigned int v,
                         const unsigned int i,
                         const unsigned int j,
                         const double       weight,
                         const auto        &entry_of) {
        const unsigned int constrained_i =
          constrained_at[i] | constrained_unknowns[u];
        const unsigned int constrained_j =
          constrained_at[j] | constrained_unknowns[v];
        Block<dim> &entry = rows.blocks[rows.begin[u] + rows.size[u]++];
        entry.column      = v;
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            entry.values[c * dim + d] =
              ((constrained_i >> c) & 1) || ((constrained_j >> d) & 1)
                ? 0.
                : weight * entry_of(c, d);
      });
      for (unsigned int u = 0; u < n; ++u)
        {
          // Most rows are sorted already, since unknowns have the order of
          // places.
          const auto is_before = [](const auto &a, const auto &b) {
            return a.column < b.column;
          };
          Block<dim> *const row = rows.blocks.data() + rows.begin[u];
          Block<dim> *const end = row + rows.size[u];
          if (!std::is_sorted(row, end, is_before))
            std::sort(row, end, is_before);
          unsigned int n_columns = 0;
          for (const Block<dim> *entry = row; entry != end; ++entry)
            if (n_columns > 0 && row[n_columns - 1].column == entry->column)
              for (unsigned int k = 0; k < dim * dim; ++k)
                row[n_columns - 1].values[k] += entry->values[k];
            else
              row[n_columns++] = *entry;
          rows.size[u] = n_columns;
        }
      return rows;
    }



    /**
     * Attach translations and rotations to the matrix as near-null space: the
     * coefficients of a linear field are its values at the Greville points.
     */
    template <int dim>
    void
    set_rigid_body_modes(const Mat                        matrix,
                         const SplineSpace<dim>          &space,
                         const std::vector<unsigned int> &functions)
    {
      Vec coordinates;
      check_petsc(MatCreateVecs(matrix, &coordinates, nullptr));
      const PetscVector owner(coordinates);
      check_petsc(VecSetBlockSize(coordinates, dim));
      PetscScalar *values;
      check_petsc(VecGetArray(coordinates, &values));
      for (unsigned int u = 0; u < functions.size(); ++u)
        {
          const Point<dim> x = space.greville_point(functions[u]);
          for (unsigned int d = 0; d < dim; ++d)
            values[u * dim + d] = x[d];
        }
      check_petsc(VecRestoreArray(coordinates, &values));
      MatNullSpace modes;
      check_petsc(MatNullSpaceCreateRigidBody(coordinates, &modes));
      check_petsc(MatSetNearNullSpace(matrix, modes));
      check_petsc(MatNullSpaceDestroy(&modes));
    }
  } // namespace



  template <int dim>
  PetscMatrix
  TangentLevel<dim>::petsc_matrix() const
  {
    const ExtendedMass<dim>          &extended_mass = this->extended_mass;
    const std::vector<unsigned char> &constrained   = this->constrained;
    const InterleavedLayout          &layout =
      *extended_mass.unknowns().unknown_layout();
    const auto    &functions = extended_mass.unknowns().unknown_functions();
    const MPI_Comm comm      = this->space().communicator();
    checked_index<PetscInt>(
      Utilities::MPI::sum<std::uint64_t>(layout.n_owned() * dim, comm),
      "rows of a matrix");

    // The constrained unknowns of other processes are needed, too.
    VectorType column;
    extended_mass.unknowns().initialize_vector(column, 1);
    for (unsigned int u = 0; u < functions.size(); ++u)
      column.local_element(u) = constrained[functions[u]];
    column.update_ghost_values();
    std::vector<unsigned char> constrained_local(layout.n_local());
    for (unsigned int u = 0; u < constrained_local.size(); ++u)
      constrained_local[u] =
        static_cast<unsigned char>(column.local_element(u));

    const auto            rows    = extended_blocks<dim>(blocks,
                                           extended_mass,
                                           constrained,
                                           constrained_local);
    const PetscInt        n_owned = layout.n_owned() * dim;
    std::vector<PetscInt> n_diagonal(n_owned, dim), n_other(n_owned, 0);
    for (unsigned int u = 0; u < layout.n_owned(); ++u)
      for (unsigned int c = 0; c < dim; ++c)
        {
          const auto is_owned = [&](const Block<dim> &block) {
            return block.column < layout.n_owned();
          };
          const Block<dim> *const row = rows.blocks.data() + rows.begin[u];
          const PetscInt n = std::count_if(row, row + rows.size[u], is_owned);
          n_diagonal[u * dim + c] = std::max<PetscInt>(n, 1) * dim;
          n_other[u * dim + c]    = (rows.size[u] - n) * dim;
        }
    Mat mat;
    check_petsc(MatCreate(comm, &mat));
    PetscMatrix matrix(mat);
    check_petsc(
      MatSetSizes(mat, n_owned, n_owned, PETSC_DETERMINE, PETSC_DETERMINE));
    check_petsc(MatSetBlockSize(mat, dim));
    check_petsc(MatSetType(mat, MATAIJ));
    check_petsc(MatSeqAIJSetPreallocation(mat, 0, n_diagonal.data()));
    check_petsc(
      MatMPIAIJSetPreallocation(mat, 0, n_diagonal.data(), 0, n_other.data()));
    // Rows at the boundary of a process receive entries from its neighbours.
    check_petsc(MatSetOption(mat, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
    std::vector<PetscInt>    columns;
    std::vector<PetscScalar> values; // dim rows
    for (unsigned int u = 0; u < rows.size.size(); ++u)
      {
        const Block<dim> *const row = rows.blocks.data() + rows.begin[u];
        const PetscInt          i   = layout.global_number(u);
        const unsigned int      n   = rows.size[u];
        columns.resize(n);
        values.resize(n * dim * dim);
        for (unsigned int k = 0; k < n; ++k)
          {
            columns[k] = layout.global_number(row[k].column);
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                values[(c * n + k) * dim + d] = row[k].values[c * dim + d];
          }
        check_petsc(MatSetValuesBlocked(
          mat, 1, &i, n, columns.data(), values.data(), ADD_VALUES));
      }
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < dim; ++c)
        {
          const PetscInt i = layout.global_number(u) * dim + c;
          if ((constrained[functions[u]] >> c) & 1)
            check_petsc(MatSetValue(mat,
                                    i,
                                    i,
                                    this->all_diagonal.local_element(
                                      functions[u] * dim + c),
                                    ADD_VALUES));
        }
    check_petsc(MatAssemblyBegin(mat, MAT_FINAL_ASSEMBLY));
    check_petsc(MatAssemblyEnd(mat, MAT_FINAL_ASSEMBLY));
    return matrix;
  }



  template <int dim>
  void
  TangentLevel<dim>::set_modes(const PetscMatrix &matrix) const
  {
    set_rigid_body_modes(matrix.get(),
                         this->space(),
                         this->extended_mass.unknowns().unknown_functions());
  }



  template class TangentLevel<2>;
  template class TangentLevel<3>;
} // namespace greville
