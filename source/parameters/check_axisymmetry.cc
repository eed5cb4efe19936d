// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    const Refusal refuse_with_axis{"'Grid/Geometry' = axisymmetric"};



    /// Return whether the first of several formulas of time is zero, judging
    /// from samples.
    bool
    has_radial_part(const std::string &text,
                    const std::string &parameter,
                    const double       start,
                    const double       end)
    {
      if (text.empty())
        return false;
      const VectorExpression<2> formulas(text, parameter, {"t"});
      constexpr unsigned int    n = 16;
      for (unsigned int k = 0; k <= n; ++k)
        if (formulas(start + k * (end - start) / n)[0] != 0.)
          return true;
      return false;
    }
  } // namespace



  void
  SimulationParameters::check_axisymmetry() const
  {
    refuse_with_axis(general.dimension == 3,
                     "'Simulation/Dimension' = 3",
                     "it is a geometry of 2D files.");
    const std::string at = text_of(grid.lower[0]);
    refuse_with_axis(grid.lower[0] < 0.,
                     "'Grid/Lower corner', whose x is " + at + " m",
                     "x is the distance from the axis and cannot be negative.");
    for (const auto &[name, body_grid] : body_grids)
      refuse_with_axis(
        body_grid.lower.size() == 2 &&
          (body_grid.lower[0] < 0. ||
           (body_grid.lower[0] == 0.) != grid.has_axis()),
        "the 'Grid/Lower corner' of 'Body " + name + "', whose x is " +
          (body_grid.lower.size() == 2 ? text_of(body_grid.lower[0]) : "") +
          " m",
        "the grids of all bodies have to begin at the axis, x = 0, or "
        "none; the section 'Grid' begins at " +
          at + " m.");
    for (const auto &[name, body] : rigid_bodies)
      {
        const std::string section = "'Rigid body " + name + "/";
        refuse_with_axis(
          body.is_free,
          section + "Free'",
          "a ring has no rigid motion along r. Give a 'Velocity' along y.");
        refuse_with_axis(!body.rotation.empty(),
                         section + "Rotation'",
                         "a body of revolution does not turn in the plane.");
        refuse_with_axis(
          has_radial_part(body.velocity,
                          section + "Velocity'",
                          stages.empty() ? time.start : stages[0].time.start,
                          end_of_run()),
          section + "Velocity', which is <" + body.velocity + ">",
          "a rigid body moves along y, the axis, only.");
      }
  }



  void
  SimulationParameters::check_axisymmetry_of_stage() const
  {
    refuse_with_axis(walls.is_periodic(0),
                     "'Walls/Left' = periodic",
                     "the radius is not periodic.");
    refuse_with_axis(
      has_radial_part(loads.gravity, "Loads/Gravity", time.start, time.end),
      "'Loads/Gravity', which is <" + formula_text(loads.gravity) + ">",
      "gravity acts along y, the axis; 'Loads/Body force' may be radial.");
    if (!grid.has_axis())
      return;
    refuse_with_axis(
      walls.type[0] != "sliding" && walls.type[0] != "fixed",
      "'Walls/Left' = " + walls.type[0],
      "the grid begins at x = 0, where this wall is the axis. It "
      "constrains the radial component if it is free or sliding, and "
      "both components if it is fixed.");
    refuse_with_axis(
      !walls.velocity[0].empty() || !walls.displacement[0].empty() ||
        !walls.region[0].empty(),
      "'Walls/Left velocity', 'Left displacement' and 'Left region'",
      "the grid begins at x = 0, where this wall is the axis.");
  }
} // namespace greville
