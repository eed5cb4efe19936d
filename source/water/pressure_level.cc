// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

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

    // Set the volumes at Gauss points, positive in all cells with points.
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



  GREVILLE_INSTANTIATE_CLASS(PressureLevel);
} // namespace greville
