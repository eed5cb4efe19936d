#ifndef greville_particles_reconstruction_h
#define greville_particles_reconstruction_h

#include <greville/particles/material_points.h>

namespace greville
{
  /**
   * Taylor least squares (E. Wobbes, M. Moeller, V. Galavi, C. Vuik,
   * Conservative Taylor least squares reconstruction with application to
   * material point methods, 2019): in each full cell, a quantity f of the
   * points becomes the polynomial
   *   f(t) = mean(f) + sum_k a_k psi_k(t),   t = (x - centre) / h,
   * with psi = t_d, t_d t_e, t_d^2 - 1/12, whose mean over the cell is zero. So
   * the integral over the cell is that of the points, mean(f) |cell| = sum_p
   * V_p f_p, for any a_k; these fit the values at the points by least squares.
   * Reconstructed are density, momentum, stress and load, which conserves mass
   * and momentum.
   *
   * A cell is full where its points have at least 90 % of its volume and where
   * there are more of them than polynomials. In directions with too few
   * different positions the polynomials are left out. Other cells keep their
   * points.
   */
  template <int dim>
  class Reconstruction
  {
  public:
    static constexpr double full = 0.9;

    /**
     * @p n_points_1d Gauss points per direction carry the reconstruction.
     */
    Reconstruction(const unsigned int n_points_1d = 1)
      : n_q(n_points_1d)
    {}

    /**
     * Overwrite @p result with points that integrate like @p points: Gauss
     * points in full cells, the points themselves in others. Their position,
     * velocity, mass, volume, stress and load are set.
     */
    void
    reconstruct(const MaterialPoints<dim> &points,
                MaterialPoints<dim>       &result) const;

  private:
    unsigned int n_q;
  };
} // namespace greville

#endif
