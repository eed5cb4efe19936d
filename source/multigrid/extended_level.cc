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



    /// Attach translations and rotations to a matrix of @p dim components as
    /// near-null space. The coefficients of a linear field are its values at
    /// the Greville points of the functions.
    template <int dim>
    void
    set_rigid_body_modes(const Mat                        matrix,
                         const SplineSpace<dim>          &space,
                         const std::vector<unsigned int> &functions)
    {
      Vec coordinates;
      check_petsc(MatCreateVecs(matrix, &coordinates, nullptr));
      const PetscVector owner(coordinates);
      check_petsc(VecSetBlockSize(coordinates, dim));
      PetscScalar *values;
      check_petsc(VecGetArray(coordinates, &values));
      for (unsigned int u = 0; u < functions.size(); ++u)
        {
          const Point<dim> x = space.greville_point(functions[u]);
          for (unsigned int d = 0; d < dim; ++d)
            values[u * dim + d] = x[d];
        }
      check_petsc(VecRestoreArray(coordinates, &values));
      MatNullSpace modes;
      check_petsc(MatNullSpaceCreateRigidBody(coordinates, &modes));
      check_petsc(MatSetNearNullSpace(matrix, modes));
      check_petsc(MatNullSpaceDestroy(&modes));
    }



    /// A preconditioner of PETSc on the entries of a level.
    template <int dim>
    class EntriesPreconditioner : public Preconditioner
    {
    public:
      EntriesPreconditioner(const ExtendedLevel<dim>   &level,
                            const ExtendedLattice<dim> &lattice,
                            const std::string          &options)
        : n(level.n_components())
      {
        const LatticeMatrix<dim> entries(lattice, false);
        const auto               positions = lattice.unknown_positions();
        const unsigned int       n_owned   = entries.layout().n_owned();
        functions.resize(n_owned);
        constrained = entries.constrained_unknowns();
        for (unsigned int u = 0; u < positions.size(); ++u)
          {
            const int row = entries.unknowns().find(positions[u]);
            if (row >= 0)
              functions[row] = lattice.unknown_functions()[u];
          }
        for (VectorType *vector : {&to, &from})
          vector->reinit(entries.layout().partitioner(n));
        matrix = entries.petsc_matrix(lattice.unit());
        if (n == dim)
          set_rigid_body_modes(matrix.get(), level.space(), functions);
        petsc = std::make_unique<PetscPreconditioner>(matrix.get(), options);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        for_each([&](const unsigned int row, const unsigned int i, bool free) {
          from.local_element(row) = free ? src.local_element(i) : 0.;
        });
        petsc->vmult(to, from);
        dst = 0.;
        for_each([&](const unsigned int row, const unsigned int i, bool free) {
          dst.local_element(i) = free ? to.local_element(row) : 0.;
        });
      }

    private:
      /// Call visit(row, entry of a vector of the level, whether it is free).
      template <typename Visit>
      void
      for_each(const Visit &visit) const
      {
        for (unsigned int u = 0; u < functions.size(); ++u)
          for (unsigned int c = 0; c < n; ++c)
            visit(u * n + c,
                  functions[u] * n + c,
                  ((constrained[u] >> c) & 1) == 0);
      }

      const unsigned int                   n;
      std::vector<unsigned int>            functions; // by row
      std::vector<unsigned char>           constrained;
      PetscMatrix                          matrix;
      std::unique_ptr<PetscPreconditioner> petsc;
      mutable VectorType                   to, from;
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
  ExtendedLevel<dim>::factorize(const UpperTriangle      &matrix,
                                const CholeskyParameters &parameters,
                                OverlappingCholesky      &factors) const
  {
    // Tangents couple more unknowns than masses. With one layer, four processes
    // in 3D would take twice as many iterations.
    constexpr unsigned int n_layers = 2;
    factors.factorize(matrix,
                      *extended_mass.unknowns().unknown_layout(),
                      extended_mass.unknowns().unknown_positions(),
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
  UpperTriangle
  ExtendedLevel<dim>::local_block(const unsigned int c,
                                  const bool         by_components) const
  {
    const unsigned int of_components =
      by_components ? 1u << c : all_components(components);
    return diagonal_block(of_components).local_entries(of_components);
  }



  template <int dim>
  std::vector<OverlappingCholesky>
  ExtendedLevel<dim>::factorize(const CholeskyParameters &parameters,
                                const bool                by_components) const
  {
    std::vector<OverlappingCholesky> factors(by_components ? components : 1);
    for (unsigned int c = 0; c < factors.size(); ++c)
      factorize(local_block(c, by_components), parameters, factors[c]);
    return factors;
  }



  template <int dim>
  std::vector<UpperTriangle>
  ExtendedLevel<dim>::diagonal_blocks(const bool by_components) const
  {
    std::vector<UpperTriangle> result;
    for (unsigned int c = 0; c < (by_components ? components : 1); ++c)
      result.push_back(local_block(c, by_components));
    return result;
  }



  template <int dim>
  const OverlappingCholesky &
  ExtendedLevel<dim>::factors_of_mass() const
  {
    if (!mass_factors)
      {
        auto factors = std::make_unique<OverlappingCholesky>();
        factorize(extended_mass.local_entries(all_components(components)),
                  {},
                  *factors);
        mass_factors = std::move(factors);
      }
    return *mass_factors;
  }



  template <int dim>
  void
  ExtendedLevel<dim>::apply_inverse_mass(VectorType &x) const
  {
    solve(factors_of_mass(), x, x, 0, components);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  ExtendedLevel<dim>::petsc_preconditioner(const std::string &options) const
  {
    return std::make_unique<EntriesPreconditioner<dim>>(*this,
                                                        *make_lattice(),
                                                        options);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  ExtendedLevel<dim>::lattice_preconditioner(
    const LatticeCycleParameters &parameters) const
  {
    return std::make_unique<LatticeCycle<dim>>(make_lattice(), parameters);
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedLevel);
} // namespace greville
