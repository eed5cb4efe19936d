// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/paper/ilut.h>
#include <greville/paper/paper_parts.h>
#include <greville/paper/schwarz.h>
#include <greville/paper/tensor_product_solver.h>

#include <petscpc.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Forward Gauss-Seidel, and backward as its transpose, process by process.
    class GaussSeidelSmoother : public Preconditioner
    {
    public:
      GaussSeidelSmoother(const Mat matrix)
        : forward(matrix, "-pc_type sor -pc_sor_local_forward")
        , backward(matrix, "-pc_type sor -pc_sor_local_backward")
      {}

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        forward.vmult(dst, src);
      }

      void
      Tvmult(VectorType &dst, const VectorType &src) const override
      {
        backward.vmult(dst, src);
      }

    private:
      PetscPreconditioner forward, backward;
    };



    LocalSolver
    make_ilut(const Mat    matrix,
              const double drop_tolerance,
              const double fill_factor)
    {
      const auto ilut =
        std::make_shared<const ILUT>(matrix, drop_tolerance, fill_factor);
      return [ilut](double *x, const bool transpose) {
        transpose ? ilut->solve_transpose(x) : ilut->solve(x);
      };
    }



    LocalSolver
    make_ic0(const Mat matrix, const double shift)
    {
      const auto factors = std::make_shared<IncompleteCholesky>();
      factors->factorize(upper_triangle(matrix), {shift, 0.});
      return [factors](double *x, const bool) { factors->solve(x, 1); };
    }



    /// Return PETSc's ILU(0) of the matrix scaled to a unit diagonal, plus @p
    /// shift on the diagonal.
    LocalSolver
    make_ilu0(const Mat matrix, const double shift)
    {
      Mat scaled;
      check_petsc(MatDuplicate(matrix, MAT_COPY_VALUES, &scaled));
      PetscMatrix owner(scaled);
      Vec         diagonal;
      check_petsc(MatCreateVecs(scaled, &diagonal, nullptr));
      PetscVector vector_owner(diagonal);
      check_petsc(MatGetDiagonal(scaled, diagonal));
      check_petsc(VecSqrtAbs(diagonal));
      check_petsc(VecReciprocal(diagonal));
      check_petsc(MatDiagonalScale(scaled, diagonal, diagonal));
      if (shift != 0.)
        check_petsc(MatShift(scaled, shift));

      PetscInt           n;
      const PetscScalar *values;
      check_petsc(VecGetLocalSize(diagonal, &n));
      check_petsc(VecGetArrayRead(diagonal, &values));
      const std::vector<double> scaling(values, values + n);
      check_petsc(VecRestoreArrayRead(diagonal, &values));

      PC handle;
      check_petsc(PCCreate(PETSC_COMM_SELF, &handle));
      const std::shared_ptr<std::remove_pointer_t<PC>> pc(handle, [](PC owned) {
        PCDestroy(&owned);
      });
      check_petsc(PCSetOperators(handle, scaled, scaled));
      check_petsc(PCSetType(handle, PCILU));
      check_petsc(PCFactorSetMatOrderingType(handle, MATORDERINGNATURAL));
      check_petsc(PCFactorSetLevels(handle, 0));
      check_petsc(PCFactorSetShiftType(handle, MAT_SHIFT_NONE));
      check_petsc(PCFactorSetZeroPivot(handle, 1e-14));
      check_petsc(PCSetErrorIfFailure(handle, PETSC_FALSE));
      check_petsc(PCSetUp(handle));
      PCFailedReason reason;
      check_petsc(PCGetFailedReason(handle, &reason));
      Require(reason == PC_NOERROR,
              "ILU(0) found a pivot that is zero: the matrix needs a shift "
              "(parameter 'Shift', try 1e-3).");

      const auto in =
        std::make_shared<const PetscVectorView>(PETSC_COMM_SELF, n);
      const auto out =
        std::make_shared<const PetscVectorView>(PETSC_COMM_SELF, n);
      return [scaling, pc, in, out](double *x, const bool transpose) {
        std::vector<double> y(scaling.size());
        for (std::size_t i = 0; i < y.size(); ++i)
          x[i] *= scaling[i];
        in->with(x, [&](Vec from) {
          out->with(y.data(), [&](Vec to) {
            check_petsc(transpose ? PCApplyTranspose(pc.get(), from, to)
                                  : PCApply(pc.get(), from, to));
          });
        });
        for (std::size_t i = 0; i < y.size(); ++i)
          x[i] = scaling[i] * y[i];
      };
    }



    /// @p make returns the local solver of a matrix.
    template <int dim>
    MakeSmoother<dim>
    schwarz_with(
      const std::function<LocalSolver(const Mat, const SmootherParameters &)>
        &make)
    {
      return [make](const SmootherParameters &p,
                    const LevelOperator<dim> &level,
                    const bool                symmetric) {
        const bool is_symmetric = p.combination == "symmetric" ||
                                  (p.combination == "automatic" && symmetric);
        return std::make_unique<AdditiveSchwarz<dim>>(
          level, p.overlap, is_symmetric, p.ordering, [&](const Mat matrix) {
            return make(matrix, p);
          });
      };
    }



    template <int dim>
    void
    add_parts()
    {
      using P         = const SmootherParameters &;
      using L         = const LevelOperator<dim> &;
      const auto ilut = [](const Mat m, P p) {
        return make_ilut(m, p.drop_tolerance, p.fill_factor);
      };
      const auto ilu0 = [](const Mat m, P p) { return make_ilu0(m, p.shift); };
      const auto ic0  = [](P p, L level, const bool symmetric) {
        if (auto factorization = make_factorization<dim>(level, {p.shift, 0.}))
          return factorization;
        return make_by_components<dim>(schwarz_with<dim>([](const Mat m, P q) {
                                         return make_ic0(m, q.shift);
                                       })(p, level, symmetric),
                                       level);
      };
      const auto gauss_seidel = [](P, L level, const bool) {
        return std::make_unique<GaussSeidelSmoother>(level.matrix());
      };
      const auto symmetric_gauss_seidel = [](P, L level, const bool) {
        return std::make_unique<PetscPreconditioner>(
          level.matrix(), "-pc_type sor -pc_sor_local_symmetric");
      };
      const auto tensor_product = [](P, L level, const bool) {
        return std::make_unique<TensorProductPreconditioner<dim>>(
          level.space(), level.diagonal(), level.inactive());
      };
      add_smoother<dim>("ilut", true, true, schwarz_with<dim>(ilut));
      add_smoother<dim>("ilu0", true, true, schwarz_with<dim>(ilu0));
      add_smoother<dim>("ic0", true, false, ic0);
      add_smoother<dim>("gauss-seidel", true, true, gauss_seidel);
      add_smoother<dim>("symmetric-gauss-seidel",
                        true,
                        true,
                        symmetric_gauss_seidel);
      add_smoother<dim>("tensor-product", false, true, tensor_product);
      add_inverse_mass<dim>("exact-l2", [](L level, const bool unit_weight) {
        const TensorProductSolver<dim> solver(level.space());
        VectorType                     diagonal(level.diagonal());
        if (unit_weight)
          {
            level.space().initialize_vector(diagonal);
            for (unsigned int i = 0; i < solver.n_unknowns(); ++i)
              diagonal.local_element(i) = solver.diagonal(i);
          }
        return std::make_unique<TensorProductPreconditioner<dim>>(
          solver, diagonal, level.inactive());
      });
    }
  } // namespace



  void
  add_paper_parts()
  {
    static bool are_added = false;
    if (are_added)
      return;
    are_added = true;
    register_petsc_ilut();
    add_parts<2>();
    add_parts<3>();
  }



  void
  PaperMultigridParameters::declare(ParameterHandler &prm)
  {
    declare_levels(prm, *this);
    PMultigridParameters::declare(
      prm, smoother_names(), all_coarse_preconditioners() + "|tensor-product");
  }



  void
  declare_levels(ParameterHandler &prm, PMultigridParameters &parameters)
  {
    add_choice(prm, "Coarsening", parameters.coarsening, coarsenings)(
      "The orders of the levels: p, p-1, ..., 1 (one by one), p, p-2, ..., 1 "
      "(by two), p, 1 (direct), or p alone (none), on lattices that become "
      "coarser by two (lattice), the coarsest one with order 1 (hp).");
    add_choice(prm, "Cycle", parameters.cycle, cycle_types)("The cycle.");
    prm.add_parameter(
      "Prolongation",
      parameters.prolongation,
      "From an order to the next higher one: L2 projection with the lumped "
      "mass matrix, with the exact one (1D banded solves), or with one "
      "solve by IC(0) of the mass matrix.",
      Patterns::Selection(OrderTransfer<2>::prolongations()));
    prm.add_parameter("Restriction",
                      parameters.restriction,
                      "From an order to the next lower one: L2 projection of "
                      "the residual, lumped or exact, or the transpose of the "
                      "prolongation, which makes the cycle symmetric.",
                      Patterns::Selection(OrderTransfer<2>::restrictions()));
    add_choice(prm, "Transfer weight", parameters.weight, transfer_weights)(
      "The weight of the L2 products in the transfer.");
    add_parameter(prm,
                  "Pre-smoothing steps",
                  parameters.pre_smoothing,
                  Patterns::Integer(0, 100))(
      "nu1, smoothing steps before the coarse correction. Unit: steps.");
    add_parameter(prm,
                  "Post-smoothing steps",
                  parameters.post_smoothing,
                  Patterns::Integer(0, 100))(
      "nu2, smoothing steps after the coarse correction. Unit: steps.");
    add_parameter(prm,
                  "Coarse tolerance",
                  parameters.coarse_tolerance,
                  Patterns::Double(0., 1.))(
      "Relative residual of the conjugate gradients at p = 1. If p = 1 is "
      "the only level, the solver's tolerance applies. 1: the coarse "
      "preconditioner is applied once. Unit: none.");
    add_parameter(prm,
                  "Coarse maximum iterations",
                  parameters.coarse_max_iterations,
                  Patterns::Integer(1))(
      "The conjugate gradients at p = 1 end after so many iterations at the "
      "latest. Unit: iterations.");
  }



  void
  PaperSmootherParameters::declare(ParameterHandler &prm)
  {
    SmootherParameters::declare(prm);
    add_parameter(prm, "Damping", damping, Patterns::Double(0.))(
      "jacobi: the factor omega in units of 1 / lambda_max(D^-1 M), which is "
      "estimated; below 2 for convergence. Unit: none.");
    prm.add_parameter("Drop tolerance",
                      drop_tolerance,
                      "ilut: entries below this fraction of the norm of their "
                      "row are dropped. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Fill factor",
                      fill_factor,
                      "ilut: entries kept in a row of L and of U, as a "
                      "multiple of the entries of the matrix. Unit: none.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Overlap",
      overlap,
      "ilut, ilu0, ic0: overlap of the domains of processes, in "
      "layers of the matrix's graph (p coefficients each). Unit: layers.",
      Patterns::Integer(0, 10));
    prm.add_parameter("Ordering",
                      ordering,
                      "ilut, ilu0, ic0: order of the unknowns of a process. "
                      "All but lexicographic are orderings of PETSc.",
                      Patterns::Selection("lexicographic|rcm|amd|nd|qmd|1wd"));
    prm.add_parameter("Combination",
                      combination,
                      "ilut, ilu0, ic0: how overlapping corrections "
                      "are put together; automatic is symmetric in a symmetric "
                      "cycle (restriction = transpose), else restricted.",
                      Patterns::Selection("automatic|restricted|symmetric"));
  }
} // namespace greville
