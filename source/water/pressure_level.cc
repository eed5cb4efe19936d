// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/index_limits.h>
#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/multigrid/lattice_levels.h>
#include <greville/water/pressure_level.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  PressureLevel<dim>::PressureLevel(const SplineSpace<dim> &space)
    : spline_space(space)
    , weights(space, space.degree() + 1)
  {
    matrix.reinit(space);
    volume.reinit(matrix);
    space.initialize_vector(all_diagonal);
  }



  template <int dim>
  void
  PressureLevel<dim>::begin(const CellFilling<dim>    &filling,
                            const std::vector<double> &parts,
                            const bool                 changed)
  {
    if (changed)
      extension.reinit(spline_space, filling);
    matrix.begin(extension, changed);
    volume.begin(changed);
    const std::vector<unsigned char> none(
      spline_space.owned_functions().size() +
      spline_space.ghost_functions().size());
    if (changed)
      {
        matrix.unknowns().hold(none);
        for (VectorType *vector : {&source, &result})
          matrix.unknowns().initialize_vector(*vector, 1);
        std::vector<bool> is_unknown(spline_space.owned_functions().size());
        for (const unsigned int f : matrix.unknowns().unknown_functions())
          is_unknown[f] = true;
        inactive_functions.clear();
        for (unsigned int f = 0; f < is_unknown.size(); ++f)
          if (!is_unknown[f])
            inactive_functions.push_back(f);
      }

    // Volumes at Gauss points; those of cells with points are not zero.
    const QGauss<dim> gauss(spline_space.degree() + 1);
    const double      cell_volume = spline_space.lattice().cell_volume();
    constexpr double  smallest    = 1e-3;
    weights.clear();
    for (unsigned int c = 0; c < parts.size(); ++c)
      if (filling.holds_points(c))
        for (unsigned int q = 0; q < weights.n_points(); ++q)
          weights.at_cell(c)[q * CellBatches<dim>::width()] =
            std::min(1., std::max(parts[c], smallest)) * cell_volume *
            gauss.weight(q);
    add_mass_matrix(volume.matrix(), weights);
    volume.finish();
    volume_factors.reset();
  }



  template <int dim>
  StencilMatrix<dim> &
  PressureLevel<dim>::begin_matrix()
  {
    matrix.matrix().clear();
    return matrix.matrix();
  }



  template <int dim>
  void
  PressureLevel<dim>::finish_matrix()
  {
    matrix.finish();
    entries = matrix.local_entries(1);
    result  = 0.;
    for (unsigned int u = 0; u < entries.size(); ++u)
      result.local_element(u) = entries.values[entries.row_begin[u + 1] - 1];
    result.compress(VectorOperation::add);
    double largest = 0.;
    for (unsigned int u = 0; u < result.locally_owned_size(); ++u)
      largest = std::max(largest, result.local_element(u));
    largest      = Utilities::MPI::max(largest, spline_space.communicator());
    all_diagonal = largest > 0. ? largest : 1.;
    const auto &functions = matrix.unknowns().unknown_functions();
    for (unsigned int u = 0; u < functions.size(); ++u)
      if (result.local_element(u) > 1e-12 * largest)
        all_diagonal.local_element(functions[u]) = result.local_element(u);
  }



  template <int dim>
  void
  PressureLevel<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    matrix.unknowns().read(source, src, 1);
    matrix.vmult(result, source, 1);
    matrix.unknowns().write(dst, result, 1);
    for (const unsigned int f : inactive_functions)
      dst.local_element(f) =
        all_diagonal.local_element(f) * src.local_element(f);
  }



  template <int dim>
  void
  PressureLevel<dim>::factorize(const LowerTriangle &of_matrix,
                                const double         shift,
                                PartitionedCholesky &factors) const
  {
    factors.factorize(of_matrix,
                      matrix.unknowns().unknown_layout(),
                      matrix.unknowns().unknown_positions(),
                      std::vector<bool>(matrix.unknowns().n_owned_unknowns(),
                                        false),
                      spline_space.degree(),
                      shift);
  }



  template <int dim>
  void
  PressureLevel<dim>::solve(const PartitionedCholesky &factors,
                            VectorType                &dst,
                            const VectorType          &src) const
  {
    matrix.unknowns().read(source, src, 1);
    factors.solve(source.begin(), 1);
    matrix.unknowns().write(dst, source, 1);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  PressureLevel<dim>::factorization(const double shift, const bool) const
  {
    class Factorization : public Preconditioner
    {
    public:
      Factorization(const PressureLevel<dim> &level, const double shift)
        : level(level)
      {
        level.factorize(level.entries, shift, factors);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        level.solve(factors, dst, src);
      }

    private:
      const PressureLevel<dim> &level;
      PartitionedCholesky       factors;
    };
    return std::make_unique<Factorization>(*this, shift);
  }



  template <int dim>
  void
  PressureLevel<dim>::apply_inverse_mass(VectorType &x) const
  {
    if (!volume_factors)
      {
        auto factors = std::make_unique<PartitionedCholesky>();
        factorize(volume.local_entries(1), 0., *factors);
        volume_factors = std::move(factors);
      }
    solve(*volume_factors, x, x);
  }



  namespace
  {
    /**
     * A preconditioner of PETSc for vectors of unknowns, on those of a level.
     */
    template <int dim>
    class PressurePreconditioner : public Preconditioner
    {
    public:
      PressurePreconditioner(const ExtendedUnknowns<dim>   &unknowns,
                             PetscMatrix                    given_matrix,
                             const std::string             &options,
                             const std::function<void(PC)> &prepare = {})
        : unknowns(unknowns)
        , matrix(std::move(given_matrix))
        , petsc(matrix.get(), options, prepare)
      {
        unknowns.initialize_vector(to, 1);
        unknowns.initialize_vector(from, 1);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        unknowns.read(from, src, 1);
        petsc.vmult(to, from);
        unknowns.write(dst, to, 1);
      }

    private:
      const ExtendedUnknowns<dim> &unknowns;
      const PetscMatrix            matrix;
      const PetscPreconditioner    petsc;
      mutable VectorType           to, from;
    };
  } // namespace



  template <int dim>
  PetscMatrix
  PressureLevel<dim>::petsc_matrix() const
  {
    const InterleavedLayout &layout = *matrix.unknowns().unknown_layout();
    const MPI_Comm           comm   = spline_space.communicator();
    checked_index<PetscInt>(Utilities::MPI::sum<std::uint64_t>(layout.n_owned(),
                                                               comm),
                            "rows of a matrix");
    std::vector<PetscInt>    rows, columns;
    std::vector<PetscScalar> values;
    for (unsigned int u = 0; u < entries.size(); ++u)
      for (std::size_t e = entries.row_begin[u]; e < entries.row_begin[u + 1];
           ++e)
        {
          const PetscInt i = layout.global_number(u);
          const PetscInt j = layout.global_number(entries.columns[e]);
          rows.push_back(i);
          columns.push_back(j);
          values.push_back(entries.values[e]);
          if (i == j)
            continue;
          rows.push_back(j);
          columns.push_back(i);
          values.push_back(entries.values[e]);
        }
    Mat mat;
    check_petsc(MatCreate(comm, &mat));
    PetscMatrix result(mat);
    check_petsc(MatSetSizes(mat,
                            layout.n_owned(),
                            layout.n_owned(),
                            PETSC_DETERMINE,
                            PETSC_DETERMINE));
    check_petsc(MatSetType(mat, MATAIJ));
    check_petsc(
      MatSetPreallocationCOO(mat, rows.size(), rows.data(), columns.data()));
    check_petsc(MatSetValuesCOO(mat, values.data(), INSERT_VALUES));
    return result;
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  PressureLevel<dim>::petsc_preconditioner(const std::string &options) const
  {
    return std::make_unique<PressurePreconditioner<dim>>(matrix.unknowns(),
                                                         petsc_matrix(),
                                                         options);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  PressureLevel<dim>::lattice_preconditioner(const std::string &options) const
  {
    PetscMatrix              of_petsc = petsc_matrix();
    const LatticeLevels<dim> lattice(
      of_petsc.get(),
      spline_space,
      matrix.unknowns().unknown_functions(),
      1,
      std::vector<unsigned char>(matrix.unknowns().n_owned_unknowns(), 0));
    return std::make_unique<PressurePreconditioner<dim>>(matrix.unknowns(),
                                                         std::move(of_petsc),
                                                         options,
                                                         [&](PC pc) {
                                                           lattice.apply_to(pc);
                                                         });
  }



  template class PressureLevel<2>;
  template class PressureLevel<3>;
} // namespace greville
