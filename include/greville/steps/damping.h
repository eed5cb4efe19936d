// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_damping_h
#define greville_steps_damping_h

#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * Cundall's damping towards rest,
   *
   *   a_i -= alpha |f_i| / m_i sign(P_i)
   *
   * with the lumped mass m_i: it takes alpha sum |f_i| |P_i| / m_i out of the
   * kinetic energy of the points per time, with any mass. To damp the force
   * before the solve is the same for a lumped mass; an inverse that is not
   * diagonal amplifies changes of sign from one function to the next.
   */
  template <int dim>
  class Damping
  {
  public:
    /**
     * The parameters are kept by reference.
     */
    explicit Damping(const LoadParameters &parameters);

    /**
     * The factor alpha.
     */
    double
    factor() const
    {
      return parameters.cundall;
    }

    /**
     * Damp the acceleration of a field that its force has led to.
     */
    void
    damp(GridField<dim> &field) const;

    /**
     * The power of that on this process, W (2D: W / m), where points have the
     * momentum P before and P' after the kick, and @p momenta is P + P': a kick
     * dt' a adds dt' a . (P + P') / 2 to their kinetic energy, and damping has
     * its part of a in that.
     */
    double
    power(const GridField<dim> &field, const VectorField<dim> &momenta) const;

  private:
    /**
     * What damping with the factor @p alpha takes from the acceleration of
     * function @p i of this process.
     */
    dealii::Tensor<1, dim>
    taken(const GridField<dim> &field,
          const double          alpha,
          const unsigned int    i) const;

    const LoadParameters &parameters;
  };
} // namespace greville

#endif
