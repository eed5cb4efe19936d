// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <greville/points/point_layout.h>

#include <cmath>
#include <type_traits>

namespace greville
{
  /// A pointer to a point in the storage of MaterialPoints, or in an array of
  /// its numbers (stride 1), with named access; see PointLayout for units.
  /// Copying it does not copy the point. The point of a `const PointRef` may be
  /// changed, but not the point of a ConstPointRef.
  template <int dim, typename Number = double>
  class PointRef
  {
  public:
    using Layout = PointLayout<dim>;

    explicit PointRef(Number *values, const unsigned int stride = 1)
      : values(values)
      , stride(stride)
    {}

    /// Convert a PointRef to a ConstPointRef.
    template <
      typename Other,
      typename = std::enable_if_t<std::is_convertible_v<Other *, Number *>>>
    PointRef(const PointRef<dim, Other> &other)
      : values(other.values)
      , stride(other.stride)
    {}

    /// Return number k of the point, for k that is known at run time only.
    Number &
    operator[](const unsigned int k) const
    {
      return values[k * stride];
    }

    Number &
    position(const unsigned int d) const
    {
      return (*this)[Layout::position + d];
    }

    dealii::Point<dim>
    position() const
    {
      return dealii::Point<dim>(vector(Layout::position));
    }

    Number &
    velocity(const unsigned int d) const
    {
      return (*this)[Layout::velocity + d];
    }

    dealii::Tensor<1, dim>
    velocity() const
    {
      return vector(Layout::velocity);
    }

    Number &
    reference(const unsigned int d) const
    {
      return (*this)[Layout::reference + d];
    }

    dealii::Point<dim>
    reference() const
    {
      return dealii::Point<dim>(vector(Layout::reference));
    }

    /// Return the position at which basis functions are evaluated.
    dealii::Point<dim>
    basis_position(const Layout &layout) const
    {
      return dealii::Point<dim>(vector(layout.basis_position));
    }

    Number &
    mass() const
    {
      return (*this)[Layout::mass];
    }

    Number &
    volume0() const
    {
      return (*this)[Layout::volume0];
    }

    Number &
    J() const
    {
      return (*this)[Layout::J];
    }

    /// Return the volume V = J V0.
    double
    volume() const
    {
      return volume0() * J();
    }

    /// Return the edge of a square or cube of the point's volume; for
    /// axisymmetric points, of a square in the plane of coordinates.
    double
    extent(const Layout &layout) const
    {
      return dim == 2 ? std::sqrt(volume() / layout.thickness(position()))
                      : std::cbrt(volume());
    }

    Number &
    wave_modulus() const
    {
      return (*this)[Layout::wave_modulus];
    }

    Number &
    id() const
    {
      return (*this)[Layout::id];
    }

    /// Return component k of the n_stress stored components.
    Number &
    stress(const unsigned int k) const
    {
      return (*this)[Layout::stress + k];
    }

    dealii::SymmetricTensor<2, 3>
    stress() const
    {
      dealii::SymmetricTensor<2, 3> result;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          if (dim == 3 || i == j || j < 2)
            result[i][j] = stress(Layout::stress_index(i, j));
      return result;
    }

    void
    set_stress(const dealii::SymmetricTensor<2, 3> &sigma) const
    {
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          if (dim == 3 || i == j || j < 2)
            stress(Layout::stress_index(i, j)) = sigma[i][j];
    }

    /// Return entry (i, j) with i, j < dim, or F_zz.
    Number &
    F(const unsigned int i, const unsigned int j) const
    {
      return (*this)[Layout::F + Layout::F_index(i, j)];
    }

    dealii::Tensor<2, 3>
    F() const
    {
      dealii::Tensor<2, 3> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] = F(i, j);
      result[2][2] = F(2, 2);
      return result;
    }

    void
    set_F(const dealii::Tensor<2, 3> &F_3d) const
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          F(i, j) = F_3d[i][j];
      F(2, 2) = F_3d[2][2];
    }

    /// Return the dim, or dim x dim, numbers from number @p first on.
    dealii::Tensor<1, dim>
    vector(const unsigned int first) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = (*this)[first + d];
      return result;
    }

    dealii::Tensor<2, dim>
    matrix(const unsigned int first) const
    {
      dealii::Tensor<2, dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] = (*this)[first + i * dim + j];
      return result;
    }

  private:
    Number      *values;
    unsigned int stride;

    template <int, typename>
    friend class PointRef;
  };

  template <int dim>
  using ConstPointRef = PointRef<dim, const double>;
} // namespace greville
