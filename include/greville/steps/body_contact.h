// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/rigid_body.h>
#include <greville/steps/simulation.h>

#include <array>
#include <unordered_map>

namespace greville
{
  /// The distances of cell centers from a rigid body in a position, by number
  /// of cell: the largest number, or its negative inside the body, if the
  /// distance exceeds the reach, m.
  template <int dim>
  struct CellDistances
  {
    RigidPosition<dim>                        position;
    double                                    reach = -1.;
    std::unordered_map<std::uint64_t, double> of_cells;
  };



  /// A surface of a part.
  template <int dim>
  struct ContactPlace
  {
    Simulation<dim>   *part;
    unsigned int       surface;
    CellDistances<dim> distances = CellDistances<dim>();
    /// True after check_added() for its body.
    bool is_known = false;
  };



  /// Two sides that touch: surfaces of parts, or a surface and a rigid body.
  template <int dim>
  struct BodyContact
  {
    std::string                                   name;
    std::array<std::vector<ContactPlace<dim>>, 2> sides;
    int rigid = -1; // number of the rigid body
    // The constants of the law: for both sides the modulus E', Pa, the
    // impedance of the softer side, Pa s / m, and cells of the coarser grid.
    ContactParameters given;
    double            modulus = 0., impedance = 0., cell_size = 0.;
    Lattice<dim>      lattice;
    std::unique_ptr<AveragedContact<dim>> average;
    // The motion of both sides: the sum of their speeds in the last step, m /
    // s; their displacement in it, and from the last check for overlaps until
    // then, m; whether there has been a check, and its Overlap::excess.
    double speed = 0., last_way = 0., way = 0.;
    bool   is_checked   = false;
    double first_excess = 0.;
    // Data of check_gains(): the gain of the last warning, the energy stored by
    // the pressure at the start, the energy given before the run was resumed,
    // J, and whether this energy has been counted.
    double warned_gain      = 0.;
    double stored_energy    = -1.;
    bool   is_start_counted = false;
  };



  /// A cell in which points may be near the second side.
  template <int dim>
  struct NearContactCell
  {
    unsigned int       cell;
    dealii::Point<dim> center;
    double             distance; // lower bound, of the center; 0: unknown
  };
} // namespace greville
