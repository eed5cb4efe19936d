// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/paper/assembled_mass_level.h>

namespace greville
{
  template <int dim>
  void
  AssembledMassLevel<dim>::assemble(const bool with_matrix,
                                    const bool apply,
                                    const bool with_entries)
  {
    apply_matrix = apply;
    mass_matrix.reset();
    MassLevel<dim>::assemble(with_matrix || apply || with_entries);
    if (with_matrix || apply)
      mass_matrix =
        std::make_unique<MassMatrix<dim>>(*this->entries,
                                          this->entries->local_entries(1),
                                          this->inactive(),
                                          this->diagonal().linfty_norm());
  }



  template <int dim>
  void
  AssembledMassLevel<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    if (apply_matrix)
      mass_matrix->vmult(dst, src);
    else
      MassLevel<dim>::vmult(dst, src);
  }



  GREVILLE_INSTANTIATE_CLASS(AssembledMassLevel);
} // namespace greville
