// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/overlapping_cholesky.h>
#include <greville/mass/extended_mass.h>
#include <greville/mass/mass_operator.h>
#include <greville/multigrid/level_operator.h>

#include <optional>

namespace greville
{
  /// The mass matrix of one order of the hierarchy, discretized from the
  /// weights: a MassOperator or, with extended B-splines, an ExtendedMass.
  template <int dim>
  class MassLevel : public LevelOperator<dim>
  {
  public:
    /// Collective. Evaluates @p density at p + 1 Gauss points per direction;
    /// assemble() builds the operators. The space is kept by reference.
    MassLevel(const SplineSpace<dim>      &space,
              const dealii::Function<dim> &density)
      : spline_space(&space)
      , density_weights(space, space.degree() + 1, density)
    {}

    /// Use @p weights, which the caller fills before assemble().
    MassLevel(const SplineSpace<dim> &space, DensityWeights<dim> weights)
      : spline_space(&space)
      , density_weights(std::move(weights))
    {}

    DensityWeights<dim> &
    weights()
    {
      return density_weights;
    }

    const DensityWeights<dim> &
    weights() const
    {
      return density_weights;
    }

    /// Use extended B-splines from the next assemble() on. Local functions that
    /// are @p constrained (not zero) are omitted from the columns of E.
    void
    extend(Extension<dim>             extension,
           std::vector<unsigned char> constrained = {})
    {
      given_extension       = std::move(extension);
      constrained_functions = std::move(constrained);
    }

    /// Collective. Build the operators. Without extended B-splines,
    /// factorization() is available only if @p with_entries.
    void
    assemble(const bool with_entries = true);

    /// Free the operators.
    void
    clear()
    {
      mass_operator.reset();
      entries.reset();
    }

    const SplineSpace<dim> &
    space() const override
    {
      return *spline_space;
    }

    /// Return M of all functions, matrix-free.
    const MassOperator<dim> &
    mass() const
    {
      AssertThrow(mass_operator, dealii::ExcNotInitialized());
      return *mass_operator;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override;

    const VectorType &
    diagonal() const override
    {
      return is_extended() ? extended_diagonal : mass().diagonal();
    }

    const std::vector<unsigned int> &
    inactive() const override
    {
      return is_extended() ? extended_inactive : mass().inactive();
    }

    /// Return the row sums (the lumped mass), with the diagonal of inactive
    /// coefficients. With extended B-splines they can be negative.
    VectorType
    lumped() const;

    bool
    is_extended() const
    {
      return given_extension.has_value();
    }

    void
    distribute(VectorType &x, const unsigned int component = 0) const override;

    void
    condense(VectorType &x, const unsigned int component = 0) const override;

    /// Return IC(0) or ICT, one for all components. ICT omits the same entries
    /// as ExtendedMassSolver.
    std::unique_ptr<Preconditioner>
    factorization(const CholeskyParameters &parameters,
                  const bool) const override;

    std::unique_ptr<Preconditioner>
    lattice_preconditioner(
      const LatticeCycleParameters &parameters) const override;

    const DensityWeights<dim> *
    transfer_weights() const override
    {
      return &density_weights;
    }

  protected:
    // The matrix, if B-splines are extended or entries are needed. Without an
    // extension, all functions with mass are unknowns.
    std::unique_ptr<ExtendedMass<dim>> entries;

  private:
    /// Collective. Assemble the entries of M for all unknowns.
    void
    fill_entries();

    void
    find_extended_diagonal();

    const SplineSpace<dim>            *spline_space;
    DensityWeights<dim>                density_weights;
    std::optional<Extension<dim>>      given_extension;
    std::vector<unsigned char>         constrained_functions;
    std::unique_ptr<MassOperator<dim>> mass_operator;

    CellFilling<dim>          filling;
    Extension<dim>            all_stable;
    VectorType                extended_diagonal;
    std::vector<unsigned int> extended_inactive;
    mutable VectorType        unknown_source, unknown_result;
  };
} // namespace greville
