// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/implicit_steps.h>

#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class TrialContacts;

  /**
   * The equations of a common implicit step of one or several parts, with the
   * unknowns of all parts one after another. Contacts couple the parts; without
   * contacts, each part is solved separately, as a list of one.
   *
   * Linear systems of several parts are solved by conjugate gradients if all
   * tangents are symmetric, otherwise by FGMRES, with a CoupledCycle as the
   * preconditioner.
   *
   * The displacements of all parts are followed by the pore pressures of all
   * parts (see PoreWater), if there are any. The pressures of parts without
   * pore water are empty. Contacts transmit the total stress and are
   * impervious; friction depends on the effective stress.
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

    /// The @p contacts may be null.
    CoupledSteps(const std::vector<Part> &parts,
                 TrialContacts<dim>      *contacts,
                 const double             dt);

    /// Collective. Run Newton's method from a guess with constant velocity.
    /// Throws StepRejected if it does not converge.
    void
    try_step();

    /// Residual and stiffness are computed together, in one pass over the
    /// points, for the guess and the following iterates, up to the number of
    /// iterations of the last step.
    std::string
    residual(VectorType &r, const VectorType &x) override;

    /// Return the scale of the residual; tolerance times scale exceeds
    /// round-off.
    double
    scale() override
    {
      return scale_with(true);
    }

    double
    likely_scale() override
    {
      return scale_with(false);
    }

    std::string
    linearize(const VectorType &x) override;

    SolveResult
    solve(VectorType &dx, const VectorType &r, const double tolerance) override;

  private:
    /// Return the scale. The tolerance times the scale is at least the upper
    /// bound of round-off, or the likely round-off of parts whose forces have
    /// not vanished.
    double
    scale_with(const bool upper_bound) const;

    /// Copy all blocks out of a vector, and into it.
    void
    read(std::vector<VectorType> &blocks, const VectorType &x) const;
    void
    write(VectorType &x, const std::vector<VectorType> &blocks) const;

    /// Collective. Compute the residual, and the stiffness if requested.
    std::string
    evaluate(VectorType &r, const VectorType &x, const bool with_stiffness);

    SolveResult
    solve_all(VectorType &x, const VectorType &b, const double tolerance);

    /// Collective. Add the contribution of the pore water of part k to the
    /// product of the stiffness; and apply the preconditioner of the pore
    /// water, which precedes the one of the displacement.
    void
    add_water(const unsigned int k);
    void
    precondition_water(const unsigned int k);

    VectorType &
    pressure(std::vector<VectorType> &of_parts, const unsigned int k) const
    {
      return of_parts[parts.size() + k];
    }

    /// Return whether the last block belongs to free rigid bodies.
    bool
    has_rigid_block() const;

    /// Return whether any part has pore water.
    bool
    has_water() const;

    /// Collective. Throw StepRejected with the reason why Newton's method has
    /// failed at @p x, and with the contacts that are @p changing, see
    /// TrialContacts::describe_changes().
    [[noreturn]] void
    reject(const VectorType  &x,
           const std::string &reason,
           const std::string &changing = "");

    const std::vector<Part>   parts;
    TrialContacts<dim> *const contacts;
    const double              dt;
    unsigned int              n_residuals = 0;
    VectorType                layout;
    VectorType                linearized; // x of the last stiffness
    std::vector<VectorType>   blocks, products;
  };
} // namespace greville
