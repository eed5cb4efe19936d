// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_discretization_h
#define greville_steps_discretization_h

#include <greville/boundary/loads.h>
#include <greville/points/point_transport.h>
#include <greville/points/volume_projection.h>
#include <greville/steps/grid_field.h>
#include <greville/steps/state.h>
#include <greville/steps/step_log.h>

#include <optional>

namespace greville
{
  /**
   * The grid: mesh, spaces of B-splines, walls and velocity fields with their
   * masses, and what goes between the grid and the points of a state. Sums over
   * points are made once for each State::points_stamp.
   */
  template <int dim>
  class Discretization
  {
  public:
    /**
     * Collective. Processes get the same share of points and cells. Parameters
     * and log are kept by reference. Throws dealii::ExcMessage where parameters
     * are wrong.
     */
    Discretization(const SimulationParameters &parameters,
                   const Loads<dim>           &loads,
                   StepLog                    &log,
                   const MPI_Comm              comm);

    /**
     * Collective. Share the cells among the processes as @p partition wants it.
     * Returns whether the mesh has changed, not where cells are shared so,
     * where it has no rows and on one process: then all has to be made anew by
     * reinit().
     */
    bool
    repartition(const std::shared_ptr<const Partition> &partition);

    /**
     * How the cells are shared.
     */
    const std::shared_ptr<const Partition> &
    partition() const
    {
      return cell_partition;
    }

    /**
     * Collective. Make walls and mass anew from the parameters,
     * which may have become those of another stage. Fields that have been
     * initialized before, and the space of points, are those of the old space.
     */
    void
    reinit();

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

    /**
     * The orders that solvers make use of, down from space().
     */
    const OrderHierarchy<dim> &
    hierarchy() const
    {
      return orders;
    }

    /**
     * The smallest edge of a cell, m.
     */
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

    /**
     * The windows of cells, null where gradients are those at points.
     */
    CellWindows<dim> *
    cell_windows()
    {
      return windows.get();
    }

    /**
     * The projection of changes of volume, null where there is none.
     */
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

    /**
     * Make room for a field.
     */
    void
    initialize(VectorField<dim> &field) const;

    /**
     * Give a state a FieldState of zeros.
     */
    void
    initialize_field(State<dim> &state) const;

    /**
     * Collective. Sum up mass and momentum of the points, and assemble the
     * mass, unless those of State::points_stamp are there; and
     * @p with_force the force, with that of loads on surfaces.
     */
    void
    sum(const State<dim> &state, const bool with_force = false);

    /**
     * Collective. The momentum of points that have been kicked where they are:
     * the masses stay.
     */
    void
    sum_momentum(const State<dim> &state);

    /**
     * Collective. The force on the functions by stresses, by loads
     * as the points have them, and by the acceleration @p gravity. It changes
     * nothing of what sum() has found.
     */
    void
    find_force(const State<dim>             &state,
               const dealii::Tensor<1, dim> &gravity,
               VectorField<dim>             &force);

    /**
     * Collective. CellFilling::cell_class() of the owned cells, as extended
     * B-splines have them.
     */
    std::vector<unsigned char>
    cell_classes(const State<dim> &state, const bool is_implicit);

    /**
     * Collective. Solve M x = sum for pairs of them, see GridMass::solve().
     * Returns the most iterations of a component. Throws StepFailed where the
     * solver does not converge.
     */
    unsigned int
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &sums,
          const std::vector<double>                   &shares = {});

    /**
     * Collective. Bring points that have left the cells @p left_cells[body],
     * or those of surfaces, to their new cells and processes, and count those
     * of bodies. Returns what is wrong with them on this process.
     */
    std::string
    transport_points(
      State<dim>                                   &state,
      const std::vector<std::vector<unsigned int>> &left_cells,
      const std::vector<std::vector<unsigned int>> &left_surface_cells = {});

  private:
    void
    make_field();

    /**
     * Add the loads on surfaces to the force, and remember each of them.
     */
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

    std::uint64_t stamp_of_sums = 0;     // of no state
    bool          mass_is_known = false; // for all states
  };
} // namespace greville

#endif
