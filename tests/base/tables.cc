// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 4

// Checks tables and texts in files. All processes read what was written, with
// the rows in order. Truncated, foreign or changed files are refused before
// HDF5 opens them. A failed write leaves the previous file.

#include <deal.II/base/mpi.h>

#include <greville/base/disk.h>
#include <greville/base/tables.h>

#include "../tests.h"
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <hdf5.h>

TablesFile
example(const MPI_Comm comm, const double scale)
{
  const unsigned int process = Utilities::MPI::this_mpi_process(comm);
  TablesFile         content;
  content.texts = {{"empty", ""},
                   {"long", std::string(200000, 'x') + "\n"},
                   {"words", "a = 1"}};
  content.tables.push_back({"rows", {"number", "process", "value"}, {}});
  // More rows on one process than on others, and none on the last of many.
  for (unsigned int k = 0; k < (process == 3 ? 0 : 7 + 5 * process); ++k)
    for (const double x : {double(k), double(process), scale * std::sqrt(k)})
      content.tables[0].values.push_back(x);
  content.tables.push_back({"nothing", {"a"}, {}});
  content.tables.push_back({"one row", {"nan", "inf", "zero"}, {}});
  if (process == 0)
    content.tables[2].values = {std::nan(""), -INFINITY, -0.};
  return content;
}



std::vector<double>
all(const DistributedTable &table, const MPI_Comm comm)
{
  std::vector<double> result;
  for (const auto &part : Utilities::MPI::all_gather(comm, table.values))
    result.insert(result.end(), part.begin(), part.end());
  return result;
}



void
check_refused(const std::string &file,
              const std::string &text,
              const MPI_Comm     comm)
{
  std::string message;
  try
    {
      read_tables(file, comm);
    }
  catch (const std::exception &error)
    {
      message = message_of(error);
    }
  check("<" + text + "> in <" + message + ">",
        message.find(text) != std::string::npos);
}



// A file with a table of 2^40 rows, none of which has been written.
void
write_promises(const std::string &name)
{
  const hid_t file =
    H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t letter = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR);
  const auto  add_text =
    [&](const hid_t object, const char *key, const char *text) {
      const hid_t attribute =
        H5Acreate2(object, key, letter, scalar, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, letter, text);
      H5Aclose(attribute);
    };
  add_text(file, "checksum", "0");
  const hsize_t size[2] = {hsize_t(1) << 40, 1}, chunk[2] = {1024, 1};
  const hid_t   list  = H5Pcreate(H5P_DATASET_CREATE);
  const hid_t   space = H5Screate_simple(2, size, nullptr);
  H5Pset_chunk(list, 2, chunk);
  const hid_t table = H5Dcreate2(
    file, "rows", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  add_text(table, "columns", "a");
  add_text(table, "checksum", "0");
  H5Dclose(table);
  H5Pclose(list);
  H5Sclose(space);
  H5Sclose(scalar);
  H5Tclose(letter);
  H5Fclose(file);
}



