// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/contact.h>

namespace greville
{
  /// Friction walls for lumped mass and FMPM, applied to each coefficient
  /// separately, see Walls::add_contact().
  template <int dim>
  class WallFriction : public Contact<dim>
  {
  public:
    /// Return the contact; null without friction walls.
    static std::unique_ptr<Contact<dim>>
    make(const IntegratorParts<dim> &parts);

    /// Both arguments are kept by reference.
    WallFriction(const Walls<dim> &walls, GridField<dim> &field);

    void
    apply(ContactStep<dim> &step) override;

    /// Call Walls::stop().
    void
    stop(VectorField<dim> &velocity) const override
    {
      walls.stop(velocity);
    }

  private:
    const Walls<dim> &walls;
    GridField<dim>   &field;
    VectorField<dim>  before;
  };
} // namespace greville
