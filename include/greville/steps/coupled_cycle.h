// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/lattice_cycle.h>
#include <greville/stiffness/tangent_system.h>

#include <memory>
#include <vector>

namespace greville
{
  /// The preconditioner for the displacements of parts in contact: a
  /// LatticeCycle for the tangents of all parts and the contact stiffness.
  template <int dim>
  class CoupledCycle
  {
  public:
    /// Collective. Build the cycle with the coupling from @p make_coupling, if
    /// a system has been set up again since the last call, or if the sum of the
    /// @p stiffness of the coupling has changed by more than a fifth. The
    /// systems are kept by reference. Throws ErrorOnAll if a matrix has no
    /// factorization.
    void
    update(const std::vector<TangentSystem<dim> *> &systems,
           const double                             stiffness,
           const std::function<std::unique_ptr<LatticeCoupling<dim>>()>
             &make_coupling);

    /// Apply the cycle to the first blocks: the displacements of the parts.
    void
    vmult(std::vector<VectorType>       &dst,
          const std::vector<VectorType> &src) const;

  private:
    void
    build(const std::vector<TangentSystem<dim> *> &systems,
          const bool                               coarsens);

    std::vector<std::uint64_t>            set_ups; // of the systems
    double                                stiffness_of_set_up = 0.;
    std::unique_ptr<LatticeCoupling<dim>> coupling;
    std::unique_ptr<LatticeCycle<dim>>    cycle;
  };
} // namespace greville