void
test_main()
{
  const MPI_Comm comm     = MPI_COMM_WORLD;
  const bool     is_first = Utilities::MPI::this_mpi_process(comm) == 0;

  const TablesFile written = example(comm, 1.);
  write_tables("tables.h5", written, comm);
  check("no unfinished file", !std::filesystem::exists("tables.h5.new"));
  const TablesFile read = read_tables("tables.h5", comm);
  check("texts", read.texts == written.texts);
  check("number of tables", read.tables.size() == 3);
  for (const DistributedTable &table : written.tables)
    {
      const DistributedTable &other = read.table(table.name);
      check("columns of " + table.name, other.columns == table.columns);
      const auto a = all(table, comm), b = all(other, comm);
      check("bits of " + table.name,
            a.size() == b.size() &&
              (a.empty() ||
               std::memcmp(a.data(), b.data(), 8 * a.size()) == 0));
      const auto n = Utilities::MPI::min_max_avg(double(other.n_rows()), comm);
      check("rows of " + table.name + " are shared", n.max - n.min, 1.);
    }

  // Files that are not what they were.
  check_refused("missing.h5", "No such file", comm);
  const auto size = std::filesystem::file_size("tables.h5");
  for (const double fraction : {0., 0.1, 0.5, 0.99})
    {
      if (is_first)
        {
          std::filesystem::copy("tables.h5", "truncated.h5");
          std::filesystem::resize_file("truncated.h5", fraction * size);
        }
      MPI_Barrier(comm);
      check_refused("truncated.h5", "truncated", comm);
      MPI_Barrier(comm);
      if (is_first)
        std::filesystem::remove("truncated.h5");
    }
  // One bit of a number, and a letter of a text.
  for (const bool of_text : {false, true})
    {
      if (is_first)
        {
          std::ifstream in("tables.h5", std::ios::binary);
          std::string   bytes((std::istreambuf_iterator<char>(in)), {});
          const double  x = std::sqrt(5.);
          std::string   wanted(of_text ? "a = 1" : "12345678");
          if (!of_text)
            std::memcpy(&wanted[0], &x, sizeof(x));
          const auto place = bytes.find(wanted);
          check("the number is there", place != std::string::npos);
          bytes[place] ^= 1;
          std::ofstream("changed.h5", std::ios::binary) << bytes;
        }
      MPI_Barrier(comm);
      check_refused("changed.h5", "has been changed", comm);
      MPI_Barrier(comm);
    }
  if (is_first)
    std::ofstream("foreign.h5") << "time,step\n0,1\n";
  MPI_Barrier(comm);
  check_refused("foreign.h5", "was not written by this program", comm);

  // A table that promises more rows than there are, without the memory for
  // them.
  if (is_first)
    write_promises("promises.h5");
  MPI_Barrier(comm);
  seal_file("promises.h5", comm);
  check_refused("promises.h5", "the table rows is longer than the file", comm);

  // Each byte of a file counts, and each that is missing or added.
  TablesFile small = example(comm, 1.);
  small.texts.erase("long");
  write_tables("small.h5", small, comm);
  check_seal("small.h5", comm);
  const auto is_refused = [&]() {
    try
      {
        check_seal("small.h5", comm);
        return false;
      }
    catch (const std::exception &)
      {
        return true;
      }
  };
  const std::uint64_t n_bytes    = std::filesystem::file_size("small.h5");
  std::uint64_t       n_accepted = 0;
  // The first process alone has the file open for writing.
  std::fstream stream;
  if (is_first)
    stream.open("small.h5", std::ios::binary | std::ios::in | std::ios::out);
  for (std::uint64_t k = 0; k < n_bytes; ++k)
    {
      const auto flip = [&]() {
        if (!is_first)
          return;
        stream.seekg(k);
        const char byte = stream.get();
        stream.seekp(k);
        stream.put(byte ^ (1 << (k % 8))).flush();
      };
      flip();
      MPI_Barrier(comm);
      n_accepted += !is_refused();
      flip();
    }
  stream.close();
  check("bytes", n_bytes > 2000);
  check("changed bytes that are accepted", n_accepted == 0);
  MPI_Barrier(comm);
  check("the file of before", !is_refused());
  for (const std::uint64_t size :
       {n_bytes + 1, n_bytes - 1, n_bytes - 64, n_bytes / 2, std::uint64_t(9)})
    {
      MPI_Barrier(comm);
      if (is_first)
        std::filesystem::resize_file("small.h5", size);
      MPI_Barrier(comm);
      check("refused with " + std::to_string(size) + " bytes", is_refused());
    }

  // Names of 300 letters and more.
  const std::string folder =
    std::string(150, 'a') + "/" + std::string(150, 'b');
  if (is_first)
    std::filesystem::create_directories(folder);
  MPI_Barrier(comm);
  write_tables(folder + "/tables.h5", written, comm);
  check("a long name",
        read_tables(folder + "/tables.h5", comm).texts == written.texts);

  // A file cannot take the place of a folder.
  if (is_first)
    std::filesystem::create_directories("folder.h5/a");
  MPI_Barrier(comm);
  for (const std::string name : {"folder.h5", "no_folder/a.h5"})
    {
      bool is_refused = false;
      try
        {
          write_tables(name, written, comm);
        }
      catch (const std::exception &)
        {
          is_refused = true;
        }
      check("refused " + name, is_refused);
    }
  write_tables("tables.h5", example(comm, 2.), comm);
  const auto twice = all(read_tables("tables.h5", comm).table("rows"), comm);
  check("the newer file", twice[3 * 4 + 2] == 4.);
}
