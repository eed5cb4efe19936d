// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_parameters_simulation_parameters_h
#define greville_parameters_simulation_parameters_h

#include <deal.II/base/parameter_handler.h>

#include <greville/base/parameters.h>
#include <greville/materials/material.h>
#include <greville/parameters/run_parameters.h>
#include <greville/parameters/section_parameters.h>
#include <greville/parameters/stage_parameters.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
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
    WaterParameters     water;
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
    std::map<std::string, RigidBodyParameters>             rigid_bodies;
    std::map<std::string, ContactParameters>               contacts;

    /**
     * Whether bodies have grids of their own, see CoupledSimulations.
     */
    bool
    has_body_grids() const;

    /**
     * The bodies that share a velocity field, and stick where they touch: each
     * side of a contact, and all others. Bodies with grids of their own have a
     * field each.
     */
    std::vector<std::vector<std::string>>
    body_groups() const;

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
     * Whether a stage has a 'Time/Ramp until failure'.
     */
    bool
    has_ramp() const;

    /**
     * Take the sections of a stage, which begins where the last one ends.
     */
    void
    enter_stage(const unsigned int stage);

    /**
     * Whether a body is there in a stage.
     */
    bool
    is_there(const std::string &body, const unsigned int stage) const;

    /**
     * Whether bodies or materials of a stage are others than those of the stage
     * before it.
     */
    bool
    changes_bodies(const unsigned int stage) const;

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
     * The material of each body in each stage. Throws where 'Materials' of a
     * stage names something else.
     */
    void
    find_materials();

    /**
     * check() of the grids of bodies.
     */
    void
    check_body_grids() const;

    /**
     * Let 'Walls/Left' slide where it is free and the axis of symmetry.
     */
    void
    make_axis();

    /**
     * check() of what does not go with axisymmetry, of all stages, and of one.
     */
    void
    check_axisymmetry() const;

    void
    check_axisymmetry_of_stage() const;

    /**
     * check() of contacts and rigid bodies.
     */
    void
    check_contacts() const;

    /**
     * check() of bodies that come and go, and of their materials.
     */
    void
    check_construction() const;

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

    void
    check_friction_walls() const;

    void
    check_domains() const;

    /**
     * check() of pore water, of all stages, and of one.
     */
    void
    check_water() const;

    void
    check_water_of_stage() const;

    /**
     * What "auto" stands for: lumped mass where bodies spread into thin layers,
     * with friction walls and with APIC; the consistent one otherwise, and with
     * total Lagrangian steps.
     */
    std::string
    default_mass(const SchemeParameters &scheme,
                 const WallParameters   &walls) const;

    std::string used_text;
  };
} // namespace greville

#endif
