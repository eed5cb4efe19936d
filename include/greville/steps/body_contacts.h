// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/surface_search.h>
#include <greville/steps/body_contact.h>
#include <greville/steps/passing_bodies.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class TrialContacts;

  /// The contacts between bodies that are parts of CoupledSimulations, and
  /// between these and rigid bodies. At the start of each explicit step, when
  /// all parts are at the same time, a contact sets forces at the points of its
  /// surfaces. The parts add them to their loads. The points also store contact
  /// data of the step (ContactPoint::slip). See AveragedContact and
  /// SurfaceSearch. In implicit steps, TrialContacts computes loads and slip at
  /// the end of the step.
  template <int dim>
  class BodyContacts
  {
  public:
    /// Collective. The @p parts are kept by reference. Throws
    /// dealii::ExcMessage for invalid parameters.
    BodyContacts(const SimulationParameters           &parameters,
                 const std::vector<Simulation<dim> *> &parts,
                 const MPI_Comm                        comm);

    /// Collective. Set the loads on the surfaces of the parts in their current
    /// state. Does nothing if this has been done already; between two implicit
    /// steps, points keep their loads. Throws StepFailed if a surface is lost,
    /// or bodies overlap initially.
    void
    act();

    /// Begin an explicit step of length @p dt (s) with the loads of act():
    /// store results and slip, and move rigid bodies to the end of the step.
    void
    begin_step(const double dt);

    /// End an implicit step of the parts; results then belong to its end.
    void
    end_step();

    /// Collective. Return an explicit step, at most @p longest (s), in which
    /// surfaces and rigid bodies move by at most a quarter of a cell relative
    /// to one another. Throws StepFailed if this step is below a thousandth of
    /// the first one.
    double
    bounded_step(const double longest) const;

    /// Add contact and rigid body results to a row of statistics. They belong
    /// to the last act() or, with @p at_start_of_step, to the start of the last
    /// step.
    void
    add_to(Statistics<dim> &row, const bool at_start_of_step) const;

    /// Return the sums over the steps of the interval, for each contact.
    const std::vector<ContactInterval<dim>> &
    intervals() const
    {
      return of_interval;
    }

    /// Continue from earlier intervals(), or restart them if empty.
    void
    set_intervals(const std::vector<ContactInterval<dim>> &intervals);

    /// Collective. Return the spurious energy of each contact with its name:
    /// the energy that its surfaces have given to the bodies in excess of the
    /// energy taken, as a fraction of the largest energy or work of one source
    /// so far. Contacts with rigid bodies that have moved are omitted, because
    /// these bodies do work.
    std::vector<std::pair<std::string, double>>
    gains() const;

    /// Collective. Warn, or throw StepFailed, if gains() of explicit steps
    /// exceed a tenth.
    void
    check_gains();

    /// Return notes on rigid bodies that are away from the grid.
    const std::vector<std::string> &
    notes() const
    {
      return all_notes;
    }

    const std::vector<RigidBody<dim>> &
    all_rigid_bodies() const
    {
      return rigid_bodies;
    }

  private:
    friend class TrialContacts<dim>;

    using Place    = ContactPlace<dim>;
    using Contact  = BodyContact<dim>;
    using NearCell = NearContactCell<dim>;

    /// Results of all contacts, and the positions of the rigid bodies then.
    struct Results
    {
      std::vector<ContactResult<dim>> contacts;
      std::vector<RigidPosition<dim>> rigid_bodies;
    };

    void
    make_contact(const SimulationParameters &parameters,
                 const std::string          &name);

    /// Add results that acted for a time @p dt, s, to intervals().
    void
    add_to_intervals(const std::vector<ContactResult<dim>> &results,
                     const double                           dt);

    /// Return, for each rigid body, the box around the grids of its bodies.
    std::vector<dealii::BoundingBox<dim>>
    regions_of_rigid_bodies() const;

    bool
    steps_are_implicit() const;

    /// Set the law of a contact for explicit or implicit steps.
    void
    set_law(Contact &contact) const;

    /// Set the cell size and the lattices, for set_law(): of the grid with
    /// larger cells if cells are equal, otherwise of all grids. Returns whether
    /// cells have changed.
    bool
    take_cells(Contact &contact) const;

    /// Collective. Set all laws if cells have changed, or steps between
    /// explicit and implicit.
    void
    set_laws();

    /// Collective. Set BodyContact::smallest. Returns whether it has changed.
    bool
    find_smallest(Contact &contact) const;

    /// Store data of the last results for the next step: the slip, the
    /// positions and the radii of points.
    void
    commit();

    /// Return the actions on a rigid body: forces of the last results, and
    /// gravity at the time @p t, s.
    RigidStep<dim>
    rigid_step(const unsigned int body, const double t) const;

    /// Return the rigid bodies after a time @p dt, s.
    std::vector<RigidBodyState<dim>>
    moved_bodies(const double dt) const;

    /// Return the points of both sides in their current state.
    std::vector<ContactPoint<dim>>
    collect(const Contact &contact) const;

    /// Replace the points of the first side's surfaces by the material points
    /// that now form its outermost layer, with their contact data. Candidates
    /// are closer to the other side than one spacing, or in implicit steps may
    /// come as close in a step. Points inside the other side are moved back to
    /// its surface: the averaged pressure does not keep single points out.
    void
    renew_contactors(Contact &contact);

    /// The material points of the first side that may be contactors.
    struct Candidates;

    Candidates
    find_candidates(Contact &contact);

    /// Replace only the surface number @p s of the first side.
    void
    renew_contactors(const Contact     &contact,
                     const Candidates  &candidates,
                     const unsigned int s);

    /// The largest motion of a point or a rigid body in an implicit step, in
    /// cells.
    static constexpr double longest_trial_motion = 0.5;

    /// The largest motion of a point or a rigid body in an explicit step.
    static constexpr double longest_motion = 0.25;

    /// Return the cells of a body that may contain points closer than @p reach
    /// to the other side, a function of the cell's number, in units of its
    /// size. Distances from rigid bodies are updated after motions of a quarter
    /// of a cell.
    std::vector<NearCell>
    near_cells(const Contact                                   &contact,
               Place                                           &place,
               const std::function<double(const unsigned int)> &reach);

    static Body<dim> &
    body_of(const Place &place)
    {
      State<dim> &state = place.part->current;
      return state.bodies[state.surfaces[place.surface].body];
    }

    /// Set the data of a point that do not depend on the other side. @p radius
    /// is null for surface points that are not material points.
    static void
    set_place(ContactPoint<dim>       &point,
              const ConstPointRef<dim> p,
              const SurfaceState<dim> &at,
              const PointField        *radius);

    /// Set the gaps of points up to @p reach, in cells, and related data.
    void
    find_gaps(const Contact                  &contact,
              std::vector<ContactPoint<dim>> &points,
              const double                    reach);

    /// Throw if added bodies overlap, by their shapes, or if points of a body
    /// are inside the other side by more than half a cell. Points inside are
    /// checked whenever both sides have moved by a quarter of a cell.
    void
    check_overlaps(Contact &contact);

    /// Return the sides and places of bodies that are present for the first
    /// time, except after a restart.
    std::vector<std::pair<unsigned int, Place *>>
    added_places(Contact &contact) const;

    void
    check_added(Contact &contact, const unsigned int side, Place &place) const;

    /// Collective. Return a text about the point that is too far inside, empty
    /// if there is none.
    std::string
    find_inside_of_rigid(Contact &contact);

    std::string
    find_inside_of_body(Contact &contact) const;

    /// Collective. Return the energy that each contact has given to the bodies,
    /// J, and set @p largest to the largest energy or work of one source so
    /// far. Contacts with rigid bodies that have moved have no value, because
    /// these bodies do work.
    std::vector<std::optional<double>>
    given_energies(double &largest) const;

    /// Collective. Compute the relative motion of both sides in the last step.
    void
    find_way(Contact                              &contact,
             const std::vector<ContactPoint<dim>> &points) const;

    /// Return the largest displacement of a contact's rigid body between two
    /// positions, m.
    double
    rigid_way(const Contact            &contact,
              const RigidPosition<dim> &before,
              const RigidPosition<dim> &now) const;

    /// Throw if points have moved too far in a step, or overlap at the start.
    void
    check(const Contact                        &contact,
          const std::vector<ContactPoint<dim>> &points) const;

    /// Collective. Throw StepFailed if a point, after find_gaps(), has passed
    /// through a rigid body in the last step.
    void
    check_sides(const Contact                        &contact,
                const std::vector<ContactPoint<dim>> &points) const;

    /// Store forces and slip in the surfaces.
    void
    give(const Contact &contact, const std::vector<ContactPoint<dim>> &points);

    std::vector<Simulation<dim> *>      parts;
    const MPI_Comm                      comm;
    SurfaceSearch<dim>                  search;
    std::vector<RigidBody<dim>>         rigid_bodies;
    std::vector<Contact>                contacts;
    std::unique_ptr<PassingBodies<dim>> passing;
    bool are_implicit = false; // at the last set_laws()
    // The versions of the parts at the last act().
    std::vector<std::uint64_t> points_versions;
    Results                    now, at_start;

    std::vector<ContactInterval<dim>> of_interval;
    std::vector<std::string>          all_notes;
  };
} // namespace greville
