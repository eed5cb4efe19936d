// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_output_h
#define greville_simulation_output_h

#include <greville/base/csv.h>
#include <greville/particles/body.h>
#include <greville/particles/point_transfer.h>
#include <greville/particles/surface.h>
#include <greville/simulation/parameters.h>

#include <string>

namespace greville
{
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
   * are replaced at the end of each write, so that they never name what is not
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
     * Collective. The fields of the parameters, see point_fields().
     */
    void
    write_points(const double                  time,
                 const std::vector<Body<dim>> &bodies,
                 const MPI_Comm                comm);

    /**
     * Collective. The fields of the grid as Lagrange cells of the order of the
     * @p space, where there is mass.
     */
    void
    write_grid(const double            time,
               const SplineSpace<dim> &space,
               const GridFields<dim>  &fields);

    /**
     * Collective. The points of loads on surfaces: the number of the load and
     * that of its body, load (Pa per initial area), normal today times area,
     * area, velocity and displacement. Writes nothing where there are none.
     */
    void
    write_surfaces(const double                     time,
                   const std::vector<Surface<dim>> &surfaces,
                   const std::vector<unsigned int> &bodies,
                   const MPI_Comm                   comm);

    /**
     * How many times have been written.
     */
    unsigned int
    n_written() const
    {
      return times_and_names[0].size();
    }

  private:
    void
    write_record(const unsigned int kind,
                 const std::string &name,
                 const MPI_Comm     comm);

    const std::string       directory;
    const OutputParameters &parameters;
    // Of points, grid and surfaces.
    std::array<std::vector<std::pair<double, std::string>>, 3> times_and_names;
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
    Probes(const std::string            &text,
           const std::vector<Body<dim>> &bodies,
           const std::string            &file,
           const MPI_Comm                comm);

    /**
     * Collective.
     */
    void
    write(const double time, const std::vector<Body<dim>> &bodies);

  private:
    struct Probe
    {
      unsigned int body;
      double       id;
    };

    MPI_Comm           comm;
    std::vector<Probe> probes;
    CsvWriter          file;
  };
} // namespace greville

#endif
