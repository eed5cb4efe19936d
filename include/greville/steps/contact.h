// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_contact_h
#define greville_steps_contact_h

#include <greville/steps/time_integrator.h>

namespace greville
{
  /**
   * An explicit step as contacts see it: the state with its bodies, and the
   * velocity field of the grid.
   */
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

    /**
     * Count the work of a contact's impulse I: @p before is I v, and @p after
     * is I v', the share of this process, J (2D: J / m).
     */
    void
    add_work(const double before, const double after)
    {
      state.energy.add_friction(0.5 * (before + after));
      if (row)
        row->energy.add_friction(row->part_of_work(before, after));
    }
  };



  /**
   * Forces on the velocity field of the grid in explicit steps. A step calls
   * - constrain(), with the sums over the points, before solves: what is
   *   constrained then keeps its value in them;
   * - apply(), with the new velocity that the forces lead to.
   *
   * A new contact is a class that derives from this one, and one line in the
   * list of source/steps/contact.cc; or a call of add_contact() in a program.
   * Implicit steps refuse to be made where make_contacts() gives any.
   */
  template <int dim>
  class Contact
  {
  public:
    virtual ~Contact() = default;

    /**
     * Collective. Add to GridField::constraints, and set the velocity and the
     * acceleration that is given there.
     */
    virtual void
    constrain(ContactStep<dim> &)
    {}

    /**
     * Collective. Change GridField::new_velocity, and GridField::acceleration
     * by that change over the step, which may be of no length. What walls give
     * is added to GridField::momentum_of_walls; ContactStep::add_work() counts
     * the work.
     */
    virtual void
    apply(ContactStep<dim> &)
    {}

    /**
     * Take from a velocity that has been found from the points what this
     * contact does not let through.
     */
    virtual void
    stop(VectorField<dim> &) const
    {}

    /**
     * Whether constrain() may constrain something. What that gives to the
     * momentum is not added up, and its work is part of that of walls.
     */
    virtual bool
    constrains() const
    {
      return false;
    }

    /**
     * Forget what earlier steps have left, see TimeIntegrator::forget().
     */
    virtual void
    forget()
    {}
  };



  /**
   * Makes a contact, or null where the parameters have none of its kind.
   */
  template <int dim>
  using MakeContact = std::function<std::unique_ptr<Contact<dim>>(
    const IntegratorParts<dim> &parts)>;

  /**
   * Add one to the list, before simulations are made.
   */
  template <int dim>
  void
  add_contact(const MakeContact<dim> &make);

  /**
   * All contacts that the parameters have, in the order in which they act.
   */
  template <int dim>
  std::vector<std::unique_ptr<Contact<dim>>>
  make_contacts(const IntegratorParts<dim> &parts);
} // namespace greville

#endif
