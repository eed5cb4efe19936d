// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/base/tables.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <hdf5.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr const char *checksum_name = "checksum";
    constexpr const char *columns_name  = "columns";

    // Bytes that HDF5 adds to the content of a file, and of a table in it.
    constexpr std::uint64_t size_of_headers = 4096;

    // The largest number of elements per HDF5 call, since MPI-IO counts bytes
    // by int.
    constexpr hsize_t max_elements_of_call = 1u << 27;



    // HDF5's own C functions, with exceptions: dealii::HDF5 checks results by
    // Assert only, so that a full disk would pass unnoticed in release mode,
    // and cannot list attributes and data sets.

    /// Throw with HDF5's reason if the @p result of its last call indicates a
    /// failure: its innermost message, with the system's reason if there is
    /// one.
    void
    check_hdf5(const hid_t result)
    {
      if (result >= 0)
        return;
      std::string text;
      const auto  keep =
        [](unsigned, const H5E_error2_t *error, void *found) -> herr_t {
        auto &words = *static_cast<std::string *>(found);
        if (words.empty() && error->desc != nullptr)
          words = error->desc;
        return 0;
      };
      H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, +keep, &text);
      Require(false, "HDF5 has failed" + (text.empty() ? "" : ": " + text));
    }



    /// An object of HDF5, with the function that closes it. Throws if HDF5 has
    /// not made the object.
    class HDF5Handle
    {
    public:
      HDF5Handle(const hid_t id, herr_t (*close)(hid_t))
        : id(id)
        , close(close)
      {
        check_hdf5(id);
      }

      HDF5Handle(const HDF5Handle &) = delete;

      ~HDF5Handle()
      {
        if (id >= 0)
          close(id);
      }

      operator hid_t() const
      {
        return id;
      }

      /// Close the object, and throw if this fails, since closing may write
      /// data.
      void
      finish()
      {
        const hid_t closed = id;
        id                 = -1;
        check_hdf5(close(closed));
      }

    private:
      hid_t id;
      herr_t (*close)(hid_t);
    };



    /// Suppresses, during its lifetime, the error messages that HDF5 prints on
    /// all processes.
    class HDF5Silence
    {
    public:
      HDF5Silence()
      {
        // Otherwise, HDF5 would retry a failed write at the end of the program,
        // after MPI has ended.
        static const herr_t no_end = H5dont_atexit();
        (void)no_end;
        H5Eget_auto2(H5E_DEFAULT, &function, &data);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      }

      HDF5Silence(const HDF5Silence &) = delete;

      ~HDF5Silence()
      {
        H5Eset_auto2(H5E_DEFAULT, function, data);
      }

    private:
      H5E_auto2_t function = nullptr;
      void       *data     = nullptr;
    };



    void
    write_hdf5_text(const hid_t        object,
                    const std::string &name,
                    const std::string &text)
    {
      // HDF5 has no empty strings.
      const HDF5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
      check_hdf5(H5Tset_size(type, std::max<std::size_t>(1, text.size())));
      check_hdf5(H5Tset_strpad(type, H5T_STR_NULLPAD));
      const HDF5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      HDF5Handle       attribute(
        H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
      check_hdf5(H5Awrite(attribute, type, text.empty() ? "\0" : text.data()));
      attribute.finish();
    }



    std::string
    read_hdf5_text(const hid_t object, const std::string &name)
    {
      const HDF5Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT),
                                 H5Aclose);
      const HDF5Handle type(H5Aget_type(attribute), H5Tclose);
      Require(H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0,
              "an attribute is no text");
      std::string text(H5Tget_size(type), '\0');
      check_hdf5(H5Aread(attribute, type, &text[0]));
      while (!text.empty() && text.back() == '\0')
        text.pop_back();
      return text;
    }



    /// Return the property list of HDF5 for files shared by all processes.
    HDF5Handle
    hdf5_access(const MPI_Comm comm)
    {
      // A component of Open MPI 4.1 for shared file pointers, which HDF5 does
      // not use, overflows for paths of 250 letters. Open MPI reads this
      // variable when it opens its first file.
      setenv("OMPI_MCA_sharedfp", "^lockedfile", 0);
      const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
      if (list >= 0)
        {
          H5Pset_fapl_mpio(list, comm, MPI_INFO_NULL);
          // Older file formats have no attributes beyond 64 kB.
          H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
        }
      return {list, H5Pclose};
    }



    std::uint64_t
    checksum_of(const std::map<std::string, std::string> &texts)
    {
      std::uint64_t sum = 0;
      for (const auto &[name, text] : texts)
        for (const std::string &word : {name, text})
          sum = checksum(word, sum);
      return sum;
    }



    /// Add a name to a list, for each attribute or link of an object.
    template <typename Info>
    herr_t
    add_name(hid_t, const char *name, const Info *, void *list)
    {
      static_cast<std::vector<std::string> *>(list)->push_back(name);
      return 0;
    }



    /// Collective. Read or write, by the @p call H5Dread or H5Dwrite, the rows
    /// [first, first + n_rows) of a data set. All processes make the same
    /// number of calls, and throw together.
    template <typename Call, typename Number>
    void
    transfer_rows(const Call     call,
                  const hsize_t  first,
                  const hsize_t  n_rows,
                  const hsize_t  n_columns,
                  const hid_t    data_set,
                  const MPI_Comm comm,
                  Number        *values)
    {
      const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
      const HDF5Handle list(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
      check_hdf5(H5Pset_dxpl_mpio(list, H5FD_MPIO_COLLECTIVE));
      const hsize_t chunk =
        std::max<hsize_t>(1, max_elements_of_call / n_columns);
      const hsize_t n_chunks =
        Utilities::MPI::max<std::uint64_t>((n_rows + chunk - 1) / chunk, comm);
      bool has_failed = false;
      for (hsize_t k = 0; k < n_chunks; ++k)
        {
          const hsize_t    begin    = std::min(n_rows, k * chunk);
          const hsize_t    n        = std::min(chunk, n_rows - begin);
          const hsize_t    start[2] = {first + begin, 0};
          const hsize_t    count[2] = {n, n_columns};
          const HDF5Handle memory(H5Screate_simple(2, count, nullptr),
                                  H5Sclose);
          // A process whose selection fails takes part with no rows.
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
          has_failed = call(data_set,
                            H5T_NATIVE_DOUBLE,
                            memory,
                            space,
                            list,
                            values + begin * n_columns) < 0 ||
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
      const hsize_t       size[2] = {Utilities::MPI::sum(own, comm), n_columns};
      const HDF5Handle    space(H5Screate_simple(2, size, nullptr), H5Sclose);
      HDF5Handle          data_set(H5Dcreate2(file,
                                     table.name.c_str(),
                                     H5T_NATIVE_DOUBLE,
                                     space,
                                     H5P_DEFAULT,
                                     H5P_DEFAULT,
                                     H5P_DEFAULT),
                          H5Dclose);
      write_hdf5_text(data_set,
                      columns_name,
                      boost::algorithm::join(table.columns, ","));
      write_hdf5_text(data_set,
                      checksum_name,
                      std::to_string(Utilities::MPI::sum(
                        checksum(table.values, first * n_columns), comm)));
      if (size[0] > 0)
        transfer_rows(
          H5Dwrite, first, own, n_columns, data_set, comm, table.values.data());
      data_set.finish();
    }



    DistributedTable
    read_table(const hid_t file, const std::string &name, const MPI_Comm comm)
    {
      DistributedTable table;
      table.name = name;
      const HDF5Handle data_set(H5Dopen2(file, name.c_str(), H5P_DEFAULT),
                                H5Dclose);
      table.columns =
        Utilities::split_string_list(read_hdf5_text(data_set, columns_name));
      const HDF5Handle space(H5Dget_space(data_set), H5Sclose);
      hsize_t          size[2] = {0, 0};
      Require(H5Sget_simple_extent_ndims(space) == 2 &&
                H5Sget_simple_extent_dims(space, size, nullptr) == 2 &&
                size[1] == table.columns.size() && size[1] > 0,
              "the table " + name + " has a wrong shape");
      hsize_t n_bytes = 0;
      check_hdf5(H5Fget_filesize(file, &n_bytes));
      Require(size[0] <= n_bytes / (sizeof(double) * size[1]),
              "the table " + name + " is longer than the file");
      const auto    share = share_of(size[0], comm);
      const hsize_t first = share.first, own = share.second - first;
      table.values.resize(own * size[1]);
      if (size[0] > 0)
        transfer_rows(
          H5Dread, first, own, size[1], data_set, comm, table.values.data());
      const std::string found = std::to_string(
        Utilities::MPI::sum(checksum(table.values, first * size[1]), comm));
      Require(found == read_hdf5_text(data_set, checksum_name),
              "the table " + name + " does not have its checksum");
      return table;
    }



    std::uint64_t
    size_of(const TablesFile &content, const MPI_Comm comm)
    {
      std::uint64_t own = 0;
      for (const DistributedTable &table : content.tables)
        own += table.values.size() * sizeof(double);
      std::uint64_t size = Utilities::MPI::sum(own, comm) +
                           size_of_headers * (1 + content.tables.size());
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
    Require(false, "there is no table " + name);
    return tables[0];
  }



  const std::string &
  TablesFile::text(const std::string &name) const
  {
    const auto found = texts.find(name);
    Require(found != texts.end(), "there is no text " + name);
    return found->second;
  }



  void
  write_tables(const std::string &file,
               const TablesFile  &content,
               const MPI_Comm     comm)
  {
    const std::string unfinished = file + ".new";
    const HDF5Silence silence;
    std::string       message;
    const auto        size = size_of(content, comm);
    // The first process makes the file alone: otherwise, MPI-IO would report a
    // failure on all processes.
    run_on_first(comm, [&]() { make_file(unfinished, size); });
    try
      {
        const HDF5Handle access = hdf5_access(comm);
        HDF5Handle       handle(
          H5Fcreate(unfinished.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
          H5Fclose);
        for (const auto &[name, text] : content.texts)
          write_hdf5_text(handle, name, text);
        write_hdf5_text(handle,
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
    run_on_first(comm, [&]() {
      if (message.empty())
        {
          write_to_disk(unfinished);
          std::filesystem::rename(unfinished, file);
          write_to_disk(std::filesystem::path(file).parent_path());
          return;
        }
      std::error_code error;
      std::filesystem::remove(unfinished, error);
      Require(false, message);
    });
  }



  TablesFile
  read_tables(const std::string &file, const MPI_Comm comm)
  {
    const HDF5Silence silence;
    // HDF5 may crash on a damaged file.
    check_seal(file, comm);
    TablesFile  content;
    std::string message;
    try
      {
        const HDF5Handle access = hdf5_access(comm);
        const HDF5Handle handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access),
                                H5Fclose);
        std::string      sum;
        std::vector<std::string> names, links;
        hsize_t                  n = 0;
        check_hdf5(H5Aiterate2(handle,
                               H5_INDEX_NAME,
                               H5_ITER_INC,
                               &n,
                               add_name<H5A_info_t>,
                               &names));
        n = 0;
        check_hdf5(H5Literate(handle,
                              H5_INDEX_NAME,
                              H5_ITER_INC,
                              &n,
                              add_name<H5L_info_t>,
                              &links));
        for (const std::string &name : names)
          if (name == checksum_name)
            sum = read_hdf5_text(handle, name);
          else
            content.texts[name] = read_hdf5_text(handle, name);
        Require(sum == std::to_string(checksum_of(content.texts)),
                "its texts do not have their checksum");
        for (const std::string &name : links)
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
