// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_body_contacts_h
#define greville_steps_body_contacts_h

#include <greville/contact/averaged_contact.h>
#include <greville/contact/rigid_body.h>
#include <greville/contact/surface_search.h>
#include <greville/steps/simulation.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The contacts of bodies that are parts of an Ensemble, and the rigid bodies
   * that they meet. At the start of each step, with all parts at the same time,
   * a contact gives forces to the points of its surfaces, as loads that the
   * parts sum up; and it remembers what it has to know of the step there
   * (ContactPoint::slip). See AveragedContact and SurfaceSearch.
   */
  template <int dim>
  class BodyContacts
  {
  public:
    /**
     * Collective. The @p parts are kept. Throws dealii::ExcMessage where
     * parameters are wrong.
     */
    BodyContacts(const SimulationParameters           &parameters,
                 const std::vector<Simulation<dim> *> &parts,
                 const MPI_Comm                        comm);

    /**
     * Collective. Give loads to the surfaces of the parts as they are. Nothing
     * changes where that has been done. Throws StepFailed where a surface is
     * lost, or bodies overlap initially.
     */
    void
    act();

    /**
     * The parts take a step of length @p dt (s) with these loads: keep results
     * and slip, and move rigid bodies to its end.
     */
    void
    begin_step(const double dt);

    /**
     * Add what contacts and rigid bodies did to a row of statistics: at the
     * state as it is, to which act() belongs, or at the start of the last step.
     */
    void
    add_to(Statistics<dim> &row, const bool at_start_of_step) const;

  private:
    /// A surface of a part.
    struct Place
    {
      Simulation<dim> *part;
      unsigned int     surface;
    };

    struct Contact
    {
      std::string                       name, bodies;
      std::array<std::vector<Place>, 2> sides;
      int                               rigid = -1; // number of the rigid body
      double                            reach = 0.; // m
      std::unique_ptr<AveragedContact<dim>> average;
    };

    /// Results of all contacts, and the rigid bodies then.
    struct Results
    {
      std::vector<ContactResult<dim>> contacts;
      std::vector<RigidPosition<dim>> rigid_bodies;
    };

    void
    make_contact(const SimulationParameters &parameters,
                 const std::string          &name);

    /// The points of both sides as they are.
    std::vector<ContactPoint<dim>>
    collect(const Contact &contact) const;

    /// Throw where points have moved too far in a step, or overlap initially.
    void
    check(const Contact                        &contact,
          const std::vector<ContactPoint<dim>> &points) const;

    /// Give forces and slip to the surfaces.
    void
    give(const Contact &contact, const std::vector<ContactPoint<dim>> &points);

    std::vector<Simulation<dim> *> parts;
    const MPI_Comm                 comm;
    SurfaceSearch<dim>             search;
    std::vector<RigidBody<dim>>    rigid_bodies;
    std::vector<Contact>           contacts;
    std::vector<std::uint64_t>     stamps; // of the parts, at the last act()
    Results                        now, at_start;
  };
} // namespace greville

#endif
