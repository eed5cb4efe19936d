// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/stiffness/tangent_level.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TangentLevel<dim>::TangentLevel(const SplineSpace<dim>           &space,
                                  const std::vector<unsigned char> &constrained,
                                  const bool has_transfer)
    // The quadrature is exact for products with functions of lower order.
    : ExtendedLevel<dim>(space,
                         dim,
                         constrained,
                         has_transfer ? 2 * space.degree() : 0)
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

    // The products with the unknowns, without contributions of extended
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
      for_each_row(const std::function<void(const Position &, const float *)>
                     &visit) const override
      {
        this->for_each_place([&](const Position &i, const unsigned int place) {
          visit(i, level.blocks.row(place));
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

      std::vector<UpperTriangle>
      diagonal_blocks(const bool by_components) const override
      {
        return level.diagonal_blocks(by_components);
      }

    private:
      const TangentLevel<dim> &level;
    };

    return std::make_unique<TangentLattice>(*this);
  }



  template <int dim>
  void
  TangentLevel<dim>::multiply_of_unknowns(VectorType       &dst,
                                          const VectorType &src) const
  {
    const auto &unknowns = this->extended_mass.unknowns();
    this->source.copy_locally_owned_data_from(src);
    unknowns.multiply(dst, this->source, dim, exact_product);
    const auto &functions = unknowns.unknown_functions();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < dim; ++c)
        if ((this->constrained[functions[u]] >> c) & 1)
          dst.local_element(u * dim + c) =
            this->all_diagonal.local_element(functions[u] * dim + c) *
            src.local_element(u * dim + c);
  }



  template <int dim>
  const ExtendedMass<dim> &
  TangentLevel<dim>::diagonal_block(const unsigned int components) const
  {
    blocks.diagonal_block(block.matrix(), components);
    return block;
  }



  GREVILLE_INSTANTIATE_CLASS(TangentLevel);
} // namespace greville
