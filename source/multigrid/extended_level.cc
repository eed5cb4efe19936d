// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/multigrid/extended_level.h>
#include <greville/multigrid/lattice_cycle.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Return the number of columns of a factorization's vectors.
    unsigned int
    factor_width(const unsigned int n_components)
    {
      return n_components == 3 ? 4 : n_components;
    }



    constexpr unsigned int
    all_components(const unsigned int n_components)
    {
      return (1u << n_components) - 1;
    }



    /**
     * A preconditioner of PETSc for vectors of unknowns, applied to vectors of
     * a level.
     */
    template <int dim>
    class UnknownsPreconditioner : public Preconditioner
    {
    public:
      UnknownsPreconditioner(const ExtendedLevel<dim> &level,
                             PetscMatrix               given_matrix,
                             const std::string        &options)
        : level(level)
        , matrix(std::move(given_matrix))
        , petsc(matrix.get(), options)
      {
        for (VectorType *vector : {&to, &from})
          level.extended().unknowns().initialize_vector(*vector,
                                                        level.n_components());
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        const unsigned int n = level.n_components();
        level.extended().unknowns().read(from, src, n);
        petsc.vmult(to, from);
        level.extended().unknowns().zero_constrained_unknowns(to, n);
        level.extended().unknowns().write(dst, to, n);
      }

    private:
      const ExtendedLevel<dim> &level;
      const PetscMatrix         matrix;
      const PetscPreconditioner petsc;
      mutable VectorType        to, from;
    };
  } // namespace



  template <int dim>
  ExtendedLevel<dim>::ExtendedLevel(
    const SplineSpace<dim>           &space,
    const unsigned int                n_components,
    const std::vector<unsigned char> &constrained,
    const unsigned int                n_weights)
    : spline_space(space)
    , components(n_components)
    , constrained(constrained.empty() ? std::vector<unsigned char>(
                                          space.owned_functions().size() +
                                          space.ghost_functions().size())
                                      : constrained)
    , mass_weights(space, n_weights)
  {
    extended_mass.reinit(space);
  }



  template <int dim>
  void
  ExtendedLevel<dim>::begin_level(const CellFilling<dim> &filling,
                                  const bool              changed)
  {
    if (changed)
      spline_extension.reinit(spline_space, filling);
    extended_mass.begin(spline_extension, changed);
    mass_weights.clear();
    mass_factors.reset();
    if (!changed)
      return;
    extended_mass.unknowns().constrain(constrained);
    for (VectorType *vector : {&source, &result})
      extended_mass.unknowns().initialize_vector(*vector, components);
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
  ExtendedLevel<dim>::set_diagonal()
  {
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
      for (unsigned int c = 0; c < components; ++c)
        if (!((constrained[functions[u]] >> c) & 1) &&
            result.local_element(u * components + c) > 1e-12 * largest)
          all_diagonal.local_element(functions[u] * components + c) =
            result.local_element(u * components + c);
  }



  template <int dim>
  void
  ExtendedLevel<dim>::multiply_unknowns(
    VectorType                  &dst,
    const VectorType            &src,
    const std::function<void()> &product) const
  {
    extended_mass.unknowns().read(source, src, components);
    product();
    extended_mass.unknowns().write(dst, result, components);
    for (const unsigned int f : inactive_functions)
      for (unsigned int c = 0; c < components; ++c)
        dst.local_element(f * components + c) =
          all_diagonal.local_element(f * components + c) *
          src.local_element(f * components + c);
    for (const unsigned int f : extended_mass.unknowns().unknown_functions())
      if (constrained[f] != 0)
        for (unsigned int c = 0; c < components; ++c)
          if ((constrained[f] >> c) & 1)
            dst.local_element(f * components + c) =
              all_diagonal.local_element(f * components + c) *
              src.local_element(f * components + c);
  }



  template <int dim>
  void
  ExtendedLevel<dim>::factorize(const ExtendedMass<dim>  &matrix,
                                const CholeskyParameters &parameters,
                                const unsigned int        of_components,
                                OverlappingCholesky      &factors) const
  {
    // Tangents couple more unknowns than masses: a layer alone would double
    // the iterations on four processes in 3D.
    constexpr unsigned int n_layers = 2;
    factors.factorize(matrix.local_entries(of_components),
                      matrix.unknowns().unknown_layout(),
                      matrix.unknowns().unknown_positions(),
                      spline_space.degree(),
                      n_layers,
                      parameters);
  }



  template <int dim>
  void
  ExtendedLevel<dim>::solve(const OverlappingCholesky &factors,
                            VectorType                &dst,
                            const VectorType          &src,
                            const unsigned int         component,
                            const unsigned int         n) const
  {
    const unsigned int width     = factor_width(n);
    const auto        &functions = extended_mass.unknowns().unknown_functions();
    const auto         for_free  = [&](const auto &visit) {
      for (unsigned int u = 0; u < functions.size(); ++u)
        for (unsigned int c = 0; c < n; ++c)
          if (!((constrained[functions[u]] >> (component + c)) & 1))
            visit(u * width + c, functions[u] * components + component + c);
    };
    work.assign(functions.size() * width, 0.);
    for_free([&](const unsigned int k, const unsigned int i) {
      work[k] = src.local_element(i);
    });
    factors.solve(work.data(), width);
    for (unsigned int i = 0; i < dst.locally_owned_size(); i += components)
      for (unsigned int c = 0; c < n; ++c)
        dst.local_element(i + component + c) = 0.;
    for_free([&](const unsigned int k, const unsigned int i) {
      dst.local_element(i) = work[k];
    });
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  ExtendedLevel<dim>::factorization(const CholeskyParameters &parameters,
                                    const bool by_components) const
  {
    /// The factors of the mean of all diagonal blocks, or of each block.
    class Factorization : public Preconditioner
    {
    public:
      Factorization(const ExtendedLevel<dim> &level,
                    const CholeskyParameters &parameters,
                    const bool                by_components)
        : level(level)
        , factors(level.factorize(parameters, by_components))
      {}

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        for (unsigned int c = 0; c < factors.size(); ++c)
          level.solve(
            factors[c], dst, src, c, level.components / factors.size());
      }

    private:
      const ExtendedLevel<dim>        &level;
      std::vector<OverlappingCholesky> factors;
    };
    return std::make_unique<Factorization>(*this, parameters, by_components);
  }



  template <int dim>
  std::vector<OverlappingCholesky>
  ExtendedLevel<dim>::factorize(const CholeskyParameters &parameters,
                                const bool                by_components) const
  {
    std::vector<OverlappingCholesky> factors(by_components ? components : 1);
    for (unsigned int c = 0; c < factors.size(); ++c)
      {
        const unsigned int of_components =
          factors.size() > 1 ? 1u << c : all_components(components);
        factorize(diagonal_block(of_components),
                  parameters,
                  of_components,
                  factors[c]);
      }
    return factors;
  }



  template <int dim>
  void
  ExtendedLevel<dim>::apply_inverse_mass(VectorType &x) const
  {
    if (!mass_factors)
      {
        auto factors = std::make_unique<OverlappingCholesky>();
        factorize(extended_mass, {}, all_components(components), *factors);
        mass_factors = std::move(factors);
      }
    solve(*mass_factors, x, x, 0, components);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  ExtendedLevel<dim>::petsc_preconditioner(const std::string &options) const
  {
    PetscMatrix matrix = petsc_matrix();
    set_modes(matrix);
    return std::make_unique<UnknownsPreconditioner<dim>>(*this,
                                                         std::move(matrix),
                                                         options);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  ExtendedLevel<dim>::lattice_preconditioner(
    const LatticeCycleParameters &parameters) const
  {
    return std::make_unique<LatticeCycle<dim>>(make_lattice(), parameters);
  }



  template class ExtendedLevel<2>;
  template class ExtendedLevel<3>;
} // namespace greville
