// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_stage_bodies_h
#define greville_steps_stage_bodies_h

#include <greville/points/body_list.h>
#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * A body without points: its name, parameters and material.
   */
  template <int dim>
  Body<dim>
  make_body(const std::string &name, const SimulationParameters &parameters);

  /**
   * What points of a body have: the history of its material in the stage of
   * the @p parameters, and the fields that schemes and loads of all stages
   * need.
   */
  template <int dim>
  PointLayout<dim>
  layout_of(const std::string &body, const SimulationParameters &parameters);

  /**
   * Collective. Give a body its points, with its initial state at the start of
   * the stage at hand: its K0 procedure counts the layers that are there then.
   * Throws dealii::ExcMessage as make_points(), and where an initial
   * displacement moves points out of the grid.
   */
  template <int dim>
  void
  add_points(Body<dim>                  &body,
             const unsigned int          stage,
             const SimulationParameters &parameters,
             const Loads<dim>           &loads,
             Discretization<dim>        &discretization);

  /**
   * Collective. The surfaces of loads and contacts, without points where their
   * body has none.
   */
  template <int dim>
  std::vector<Surface<dim>>
  make_surfaces(const std::vector<Body<dim>> &bodies,
                const Loads<dim>             &loads,
                Discretization<dim>          &discretization);

  /**
   * Collective. The bodies that are not there in the first stage, as if they
   * came now. Throws dealii::ExcMessage where one cannot, and where two of a
   * stage are in the same place, those of the @p first stage among them.
   */
  template <int dim>
  std::vector<Body<dim>>
  make_later_bodies(const std::vector<Body<dim>> &first,
                    const SimulationParameters   &parameters,
                    Discretization<dim>          &discretization);

  /**
   * Collective. At the start of the stage that @p parameters are those of: take
   * away bodies with their surfaces, add others, and give bodies the material
   * that they have in this stage, in the place of those of @p before.
   *
   * A point keeps its stress, mass (times the ratio of the densities), place,
   * velocity and id. Where the new material is of the same model and elastic
   * constants, it keeps deformation and history, too. Otherwise its deformation
   * gradient is the symmetric stretch that belongs to the stress, as
   * Material::initialize() finds it; history is that of a new point, but for
   * plastic strain and the like where the model is the same. Throws
   * dealii::ExcMessage where a material cannot have the stress.
   */
  template <int dim>
  void
  change_bodies(State<dim>                          &state,
                const std::vector<const Material *> &before,
                const SimulationParameters          &parameters,
                const Loads<dim>                    &loads,
                Discretization<dim>                 &discretization);

  /**
   * Collective. Throw where two bodies fill the same cells, by half a cell or
   * more.
   */
  template <int dim>
  void
  check_overlap(const BodyList<dim> &bodies, const SplineSpace<dim> &space);

  /**
   * Collective. The same of bodies with shapes, however thin they are.
   */
  template <int dim>
  void
  check_overlap_of_shapes(const BodyList<dim>    &bodies,
                          const SplineSpace<dim> &space);
} // namespace greville

#endif
