// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/body_list.h>

#include <functional>
#include <string>
#include <vector>

namespace greville
{
  /// A field that points_NNNN.vtu may contain, by its name in `Output/Fields`.
  template <int dim>
  struct OutputField
  {
    std::string name;
    /// The column names in the file, equal for all components of a vector.
    std::vector<std::string> components;
    bool                     is_vector = false;
    /// Write the numbers of a point of body number b.
    std::function<void(const ConstPointRef<dim> p,
                       const Body<dim>         &body,
                       const unsigned int       b,
                       double                  *values)>
      evaluate;
  };



  /// Return the fields @p names of the points of @p bodies on a process. F is
  /// the deformation gradient, strain is Green's strain (F^T F - 1) / 2, size
  /// is the edge of a cube with the volume of a point, m, and history contains
  /// the history variables of the materials. Each history variable is a field
  /// of all points, which is zero if the material of a point does not have it.
  template <int dim>
  std::vector<OutputField<dim>>
  point_fields(const std::vector<std::string> &names,
               const BodyList<dim>            &bodies,
               const unsigned int              process);

  /// Return the names of the entries of the stress, or of another symmetric
  /// tensor, in the order of PointLayout: NAME_xx, ...
  template <int dim>
  std::vector<std::string>
  symmetric_entries(const std::string &name);

  /// Return the names of the entries of the deformation gradient: F_xx, ...
  template <int dim>
  std::vector<std::string>
  entries_of_F();

  /// Return all names of fields, separated by '|'.
  std::string
  output_field_names();
} // namespace greville
