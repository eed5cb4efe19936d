// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_coupled_steps_h
#define greville_steps_coupled_steps_h

#include <greville/steps/implicit_steps.h>

#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class TrialContacts;

  /**
   * The equations of a common implicit step of one or several parts, for the
   * unknowns of all of them one after another. Contacts couple them; without
   * these, each part is a list of one and has its own iterations.
   *
   * Linear systems of several parts are solved by conjugate gradients where all
   * tangents are symmetric, and by FGMRES else, with the p-multigrid of each
   * part as its block of the preconditioner (see TangentSystem).
   *
   * Behind the displacements of all parts are the pressures of the pore water
   * of all parts (see PoreWater), where a body has any; those of parts without
   * it are empty. Contacts act on the total stress, their friction is that of
   * the effective one, and nothing flows through them.
   */
  template <int dim>
  class CoupledSteps : public NewtonProblem
  {
  public:
    struct Part
    {
      ImplicitSteps<dim> *steps;
      State<dim>         *state;
    };

    /**
     * The @p contacts may be null.
     */
    CoupledSteps(const std::vector<Part> &parts,
                 TrialContacts<dim>      *contacts,
                 const double             dt);

    /**
     * Collective. Newton's method from the guess that the velocity goes on.
     * Throws StepRejected where it does not converge.
     */
    void
    try_step();

    /**
     * The guess is linearized at once, and so is what follows up to the
     * iterations of the last step: it gets residual and stiffness with one
     * pass over points.
     */
    std::string
    residual(VectorType &r, const VectorType &x) override;

    /**
     * The tolerance of a residual is not below round-off.
     */
    double
    scale() override;

    std::string
    linearize(const VectorType &x) override;

    SolveResult
    solve(VectorType &dx, const VectorType &r, const double tolerance) override;

  private:
    /// Copy all blocks out of a vector, and into it.
    void
    read(std::vector<VectorType> &blocks, const VectorType &x) const;
    void
    write(VectorType &x, const std::vector<VectorType> &blocks) const;

    /**
     * Collective. The residual, and the stiffness, too.
     */
    std::string
    evaluate(VectorType &r, const VectorType &x, const bool with_stiffness);

    SolveResult
    solve_all(VectorType &x, const VectorType &b, const double tolerance);

    /**
     * Collective. What the pore water of part k adds to the product with the
     * blocks; and its part of the preconditioner, before that of the
     * displacement.
     */
    void
    add_water(const unsigned int k);
    void
    precondition_water(const unsigned int k);

    /// The block of the pressure of part k.
    VectorType &
    pressure(std::vector<VectorType> &of_parts, const unsigned int k) const
    {
      return of_parts[parts.size() + k];
    }

    /// Whether the last block is that of free rigid bodies.
    bool
    has_rigid_block() const;

    /// Whether any part has pore water.
    bool
    has_water() const;

    /**
     * Collective. Tell the parts why Newton's method has failed at @p x, and
     * which contacts are @p changing, see TrialContacts::describe_changes().
     */
    [[noreturn]] void
    reject(const VectorType  &x,
           const std::string &reason,
           const std::string &changing = "");

    const std::vector<Part>   parts;
    TrialContacts<dim> *const contacts;
    const double              dt;
    unsigned int              n_residuals = 0;
    VectorType                layout;
    VectorType                linearized; // where the stiffness is known
    std::vector<VectorType>   blocks, products;
  };
} // namespace greville

#endif
