// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/mass_level.h>
#include <greville/multigrid/p_multigrid.h>

namespace greville
{
  /// The cycle of PMultigrid for the mass of points on extended B-splines, as a
  /// preconditioner of ExtendedMassSolver, applied column by column. Components
  /// with the same constrained functions share their levels.
  template <int dim>
  class ExtendedMultigrid
  {
  public:
    /// A function that returns, for the local functions of a space, whether a
    /// component is constrained (not zero).
    using ConstrainedFunctions =
      std::function<std::vector<unsigned char>(const SplineSpace<dim> &space,
                                               const unsigned int component)>;

    /// Collective. The arguments are kept by reference. The mass has the finest
    /// order.
    ExtendedMultigrid(const OrderHierarchy<dim>  &orders,
                      const ExtendedMass<dim>    &mass,
                      const ConstrainedFunctions &constrained,
                      const PMultigridParameters &parameters,
                      const SmootherParameters   &smoother_parameters);

    /// Collective. Update after a change of the mass. If @p unknowns_changed,
    /// the set of unknowns with this @p filling is new. @p fill(weights) fills
    /// the weights of a level.
    void
    update(const CellFilling<dim>                           &filling,
           const bool                                        unknowns_changed,
           const std::function<void(DensityWeights<dim> &)> &fill);

    /// Collective. Compute z = one cycle for each of the first @p n_columns
    /// columns of r, which has @p width columns.
    void
    vmult(VectorType        &z,
          const VectorType  &r,
          const unsigned int width,
          const unsigned int n_columns) const;

  private:
    /// The levels of components with the same constrained functions.
    struct Group
    {
      unsigned int component; // the first of the group
      std::vector<std::unique_ptr<MassLevel<dim>>> levels;
      std::unique_ptr<PMultigrid<dim>>             cycle;
    };

    const OrderHierarchy<dim>  &orders;
    const ExtendedMass<dim>    &mass;
    const PMultigridParameters &parameters;
    const SmootherParameters   &smoother_parameters;

    const ConstrainedFunctions    constrained;
    std::vector<Group>            groups;
    std::array<unsigned int, dim> group_of; // by component
    mutable VectorType            to, from;
  };
} // namespace greville
