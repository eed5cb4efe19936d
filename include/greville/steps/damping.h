// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * Cundall's damping towards rest,
   *
   *   a_i -= alpha |f_i| / m_i sign(P_i)
   *
   * with the lumped mass m_i. It reduces the kinetic energy of the points by
   * alpha sum |f_i| |P_i| / m_i per time, with any mass. Damping the force
   * before the solve is equivalent for a lumped mass only. An inverse that is
   * not diagonal amplifies changes of sign between neighboring functions.
   */
  template <int dim>
  class Damping
  {
  public:
    /// The parameters are kept by reference.
    explicit Damping(const LoadParameters &parameters);

    /// Return the factor alpha.
    double
    factor() const
    {
      return parameters.cundall;
    }

    /// Damp the acceleration of a field in proportion to its force.
    void
    damp(GridField<dim> &field) const;

    /// Return the power of damping on this process, W (2D: W / m). Points have
    /// the momentum P before the kick and P' after it, and @p momenta is P +
    /// P'. A kick dt' a adds dt' a . (P + P') / 2 to the kinetic energy; only
    /// the part of a that is due to damping counts.
    double
    power(const GridField<dim> &field, const VectorField<dim> &momenta) const;

  private:
    /// Return the reduction of the acceleration of the owned function @p i.
    dealii::Tensor<1, dim>
    taken(const GridField<dim> &field, const unsigned int i) const;

    const LoadParameters &parameters;
  };
} // namespace greville
