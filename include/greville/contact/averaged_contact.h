// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_contact_averaged_contact_h
#define greville_contact_averaged_contact_h

#include <deal.II/base/mpi.h>

#include <greville/contact/contact_point.h>
#include <greville/contact/contact_tangent.h>
#include <greville/contact/friction_law.h>

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace greville
{
  /**
   * The numbers of a contact, see AveragedContact.
   */
  struct ContactLaw
  {
    /// Of the pressure by the gap, and of the shear stress by slip, Pa / m.
    double stiffness = 0., shear_stiffness = 0.;
    /// Of both by the speed, Pa s / m.
    double viscosity = 0.;
    /// What resists sliding, null for smooth surfaces; and what is added to its
    /// strength under pressure, Pa.
    std::shared_ptr<const FrictionLaw> friction;
    double                             adhesion = 0.;
    /// Gaps of this size count as closed in a ContactTangent, m.
    double touching = 0.;
    /// Which sides have pore water, whose pressure friction does not feel.
    std::array<bool, 2> has_pores{{true, true}};
    /// Whether both sides deform; otherwise only points of side 0 are given.
    bool has_two_sides = true;
    /// Whether gaps and slip of side 1 count, too. Those of side 0 alone do
    /// where it consists of material points, which have no surface.
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



  /**
   * What a contact did, of all processes.
   */
  template <int dim>
  struct ContactResult
  {
    /// The force on side 0, N (2D: N / m), and its moment about a point.
    dealii::Tensor<1, dim>                force;
    dealii::Tensor<1, dim == 2 ? 1 : dim> moment;
    /// The smallest gap of a point, infinite where none faces the other side,
    /// m; and the area under pressure, m^2 (2D: m).
    double gap = 0., area = 0.;
  };



  /**
   * Sums over the steps of an interval, of the force on side 0.
   */
  template <int dim>
  struct ContactInterval
  {
    dealii::Tensor<1, dim> impulse;            // N s (2D: N s / m)
    double                 time          = 0.; // s
    double                 largest_force = 0.; // N (2D: N / m)
  };



  /**
   * What is remembered of the keys of an AveragedContact that belong to this
   * process, between the iterations of a step. Pressures are those of the
   * method of Uzawa: those that are given, Pa, are the averages of
   * ContactPoint::start_pressure in the first round, and those that the round
   * before has found in all others. A key that slides the other way than in the
   * last tangent has the tangent of one that sticks: Newton's method would go
   * to and fro between both ways.
   */
  template <int dim>
  struct KeyMemory
  {
    bool                                      is_first_round = true;
    std::unordered_map<std::uint64_t, double> given, found;
    /// The shear stress of keys that slide in the last tangent, of length 1.
    std::unordered_map<std::uint64_t, dealii::Tensor<1, dim>> sliding;
  };



  /**
   * Contact with friction by averages of the gap. With the hat functions
   * @f$\psi_i@f$ (degree 1) of a grid, at the positions of the points x_s of
   * both surfaces with areas a_s, gaps g_s and oriented normals n_s (outwards
   * from side 1), each key k, a function i together with a sector of normals,
   * has
   * @f[
   *   w^A_k = \sum_{s \in A} a_s \psi_k(x_s), \qquad
   *   w_k = \frac{2 w^A_k w^B_k}{w^A_k + w^B_k}, \qquad
   *   \bar g_k = \frac{\sum_{s \in A \cup B} a_s \psi_k(x_s) g_s}
   *                   {w^A_k + w^B_k}, \qquad
   *   t_k = \max(0, -\epsilon \bar g_k - \zeta \dot{\bar g}_k),
   * @f]
   * and the velocity of the gap is that of the mean of A against the mean of B.
   * The force @f$w_k t_k \bar n_k@f$ of a key goes to the points of A as
   * @f$a_s \psi_k(x_s) / w^A_k@f$ of it, and its opposite likewise to those of
   * B: momentum is kept to round-off. In the method of Uzawa the pressure has
   * a given part besides, the one that has been found before, until the gap is
   * zero. Each surface has as many conditions as
   * the grid has hats, which splines of any degree can meet; with a condition
   * at each point the pressure of splines of degree 2 and more oscillates.
   * Without the sectors, opposite faces of a thin body would share an average.
   *
   * The slip is averaged likewise, and so is the pressure p of pore water. The
   * shear stress of a key, @f$-\epsilon_T \bar e_k - \zeta \dot{\bar e}_k@f$
   * with the mean elastic slip, is at most
   * @f$\tau(t_k - \max(-t_k, \min(t_k, \bar p_k)), v_k) + c@f$, with the
   * strength of the FrictionLaw at the effective pressure
   * (@ref Terzaghi1943 "Terzaghi, 1943") and the speed v_k of the step; beyond
   * that the elastic slip of its points is set back by the mean. The mean of p
   * is that over the sides that have pores, with the weights of the gap, so
   * that a Coulomb friction mu that slides all over an area of soil has the sum
   * mu (N - sum a p) of the force N and the points.
   *
   * Material points as side A have gaps and slip, which side B then has not:
   * the means of these are those over A.
   */
  template <int dim>
  class AveragedContact
  {
  public:
    /**
     * The lattice of hat functions: one of its corners, and the size of its
     * cells, m.
     */
    AveragedContact(const ContactLaw             &law,
                    const dealii::Point<dim>     &corner,
                    const dealii::Tensor<1, dim> &cell_size,
                    const MPI_Comm                comm);

    /**
     * Collective. Set the force and the slip of all points, which know their
     * gaps. @p dt is the length of the step of their motion, s: 0 if there is
     * none. The @p tangent is made where it is not null, and the stiffness of
     * points with it. Where the @p memory is not null, given pressures are
     * added.
     *
     * Where points are in the middle of their step (@p share of it is 0.5), the
     * pressure is the mean one whose work is the change of the energy
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
    ContactLaw             contact_law;
    dealii::Point<dim>     corner;
    dealii::Tensor<1, dim> cell_size;
    MPI_Comm               comm;
  };
} // namespace greville

#endif
