// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/aligned_vector.h>

#include <greville/base/vector_field.h>
#include <greville/mass/density_weights.h>
#include <greville/mass/stencil_matrix.h>
#include <greville/points/material_points.h>
#include <greville/points/point_update.h>
#include <greville/points/spline_polynomials.h>
#include <greville/spline/cell_windows.h>

namespace greville
{
  /// Return the position of a point for messages: "at (0.1, 0.2) m, in the cell
  /// (3, 4)", with the lexicographic index of the owned cell number @p cell,
  /// and a @p word for "in".
  template <int dim>
  std::string
  describe_place(const SplineSpace<dim>   &space,
                 const unsigned int        cell,
                 const dealii::Point<dim> &x,
                 const std::string        &word = "in");



  /// Two isotropic tensors that map a gradient to a stress. The elasticity
  /// depends on the state of a point: lambda and G of the stress-free state are
  /// multiplied by the wave modulus of the point over lambda + 2 G, and by
  /// @p elastic_factor. The viscosity does not depend on the state.
  struct Stiffness
  {
    double lambda         = 0.;
    double shear          = 0.;
    double viscous_lambda = 0.;
    double viscous_shear  = 0.;
    double elastic_factor = 1.;
  };



  /**
   * Sums over points and grid functions. For functions N_i and points p with
   * mass m, velocity v, volume V = J V0 and Cauchy stress sigma:
   *   mass      m_i = sum_p m_p N_i(x_p),
   *   momentum  P_i = sum_p m_p (v_p + C_p (xi_i - x_p)) N_i(x_p),
   *   force     f_i = sum_p (m_p b_p N_i(x_p) - V_p sigma_p grad N_i(x_p)),
   * with the acceleration b_p by loads and, for APIC and Taylor, the affine
   * matrix C_p and the Greville point xi_i (@ref Jiang2015 "Jiang et al.,
   * 2015"). The transfer back to the points is
   *   v_p <- flip (v_p + dt' a(x_p)) + (1 - flip) v(x_p),    (PIC: flip = 0)
   *   x_p <- x_p + dt v(x_p),
   *   F_p <- (1 + dt grad w(x_p)) F_p,  J_p likewise, sigma_p by the material.
   * All fields are evaluated at the x_p before the call. For APIC, v_p = v(x_p)
   * and C_p = sum_i N_i v_i (xi_i - x_p)^T D_p^-1 with the diagonal matrix D_p
   * = sum_i N_i (xi_i - x_p)(xi_i - x_p)^T. For Taylor, C_p = grad v (1 + dt
   * grad v)^-1 at x_p is the gradient at the new position if v moves all points
   * (@ref Nakamura2023 "Nakamura, Matsumura and Mizutani, 2023"); without
   * motion and in total Lagrangian steps, C_p = grad v.
   *
   * With CellWindows, the gradients of N_i, and possibly N_i itself, are means
   * over the domains of points (@ref Bardenhagen2004 "Bardenhagen and Kober,
   * 2004") in the cells that reach their neighbours.
   *
   * Kernels process the points of a group by SIMD, and loops over a cell's
   * functions use the tensor product. The space has order 1 to 5.
   */
  template <int dim>
  class PointTransfer
  {
  public:
    /// The space and the windows of its cells are kept by reference. Windows
    /// are null if gradients are evaluated at points.
    void
    reinit(const SplineSpace<dim> &space,
           const CellWindows<dim> *windows = nullptr);

    /// Collective. Set each vector, unless null, to the sums over all
    /// @p bodies, which must be on cells of the space. Mass and momentum must
    /// be given together. @p filled_parts, unless null, is set as by filling().
    /// C_p is omitted unless @p with_affine.
    void
    points_to_grid(const std::vector<const MaterialPoints<dim> *> &bodies,
                   VectorType                                     *mass,
                   VectorField<dim>                               *momentum,
                   VectorField<dim>                               *force,
                   std::vector<double> *filled_parts = nullptr,
                   const bool           with_affine  = true);

    /// Collective. Set y_i = sum_p m_p N_i(x_p) c_p with column number
    /// @p column, c_p, of the affine matrices C_p, over the points in owned
    /// cells with @p is_used.
    void
    affine_momentum(const std::vector<const MaterialPoints<dim> *> &bodies,
                    const unsigned int                              column,
                    const std::vector<bool>                        &is_used,
                    VectorField<dim>                               &y);

