// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <greville/base/compatibility.h>

#include <cstdint>
#include <vector>

namespace greville
{
  /**
   * The derivative of the forces of an AveragedContact by displacements u of
   * its points and by their pore water pressures p, for constant hat functions,
   * areas and normals:
   * @f[
   *   F_k = -w_k D_k \Bigl(
   *     \frac{1}{w^A_k} \sum_{s \in A} a_s \psi_k(x_s) u_s
   *     - \frac{1}{w^B_k} \sum_{s \in B} a_s \psi_k(x_s) u_s \Bigr)
   *     - w_k \tau'_k d_k \frac{\sum_s a_s \psi_k(x_s) p_s}
   *                            {\sum_s a_s \psi_k(x_s)}, \qquad
   *   f_s = \pm \frac{a_s \psi_k(x_s)}{w^{A, B}_k} F_k,
   * @f]
   * with the stiffness D_k of a key, Pa / m, of its pressure along its normal
   * and of the shear stress along the plane, and with the derivative tau'_k of
   * its strength by the effective pressure if it slides in the direction d_k,
   * otherwise 0. D_k is symmetric and positive except for sliding keys, whose
   * shear stress changes with the pressure and with displacements across the
   * direction of sliding. Without a side 1, the second sum is zero. The last
   * sums run over the sides with pores.
   *
   * It couples all points with a common key across processes: each key has an
   * owner, which adds up its sums.
   */
  template <int dim>
  class ContactTangent
  {
  public:
    /// Collective. Compute the forces due to displacements of all points, in
    /// the order of the points, and due to changes of the pore pressure, unless
    /// null.
    void
    multiply(const std::vector<dealii::Tensor<1, dim>> &displacements,
             std::vector<dealii::Tensor<1, dim>>       &forces,
             const std::vector<double> *pore_pressures = nullptr) const;

    /// A key owned by this process.
    struct Key
    {
      double                 inverse_weights[2] = {0., 0.};
      dealii::Tensor<2, dim> stiffness; // w_k D_k
      /// The stiffness without the asymmetric part, which is due to sliding.
      dealii::Tensor<2, dim> symmetric;
      /// The derivative by the mean pore pressure: -w_k tau'_k d_k over the sum
      /// of a_s psi_k.
      dealii::Tensor<1, dim> by_pore_pressure;
    };

    /// Return the keys of this process.
    const std::vector<Key> &
    own_keys() const
    {
      return keys;
    }

    /// Return whether any process has keys.
    bool
    has_keys() const
    {
      return values.size() > 0;
    }

    /// Call visit(k, a_s psi_k) for the global numbers of the keys of a point.
    template <typename Visit>
    void
    for_each_share(const std::size_t point, const Visit &visit) const
    {
      for (std::size_t k = point == 0 ? 0 : ends[point - 1]; k < ends[point];
           ++k)
        visit(values.get_partitioner()->local_to_global(shares[k].place) / size,
              shares[k].weight);
    }

    /// Collective. Set the keys of this process, numbered from @p first on.
    /// @p numbers are the numbers of all keys of its points.
    void
    begin(std::vector<Key>                &&own_keys,
          const std::uint64_t               first,
          const std::vector<std::uint64_t> &numbers,
          const MPI_Comm                    comm);

    /// Add a point of a side, with or without pores.
    void
    add_point(const unsigned int side, const bool has_pores);

    /// Add a key, given by its number, to the last point.
    void
    add_share(const std::uint64_t number, const double weight);

  private:
    /// A point's share of a key: the place of the key in the vector, and a_s
    /// psi_k.
    struct Share
    {
      unsigned int place;
      double       weight;
    };

    static constexpr unsigned int size = 2 * dim + 1; // of a key in the vector

    std::vector<Key>           keys;
    std::vector<unsigned char> sides;
    std::vector<bool>          have_pores; // points
    std::vector<std::size_t>   ends;       // of the shares of points
    std::vector<Share>         shares;
    /// Sums of the displacements of both sides and of the pore pressure, and
    /// then forces.
    mutable VectorType values;
  };
} // namespace greville
