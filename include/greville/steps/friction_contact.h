// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_friction_contact_h
#define greville_steps_friction_contact_h

#include <greville/steps/grid_mass.h>

namespace greville
{
  /**
   * Friction walls where the mass matrix M couples coefficients. The velocity v
   * of a step without these walls is corrected by impulses lambda of the
   * walls,
   *
   *   M (v' - v) = lambda,
   *   v'_n <= 0, lambda_n >= 0, v'_n lambda_n = 0            (no adhesion)
   *   |lambda_t| <= mu lambda_n                              (where it sticks)
   *   lambda_t = -mu lambda_n v'_t / |v'_t|                  (where it slides)
   *
   * for each coefficient at such a wall, with v_n the speed into the wall and
   * lambda_n the impulse away from it. M does not couple components, so the
   * first two lines are the condition of a quadratic minimum with v'_n <= 0,
   * and the others, with lambda_n from there, Tresca's friction. Both are
   * solved together by active sets: what goes into the wall is held, in the
   * normal direction and along the wall; what is pulled is released; what needs
   * more than Coulomb's impulse slides under that load.
   *
   * All functions at such walls are unknowns, stable or lumped ones, see
   * CellFilling: the impulses act in the space of the velocity, and leave
   * nothing on the points that the grid does not see. What has been released
   * three times in a step stays when it returns, which ends the rounds.
   *
   * The references are
   * @ref Hintermueller2003 "Hintermueller, Ito and Kunisch, 2003", for the
   * active sets and
   * @ref Hueeber2008 "Hueeber, Stadler and Wohlmuth, 2008", for friction.
   */
  template <int dim>
  class FrictionContact
  {
  public:
    /**
     * Walls and mass are kept by reference.
     */
    FrictionContact(const Walls<dim> &walls, GridMass<dim> &mass);

    /**
     * Collective. Change the new velocity, and the acceleration that led to it
     * in the time @p dt. @p slid has the contacts that slid in the last step,
     * which are tried as such first: overwritten by those that slide in this
     * one; empty before the first. Returns the momentum that walls have given
     * on this process, friction walls and those that hold. Throws
     * dealii::ExcMessage where a solve does not converge.
     */
    WallSums<dim>
    add(VectorField<dim>  &velocity,
        VectorField<dim>  &acceleration,
        const double       dt,
        std::vector<bool> &slid);

    /**
     * Forget under what contacts slid in the last add(), where the next one
     * begins.
     */
    void
    forget()
    {
      for (Contact &contact : contacts)
        contact.load = {};
    }

    /**
     * Iterations of all solves of the last add(), and of the one that needed
     * most.
     */
    unsigned int
    n_iterations() const
    {
      return iterations;
    }

    unsigned int
    most_iterations() const
    {
      return most;
    }

    /**
     * What the impulses of the last add() on this process give to the kinetic
     * energy of a step from the velocity @p v to @p w, J (2D: J / m).
     */
    double
    work(const VectorField<dim> &v, const VectorField<dim> &w) const;

  private:
    enum class State
    {
      apart,
      sticks,
      slides
    };

    /**
     * A function at a friction wall.
     */
    struct Contact
    {
      unsigned int           wall       = 0;
      unsigned int           function   = 0; // local number
      State                  state      = State::apart;
      unsigned int           n_released = 0, n_stopped = 0; // in this step
      dealii::Tensor<1, dim> load;                          // where it slides
    };

    double
    speed_into_wall(const Contact &contact, const VectorField<dim> &v) const;

    /**
     * The part along the wall, without components that are held otherwise.
     */
    dealii::Tensor<1, dim>
    along_wall(const Contact &contact, const VectorField<dim> &v) const;

    /**
     * Hold and load the contacts as they are, and solve for the change.
     */
    void
    solve(const VectorField<dim> &velocity);

    /**
     * States and loads after a solve. Whether any has changed.
     */
    bool
    update(const VectorField<dim> &velocity, const double smallest_speed);

    /**
     * The momentum of the last change.
     */
    WallSums<dim>
    impulses();

    const Walls<dim>          &walls;
    GridMass<dim>             &mass;
    std::vector<Contact>       contacts;
    std::vector<unsigned char> normals; // bits of components that touch
    VectorField<dim>           change, load, reaction, held;
    unsigned int               iterations = 0, most = 0, rounds = 0;
  };
} // namespace greville

#endif
