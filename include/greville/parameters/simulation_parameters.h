// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_parameters_simulation_parameters_h
#define greville_parameters_simulation_parameters_h

#include <deal.II/base/parameter_handler.h>

#include <greville/base/parameters.h>
#include <greville/materials/material.h>
#include <greville/parameters/run_parameters.h>
#include <greville/parameters/stage_parameters.h>
#include <greville/points/body.h>
#include <greville/stiffness/tangent_system.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * What is simulated.
   */
  struct GeneralParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string              name;
    unsigned int             dimension = 2;
    std::vector<std::string> bodies;
    std::vector<std::string> materials;
    std::vector<std::string> surface_loads;
    std::vector<std::string> stages;
  };



  /**
   * The background grid.
   */
  struct GridParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::vector<double>       lower    = {0., 0.};
    std::vector<double>       upper    = {1., 1.};
    std::vector<unsigned int> cells    = {16, 16};
    unsigned int              degree   = 2;
    bool                      per_body = false;

    /**
     * The numbers of the bodies of each velocity field of the grid, in the
     * order of GeneralParameters::bodies: each body in one field. Bodies of one
     * field stick where they touch, those of two do not see one another. Empty:
     * all bodies have one field. For programs: no parameter sets it.
     */
    std::vector<std::vector<unsigned int>> fields;
  };



  /**
   * The grid of a body: what is empty, or zero, is that of GridParameters.
   */
  struct BodyGridParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    bool
    is_given() const
    {
      return !lower.empty() || !upper.empty() || !cells.empty() || degree > 0;
    }

    std::vector<double>       lower;
    std::vector<double>       upper;
    std::vector<unsigned int> cells;
    unsigned int              degree = 0;
  };



  /**
   * The solver of the consistent mass.
   */
  struct ConsistentSolverParameters : SolverParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Whether the preconditioner is a factorization, or the cycle of
    /// p-multigrid, or the diagonal: none of these is the identity.
    bool
    has_factorization() const
    {
      return method == "cg-ic0";
    }

    bool
    has_cycle() const
    {
      return method == "cg-p-multigrid";
    }

    bool
    has_diagonal() const
    {
      return method == "cg-jacobi";
    }

    /// One of mass_solver_methods().
    std::string method = "cg-ic0";
  };



  /**
   * A load on the surface of a body with fitted points.
   */
  struct SurfaceLoadParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /**
     * Throw dealii::ExcMessage where the parameters of the @p section do not go
     * with the kind of the load or with the @p bodies.
     */
    void
    check(const std::string                           &section,
          const std::map<std::string, BodyParameters> &bodies) const;

    bool
    is_per_current_area() const
    {
      return area == "current";
    }

    std::string body;
    std::string where;
    std::string kind = "traction";
    std::string traction;
    std::string area = "initial";
    std::string pressure;
    double      stiffness = 0.;
    std::string displacement;
  };



  /**
   * All parameters of a simulation: a value, which programs may copy and
   * change. Bodies, materials, loads and stages have a section each, whose
   * names the file itself gives.
   *
   * A simulation with stages takes the sections of its stages in place of those
   * that are members here.
   */
  class SimulationParameters : public StageSections
  {
  public:
    /// The defaults, without bodies.
    SimulationParameters();

    /**
     * Read a file, and what @p settings put in its place, see
     * read_parameter_lines(). Throws where one is wrong, with the line.
     */
    explicit SimulationParameters(
      const std::string &file, const std::vector<std::string> &settings = {});

    /**
     * The reference of all parameters, with a body, a load and a material of
     * each model.
     */
    static void
    use_reference(const UseParameters &use);

    /**
     * The text of a file with the defaults of all parameters, and a body so
     * that it runs.
     */
    static std::string
    defaults();

    GeneralParameters   general;
    GridParameters      grid;
    ExactParameters     exact;
    SweepParameters     sweep;
    ReferenceParameters reference;
    OutputParameters    output;

    CheckpointParameters  checkpoints;
    LoadBalanceParameters load_balance;

    ConsistentSolverParameters solver;
    PMultigridParameters       multigrid;
    SmootherParameters         smoother;

    TangentParameters implicit_solver;

    /// One after the other; empty: one stage with the sections above.
    std::vector<StageParameters> stages;

    // By name. Copies share materials, which do not change.
    std::map<std::string, BodyParameters>                  bodies;
    std::map<std::string, BodyGridParameters>              body_grids;
    std::map<std::string, std::shared_ptr<const Material>> materials;
    std::map<std::string, SurfaceLoadParameters>           surface_loads;

    /**
     * Whether bodies have grids of their own, see Ensemble.
     */
    bool
    has_body_grids() const;

    /**
     * The grid that is meant for a body.
     */
    GridParameters
    grid_of(const std::string &body) const;

    /**
     * One with a file that names no stages.
     */
    unsigned int
    n_stages() const
    {
      return stages.empty() ? 1 : stages.size();
    }

    /**
     * The end of the last stage, s.
     */
    double
    end_of_run() const
    {
      return stages.empty() ? time.end : stages.back().time.end;
    }

    /**
     * Take the sections of a stage, which begins where the last one ends.
     */
    void
    enter_stage(const unsigned int stage);

    /**
     * "Stage 2 (collapse): ", which messages of one of several stages begin
     * with. Empty if there is one.
     */
    std::string
    stage_text(const unsigned int stage) const;

    /**
     * Throw dealii::ExcMessage where parameters contradict each other or are
     * wrong in a way that patterns cannot see.
     */
    void
    check() const;

    /**
     * All that was read, as a file that gives the same run from any folder.
     */
    const std::string &
    used() const
    {
      return used_text;
    }

    /**
     * What was read, with the lines of @p changes, the text of a parameter
     * file, in the place of some. Throws as the constructor.
     */
    SimulationParameters
    with(const std::string &changes) const;

  private:
    /**
     * Take what @p lines say, which are those of @p file.
     */
    void
    read(const std::string &file, const std::vector<ParameterLine> &lines);

    /**
     * All parameters but those of materials.
     */
    void
    declare(dealii::ParameterHandler &prm);

    /**
     * Read what the file gives of stages: all but what @p prm does with the
     * same lines.
     */
    void
    make_stages(const std::vector<ParameterLine> &lines);

    /**
     * check() of the grids of bodies.
     */
    void
    check_body_grids() const;

    /**
     * check() of the parameters of one stage.
     */
    void
    check_stage() const;

    /**
     * check_stage() of what does not go with total Lagrangian steps.
     */
    void
    check_total_lagrangian() const;

    /**
     * What "auto" stands for: lumped mass where bodies spread into thin layers,
     * and with APIC; the consistent one otherwise, and with total Lagrangian
     * steps.
     */
    std::string
    default_mass(const SchemeParameters &scheme) const;

    std::string used_text;
  };
} // namespace greville

#endif
