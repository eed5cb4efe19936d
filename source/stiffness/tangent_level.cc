// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/stiffness/tangent_level.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Columns of a factorization's vectors.
    template <int dim>
    constexpr unsigned int factor_width = dim == 2 ? 2 : 4;

    constexpr unsigned char
    all_components(const unsigned int dim)
    {
      return (1u << dim) - 1;
    }
  } // namespace



  template <int dim>
  TangentLevel<dim>::TangentLevel(const SplineSpace<dim>           &space,
                                  const std::vector<unsigned char> &held)
    : spline_space(space)
    , held(held.empty()
             ? std::vector<unsigned char>(space.owned_functions().size() +
                                          space.ghost_functions().size())
             : held)
    // Exact for products with functions of lower order.
    , mass_weights(space, 2 * space.degree())
  {
    extended_mass.reinit(space);
    block.reinit(extended_mass);
    blocks.reinit(extended_mass.matrix());
  }



  template <int dim>
  void
  TangentLevel<dim>::begin(const CellFilling<dim> &filling, const bool changed)
  {
    if (changed)
      spline_extension.reinit(spline_space, filling);
    extended_mass.begin(spline_extension, changed);
    if (changed)
      extended_mass.unknowns().hold(held);
    block.begin(changed);
    mass_weights.clear();
    mass_factors.reset();
    if (!changed)
      return;
    for (VectorType *vector : {&source, &result})
      extended_mass.unknowns().initialize_vector(*vector, dim);
    std::vector<bool> is_unknown(spline_space.owned_functions().size(), false);
    for (const unsigned int f : extended_mass.unknowns().unknown_functions())
      is_unknown[f] = true;
    inactive_functions.clear();
    for (unsigned int f = 0; f < is_unknown.size(); ++f)
      if (!is_unknown[f])
        inactive_functions.push_back(f);
  }



  template <int dim>
  void
  TangentLevel<dim>::finish_mass(const bool lump)
  {
    if (lump)
      extended_mass.matrix().lump();
    extended_mass.finish();
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
      blocks.add(mass_factor, extended_mass.matrix());

    // Those of extended B-splines without what extended functions add.
    result             = 0.;
    const auto &places = extended_mass.unknowns().unknown_places();
    for (unsigned int u = 0; u < places.size(); ++u)
      if (places[u] != numbers::invalid_unsigned_int)
        for (unsigned int c = 0; c < dim; ++c)
          result.local_element(u * dim + c) = blocks.diagonal(places[u], c);
    extended_mass.unknowns().for_each_image_of_unknown(
      [&](const unsigned int u, const std::size_t place) {
        for (unsigned int c = 0; c < dim; ++c)
          result.local_element(u * dim + c) += blocks.diagonal(place, c);
      });
    result.compress(VectorOperation::add);
    largest = 0.;
    for (unsigned int i = 0; i < result.locally_owned_size(); ++i)
      largest = std::max(largest, result.local_element(i));
    largest = Utilities::MPI::max(largest, spline_space.communicator());
    if (all_diagonal.size() == 0)
      initialize_vector<dim>(all_diagonal, *this);
    all_diagonal          = largest > 0. ? largest : 1.;
    const auto &functions = extended_mass.unknowns().unknown_functions();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < dim; ++c)
        if (!((held[functions[u]] >> c) & 1) &&
            result.local_element(u * dim + c) > 1e-12 * largest)
          all_diagonal.local_element(functions[u] * dim + c) =
            result.local_element(u * dim + c);
  }



  template <int dim>
  void
  TangentLevel<dim>::multiply(
    VectorType                                            &dst,
    const VectorType                                      &src,
    const std::function<void(double *y, const double *x)> &product) const
  {
    extended_mass.unknowns().read(source, src, dim);
    extended_mass.unknowns().multiply(result, source, dim, product);
    extended_mass.unknowns().write(dst, result, dim);
    for (const unsigned int f : inactive_functions)
      for (unsigned int c = 0; c < dim; ++c)
        dst.local_element(f * dim + c) =
          all_diagonal.local_element(f * dim + c) *
          src.local_element(f * dim + c);
    for (const unsigned int f : extended_mass.unknowns().unknown_functions())
      if (held[f] != 0)
        for (unsigned int c = 0; c < dim; ++c)
          if ((held[f] >> c) & 1)
            dst.local_element(f * dim + c) =
              all_diagonal.local_element(f * dim + c) *
              src.local_element(f * dim + c);
  }



  template <int dim>
  void
  TangentLevel<dim>::multiply_mass(VectorType &dst, const VectorType &src) const
  {
    extended_mass.unknowns().read(source, src, dim);
    extended_mass.vmult(result, source, dim);
    extended_mass.unknowns().write(dst, result, dim);
  }



  template <int dim>
  void
  TangentLevel<dim>::factorize(const ExtendedMass<dim> &matrix,
                               const double             shift,
                               const unsigned int       components,
                               PartitionedCholesky     &factors) const
  {
    const auto        of_unknowns = matrix.unknowns().held_unknowns();
    std::vector<bool> is_held_in_some(of_unknowns.size());
    for (unsigned int u = 0; u < of_unknowns.size(); ++u)
      is_held_in_some[u] = (of_unknowns[u] & components) != 0 &&
                           (of_unknowns[u] & components) != components;
    factors.factorize(matrix.local_entries(components),
                      matrix.unknowns().unknown_layout(),
                      matrix.unknowns().unknown_positions(),
                      is_held_in_some,
                      spline_space.degree(),
                      shift);
    if (components == all_components(dim))
      factors.hold(of_unknowns, factor_width<dim>);
  }



  template <int dim>
  void
  TangentLevel<dim>::solve(const PartitionedCholesky &factors,
                           VectorType                &dst,
                           const VectorType          &src,
                           const unsigned int         component,
                           const unsigned int         n_components) const
  {
    const unsigned int width     = n_components == 1 ? 1 : factor_width<dim>;
    const auto        &functions = extended_mass.unknowns().unknown_functions();
    const auto         for_free  = [&](const auto &visit) {
      for (unsigned int u = 0; u < functions.size(); ++u)
        for (unsigned int c = 0; c < n_components; ++c)
          if (!((held[functions[u]] >> (component + c)) & 1))
            visit(u * width + c, functions[u] * dim + component + c);
    };
    work.assign(functions.size() * width, 0.);
    for_free([&](const unsigned int k, const unsigned int i) {
      work[k] = src.local_element(i);
    });
    factors.solve(work.data(), width);
    for (unsigned int i = 0; i < dst.locally_owned_size(); i += dim)
      for (unsigned int c = 0; c < n_components; ++c)
        dst.local_element(i + component + c) = 0.;
    for_free([&](const unsigned int k, const unsigned int i) {
      dst.local_element(i) = work[k];
    });
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  TangentLevel<dim>::factorization(const double shift,
                                   const bool   by_components) const
  {
    /**
     * The factors of the mean of all diagonal blocks, or of each of them.
     */
    class Factorization : public Preconditioner
    {
    public:
      Factorization(const TangentLevel<dim> &level,
                    const double             shift,
                    const bool               by_components)
        : level(level)
        , factors(by_components ? dim : 1)
      {
        for (unsigned int c = 0; c < factors.size(); ++c)
          {
            const unsigned int components =
              by_components ? 1u << c : all_components(dim);
            level.blocks.diagonal_block(level.block.matrix(), components);
            level.factorize(level.block, shift, components, factors[c]);
          }
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        for (unsigned int c = 0; c < factors.size(); ++c)
          level.solve(factors[c], dst, src, c, dim / factors.size());
      }

    private:
      const TangentLevel<dim>         &level;
      std::vector<PartitionedCholesky> factors;
    };
    return std::make_unique<Factorization>(*this, shift, by_components);
  }



  template <int dim>
  void
  TangentLevel<dim>::apply_inverse_mass(VectorType &x) const
  {
    if (!mass_factors)
      {
        auto factors = std::make_unique<PartitionedCholesky>();
        factorize(extended_mass, 0., all_components(dim), *factors);
        mass_factors = std::move(factors);
      }
    solve(*mass_factors, x, x);
  }



  template class TangentLevel<2>;
  template class TangentLevel<3>;
} // namespace greville
