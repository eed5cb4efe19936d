// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/mass_level.h>
#include <greville/paper/mass_matrix.h>

namespace greville
{
  /// A MassLevel that is assembled if a smoother or solver needs a PETSc
  /// matrix. For IC(0) it uses the Schwarz smoother of add_paper_parts().
  template <int dim>
  class AssembledMassLevel : public MassLevel<dim>
  {
  public:
    using MassLevel<dim>::MassLevel;

    /// Collective. Make the operators. vmult() applies the assembled matrix if
    /// @p apply_matrix, which implies @p with_matrix. ICT needs
    /// @p with_entries, which the other two imply.
    void
    assemble(const bool with_matrix,
             const bool apply_matrix,
             const bool with_entries = false);

    /// Free the operators.
    void
    clear()
    {
      MassLevel<dim>::clear();
      mass_matrix.reset();
      apply_matrix = false;
    }

    /// Return the matrix; null without one.
    const MassMatrix<dim> *
    assembled() const
    {
      return mass_matrix.get();
    }

    Mat
    matrix() const override
    {
      AssertThrow(mass_matrix, dealii::ExcNotInitialized());
      return mass_matrix->petsc();
    }

    void
    vmult(VectorType &dst, const VectorType &src) const override;

    std::unique_ptr<Preconditioner>
    factorization(const CholeskyParameters &parameters,
                  const bool                by_components) const override
    {
      if (parameters.drop_tolerance > 0.)
        return MassLevel<dim>::factorization(parameters, by_components);
      return nullptr;
    }

  private:
    std::unique_ptr<MassMatrix<dim>> mass_matrix;
    bool                             apply_matrix = false;
  };
} // namespace greville
