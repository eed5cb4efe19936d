// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <greville/contact/contact_point.h>
#include <greville/contact/contact_tangent.h>
#include <greville/contact/friction_law.h>
#include <greville/spline/lattice.h>

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace greville
{
  /// The constants of a contact, see AveragedContact.
  struct ContactLaw
  {
    /// The derivatives of the pressure by the gap and of the shear stress by
    /// slip, Pa / m.
    double stiffness = 0., shear_stiffness = 0.;
    /// The derivative of pressure and shear stress by the velocity, Pa s / m.
    double viscosity = 0.;
    /// The resistance to sliding, null for smooth surfaces; and the adhesion,
    /// which is added to its strength under pressure, Pa.
    std::shared_ptr<const FrictionLaw> friction;
    double                             adhesion = 0.;
    /// Gaps up to this size count as closed in a ContactTangent, m.
    double touching = 0.;
    /// True for sides with pore water, whose pressure causes no friction.
    std::array<bool, 2> has_pores{{true, true}};
    /// True if both sides deform; otherwise only points of side 0 are given.
    bool has_two_sides = true;
    /// True if gaps and slip of side 1 count, too. Only side 0 counts if it
    /// consists of material points, which have no surface.
    bool both_measure = true;

    bool
    has_pores_on(const unsigned int side) const
    {
      return has_pores[side] && (side == 0 || has_two_sides);
    }

    bool
    measures(const unsigned int side) const
    {
      return both_measure || side == 0;
    }
  };



  /// The result of a contact, summed over all processes.
  template <int dim>
  struct ContactResult
  {
    /// The force on side 0, N (2D: N / m), and its moment about a point.
    dealii::Tensor<1, dim>                force;
    dealii::Tensor<1, dim == 2 ? 1 : dim> moment;
    /// The smallest gap of a point, m, infinite if no point faces the other
    /// side; and the area under pressure, m^2 (2D: m).
    double gap = 0., area = 0.;
  };



  /// Sums of the force on side 0 over the steps of an interval.
  template <int dim>
  struct ContactInterval
  {
    dealii::Tensor<1, dim> impulse;            // N s (2D: N s / m)
    double                 time          = 0.; // s
    double                 largest_force = 0.; // N (2D: N / m)
  };



  /// Data of the keys of an AveragedContact on this process that are stored
  /// between the iterations of a step. Pressures are used in the method of
  /// Uzawa: the given pressures, Pa, are the averages of
  /// ContactPoint::start_pressure in the first round, and the results of the
  /// previous round afterwards. A key that slides in the direction opposite to
  /// the last tangent gets the tangent of a sticking key, since Newton's method
  /// would otherwise alternate between both directions.
  template <int dim>
  struct KeyMemory
  {
    bool                                      is_first_round = true;
    std::unordered_map<std::uint64_t, double> given, found;
    /// The direction of the shear stress, of length 1, of keys that slide in
    /// the last tangent.
    std::unordered_map<std::uint64_t, dealii::Tensor<1, dim>> sliding;
  };



  /**
   * Contact with friction based on averages of the gap. With the hat functions
   * @f$\psi_i@f$ (degree 1) of a grid, at the positions of the points x_s of
   * both surfaces with areas a_s, gaps g_s and oriented normals n_s (outwards
   * from side 1), each key k, which is a function i together with a sector of
   * normals, has
   * @f[
   *   w^A_k = \sum_{s \in A} a_s \psi_k(x_s), \qquad
   *   w_k = \frac{2 w^A_k w^B_k}{w^A_k + w^B_k}, \qquad
   *   \bar g_k = \frac{\sum_{s \in A \cup B} a_s \psi_k(x_s) g_s}
   *                   {w^A_k + w^B_k}, \qquad
   *   t_k = \max(0, -\epsilon \bar g_k - \zeta \dot{\bar g}_k),
   * @f]
   * and the velocity of the gap is the velocity of the mean of A relative to
   * the mean of B. The
   * force @f$w_k t_k \bar n_k@f$ of a key is distributed to
   * the points of A in proportion to @f$a_s \psi_k(x_s) / w^A_k@f$, and its
   * opposite likewise to the points of B, so momentum is conserved to
   * round-off. In the method of Uzawa, a given part is added to the pressure,
   * which is updated from the previous result until the gap is zero. Each
   * surface has one condition per hat function, which splines of any degree can
   * satisfy; with a condition at each point, the pressure would oscillate for
   * splines of degree 2 and higher. Without the sectors, opposite faces of a
   * thin body would share an average.
   *
   * The slip and the pressure p of pore water are averaged in the same way. The
   * shear stress of a key, @f$-\epsilon_T \bar e_k - \zeta \dot{\bar e}_k@f$
   * with the mean elastic slip, is at most
   * @f$\tau(t_k - \max(-t_k, \min(t_k, \bar p_k)), v_k) + c@f$, with the
   * strength of the FrictionLaw at the effective pressure (@ref Terzaghi1943
   * "Terzaghi, 1943") and the speed v_k of the step; beyond this limit, the
   * elastic slip of its points is reduced by the mean excess. The mean of p is
   * taken over the sides with pores, with the weights of the gap, so that the
   * friction force of an area that slides with a Coulomb coefficient mu is mu
   * (N - sum a p), with the normal force N.
   *
   * If side A consists of material points, only these have gaps and slip, and
   * means are taken over A.
   */
  template <int dim>
  class AveragedContact
  {
  public:
    /// The hat functions at a point belong to the nodes of one of the
    /// @p lattices, the largest cells there: see lattice_at().
    AveragedContact(const ContactLaw                &law,
                    const std::vector<Lattice<dim>> &lattices,
                    const MPI_Comm                   comm);

    /**
     * Collective. Set the force and the slip of all points, whose gaps must be
     * set. @p dt is the length of the step of their motion, s, or 0 without
     * motion. The @p tangent and the stiffness of points are computed unless @p
     * tangent is null. Given pressures are added unless @p memory is null.
     *
     * If points are in the middle of their step (@p share is 0.5), the pressure
     * is the mean pressure whose work is the change of the energy
     * @f$\Psi = \epsilon / 2 \, \langle -\bar g \rangle^2@f$,
     * @f[
     *   t_k = -\frac{\Psi(\bar g_1) - \Psi(\bar g_0)}{\bar g_1 - \bar g_0},
     * @f]
     * with the gaps at both ends that follow from the motion of both sides.
     */
    ContactResult<dim>
    act(std::vector<ContactPoint<dim>> &points,
        const double                    dt,
        const dealii::Point<dim>       &about,
        ContactTangent<dim>            *tangent = nullptr,
        KeyMemory<dim>                 *memory  = nullptr,
        const double                    share   = 1.) const;

    const ContactLaw &
    law() const
    {
      return contact_law;
    }

  private:
    ContactLaw                contact_law;
    std::vector<Lattice<dim>> lattices;
    MPI_Comm                  comm;
  };
} // namespace greville
