// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/time_integrator.h>

namespace greville
{
  /// The data of an explicit step for contacts: the state with its bodies, and
  /// the velocity field of the grid.
  template <int dim>
  struct ContactStep
  {
    State<dim>         &state;
    GridField<dim>     &field;
    PointTransfer<dim> &transfer;
    /// The times to which v and v' belong, and the length of the step between
    /// them, s.
    double begin = 0., end = 0., dt = 0.;
    /// The row of statistics that the step sums up, or null.
    LateRow<dim> *row = nullptr;

    /// Add the work of a contact's impulse I, the share of this process, J (2D:
    /// J / m). @p before is I v, and @p after is I v'.
    void
    add_work(const double before, const double after)
    {
      state.energy.add_friction(0.5 * (before + after));
      if (row)
        row->energy.add_friction(row->part_of_work(before, after));
    }
  };



  /**
   * Base class of contact forces on the velocity field of the grid in explicit
   * steps. A step calls
   * - constrain() before solves, with the sums over the points; solves then
   *   keep the values of constrained coefficients;
   * - apply() after the solve, with the new velocity.
   *
   * A new contact is a class that derives from this one, and one line in the
   * list of source/steps/contact.cc; or a call of add_contact() in a program.
   * Implicit steps are rejected if make_contacts() returns any.
   */
  template <int dim>
  class Contact
  {
  public:
    virtual ~Contact() = default;

    /// Collective. Add to GridField::constraints, and set the prescribed
    /// velocity and acceleration there.
    virtual void
    constrain(ContactStep<dim> &)
    {}

    /// Collective. Change GridField::new_velocity by an impulse, and
    /// GridField::acceleration by the impulse over the step length, which may
    /// be zero. Momentum of walls is added to GridField::momentum_of_walls;
    /// ContactStep::add_work() counts the work.
    virtual void
    apply(ContactStep<dim> &)
    {}

    /// Set the components that this contact blocks to zero in a velocity that
    /// was computed from the points.
    virtual void
    stop(VectorField<dim> &) const
    {}

    /// Return whether constrain() may constrain anything. The momentum of these
    /// constraints is not summed, and their work counts as work of walls.
    virtual bool
    constrains() const
    {
      return false;
    }

    /// Forget data of earlier steps, see TimeIntegrator::forget().
    virtual void
    forget()
    {}
  };



  /// A function that makes a contact, or returns null if the parameters define
  /// none of its kind.
  template <int dim>
  using MakeContact = std::function<std::unique_ptr<Contact<dim>>(
    const IntegratorParts<dim> &parts)>;

  /// Add a kind of contact to the list, before simulations are made.
  template <int dim>
  void
  add_contact(const MakeContact<dim> &make);

  /// Return all contacts that the parameters define, in the order in which they
  /// act.
  template <int dim>
  std::vector<std::unique_ptr<Contact<dim>>>
  make_contacts(const IntegratorParts<dim> &parts);
} // namespace greville
