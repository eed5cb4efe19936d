#ifndef greville_mass_mass_matrix_h
#define greville_mass_mass_matrix_h

#include <greville/base/petsc.h>
#include <greville/mass/mass_operator.h>

namespace greville
{
  /**
   * The consistent mass matrix M_ij = sum_q w_q N_i(x_q) N_j(x_q), assembled as
   * a PETSc matrix (MPIAIJ). Row i has the columns j with |i_d - j_d| <= p in
   * each direction d: (2 p + 1)^dim entries away from the walls. Inactive,
   * constrained and lumped coefficients are treated as in MassOperator.
   *
   * The rows lie in arrays of this class, which PETSc uses in place. A row of
   * the arrays is filled run by run in x; its entries are found by arithmetic,
   * not by search. assemble() can be called again with new weights (each step
   * of a simulation has a new matrix). Where constraints have entries,
   * E^T M E is a second matrix, with the numbers of the first.
   */
  template <int dim>
  class MassMatrix
  {
  public:
    MassMatrix() = default;

    MassMatrix(const SplineSpace<dim>    &space,
               const DensityWeights<dim> &weights,
               const Constraints         &constraints = Constraints())
    {
      reinit(space);
      assemble(weights, constraints);
    }

    /**
     * Collective. Make the sparsity pattern. The space is kept by reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Collective. Fill the matrix. Arguments as of MassOperator.
     */
    void
    assemble(const DensityWeights<dim>       &weights,
             const Constraints               &constraints = Constraints(),
             const std::vector<unsigned int> &lumped      = {});

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    Mat
    petsc() const
    {
      return extended_matrix ? extended_matrix.get() : matrix.get();
    }

    /**
     * Whether the constraints have entries.
     */
    bool
    is_extended() const
    {
      return extended_matrix != nullptr;
    }

    /**
     * The diagonal, but zero where coefficients are inactive. Collective.
     */
    VectorType
    active_diagonal() const;

    void
    vmult(VectorType &dst, const VectorType &src) const;

    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }

    /**
     * Bytes of the arrays on this process.
     */
    std::size_t
    memory_consumption() const;

  private:
    void
    find_row_boxes();

    void
    make_parallel_pattern();

    template <int n>
    void
    add_cells(const DensityWeights<dim> &weights);

    void
    finish(const Constraints               &constraints,
           const std::vector<unsigned int> &lumped);

    void
    lump(const std::vector<unsigned int> &functions);

    void
    extend(const Constraints &constraints);

    const SplineSpace<dim> *spline_space = nullptr;

    // Rows of owned and then of ghost functions as boxes of columns in
    // lexicographic order. On one process they are the matrix.
    std::vector<std::array<std::vector<unsigned int>, 2>> boxes;
    std::vector<PetscInt>                                 row_begin;
    std::vector<double>                                   box_values;

    // The columns of the diagonal and of the off-diagonal part, and the place
    // of each entry in box_values.
    std::vector<PetscInt>     diagonal_begin, diagonal_columns;
    std::vector<double>       diagonal_values;
    std::vector<unsigned int> diagonal_source;
    std::vector<PetscInt>     remote_begin, remote_columns;
    std::vector<double>       remote_values;
    std::vector<unsigned int> remote_source;

    std::vector<PetscInt> ghost_rows;
    std::vector<PetscInt> ghost_columns; // -1: meets no owned cell

    PetscMatrix               matrix, extended_matrix;
    std::vector<unsigned int> inactive_functions;
    PetscVectorView           view_dst, view_src;
  };
} // namespace greville

#endif
