// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/simulation/grid_mass.h>
#include <greville/simulation/parameters.h>

namespace greville
{
  using namespace dealii;

  void
  SimulationParameters::check_stage() const
  {
    const unsigned int dim = general.dimension;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        const std::string &name = WallParameters::names[w];
        const std::string &v    = walls.velocity[w];
        const std::string &d    = walls.displacement[w];
        AssertThrow(v.empty() || d.empty(),
                    ExcMessage("The wall '" + name + "' has both of '" + name +
                               " velocity' (<" + v + ">) and '" + name +
                               " displacement' (<" + d +
                               ">): one of them is enough."));
        AssertThrow(walls.type[w] == "sliding" ||
                      (walls.type[w] == "moving") == !(v + d).empty(),
                    ExcMessage("The wall '" + name + "' is " + walls.type[w] +
                               ", and '" + name +
                               (d.empty() ? " velocity' is <" + v
                                          : " displacement' is <" + d) +
                               ">: a moving wall has one, a sliding wall may "
                               "have one, others have none."));
        AssertThrow(walls.region[w].empty() || walls.type[w] == "fixed" ||
                      walls.type[w] == "sliding" || walls.type[w] == "moving",
                    ExcMessage("The wall '" + name + "' is " + walls.type[w] +
                               ", and '" + name + " region' is <" +
                               walls.region[w] +
                               ">: fixed, sliding and moving walls may have "
                               "one."));
      }
    for (unsigned int w = 0; w < 2 * dim; w += 2)
      {
        const bool is_periodic = walls.type[w] == "periodic";
        AssertThrow(is_periodic == (walls.type[w + 1] == "periodic"),
                    ExcMessage("The wall '" + WallParameters::names[w] +
                               "' is " + walls.type[w] + " and '" +
                               WallParameters::names[w + 1] + "' is " +
                               walls.type[w + 1] +
                               ": both or none of them are periodic."));
        const unsigned int n = grid.cells.size() == dim ? grid.cells[w / 2] : 0;
        AssertThrow(!is_periodic || n == 0 || n > grid.degree,
                    ExcMessage(
                      "The parameter 'Grid/Cells' has " + std::to_string(n) +
                      " cells from '" + WallParameters::names[w] + "' to '" +
                      WallParameters::names[w + 1] +
                      "', which are periodic: B-splines of 'Grid/Order' " +
                      std::to_string(grid.degree) + " need " +
                      std::to_string(grid.degree + 1) +
                      " or more, so that none meets itself."));
      }
    check_mass_name(scheme.mass, "Scheme/Mass");
    if (scheme.is_total_lagrangian())
      check_total_lagrangian();
    AssertThrow(scheme.transfer == "FLIP" || scheme.flip == 1.,
                ExcMessage("The parameter 'Scheme/FLIP share' is " +
                           text_of(scheme.flip) +
                           ", but 'Scheme/Transfer' is " + scheme.transfer +
                           ": a share belongs to FLIP."));
    AssertThrow(time.start <= time.end,
                ExcMessage("'Time/Start' is " + text_of(time.start) +
                           " s, behind 'Time/End', " + text_of(time.end) +
                           " s."));
    AssertThrow(!time.step.empty() || (time.cfl > 0. && time.safety > 0.),
                ExcMessage("Without a 'Time/Step', the parameters 'Time/CFL "
                           "number' and 'Time/Safety' have to be above zero; "
                           "they are " +
                           text_of(time.cfl) + " and " + text_of(time.safety) +
                           "."));
    for (unsigned int w = 0; w < 6; ++w)
      AssertThrow((walls.friction[w] == 0. || walls.type[w] == "friction") &&
                    (w < 2 * dim || walls.type[w] == "free"),
                  ExcMessage("The wall '" + WallParameters::names[w] + "' is " +
                             walls.type[w] +
                             (w < 2 * dim ? ", but has a friction."
                                          : ", but there is none in 2D.")));
  }



  void
  SimulationParameters::check_total_lagrangian() const
  {
    const auto refuse = [&](const bool         wrong,
                            const std::string &parameter,
                            const std::string &why) {
      AssertThrow(!wrong,
                  ExcMessage("'Scheme/Formulation' = total Lagrangian does not "
                             "go with " +
                             parameter + ": " + why));
    };
    refuse(scheme.transfer == "APIC",
           "'Scheme/Transfer' = APIC",
           "take FLIP or PIC.");
    refuse(scheme.quadrature != "points",
           "'Scheme/Quadrature' = " + scheme.quadrature,
           "take points, which stay where they are in their cells.");
    for (unsigned int w = 0; w < 2 * general.dimension; ++w)
      refuse(walls.type[w] == "friction",
             "'Walls/" + WallParameters::names[w] + "' = friction",
             "walls act on the initial configuration, which does not slide "
             "along them.");
    for (const auto &[name, body] : bodies)
      refuse(!body.imposed_velocity.empty(),
             "'Body " + name + "/Imposed velocity'",
             "bodies do not see one another.");
  }
} // namespace greville
