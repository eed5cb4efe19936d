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
   * its points, and by the pressures p of the pore water there, where hat
   * functions, areas and normals do not change:
   * @f[
   *   F_k = -w_k D_k \Bigl(
   *     \frac{1}{w^A_k} \sum_{s \in A} a_s \psi_k(x_s) u_s
   *     - \frac{1}{w^B_k} \sum_{s \in B} a_s \psi_k(x_s) u_s \Bigr)
   *     - w_k \tau'_k d_k \frac{\sum_s a_s \psi_k(x_s) p_s}
   *                            {\sum_s a_s \psi_k(x_s)}, \qquad
   *   f_s = \pm \frac{a_s \psi_k(x_s)}{w^{A, B}_k} F_k,
   * @f]
   * with D_k of a key, Pa / m: the stiffness of its pressure along its normal,
   * and of the shear stress along the plane; and with the derivative of its
   * strength by the effective pressure where it slides in the direction d_k,
   * else 0. D_k is symmetric and positive, but for a key that slides: its shear
   * stress changes with the pressure, and with displacements across the
   * direction of sliding. Without a side 1 the second sum is zero. The last
   * sums are those over the sides that have pores.
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
     * the order of the points, and changes of the pressure of the pores there;
     * null: none.
     */
    void
    multiply(const std::vector<dealii::Tensor<1, dim>> &displacements,
             std::vector<dealii::Tensor<1, dim>>       &forces,
             const std::vector<double> *pore_pressures = nullptr) const;

    /// A key that belongs to this process.
    struct Key
    {
      double                 inverse_weights[2] = {0., 0.};
      dealii::Tensor<2, dim> stiffness; // w_k D_k
      /// That by the mean pressure of the pores: -w_k tau'_k d_k over the sum
      /// of a_s psi_k.
      dealii::Tensor<1, dim> by_pore_pressure;
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

    /// The next point, and whether its side has pores.
    void
    add_point(const unsigned int side, const bool has_pores);

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

    static constexpr unsigned int size = 2 * dim + 1; // of a key in the vector

    std::vector<Key>           keys;
    std::vector<unsigned char> sides;
    std::vector<bool>          have_pores; // points
    std::vector<std::size_t>   ends;       // of the shares of points
    std::vector<Share>         shares;
    /// Sums of the displacements of both sides and of the pressure of the
    /// pores, and then forces.
    mutable VectorType values;
  };
} // namespace greville

#endif
