// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_reconstruction_h
#define greville_points_reconstruction_h

#include <greville/points/material_points.h>
#include <greville/spline/cell_neighbors.h>

namespace greville
{
  /**
   * Quadrature by Gauss points instead of material points: in each full cell, a
   * quantity f of the points becomes the polynomial
   *   f(t) = a_0 + sum_k a_k psi_k(t),   t = (x - centre) / h,
   * with psi = t_d, t_d t_e, t_d^2 - 1/12, whose mean over the cell is zero, so
   * that the integral is a_0 |cell|. Reconstructed are density, momentum,
   * stress and the force of loads, by one of two methods:
   *
   * - conservative Taylor least squares
   *   (@ref Wobbes2019 "Wobbes, Moeller, Galavi and Vuik, 2019"):
   *   for density, momentum and force, a_0 is
   *   sum_p V_p f_p / |cell|, which conserves mass and momentum cell by cell,
   * and the other a_k fit the values at the points by least squares. For stress
   *   a_0 is fitted as well.
   * - Least squares: all a_k are fitted for all quantities. Then the density of
   *   all full cells is multiplied by the number, and their velocity changed by
   *   the constant, that give back the mass and the momentum of all points.
   * This does not see how many points happen to lie in a cell, which makes it
   * the more accurate of both as soon as points move.
   *
   * A cell is full where the volume of its points is at least a given part of
   * its own, where there are more points than polynomials, and where no surface
   * of the body cuts it: all of its neighbours (by a face, an edge or a vertex)
   * hold points of the body, and a layer of cells at an edge of the grid is
   * filled up to there. In directions with too few different positions
   * polynomials are left out. Other cells keep their points: to integrate over
   * all of a cell that is filled in part would be wrong by order h.
   */
  template <int dim>
  class Reconstruction
  {
  public:
    /**
     * @p n_points_1d Gauss points per direction carry the reconstruction.
     */
    Reconstruction(const unsigned int n_points_1d,
                   const bool         conserves_in_cells,
                   const double       full)
      : n_q(n_points_1d)
      , conserves_in_cells(conserves_in_cells)
      , full(full)
    {}

    /**
     * Collective. Overwrite @p result with points that integrate like
     * @p points: Gauss points in full cells, the points themselves in others.
     * Their position, velocity, mass, volume, stress and load are set.
     */
    void
    reconstruct(const MaterialPoints<dim> &points,
                MaterialPoints<dim>       &result) const;

  private:
    /**
     * By owned cell: whether no surface cuts it.
     */
    std::vector<bool>
    inner_cells(const MaterialPoints<dim> &points) const;

    /**
     * Give the Gauss points of @p cells the mass and momentum of the points
     * there.
     */
    void
    conserve(const MaterialPoints<dim>       &points,
             const std::vector<unsigned int> &cells,
             MaterialPoints<dim>             &result) const;

    unsigned int n_q;
    bool         conserves_in_cells;
    double       full;

    // Of this space.
    mutable const SplineSpace<dim> *spline_space = nullptr;
    mutable CellNeighbors<dim>      neighbors;
  };
} // namespace greville

#endif
