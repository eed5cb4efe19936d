// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/index_limits.h>
#include <greville/water/pressure_level.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  PressureLevel<dim>::PressureLevel(const SplineSpace<dim> &space)
    : ExtendedLevel<dim>(space, 1, {}, space.degree() + 1)
  {
    matrix.reinit(this->extended_mass);
  }



  template <int dim>
  void
  PressureLevel<dim>::begin(const CellFilling<dim>    &filling,
                            const std::vector<double> &parts,
                            const bool                 changed)
  {
    this->begin_level(filling, changed);
    matrix.begin(changed);

    // Volumes at Gauss points, which are not zero in cells with points.
    const QGauss<dim>    gauss(this->space().degree() + 1);
    constexpr double     smallest = 1e-3;
    DensityWeights<dim> &weights  = this->mass_weights;
    for (unsigned int c = 0; c < parts.size(); ++c)
      if (filling.holds_points(c))
        for (unsigned int q = 0; q < weights.n_points(); ++q)
          weights.at_cell(c)[q * CellBatches<dim>::width()] =
            std::min(1., std::max(parts[c], smallest)) *
            this->space().box(c).volume() * gauss.weight(q);
    add_mass_matrix(this->extended_mass.matrix(), weights);
    this->extended_mass.finish();
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
    entries      = matrix.local_entries(1);
    this->result = 0.;
    for (unsigned int u = 0; u < entries.size(); ++u)
      this->result.local_element(u) = entries.diagonal(u);
    this->set_diagonal();
  }



  template <int dim>
  void
  PressureLevel<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    this->multiply_unknowns(dst, src, [&]() {
      matrix.vmult(this->result, this->source, 1);
    });
  }



  template <int dim>
  PetscMatrix
  PressureLevel<dim>::petsc_matrix() const
  {
    const InterleavedLayout &layout = *matrix.unknowns().unknown_layout();
    const MPI_Comm           comm   = this->space().communicator();
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



  template class PressureLevel<2>;
  template class PressureLevel<3>;
} // namespace greville
