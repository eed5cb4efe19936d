// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/body_contacts.h>
#include <greville/steps/implicit_steps.h>
#include <greville/steps/rigid_trial.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * The BodyContacts in a trial of an implicit step, see CoupledSteps. Contact
   * is evaluated at the trial positions of points and rigid bodies at the end
   * or in the middle of the step, depending on ImplicitScheme::load_time. Areas
   * and hat functions are taken from the start. If the trial is accepted, the
   * contacts receive results, loads, slip, and the positions of rigid bodies.
   *
   * The tangent is a ContactTangent. Its symmetric part is the coupling of a
   * LatticeCycle in the preconditioner, see CoupledCycle.
   */
  template <int dim>
  class TrialContacts
  {
  public:
    /// Collective. The integrators belong to the parts of @p contacts. Both are
    /// kept by reference. Throws StepFailed if a formula of a rigid body has no
    /// value.
    TrialContacts(BodyContacts<dim>                       &contacts,
                  const std::vector<ImplicitSteps<dim> *> &steps,
                  const double                             dt);

    /// Collective. Return the reason why no step of this length can be tried;
    /// empty if it can.
    std::string
    check_rigid_bodies() const;

    /// Collective. Set the pore pressures in the trial, given as the blocks of
    /// CoupledSteps: friction depends on the effective pressure.
    void
    set_pore_pressures(const std::vector<VectorType> &blocks);

    /// Collective. Evaluate contact at the trial displacements of the parts,
    /// with the tangent if requested. Returns an error message, or an empty
    /// text.
    std::string
    evaluate(const bool with_stiffness);

    /// Return the number of unknowns of free rigid bodies, see RigidTrial.
    unsigned int
    n_rigid_unknowns() const
    {
      return free_bodies.size() * RigidTrial<dim>::n_unknowns;
    }

    /// Collective. Initialize the vector of the unknowns of rigid bodies, which
    /// belongs to the first process, with motion at constant velocity.
    void
    initialize_rigid(VectorType &q) const;

    /// Collective. Set the unknowns of rigid bodies for evaluate().
    void
    set_rigid(const VectorType &q);

    /// Compute the residual of rigid bodies and their largest force from the
    /// last evaluate().
    void
    find_rigid_residual(VectorType &r);

    double
    rigid_scale() const
    {
      return largest_rigid_force;
    }

    /// Apply the inverse of the tangents of single bodies.
    void
    precondition_rigid(VectorType &dst, const VectorType &src) const;

    /// Return the force on the grid of a part, times the weight of contacts.
    const VectorField<dim> &
    force(const unsigned int part) const
    {
      return forces[part];
    }

    /// Return whether the tangent is symmetric: nothing slides with friction.
    bool
    is_symmetric() const;

    /// Collective. Return the symmetric part of the last tangent for the
    /// unknowns of the parts.
    std::unique_ptr<LatticeCoupling<dim>>
    coupling() const;

    /// Collective. Return the sum of the stiffness traces of all contact keys.
    double
    sum_of_stiffness() const;

    /// Collective. Add the tangent's product with @p src to @p dst. The blocks
    /// of the parts are followed by pore pressures, whose product does not
    /// change, and by free rigid bodies, whose product is set, if there are
    /// any.
    void
    add_product(std::vector<VectorType>       &dst,
                const std::vector<VectorType> &src);

    /// Collective. Set the given pressures of augmented contacts to the
    /// computed ones. Returns whether any have changed; the equations must then
    /// be solved again.
    bool
    augment();

    /// Collective. Return the reason for rejecting a trial that solves the
    /// equations: points have moved so far that they may have missed contacts.
    /// Empty if there is none.
    std::string
    check_motion() const;

    /// Collective. Return a text, after "; ", with the names of contacts that
    /// have changed between sticking and sliding before most tangents, and with
    /// a parameter that helps. Empty if there are none.
    std::string
    describe_changes() const;

    /// Collective. Accept the step, after the parts' integrators have stored
    /// the trial.
    void
    accept();

  private:
    using Contact = typename BodyContacts<dim>::Contact;
    using Place   = typename BodyContacts<dim>::Place;

    /// A surface, and the offset of its points among the points of a contact.
    struct Side
    {
      unsigned int contact, side, part, surface;
      std::size_t  begin, end;
    };

    /// Collective. Set the points of a contact after a @p share of the step.
    void
    move_points(const unsigned int contact, const double share);

    /// Collective. Compute contact after a share of the step, and its results.
    std::string
    find_forces(const double share, const bool with_stiffness);

    const MaterialPoints<dim> &
    points_of(const Side &side) const;

    /// Return whether friction depends on the pore pressure.
    bool
    friction_depends_on_pores() const;

    /// Collective. Compute pore pressures, or their changes, at all points.
    void
    find_pore_pressures(const std::vector<VectorType> &blocks);

    struct FreeBody
    {
      unsigned int                     number; // of the rigid body
      RigidTrial<dim>                  trial;
      typename RigidTrial<dim>::Vector q, load;
      /// The inverse of the tangent of its inertia and its contacts.
      dealii::FullMatrix<double> inverse;
    };

    /// Gather all unknowns of a vector on each process, and write them back.
    std::vector<typename RigidTrial<dim>::Vector>
    all_of(const VectorType &q) const;
    void
    set_all(VectorType                                          &q,
            const std::vector<typename RigidTrial<dim>::Vector> &values) const;

    /// Return the distance from the reference point of a body in the trial.
    dealii::Tensor<1, dim>
    distance(const FreeBody &body, const dealii::Point<dim> &x) const;

    /// Collective. Return the load on a body due to the changes of forces.
    typename RigidTrial<dim>::Vector
    load_by_changes(const FreeBody &body) const;

    /// Collective. Compute the tangents of single bodies.
    void
    find_rigid_tangents();

    /// Count the work on surfaces, with the loads at the start.
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
    // The number of tangents of this trial. And by contact, the number of
    // tangents for which keys of this process started, stopped or reversed
    // sliding.
    unsigned int              n_tangents = 0;
    std::vector<unsigned int> n_changes;
    unsigned int              n_rounds = 0; // of augment()

    // Memory for products.
    std::vector<VectorField<dim>>                    directions, products;
    std::vector<std::vector<dealii::Tensor<1, dim>>> displacements, relative;
    std::vector<std::vector<dealii::Tensor<1, dim>>> changes;
    std::vector<std::vector<double>>                 pore_pressures;
  };
} // namespace greville
