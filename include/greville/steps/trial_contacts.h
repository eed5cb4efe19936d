// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_trial_contacts_h
#define greville_steps_trial_contacts_h

#include <greville/steps/body_contacts.h>
#include <greville/steps/implicit_steps.h>
#include <greville/steps/rigid_trial.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * The BodyContacts of an implicit step that is being tried, see CoupledSteps.
   * Contact is that of the place which points and rigid bodies have in the
   * trial, when loads act: at the end, or in the middle of the step. Areas and
   * hat functions are those at the start. Where the trial is accepted, the
   * contacts get results, loads, slip, and the places of rigid bodies.
   *
   * The tangent is that of ContactTangent. The matrices of the parts, from
   * which preconditioners are made, have the stiffness of each point by itself
   * (ContactPoint::stiffness) in its place, which fits their stencils.
   */
  template <int dim>
  class TrialContacts
  {
  public:
    /**
     * Collective. The integrators belong to the parts of @p contacts. Both are
     * kept. Throws StepFailed where a formula of a rigid body has no value.
     */
    TrialContacts(BodyContacts<dim>                       &contacts,
                  const std::vector<ImplicitSteps<dim> *> &steps,
                  const double                             dt);

    /**
     * Collective. Why no step of this length can be tried, empty if it can.
     */
    std::string
    check_rigid_bodies() const;

    /**
     * Collective. The pressures of pore water in the trial, as the blocks of
     * CoupledSteps: friction is that of the effective pressure.
     */
    void
    set_pore_pressures(const std::vector<VectorType> &blocks);

    /**
     * Collective. Contact at the trial displacements of the parts; with the
     * tangent, which is added to the stiffness of the parts. Returns what is
     * wrong, empty if nothing is.
     */
    std::string
    evaluate(const bool with_stiffness);

    /**
     * The unknowns of free rigid bodies, see RigidTrial.
     */
    unsigned int
    n_rigid_unknowns() const
    {
      return free_bodies.size() * RigidTrial<dim>::n_unknowns;
    }

    /**
     * Collective. Their vector, which belongs to the first process; it begins
     * with bodies that go on with their velocity.
     */
    void
    initialize_rigid(VectorType &q) const;

    /**
     * Collective. Take these unknowns for evaluate().
     */
    void
    set_rigid(const VectorType &q);

    /**
     * Their residual, after evaluate(); and the largest of its forces.
     */
    void
    find_rigid_residual(VectorType &r);

    double
    rigid_scale() const
    {
      return largest_rigid_force;
    }

    /**
     * The tangent of the bodies by themselves, inverted.
     */
    void
    precondition_rigid(VectorType &dst, const VectorType &src) const;

    /// The force on the grid of a part, times the weight of contacts.
    const VectorField<dim> &
    force(const unsigned int part) const
    {
      return forces[part];
    }

    /// Whether the tangent is symmetric: where nothing slides with friction.
    bool
    is_symmetric() const;

    /**
     * Collective. To the products of the parts' matrices with @p src add what
     * their tangent has beyond the stiffness of single points. Behind the parts
     * are the pressures of pore water, if there is any, whose product stays;
     * and free rigid bodies, if there are any, whose product is set.
     */
    void
    add_product(std::vector<VectorType>       &dst,
                const std::vector<VectorType> &src);

    /**
     * Collective. Take the pressures that have been found for given ones, in
     * the contacts that are augmented. Returns whether there are any in which
     * they have changed, so that the equations are to be solved again.
     */
    bool
    augment();

    /**
     * Collective. Why the trial, which solves the equations, is no step: points
     * have moved too far to have met what is between. Empty if it is one.
     */
    std::string
    check_motion() const;

    /**
     * Collective. Name the contacts with friction that have changed between
     * sticking and sliding before most tangents, and the parameter that helps,
     * after "; ". Empty if there are none.
     */
    std::string
    describe_changes() const;

    /**
     * Collective. The step is taken. Before that, all that has been tried is
     * in the parts' integrators.
     */
    void
    accept();

  private:
    using Contact = typename BodyContacts<dim>::Contact;
    using Place   = typename BodyContacts<dim>::Place;

    /// A surface, and where its points are among those of a contact.
    struct Side
    {
      unsigned int contact, side, part, surface;
      std::size_t  begin, end;
    };

    /**
     * Collective. The points of a contact after a @p share of the step.
     */
    void
    move_points(const unsigned int contact, const double share);

    /**
     * Collective. Contact after a share of the step, and the results of it.
     */
    std::string
    find_forces(const double share, const bool with_stiffness);

    const MaterialPoints<dim> &
    points_of(const Side &side) const;

    /// Whether friction depends on the pressure of pore water.
    bool
    feel_pores() const;

    /// Collective. The pressures, or changes of them, at all points.
    void
    find_pore_pressures(const std::vector<VectorType> &blocks);

    /// A free rigid body.
    struct FreeBody
    {
      unsigned int                     number; // of the rigid body
      RigidTrial<dim>                  trial;
      typename RigidTrial<dim>::Vector q, load;
      /// Of the tangent of its inertia and its contacts.
      dealii::FullMatrix<double> inverse;
    };

    /// All unknowns of a vector of them, on each process, and back.
    std::vector<typename RigidTrial<dim>::Vector>
    all_of(const VectorType &q) const;
    void
    set_all(VectorType                                          &q,
            const std::vector<typename RigidTrial<dim>::Vector> &values) const;

    /// From the reference point of a body in the trial.
    dealii::Tensor<1, dim>
    distance(const FreeBody &body, const dealii::Point<dim> &x) const;

    /**
     * Collective. The load that changes of forces on the points of its contacts
     * give to a body.
     */
    typename RigidTrial<dim>::Vector
    load_by_changes(const FreeBody &body) const;

    /**
     * Collective. The tangent of the bodies by themselves.
     */
    void
    find_rigid_tangents();

    /**
     * Count the work on surfaces, with the loads of the start.
     */
    void
    add_work() const;

    BodyContacts<dim>                      &contacts;
    const std::vector<ImplicitSteps<dim> *> steps;
    const double                            dt;
    double                                  share  = 1.; // of the step
    double                                  weight = 1.; // contact_weight()

    std::vector<Side>                                     sides;
    std::vector<std::vector<const MaterialPoints<dim> *>> surfaces; // of parts
    std::vector<RigidPosition<dim>>                       at_start, at_trial;
    std::vector<RigidPosition<dim>>                       at_end;
    std::vector<FreeBody>                                 free_bodies;
    double                                      largest_rigid_force = 0.;
    std::vector<std::vector<ContactPoint<dim>>> points;
    std::vector<ContactResult<dim>>             results;
    std::vector<ContactTangent<dim>>            tangents;
    std::vector<VectorField<dim>>               forces;
    std::vector<KeyMemory<dim>>                 memories;
    // The tangents of this trial; and, by contact, those before which keys of
    // this process have begun or ended to slide, or slide the other way.
    unsigned int              n_tangents = 0;
    std::vector<unsigned int> n_changes;
    std::vector<double>       shares; // of ContactPoint::stiffness in matrices
    unsigned int              n_rounds = 0; // of augment()

    // For products.
    std::vector<VectorField<dim>>                    directions, products;
    std::vector<std::vector<dealii::Tensor<1, dim>>> displacements, relative;
    std::vector<std::vector<dealii::Tensor<1, dim>>> changes;
    std::vector<std::vector<double>>                 pore_pressures;
  };
} // namespace greville

#endif
