// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/multigrid/lattice_coupling.h>

#include <petscmat.h>

#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Collective. Make a matrix of the given numbers of own rows and columns
    /// from its entries, which are added up.
    PetscMatrix
    make_matrix(const PetscInt                  n_rows,
                const PetscInt                  n_columns,
                std::vector<PetscInt>           rows,
                std::vector<PetscInt>           columns,
                const std::vector<PetscScalar> &values,
                const MPI_Comm                  comm)
    {
      Mat mat;
      check_petsc(MatCreate(comm, &mat));
      PetscMatrix result(mat);
      check_petsc(
        MatSetSizes(mat, n_rows, n_columns, PETSC_DETERMINE, PETSC_DETERMINE));
      check_petsc(MatSetType(mat, MATAIJ));
      check_petsc(
        MatSetPreallocationCOO(mat, rows.size(), rows.data(), columns.data()));
      check_petsc(MatSetValuesCOO(mat, values.data(), INSERT_VALUES));
      return result;
    }



    /// Collective. Return P with rows for the owned unknowns of the finer
    /// level.
    template <int dim>
    PetscMatrix
    transfer_matrix(const LatticeUnknowns<dim> &coarse,
                    const InterleavedLayout    &fine)
    {
      std::vector<PetscInt>    rows, columns;
      std::vector<PetscScalar> values;
      coarse.for_each_weight(
        [&](const unsigned int f, const unsigned int u, const float weight) {
          for (unsigned int c = 0; c < dim; ++c)
            if (!coarse.is_constrained(u, c))
              {
                rows.push_back(fine.global_number(f) * dim + c);
                columns.push_back(coarse.layout()->global_number(u) * dim + c);
                values.push_back(weight);
              }
        });
      return make_matrix(fine.n_owned() * dim,
                         coarse.layout()->n_owned() * dim,
                         std::move(rows),
                         std::move(columns),
                         values,
                         fine.communicator());
    }



    /// Call visit(row, n, columns, weights) for the own rows, counted from 0.
    template <typename Visit>
    void
    for_each_row(const Mat matrix, const Visit &visit)
    {
      PetscInt begin, end;
      check_petsc(MatGetOwnershipRange(matrix, &begin, &end));
      for (PetscInt row = begin; row < end; ++row)
        {
          PetscInt           n;
          const PetscInt    *columns;
          const PetscScalar *values;
          check_petsc(MatGetRow(matrix, row, &n, &columns, &values));
          visit(row - begin, n, columns, values);
          check_petsc(MatRestoreRow(matrix, row, &n, &columns, &values));
        }
    }
  } // namespace



  template <int dim>
  void
  LatticeCoupling<dim>::add_keys(const std::vector<Tensor<2, dim>> &stiffness)
  {
    groups.push_back(stiffness);
    gaps.emplace_back(stiffness.size() * dim);
  }



  template <int dim>
  void
  LatticeCoupling<dim>::add_weights(const unsigned int         part,
                                    const InterleavedLayout   &layout,
                                    const std::vector<Weight> &weights,
                                    const std::vector<double> &factors)
  {
    std::vector<PetscInt>    rows, columns;
    std::vector<PetscScalar> values;
    for (const Weight &weight : weights)
      for (unsigned int c = 0; c < dim; ++c)
        if (((weight.constrained >> c) & 1) == 0)
          {
            rows.push_back(weight.key * dim + c);
            columns.push_back(weight.unknown * dim + c);
            values.push_back(weight.weight);
          }
    std::vector<double> of_rows;
    for (const double factor : factors)
      of_rows.insert(of_rows.end(), dim, factor);
    PetscMatrix G = make_matrix(of_rows.size(),
                                layout.n_owned() * dim,
                                std::move(rows),
                                std::move(columns),
                                values,
                                layout.communicator());
    PetscVectorView(layout.communicator(), of_rows.size())
      .with(of_rows.data(), [&](const Vec vector) {
        check_petsc(MatDiagonalScale(G.get(), vector, nullptr));
      });
    levels[0].push_back({unsigned(groups.size() - 1), part, std::move(G)});
  }



  template <int dim>
  void
  LatticeCoupling<dim>::coarsen(
    const std::vector<const LatticeUnknowns<dim> *> &transfers,
    const std::vector<const InterleavedLayout *>    &layouts)
  {
    std::vector<PetscMatrix> P(transfers.size());
    for (unsigned int part = 0; part < transfers.size(); ++part)
      if (transfers[part])
        P[part] = transfer_matrix(*transfers[part], *layouts[part]);
    std::vector<Term> level;
    for (const Term &term : levels.back())
      {
        Mat product = term.G.get();
        if (P[term.part])
          check_petsc(MatMatMult(term.G.get(),
                                 P[term.part].get(),
                                 MAT_INITIAL_MATRIX,
                                 PETSC_DEFAULT,
                                 &product));
        else
          check_petsc(
            PetscObjectReference(reinterpret_cast<PetscObject>(product)));
        level.push_back({term.group, term.part, PetscMatrix(product)});
      }
    levels.push_back(std::move(level));
  }



  template <int dim>
  void
  LatticeCoupling<dim>::add_product(const unsigned int level,
                                    Blocks            &y,
                                    const Blocks      &x,
                                    const double       factor) const
  {
    // Call action(G, unknowns, keys) for a term.
    const auto with_vectors = [&](const Term &term, const auto &action) {
      const MPI_Comm comm = x[term.part].get_mpi_communicator();
      of_keys.resize(gaps[term.group].size());
      of_unknowns.resize(x[term.part].locally_owned_size());
      PetscVectorView(comm, of_unknowns.size())
        .with(of_unknowns.data(), [&](const Vec unknowns) {
          PetscVectorView(comm, of_keys.size())
            .with(of_keys.data(), [&](const Vec keys) {
              action(term.G.get(), unknowns, keys);
            });
        });
    };
    for (std::vector<double> &of_group : gaps)
      std::fill(of_group.begin(), of_group.end(), 0.);
    for (const Term &term : levels[level])
      {
        const SingleVector &from = x[term.part];
        of_unknowns.assign(from.begin(),
                           from.begin() + from.locally_owned_size());
        with_vectors(term, [](const Mat G, const Vec unknowns, const Vec keys) {
          check_petsc(MatMult(G, unknowns, keys));
        });
        for (std::size_t i = 0; i < of_keys.size(); ++i)
          gaps[term.group][i] += of_keys[i];
      }
    for (unsigned int group = 0; group < groups.size(); ++group)
      for (std::size_t k = 0; k < groups[group].size(); ++k)
        {
          Tensor<1, dim> gap;
          std::copy_n(gaps[group].begin() + k * dim, dim, gap.begin_raw());
          gap = groups[group][k] * gap;
          std::copy_n(gap.begin_raw(), dim, gaps[group].begin() + k * dim);
        }
    for (const Term &term : levels[level])
      {
        of_keys = gaps[term.group];
        with_vectors(term, [](const Mat G, const Vec unknowns, const Vec keys) {
          check_petsc(MatMultTranspose(G, keys, unknowns));
        });
        for (std::size_t i = 0; i < of_unknowns.size(); ++i)
          y[term.part].local_element(i) += float(factor * of_unknowns[i]);
      }
  }



  template <int dim>
  void
  LatticeCoupling<dim>::for_each_key(const unsigned int level,
                                     const Visit       &visit) const
  {
    for (unsigned int group = 0; group < groups.size(); ++group)
      {
        std::vector<std::vector<Entry>> of_keys(groups[group].size());
        for (const Term &term : levels[level])
          if (term.group == group)
            for_each_row(term.G.get(),
                         [&](const unsigned int row,
                             const PetscInt     n,
                             const PetscInt    *columns,
                             const PetscScalar *values) {
                           for (PetscInt k = 0; k < n; ++k)
                             of_keys[row / dim].push_back(
                               {row % dim, term.part, columns[k], values[k]});
                         });
        for (std::size_t k = 0; k < of_keys.size(); ++k)
          visit(groups[group][k], of_keys[k]);
      }
  }



  template <int dim>
  std::vector<BlockEntry>
  LatticeCoupling<dim>::owned_entries(
    const unsigned int                            level,
    const std::vector<const InterleavedLayout *> &layouts) const
  {
    std::vector<unsigned int> begin{0};
    std::vector<PetscMatrix>  roots; // K^(1/2) G of the terms
    for (const InterleavedLayout *layout : layouts)
      begin.push_back(begin.back() + layout->n_owned());
    for (const Term &term : levels[level])
      {
        std::vector<double> scaling;
        for (const Tensor<2, dim> &K : groups[term.group])
          for (unsigned int c = 0; c < dim; ++c)
            scaling.push_back(std::sqrt(std::max(0., K[c][c])));
        Mat root;
        check_petsc(MatDuplicate(term.G.get(), MAT_COPY_VALUES, &root));
        roots.emplace_back(root);
        PetscVectorView(layouts[term.part]->communicator(), scaling.size())
          .with(scaling.data(), [&](const Vec vector) {
            check_petsc(MatDiagonalScale(root, vector, nullptr));
          });
      }
    std::vector<std::map<unsigned int, std::array<double, 3>>> rows(
      begin.back());
    for (unsigned int k = 0; k < roots.size(); ++k)
      for (unsigned int l = 0; l < roots.size(); ++l)
        {
          const Term &of_row = levels[level][k], &of_column = levels[level][l];
          if (of_row.group != of_column.group || of_row.part > of_column.part)
            continue;
          const InterleavedLayout &layout  = *layouts[of_column.part];
          const PetscInt           n_owned = layout.n_owned();
          const PetscInt first = n_owned > 0 ? layout.global_number(0) : 0;
          Mat            product;
          check_petsc(MatTransposeMatMult(roots[k].get(),
                                          roots[l].get(),
                                          MAT_INITIAL_MATRIX,
                                          PETSC_DEFAULT,
                                          &product));
          const PetscMatrix owner(product);
          for_each_row(product,
                       [&](const unsigned int row,
                           const PetscInt     n,
                           const PetscInt    *columns,
                           const PetscScalar *values) {
                         const unsigned int i = begin[of_row.part] + row / dim;
                         for (PetscInt e = 0; e < n; ++e)
                           {
                             const PetscInt v = columns[e] / dim - first;
                             if (v < 0 || v >= n_owned)
                               continue;
                             const unsigned int j = begin[of_column.part] + v;
                             if (i <= j)
                               rows[i][j][row % dim] += values[e];
                           }
                       });
        }
    std::vector<BlockEntry> result;
    for (unsigned int i = 0; i < rows.size(); ++i)
      for (const auto &[j, values] : rows[i])
        result.push_back({i, j, values});
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(LatticeCoupling);
} // namespace greville
