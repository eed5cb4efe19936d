// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <hdf5.h>
#include <string>

/// Functions for reading and writing HDF5 files. All of them throw
/// dealii::ExcMessage with HDF5's reason. dealii::HDF5 checks results by Assert
/// only, so that a full disk would pass unnoticed in release mode, and cannot
/// list attributes and data sets.
namespace greville
{
  /// An object of HDF5, with the function that closes it. Throws if HDF5 has
  /// not made the object.
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

    /// Close the object, and throw if this fails, since closing may write data.
    void
    finish();

  private:
    hid_t id;
    herr_t (*close)(hid_t);
  };



  /// Suppresses, during its lifetime, the error messages that HDF5 prints on
  /// all processes.
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



  /// Throw if the @p result of a call indicates a failure.
  void
  check_hdf5(const herr_t result);

  void
  write_hdf5_text(const hid_t        object,
                  const std::string &name,
                  const std::string &text);

  std::string
  read_hdf5_text(const hid_t object, const std::string &name);

  /// Return the property list of HDF5 for files shared by all processes.
  HDF5Handle
  hdf5_access(const MPI_Comm comm);
} // namespace greville
