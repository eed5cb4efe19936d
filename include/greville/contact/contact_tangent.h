// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_contact_contact_tangent_h
#define greville_contact_contact_tangent_h

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <greville/base/compatibility.h>

#include <cstdint>
#include <vector>

namespace greville
{
  /**
   * The derivative of the forces of an AveragedContact by displacements u of
   * its points, where hat functions, areas and normals do not change:
   * @f[
   *   F_k = -w_k D_k \Bigl(
   *     \frac{1}{w^A_k} \sum_{s \in A} a_s \psi_k(x_s) u_s
   *     - \frac{1}{w^B_k} \sum_{s \in B} a_s \psi_k(x_s) u_s \Bigr), \qquad
   *   f_s = \pm \frac{a_s \psi_k(x_s)}{w^{A, B}_k} F_k,
   * @f]
   * with D_k of a key, Pa / m: the stiffness of its pressure along its normal,
   * and of the shear stress along the plane. It is symmetric and positive, but
   * for a key that slides: its shear stress changes with the pressure, and with
   * displacements across the direction of sliding. Without a side 1 the second
   * sum is zero.
   *
   * It couples all points with a common key, on whatever processes they are:
   * keys have owners, to which sums go.
   */
  template <int dim>
  class ContactTangent
  {
  public:
    /**
     * Collective. The forces that displacements of all points give to them, in
     * the order of the points.
     */
    void
    multiply(const std::vector<dealii::Tensor<1, dim>> &displacements,
             std::vector<dealii::Tensor<1, dim>>       &forces) const;

    /// A key that belongs to this process.
    struct Key
    {
      double                 inverse_weights[2] = {0., 0.};
      dealii::Tensor<2, dim> stiffness; // w_k D_k
    };

    /**
     * Collective. Begin with the keys of this process, which have the numbers
     * from @p first on, and with all @p numbers of keys that points here have.
     */
    void
    begin(std::vector<Key>                &&own_keys,
          const std::uint64_t               first,
          const std::vector<std::uint64_t> &numbers,
          const MPI_Comm                    comm);

    /// The next point.
    void
    add_point(const unsigned int side);

    /// That this point has the key of a number.
    void
    add_share(const std::uint64_t number, const double weight);

  private:
    /// Of a point and a key that it has: the place of the key in the vector,
    /// and a_s psi_k.
    struct Share
    {
      unsigned int place;
      double       weight;
    };

    static constexpr unsigned int size = 2 * dim; // of a key in the vector

    std::vector<Key>           keys;
    std::vector<unsigned char> sides;
    std::vector<std::size_t>   ends; // of the shares of points
    std::vector<Share>         shares;
    /// Sums of the displacements of both sides, and then forces.
    mutable VectorType values;
  };
} // namespace greville

#endif
