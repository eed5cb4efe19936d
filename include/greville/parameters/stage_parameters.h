// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/parameters/wall_parameters.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  struct TimeParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    double       start = 0.;
    double       end   = 1.;
    std::string  step;
    double       cfl                  = 0.5;
    double       safety               = 0.7;
    std::string  too_large_step       = "refuse";
    std::string  velocities           = "half steps";
    unsigned int max_steps            = 0;
    double       largest_displacement = 0.;
    std::string  end_when;
    std::string  ramp;

    // Files cannot set these: the smallest automatic step over the first one of
    // its stage, and the steps between two estimates of the critical step (0:
    // the first step only).
    double       smallest_step  = 1e-3;
    unsigned int estimate_every = 20;

    bool
    has_half_steps() const
    {
      return velocities == "half steps";
    }

    bool
    refuses_too_large_steps() const
    {
      return too_large_step == "refuse";
    }

    bool
    looks_at_too_large_steps() const
    {
      return too_large_step != "ignore";
    }
  };



  /// The transfer between points and grid.
  struct SchemeParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string formulation           = "updated Lagrangian";
    std::string mass                  = "auto";
    double      filling               = -1.;
    double      filter                = 0.4;
    std::string energy_gain           = "stop";
    std::string stress_update         = "USL";
    std::string transfer              = "FLIP";
    double      flip                  = 1.;
    std::string functions             = "points";
    std::string volumetric_projection = "none";
    std::string outside               = "error";

    bool
    is_quasi_static() const
    {
      return stress_update == "quasi-static";
    }

    bool
    is_backward_euler() const
    {
      return stress_update == "backward-euler";
    }

    bool
    is_total_lagrangian() const
    {
      return formulation == "total Lagrangian";
    }

    bool
    has_lumped_mass() const
    {
      return mass == "lumped";
    }

    bool
    has_consistent_mass() const
    {
      return mass == "consistent";
    }

    /// Return whether points keep a part of their velocity.
    bool
    is_flip() const
    {
      return transfer == "FLIP" || is_taylor();
    }

    bool
    is_pic() const
    {
      return transfer == "PIC";
    }

    bool
    is_apic() const
    {
      return transfer == "APIC";
    }

    bool
    is_taylor() const
    {
      return transfer == "Taylor";
    }

    /// Return whether points have an affine velocity.
    bool
    has_affine() const
    {
      return is_apic() || is_taylor();
    }

    bool
    averages_over_domains() const
    {
      return functions == "domains";
    }

    bool
    has_projection() const
    {
      return volumetric_projection != "none";
    }

    bool
    projects_on_coarse_mesh() const
    {
      return volumetric_projection == "coarse mesh";
    }

    bool
    looks_at_energy() const
    {
      return energy_gain != "ignore";
    }

    bool
    stops_at_energy_gain() const
    {
      return energy_gain == "stop";
    }

    bool
    stops_outside() const
    {
      return outside == "error";
    }

    /// Return the filling from which cells are well-filled. Since extended
    /// functions reduce the accuracy, it is smaller if points stay in their
    /// cells.
    double
    filling_threshold(const bool implicit = false) const
    {
      return filling >= 0.           ? filling
             : is_total_lagrangian() ? 0.1
             : implicit              ? 0.55
                                     : 0.45;
    }
  };



  struct LoadParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string gravity;
    std::string body_force;
    double      cundall = 0.;
  };



  /// Constants of implicit schemes, and the solution of a step.
  struct ImplicitParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    double spectral_radius = 0.8;
    double smallest_step   = 1e-3;
  };



  /// The tolerances of Newton's method and of its linear systems.
  struct NewtonParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    double       tolerance          = 1e-8;
    double       absolute_tolerance = 0.;
    unsigned int max_iterations     = 20;
    double       largest_forcing    = 0.01;
  };



  /// Sections that may differ between the stages of a simulation.
  struct StageSections
  {
    void
    declare_sections(dealii::ParameterHandler &prm);

    TimeParameters     time;
    SchemeParameters   scheme;
    WallParameters     walls;
    LoadParameters     loads;
    ImplicitParameters implicit;
    NewtonParameters   newton;
  };



  struct StageParameters : StageSections
  {
    /// Declare the parameters outside the sections.
    void
    declare(dealii::ParameterHandler &prm);

    std::string              name;
    std::vector<std::string> bodies = {"all"};
    std::vector<std::string> materials; // "body: material"
    bool                     reset_displacements = false;

    bool
    has_all_bodies() const
    {
      return bodies == std::vector<std::string>{"all"};
    }

    /// The material of each body, see SimulationParameters::find_materials().
    std::map<std::string, std::string> material_of;
  };
} // namespace greville
