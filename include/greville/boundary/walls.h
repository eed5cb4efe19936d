// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_boundary_walls_h
#define greville_boundary_walls_h

#include <greville/base/expression.h>
#include <greville/geometry/shape.h>
#include <greville/parameters/simulation_parameters.h>
#include <greville/points/point_transfer.h>

#include <optional>

namespace greville
{
  /**
   * When moving walls have a velocity: at @p t, where their velocity is given;
   * as the mean from @p begin to @p end, where their displacement is.
   */
  struct WallTime
  {
    double t, begin, end;
  };



  /**
   * The kinds of WallParameters::type.
   */
  enum class WallType
  {
    free,
    fixed,
    sliding,
    moving,
    friction,
    periodic
  };



  /**
   * A vector for each wall of the grid.
   */
  template <int dim>
  using WallSums = std::array<dealii::Tensor<1, dim>, 2 * dim>;



  /**
   * The walls of the grid. On open knot vectors only the functions of the first
   * or last index of a direction do not vanish at a wall, and the value there
   * is that of their coefficients. So a wall holds these coefficients, of all
   * components (fixed, moving) or of the normal one (sliding), and is sharp:
   * for all orders, without help by the user. The body does not separate from
   * such a wall.
   *
   * The velocity or displacement of a moving wall is a formula of position and
   * time. Its coefficients are the values at the Greville abscissae: exact
   * where it is linear in the position, as that of a wall that turns. A sliding
   * wall may have one, of which the normal component counts.
   *
   * A wall may have a region: it holds the coefficients whose Greville
   * abscissae are inside. Its edge is then a transition of the width of p
   * cells, in whose middle it is where it lies at a knot (even orders) or
   * between two knots (odd ones).
   *
   * Periodic walls hold nothing: the spaces of functions and the transport of
   * points know them from the mesh.
   *
   * A friction wall is touched from one side. A coefficient v of the new
   * velocity that goes into the wall with the speed v_n is stopped, and slowed
   * down along the wall by Coulomb's law for the two parts of the impulse, v <-
   * v - v_n n - min(mu v_n, |v_t|) v_t / |v_t|; others are left alone. The
   * acceleration changes accordingly. This is for lumped mass and FMPM.
   */
  template <int dim>
  class Walls
  {
  public:
    /**
     * Throws dealii::ExcMessage for wrong formulas.
     */
    Walls(const WallParameters &parameters);

    /**
     * The directions in which both walls are periodic.
     */
    static std::array<bool, dim>
    periodic_directions(const WallParameters &parameters);

    /**
     * The order of the fields that other functions get. The space is kept by
     * reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Throw dealii::ExcMessage where formulas of moving walls fail at corners
     * between two times, or where a wall has to stay in its place and leaves
     * it: the wall holds the coefficients at the edge of the grid, which in
     * updated Lagrangian steps lets go of a body that is a cell away.
     */
    void
    check_paths(const SplineSpace<dim> &space,
                const double            start,
                const double            end,
                const bool              walls_have_to_stay) const;

    /**
     * Local numbers of the owned coefficients of a component that are held, for
     * any space. May have some twice.
     */
    std::vector<unsigned int>
    held_functions(const SplineSpace<dim> &space,
                   const unsigned int      component) const;

    /**
     * Whether there are moving walls.
     */
    bool
    have_moving() const;

    /**
     * Whether there are friction walls, and this one is.
     */
    bool
    have_friction() const;

    bool
    is_friction(const unsigned int wall) const
    {
      return type[wall] == WallType::friction;
    }

    double
    friction_coefficient(const unsigned int wall) const
    {
      return friction[wall];
    }

    /**
     * Local numbers of the owned functions that do not vanish at a wall.
     */
    const std::vector<unsigned int> &
    functions(const unsigned int wall) const
    {
      return coefficients[wall];
    }

    /**
     * Collective where walls move. Set held coefficients to the velocity of
     * their walls. Throws StepFailed where a formula fails.
     */
    void
    hold_velocity(VectorField<dim> &velocity, const WallTime &time) const;

    /**
     * Likewise to the mean acceleration from the velocity at @p
     * before to that at @p after, in the time @p dt.
     */
    void
    hold_acceleration(VectorField<dim> &acceleration,
                      const WallTime   &before,
                      const WallTime   &after,
                      const double      dt) const;

    /**
     * The components (bits) that a wall holds, and those in which it has a
     * force.
     */
    unsigned char
    held_components(const unsigned int wall) const;

    unsigned char
    components_with_force(const unsigned int wall) const;

    /**
     * Sums of value(c, i) over the coefficients that each wall holds, component
     * c of the owned function i. Those that two walls hold count for the one
     * whose value they have.
     */
    template <typename Value>
    void
    add_held(WallSums<dim> &sums, const Value &value) const
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        for (unsigned int k = 0; k < coefficients[w].size(); ++k)
          for (unsigned int c = 0; c < dim; ++c)
            if ((counted[w][k] >> c) & 1)
              sums[w][c] += value(c, coefficients[w][k]);
    }

    /**
     * Those of the coefficients of a field.
     */
    WallSums<dim>
    sums_of_held(const VectorField<dim> &field) const;

    /**
     * Friction walls and a diagonal mass: change the new velocity and the
     * acceleration that led to it in the time @p dt. Returns the changes of
     * momentum on this process.
     */
    WallSums<dim>
    add_contact(VectorField<dim> &velocity,
                VectorField<dim> &acceleration,
                const double      dt,
                const VectorType &lumped_mass) const;

    /**
     * Friction walls: stop what goes into them, without friction.
     */
    void
    stop(VectorField<dim> &velocity) const;

  private:
    bool
    holds(const unsigned int wall, const unsigned int component) const;

    /**
     * Owned coefficients at a wall, in its region.
     */
    std::vector<unsigned int>
    coefficients_at(const SplineSpace<dim> &space,
                    const unsigned int      wall) const;

    /**
     * Whether it has a velocity or a displacement.
     */
    bool
    is_moving(const unsigned int wall) const
    {
      return !velocity[wall].is_zero() || !displacement[wall].is_zero();
    }

    /**
     * Zero of a wall that does not move.
     */
    dealii::Tensor<1, dim>
    velocity_at(const unsigned int        wall,
                const dealii::Point<dim> &x,
                const WallTime           &time) const;

    /**
     * Collective where walls move. Set the held coefficients at each wall to
     * the values of @p value(wall, position). Throws StepFailed.
     */
    template <typename Value>
    void
    hold(VectorField<dim> &field, const Value &value) const;

    /**
     * Likewise for the coefficients of this process alone, of which some have
     * none. What @p value throws goes through.
     */
    template <typename Value>
    void
    set_held(VectorField<dim> &field, const Value &value) const;

    std::array<WallType, 2 * dim>                  type;
    std::array<double, 2 * dim>                    friction;
    std::array<std::optional<Shape<dim>>, 2 * dim> region;
    std::array<VectorExpression<dim>, 2 * dim>     velocity;
    std::array<VectorExpression<dim>, 2 * dim>     displacement;

    // Local numbers of the owned coefficients at each wall, and the Greville
    // abscissae of their functions, and the components (bits) that count for
    // this wall.
    std::array<std::vector<unsigned int>, 2 * dim>       coefficients;
    std::array<std::vector<dealii::Point<dim>>, 2 * dim> places;
    std::array<std::vector<unsigned char>, 2 * dim>      counted;
  };
} // namespace greville

#endif
