#ifndef greville_simulation_loads_h
#define greville_simulation_loads_h

#include <greville/particles/shape.h>
#include <greville/simulation/parameters.h>

namespace greville
{
  /**
   * Gravity g(t), which acts on the mass of the grid, and what points carry as
   * an acceleration: the body force b(x, X, t) per mass and tractions s(x, X,
   * t) on surfaces. A surface of area A is a set of points; each has the part
   * of A that its V0 has of the volume of the set.
   */
  template <int dim>
  class Loads
  {
  public:
    /**
     * Throws dealii::ExcMessage for wrong
     * formulas.
     */
    Loads(const SimulationParameters &parameters);

    /**
     * Collective. Find the points of tractions at their initial
     * positions; throws dealii::ExcMessage where there are none.
     */
    void
    find_surfaces(const std::vector<Body<dim>> &bodies, const MPI_Comm comm);

    /**
     * Whether points carry an acceleration (PointLayout::load).
     */
    bool
    act_on_points() const;

    /**
     * Set the accelerations of points at time @p t, s.
     */
    void
    set(std::vector<Body<dim>> &bodies, const double t);

    /**
     * Collective. Where the loads that were last @ref set, and gravity, alone
     * move a point by more than a tenth of @p h, the smallest edge of a cell,
     * in a step @p dt: a sentence that says so and names their parameters.
     * Otherwise nothing.
     */
    std::string
    what_is_large(const double   t,
                  const double   dt,
                  const double   h,
                  const MPI_Comm comm) const;

    /**
     * m / s^2.
     */
    dealii::Tensor<1, dim>
    gravity(const double t) const;

  private:
    struct Traction
    {
      Shape<dim>              shape;
      std::vector<Expression> formulas;
      double                  area_per_volume0;
    };

    const SimulationParameters parameters;
    std::vector<Expression>    gravity_formulas, body_force;
    std::vector<Traction>      tractions;
    /// Of the points of a process, m / s^2.
    double largest = 0.;
  };
} // namespace greville

#endif
