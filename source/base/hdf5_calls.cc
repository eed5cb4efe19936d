// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/hdf5_calls.h>

#include <algorithm>
#include <cstdlib>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return HDF5's reason for the failure of the last call: its innermost
    /// message, with the system's reason if there is one.
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
  } // namespace



  HDF5Handle::HDF5Handle(const hid_t id, herr_t (*close)(hid_t))
    : id(id)
    , close(close)
  {
    Require(id >= 0, reason_of_hdf5());
  }



  HDF5Handle::~HDF5Handle()
  {
    if (id >= 0)
      close(id);
  }



  void
  HDF5Handle::finish()
  {
    const hid_t closed = id;
    id                 = -1;
    check_hdf5(close(closed));
  }



  HDF5Silence::HDF5Silence()
  {
    // Otherwise, HDF5 would retry a failed write at the end of the program,
    // after MPI has ended.
    static const herr_t no_end = H5dont_atexit();
    (void)no_end;
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }



  HDF5Silence::~HDF5Silence()
  {
    H5Eset_auto2(H5E_DEFAULT, function, data);
  }



  void
  check_hdf5(const herr_t result)
  {
    Require(result >= 0, reason_of_hdf5());
  }



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



  HDF5Handle
  hdf5_access(const MPI_Comm comm)
  {
    // A component of Open MPI 4.1 for shared file pointers, which HDF5 does not
    // use, overflows for paths of 250 letters. Open MPI reads this variable
    // when it opens its first file.
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
} // namespace greville
