#ifndef greville_simulation_walls_h
#define greville_simulation_walls_h

#include <greville/base/expression.h>
#include <greville/multigrid/mass_operator.h>
#include <greville/particles/point_transfer.h>
#include <greville/simulation/parameters.h>

namespace greville
{
  /**
   * The walls of the grid. On open knot vectors only the functions of the first
   * or last index of a direction do not vanish at a wall, and the value there
   * is that of their coefficients. So a wall holds these coefficients, of all
   * components (fixed, moving) or of the normal one (sliding, friction), and is
   * sharp: for all orders, without help by the user.
   *
   * A friction wall pushes with N_i = max(0, F_i . n), the force of the body
   * onto the wall at function i with the outward normal n, and drags along it
   * with the force
   *   T_i = -min(mu N_i, |P_i + dt F_i| / dt) (P_i + dt F_i) / |P_i + dt F_i|
   * (tangential parts), which is Coulomb's law: no more than would stop it.
   * Walls neither let go of the body: it does not separate from fixed, sliding
   * and friction walls that it touches.
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
     * The order for which hold() and add_friction() work. The space is kept by
     * reference.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * The owned coefficients of component @p component that are held, for any
     * space.
     */
    Constraints
    constraints(const SplineSpace<dim> &space,
                const unsigned int      component) const;

    /**
     * Whether two components have the same constraints().
     */
    bool
    hold_the_same(const unsigned int a, const unsigned int b) const;

    /**
     * Whether there are moving walls.
     */
    bool
    move() const;

    /**
     * Set held coefficients to the velocity of their walls at time @p t.
     */
    void
    hold_velocity(VectorField<dim> &velocity, const double t) const;

    /**
     * Set held coefficients to the mean acceleration between two times.
     */
    void
    hold_acceleration(VectorField<dim> &acceleration,
                      const double      t,
                      const double      dt) const;

    void
    add_friction(const VectorField<dim> &momentum,
                 VectorField<dim>       &force,
                 const double            dt) const;

  private:
    bool
    holds(const unsigned int wall, const unsigned int component) const;

    std::array<std::string, 2 * dim>             type;
    std::array<double, 2 * dim>                  friction;
    std::array<std::vector<Expression>, 2 * dim> velocity;

    // Local numbers of the owned coefficients at each wall.
    std::array<std::vector<unsigned int>, 2 * dim> coefficients;
  };
} // namespace greville

#endif
