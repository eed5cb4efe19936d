#ifndef greville_simulation_energy_guard_h
#define greville_simulation_energy_guard_h

#include <greville/simulation/discretization.h>

namespace greville
{
  /**
   * Watches the EnergyBalance of a state: warns, or stops the run, where energy
   * has come from nothing.
   */
  template <int dim>
  class EnergyGuard
  {
  public:
    /**
     * All but @p mass, the name of the mass for messages, are kept by
     * reference.
     */
    EnergyGuard(const SchemeParameters    &parameters,
                const std::string         &mass,
                const Discretization<dim> &discretization,
                StepLog                   &log);

    /**
     * Collective. The initial energy.
     */
    void
    start(State<dim> &state) const;

    /**
     * Collective. Every hundred steps, and after the last one. Throws
     * StepFailed where that is asked for.
     */
    void
    check(State<dim> &state, const bool is_last) const;

  private:
    const SchemeParameters    &parameters;
    const std::string          mass;
    const Discretization<dim> &discretization;
    StepLog                   &log;
  };

  /**
   * The power of gravity and of the loads of points on this process, W (2D: W /
   * m), in a step that ends with the velocity @p v of the grid. Points have
   * that of its begin.
   */
  template <int dim>
  double
  power_of_loads(const State<dim>          &state,
                 const Discretization<dim> &discretization,
                 const Loads<dim>          &loads,
                 const VectorField<dim>    &v);

  /**
   * Collective. The power of walls and obstacles: they give what the @p
   * acceleration needs beyond the @p force. @p residual is overwritten.
   */
  template <int dim>
  double
  power_of_walls(const Discretization<dim> &discretization,
                 const VectorField<dim>    &force,
                 const VectorField<dim>    &acceleration,
                 const VectorField<dim>    &v,
                 VectorField<dim>          &residual);
} // namespace greville

#endif
