// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/stiffness/tangent_level.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TangentLevel<dim>::TangentLevel(const SplineSpace<dim>           &space,
                                  const std::vector<unsigned char> &held)
    // Exact for products with functions of lower order.
    : ExtendedLevel<dim>(space, dim, held, 2 * space.degree())
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

    // Those of extended B-splines without what extended functions add.
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
    this->multiply(dst, src, [&]() {
      this->extended_mass.unknowns().multiply(this->result,
                                              this->source,
                                              dim,
                                              product);
    });
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



  template class TangentLevel<2>;
  template class TangentLevel<3>;
} // namespace greville
