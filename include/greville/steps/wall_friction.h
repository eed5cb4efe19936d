// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_wall_friction_h
#define greville_steps_wall_friction_h

#include <greville/steps/contact.h>
#include <greville/steps/friction_contact.h>

namespace greville
{
  /**
   * What friction walls do with all masses.
   */
  template <int dim>
  class FrictionWalls : public Contact<dim>
  {
  public:
    /**
     * By Walls::stop().
     */
    void
    stop(VectorField<dim> &velocity) const override;

  protected:
    /**
     * Both are kept by reference.
     */
    FrictionWalls(const Walls<dim> &walls, GridField<dim> &field);

    const Walls<dim> &walls;
    GridField<dim>   &field;
  };



  /**
   * Friction walls with lumped mass and FMPM: each coefficient for itself, see
   * Walls::add_contact().
   */
  template <int dim>
  class LumpedWallFriction : public FrictionWalls<dim>
  {
  public:
    /**
     * Null without friction walls, and with another mass.
     */
    static std::unique_ptr<Contact<dim>>
    make(const IntegratorParts<dim> &parts);

    /**
     * Both are kept by reference.
     */
    LumpedWallFriction(const Walls<dim> &walls, GridField<dim> &field);

    void
    apply(ContactStep<dim> &step) override;

  private:
    VectorField<dim> before;
  };



  /**
   * Friction walls with the consistent mass: see FrictionContact.
   */
  template <int dim>
  class WallFriction : public FrictionWalls<dim>
  {
  public:
    /**
     * Null without friction walls, and with another mass.
     */
    static std::unique_ptr<Contact<dim>>
    make(const IntegratorParts<dim> &parts);

    /**
     * All are kept by reference.
     */
    WallFriction(const Walls<dim> &walls, GridField<dim> &field, StepLog &log);

    /**
     * Throws StepFailed where a solve does not converge.
     */
    void
    apply(ContactStep<dim> &step) override;

    /**
     * Where contacts slide, solves begin with the loads of the last step.
     */
    void
    forget() override;

  private:
    FrictionContact<dim> contact;
    StepLog             &log;
  };
} // namespace greville

#endif
