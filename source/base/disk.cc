// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/disk.h>
#include <greville/base/parameters.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <vector>

namespace greville
{
  using namespace dealii;

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
    // Not all file systems can tell.
    const bool has_room = fallocate(descriptor, 0, 0, off_t(size)) == 0 ||
                          errno == EOPNOTSUPP || errno == ENOSYS ||
                          errno == ENODEV;
    const std::string message = write_error(file);
    close(descriptor);
    if (!has_room)
      unlink(file.c_str());
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
} // namespace greville
