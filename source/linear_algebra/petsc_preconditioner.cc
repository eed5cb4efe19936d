// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/petsc_preconditioner.h>

#include <sstream>

namespace greville
{
  using namespace dealii;

  PetscPreconditioner::PetscPreconditioner(const Mat          matrix,
                                           const std::string &options)
  {
    const MPI_Comm comm =
      PetscObjectComm(reinterpret_cast<PetscObject>(matrix));

    // PETSc's options are global: these get a unique prefix.
    static unsigned int counter = 0;
    const std::string   prefix  = "greville" + std::to_string(counter++) + "_";

    std::istringstream       stream(options);
    std::string              word, prefixed;
    std::vector<std::string> names;
    while (stream >> word)
      if (word.size() > 1 && word[0] == '-' && std::isalpha(word[1]))
        {
          names.push_back("-" + prefix + word.substr(1));
          prefixed += " " + names.back();
        }
      else
        prefixed += " " + word;
    check_petsc(PetscOptionsInsertString(nullptr, prefixed.c_str()));

    PC handle;
    check_petsc(PCCreate(comm, &handle));
    pc.reset(handle);
    check_petsc(PCSetOptionsPrefix(handle, prefix.c_str()));
    check_petsc(PCSetOperators(handle, matrix, matrix));
    check_petsc(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
    PetscErrorCode error = PCSetFromOptions(handle);
    if (error == 0)
      error = PCSetUp(handle);
    if (error == 0)
      error = PCSetUpOnBlocks(handle);
    check_petsc(PetscPopErrorHandler());
    PCFailedReason reason = PC_NOERROR;
    if (error == 0)
      check_petsc(PCGetFailedReason(handle, &reason));
    throw_on_all(error == 0 && reason == PC_NOERROR
                   ? ""
                   : "PETSc cannot make the preconditioner <" + options +
                       "> of the parameter 'Smoother/PETSc options'.",
                 comm);

    std::string unused;
    for (const std::string &name : names)
      {
        PetscBool used;
        check_petsc(PetscOptionsUsed(nullptr, name.c_str() + 1, &used));
        if (!used)
          unused += " -" + name.substr(1 + prefix.size());
        check_petsc(PetscOptionsClearValue(nullptr, name.c_str()));
      }
    throw_on_all(unused.empty()
                   ? ""
                   : "PETSc does not use" + unused + " in <" + options +
                       ">, the parameter "
                       "'Smoother/PETSc options'.",
                 comm);

    PetscInt n;
    check_petsc(MatGetLocalSize(matrix, &n, nullptr));
    view_dst = PetscVectorView(comm, n);
    view_src = PetscVectorView(comm, n);
  }



  void
  PetscPreconditioner::vmult(VectorType &dst, const VectorType &src) const
  {
    view_src.with(src.begin(), [&](Vec x) {
      view_dst.with(dst.begin(),
                    [&](Vec y) { check_petsc(PCApply(pc.get(), x, y)); });
    });
  }



  void
  PetscPreconditioner::Tvmult(VectorType &dst, const VectorType &src) const
  {
    check_petsc(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
    PetscErrorCode error = 0;
    view_src.with(src.begin(), [&](Vec x) {
      view_dst.with(dst.begin(),
                    [&](Vec y) { error = PCApplyTranspose(pc.get(), x, y); });
    });
    check_petsc(PetscPopErrorHandler());
    Require(error == 0,
            "PETSc cannot transpose this preconditioner, which a symmetric "
            "cycle (restriction = transpose) needs.");
  }
} // namespace greville
