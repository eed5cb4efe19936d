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
     * Both are kept by reference.
     */
    Damping(const LoadParameters      &parameters,
            const Discretization<dim> &discretization);

    /**
     * The factor alpha.
     */
    double
    factor() const
    {
      return parameters.cundall;
    }

    /**
     * Damp the acceleration that the @p force has led to.
     */
    void
    damp(VectorField<dim> &acceleration, const VectorField<dim> &force) const;

    /**
     * The power of that on this process, W (2D: W / m), where points have the
     * momentum P before and P' after the kick, and @p momenta is P + P': a kick
     * dt' a adds dt' a . (P + P') / 2 to their kinetic energy, and damping has
     * its part of a in that.
     */
    double
    power(const VectorField<dim> &momenta, const VectorField<dim> &force) const;

  private:
    /**
     * What damping with the factor @p alpha takes from component @p d of the
     * acceleration of function @p i of this process.
     */
    double
    taken(const VectorField<dim> &force,
          const double            alpha,
          const unsigned int      i,
          const unsigned int      d) const;

    const LoadParameters      &parameters;
    const Discretization<dim> &discretization;
  };
} // namespace greville

#endif
