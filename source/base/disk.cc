// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/errors.h>
#include <greville/base/mixed_bits.h>
#include <greville/base/parameters.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sstream>
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



    /**
     * Return whether there is room on the disk, which not all file systems can
     * tell.
     */
    bool
    allocate(const int           descriptor,
             const int           mode,
             const off_t         begin,
             const std::uint64_t size)
    {
      return fallocate(descriptor, mode, begin, off_t(size)) == 0 ||
             errno == EOPNOTSUPP || errno == ENOSYS || errno == ENODEV;
    }



    /**
     * Collective. Return the checksum of the first bytes of a file, read as
     * doubles, the last of which is padded with zeros.
     */
    std::uint64_t
    checksum_of_file(const std::string  &file,
                     const std::uint64_t n_bytes,
                     const MPI_Comm      comm)
    {
      const auto    share = share_of((n_bytes + 7) / 8, comm);
      std::uint64_t own   = 0;
      run_on_all(
        [&]() {
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
              AssertThrow(std::uint64_t(in.gcount()) == wanted,
                          ExcMessage("Cannot read <" + file +
                                     ">: " + std::strerror(errno) + "."));
              own += checksum(values, at);
            }
        },
        comm);
      std::uint64_t sum = 0;
      MPI_Allreduce(&own, &sum, 1, MPI_UINT64_T, MPI_SUM, comm);
      return sum;
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
    AssertThrow(descriptor >= 0, ExcMessage(write_error(file)));
    const bool        has_room = allocate(descriptor, 0, 0, size);
    const std::string message  = write_error(file);
    close(descriptor);
    if (!has_room)
      unlink(file.c_str());
    AssertThrow(has_room, ExcMessage(message));
  }



  void
  reserve_room(const std::string &file, const std::uint64_t size)
  {
    errno                = 0;
    const int descriptor = open(file.c_str(), O_WRONLY);
    AssertThrow(descriptor >= 0, ExcMessage(write_error(file)));
    const off_t end = lseek(descriptor, 0, SEEK_END);
    const bool  has_room =
      end < 0 || allocate(descriptor, FALLOC_FL_KEEP_SIZE, end, size);
    const std::string message = write_error(file);
    close(descriptor);
    AssertThrow(has_room, ExcMessage(message));
  }



  void
  write_to_disk(const std::string &file)
  {
    const int descriptor = open(file.c_str(), O_RDONLY);
    if (descriptor < 0)
      return;
    const int result = fsync(descriptor);
    close(descriptor);
    AssertThrow(result == 0, ExcMessage(write_error(file)));
  }



  namespace
  {
    const std::string     journal_begin    = "Greville: journal\n";
    constexpr std::size_t journal_end_size = 17; // bytes



    std::string
    end_of_journal(const std::string &text)
    {
      char end[journal_end_size + 1];
      std::snprintf(end,
                    sizeof(end),
                    "\n%016llx",
                    static_cast<unsigned long long>(checksum(text, 0)));
      return end;
    }



    /**
     * Return the gaps between ranges, up to a length.
     */
    std::vector<ByteRange>
    gaps_between(std::vector<ByteRange> ranges, const std::uint64_t length)
    {
      std::sort(ranges.begin(),
                ranges.end(),
                [](const ByteRange &a, const ByteRange &b) {
                  return a.begin < b.begin;
                });
      ranges.push_back({length, length});
      std::vector<ByteRange> result;
      std::uint64_t          at = 0;
      for (const ByteRange &range : ranges)
        {
          if (at < std::min(range.begin, length))
            result.push_back({at, std::min(range.begin, length)});
          at = std::max(at, range.end);
        }
      return result;
    }
  } // namespace



  void
  write_journal(const std::string            &journal,
                const std::string            &file,
                const std::vector<ByteRange> &kept)
  {
    errno                      = 0;
    const std::uint64_t length = std::filesystem::file_size(file);
    const auto          parts  = gaps_between(kept, length);
    std::string         text   = journal_begin + std::to_string(length) + ' ' +
                       std::to_string(parts.size()) + '\n';
    for (const ByteRange &part : parts)
      text +=
        std::to_string(part.begin) + ' ' + std::to_string(part.end) + '\n';
    std::ifstream in(file, std::ios::binary);
    for (const ByteRange &part : parts)
      {
        std::string bytes(part.end - part.begin, '\0');
        in.seekg(part.begin);
        in.read(&bytes[0], bytes.size());
        text += bytes;
      }
    AssertThrow(in,
                ExcMessage("Cannot read <" + file +
                           ">: " + std::strerror(errno) + "."));
    try
      {
        write_atomically(journal, text + end_of_journal(text));
      }
    catch (const std::exception &)
      {
        unlink((journal + ".tmp").c_str());
        throw;
      }
  }



  void
  take_back(const std::string &journal, const std::string &file)
  {
    std::ostringstream content;
    content << std::ifstream(journal, std::ios::binary).rdbuf();
    std::string text = content.str();
    AssertThrow(text.size() > journal_end_size &&
                  text.rfind(journal_begin, 0) == 0,
                ExcMessage("<" + journal + "> is no complete journal."));
    const std::string end = text.substr(text.size() - journal_end_size);
    text.resize(text.size() - journal_end_size);
    AssertThrow(end == end_of_journal(text),
                ExcMessage("<" + journal + "> is no complete journal."));
    std::istringstream in(text.substr(journal_begin.size()));
    std::uint64_t      length = 0, n_parts = 0;
    in >> length >> n_parts;
    std::vector<ByteRange> parts(n_parts);
    std::uint64_t          n_bytes = 0;
    for (ByteRange &part : parts)
      {
        in >> part.begin >> part.end;
        n_bytes += part.end - part.begin;
      }
    std::uint64_t at = text.size() - n_bytes;
    errno            = 0;
    std::fstream out(file, std::ios::binary | std::ios::in | std::ios::out);
    for (const ByteRange &part : parts)
      {
        out.seekp(part.begin);
        out.write(text.data() + at, part.end - part.begin);
        at += part.end - part.begin;
      }
    out.close();
    AssertThrow(out, ExcMessage(write_error(file)));
    std::filesystem::resize_file(file, length);
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
    run_on_first([&]() { n_bytes = std::filesystem::file_size(file); }, comm);
    n_bytes                 = Utilities::MPI::broadcast(comm, n_bytes);
    const std::uint64_t sum = checksum_of_file(file, n_bytes, comm);
    run_on_first(
      [&]() {
        errno = 0;
        std::ofstream out(file, std::ios::binary | std::ios::app);
        out << seal_of(n_bytes, sum) << std::flush;
        AssertThrow(out, ExcMessage(write_error(file)));
      },
      comm);
  }



  void
  check_seal(const std::string &file, const MPI_Comm comm)
  {
    std::uint64_t n_bytes = 0;
    std::string   seal(seal_size, ' ');
    run_on_first(
      [&]() {
        errno = 0;
        std::ifstream in(file, std::ios::binary);
        AssertThrow(in,
                    ExcMessage("Cannot read <" + file +
                               ">: " + std::strerror(errno) + "."));
        AssertThrow(std::filesystem::is_regular_file(file),
                    ExcMessage("Cannot read <" + file +
                               ">, which is no regular file."));
        n_bytes = std::filesystem::file_size(file);
        if (n_bytes >= seal_size)
          {
            n_bytes -= seal_size;
            in.seekg(n_bytes);
            in.read(&seal[0], seal_size);
          }
        AssertThrow(seal.rfind(seal_begin, 0) == 0,
                    ExcMessage("Cannot read <" + file +
                               ">, which does not end with its checksum: it "
                               "is truncated, is no file of HDF5 by this "
                               "program, or comes from a version that wrote "
                               "no such checksums."));
      },
      comm);
    n_bytes                 = Utilities::MPI::broadcast(comm, n_bytes);
    const std::uint64_t sum = checksum_of_file(file, n_bytes, comm);
    run_on_first(
      [&]() {
        AssertThrow(seal == seal_of(n_bytes, sum),
                    ExcMessage("Cannot read <" + file +
                               ">, which has been changed: it does not have "
                               "the checksum at its end."));
      },
      comm);
  }
} // namespace greville
