// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace greville
{
  /// A named field of points, in addition to the numbers that all points have.
  struct PointField
  {
    std::string  name;
    unsigned int first;
    unsigned int n_components;
  };



  /**
   * The positions of the numbers of a material point, counted in doubles from
   * the first number of the point. Symmetric tensors are stored as xx, yy, zz,
   * xy (in 3D then xz, yz), the deformation gradient row by row, in 2D followed
   * by F_zz. The numbers that all points have are followed by named fields: the
   * history variables of the material, and as many of the following as are
   * needed:
   *   "affine", dim x dim numbers: the matrix of APIC or Taylor, 1 / s,
   *   "load", dim numbers: the acceleration by loads, m / s^2,
   *   "initial_F", dim x dim numbers: the initial F (in 2D in the plane),
   *   "projected_J", one number: the ratio of volumes that the material uses
   *     if changes of volume are projected (VolumeProjection),
   *   "domain", dim numbers: half of the edges of the box around the point in
   *     the stress-free state, over which gradients are averaged, m,
   *   "radius0", one number: the distance r of an axisymmetric point from the
   *     axis in the stress-free state, m; r is x, and F_zz = r / radius0,
   * and further fields, for instance of a PointLoad.
   */
  template <int dim>
  class PointLayout
  {
  public:
    static constexpr unsigned int n_stress = dim == 2 ? 4 : 6;
    static constexpr unsigned int n_F      = dim == 2 ? 5 : 9;

    /// x, m.
    static constexpr unsigned int position = 0;
    /// v, m / s.
    static constexpr unsigned int velocity = position + dim;
    /// m, kg (in 2D per metre of thickness, or per radian).
    static constexpr unsigned int mass = velocity + dim;
    /// V0, volume of the stress-free state, m^3 (in 2D m^2, or m^3 per radian).
    static constexpr unsigned int volume0 = mass + 1;
    /// J = V / V0.
    static constexpr unsigned int J = volume0 + 1;
    /// Cauchy stress, Pa.
    static constexpr unsigned int stress = J + 1;
    /// rho c^2 of the fastest wave, Pa (MaterialPoint::wave_modulus).
    static constexpr unsigned int wave_modulus = stress + n_stress;
    /// Deformation gradient from the stress-free state.
    static constexpr unsigned int F = wave_modulus + 1;
    /// The initial position, m.
    static constexpr unsigned int reference = F + n_F;
    /// A number that identifies the point within its body. Initial points have
    /// numbers below id_of_parts. A part of a divided point has the numbers of
    /// its ancestors and its own among their parts, from 1, as digits of base
    /// 2^dim + 1 above the number of the initial point.
    static constexpr unsigned int id          = reference + dim;
    static constexpr double       id_of_parts = 4294967296.;

    /// Return the id of the initial point of which a point is a part.
    static double
    initial_id(const double id)
    {
      return id < id_of_parts ? id : std::fmod(id, id_of_parts);
    }
    /// The number of doubles that every point has.
    static constexpr unsigned int n_fixed = id + 1;

    /// Return the position of entry (i, j) of a stress or deformation gradient,
    /// relative to its first number.
    static constexpr unsigned int
    stress_index(const unsigned int i, const unsigned int j)
    {
      return i == j ? i : (dim == 2 ? 3 : 2 + i + j);
    }

    static constexpr unsigned int
    F_index(const unsigned int i, const unsigned int j)
    {
      return dim == 2 && i == 2 && j == 2 ? 4 : i * dim + j;
    }

    /// The position of the history variables.
    static constexpr unsigned int state = n_fixed;

    /// Set up a layout with the history variables of a material as fields of
    /// one component.
    PointLayout(const std::vector<std::string> &state_names = {});

    /// Add a field, unless one with this name exists, and set the matching
    /// member below.
    void
    add(const std::string &name, const unsigned int n_components);

    /// Return a history variable or added field, nullptr if there is none.
    const PointField *
    find(const std::string &name) const;

    /// Return the first number of an existing field.
    unsigned int
    first(const std::string &name) const;

    /// Return the names of the numbers of a point in their order: "position_0",
    /// ..., "mass", ...
    std::vector<std::string>
    names() const;

    unsigned int n_state = 0;
    /// The number of doubles of a point.
    unsigned int size = n_fixed;
    /// The first number of the position at which basis functions are evaluated:
    /// `position` in updated Lagrangian steps, `reference` in total Lagrangian
    /// steps, whose gradients are with respect to the reference position.
    unsigned int basis_position = position;

    /// The first number of "initial_F", 0 if there is none. Points of total
    /// Lagrangian steps with initial stresses have it. F F_initial^-1 is the
    /// deformation since the configuration of their basis functions.
    unsigned int initial_F = 0;

    /// The number of "projected_J", 0 if there is none. J and F are never
    /// projected: they result from the motion.
    unsigned int projected_J = 0;

    /// The number of "radius0", 0 in plane strain.
    unsigned int radius0 = 0;

    bool
    is_axisymmetric() const
    {
      return dim == 2 && radius0 != 0;
    }

    /**
     * Return the volume per area of the coordinate plane at @p x: the radius of
     * axisymmetric points, whose quantities are per radian, otherwise 1.
     */
    template <typename Position>
    double
    thickness(const Position &x) const
    {
      return is_axisymmetric() ? x[0] : 1.;
    }

    /// The first number of "domain", 0 if there is none.
    unsigned int domain = 0;

    bool
    is_total_lagrangian() const
    {
      return basis_position == reference;
    }

  private:
    std::vector<PointField> all_fields;
  };
} // namespace greville
