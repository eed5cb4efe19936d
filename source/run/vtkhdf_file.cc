// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/run/vtkhdf_file.h>

#include <algorithm>
#include <limits>

namespace greville
{
  using namespace dealii;

  const std::string VtkHdfFile::root       = "/VTKHDF/",
                    VtkHdfFile::point_data = "/VTKHDF/PointData/",
                    VtkHdfFile::steps      = "/VTKHDF/Steps/";

  namespace
  {
    // Rows of times that are stored together.
    constexpr std::uint64_t chunk_of_times = 64;

    const std::vector<std::string> names_of_parts = {"NumberOfPoints",
                                                     "NumberOfCells",
                                                     "NumberOfConnectivityIds"};
    const std::vector<std::string> names_of_steps = {"Values",
                                                     "PartOffsets",
                                                     "NumberOfParts",
                                                     "PointOffsets"};
    // With a column for each kind of cell, of which there is one.
    const std::vector<std::string> names_of_cells = {"CellOffsets",
                                                     "ConnectivityIdOffsets"};



    void
    write_numbers(const hid_t                      object,
                  const std::string               &name,
                  const std::vector<std::int64_t> &values)
    {
      const hsize_t    n = values.size();
      const HDF5Handle space(n == 1 ? H5Screate(H5S_SCALAR)
                                    : H5Screate_simple(1, &n, nullptr),
                             H5Sclose);
      HDF5Handle attribute(
        H5Acreate2(
          object, name.c_str(), H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
      check_hdf5(H5Awrite(attribute, H5T_NATIVE_INT64, values.data()));
      attribute.finish();
    }



    /**
     * Data sets of one column have no columns.
     */
    unsigned int
    columns_of_data_set(const unsigned int n_columns)
    {
      return n_columns == 1 ? 0 : n_columns;
    }
  } // namespace



  std::uint64_t
  VtkHdfContent::n_cells_before(const std::uint64_t part) const
  {
    std::uint64_t sum = 0;
    for (std::uint64_t k = 0; k < part; ++k)
      sum += parts[k];
    return sum;
  }



  VtkHdfFile::VtkHdfFile(const std::string &path,
                         const bool         is_new,
                         const MPI_Comm     comm)
    : comm(comm)
    , access(hdf5_access(comm))
    , file(is_new ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                  : H5Fopen(path.c_str(), H5F_ACC_RDWR, access),
           H5Fclose)
  {}



  bool
  VtkHdfFile::is_double(const std::string &field)
  {
    return field == "id";
  }



  void
  VtkHdfFile::make(const std::string  &name,
                   const hid_t         type,
                   const unsigned int  n_columns,
                   const std::uint64_t rows_of_chunk)
  {
    const int        rank    = n_columns == 0 ? 1 : 2;
    const hsize_t    size[]  = {0, n_columns};
    const hsize_t    most[]  = {H5S_UNLIMITED, n_columns};
    const hsize_t    chunk[] = {rows_of_chunk, n_columns};
    const HDF5Handle space(H5Screate_simple(rank, size, most), H5Sclose);
    const HDF5Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check_hdf5(H5Pset_chunk(list, rank, chunk));
    check_hdf5(H5Pset_fill_time(list, H5D_FILL_TIME_NEVER));
    const HDF5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    check_hdf5(H5Pset_create_intermediate_group(links, 1));
    HDF5Handle data_set(
      H5Dcreate2(file, name.c_str(), type, space, links, list, H5P_DEFAULT),
      H5Dclose);
    data_set.finish();
  }



  void
  VtkHdfFile::make_structure(const std::uint64_t rows_of_chunk)
  {
    make(root + "Points", H5T_IEEE_F32LE, 3, rows_of_chunk);
    make(root + "Connectivity", H5T_STD_I64LE, 0, rows_of_chunk);
    make(root + "Offsets", H5T_STD_I64LE, 0, rows_of_chunk);
    make(root + "Types", H5T_STD_U8LE, 0, rows_of_chunk);
    for (const std::string &name : names_of_parts)
      make(root + name, H5T_STD_I64LE, 0, chunk_of_times);
    for (const std::string &name : names_of_steps)
      make(steps + name,
           name == "Values" ? H5T_IEEE_F64LE : H5T_STD_I64LE,
           0,
           chunk_of_times);
    for (const std::string &name : names_of_cells)
      make(steps + name, H5T_STD_I64LE, 1, chunk_of_times);
    const HDF5Handle outer(H5Gopen2(file, root.c_str(), H5P_DEFAULT), H5Gclose);
    write_hdf5_text(outer, "Type", "UnstructuredGrid");
    write_numbers(outer, "Version", {2, 0});
    const HDF5Handle inner(H5Gopen2(file, steps.c_str(), H5P_DEFAULT),
                           H5Gclose);
    write_numbers(inner, "NSteps", {0});
  }



  void
  VtkHdfFile::make_field(const std::string  &name,
                         const unsigned int  n_columns,
                         const std::uint64_t rows_of_chunk)
  {
    make(point_data + name,
         is_double(name) ? H5T_IEEE_F64LE : H5T_IEEE_F32LE,
         columns_of_data_set(n_columns),
         rows_of_chunk);
    // The rows of a time are those of the positions: another name of the same
    // numbers.
    const HDF5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    check_hdf5(H5Pset_create_intermediate_group(links, 1));
    check_hdf5(H5Lcreate_hard(file,
                              (steps + "PointOffsets").c_str(),
                              file,
                              (steps + "PointDataOffsets/" + name).c_str(),
                              links,
                              H5P_DEFAULT));
  }



  void
  VtkHdfFile::set_rows_of(const std::string &name, const std::uint64_t n_rows)
  {
    HDF5Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    hsize_t    size[] = {0, 0};
    {
      const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
      check_hdf5(H5Sget_simple_extent_dims(space, size, nullptr));
    }
    size[0] = n_rows;
    check_hdf5(H5Dset_extent(data_set, size));
    data_set.finish();
  }



  void
  VtkHdfFile::set_rows(const VtkHdfContent &content)
  {
    const std::uint64_t n_points = content.n_points(),
                        n_parts  = content.parts.size(),
                        n_cells  = content.n_cells_before(n_parts);
    set_rows_of(root + "Points", n_points);
    for (const auto &field : content.fields)
      set_rows_of(point_data + field.first, n_points);
    set_rows_of(root + "Connectivity", n_cells);
    set_rows_of(root + "Types", n_cells);
    set_rows_of(root + "Offsets", n_cells + n_parts);
    for (const std::string &name : names_of_parts)
      set_rows_of(root + name, n_parts);
    for (const auto *names : {&names_of_steps, &names_of_cells})
      for (const std::string &name : *names)
        set_rows_of(steps + name, content.times.size());
  }



  template <typename T>
  void
  VtkHdfFile::write(const std::string    &name,
                    const std::uint64_t   first,
                    const std::vector<T> &values,
                    const unsigned int    n_columns)
  {
    const hid_t        type  = std::is_same_v<T, float>    ? H5T_NATIVE_FLOAT
                               : std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE
                               : std::is_same_v<T, std::uint64_t> ? H5T_NATIVE_UINT64
                                                                  : H5T_NATIVE_UINT8;
    const unsigned int width = std::max(1u, n_columns);
    HDF5Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    transfer_hdf5_rows(first,
                       values.size() / width,
                       n_columns,
                       data_set,
                       comm,
                       [&](const hid_t         memory,
                           const hid_t         space,
                           const hid_t         list,
                           const unsigned long begin) {
                         return H5Dwrite(data_set,
                                         type,
                                         memory,
                                         space,
                                         list,
                                         values.data() + begin * width);
                       });
    data_set.finish();
  }



  void
  VtkHdfFile::write_cells(const VtkHdfContent &content,
                          const std::uint64_t  first,
                          const std::uint64_t  own)
  {
    const std::uint64_t part  = content.parts.size() - 1,
                        begin = content.n_cells_before(part) + first;
    const bool is_last        = Utilities::MPI::this_mpi_process(comm) + 1 ==
                         Utilities::MPI::n_mpi_processes(comm);
    std::vector<std::uint64_t> numbers(own + is_last);
    for (std::uint64_t k = 0; k < numbers.size(); ++k)
      numbers[k] = first + k;
    // One more than cells in each part.
    write(root + "Offsets", begin + part, numbers);
    numbers.resize(own);
    write(root + "Connectivity", begin, numbers);
    // Vertices.
    write(root + "Types", begin, std::vector<std::uint8_t>(own, 1));
  }



  void
  VtkHdfFile::write_time(const VtkHdfContent &content, const bool is_new_part)
  {
    // Rows of the first process.
    const bool is_first = Utilities::MPI::this_mpi_process(comm) == 0;
    using Numbers       = std::vector<std::uint64_t>;
    const auto row      = [&](const std::uint64_t value) {
      return is_first ? Numbers{value} : Numbers();
    };
    const VtkHdfTime   &last = content.times.back();
    const std::uint64_t k    = content.times.size() - 1;
    if (is_new_part)
      for (const std::string &name : names_of_parts)
        write(root + name, last.part, row(last.n_points));
    write(steps + "Values",
          k,
          is_first ? std::vector<double>{last.time} : std::vector<double>());
    write(steps + "PartOffsets", k, row(last.part));
    write(steps + "NumberOfParts", k, row(1));
    write(steps + "PointOffsets", k, row(last.first_point));
    for (const std::string &name : names_of_cells)
      write(steps + name, k, row(content.n_cells_before(last.part)), 1);
  }



  void
  VtkHdfFile::write_nothing(const std::string  &field,
                            const unsigned int  n_columns,
                            const std::uint64_t first,
                            const std::uint64_t n_rows)
  {
    const auto         share = share_of(n_rows, comm);
    std::vector<float> values((share.second - share.first) * n_columns,
                              std::numeric_limits<float>::quiet_NaN());
    write(point_data + field,
          first + share.first,
          values,
          columns_of_data_set(n_columns));
  }



  void
  VtkHdfFile::set_n_times(const std::uint64_t n)
  {
    const HDF5Handle group(H5Gopen2(file, steps.c_str(), H5P_DEFAULT),
                           H5Gclose);
    HDF5Handle       attribute(H5Aopen(group, "NSteps", H5P_DEFAULT), H5Aclose);
    check_hdf5(H5Awrite(attribute, H5T_NATIVE_UINT64, &n));
    attribute.finish();
  }



  template <typename T>
  std::vector<T>
  VtkHdfFile::read_all(const std::string &name) const
  {
    const hid_t type =
      std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT64;
    const HDF5Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT),
                              H5Dclose);
    const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
    const hssize_t   n = H5Sget_simple_extent_npoints(space);
    check_hdf5(n < 0 ? -1 : 0);
    std::vector<T> values(n);
    if (n > 0)
      check_hdf5(
        H5Dread(data_set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    return values;
  }



  std::map<std::string, unsigned int>
  VtkHdfFile::read_fields() const
  {
    std::map<std::string, unsigned int> result;
    const HDF5Handle group(H5Gopen2(file, point_data.c_str(), H5P_DEFAULT),
                           H5Gclose);
    for (const std::string &name : hdf5_links(group))
      {
        const HDF5Handle data_set(H5Dopen2(group, name.c_str(), H5P_DEFAULT),
                                  H5Dclose);
        const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
        hsize_t          size[] = {0, 1};
        AssertThrow(H5Sget_simple_extent_ndims(space) <= 2,
                    ExcMessage("a field has a wrong shape"));
        check_hdf5(H5Sget_simple_extent_dims(space, size, nullptr));
        result[name] = size[1];
      }
    return result;
  }



  VtkHdfContent
  VtkHdfFile::read(const unsigned int n_times) const
  {
    using Number       = std::uint64_t;
    const auto times   = read_all<double>(steps + "Values");
    const auto first   = read_all<Number>(steps + "PointOffsets");
    const auto part    = read_all<Number>(steps + "PartOffsets");
    const auto numbers = read_all<Number>(root + "NumberOfPoints");
    AssertThrow(std::min({times.size(), first.size(), part.size()}) >= n_times,
                ExcMessage("it has " + std::to_string(times.size()) +
                           " times, and not the " + std::to_string(n_times) +
                           " that had been written"));
    VtkHdfContent content;
    std::uint64_t n_parts = 0;
    for (unsigned int k = 0; k < n_times; ++k)
      {
        AssertThrow(part[k] < numbers.size() && first[k] == content.n_points(),
                    ExcMessage("its numbers of points contradict each other"));
        content.times.push_back(
          {times[k], first[k], numbers[part[k]], part[k]});
        n_parts = std::max(n_parts, part[k] + 1);
      }
    content.parts.assign(numbers.begin(), numbers.begin() + n_parts);
    content.fields = read_fields();
    return content;
  }



  void
  VtkHdfFile::find_chunks(const VtkHdfContent &content,
                          ChunkPlaces         &places) const
  {
    const auto find = [&](const std::string &name) {
      const HDF5Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT),
                                H5Dclose);
      const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
      const HDF5Handle list(H5Dget_create_plist(data_set), H5Pclose);
      hsize_t          size[] = {0, 0}, chunk[] = {0, 0};
      check_hdf5(H5Sget_simple_extent_dims(space, size, nullptr));
      check_hdf5(H5Pget_chunk(list, 2, chunk));
      std::uint64_t &k = places.n_known[name];
      for (; k * chunk[0] < size[0]; ++k)
        {
          const hsize_t first[] = {k * chunk[0], 0};
          unsigned int  filters = 0;
          haddr_t       begin   = HADDR_UNDEF;
          hsize_t       n_bytes = 0;
          check_hdf5(H5Dget_chunk_info_by_coord(
            data_set, first, &filters, &begin, &n_bytes));
          if (begin == HADDR_UNDEF)
            break;
          places.ranges.push_back({begin, begin + n_bytes});
        }
    };
    for (const char *const name :
         {"Points", "Connectivity", "Types", "Offsets"})
      find(root + name);
    for (const auto &field : content.fields)
      find(point_data + field.first);
    for (const std::string &name : names_of_parts)
      find(root + name);
    for (const auto *names : {&names_of_steps, &names_of_cells})
      for (const std::string &name : *names)
        find(steps + name);
  }



  void
  VtkHdfFile::finish()
  {
    file.finish();
  }



  template void
  VtkHdfFile::write(const std::string &,
                    const std::uint64_t,
                    const std::vector<float> &,
                    const unsigned int);
  template void
  VtkHdfFile::write(const std::string &,
                    const std::uint64_t,
                    const std::vector<double> &,
                    const unsigned int);
} // namespace greville
