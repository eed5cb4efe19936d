// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

#include <optional>

namespace greville
{
  /// The time at which moving walls have a velocity: @p t if their velocity is
  /// given; the mean from @p begin to @p end if their displacement is given.
  struct WallTime
  {
    double t, begin, end;
  };



  enum class WallType
  {
    free,
    fixed,
    sliding,
    moving,
    friction,
    periodic
  };



  template <int dim>
  using WallSums = std::array<dealii::Tensor<1, dim>, 2 * dim>;



  /**
   * The walls of the grid. On open knot vectors, only the functions with the
   * first or last index of a direction do not vanish at a wall, and the field
   * there has the value of their coefficients. A wall therefore constrains
   * these coefficients, in all components (fixed, moving) or in the normal one
   * (sliding), and is sharp for all orders without further action by the user.
   * The body does not separate from such a wall.
   *
   * The velocity or displacement of a moving wall is a formula of position and
   * time. Its coefficients are the values at the Greville abscissae, which is
   * exact if it is linear in the position, as for a rotating wall. If a sliding
   * wall has a velocity, only the normal component counts.
   *
   * A wall may have a region: it then constrains the coefficients whose
   * Greville abscissae are inside. The edge of the region is a transition over
   * p cells. The edge is in the middle of the transition if it lies at a knot
   * (even orders) or between two knots (odd orders).
   *
   * Periodic walls constrain nothing: spline spaces and the transport of points
   * obtain periodicity from the mesh.
   *
   * A friction wall acts as one-sided contact. A coefficient v of the new
   * velocity that moves into the wall with the speed v_n is stopped, and slowed
   * down along the wall by Coulomb's law for the two parts of the impulse, v <-
   * v - v_n n - min(mu v_n, |v_t|) v_t / |v_t|; others are left alone. The
   * acceleration changes accordingly. This is for lumped mass and FMPM.
   */
  template <int dim>
  class Walls
  {
  public:
    /// Throws dealii::ExcMessage for invalid formulas.
    Walls(const WallParameters &parameters);

    /// Return the directions in which both walls are periodic.
    static std::array<bool, dim>
    periodic_directions(const WallParameters &parameters);

    /// Set the space of the fields for the other functions. It is kept by
    /// reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// Throw dealii::ExcMessage if formulas of moving walls fail at corners
    /// between two times, or if a wall leaves its place although it must stay
    /// there. A wall constrains the coefficients at the edge of the grid. In
    /// updated Lagrangian steps, these do not touch a body that is a cell away.
    void
    check_paths(const SplineSpace<dim> &space,
                const double            start,
                const double            end,
                const bool              walls_have_to_stay) const;

    /// Return the local numbers of the owned coefficients of a component that
    /// are constrained, for any space. Some numbers may occur twice.
    std::vector<unsigned int>
    constrained_functions(const SplineSpace<dim> &space,
                          const unsigned int      component) const;

    bool
    have_moving() const;

    /// Return whether there are friction walls, or whether @p wall is one.
    bool
    have_friction() const
    {
      return std::find(type.begin(), type.end(), WallType::friction) !=
             type.end();
    }

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

    /// Return the local numbers of the owned functions that do not vanish at a
    /// wall.
    const std::vector<unsigned int> &
    functions(const unsigned int wall) const
    {
      return coefficients[wall];
    }

    /// Collective if walls move. Set constrained coefficients to the velocity
    /// of their walls. Throws StepFailed if a formula fails.
    void
    impose_velocity(VectorField<dim> &velocity, const WallTime &time) const;

    /// Collective if walls move. Set constrained coefficients to the mean
    /// acceleration from the velocity at @p before to the velocity at @p after,
    /// in the time @p dt. Throws StepFailed if a formula fails.
    void
    impose_acceleration(VectorField<dim> &acceleration,
                        const WallTime   &before,
                        const WallTime   &after,
                        const double      dt) const;

    /// Return the components (bits) that a wall constrains, and the components
    /// in which it has a force.
    unsigned char
    constrained_components(const unsigned int wall) const;

    unsigned char
    components_with_force(const unsigned int wall) const
    {
      return is_friction(wall) ? (1 << dim) - 1 : constrained_components(wall);
    }

    /// Add value(c, i) over the coefficients that each wall constrains,
    /// component c of the owned function i. A coefficient constrained by two
    /// walls counts for the wall that determines its value.
    template <typename Value>
    void
    add_constrained(WallSums<dim> &sums, const Value &value) const
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        for (unsigned int k = 0; k < coefficients[w].size(); ++k)
          for (unsigned int c = 0; c < dim; ++c)
            if ((counted[w][k] >> c) & 1)
              sums[w][c] += value(c, coefficients[w][k]);
    }

    /// Return the sums of add_constrained() for the coefficients of a field.
    WallSums<dim>
    constrained_sums(const VectorField<dim> &field) const;

    /// Apply friction walls with a diagonal mass: change the new velocity and
    /// the acceleration that led to it in the time @p dt. Returns the changes
    /// of momentum on this process.
    WallSums<dim>
    add_contact(VectorField<dim> &velocity,
                VectorField<dim> &acceleration,
                const double      dt,
                const VectorType &lumped_mass) const;

    /// Stop coefficients that move into friction walls, without friction.
    void
    stop(VectorField<dim> &velocity) const;

  private:
    bool
    constrains(const unsigned int wall, const unsigned int component) const
    {
      return type[wall] == WallType::fixed || type[wall] == WallType::moving ||
             (type[wall] == WallType::sliding && wall / 2 == component);
    }

    /// Return the owned coefficients at a wall, in its region.
    std::vector<unsigned int>
    coefficients_at(const SplineSpace<dim> &space,
                    const unsigned int      wall) const;

    bool
    is_moving(const unsigned int wall) const
    {
      return !velocity[wall].is_zero() || !displacement[wall].is_zero();
    }

    /// Return the velocity of a wall; zero if it does not move.
    dealii::Tensor<1, dim>
    velocity_at(const unsigned int        wall,
                const dealii::Point<dim> &x,
                const WallTime           &time) const;

    /// Collective if walls move. Set the constrained coefficients at each wall
    /// to @p value(wall, position). Throws StepFailed if a formula fails.
    template <typename Value>
    void
    impose(VectorField<dim> &field, const Value &value) const;

    std::array<WallType, 2 * dim>                  type;
    std::array<double, 2 * dim>                    friction;
    std::array<std::optional<Shape<dim>>, 2 * dim> region;
    std::array<VectorExpression<dim>, 2 * dim>     velocity;
    std::array<VectorExpression<dim>, 2 * dim>     displacement;

    // The local numbers of the owned coefficients at each wall, the Greville
    // abscissae of their functions, and the components (bits) that count for
    // this wall.
    std::array<std::vector<unsigned int>, 2 * dim>       coefficients;
    std::array<std::vector<dealii::Point<dim>>, 2 * dim> abscissae;
    std::array<std::vector<unsigned char>, 2 * dim>      counted;
  };
} // namespace greville
