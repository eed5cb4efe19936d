// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/rigid_body.h>
#include <greville/steps/simulation.h>

#include <array>
#include <unordered_map>

namespace greville
{
  /// Signed distances of cell centers from a rigid body in one position, by
  /// cell number, m. Distances beyond the reach are infinite in effect: the
  /// largest number, negative inside the body.
  template <int dim>
  struct CellDistances
  {
    RigidPosition<dim>                        position;
    double                                    reach = -1.;
    std::unordered_map<std::uint64_t, double> of_cells;
  };



  /// A contact surface of a part of CoupledSimulations.
  template <int dim>
  struct ContactPlace
  {
    Simulation<dim>   *part;
    unsigned int       surface;
    CellDistances<dim> distances = CellDistances<dim>();
    /// True if added_places() has seen the body's points.
    bool is_known = false;
  };



  /// Two sides that touch: surfaces of parts, or a surface and a rigid body.
  template <int dim>
  struct BodyContact
  {
    std::string                                   name;
    std::array<std::vector<ContactPlace<dim>>, 2> sides;
    int rigid = -1; // number of the rigid body
    // Constants of the contact law: the modulus E' of both sides, Pa, the
    // impedance of the softer side, Pa s / m, and the larger cell size, m.
    ContactParameters given;
    double            modulus = 0., impedance = 0., cell_size = 0.;
    Lattice<dim>      lattice;
    std::shared_ptr<const Partition>      cells; // those of the lattice
    std::unique_ptr<AveragedContact<dim>> average;
    // The motion of both sides: the sum of their speeds in the last step, m /
    // s; their displacement in this step, and since the last check for
    // overlaps, m; whether a check has been made, and its Overlap::excess.
    double speed = 0., last_way = 0., way = 0.;
    bool   is_checked   = false;
    double first_excess = 0.;
    // Data of check_gains(): the gain at the last warning; the energy that the
    // pressure stored at the start, J, with the energy given before a resumed
    // run; whether the latter has been added.
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
    double             distance; // lower bound for the center; 0: unknown
  };
} // namespace greville
