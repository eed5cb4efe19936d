// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/base/parameters.h>
#include <greville/base/tables.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <hdf5.h>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr const char *checksum_name = "checksum";
    constexpr const char *columns_name  = "columns";

    // Elements that one call of HDF5 writes or reads: MPI-IO counts bytes by
    // int.
    constexpr hsize_t most_elements = 1u << 27;

    // Bytes of what HDF5 adds to the content of a file, and of a table in it.
    constexpr std::uint64_t size_of_headers = 4096;



    std::string
    reason_of_hdf5();



    /**
     * What HDF5 makes, with the function that closes it.
     */
    class Handle
    {
    public:
      Handle(const hid_t id, herr_t (*close)(hid_t))
        : id(id)
        , close(close)
      {
        AssertThrow(id >= 0, ExcMessage(reason_of_hdf5()));
      }

      Handle(const Handle &) = delete;

      ~Handle()
      {
        if (id >= 0)
          close(id);
      }

      operator hid_t() const
      {
        return id;
      }

      /**
       * Close it, and look whether that works: data may be written by it.
       */
      void
      finish()
      {
        const hid_t closed = id;
        id                 = -1;
        AssertThrow(close(closed) >= 0, ExcMessage(reason_of_hdf5()));
      }

    private:
      hid_t id;
      herr_t (*close)(hid_t);
    };



    /**
     * What HDF5 says of the last call, which has failed: the innermost of its
     * messages, with the reason of the system where there is one.
     */
    std::string
    reason_of_hdf5()
    {
      std::string text;
      const auto  keep =
        [](unsigned, const H5E_error2_t *error, void *found) -> herr_t {
        auto &words = *static_cast<std::string *>(found);
        if (words.empty() && error->desc != nullptr)
          words = error->desc;
        return 0;
      };
      H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, +keep, &text);
      return "HDF5 has failed" + (text.empty() ? "" : ": " + text);
    }



    void
    check(const herr_t result)
    {
      AssertThrow(result >= 0, ExcMessage(reason_of_hdf5()));
    }



    /**
     * HDF5 prints what goes wrong, on all processes; our messages say it once.
     */
    class Silence
    {
    public:
      Silence()
      {
        // At the end of the program, a file that could not be written would be
        // tried again, without MPI.
        static const herr_t no_end = H5dont_atexit();
        (void)no_end;
        H5Eget_auto2(H5E_DEFAULT, &function, &data);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      }

      ~Silence()
      {
        H5Eset_auto2(H5E_DEFAULT, function, data);
      }

    private:
      H5E_auto2_t function = nullptr;
      void       *data     = nullptr;
    };



    std::uint64_t
    checksum_of(const std::map<std::string, std::string> &texts)
    {
      std::uint64_t sum = 0;
      for (const auto &[name, text] : texts)
        for (const std::string &word : {name, text})
          sum = checksum(word, sum);
      return sum;
    }



    std::uint64_t
    sum_of(const std::uint64_t value, const MPI_Comm comm)
    {
      std::uint64_t sum = 0;
      MPI_Allreduce(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, comm);
      return sum;
    }



    void
    write_text(const hid_t        object,
               const std::string &name,
               const std::string &text)
    {
      // HDF5 has no empty texts.
      const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
      check(H5Tset_size(type, std::max<std::size_t>(1, text.size())));
      check(H5Tset_strpad(type, H5T_STR_NULLPAD));
      const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      Handle       attribute(
        H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
      check(H5Awrite(attribute, type, text.empty() ? "\0" : text.data()));
      attribute.finish();
    }



    std::string
    read_text(const hid_t object, const std::string &name)
    {
      const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT),
                             H5Aclose);
      const Handle type(H5Aget_type(attribute), H5Tclose);
      AssertThrow(H5Tget_class(type) == H5T_STRING &&
                    H5Tis_variable_str(type) == 0,
                  ExcMessage("an attribute is no text"));
      std::string text(H5Tget_size(type), '\0');
      check(H5Aread(attribute, type, &text[0]));
      while (!text.empty() && text.back() == '\0')
        text.pop_back();
      return text;
    }



    std::vector<std::string>
    names_of_attributes(const hid_t object)
    {
      std::vector<std::string> names;
      const auto               add =
        [](hid_t, const char *name, const H5A_info_t *, void *list) -> herr_t {
        static_cast<std::vector<std::string> *>(list)->push_back(name);
        return 0;
      };
      hsize_t n = 0;
      check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &n, +add, &names));
      return names;
    }



    std::vector<std::string>
    names_of_tables(const hid_t file)
    {
      std::vector<std::string> names;
      const auto               add =
        [](hid_t, const char *name, const H5L_info_t *, void *list) -> herr_t {
        static_cast<std::vector<std::string> *>(list)->push_back(name);
        return 0;
      };
      hsize_t n = 0;
      check(H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, &n, +add, &names));
      return names;
    }



    std::vector<std::string>
    split(const std::string &text)
    {
      std::vector<std::string> words;
      std::istringstream       stream(text);
      for (std::string word; std::getline(stream, word, ',');)
        words.push_back(word);
      return words;
    }



    /**
     * Rows [first, first + n_rows) of a data set from or to @p values, by
     * @p transfer(memory space, file space, list, place). All processes call
     * it equally often, and throw together.
     */
    template <typename Transfer>
    void
    transfer_rows(const hsize_t   first,
                  const hsize_t   n_rows,
                  const hsize_t   n_columns,
                  const hid_t     data_set,
                  const MPI_Comm  comm,
                  const Transfer &transfer)
    {
      const Handle space(H5Dget_space(data_set), H5Sclose);
      const Handle list(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
      check(H5Pset_dxpl_mpio(list, H5FD_MPIO_COLLECTIVE));
      const hsize_t chunk = std::max<hsize_t>(1, most_elements / n_columns);
      const hsize_t n_chunks =
        Utilities::MPI::max<std::uint64_t>((n_rows + chunk - 1) / chunk, comm);
      bool has_failed = false;
      for (hsize_t k = 0; k < n_chunks; ++k)
        {
          const hsize_t begin    = std::min(n_rows, k * chunk);
          const hsize_t n        = std::min(chunk, n_rows - begin);
          const hsize_t start[2] = {first + begin, 0};
          const hsize_t count[2] = {n, n_columns};
          const Handle  memory(H5Screate_simple(2, count, nullptr), H5Sclose);
          // A process that cannot select takes part with no rows.
          bool is_selected = n > 0 && H5Sselect_hyperslab(space,
                                                          H5S_SELECT_SET,
                                                          start,
                                                          nullptr,
                                                          count,
                                                          nullptr) >= 0;
          has_failed       = has_failed || (n > 0 && !is_selected);
          if (!is_selected)
            is_selected =
              H5Sselect_none(space) >= 0 && H5Sselect_none(memory) >= 0;
          has_failed = transfer(memory, space, list, begin * n_columns) < 0 ||
                       !is_selected || has_failed;
        }
      throw_on_all(has_failed ? "HDF5 has failed" : "", comm);
    }



    void
    write_table(const hid_t             file,
                const DistributedTable &table,
                const MPI_Comm          comm)
    {
      const std::uint64_t own       = table.n_rows();
      const std::uint64_t first     = sum_before(own, comm);
      const hsize_t       n_columns = table.columns.size();
      const hsize_t       size[2]   = {sum_of(own, comm), n_columns};
      const Handle        space(H5Screate_simple(2, size, nullptr), H5Sclose);
      Handle              data_set(H5Dcreate2(file,
                                 table.name.c_str(),
                                 H5T_NATIVE_DOUBLE,
                                 space,
                                 H5P_DEFAULT,
                                 H5P_DEFAULT,
                                 H5P_DEFAULT),
                      H5Dclose);
      write_text(data_set,
                 columns_name,
                 boost::algorithm::join(table.columns, ","));
      write_text(data_set,
                 checksum_name,
                 std::to_string(
                   sum_of(checksum(table.values, first * n_columns), comm)));
      if (size[0] > 0)
        transfer_rows(first,
                      own,
                      n_columns,
                      data_set,
                      comm,
                      [&](const hid_t       memory,
                          const hid_t       file_space,
                          const hid_t       list,
                          const std::size_t begin) {
                        return H5Dwrite(data_set,
                                        H5T_NATIVE_DOUBLE,
                                        memory,
                                        file_space,
                                        list,
                                        table.values.data() + begin);
                      });
      data_set.finish();
    }



    DistributedTable
    read_table(const hid_t file, const std::string &name, const MPI_Comm comm)
    {
      DistributedTable table;
      table.name = name;
      const Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT),
                            H5Dclose);
      table.columns = split(read_text(data_set, columns_name));
      const Handle space(H5Dget_space(data_set), H5Sclose);
      hsize_t      size[2] = {0, 0};
      AssertThrow(H5Sget_simple_extent_ndims(space) == 2 &&
                    H5Sget_simple_extent_dims(space, size, nullptr) == 2 &&
                    size[1] == table.columns.size() && size[1] > 0,
                  ExcMessage("the table " + name + " has a wrong shape"));
      hsize_t n_bytes = 0;
      check(H5Fget_filesize(file, &n_bytes));
      AssertThrow(size[0] <= n_bytes / (sizeof(double) * size[1]),
                  ExcMessage("the table " + name + " is longer than the file"));
      const auto    share = share_of(size[0], comm);
      const hsize_t first = share.first, own = share.second - first;
      table.values.resize(own * size[1]);
      if (size[0] > 0)
        transfer_rows(first,
                      own,
                      size[1],
                      data_set,
                      comm,
                      [&](const hid_t       memory,
                          const hid_t       file_space,
                          const hid_t       list,
                          const std::size_t at) {
                        return H5Dread(data_set,
                                       H5T_NATIVE_DOUBLE,
                                       memory,
                                       file_space,
                                       list,
                                       table.values.data() + at);
                      });
      const std::string found =
        std::to_string(sum_of(checksum(table.values, first * size[1]), comm));
      AssertThrow(found == read_text(data_set, checksum_name),
                  ExcMessage("the table " + name +
                             " does not have its checksum"));
      return table;
    }



    /**
     * The list of HDF5 for files of all processes.
     */
    Handle
    parallel_access(const MPI_Comm comm)
    {
      // A component of Open MPI 4.1 for files with one pointer of all
      // processes, which HDF5 does not use, overflows by paths of 250 letters.
      // Open MPI reads this when it opens its first file.
      setenv("OMPI_MCA_sharedfp", "^lockedfile", 0);
      const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
      if (list >= 0)
        {
          H5Pset_fapl_mpio(list, comm, MPI_INFO_NULL);
          // Files of before have no attributes beyond 64 kB.
          H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
        }
      return {list, H5Pclose};
    }



    /**
     * The bytes of a file with the content of all processes, and some more.
     */
    std::uint64_t
    size_of(const TablesFile &content, const MPI_Comm comm)
    {
      std::uint64_t own = 0;
      for (const DistributedTable &table : content.tables)
        own += table.values.size() * sizeof(double);
      std::uint64_t size =
        sum_of(own, comm) + size_of_headers * (1 + content.tables.size());
      for (const auto &[name, text] : content.texts)
        size += name.size() + text.size();
      return size;
    }
  } // namespace



  std::vector<double>
  DistributedTable::gather(const MPI_Comm comm) const
  {
    std::vector<double> result;
    for (const auto &part : Utilities::MPI::all_gather(comm, values))
      result.insert(result.end(), part.begin(), part.end());
    return result;
  }



  const DistributedTable &
  TablesFile::table(const std::string &name) const
  {
    for (const DistributedTable &table : tables)
      if (table.name == name)
        return table;
    AssertThrow(false, ExcMessage("there is no table " + name));
    return tables[0];
  }



  const std::string &
  TablesFile::text(const std::string &name) const
  {
    const auto found = texts.find(name);
    AssertThrow(found != texts.end(), ExcMessage("there is no text " + name));
    return found->second;
  }



  void
  write_tables(const std::string &file,
               const TablesFile  &content,
               const MPI_Comm     comm)
  {
    const std::string unfinished = file + ".new";
    const Silence     silence;
    std::string       message;
    const auto        size = size_of(content, comm);
    // A file that cannot be made is found by the first process alone, so that
    // MPI-IO does not report it from all.
    run_on_first([&]() { make_file(unfinished, size); }, comm);
    try
      {
        const Handle access = parallel_access(comm);
        Handle       handle(
          H5Fcreate(unfinished.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
          H5Fclose);
        for (const auto &[name, text] : content.texts)
          write_text(handle, name, text);
        write_text(handle,
                   checksum_name,
                   std::to_string(checksum_of(content.texts)));
        for (const DistributedTable &table : content.tables)
          write_table(handle, table, comm);
        handle.finish();
      }
    catch (const std::exception &error)
      {
        message = "Cannot write <" + unfinished +
                  ">: " + system_reason(unfinished) + message_of(error) + ".";
      }
    message = first_of_all(message, comm);
    if (message.empty())
      try
        {
          seal_file(unfinished, comm);
        }
      catch (const ErrorOnAll &error)
        {
          message = message_of(error);
        }
    run_on_first(
      [&]() {
        if (message.empty())
          {
            write_to_disk(unfinished);
            std::filesystem::rename(unfinished, file);
            write_to_disk(std::filesystem::path(file).parent_path());
            return;
          }
        std::error_code error;
        std::filesystem::remove(unfinished, error);
        AssertThrow(false, ExcMessage(message));
      },
      comm);
  }



  TablesFile
  read_tables(const std::string &file, const MPI_Comm comm)
  {
    const Silence silence;
    // HDF5 may crash on a damaged file.
    check_seal(file, comm);
    TablesFile  content;
    std::string message;
    try
      {
        const Handle access = parallel_access(comm);
        const Handle handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access),
                            H5Fclose);
        std::string  sum;
        for (const std::string &name : names_of_attributes(handle))
          if (name == checksum_name)
            sum = read_text(handle, name);
          else
            content.texts[name] = read_text(handle, name);
        AssertThrow(sum == std::to_string(checksum_of(content.texts)),
                    ExcMessage("its texts do not have their checksum"));
        for (const std::string &name : names_of_tables(handle))
          content.tables.push_back(read_table(handle, name, comm));
      }
    catch (const std::exception &error)
      {
        message =
          "Cannot read <" + file +
          ">, which is truncated or has been changed: " + message_of(error) +
          ".";
      }
    throw_on_all(message, comm);
    return content;
  }
} // namespace greville
