// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/memory.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <sstream>
#include <sys/resource.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The minimum memory of mesh, spline space and fields, measured with order
    // 1, lumped mass and a body of few points.
    constexpr double bytes_per_cell_2d = 900., bytes_per_cell_3d = 1400.;

    // deal.II counts the cells of a process with 32 bits.
    constexpr double max_cells_of_process = 4e9;



    /// Return the bytes that are still available to programs on this machine,
    /// and to this program.
    double
    free_memory()
    {
      double        result = std::numeric_limits<double>::max();
      std::ifstream file("/proc/meminfo");
      std::string   line;
      while (std::getline(file, line))
        {
          std::istringstream words(line);
          std::string        name;
          double             kilobytes;
          if (words >> name >> kilobytes && name == "MemAvailable:")
            result = 1024. * kilobytes;
        }
      rlimit limit;
      if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        {
          Utilities::System::MemoryStats used;
          Utilities::System::get_memory_stats(used);
          result =
            std::min(result, double(limit.rlim_cur) - 1024. * used.VmSize);
        }
      return result;
    }



    std::string
    gigabytes(const double bytes)
    {
      return rounded(bytes * 1e-9, 3) + " GB";
    }
  } // namespace



  void
  check_memory_of_cells(const double       n_cells,
                        const unsigned int dim,
                        const std::string &parameter,
                        const MPI_Comm     comm)
  {
    MPI_Comm machine;
    MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    const double part = double(Utilities::MPI::n_mpi_processes(machine)) /
                        Utilities::MPI::n_mpi_processes(comm);
    MPI_Comm_free(&machine);
    const double bytes =
      n_cells * (dim == 2 ? bytes_per_cell_2d : bytes_per_cell_3d);
    const double       available = free_memory();
    std::ostringstream message;
    if (part * bytes > available || n_cells > max_cells_of_process)
      message << parameter << ": " << n_cells << " cells need at least "
              << gigabytes(bytes) << " of memory, and " << gigabytes(available)
              << " are free on a machine that holds " << 100. * part
              << " % of them. Take fewer cells.";
    throw_on_all(message.str(), comm);
  }



  std::optional<unsigned long>
  allocated_memory()
  {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
#else
    return {};
#endif
  }



  void
  return_free_memory()
  {
#ifdef __GLIBC__
    // Large arrays get memory of their own, but not the buffers of each step,
    // and the heap shrinks only by much, since new pages cost time.
    mallopt(M_MMAP_MAX, 65536);
    mallopt(M_MMAP_THRESHOLD, 1 << 22);
    mallopt(M_TRIM_THRESHOLD, 1 << 26);
#endif
  }
} // namespace greville
