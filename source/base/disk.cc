// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/base/mixed_bits.h>
#include <greville/base/parameters.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr std::uint64_t seal_size  = 64; // bytes
    const char *const       seal_begin = "\nGreville: ";

    // The number of eight-byte numbers in memory at a time.
    constexpr std::uint64_t piece = 1 << 17;



    std::string
    seal_of(const std::uint64_t n_bytes, const std::uint64_t sum)
    {
      char text[seal_size + 1];
      std::snprintf(text,
                    sizeof(text),
                    "%s%19llu bytes, checksum %016llx\n",
                    seal_begin,
                    static_cast<unsigned long long>(n_bytes),
                    static_cast<unsigned long long>(sum));
      return text;
    }



    /// Reserve room on the disk. Returns false if this fails; file systems that
    /// cannot reserve room count as having enough.
    bool
    allocate(const int           descriptor,
             const int           mode,
             const off_t         begin,
             const std::uint64_t size)
    {
      return fallocate(descriptor, mode, begin, off_t(size)) == 0 ||
             errno == EOPNOTSUPP || errno == ENOSYS || errno == ENODEV;
    }



    /// Collective. Return the checksum of the first bytes of a file, read as
    /// doubles, the last of which is padded with zeros.
    std::uint64_t
    checksum_of_file(const std::string  &file,
                     const std::uint64_t n_bytes,
                     const MPI_Comm      comm)
    {
      const auto    share = share_of((n_bytes + 7) / 8, comm);
      std::uint64_t own   = 0;
      run_on_all(comm, [&]() {
        if (share.first == share.second)
          return;
        std::ifstream in(file, std::ios::binary);
        in.seekg(8 * share.first);
        std::vector<double> values;
        for (std::uint64_t at = share.first; at < share.second; at += piece)
          {
            values.assign(std::min(piece, share.second - at), 0.);
            const std::uint64_t wanted =
              std::min(8 * values.size(), n_bytes - 8 * at);
            in.read(reinterpret_cast<char *>(values.data()), wanted);
            Require(std::uint64_t(in.gcount()) == wanted,
                    "Cannot read <" + file + ">: " + std::strerror(errno) +
                      ".");
            own += checksum(values, at);
          }
      });
      return Utilities::MPI::sum(own, comm);
    }
  } // namespace



  std::string
  system_reason(const std::string &file)
  {
    const int descriptor = open(file.c_str(), O_WRONLY | O_APPEND);
    int       error      = descriptor < 0 ? errno : 0;
    errno                = 0;
    if (descriptor >= 0)
      {
        const std::vector<char> zeros(1 << 16, 0);
        if (write(descriptor, zeros.data(), zeros.size()) !=
            ssize_t(zeros.size()))
          error = errno != 0 ? errno : ENOSPC;
        else if (fsync(descriptor) != 0)
          error = errno;
        close(descriptor);
      }
    return error == 0 ? "" : std::string(std::strerror(error)) + ". ";
  }



  void
  make_file(const std::string &file, const std::uint64_t size)
  {
    errno = 0;
    const int descriptor =
      open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    Require(descriptor >= 0, write_error(file));
    const bool        has_room = allocate(descriptor, 0, 0, size);
    const std::string message  = write_error(file);
    close(descriptor);
    if (!has_room)
      unlink(file.c_str());
    Require(has_room, message);
  }



  void
  write_to_disk(const std::string &file)
  {
    const int descriptor = open(file.c_str(), O_RDONLY);
    if (descriptor < 0)
      return;
    const int result = fsync(descriptor);
    close(descriptor);
    Require(result == 0, write_error(file));
  }



  void
  write_together(const std::string              &file,
                 const std::vector<std::string> &own,
                 const MPI_Comm                  comm)
  {
    std::uint64_t own_size = 0;
    for (const std::string &text : own)
      own_size += text.size();
    const std::uint64_t begin = sum_before(own_size, comm);
    const std::uint64_t size  = Utilities::MPI::sum(own_size, comm);
    run_on_first(comm, [&]() { make_file(file, size); });
    run_on_all(comm, [&]() {
      if (own_size == 0)
        return;
      errno = 0;
      // A network file system may not know yet that the file is there.
      const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT, 0666);
      Require(descriptor >= 0, write_error(file));
      std::uint64_t done = 0;
      ssize_t       n    = 1;
      for (const std::string &text : own)
        for (std::size_t at = 0; n > 0 && at < text.size(); at += n, done += n)
          n = std::max<ssize_t>(0,
                                pwrite(descriptor,
                                       text.data() + at,
                                       text.size() - at,
                                       off_t(begin + done)));
      std::string message = done < own_size ? write_error(file) : "";
      if (close(descriptor) != 0 && message.empty())
        message = write_error(file);
      Require(message.empty(), message);
    });
  }



  std::pair<std::uint64_t, std::uint64_t>
  share_of(const std::uint64_t n, const MPI_Comm comm)
  {
    const std::uint64_t n_processes = Utilities::MPI::n_mpi_processes(comm);
    const std::uint64_t process     = Utilities::MPI::this_mpi_process(comm);
    // n * process / n_processes might overflow.
    const auto begin = [&](const std::uint64_t k) {
      return n / n_processes * k + std::min(n % n_processes, k);
    };
    return {begin(process), begin(process + 1)};
  }



  std::uint64_t
  checksum(const std::vector<double> &values, const std::uint64_t first)
  {
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k)
      {
        std::uint64_t bits;
        std::memcpy(&bits, &values[k], sizeof(bits));
        sum += mixed_bits(bits + 0x9e3779b97f4a7c15ull * (first + k + 1));
      }
    return sum;
  }



  std::uint64_t
  checksum(const std::string &text, const std::uint64_t before)
  {
    std::uint64_t sum = mixed_bits(before + text.size());
    for (const unsigned char c : text)
      sum = mixed_bits(sum + c);
    return sum;
  }



  void
  seal_file(const std::string &file, const MPI_Comm comm)
  {
    std::uint64_t n_bytes = 0;
    run_on_first(comm, [&]() { n_bytes = std::filesystem::file_size(file); });
    n_bytes                 = Utilities::MPI::broadcast(comm, n_bytes);
    const std::uint64_t sum = checksum_of_file(file, n_bytes, comm);
    run_on_first(comm, [&]() {
      errno = 0;
      std::ofstream out(file, std::ios::binary | std::ios::app);
      out << seal_of(n_bytes, sum) << std::flush;
      Require(out, write_error(file));
    });
  }



  void
  check_seal(const std::string &file, const MPI_Comm comm)
  {
    std::uint64_t n_bytes = 0;
    std::string   seal(seal_size, ' ');
    run_on_first(comm, [&]() {
      errno = 0;
      std::ifstream in(file, std::ios::binary);
      Require(in, "Cannot read <" + file + ">: " + std::strerror(errno) + ".");
      Require(std::filesystem::is_regular_file(file),
              "Cannot read <" + file + ">, which is not a regular file.");
      n_bytes = std::filesystem::file_size(file);
      if (n_bytes >= seal_size)
        {
          n_bytes -= seal_size;
          in.seekg(n_bytes);
          in.read(&seal[0], seal_size);
        }
      Require(seal.rfind(seal_begin, 0) == 0,
              "Cannot read <" + file +
                ">, which does not end with its checksum: it is truncated, "
                "was not written by this program, or comes from a version "
                "that wrote no checksums.");
    });
    n_bytes                 = Utilities::MPI::broadcast(comm, n_bytes);
    const std::uint64_t sum = checksum_of_file(file, n_bytes, comm);
    run_on_first(comm, [&]() {
      Require(seal == seal_of(n_bytes, sum),
              "Cannot read <" + file +
                ">, which has been changed: it does not have the checksum at "
                "its end.");
    });
  }
} // namespace greville
