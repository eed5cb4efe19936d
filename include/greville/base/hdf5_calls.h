// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_hdf5_calls_h
#define greville_base_hdf5_calls_h

#include <deal.II/base/mpi.h>

#include <functional>
#include <hdf5.h>
#include <string>
#include <vector>

/**
 * What the sources that read and write files of HDF5 share. All of it throws
 * dealii::ExcMessage with what HDF5 says.
 */
namespace greville
{
  /**
   * What HDF5 makes, with the function that closes it. Throws where HDF5 has
   * not made it.
   */
  class HDF5Handle
  {
  public:
    HDF5Handle(const hid_t id, herr_t (*close)(hid_t));

    HDF5Handle(const HDF5Handle &) = delete;

    ~HDF5Handle();

    operator hid_t() const
    {
      return id;
    }

    /**
     * Close it, and throw where that fails: data may be written by it.
     */
    void
    finish();

  private:
    hid_t id;
    herr_t (*close)(hid_t);
  };



  /**
   * HDF5 prints what goes wrong, on all processes; while this object lives it
   * does not.
   */
  class HDF5Silence
  {
  public:
    HDF5Silence();

    HDF5Silence(const HDF5Silence &) = delete;

    ~HDF5Silence();

  private:
    H5E_auto2_t function = nullptr;
    void       *data     = nullptr;
  };



  /**
   * Throw where the @p result of a call says that it has failed.
   */
  void
  check_hdf5(const herr_t result);

  /**
   * Write and read an attribute that is a text.
   */
  void
  write_hdf5_text(const hid_t        object,
                  const std::string &name,
                  const std::string &text);

  std::string
  read_hdf5_text(const hid_t object, const std::string &name);

  /**
   * The names of the data sets and groups in a group.
   */
  std::vector<std::string>
  hdf5_links(const hid_t group);

  /**
   * The list of HDF5 for files of all processes.
   */
  HDF5Handle
  hdf5_access(const MPI_Comm comm);

  /**
   * One call of HDF5 that reads or writes: the rows of this process from number
   * @p begin on have their place in @p file.
   */
  using HDF5Transfer = std::function<herr_t(const hid_t         memory,
                                            const hid_t         file,
                                            const hid_t         list,
                                            const unsigned long begin)>;

  /**
   * Collective. Read or write the rows [first, first + n_rows) of a data set of
   * @p n_columns, or of one without columns for 0, by @p transfer. All
   * processes call it equally often, and throw together.
   */
  void
  transfer_hdf5_rows(const hsize_t       first,
                     const hsize_t       n_rows,
                     const hsize_t       n_columns,
                     const hid_t         data_set,
                     const MPI_Comm      comm,
                     const HDF5Transfer &transfer);
} // namespace greville

#endif
