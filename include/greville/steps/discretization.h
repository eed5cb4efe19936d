// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/loads.h>
#include <greville/points/point_transport.h>
#include <greville/steps/move_points.h>
#include <greville/steps/step_log.h>

#include <optional>

namespace greville
{
  /// Collective. Make the cells of a @p grid at the @p start of a run (s), and
  /// return their number in each direction. Throws dealii::ExcMessage, which
  /// names the @p parameter, if they do not fit into memory.
  template <int dim>
  MultiIndex<dim>
  create_grid_mesh(DistributedTriangulation<dim> &mesh,
                   const GridParameters          &grid,
                   const WallParameters          &walls,
                   const std::string             &parameter,
                   const double                   start);



  /// The grid: mesh, spline spaces, walls and velocity fields with their
  /// masses, and the transfer between the grid and the points of a state. Sums
  /// over points are computed once for each State::points_version.
  template <int dim>
  class Discretization
  {
  public:
    /// Collective. Distribute points and cells equally among processes.
    /// Parameters and log are kept by reference. Throws dealii::ExcMessage for
    /// invalid parameters.
    Discretization(const SimulationParameters &parameters,
                   const Loads<dim>           &loads,
                   StepLog                    &log,
                   const MPI_Comm              comm);

    /// Collective. Make the cells of a @p partition with refined cells, and
    /// distribute the cells among the processes by it. Returns whether the mesh
    /// has changed; reinit() must then make everything anew. Cells are not
    /// distributed on one process, if they have this distribution already, or
    /// if the partition has no rows.
    bool
    repartition(const std::shared_ptr<const Partition> &partition);

    /// Return the distribution of the cells.
    const std::shared_ptr<const Partition> &
    partition() const
    {
      return cell_partition;
    }

    /// Collective. Make walls and mass anew from the parameters, which may now
    /// belong to another stage. Initialized fields, and the space of points,
    /// still refer to the old space.
    void
    reinit();

    /// Collective. Call reinit() after the cells of triangulation() have
    /// changed, without rows of a partition. @p at_surfaces is a member of
    /// RefinedCells.
    void
    reinit_adapted(const std::vector<std::uint64_t> &at_surfaces);

    MPI_Comm
    communicator() const
    {
      return comm;
    }

    DistributedTriangulation<dim> &
    triangulation()
    {
      return mesh;
    }

    const SplineSpace<dim> &
    space() const
    {
      return orders.finest();
    }

    /// Return the orders that solvers use, in descending order from space().
    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /// Return the smallest edge of a cell, m.
    double
    cell_size() const
    {
      return space().smallest_cell_size();
    }

    const Walls<dim> &
    walls() const
    {
      return grid_walls;
    }

    GridField<dim> &
    field()
    {
      return grid_field;
    }

    const GridField<dim> &
    field() const
    {
      return grid_field;
    }

    PointTransfer<dim> &
    transfer()
    {
      return point_transfer;
    }

    const PointTransfer<dim> &
    transfer() const
    {
      return point_transfer;
    }

    /// Return the windows of cells, null if gradients are evaluated at points.
    CellWindows<dim> *
    cell_windows()
    {
      return windows.get();
    }

    /// Return the projection of volume changes, null if there is none.
    VolumeProjection<dim> *
    volume_projection()
    {
      return projection.get();
    }

    PointTransport<dim> &
    transport()
    {
      return point_transport;
    }

    /// Allocate a field.
    void
    initialize(VectorField<dim> &field) const
    {
      for (VectorType &component : field)
        space().initialize_vector(component);
    }

    /// Initialize a state's FieldState with zeros.
    void
    initialize_field(State<dim> &state) const;

    /// Collective. Sum up mass and momentum of the points and assemble the
    /// mass, unless this has been done for State::points_version. With
    /// @p with_force, also sum up the force, including loads on surfaces.
    void
    sum(const State<dim> &state, const bool with_force = false);

    /// Collective. Sum up the momentum after a kick that has not moved the
    /// points: the masses do not change.
    void
    sum_momentum(const State<dim> &state);

    /// Collective. Compute the force on the functions by stresses, by the
    /// current loads of points, and by the acceleration @p gravity. The results
    /// of sum() do not change.
    void
    find_force(const State<dim>             &state,
               const dealii::Tensor<1, dim> &gravity,
               VectorField<dim>             &force);

    /// Collective. Return CellFilling::cell_class() of the owned cells for
    /// extended B-splines.
    std::vector<unsigned char>
    cell_classes(const State<dim> &state, const bool is_implicit);

    /// Collective. Solve M x = sum for pairs of fields, see GridMass::solve().
    /// Returns the largest number of iterations of a component. Throws
    /// StepFailed if the solver does not converge.
    unsigned int
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &sums,
          const std::vector<double>                   &shares = {});

    /// Return the share of FLIP in a step @p dt (s), see SchemeParameters.
    double
    flip_share(const State<dim> &state, const double dt) const;

    /// Collective. Move points that have left their cells in a @p motion to
    /// their new cells and processes, and count the points of bodies. Throws
    /// StepFailed for invalid points.
    void
    transport_points(State<dim> &state, const PointMotion &motion);

  private:
    void
    make_field();

    /// Add the loads on surfaces to the force, and store each of them.
    void
    add_surface_forces(const State<dim>              &state,
                       std::vector<VectorField<dim>> &of_surfaces,
                       VectorField<dim>              &force);

    void
    set_points(const State<dim> &state);

    const SimulationParameters            &parameters;
    StepLog                               &log;
    MPI_Comm                               comm;
    DistributedTriangulation<dim>          mesh;
    std::shared_ptr<const Partition>       cell_partition;
    Walls<dim>                             grid_walls;
    OrderHierarchy<dim>                    orders;
    GridField<dim>                         grid_field;
    PointTransfer<dim>                     point_transfer;
    std::unique_ptr<VolumeProjection<dim>> projection;
    std::unique_ptr<CellWindows<dim>>      windows;
    PointTransport<dim>                    point_transport;

    std::uint64_t version_of_sums = 0;     // 0: no state
    bool          mass_is_known   = false; // in total Lagrangian steps
  };
} // namespace greville
