// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/base/parameters.h>
#include <greville/run/point_series.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points that are stored together, at most.
    constexpr std::uint64_t largest_chunk = 1 << 16;

    // Bytes of what HDF5 adds to a time.
    constexpr std::uint64_t size_of_headers = 1 << 16;



    /**
     * A data set of a field, and its first component.
     */
    struct DataSet
    {
      std::string  name;
      unsigned int n_columns, component;
    };



    template <int dim>
    std::vector<DataSet>
    data_sets_of(const OutputField<dim> &field)
    {
      if (field.is_vector)
        return {{field.name, 3, 0}};
      std::vector<DataSet> result;
      for (unsigned int c = 0; c < field.components.size(); ++c)
        result.push_back({field.components[c], 1, c});
      return result;
    }



    /**
     * Rows of a data set as XDMF describes them.
     */
    std::string
    xdmf_data(const std::string  &data_set,
              const unsigned int  n_columns,
              const bool          is_double,
              const std::uint64_t first,
              const std::uint64_t n)
    {
      const bool        is_vector = n_columns > 1;
      const std::string width =
        is_vector ? " " + std::to_string(n_columns) : "";
      std::ostringstream text;
      text << "<DataItem ItemType=\"HyperSlab\" Dimensions=\"" << n << width
           << "\"><DataItem Dimensions=\"3 " << (is_vector ? 2 : 1)
           << "\" Format=\"XML\">" << first << (is_vector ? " 0" : "") << " 1"
           << (is_vector ? " 1" : "") << ' ' << n << width
           << "</DataItem><DataItem Dimensions=\"" << first + n << width
           << "\" NumberType=\"Float\" Precision=\"" << (is_double ? 8 : 4)
           << "\" Format=\"HDF\">" << PointSeries<2>::file_name << ':'
           << data_set << "</DataItem></DataItem>";
      return text.str();
    }
  } // namespace



  template <int dim>
  PointSeries<dim>::PointSeries(const std::string &directory)
    : directory(directory)
    , path(directory + "/" + file_name)
    , journal(path + ".changing")
  {}



  template <int dim>
  void
  PointSeries<dim>::begin_change(const MPI_Comm comm)
  {
    run_on_first([&]() { write_journal(journal, path, chunks.ranges); }, comm);
  }



  template <int dim>
  void
  PointSeries<dim>::end_change(const MPI_Comm comm)
  {
    MPI_Barrier(comm);
    run_on_first([&]() { std::filesystem::remove(journal); }, comm);
  }



  template <int dim>
  void
  PointSeries<dim>::write(const double                         time,
                          const BodyList<dim>                 &bodies,
                          const std::vector<OutputField<dim>> &fields,
                          const MPI_Comm                       comm)
  {
    std::uint64_t n = 0, bytes_of_point = 12;
    for (const Body<dim> &body : bodies)
      n += body.points.n_points();
    n = Utilities::MPI::sum(n, comm);
    for (const OutputField<dim> &field : fields)
      for (const DataSet &set : data_sets_of(field))
        bytes_of_point +=
          (VtkHdfFile::is_double(set.name) ? 8 : 4) * set.n_columns;

    const auto part = std::find(content.parts.begin(), content.parts.end(), n);
    const bool is_new_part = part == content.parts.end();
    // What can fail on one process only is found by the first one alone.
    const std::uint64_t n_bytes =
      n * (bytes_of_point + (is_new_part ? 17 : 0)) + size_of_headers;
    run_on_first(
      [&]() {
        if (content.times.empty())
          make_file(path, n_bytes);
        else
          reserve_room(path, n_bytes);
      },
      comm);
    const VtkHdfContent before        = content;
    const ChunkPlaces   chunks_before = chunks;
    content.times.push_back({time,
                             before.n_points(),
                             n,
                             std::uint64_t(part - content.parts.begin())});
    if (is_new_part)
      content.parts.push_back(n);
    const HDF5Silence silence;
    std::string       message;
    try
      {
        append(bodies, fields, is_new_part, comm);
      }
    catch (const std::exception &error)
      {
        message = "Cannot write <" + path + ">: " + system_reason(path) +
                  message_of(error) + ".";
        content = before;
        chunks  = chunks_before;
      }
    throw_on_all(message, comm);
    write_xdmf(comm);
  }



  template <int dim>
  void
  PointSeries<dim>::append(const BodyList<dim>                 &bodies,
                           const std::vector<OutputField<dim>> &fields,
                           const bool                           is_new_part,
                           const MPI_Comm                       comm)
  {
    const VtkHdfTime   &now    = content.times.back();
    const bool          is_new = content.times.size() == 1;
    const std::uint64_t rows_of_chunk =
      std::min(largest_chunk, std::max<std::uint64_t>(1, now.n_points));
    std::uint64_t own = 0;
    for (const Body<dim> &body : bodies)
      own += body.points.n_points();
    const std::uint64_t first_own = sum_before(own, comm);

    if (is_new)
      chunks = {};
    else
      begin_change(comm);
    VtkHdfFile file(path, is_new, comm);
    if (is_new)
      file.make_structure(rows_of_chunk);
    std::map<std::string, unsigned int> missing = content.fields, added;
    for (const OutputField<dim> &field : fields)
      for (const DataSet &set : data_sets_of(field))
        if (missing.erase(set.name) == 0)
          {
            file.make_field(set.name, set.n_columns, rows_of_chunk);
            content.fields[set.name] = added[set.name] = set.n_columns;
          }
    file.set_rows(content);
    for (const auto &[name, n_columns] : added)
      file.write_nothing(name, n_columns, 0, now.first_point);
    for (const auto &[name, n_columns] : missing)
      file.write_nothing(name, n_columns, now.first_point, now.n_points);
    const auto for_each = [&](const auto &action) {
      std::uint64_t k = 0;
      for (unsigned int b = 0; b < bodies.size(); ++b)
        bodies[b].points.for_each(
          [&](const unsigned int, ConstPointRef<dim> p) { action(k++, p, b); });
    };
    const std::uint64_t first = now.first_point + first_own;
    std::vector<float>  floats(3 * own, 0.f);
    for_each(
      [&](const std::uint64_t k, ConstPointRef<dim> p, const unsigned int) {
        for (unsigned int d = 0; d < dim; ++d)
          floats[3 * k + d] = p.position()[d];
      });
    file.write(VtkHdfFile::root + "Points", first, floats, 3);
    std::vector<double> values, doubles;
    for (const OutputField<dim> &field : fields)
      {
        const unsigned int n = field.components.size();
        values.resize(n * own);
        for_each([&](const std::uint64_t k,
                     ConstPointRef<dim>  p,
                     const unsigned int  b) {
          field.evaluate(p, bodies[b], b, values.data() + k * n);
        });
        for (const DataSet &set : data_sets_of(field))
          {
            const bool is_vector = set.n_columns > 1;
            const auto write     = [&](auto &numbers) {
              numbers.assign(set.n_columns * own, 0.);
              for (std::uint64_t k = 0; k < own; ++k)
                for (unsigned int c = 0; c < (is_vector ? n : 1); ++c)
                  numbers[k * set.n_columns + c] =
                    values[k * n + set.component + c];
              file.write(VtkHdfFile::point_data + set.name,
                         first,
                         numbers,
                         is_vector ? set.n_columns : 0);
            };
            if (VtkHdfFile::is_double(set.name))
              write(doubles);
            else
              write(floats);
          }
      }
    if (is_new_part)
      file.write_cells(content, first_own, own);
    file.write_time(content, is_new_part);
    file.set_n_times(content.times.size());
    file.find_chunks(content, chunks);
    file.finish();
    end_change(comm);
  }



  template <int dim>
  void
  PointSeries<dim>::go_on(const unsigned int n_times, const MPI_Comm comm)
  {
    content         = {};
    chunks          = {};
    n_times_of_xdmf = 0;
    run_on_first(
      [&]() {
        AssertThrow(std::filesystem::exists(path),
                    ExcMessage("There is no file <" + path + ">."));
        if (!std::filesystem::exists(journal))
          return;
        try
          {
            take_back(journal, path);
          }
        catch (const std::exception &error)
          {
            AssertThrow(false,
                        ExcMessage("The run was killed while it changed <" +
                                   path + ">. " + message_of(error)));
          }
        std::filesystem::remove(journal);
      },
      comm);
    const HDF5Silence silence;
    std::string       message;
    try
      {
        VtkHdfFile file(path, false, comm);
        content = file.read(n_times);
        file.find_chunks(content, chunks);
        begin_change(comm);
        file.set_rows(content);
        file.set_n_times(n_times);
        const std::vector<ByteRange> before = chunks.ranges;
        chunks                              = {};
        file.find_chunks(content, chunks);
        file.finish();
        end_change(comm);
        // Nothing takes the place of chunks that are no longer used, but behind
        // the end of the file.
        std::uint64_t length = 0;
        run_on_first([&]() { length = std::filesystem::file_size(path); },
                     comm);
        length = Utilities::MPI::broadcast(comm, length);
        for (const ByteRange &range : before)
          if (range.begin < length)
            chunks.ranges.push_back({range.begin, std::min(range.end, length)});
      }
    catch (const std::exception &error)
      {
        content = {};
        message =
          "Cannot go on with <" + path + ">: " + message_of(error) + ".";
      }
    throw_on_all(message, comm);
    write_xdmf(comm);
  }



  template <int dim>
  void
  PointSeries<dim>::write_xdmf(const MPI_Comm comm)
  {
    run_on_first(
      [&]() {
        if (n_fields_of_xdmf != content.fields.size() || n_times_of_xdmf == 0)
          {
            n_times_of_xdmf = 0;
            xdmf.clear();
          }
        n_fields_of_xdmf = content.fields.size();
        for (; n_times_of_xdmf < content.times.size(); ++n_times_of_xdmf)
          {
            const VtkHdfTime  &now = content.times[n_times_of_xdmf];
            std::ostringstream text;
            text.precision(17);
            text << "<Grid Name=\"points\"><Time Value=\"" << now.time
                 << "\"/><Topology TopologyType=\"Polyvertex\" "
                    "NumberOfElements=\""
                 << now.n_points
                 << "\" NodesPerElement=\"1\"/><Geometry "
                    "GeometryType=\"XYZ\">"
                 << xdmf_data(VtkHdfFile::root + "Points",
                              3,
                              false,
                              now.first_point,
                              now.n_points)
                 << "</Geometry>\n";
            for (const auto &[name, n_columns] : content.fields)
              text << "<Attribute Name=\"" << name << "\" AttributeType=\""
                   << (n_columns == 1 ? "Scalar" : "Vector")
                   << "\" Center=\"Node\">"
                   << xdmf_data(VtkHdfFile::point_data + name,
                                n_columns,
                                VtkHdfFile::is_double(name),
                                now.first_point,
                                now.n_points)
                   << "</Attribute>\n";
            xdmf += text.str() + "</Grid>\n";
          }
        write_atomically(directory + "/points.xdmf",
                         "<?xml version=\"1.0\"?>\n"
                         "<Xdmf Version=\"2.0\"><Domain><Grid Name=\"points\" "
                         "GridType=\"Collection\" "
                         "CollectionType=\"Temporal\">\n" +
                           xdmf + "</Grid></Domain></Xdmf>\n");
      },
      comm);
  }



  template class PointSeries<2>;
  template class PointSeries<3>;
} // namespace greville
