// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/csv.h>
#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/base/text_file.h>

#include <boost/algorithm/string/join.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sys/stat.h>

namespace greville
{
  using namespace dealii;

  double
  CsvLine::number(const unsigned int column, const std::string &name) const
  {
    double result = std::nan("");
    try
      {
        result = Utilities::string_to_double(words.at(column));
      }
    catch (const std::exception &)
      {}
    Require(std::isfinite(result),
            where + "no finite number for '" + name + "' in <" + text + ">.");
    return result;
  }



  void
  read_csv(const std::string                          &file,
           const std::string                          &parameter,
           const std::function<void(const CsvLine &)> &visit)
  {
    const std::string of =
      "<" + file + "> of the parameter '" + parameter + "'";
    const std::string cannot_read = "Cannot read the file " + of;
    std::error_code   error;
    Require(std::filesystem::exists(file, error),
            "There is no file " + of + ".");
    std::ifstream stream = open_text_file(file, cannot_read);
    Require(stream, cannot_read + ".");
    CsvLine      line{true, "", {}, ""};
    bool         has_lines   = false;
    unsigned int line_number = 0;
    while (read_text_line(stream, line.text, line_number))
      {
        line.text = Utilities::trim(line.text);
        if (line.text.empty() || line.text[0] == '#')
          continue;
        const std::string place = of + ", line " + std::to_string(line_number);
        check_utf8(line.text, place);
        line.words = Utilities::split_string_list(line.text, ',');
        line.where = place + ": ";
        visit(line);
        has_lines      = !line.is_header;
        line.is_header = false;
      }
    Require(has_lines, "The file " + of + " has no lines of numbers.");
  }



  void
  CsvWriter::open(const std::string              &name,
                  const std::vector<std::string> &names,
                  const unsigned int              precision,
                  const MPI_Comm                  communicator)
  {
    file  = name;
    comm  = communicator;
    errno = 0;
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      out.open(file);
    out.precision(precision);
    write_line(names);
  }



  bool
  CsvWriter::resume(const std::string              &name,
                    const std::vector<std::string> &names,
                    const unsigned int              precision,
                    const std::uint64_t             n_bytes,
                    const MPI_Comm                  communicator)
  {
    file = name;
    comm = communicator;
    out.precision(precision);
    unsigned int is_there = 0;
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      {
        std::error_code none;
        is_there = std::filesystem::exists(file, none);
      }
    if (Utilities::MPI::max(is_there, comm) == 0)
      {
        open(name, names, precision, comm);
        return false;
      }
    run_on_first(comm, [&]() {
      const std::string header = boost::algorithm::join(names, ",");
      std::string       found;
      errno = 0;
      std::ifstream in(file);
      Require(in, "Cannot read <" + file + ">: " + std::strerror(errno) + ".");
      std::getline(in, found);
      std::error_code     error;
      const std::uint64_t n_there = std::filesystem::file_size(file, error);
      Require(!error, "Cannot read <" + file + ">: " + error.message() + ".");
      Require(n_there >= n_bytes,
              "<" + file +
                "> is shorter than it was at the checkpoint. Move it away to "
                "begin a new one.");
      Require(found == header,
              "<" + file + "> has the columns <" + found +
                ">, but the resumed run writes <" + header + ">.");
      std::filesystem::resize_file(file, n_bytes, error);
      errno = error.value();
      if (!error)
        out.open(file, std::ios::app);
      Require(out.is_open(), write_error(file));
      size = n_bytes;
    });
    return true;
  }



  std::uint64_t
  CsvWriter::sync()
  {
    std::uint64_t n_bytes = 0;
    if (!file.empty())
      run_on_first(comm, [&]() {
        errno = 0;
        Require(std::filesystem::exists(file), write_error(file));
        write_to_disk(file);
        n_bytes = std::filesystem::file_size(file);
      });
    return n_bytes;
  }



  void
  CsvWriter::write(const std::vector<double> &values)
  {
    errno = 0;
    write_line(values);
  }



  template <typename T>
  void
  CsvWriter::write_line(const std::vector<T> &words)
  {
    run_on_first(comm, [&]() {
      for (std::size_t k = 0; k < words.size(); ++k)
        out << (k > 0 ? "," : "") << words[k];
      out << std::endl;
      Require(out, write_error(file));
      // Otherwise, lines would be written to a file that has been removed.
      struct stat named;
      Require(stat(file.c_str(), &named) == 0, write_error(file));
      Require(inode == 0 || inode == named.st_ino,
              "Cannot write <" + file + ">: another file has taken its place.");
      inode = named.st_ino;
      size  = named.st_size;
    });
  }
} // namespace greville
