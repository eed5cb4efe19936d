// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_output_h
#define greville_run_output_h

#include <greville/base/csv.h>
#include <greville/parameters/simulation_parameters.h>
#include <greville/points/body_list.h>
#include <greville/points/point_transfer.h>
#include <greville/points/surface.h>

#include <map>
#include <string>

namespace greville
{
  /**
   * What files call a surface: the places of its load and of the body that it
   * belongs to in 'Simulation/Surface loads' and 'Simulation/Bodies'.
   */
  struct SurfaceNumbers
  {
    /// Contacts are counted behind loads.
    unsigned int load = 0, body = 0;
  };



  /**
   * What grid_NNNN.pvtu has. Vectors have no ghost values.
   */
  template <int dim>
  struct GridFields
  {
    const VectorField<dim> *velocity = nullptr;
    /// Per function.
    const VectorType *mass = nullptr;
    /// Null: not written.
    const VectorField<dim> *acceleration = nullptr;
    /// Per function; null: not written.
    const VectorField<dim> *force = nullptr;
    /// Of owned cells, see CellFilling::cell_class(); empty: not written.
    std::vector<unsigned char> cell_classes;
  };



  /**
   * Writes points, grid fields and the points of loads on surfaces for
   * ParaView: points_NNNN.pvtu, grid_NNNN.pvtu and surface_NNNN.pvtu, with
   * points.pvd, grid.pvd and surface.pvd that hold the times. The .pvd files
   * are replaced after each of them, so that they never name what is not
   * there.
   */
  template <int dim>
  class FieldOutput
  {
  public:
    /**
     * The parameters are kept by reference.
     */
    FieldOutput(const std::string      &directory,
                const OutputParameters &parameters);

    /**
     * Collective. Write the points: the fields of the parameters, see
     * point_fields().
     */
    void
    write_points(const double         time,
                 const BodyList<dim> &bodies,
                 const MPI_Comm       comm);

    /**
     * Collective. Write the fields of a grid as Lagrange cells of the order of
     * the @p space, where there is mass. One of several grids has the name of
     * its @p body.
     */
    void
    write_grid(const double            time,
               const SplineSpace<dim> &space,
               const GridFields<dim>  &fields,
               const std::string      &body = "");

    /**
     * Collective. Write the points of loads on surfaces: the number of the load
     * and that of its body, which @p numbers has for each surface, load (Pa per
     * initial area), normal today times area, area, velocity and displacement.
     * Writes nothing where there are none. Those of one of several grids have
     * the name of its @p body.
     */
    void
    write_surfaces(const double                       time,
                   const std::vector<Surface<dim>>   &surfaces,
                   const std::vector<SurfaceNumbers> &numbers,
                   const MPI_Comm                     comm,
                   const std::string                 &body = "");

    /**
     * What has been written: lines with name, time and file, separated by
     * tabulators.
     */
    std::string
    record() const;

    /**
     * The file with the points at a time, with its folder; empty where they
     * have not been written.
     */
    std::string
    points_file(const double time) const;

    /**
     * Collective. Go on with what an earlier run has written, its record():
     * numbered files that it wrote later are removed.
     */
    void
    go_on(const std::string &record, const MPI_Comm comm);

  private:
    /**
     * Write @p data as the next ones of @p name.
     */
    template <typename DataOutType>
    void
    write_next(const std::string &name,
               const double       time,
               const DataOutType &data,
               const MPI_Comm     comm);

    const std::string       directory;
    const OutputParameters &parameters;
    // By name: "points", "grid", "surface".
    std::map<std::string, std::vector<std::pair<double, std::string>>>
      times_and_names;
  };



  /**
   * Follows single points in probes.csv: time, and for each probe its position,
   * velocity, and the Cauchy stress xx, yy, zz, xy.
   */
  template <int dim>
  class Probes
  {
  public:
    /**
     * Collective. Take the points of @p bodies that are nearest to the
     * positions in @p text ("x, y; x, y; ..."). Throws where it is none, and
     * where no point is nearer than a cell is long.
     */
    Probes(const std::string   &text,
           const BodyList<dim> &bodies,
           const MPI_Comm       comm);

    /**
     * Collective. Begin the @p file; where there are no probes it has only a
     * header.
     */
    void
    open(const std::string &file_name)
    {
      file.open(file_name, columns(), 12, comm);
    }

    /**
     * Collective. Go on with the first @p n_bytes of a file, and remove what an
     * earlier run has written behind them.
     */
    void
    go_on(const std::string &file_name, const std::uint64_t n_bytes)
    {
      file.go_on(file_name, columns(), 12, n_bytes, comm);
    }

    /**
     * Collective. Let all rows be on the disk. Returns the bytes of the file.
     */
    std::uint64_t
    sync()
    {
      return file.sync();
    }

    std::uint64_t
    n_bytes() const
    {
      return file.n_bytes();
    }

    bool
    empty() const
    {
      return probes.empty();
    }

    /**
     * The next row: what a list of bodies, the first of which is number @p
     * first, has on this process, with velocities times @p weight. It is added
     * where only the @p velocities are taken.
     */
    void
    take(const unsigned int   first,
         const BodyList<dim> &bodies,
         const double         weight     = 1.,
         const bool           velocities = false);

    /**
     * What has been taken is not to be written.
     */
    void
    forget()
    {
      values.clear();
    }

    /**
     * Collective. Write the row.
     */
    void
    write(const double time);

    /**
     * Those of the file.
     */
    std::vector<std::string>
    columns() const;

  private:
    struct Probe
    {
      unsigned int body;
      double       id;
    };

    MPI_Comm            comm;
    std::vector<Probe>  probes;
    std::vector<double> values; // of the next row
    CsvWriter           file;
  };
} // namespace greville

#endif
