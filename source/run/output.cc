// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/points/point_fields.h>
#include <greville/run/output.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * Patches with their data, as DataOutBase writes them.
     */
    template <int patch_dim, int dim>
    class PatchesOut : public DataOutInterface<patch_dim, dim>
    {
    protected:
      using Interpretation =
        DataComponentInterpretation::DataComponentInterpretation;
      using Ranges = std::vector<
        std::tuple<unsigned int, unsigned int, std::string, Interpretation>>;

      void
      add_vector(const std::string &name)
      {
        ranges.emplace_back(names.size(),
                            names.size() + dim - 1,
                            name,
                            Interpretation::component_is_part_of_vector);
        names.insert(names.end(), dim, name);
      }

      const std::vector<DataOutBase::Patch<patch_dim, dim>> &
      get_patches() const override
      {
        return patches;
      }

      std::vector<std::string>
      get_dataset_names() const override
      {
        return names;
      }

      Ranges
      get_nonscalar_data_ranges() const override
      {
        return ranges;
      }

      /**
       * A patch of one point.
       */
      void
      add_point(const Point<dim> &x, const std::vector<double> &values)
      {
        patches.emplace_back();
        auto &patch       = patches.back();
        patch.vertices[0] = x;
        patch.patch_index = patches.size() - 1;
        patch.data.reinit(values.size(), 1);
        for (unsigned int k = 0; k < values.size(); ++k)
          patch.data(k, 0) = values[k];
      }

      std::vector<DataOutBase::Patch<patch_dim, dim>> patches;
      std::vector<std::string>                        names;
      Ranges                                          ranges;
    };



    DataOutBase::VtkFlags
    fast_compression()
    {
      // The enumeration has other names in other versions of deal.II.
      DataOutBase::VtkFlags flags;
      flags.compression_level = decltype(flags.compression_level)::best_speed;
      return flags;
    }



    /**
     * Points: patches without extension, which are written block by block, so
     * that memory for all of them is not needed.
     */
    template <int dim>
    class PointsOut : public PatchesOut<0, dim>
    {
    public:
      PointsOut(const BodyList<dim>                 &bodies,
                const std::vector<OutputField<dim>> &given)
        : bodies(bodies)
        , fields(given)
      {
        for (const OutputField<dim> &field : fields)
          if (field.is_vector)
            this->add_vector(field.name);
          else
            this->names.insert(this->names.end(),
                               field.components.begin(),
                               field.components.end());
      }

      /**
       * A piece of the file for each block, and at least one.
       */
      void
      write_vtu(std::ostream &out)
      {
        constexpr unsigned int size        = 1 << 12;
        const auto             write_block = [&]() {
          DataOutBase::write_vtu_main(
            this->patches, this->names, this->ranges, fast_compression(), out);
          this->patches.clear();
        };
        DataOutBase::write_vtu_header(out, fast_compression());
        std::vector<double> values(this->names.size());
        bool                is_empty = true;
        for (unsigned int b = 0; b < bodies.size(); ++b)
          bodies[b].points.for_each(
            [&](const unsigned int, ConstPointRef<dim> p) {
              double *value = values.data();
              for (const OutputField<dim> &field : fields)
                {
                  field.evaluate(p, bodies[b], b, value);
                  value += field.components.size();
                }
              this->add_point(p.position(), values);
              is_empty = false;
              if (this->patches.size() == size)
                write_block();
            });
        if (is_empty || !this->patches.empty())
          write_block();
        DataOutBase::write_vtu_footer(out);
      }

    private:
      const BodyList<dim>                &bodies;
      const std::vector<OutputField<dim>> fields;
    };



    /**
     * Points on surfaces, likewise.
     */
    template <int dim>
    class SurfacesOut : public PatchesOut<0, dim>
    {
    public:
      SurfacesOut(const std::vector<Surface<dim>>   &surfaces,
                  const std::vector<SurfaceNumbers> &numbers)
      {
        const bool has_contact =
          std::any_of(surfaces.begin(), surfaces.end(), [](const auto &s) {
            return !s.contact.empty();
          });
        for (const std::string name :
             {"velocity", "displacement", "load", "area_vector"})
          this->add_vector(name);
        if (has_contact)
          this->add_vector("shear");
        for (const std::string name : {"area", "surface_load", "body"})
          this->names.push_back(name);
        if (has_contact)
          for (const std::string name : {"gap", "pressure", "state"})
            this->names.push_back(name);
        for (unsigned int k = 0; k < surfaces.size(); ++k)
          {
            const PointLayout<dim> &layout = surfaces[k].points.layout();
            const PointField       *gap    = layout.find("gap");
            // Points of loads are as those that face nothing.
            const double h = surfaces[k].points.space().smallest_cell_size();
            surfaces[k].points.for_each(
              [&](const unsigned int, ConstPointRef<dim> p) {
                const SurfaceState<dim> state = surface_state<dim>(p, layout);
                const Tensor<1, dim>    area  = p.mass() * state.area_vector();
                const Tensor<1, dim>    load  = p.vector(layout.first("load"));
                // Per area today.
                const Tensor<1, dim> normal = area / area.norm();
                const Tensor<1, dim> traction =
                  gap ? p.mass() / area.norm() * load : Tensor<1, dim>();
                const double        pressure = -(traction * normal);
                std::vector<double> values;
                const auto          add = [&](const Tensor<1, dim> &vector) {
                  values.insert(values.end(),
                                vector.begin_raw(),
                                vector.end_raw());
                };
                add(state.velocity);
                add(state.x - state.X);
                add(load);
                add(area);
                if (has_contact)
                  add(traction + pressure * normal);
                for (const double value : {area.norm(),
                                           double(numbers[k].load),
                                           double(numbers[k].body)})
                  values.push_back(value);
                if (has_contact)
                  for (const double value :
                       {gap ? p[gap->first] : farthest_gap_in_cells * h,
                        pressure,
                        gap ? p[gap->first + 1] : 0.})
                    values.push_back(value);
                this->add_point(state.x, values);
              });
          }
      }
    };



    /**
     * The surface of a rigid body: a patch for each of its facets.
     */
    template <int dim>
    class RigidBodyOut : public PatchesOut<dim - 1, dim>
    {
    public:
      RigidBodyOut(const ClosedSurface<dim> &mesh,
                   const RigidPosition<dim> &position)
      {
        this->add_vector("velocity");
        this->add_vector("displacement");
        for (const Facet<dim> &facet : mesh)
          {
            DataOutBase::Patch<dim - 1, dim> patch;
            patch.reference_cell = ReferenceCells::get_simplex<dim - 1>();
            patch.patch_index    = this->patches.size();
            patch.data.reinit(2 * dim, dim);
            for (unsigned int v = 0; v < dim; ++v)
              {
                const Point<dim>     x = current_position(position, facet[v]);
                const Tensor<1, dim> velocity = velocity_at(position, x);
                patch.vertices[v]             = x;
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    patch.data(d, v)       = velocity[d];
                    patch.data(dim + d, v) = x[d] - facet[v][d];
                  }
              }
            this->patches.push_back(patch);
          }
      }
    };



    /**
     * Fields of the grid: a patch of order p for each cell that a function with
     * mass reaches, and nothing for all others.
     */
    template <int dim>
    class GridOut : public PatchesOut<dim, dim>
    {
    public:
      GridOut(const SplineSpace<dim> &space, const GridFields<dim> &given)
      {
        std::vector<VectorType> fields;
        const auto add = [&](const char *name, const VectorField<dim> &field) {
          if (field[0].size() == 0)
            return;
          this->add_vector(name);
          fields.insert(fields.end(), field.begin(), field.end());
        };
        add("velocity", given.velocity);
        this->names.push_back("mass");
        fields.push_back(given.mass);
        add("acceleration", given.acceleration);
        add("force", given.force);
        const bool has_classes = !given.cell_classes.empty();
        if (has_classes)
          this->names.push_back("cell_class");
        for (const VectorType &field : fields)
          field.update_ghost_values();

        const unsigned int n       = space.degree() + 1;
        const unsigned int n_nodes = Utilities::fixed_power<dim>(n);
        MultiIndex<dim>    extents;
        extents.fill(n);
        // Per direction, N[node * n + a].
        std::array<std::vector<double>, dim> N;
        for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
          {
            const auto functions = space.cell_functions(cell);
            bool       has_mass  = false;
            for (const unsigned int i : functions)
              has_mass |= fields[dim].local_element(i) > 0.;
            if (!has_mass)
              continue;
            const CellBox<dim> box = space.box(cell);
            for (unsigned int d = 0; d < dim; ++d)
              {
                N[d].resize(n * n);
                for (unsigned int node = 0; node < n; ++node)
                  space.knots(d).evaluate(
                    box.index[d],
                    box.lower[d] + box.size[d] * node / (n - 1),
                    0,
                    ArrayView<double>(N[d].data() + node * n, n));
              }

            DataOutBase::Patch<dim> patch;
            patch.n_subdivisions = n - 1;
            patch.patch_index    = this->patches.size();
            patch.reference_cell = ReferenceCells::get_hypercube<dim>();
            for (unsigned int v = 0; v < (1u << dim); ++v)
              for (unsigned int d = 0; d < dim; ++d)
                patch.vertices[v][d] =
                  box.lower[d] + ((v >> d) & 1) * box.size[d];
            patch.data.reinit(fields.size() + has_classes, n_nodes);
            for (unsigned int node = 0; has_classes && node < n_nodes; ++node)
              patch.data(fields.size(), node) = given.cell_classes[cell];
            for (unsigned int node = 0; node < n_nodes; ++node)
              for (unsigned int a = 0; a < n_nodes; ++a)
                {
                  const auto at = multi_index<dim>(node, extents),
                             of = multi_index<dim>(a, extents);
                  double value  = 1.;
                  for (unsigned int d = 0; d < dim; ++d)
                    value *= N[d][at[d] * n + of[d]];
                  for (unsigned int k = 0; k < fields.size(); ++k)
                    patch.data(k, node) +=
                      value * fields[k].local_element(functions[a]);
                }
            this->patches.push_back(patch);
          }
      }
    };



    /**
     * Collective. Each process writes its file, the first one the record of
     * all.
     */
    template <typename DataOutType>
    void
    write_parallel(DataOutType       &data,
                   const std::string &directory,
                   const std::string &numbered,
                   const MPI_Comm     comm)
    {
      const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
      const unsigned int process     = Utilities::MPI::this_mpi_process(comm);
      const auto         piece       = [&](const unsigned int k) {
        return numbered + "." +
               Utilities::int_to_string(k,
                                        Utilities::needed_digits(n_processes)) +
               ".vtu";
      };
      const auto write = [&](const std::string &file, const auto &content) {
        const std::string path = directory + "/" + file;
        errno                  = 0;
        std::ofstream out(path);
        try
          {
            if (out)
              content(out);
            out.close();
          }
        catch (const std::exception &)
          {
            out.setstate(std::ios::failbit);
          }
        AssertThrow(out, ExcMessage(write_error(path)));
      };
      run_on_all(
        [&]() {
          write(piece(process),
                [&](std::ostream &out) { data.write_vtu(out); });
          if (process > 0)
            return;
          std::vector<std::string> pieces;
          for (unsigned int k = 0; k < n_processes; ++k)
            pieces.push_back(piece(k));
          write(numbered + ".pvtu", [&](std::ostream &out) {
            data.write_pvtu_record(out, pieces);
          });
        },
        comm);
    }
  } // namespace



  template <int dim>
  FieldOutput<dim>::FieldOutput(const std::string      &directory,
                                const OutputParameters &parameters)
    : directory(directory)
    , parameters(parameters)
    , series(directory)
  {}



  template <int dim>
  template <typename DataOutType>
  void
  FieldOutput<dim>::write_next(const std::string &name,
                               const double       time,
                               DataOutType       &data,
                               const MPI_Comm     comm,
                               const bool         is_of_first)
  {
    auto             &written = times_and_names[name];
    const std::string numbered =
      name + "_" + Utilities::int_to_string(written.size(), 4);
    if (is_of_first)
      run_on_first(
        [&]() { write_parallel(data, directory, numbered, MPI_COMM_SELF); },
        comm);
    else
      write_parallel(data, directory, numbered, comm);
    written.emplace_back(time, numbered + ".pvtu");
    std::ostringstream text;
    DataOutBase::write_pvd_record(text, written);
    run_on_first(
      [&]() { write_atomically(directory + "/" + name + ".pvd", text.str()); },
      comm);
  }



  template <int dim>
  std::string
  FieldOutput<dim>::record() const
  {
    std::ostringstream text;
    text.precision(17);
    for (const auto &[name, written] : times_and_names)
      for (const auto &[time, file] : written)
        text << name << '\t' << time << '\t' << file << '\n';
    return text.str();
  }



  template <int dim>
  std::string
  FieldOutput<dim>::points_file(const double time) const
  {
    const auto points = times_and_names.find("points");
    if (points != times_and_names.end())
      for (const auto &[t, file] : points->second)
        if (t == time)
          return directory + "/" + file;
    return "";
  }



  template <int dim>
  std::string
  FieldOutput<dim>::go_on_with_series(const MPI_Comm comm)
  {
    const auto points = times_and_names.find("points");
    if (points == times_and_names.end())
      return "";
    const bool was_series =
      points->second.back().second == PointSeries<dim>::file_name;
    AssertThrow(was_series == parameters.points_in_one_file(),
                ExcMessage("the parameter 'Output/Points format' is " +
                           parameters.points_format + ", and was " +
                           (was_series ? "vtkhdf" : "vtu") +
                           " when the run began: it has to stay as it was"));
    if (!was_series)
      return "";
    try
      {
        series.go_on(points->second.size(), comm);
        return "";
      }
    catch (const ErrorOnAll &error)
      {
        const std::string file = directory + "/" + PointSeries<dim>::file_name;
        times_and_names.erase(points);
        std::string what_of_file = " Its times are lost";
        run_on_first(
          [&]() {
            std::error_code none;
            std::filesystem::remove(file + ".changing", none);
            std::filesystem::rename(file, file + ".refused", none);
            if (!none)
              what_of_file = " It is renamed to <" + file + ".refused>";
          },
          comm);
        return message_of(error) + what_of_file +
               "; a new one begins with the next time.";
      }
  }



  template <int dim>
  std::string
  FieldOutput<dim>::go_on(const std::string &record, const MPI_Comm comm)
  {
    times_and_names.clear();
    std::istringstream lines(record);
    for (std::string name, time, file; std::getline(lines, name, '\t') &&
                                       std::getline(lines, time, '\t') &&
                                       std::getline(lines, file);)
      times_and_names[name].emplace_back(Utilities::string_to_double(time),
                                         file);
    run_on_first(
      [&]() {
        const std::regex numbered(R"((.*)_([0-9]{4,10})(\.[0-9]+)?\.p?vtu)");
        for (const auto &entry : std::filesystem::directory_iterator(directory))
          {
            const std::string file = entry.path().filename().string();
            std::smatch       parts;
            if (!std::regex_match(file, parts, numbered))
              continue;
            const auto written = times_and_names.find(parts[1]);
            if (written != times_and_names.end() &&
                std::stoul(parts[2]) >= written->second.size())
              std::filesystem::remove(entry.path());
          }
      },
      comm);
    return go_on_with_series(comm);
  }



  template <int dim>
  void
  FieldOutput<dim>::write_points(const double         time,
                                 const BodyList<dim> &bodies,
                                 const MPI_Comm       comm)
  {
    const auto given = point_fields(parameters.fields,
                                    bodies,
                                    Utilities::MPI::this_mpi_process(comm));
    if (parameters.points_in_one_file())
      {
        series.write(time, bodies, given, comm);
        times_and_names["points"].emplace_back(time,
                                               PointSeries<dim>::file_name);
        return;
      }
    PointsOut<dim> points(bodies, given);
    write_next("points", time, points, comm);
  }



  template <int dim>
  void
  FieldOutput<dim>::write_grid(const double            time,
                               const SplineSpace<dim> &space,
                               const GridFields<dim>  &fields,
                               const std::string      &body)
  {
    DataOutBase::VtkFlags flags = fast_compression();
    GridOut<dim>          grid(space, fields);
    flags.write_higher_order_cells = true;
    grid.set_flags(flags);
    write_next("grid" + (body.empty() ? "" : "_" + body),
               time,
               grid,
               space.communicator());
  }



  template <int dim>
  void
  FieldOutput<dim>::write_surfaces(const double                       time,
                                   const std::vector<Surface<dim>>   &surfaces,
                                   const std::vector<SurfaceNumbers> &numbers,
                                   const MPI_Comm                     comm,
                                   const std::string                 &body)
  {
    if (surfaces.empty())
      return;
    SurfacesOut<dim> points(surfaces, numbers);
    points.set_flags(fast_compression());
    write_next("surface" + (body.empty() ? "" : "_" + body),
               time,
               points,
               comm);
  }



  template <int dim>
  void
  FieldOutput<dim>::write_rigid_body(const double              time,
                                     const RigidBody<dim>     &body,
                                     const RigidPosition<dim> &position,
                                     const BoundingBox<dim>   &region,
                                     const MPI_Comm            comm)
  {
    ClosedSurface<dim> mesh;
    run_on_first([&]() { mesh = body.mesh(position, region); }, comm);
    RigidBodyOut<dim> facets(mesh, position);
    facets.set_flags(fast_compression());
    write_next("rigid_" + body.name(), time, facets, comm, true);
  }



  template class FieldOutput<2>;
  template class FieldOutput<3>;
} // namespace greville
