// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/local_cells.h>
#include <greville/contact/rigid_body.h>
#include <greville/steps/simulation.h>

#include <array>
#include <unordered_map>

namespace greville
{
  /// Signed distances of cell centers from a rigid body in one position, by
  /// cell number, m. Distances beyond the reach, in cells, are infinite in
  /// effect: the largest number, negative inside the body.
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
    // Constants of the contact law: the modulus E' of both sides, Pa, and the
    // impedance of the softer side, Pa s / m.
    ContactParameters given;
    double            modulus = 0., impedance = 0.;
    // The cells of the parts, see take_cells(): the size of the smallest cells,
    // m, of the larger ones of two grids; the lattices of hat functions; the
    // size of the smallest cells that contain points of the contact, m.
    bool                                          is_uniform = true;
    double                                        cell_size  = 0.;
    std::vector<Lattice<dim>>                     lattices;
    std::vector<std::shared_ptr<const Partition>> cells;
    double                                        smallest = 0.;
    std::unique_ptr<AveragedContact<dim>>         average;
    // The motion of both sides in cells: the sum of their speeds in the last
    // step, 1 / s; their displacement in this step, and since the last check
    // for overlaps; whether a check has been made, and its Overlap::excess.
    double speed = 0., last_way = 0., way = 0.;
    bool   is_checked   = false;
    double first_excess = 0.;
    // Data of check_gains(): the gain at the last warning; the energy that the
    // pressure stored at the start, J, with the energy given before a resumed
    // run; whether the latter has been added.
    double warned_gain      = 0.;
    double stored_energy    = -1.;
    bool   is_start_counted = false;

    /// Return the cell size (m) for a point of a side at x, which belongs to a
    /// cell of its space: the smallest edge of this cell, or, with two
    /// lattices, of the cell of the hat functions at x if that is larger.
    double
    cell_size_at(const SplineSpace<dim>   &space,
                 const unsigned int        cell,
                 const dealii::Point<dim> &x) const
    {
      if (!is_uniform && lattices.size() == 1)
        return smallest_edge(space.box(cell));
      return is_uniform ? cell_size
                        : std::max(smallest_edge(space.box(cell)),
                                   greville::cell_size_at(
                                     lattices[lattice_at(lattices, x)], x));
    }
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
