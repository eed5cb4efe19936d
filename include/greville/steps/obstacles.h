// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_obstacles_h
#define greville_steps_obstacles_h

#include <greville/steps/contact.h>

namespace greville
{
  /**
   * Bodies with an imposed velocity, as the others meet them. They add neither
   * mass nor force to the grid. Functions N_i of which they fill a share
   *   s_i = sum_p V_p N_i(x_p) / int N_i dx
   * that is not negligible have the normal n_i = sum_p V_p grad N_i(x_p), out
   * of the obstacle. The other bodies, with mass m_i, momentum P_i and force
   * f_i there, touch it where the velocity V of the obstacle would be an
   * impulse away from it, (m_i V - P_i - dt' f_i) . n_i >= 0, and where n_i is
   * negligible: inside of it. Coefficients that touch are held at V, of all
   * components. So the law of contact is: inelastic,
   * without slip, and no tension.
   *
   * (@ref Bardenhagen2000 "Bardenhagen, Brackbill and Sulsky, 2000", has
   * the condition and the normals.)
   */
  template <int dim>
  class Obstacles : public Contact<dim>
  {
  public:
    /**
     * Null without obstacles.
     */
    static std::unique_ptr<Contact<dim>>
    make(const IntegratorParts<dim> &parts);

    /**
     * The space is kept by reference.
     */
    explicit Obstacles(const SplineSpace<dim> &space);

    /**
     * Share, normals and velocities of the bodies as they are.
     */
    void
    begin_step(const ContactStep<dim> &step) override;

    /**
     * Hold what touches. Where the force of the points is not known, it is left
     * out.
     */
    void
    constrain(ContactStep<dim> &step) override;

    /**
     * Obstacles go before other contacts: coefficients that touch have their
     * velocity.
     */
    void
    apply(ContactStep<dim> &step) override;

    void
    set_values(VectorField<dim>  &velocity,
               const unsigned int field) const override
    {
      set_velocity(velocity, field, true);
    }

    bool
    constrains() const override
    {
      return true;
    }

  private:
    /**
     * Find the components that touch of a field.
     */
    void
    touch(GridField<dim>             &field,
          std::vector<unsigned char> &touching,
          const ContactStep<dim>     &step) const;

    /**
     * Set coefficients that touch, where walls do not hold them: to the
     * velocity of the obstacle at the start or the end of the step.
     */
    void
    set_velocity(VectorField<dim>  &velocity,
                 const unsigned int field,
                 const bool         at_end) const;

    /**
     * The acceleration that leads from the velocity to that of the end.
     */
    void
    set_acceleration(GridField<dim> &field, const unsigned int number) const;

    const SplineSpace<dim> &space;
    double                  step = 0.; // s

    // By owned function: integral over the support, share, normal times its
    // size, and velocities.
    std::vector<double>                                integrals, share;
    std::array<std::vector<double>, dim>               normal;
    std::array<std::vector<dealii::Tensor<1, dim>>, 2> velocities;
    // By field and owned function: components, as bits.
    std::vector<std::vector<unsigned char>> touching;
    MaterialPoints<dim>                     points;
    VectorType                              volume;
    VectorField<dim>                        momentum, gradient;
  };
} // namespace greville

#endif
