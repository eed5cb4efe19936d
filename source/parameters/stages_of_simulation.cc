// SPDX-License-Identifier: LGPL-2.1-or-later

// The stages of a simulation, with their bodies and materials.

#include <deal.II/base/utilities.h>

#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;

  namespace
  {
    void
    check_name(const std::string              &parameter,
               const std::string              &name,
               const std::string              &kind,
               const std::vector<std::string> &names)
    {
      Require(contains(names, name),
              "The parameter '" + parameter + "' names <" + name +
                ">, which is not one of 'Simulation/" + kind +
                "': " + boost::algorithm::join(names, ", ") + "." +
                did_you_mean(name, names));
    }
  } // namespace



  void
  SimulationParameters::enter_stage(const unsigned int stage)
  {
    if (stages.empty())
      return;
    AssertThrow(stage < stages.size(), ExcIndexRange(stage, 0, stages.size()));
    static_cast<StageSections &>(*this) = stages[stage];
    if (stage > 0)
      time.start = stages[stage - 1].time.end;
    for (const auto &[body, material] : stages[stage].material_of)
      bodies.at(body).material = material;
  }



  bool
  SimulationParameters::has_ramp() const
  {
    return stages.empty()
             ? !time.ramp.empty()
             : std::any_of(stages.begin(), stages.end(), [](const auto &stage) {
                 return !stage.time.ramp.empty();
               });
  }



  bool
  SimulationParameters::changes_bodies(const unsigned int stage) const
  {
    if (stage == 0)
      return false;
    return stages[stage].material_of != stages[stage - 1].material_of ||
           std::any_of(general.bodies.begin(),
                       general.bodies.end(),
                       [&](const std::string &name) {
                         return is_in_stage(name, stage) !=
                                is_in_stage(name, stage - 1);
                       });
  }



  void
  SimulationParameters::find_materials()
  {
    for (StageParameters &stage : stages)
      {
        for (const auto &[name, body] : bodies)
          stage.material_of[name] = body.material;
        const std::string parameter = "Stage " + stage.name + "/Materials";
        std::vector<std::string> named;
        for (const std::string &text : stage.materials)
          {
            const std::size_t colon = text.find(':');
            Require(colon != std::string::npos,
                    "The parameter '" + parameter +
                      "' takes pairs of a body and a material, such as 'clay: "
                      "weak clay', not <" +
                      text + ">.");
            const std::string body = Utilities::trim(text.substr(0, colon));
            const std::string law  = Utilities::trim(text.substr(colon + 1));
            check_name(parameter, body, "Bodies", general.bodies);
            check_name(parameter, law, "Materials", general.materials);
            Require(stage.has_all_bodies() || stage.bodies.empty() ||
                      contains(stage.bodies, body),
                    "The parameter '" + parameter + "' names the body <" +
                      body + ">, which is not in this stage: 'Stage " +
                      stage.name + "/Bodies' is " +
                      boost::algorithm::join(stage.bodies, ", ") + ".");
            named.push_back(body);
            stage.material_of[body] = law;
          }
        check_different(named, parameter, "body");
      }
  }



  void
  SimulationParameters::check_construction() const
  {
    const auto groups = body_groups();
    for (unsigned int k = 0; k < stages.size(); ++k)
      {
        const StageParameters &stage     = stages[k];
        const std::string      parameter = "Stage " + stage.name + "/Bodies";
        Require(
          !stage.bodies.empty(),
          "The parameter '" + parameter +
            "' is empty: a stage needs a body. Give names of bodies, or all.");
        if (stage.has_all_bodies())
          continue;
        check_different(stage.bodies, parameter, "body");
        for (const std::string &name : stage.bodies)
          check_name(parameter, name, "Bodies", general.bodies);
      }
    for (const std::string &name : general.bodies)
      {
        unsigned int n = 0, last = 0;
        for (unsigned int k = 0; k < stages.size(); ++k)
          if (is_in_stage(name, k))
            {
              Require(
                n == 0 || last + 1 == k,
                stage_text(k) + "the body <" + name +
                  "> was removed before ('Stage " + stages[last + 1].name +
                  "/Bodies' does not name it) and cannot return. Add another "
                  "body of the same shape, with its own name and section.");
              ++n;
              last = k;
            }
        if (n == stages.size())
          continue;
        Require(n > 0,
                "'Body " + name +
                  "' is in no stage: no 'Stage NAME/Bodies' names it.");
        Require(!scheme.is_total_lagrangian(),
                "'Body " + name +
                  "' appears or disappears ('Stage NAME/Bodies'), but bodies "
                  "do not interact with 'Scheme/Formulation' = total "
                  "Lagrangian. Take updated Lagrangian.");
        for (const auto &[contact, given] : contacts)
          for (const auto &side : given.sides())
            Require(!contains(side, name),
                    "'Contact " + contact + "/Bodies' has <" + name +
                      ">, which appears or disappears ('Stage NAME/Bodies'): "
                      "bodies in contacts have to be in all stages.");
      }
    for (unsigned int k = 0; k < stages.size(); ++k)
      {
        for (const auto &group : groups)
          Require(std::any_of(group.begin(),
                              group.end(),
                              [&](const std::string &name) {
                                return is_in_stage(name, k);
                              }),
                  stage_text(k) + "none of the bodies <" +
                    boost::algorithm::join(group, ", ") +
                    "> is in 'Bodies': they share a velocity field that no "
                    "contact names, and it needs one of them.");
        for (const auto &[name, material] : stages[k].material_of)
          for (const auto &contact : contacts)
            for (const auto &side : contact.second.sides())
              Require(!contains(side, name) ||
                        material == stages[0].material_of.at(name),
                      stage_text(k) + "'Materials' gives 'Body " + name +
                        "' another material, but 'Contact " + contact.first +
                        "/Bodies' names it: bodies in contacts keep their "
                        "material, because the penalty depends on it.");
      }
  }
} // namespace greville
