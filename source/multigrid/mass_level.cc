// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/lattice_cycle.h>
#include <greville/multigrid/mass_level.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  MassLevel<dim>::assemble(const bool with_entries)
  {
    mass_operator =
      std::make_unique<MassOperator<dim>>(*spline_space, density_weights);
    if (!is_extended() && !with_entries)
      {
        entries.reset();
        return;
      }
    fill_entries();
    if (is_extended())
      find_extended_diagonal();
  }



  template <int dim>
  void
  MassLevel<dim>::fill_entries()
  {
    const SplineSpace<dim> &space = *spline_space;
    if (!is_extended())
      {
        // Without a threshold, each cell with mass is a host.
        std::vector<double> parts(space.owned_cells().size(), 0.);
        for (unsigned int c = 0; c < parts.size(); ++c)
          for (unsigned int q = 0; q < density_weights.n_points(); ++q)
            if (density_weights.at_cell(c)[q * CellBatches<dim>::width()] != 0.)
              parts[c] = 1.;
        filling.reinit(space);
        filling.update(parts, 0.);
        all_stable.reinit(space, filling);
      }
    if (!entries)
      {
        entries = std::make_unique<ExtendedMass<dim>>();
        entries->reinit(space);
      }
    entries->begin(is_extended() ? *given_extension : all_stable, true);
    constrained_functions.resize(space.owned_functions().size() +
                                   space.ghost_functions().size(),
                                 0);
    entries->unknowns().constrain(constrained_functions);
    add_mass_matrix(entries->matrix(), density_weights);
    entries->finish();
    for (VectorType *vector : {&unknown_source, &unknown_result})
      entries->unknowns().initialize_vector(*vector, 1);
  }



  template <int dim>
  void
  MassLevel<dim>::find_extended_diagonal()
  {
    const UpperTriangle upper_entries = entries->local_entries(1);
    unknown_result                    = 0.;
    for (unsigned int u = 0; u < upper_entries.size(); ++u)
      unknown_result.local_element(u) = upper_entries.diagonal(u);
    unknown_result.compress(VectorOperation::add);
    spline_space->initialize_vector(extended_diagonal);
    entries->unknowns().write(extended_diagonal, unknown_result, 1);
    for (unsigned int f = 0; f < spline_space->owned_functions().size(); ++f)
      if (constrained_functions[f] != 0)
        extended_diagonal.local_element(f) = 0.;
    extended_inactive = fill_inactive(extended_diagonal).second;
  }



  template <int dim>
  void
  MassLevel<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    if (!is_extended())
      {
        mass_operator->vmult(dst, src);
        return;
      }
    entries->unknowns().read(unknown_source, src, 1);
    entries->vmult(unknown_result, unknown_source, 1);
    entries->unknowns().write(dst, unknown_result, 1);
    for (const unsigned int i : extended_inactive)
      dst.local_element(i) =
        extended_diagonal.local_element(i) * src.local_element(i);
  }



  template <int dim>
  VectorType
  MassLevel<dim>::lumped() const
  {
    VectorType sums;
    spline_space->initialize_vector(sums);
    mass().cross_mass().row_sums(sums);
    condense(sums);
    for (const unsigned int i : inactive())
      sums.local_element(i) = diagonal().local_element(i);
    return sums;
  }



  template <int dim>
  void
  MassLevel<dim>::distribute(VectorType &x, const unsigned int) const
  {
    // With unit weights, coefficients without mass take part in transfers, so
    // that constants are preserved.
    if (is_extended())
      entries->unknowns().distribute(x, 0);
  }



  template <int dim>
  void
  MassLevel<dim>::condense(VectorType &x, const unsigned int) const
  {
    if (is_extended())
      entries->unknowns().condense(x, 0);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  MassLevel<dim>::factorization(const CholeskyParameters &parameters,
                                const bool) const
  {
    class Factorization : public Preconditioner
    {
    public:
      Factorization(const MassLevel<dim>     &level,
                    const CholeskyParameters &parameters)
        : level(level)
      {
        const ExtendedMass<dim> &entries = *level.entries;
        const int                degree  = level.space().degree();
        const int                reach =
          parameters.drop_tolerance > 0. ? std::max(1, degree - 1) : degree;
        factors.factorize(entries.local_entries(1, reach),
                          *entries.unknowns().unknown_layout(),
                          entries.unknowns().unknown_positions(),
                          reach,
                          1,
                          parameters);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        level.entries->unknowns().read(level.unknown_source, src, 1);
        factors.solve(level.unknown_source.begin(), 1);
        level.entries->unknowns().write(dst, level.unknown_source, 1);
        for (const unsigned int i : level.inactive())
          dst.local_element(i) =
            src.local_element(i) / level.diagonal().local_element(i);
      }

    private:
      const MassLevel<dim> &level;
      OverlappingCholesky   factors;
    };
    if (!entries)
      return nullptr;
    return std::make_unique<Factorization>(*this, parameters);
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  MassLevel<dim>::lattice_preconditioner(
    const LatticeCycleParameters &parameters) const
  {
    if (!entries)
      return nullptr;
    return std::make_unique<LatticeCycle<dim>>(
      std::make_unique<ExtendedLattice<dim>>(*entries,
                                             is_extended() ? *given_extension
                                                           : all_stable,
                                             constrained_functions,
                                             diagonal().linfty_norm()),
      parameters);
  }



  GREVILLE_INSTANTIATE_CLASS(MassLevel);
} // namespace greville
