// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    std::vector<ParameterLine>
    lines_of(const std::string &file, const std::vector<std::string> &settings)
    {
      return read_parameter_lines(file,
                                  "Simulation",
                                  {"Benchmark", "Problem"},
                                  "greville_benchmark",
                                  settings);
    }
  } // namespace



  SimulationParameters::SimulationParameters()
  {
    // Conjugate gradients need a symmetric cycle.
    multigrid.restriction = "transpose";
  }



  SimulationParameters::SimulationParameters(
    const std::string &file, const std::vector<std::string> &settings)
    : SimulationParameters()
  {
    read(file, lines_of(file, settings));
  }



  void
  SimulationParameters::declare(ParameterHandler &prm)
  {
    declare_section(prm, "Simulation", general);
    declare_section(prm, "Grid", grid);
    for (auto &[name, region] : grid.regions)
      declare_section(prm, "Refinement " + name, region);
    declare_section(prm, "Water", water);
    declare_sections(prm);
    declare_section(prm, "Exact solution", exact);
    declare_section(prm, "Sweep", sweep);
    declare_section(prm, "Reference", reference);
    declare_section(prm, "Output", output);
    declare_section(prm, "Checkpoints", checkpoints);
    declare_section(prm, "Load balance", load_balance);
    declare_section(prm, "Solver", solver);
    declare_section(prm, "p-multigrid", multigrid, smoother_names(), "");
    declare_section(prm, "Implicit solver", implicit_solver);
    declare_section(prm, ElementTestParameters::section, element_test);
    for (auto &body : bodies)
      {
        const std::string section = "Body " + body.first;
        declare_section(prm, section, body.second);
        prm.enter_subsection(section);
        declare_section(prm, "Grid", body_grids[body.first]);
        prm.leave_subsection();
      }
    for (auto &load : surface_loads)
      declare_section(prm, "Surface load " + load.first, load.second);
    for (auto &[name, body] : rigid_bodies)
      declare_section(prm, "Rigid body " + name, body);
    for (auto &[name, contact] : contacts)
      declare_section(prm, "Contact " + name, contact);
    for (StageParameters &stage : stages)
      {
        const std::string section = "Stage " + stage.name;
        declare_section(prm, section, stage);
        prm.enter_subsection(section);
        stage.declare_sections(prm);
        prm.leave_subsection();
      }
  }



  std::string
  SimulationParameters::all(const std::string                  &file,
                            const std::vector<std::string>     &settings,
                            const ParameterHandler::OutputStyle style)
  {
    SimulationParameters parameters;
    if (file.empty())
      parameters.read("defaults.prm",
                      parameter_lines_of("subsection Simulation\n"
                                         "  set Bodies    = block\n"
                                         "  set Materials = solid\n"
                                         "end\n"
                                         "subsection Body block\n"
                                         "  set Material = solid\n"
                                         "  set Shape = box(0.25, 0.25, 0.75, "
                                         "0.75)\n"
                                         "end\n"
                                         "subsection Material solid\n"
                                         "  set Model = linear-elastic\n"
                                         "end\n",
                                         "defaults.prm"),
                      style);
    else
      parameters.read(file, lines_of(file, settings), style);
    return parameters.used();
  }



  double
  SimulationParameters::mass_tolerance(const unsigned int degree) const
  {
    const double tight = solver.tight_tolerance();
    // Rows near the axis, whose mass is proportional to r, hardly contribute to
    // the norm of the residual.
    return solver.tolerance > 0. || general.pore_water ||
               grid.is_axisymmetric() ||
               is_implicit_scheme(scheme.stress_update)
             ? tight
             : std::clamp(std::pow(10., -3. - degree), tight, 1e-5);
  }

} // namespace greville
