// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/point_tangents.h>
#include <greville/points/volume_projection.h>
#include <greville/stiffness/block_stencil.h>
#include <greville/stiffness/trial_body.h>

#include <string>

namespace greville
{
  /**
   * The contribution of the points of bodies to a TangentSystem: internal
   * forces on the grid in a TrialStep, and their stiffness K. K is applied
   * point by point (PointTangents).
   *
   * A VolumeProjection couples functions beyond their stencils. In the K of
   * tangents(), the volumetric stiffness is therefore reduced to about the
   * shear stiffness, and multiply_rest() adds the terms of J hat point by
   * point. The projected volume changes are much stiffer than in K, but all
   * other modes agree, so the number of iterations hardly depends on the bulk
   * modulus. If gradients are averaged over domains, K uses the gradients at
   * points, and multiply_rest() adds the difference.
   */
  template <int dim>
  class TangentBodies
  {
  public:
    /// The arguments are kept by reference; the last two may be null.
    TangentBodies(const SplineSpace<dim> &space,
                  VolumeProjection<dim>  *projection,
                  CellWindows<dim>       *windows);

    /// Collective. See TangentSystem::evaluate(). If K is symmetric, it is also
    /// assembled in @p entries, unless null; tangents() is then empty without
    /// domains.
    std::string
    evaluate(const std::vector<TrialBody<dim>> &bodies,
             const VectorField<dim>            &u,
             const double                       dt,
             const StepStress                   stress,
             const bool                         with_stiffness,
             BlockStencil<dim, double>         *entries,
             VectorField<dim>                  &force);

    /// Return K.
    const PointTangents<dim> &
    tangents() const
    {
      return K;
    }

    /// Return whether K lacks a part of the stiffness.
    bool
    has_rest() const
    {
      return projection || windows;
    }

    bool
    has_projection() const
    {
      return projection;
    }

    /// Return whether a material has no symmetric tangent, as most plastic
    /// laws.
    bool
    has_plastic_flow() const
    {
      return plastic_flow;
    }

    /// Collective. Compute the product of the part that K lacks with a
    /// @p direction of the displacement.
    void
    multiply_rest(VectorField<dim> &force, const VectorField<dim> &direction);

    /// Return the sums of the compression and shear moduli of K of all points.
    const std::array<double, 2> &
    moduli() const
    {
      return sums_of_moduli;
    }

    /// Collective. Return the Euclidean norm of the cell contributions to the
    /// last force. For the most part, these balance each other.
    double
    force_scale() const;

    /// Return the unit of round-off of forces: the norm of the cell
    /// contributions for a displacement gradient of one, with the moduli of the
    /// last evaluate() with stiffness.
    double
    stiffness_scale() const
    {
      return force_of_strain;
    }

  private:
    /// Prepare K for the points of the bodies.
    void
    begin_tangents(const std::vector<TrialBody<dim>> &bodies,
                   const StepStress                   stress,
                   BlockStencil<dim, double>         *entries);

    const SplineSpace<dim> &space;
    TrialSums<dim>          sums;
    TrialStep<dim>          trial;
    PointTangents<dim>      K;
    VolumeProjection<dim>  *projection;
    // The displacement of the last evaluate() with stiffness and a projection.
    VectorField<dim>                displacement;
    std::vector<ProjectedBody<dim>> projected_bodies;
    // The points with domains, for each cell that reaches its neighbours.
    CellWindows<dim>                                                  *windows;
    std::vector<std::pair<unsigned int, std::vector<TrialGroup<dim>>>> domains;
    std::vector<double>   window_buffer;
    bool                  plastic_flow = false;
    std::array<double, 2> sums_of_moduli{};
    double                force_of_strain = 0.;
  };
} // namespace greville
