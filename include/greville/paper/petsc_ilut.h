// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_paper_petsc_ilut_h
#define greville_paper_petsc_ilut_h

namespace greville
{
  /**
   * Add ILUT with drop tolerance 1e-12 and fill factor 1 (see the class of that
   * name) in PETSc's AMD ordering to the preconditioners of PETSc, as "ilut":
   * for sequential matrices, and for the blocks of others, as in
   * "-pc_type asm -pc_asm_overlap 1 -sub_pc_type ilut". May be called several
   * times.
   */
  void
  register_petsc_ilut();
} // namespace greville

#endif
