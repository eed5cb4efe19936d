// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/paper/mass_matrix.h>

namespace greville
{
  using namespace dealii;

  static_assert(sizeof(PetscInt) == sizeof(types::global_dof_index),
                "deal.II and PETSc must both have 32-bit or 64-bit indices.");

  template <int dim>
  MassMatrix<dim>::MassMatrix(const ExtendedMass<dim>         &mass,
                              const UpperTriangle             &entries,
                              const std::vector<unsigned int> &inactive,
                              const double inactive_diagonal)
  {
    const SplineSpace<dim> &space = mass.matrix().space();
    const MPI_Comm          comm  = space.communicator();
    checked_index<PetscInt>(space.n_dofs(), "rows of a matrix");
    const PetscInt n_owned = space.n_locally_owned_dofs();
    const PetscInt first   = space.partitioner()->local_range().first;

    // The numbers of unknowns, also of other processes; -1: no unknown.
    std::vector<bool> is_inactive(n_owned, false);
    for (const unsigned int f : inactive)
      is_inactive[f] = true;
    VectorType numbers;
    mass.unknowns().initialize_vector(numbers, 1);
    for (unsigned int u = 0; u < mass.unknowns().n_owned_unknowns(); ++u)
      {
        const unsigned int f     = mass.unknowns().unknown_functions()[u];
        numbers.local_element(u) = is_inactive[f] ? -1. : double(first + f);
      }
    numbers.update_ghost_values();

    std::vector<PetscInt>    rows, columns;
    std::vector<PetscScalar> values;
    const auto               add =
      [&](const PetscInt i, const PetscInt j, const double value) {
        rows.push_back(i);
        columns.push_back(j);
        values.push_back(value);
      };
    for (unsigned int u = 0; u < entries.size(); ++u)
      for (std::size_t e = entries.row_begin[u]; e < entries.row_begin[u + 1];
           ++e)
        {
          const PetscInt i = PetscInt(numbers.local_element(u));
          const PetscInt j =
            PetscInt(numbers.local_element(entries.columns[e]));
          if (i < 0 || j < 0)
            continue;
          add(i, j, entries.values[e]);
          if (i != j)
            add(j, i, entries.values[e]);
        }
    for (const unsigned int f : inactive)
      add(first + f, first + f, inactive_diagonal);

    Mat mat;
    check_petsc(MatCreate(comm, &mat));
    matrix.reset(mat);
    check_petsc(
      MatSetSizes(mat, n_owned, n_owned, PETSC_DETERMINE, PETSC_DETERMINE));
    check_petsc(MatSetType(mat, MATMPIAIJ));
    check_petsc(
      MatSetPreallocationCOO(mat, rows.size(), rows.data(), columns.data()));
    // Gauss-Seidel must not treat rows of equal pattern as blocks.
    check_petsc(MatSetOption(mat, MAT_USE_INODES, PETSC_FALSE));
    check_petsc(MatSetValuesCOO(mat, values.data(), INSERT_VALUES));
    check_petsc(MatSetOption(mat, MAT_SYMMETRIC, PETSC_TRUE));
    check_petsc(MatSetOption(mat, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
    view_dst = PetscVectorView(comm, n_owned);
    view_src = PetscVectorView(comm, n_owned);
  }



  GREVILLE_INSTANTIATE_CLASS(MassMatrix);
} // namespace greville
