// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_paper_petsc_ilut_h
#define greville_paper_petsc_ilut_h

namespace greville
{
  /**
   * Register ILUT (see the class) with drop tolerance 1e-12, fill factor 1 and
   * PETSc's AMD ordering as the PETSc preconditioner "ilut". It supports
   * sequential matrices, and the blocks of others, as in "-pc_type asm
   * -pc_asm_overlap 1 -sub_pc_type ilut". May be called several times.
   */
  void
  register_petsc_ilut();
} // namespace greville

#endif