    /**
     * Collective. Update @p points. Ghost entries of the fields are updated.
     * There are three updates:
     * - kick, move and deform: acceleration, move, and a velocity that is also
     *   the deformation;
     * - kick only: acceleration, and a velocity unless FLIP = 1;
     * - deform without a kick: deformation; with move also a velocity, which
     *   may be another field.
     * Throws dealii::ExcMessage for other combinations.
     */
    PointReport
    grid_to_points(MaterialPoints<dim> &points, const PointUpdate<dim> &update);

    /// Fill the weights, with n points per direction, from the masses of the
    /// points. They are exact for mass matrices of order (n - 1) / 2.
    void
    mass_weights(const std::vector<const MaterialPoints<dim> *> &bodies,
                 DensityWeights<dim>                            &weights) const;

    /// Add sum_p m_p N_i(x_p) N_j(x_p), the contribution of this process'
    /// points to the mass matrix.
    void
    add_mass_matrix(const std::vector<const MaterialPoints<dim> *> &bodies,
                    StencilMatrix<dim> &matrix) const;

    /// Compute the fraction of each owned cell that points fill, for
    /// CellFilling: the sum of their volumes over the volume of the cell. A
    /// compressed point counts with V0, an expanded one with at most 1.5 V0: a
    /// stretched body then remains filled, but spray does not count as a body.
    /// In total Lagrangian steps, each point counts with V0.
    void
    filling(const std::vector<const MaterialPoints<dim> *> &bodies,
            std::vector<double>                            &result) const;

    /// Collective. Add k_i = sum_p V_p (lambda div u 1 + 2 G sym grad u) grad
    /// N_i at x_p, with lambda and G of the @p stiffness of @p points. With
    /// @p overwrite, @p k is overwritten.
    void
    add_stiffness(const MaterialPoints<dim> &points,
                  const Stiffness           &stiffness,
                  const VectorField<dim>    &u,
                  VectorField<dim>          &k,
                  const bool                 overwrite);

    /// Collective. Compute y = M x with the mass matrix M_ij = sum_p m_p
    /// N_i(x_p) N_j(x_p) of all @p bodies.
    void
    multiply_mass(const std::vector<const MaterialPoints<dim> *> &bodies,
                  const VectorField<dim>                         &x,
                  VectorField<dim>                               &y);

    /**
     * Collective. Average the changes of volume of neighboring points:
     *   J_p <- J_p + part sum_i N_i(x_p) w_i (J_i - J_p),
     *   J_i = sum_p V0_p J_p N_i(x_p) / sum_p V0_p N_i(x_p),
     *   w_i = sum_p V0_p max(J_p - 1, 0) N_i / sum_p V0_p |J_p - 1| N_i,
     * which conserves the sum of V0 J. The grid velocity moves all points of a
     * cell in the same way, so nothing else removes differences of J between
     * them. If some points have J < 1 and bear pressure, and others J > 1 and
     * none, a fluid bears pressure although its mean volume is too large. The
     * weight w_i excludes fully compressed regions, whose pressure is smooth. F
     * does not change.
     */
    void
    share_volume(MaterialPoints<dim> &points, const double part);

    /// Return the diagonal of D_p = sum_i N_i (xi_i - x)(xi_i - x)^T for a
    /// point @p x of owned cell number @p cell, m^2.
    dealii::Tensor<1, dim>
    spread(const unsigned int cell, const dealii::Point<dim> &x) const;

  private:
    /// Collective. Read a field into the buffer of windows, if there are any.
    /// Returns another buffer with zeros.
    std::vector<double>
    read_windows(const CellWindows<dim> *used_windows,
                 const VectorField<dim> &field);

    /// Allocate @p stride numbers for each function of the points' cells.
    void
    resize_numbers(const unsigned int stride);

    /// Collective. Copy a vector to number @p k of each function, or add these
    /// numbers up into the vector.
    void
    read_number(const VectorType &vector, const unsigned int k);

    void
    write_number(const unsigned int k, VectorType &vector);

    SpacePolynomials<dim>         tables;
    const CellWindows<dim>       *windows = nullptr;
    std::vector<double>           window_buffer;
    dealii::AlignedVector<double> numbers; // of functions, in a transfer
    unsigned int                  numbers_stride = 0;
  };
} // namespace greville
