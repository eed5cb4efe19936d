// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/utilities.h>

#include <greville/base/disk.h>
#include <greville/points/point_fields.h>
#include <greville/run/output.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    DataOutBase::VtkFlags
    fast_compression()
    {
      // The enumeration has other names in other versions of deal.II.
      DataOutBase::VtkFlags flags;
      flags.compression_level = decltype(flags.compression_level)::best_speed;
      return flags;
    }



    /// Patches with their data for DataOutBase.
    template <int patch_dim, int dim>
    class PatchesOut
    {
    public:
      /// Return the patches of this process as a piece of a file, even without
      /// patches.
      std::string
      piece() const
      {
        std::ostringstream out;
        DataOutBase::write_vtu_main(patches, names, ranges, flags, out);
        return out.str();
      }

      /// Append as many pieces as needed. Without patches append none, because
      /// ParaView might take the fields of the whole file from it.
      void
      append_pieces(std::vector<std::string> &pieces) const
      {
        if (!patches.empty())
          pieces.push_back(piece());
      }

      DataOutBase::VtkFlags flags = fast_compression();

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



    /// Points as patches without extension. They are written block by block to
    /// save memory.
    template <int dim>
    class PointsOut : public PatchesOut<0, dim>
    {
    public:
      PointsOut(const BodyList<dim>                 &bodies,
                const std::vector<OutputField<dim>> &given,
                const std::vector<double>           *stress_jumps,
                const unsigned int                   first,
                const unsigned int                   end)
        : bodies(bodies)
        , fields(given)
        , stress_jumps(stress_jumps)
        , first(first)
        , end(end)
      {
        for (const OutputField<dim> &field : fields)
          if (field.is_vector)
            this->add_vector(field.name);
          else
            this->names.insert(this->names.end(),
                               field.components.begin(),
                               field.components.end());
        if (stress_jumps)
          this->names.push_back("stress_jump");
      }

      void
      append_pieces(std::vector<std::string> &pieces)
      {
        constexpr unsigned int size        = 1 << 12;
        const auto             write_block = [&]() {
          PatchesOut<0, dim>::append_pieces(pieces);
          this->patches.clear();
        };
        std::vector<double> values(this->names.size());
        std::size_t         k = 0;
        for (unsigned int b = first; b < end; ++b)
          bodies[b].points.for_each(
            [&](const unsigned int, ConstPointRef<dim> p) {
              double *value = values.data();
              for (const OutputField<dim> &field : fields)
                {
                  field.evaluate(p, bodies[b], b, value);
                  value += field.components.size();
                }
              if (stress_jumps)
                *value = (*stress_jumps)[k++];
              this->add_point(p.position(), values);
              if (this->patches.size() == size)
                write_block();
            });
        write_block();
      }

    private:
      const BodyList<dim>                &bodies;
      const std::vector<OutputField<dim>> fields;
      const std::vector<double>          *stress_jumps;
      const unsigned int                  first, end; // bodies
    };



    /// Points on surfaces, as patches without extension.
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
            // Points of loads have the values of points without contact.
            const double h = surfaces[k].points.space().smallest_cell_size();
            surfaces[k].points.for_each([&](ConstPointRef<dim> p) {
              const SurfaceState<dim> state = surface_state<dim>(p, layout);
              const Tensor<1, dim>    area  = p.mass() * state.area_vector();
              const Tensor<1, dim>    load  = p.vector(layout.first("load"));
              // The load per current area.
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
            this->patches.push_back(std::move(patch));
          }
      }
    };



    /// Fields of the grid: a patch of order p for each cell in the support of a
    /// function with mass.
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
        // Values per direction, N[node * n + a].
        std::array<std::vector<double>, dim> N;
        std::vector<double>                  values(n_nodes), next(n_nodes);
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
            for (unsigned int k = 0; k < fields.size(); ++k)
              {
                for (unsigned int a = 0; a < n_nodes; ++a)
                  values[a] = fields[k].local_element(functions[a]);
                for (unsigned int d = 0, stride = 1; d < dim; ++d, stride *= n)
                  {
                    for (unsigned int i = 0; i < n_nodes; ++i)
                      {
                        const unsigned int node = i / stride % n;
                        next[i]                 = 0.;
                        for (unsigned int a = 0; a < n; ++a)
                          next[i] += N[d][node * n + a] *
                                     values[i + a * stride - node * stride];
                      }
                    values.swap(next);
                  }
                for (unsigned int node = 0; node < n_nodes; ++node)
                  patch.data(k, node) = values[node];
              }
            this->patches.push_back(std::move(patch));
          }
      }
    };



    /// Return the text of fields.pvd: data sets by time, with a block for each
    /// name.
    std::string
    text_of_pvd(
      const std::map<std::string, std::vector<std::pair<double, std::string>>>
        &times_and_names)
    {
      std::set<std::tuple<double, unsigned int, std::string, std::string>> sets;
      unsigned int part = 0;
      for (const auto &[name, written] : times_and_names)
        {
          for (const auto &[time, file] : written)
            sets.emplace(time, part, name, file);
          ++part;
        }
      std::ostringstream text;
      text.precision(12);
      text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" "
              "version=\"0.1\">\n<Collection>\n";
      for (const auto &[time, number, name, file] : sets)
        text << "<DataSet timestep=\"" << time << "\" part=\"" << number
             << "\" name=\"" << name << "\" file=\"" << file << "\"/>\n";
      text << "</Collection>\n</VTKFile>\n";
      return text.str();
    }
  } // namespace



  template <int dim>
  FieldOutput<dim>::FieldOutput(const std::string      &directory,
                                const OutputParameters &parameters)
    : directory(directory)
    , parameters(parameters)
  {}



  template <int dim>
  template <typename DataOutType>
  void
  FieldOutput<dim>::write_next(const std::string &name,
                               const double       time,
                               DataOutType       &data,
                               const MPI_Comm     comm)
  {
    const auto is_same = [&](const File &file) { return file.name == name; };
    auto       file    = std::find_if(held.begin(), held.end(), is_same);
    if (file == held.end())
      {
        file       = held.emplace(held.end());
        file->name = name;
        file->time = time;
        std::ostringstream header;
        DataOutBase::write_vtu_header(header, data.flags);
        file->header = header.str();
      }
    // write_vtu_in_parallel() of deal.II needs all patches in memory, and
    // leaves processes waiting if another one cannot write.
    run_on_all(comm, [&]() { data.append_pieces(file->pieces); });
    if (file->pieces.empty())
      file->empty_piece = data.piece();
    if (!holds)
      write_held(comm);
  }



  template <int dim>
  void
  FieldOutput<dim>::write_held(const MPI_Comm comm)
  {
    // If one file cannot be written, the other files are lost, too.
    auto files = std::move(held);
    drop_held();
    for (File &file : files)
      {
        write_file(file, comm);
        file = File();
      }
  }



  template <int dim>
  void
  FieldOutput<dim>::write_file(File &file, const MPI_Comm comm)
  {
    const unsigned int process   = Utilities::MPI::this_mpi_process(comm),
                       processes = Utilities::MPI::n_mpi_processes(comm);
    auto             &written    = times_and_names[file.name];
    const std::string path = std::string(file_folder) + "/" + file.name + "_" +
                             Utilities::int_to_string(written.size(), 4) +
                             ".vtu";
    // A file needs at least one piece.
    if (!Utilities::MPI::logical_or(!file.pieces.empty(), comm) && process == 0)
      file.pieces.push_back(file.empty_piece);
    if (process == 0)
      file.pieces.insert(file.pieces.begin(), file.header);
    std::ostringstream footer;
    DataOutBase::write_vtu_footer(footer);
    if (process + 1 == processes)
      file.pieces.push_back(footer.str());
    run_on_first(comm, [&]() {
      create_folder(directory + "/" + file_folder, "Output/Directory");
    });
    write_together(directory + "/" + path, file.pieces, comm);
    written.emplace_back(file.time, path);
    run_on_first(comm, [&]() {
      write_atomically(directory + "/" + series_name,
                       text_of_pvd(times_and_names));
    });
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
  void
  FieldOutput<dim>::resume(const std::string &record, const MPI_Comm comm)
  {
    times_and_names.clear();
    std::istringstream lines(record);
    for (std::string name, time, file; std::getline(lines, name, '\t') &&
                                       std::getline(lines, time, '\t') &&
                                       std::getline(lines, file);)
      times_and_names[name].emplace_back(Utilities::string_to_double(time),
                                         file);
    run_on_first(comm, [&]() {
      const std::string folder = directory + "/" + file_folder;
      const std::regex  numbered(R"((.*)_([0-9]{4,10})\.vtu)");
      if (!std::filesystem::exists(folder))
        return;
      write_atomically(directory + "/" + series_name,
                       text_of_pvd(times_and_names));
      for (const auto &entry : std::filesystem::directory_iterator(folder))
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
    });
  }



  template <int dim>
  void
  FieldOutput<dim>::write_points(const double               time,
                                 const BodyList<dim>       &bodies,
                                 const MPI_Comm             comm,
                                 const unsigned int         first,
                                 const unsigned int         n,
                                 const std::vector<double> *stress_jumps)
  {
    const auto         given = point_fields(parameters.fields,
                                    bodies,
                                    Utilities::MPI::this_mpi_process(comm));
    const unsigned int end =
      first + std::min<unsigned int>(n, bodies.size() - first);
    PointsOut<dim> points(bodies, given, stress_jumps, first, end);
    write_next("points", time, points, comm);
  }



  template <int dim>
  void
  FieldOutput<dim>::write_grid(const double            time,
                               const SplineSpace<dim> &space,
                               const GridFields<dim>  &fields,
                               const std::string      &body)
  {
    GridOut<dim> grid(space, fields);
    grid.flags.write_higher_order_cells = true;
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
    run_on_first(comm, [&]() { mesh = body.mesh(position, region); });
    RigidBodyOut<dim> facets(mesh, position);
    write_next("rigid_" + body.name(), time, facets, comm);
  }



  GREVILLE_INSTANTIATE_CLASS(FieldOutput);
} // namespace greville
