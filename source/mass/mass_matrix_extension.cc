#include <greville/mass/mass_matrix.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  MassMatrix<dim>::lump(const std::vector<unsigned int> &functions)
  {
    const SplineSpace<dim> &space = *spline_space;
    Mat                     mat   = matrix.get();
    VectorType              ones, sums, diagonal;
    for (VectorType *vector : {&ones, &sums, &diagonal})
      space.initialize_vector(*vector);
    const auto multiply = [&](VectorType &dst, const VectorType &src) {
      view_src.with(src.begin(), [&](Vec x) {
        view_dst.with(dst.begin(),
                      [&](Vec y) { check_petsc(MatMult(mat, x, y)); });
      });
    };
    std::vector<PetscInt> numbers;
    for (const unsigned int i : functions)
      {
        numbers.push_back(space.partitioner()->local_range().first + i);
        ones.local_element(i) = 1.;
      }
    multiply(diagonal, ones);
    ones = 1.;
    multiply(sums, ones);
    for (const unsigned int i : functions)
      diagonal.local_element(i) = sums.local_element(i);
    check_petsc(MatZeroRowsColumns(
      mat, numbers.size(), numbers.data(), 0., nullptr, nullptr));
    view_src.with(diagonal.begin(), [&](Vec vec) {
      check_petsc(MatDiagonalSet(mat, vec, ADD_VALUES));
    });
  }



  template <int dim>
  void
  MassMatrix<dim>::extend(const Constraints &constraints)
  {
    const SplineSpace<dim> &space   = *spline_space;
    const PetscInt          n_owned = space.n_locally_owned_dofs();
    const PetscInt          first   = space.partitioner()->local_range().first;

    // E by rows
    std::vector<PetscInt>    row_begins(1, 0), columns;
    std::vector<PetscScalar> values;
    for (PetscInt i = first; i < first + n_owned; ++i)
      {
        // An entry that is zero makes room for the diagonal of the result.
        const bool is_constrained = constraints.is_constrained(i);
        columns.push_back(i);
        values.push_back(is_constrained ? 0. : 1.);
        if (is_constrained)
          for (const auto &entry : *constraints.get_constraint_entries(i))
            {
              columns.push_back(entry.first);
              values.push_back(entry.second);
            }
        row_begins.push_back(columns.size());
      }
    // PETSc wants pointers even to empty arrays.
    columns.reserve(1);
    values.reserve(1);
    Mat expansion, product;
    check_petsc(MatCreateMPIAIJWithArrays(space.communicator(),
                                          n_owned,
                                          n_owned,
                                          PETSC_DETERMINE,
                                          PETSC_DETERMINE,
                                          row_begins.data(),
                                          columns.data(),
                                          values.data(),
                                          &expansion));
    const PetscMatrix owner(expansion);
    check_petsc(MatPtAP(
      matrix.get(), expansion, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &product));
    extended_matrix.reset(product);
    check_petsc(MatSetOption(product, MAT_SYMMETRIC, PETSC_TRUE));
    check_petsc(MatSetOption(product, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  }



  template void
  MassMatrix<2>::lump(const std::vector<unsigned int> &);
  template void
  MassMatrix<3>::lump(const std::vector<unsigned int> &);
  template void
  MassMatrix<2>::extend(const Constraints &);
  template void
  MassMatrix<3>::extend(const Constraints &);
} // namespace greville
