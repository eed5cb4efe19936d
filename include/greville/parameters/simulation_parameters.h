// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/base/errors.h>
#include <greville/materials/element_test.h>
#include <greville/parameters/run_parameters.h>
#include <greville/parameters/section_parameters.h>
#include <greville/parameters/stage_parameters.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * All parameters of a simulation, a value that programs may copy and change.
   * Bodies, materials, loads and stages have one section each, whose names are
   * given in the file.
   *
   * In a simulation with stages, the sections of the stages replace the
   * sections that are members here.
   */
  class SimulationParameters : public StageSections
  {
  public:
    /// Set the defaults, without bodies.
    SimulationParameters();

    /// Read a file, with values replaced by @p settings, see
    /// read_parameter_lines(). Throws with the line if a value is invalid.
    explicit SimulationParameters(
      const std::string &file, const std::vector<std::string> &settings = {});

    /// Call @p use with the reference of all parameters, with a body, a load
    /// and a material of each model.
    static void
    use_reference(const UseParameters &use);

    /// Return the text of a file with all parameters that follow from a @p file
    /// with @p settings; if its name is empty, the defaults, and a body so that
    /// the file can run.
    static std::string
    all(const std::string                          &file,
        const std::vector<std::string>             &settings,
        const dealii::ParameterHandler::OutputStyle style);

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
    /// For --element-test only.
    ElementTestParameters element_test;

    /// The stages in order; if empty, there is one stage with the sections
    /// above.
    std::vector<StageParameters> stages;

    // Bodies and materials by name. Copies share materials, which do not
    // change.
    std::map<std::string, BodyParameters>                  bodies;
    std::map<std::string, BodyGridParameters>              body_grids;
    std::map<std::string, std::shared_ptr<const Material>> materials;
    std::map<std::string, SurfaceLoadParameters>           surface_loads;
    std::map<std::string, RigidBodyParameters>             rigid_bodies;
    std::map<std::string, ContactParameters>               contacts;

    /// Return whether bodies have grids of their own, see CoupledSimulations.
    bool
    has_body_grids() const;

    /// Return the groups of bodies that share a velocity field and stick on
    /// touching: each side of a contact is a group, and all other bodies are
    /// one. Bodies with grids of their own have a field each.
    std::vector<std::vector<std::string>>
    body_groups() const;

    GridParameters
    grid_of(const std::string &body) const;

    /// Return the number of stages; one if the file names none.
    unsigned int
    n_stages() const
    {
      return stages.empty() ? 1 : stages.size();
    }

    /// Return the end of the last stage, s.
    double
    end_of_run() const
    {
      return stages.empty() ? time.end : stages.back().time.end;
    }

    /// Return whether a stage has a 'Time/Ramp until failure'.
    bool
    has_ramp() const;

    /// Replace the sections by the sections of a stage, which begins at the end
    /// of the previous stage.
    void
    enter_stage(const unsigned int stage);

    bool
    is_in_stage(const std::string &body, const unsigned int stage) const
    {
      return stages.empty() || stages[stage].has_all_bodies() ||
             contains(stages[stage].bodies, body);
    }

    /// Return whether the bodies or materials of a stage differ from the
    /// previous stage.
    bool
    changes_bodies(const unsigned int stage) const;

    /// Return "Stage 2 (collapse): " as the beginning of messages, or an empty
    /// text if there is one stage.
    std::string
    stage_text(const unsigned int stage) const
    {
      return stages.empty() ? ""
                            : "Stage " + std::to_string(stage + 1) + " (" +
                                stages[stage].name + "): ";
    }

    /// Throw dealii::ExcMessage if parameters contradict each other or are
    /// invalid in ways that patterns cannot detect.
    void
    check() const;

    /// Return all parameters that were read, as a file that gives the same run
    /// from any folder.
    const std::string &
    used() const
    {
      return used_text;
    }

    /// Return the tolerance of the solver of the consistent mass. By default,
    /// its errors in explicit steps are small compared with errors of B-splines
    /// of order @p degree. With pore water, the solver of the pressure solves
    /// for the mass in each of its products, which needs the same tolerance.
    double
    mass_tolerance(const unsigned int degree) const;

  private:
    /// Read the values of @p lines, which come from @p file; used() then has
    /// this @p style.
    void
    read(const std::string                          &file,
         const std::vector<ParameterLine>           &lines,
         const dealii::ParameterHandler::OutputStyle style =
           dealii::ParameterHandler::PRM);

    /// Add the members for the sections that @p lines name.
    void
    make_sections(const std::vector<ParameterLine> &lines);

    /// Make names of files absolute in @p prm, and relative to the current
    /// folder in the members.
    void
    locate_files(const std::filesystem::path &folder,
                 dealii::ParameterHandler    &prm);

    /// Find masses and materials of stages, and enter the first stage.
    void
    complete_stages();

    /// Declare all parameters except those of materials.
    void
    declare(dealii::ParameterHandler &prm);

    /// Read the parts of the file about stages, which @p prm does not read,
    /// from the same lines.
    void
    make_stages(const std::vector<ParameterLine> &lines);

    /// Find the material of each body in each stage. Throws if 'Materials' of a
    /// stage contains an unknown name.
    void
    find_materials();

    void
    check_body_grids() const;

    /// Do the part of check() for axisymmetry, for all stages and for one.
    void
    check_axisymmetry() const;

    void
    check_axisymmetry_of_stage() const;

    /// Do the part of check() for contacts and rigid bodies.
    void
    check_contacts() const;

    /// Do the part of check() for bodies that are added or removed, and for
    /// their materials.
    void
    check_construction() const;

    /// Do the part of check() for the parameters of one stage.
    void
    check_stage() const;

    /// Do the part of check() for pore water, for all stages and for one.
    void
    check_water() const;

    void
    check_water_of_stage() const;

    /// Throw for parameters that refined grids do not support.
    void
    check_refinement() const;

    void
    check_refinement_of_stage() const;

    std::string used_text;
  };
} // namespace greville
