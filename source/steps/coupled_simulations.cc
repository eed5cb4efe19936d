// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_grids.h>
#include <greville/steps/common_step.h>
#include <greville/steps/coupled_simulations.h>
#include <greville/steps/stage_bodies.h>
#include <greville/steps/state_tables.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  CoupledSimulations<dim>::CoupledSimulations(
    const SimulationParameters &parameters, const MPI_Comm comm)
    : comm(comm)
    , runout_above(parameters.output.runout_above)
    , load_names(parameters.general.surface_loads)
  {
    for (const auto &part : split_by_grids<dim>(parameters, comm))
      parts.push_back(std::make_unique<Simulation<dim>>(part, comm));
    for (const auto &part : parts)
      if (parts.size() > 1)
        part->step_log().of = " of 'Body " + part->state().bodies[0].name + "'";
    unsigned int n_levels = 0;
    for (const auto &part : parts)
      n_levels = std::max(n_levels, part->space().n_used_levels());
    Require(!parameters.grid.is_refined() ||
              parameters.grid.has_changing_cells() ||
              n_levels == parameters.grid.n_levels() + 1,
            "The regions of 'Grid/Refinement' contain no cell of the grid that "
            "is halved " +
              std::to_string(parameters.grid.n_levels()) +
              " times: check their 'Shape'.");
    if (!parameters.contacts.empty())
      contacts =
        std::make_unique<BodyContacts<dim>>(parameters, pointers(), comm);
  }



  template <int dim>
  std::vector<Simulation<dim> *>
  CoupledSimulations<dim>::pointers() const
  {
    std::vector<Simulation<dim> *> result;
    for (const auto &part : parts)
      result.push_back(part.get());
    return result;
  }



  template <int dim>
  const std::vector<RigidBody<dim>> &
  CoupledSimulations<dim>::rigid_bodies() const
  {
    static const std::vector<RigidBody<dim>> none;
    return contacts ? contacts->all_rigid_bodies() : none;
  }



  template <int dim>
  void
  CoupledSimulations<dim>::step()
  {
    CommonStep<dim>(pointers(), contacts.get()).take();
  }



  template <int dim>
  bool
  CoupledSimulations<dim>::is_finished() const
  {
    return exceeds_displacement() ||
           std::all_of(parts.begin(), parts.end(), [](const auto &part) {
             return part->is_finished();
           });
  }



  template <int dim>
  bool
  CoupledSimulations<dim>::exceeds_displacement() const
  {
    return std::any_of(parts.begin(), parts.end(), [](const auto &part) {
      return part->exceeds_displacement();
    });
  }



  template <int dim>
  std::vector<State<dim>>
  CoupledSimulations<dim>::state() const
  {
    std::vector<State<dim>> states;
    for (const auto &part : parts)
      states.push_back(part->state());
    return states;
  }



  template <int dim>
  void
  CoupledSimulations<dim>::set_state(const std::vector<State<dim>> &states)
  {
    AssertThrow(states.size() == parts.size(),
                ExcDimensionMismatch(states.size(), parts.size()));
    // If the entry into a stage fails, all parts return to their old state.
    std::vector<State<dim>> before;
    for (unsigned int k = 0; k < parts.size() && before.empty(); ++k)
      if (states[k].stage != part(k).state().stage)
        before = state();
    try
      {
        for (unsigned int k = 0; k < parts.size(); ++k)
          parts[k]->set_state(states[k]);
      }
    catch (const ErrorOnAll &)
      {
        for (unsigned int k = 0; k < before.size(); ++k)
          parts[k]->set_state(before[k]);
        throw;
      }
  }



  template <int dim>
  std::string
  CoupledSimulations<dim>::prefix(const unsigned int k) const
  {
    return parts.size() == 1 ? "" : part(k).bodies()[0].name + ": ";
  }



  template <int dim>
  std::vector<DistributedTable>
  CoupledSimulations<dim>::tables() const
  {
    std::vector<DistributedTable> tables;
    for (unsigned int k = 0; k < parts.size(); ++k)
      for (DistributedTable &table :
           make_tables(part(k).state(), part(k).space(), prefix(k)))
        tables.push_back(std::move(table));
    return tables;
  }



  template <int dim>
  void
  CoupledSimulations<dim>::set_from_tables(const TablesFile &content)
  {
    std::vector<State<dim>> states;
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        states.push_back(parts[k]->state());
        greville::set_from_tables(states[k],
                                  content,
                                  parts[k]->grid(),
                                  prefix(k),
                                  &parts[k]->stage_parameters());
      }
    set_state(states);
  }



  template <int dim>
  BodyList<dim>
  CoupledSimulations<dim>::bodies() const
  {
    BodyList<dim> list;
    for (const auto &part : parts)
      list.add(static_cast<const Simulation<dim> &>(*part).bodies());
    return list;
  }



  template <int dim>
  typename CoupledSimulations<dim>::AllBodies
  CoupledSimulations<dim>::bodies_of_all_stages()
  {
    AllBodies                   all;
    const SimulationParameters &parameters = first().stage_parameters();
    for (const auto &part : parts)
      for (Body<dim> &body : make_later_bodies(part->state().bodies,
                                               part->stage_parameters(),
                                               part->grid()))
        all.later.push_back(std::move(body));
    for (const StageParameters &stage : parameters.stages)
      for (const auto &[name, material] : stage.material_of)
        if (material != parameters.stages[0].material_of.at(name))
          {
            Body<dim> body;
            all.parameters.push_back(parameters.bodies.at(name));
            all.parameters.back().material = material;
            body.parameters                = &all.parameters.back();
            body.material = parameters.materials.at(material).get();
            body.points.reinit(first().space(), PointLayout<dim>());
            all.of_materials.push_back(std::move(body));
          }
    all.list = bodies();
    all.list.put(all.later);
    all.list.add(all.of_materials);
    return all;
  }



  template <int dim>
  Statistics<dim>
  CoupledSimulations<dim>::statistics()
  {
    find_contact();
    Statistics<dim> result = first().statistics();
    for (unsigned int k = 1; k < parts.size(); ++k)
      result.add(part(k).statistics());
    if (parts.size() > 1)
      result.runout_99 = runout_quantile(bodies(), comm, runout_above);
    sort_loads(result);
    if (contacts)
      contacts->add_to(result, false);
    return result;
  }



  template <int dim>
  void
  CoupledSimulations<dim>::finish()
  {
    find_contact();
    for (const auto &part : parts)
      part->finish();
  }



  template <int dim>
  void
  CoupledSimulations<dim>::show_finished(const std::function<void()> &show)
  {
    find_contact();
    std::function<void()> all = show;
    for (const auto &part : parts)
      all = [&part = *part, all]() { part.show_finished(all); };
    all();
  }



  template <int dim>
  void
  CoupledSimulations<dim>::ask_for_row(
    const std::function<void(const unsigned int, const double, const bool)>
                                                  &watch,
    const std::function<void(const unsigned int)> &show)
  {
    const double outer_mass =
      1.01 * mass_beyond_runout *
      sum([](const Simulation<dim> &part) { return part.state().mass; });
    using namespace std::placeholders;
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        decltype(LateRow<dim>::watch) watch_part;
        decltype(LateRow<dim>::show)  show_part;
        if (watch)
          watch_part = std::bind(watch, k, _1, _2);
        if (show)
          show_part = std::bind(show, k);
        parts[k]->ask_for_row(outer_mass, watch_part, show_part);
      }
  }



  template <int dim>
  Statistics<dim>
  CoupledSimulations<dim>::late_statistics() const
  {
    for (const auto &part : parts)
      AssertThrow(part->late_row().is_known,
                  ErrorOnAll("The last step has summed up no row: it was not "
                             "asked for one, or its integrator's velocities "
                             "lag and it knows no LateRow."));
    Statistics<dim> result = first().late_statistics();
    for (unsigned int k = 1; k < parts.size(); ++k)
      result.add(part(k).late_statistics());
    if (parts.size() > 1)
      {
        std::vector<const RowSums<dim> *> sums;
        for (const auto &part : parts)
          for (const RowSums<dim> &own : part->late_row().sums)
            sums.push_back(&own);
        result.runout_99 = runout_quantile(sums, comm);
      }
    sort_loads(result);
    if (contacts)
      contacts->add_to(result, true);
    return result;
  }



  template <int dim>
  void
  CoupledSimulations<dim>::sort_loads(Statistics<dim> &row) const
  {
    const auto loads = row.loads;
    const auto work  = row.work.surfaces;
    row.loads.clear();
    row.work.surfaces.clear();
    for (const std::string &name : load_names)
      for (unsigned int k = 0; k < loads.size(); ++k)
        if (loads[k].first == name)
          {
            row.loads.push_back(loads[k]);
            row.work.surfaces.push_back(work[k]);
          }
  }



  namespace
  {
    /// Return the messages in the logs of the parts, with the bodies if there
    /// are several parts.
    template <typename Parts>
    std::vector<std::string>
    take_messages(const Parts &parts,
                  std::vector<std::string> (StepLog::*take)())
    {
      std::vector<std::string> result;
      for (const auto &part : parts)
        for (const std::string &message : (part->step_log().*take)())
          result.push_back((parts.size() > 1
                              ? "Body " + part->state().bodies[0].name + ": "
                              : "") +
                           message);
      return result;
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  CoupledSimulations<dim>::take_warnings()
  {
    return take_messages(parts, &StepLog::take_warnings);
  }



  template <int dim>
  std::vector<std::string>
  CoupledSimulations<dim>::take_cuts()
  {
    return take_messages(parts, &StepLog::take_cuts);
  }



  template <int dim>
  std::vector<NewtonRecord>
  CoupledSimulations<dim>::take_newton()
  {
    std::vector<NewtonRecord> result;
    for (unsigned int k = 0; k < parts.size(); ++k)
      for (NewtonRecord &record : parts[k]->step_log().take_newton())
        {
          record.part = k + 1;
          result.push_back(std::move(record));
        }
    return result;
  }



  template <int dim>
  std::map<std::string, double>
  CoupledSimulations<dim>::part_times() const
  {
    std::map<std::string, double> result;
    for (const auto &part : parts)
      for (const auto &[name, seconds] : part->step_log().seconds)
        result[name] += seconds;
    return result;
  }



  template <int dim>
  std::size_t
  CoupledSimulations<dim>::points_memory() const
  {
    return sum([](const auto &part) { return part.points_memory(); });
  }



  GREVILLE_INSTANTIATE_CLASS(CoupledSimulations);
} // namespace greville
