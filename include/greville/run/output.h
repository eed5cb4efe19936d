// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/rigid_body.h>
#include <greville/parameters/simulation_parameters.h>
#include <greville/points/body_list.h>

#include <map>
#include <string>

namespace greville
{
  /// The numbers of a surface in files: of its load in 'Simulation/Surface
  /// loads' and of its body in 'Simulation/Bodies'.
  struct SurfaceNumbers
  {
    /// The numbers of contacts follow the loads.
    unsigned int load = 0, body = 0;
  };



  /// The fields of grid_NNNN.vtu. Vectors have no ghost values. Empty fields
  /// are not written.
  template <int dim>
  struct GridFields
  {
    VectorField<dim> velocity, acceleration;
    /// Per function.
    VectorType       mass;
    VectorField<dim> force;
    /// Classes of owned cells, see CellFilling::cell_class(); empty: not
    /// written.
    std::vector<unsigned char> cell_classes;
  };



  /// Writes points, grid fields, the points of loads and contacts on surfaces,
  /// and rigid bodies for ParaView: points_NNNN.vtu, grid_NNNN.vtu,
  /// surface_NNNN.vtu and rigid_NAME_NNNN.vtu in the folder `files`. Each file
  /// has the points or cells of all processes. fields.pvd lists all files with
  /// their times and is replaced after each, so that it never names a missing
  /// file.
  template <int dim>
  class FieldOutput
  {
  public:
    static constexpr const char *series_name = "fields.pvd",
                                *file_folder = "files";

    /// Keep @p parameters by reference.
    FieldOutput(const std::string      &directory,
                const OutputParameters &parameters);

    /// Collective. Write the points with the fields that the parameters name,
    /// see point_fields(), or of @p n bodies only. @p stress_jumps of these
    /// points are another field unless it is null.
    void
    write_points(const double         time,
                 const BodyList<dim> &bodies,
                 const MPI_Comm       comm,
                 const unsigned int   first = 0,
                 const unsigned int   n = dealii::numbers::invalid_unsigned_int,
                 const std::vector<double> *stress_jumps = nullptr);

    /// Collective. Write the fields of the grid cells with mass, as Lagrange
    /// cells of the order of the @p space. With several grids, the file has the
    /// name of the @p body.
    void
    write_grid(const double            time,
               const SplineSpace<dim> &space,
               const GridFields<dim>  &fields,
               const std::string      &body = "");

    /// Collective. Write the points of surfaces: the @p numbers of load and
    /// body, load (Pa per initial area), current normal times area, area,
    /// velocity and displacement, and with contacts gap, pressure, shear stress
    /// and ContactState. Writes nothing without points. With several grids, the
    /// file has the name of the @p body.
    void
    write_surfaces(const double                       time,
                   const std::vector<Surface<dim>>   &surfaces,
                   const std::vector<SurfaceNumbers> &numbers,
                   const MPI_Comm                     comm,
                   const std::string                 &body = "");

    /// Collective. Write the mesh of a rigid body with its velocity and
    /// displacement: rigid_NAME_NNNN.vtu, by the first process. The body has
    /// the @p position. An unbounded body is cut at @p region.
    void
    write_rigid_body(const double                    time,
                     const RigidBody<dim>           &body,
                     const RigidPosition<dim>       &position,
                     const dealii::BoundingBox<dim> &region,
                     const MPI_Comm                  comm);

    /// From now on, keep the texts of files in memory. Calls for the same name
    /// add to the same file.
    void
    hold()
    {
      holds = true;
    }

    /// Collective. Write the files in memory, and keep no more files there.
    void
    write_held(const MPI_Comm comm);

    void
    drop_held()
    {
      held.clear();
      holds = false;
    }

    /// Return a line for each file so far: name, time and file, separated by
    /// tabs.
    std::string
    record() const;

    /// Return the file of the points at a time, with its folder; empty if they
    /// have not been written.
    std::string
    points_file(const double time) const;

    /// Collective. Continue after the files of an earlier run in @p record, see
    /// record(). Later numbered files are removed.
    void
    resume(const std::string &record, const MPI_Comm comm);

  private:
    /// The text of a file by this process.
    struct File
    {
      std::string              name;
      double                   time = 0.;
      std::string              header, empty_piece;
      std::vector<std::string> pieces;
    };

    /// Collective. Write the @p data of all processes as the next file of
    /// @p name, or keep it in memory.
    template <typename DataOutType>
    void
    write_next(const std::string &name,
               const double       time,
               DataOutType       &data,
               const MPI_Comm     comm);

    void
    write_file(File &file, const MPI_Comm comm);

    const std::string       directory;
    const OutputParameters &parameters;
    // Files with their folder, by name: "points", "grid", "surface".
    std::map<std::string, std::vector<std::pair<double, std::string>>>
                      times_and_names;
    std::vector<File> held;
    bool              holds = false;
  };
} // namespace greville
