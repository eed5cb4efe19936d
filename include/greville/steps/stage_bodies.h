// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// Return a body without points, with its name, parameters and material.
  template <int dim>
  Body<dim>
  make_body(const std::string &name, const SimulationParameters &parameters);

  /// Return the layout of a body's points: the history of its material in the
  /// stage of the @p parameters, and the fields that schemes and loads of all
  /// stages need.
  template <int dim>
  PointLayout<dim>
  layout_of(const std::string &body, const SimulationParameters &parameters);

  /// Return whether points keep the accelerations of generalized-alpha, which
  /// the grid keeps if points stay in their cells.
  template <int dim>
  bool
  keeps_in_points(const std::vector<Body<dim>> &bodies)
  {
    return !bodies.empty() && bodies[0].points.layout().find("acceleration");
  }

  /// Collective. Make the points of a body with their initial state at the
  /// start of the current stage: the K0 procedure includes the layers present
  /// then. Throws like make_points(), and also if an initial displacement moves
  /// points out of the grid.
  template <int dim>
  void
  add_points(Body<dim>                  &body,
             const unsigned int          stage,
             const SimulationParameters &parameters,
             const Loads<dim>           &loads,
             Discretization<dim>        &discretization);

  /// Collective. Return the surfaces of loads and contacts. They have no points
  /// if their body has none.
  template <int dim>
  std::vector<Surface<dim>>
  make_surfaces(const std::vector<Body<dim>> &bodies,
                const Loads<dim>             &loads,
                Discretization<dim>          &discretization);

  /// Collective. Return the bodies that are absent in the first stage, as if
  /// they were added now. Throws dealii::ExcMessage if this fails, and if two
  /// bodies of the same stage overlap; @p first contains the bodies of the
  /// first stage.
  template <int dim>
  std::vector<Body<dim>>
  make_later_bodies(const std::vector<Body<dim>> &first,
                    const SimulationParameters   &parameters,
                    Discretization<dim>          &discretization);

  /**
   * Collective. At the start of the stage of @p parameters, remove bodies and
   * their surfaces, add other bodies, and replace their materials @p before by
   * the materials of this stage.
   *
   * A point keeps its stress, mass (times the ratio of the densities),
   * position, velocity and id. If the new material has the same model and
   * elastic constants, it also keeps deformation and history. Otherwise, its
   * deformation gradient is the symmetric stretch that causes the stress, from
   * Material::initialize(). Its history is then the history of a new point;
   * with the same model, plastic strain and similar variables are kept. Throws
   * dealii::ExcMessage if a material does not allow the stress.
   */
  template <int dim>
  void
  change_bodies(State<dim>                          &state,
                const std::vector<const Material *> &before,
                const SimulationParameters          &parameters,
                const Loads<dim>                    &loads,
                Discretization<dim>                 &discretization);

  /// Collective. Throw if two bodies overlap by half of a cell or more.
  template <int dim>
  void
  check_overlap(const BodyList<dim> &bodies, const SplineSpace<dim> &space);

  /// Collective. Throw if two bodies with shapes overlap, however thin they
  /// are.
  template <int dim>
  void
  check_overlap_of_shapes(const BodyList<dim>    &bodies,
                          const SplineSpace<dim> &space);
} // namespace greville
