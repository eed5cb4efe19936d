// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/body_contacts.h>

#include <list>

namespace greville
{
  /// The simulations of a parameter file, called parts. If bodies have grids of
  /// their own or there are contacts, each group of bodies with a common
  /// velocity field is a part; otherwise there is one part. Contacts couple the
  /// parts, which take common steps.
  template <int dim>
  class CoupledSimulations
  {
  public:
    /// Collective. Throws dealii::ExcMessage for invalid parameters.
    CoupledSimulations(const SimulationParameters &parameters,
                       const MPI_Comm              comm = MPI_COMM_WORLD);

    /// Collective. See Simulation::fill_grid().
    void
    fill_grid()
    {
      for (const auto &part : parts)
        part->fill_grid();
    }

    /// Collective. Take a common step of all parts, see Simulation::step().
    void
    step();

    bool
    is_finished() const;

    /// Return whether a part exceeds its largest displacement, which ends the
    /// run.
    bool
    exceeds_displacement() const;

    unsigned int
    n_parts() const
    {
      return parts.size();
    }

    /// Return a part. Parts with one body each have the order of the bodies.
    Simulation<dim> &
    part(const unsigned int k)
    {
      return *parts[k];
    }

    const Simulation<dim> &
    part(const unsigned int k) const
    {
      return *parts[k];
    }

    /// Return the first part. Its times, numbers of steps and stage are common
    /// to all parts.
    const Simulation<dim> &
    first() const
    {
      return *parts.front();
    }

    /// Return the states of all parts, a value to restore later.
    std::vector<State<dim>>
    state() const;

    /// Collective. See Simulation::set_state().
    void
    set_state(const std::vector<State<dim>> &states);

    /// See BodyContacts::intervals(); none without contacts.
    std::vector<ContactInterval<dim>>
    contact_intervals() const
    {
      return contacts ? contacts->intervals()
                      : std::vector<ContactInterval<dim>>();
    }

    /// Collective. See BodyContacts::gains(); none without contacts.
    std::vector<std::pair<std::string, double>>
    contact_gains() const
    {
      return contacts ? contacts->gains()
                      : std::vector<std::pair<std::string, double>>();
    }

    /// See BodyContacts::notes(); none without contacts.
    std::vector<std::string>
    notes() const
    {
      return contacts ? contacts->notes() : std::vector<std::string>();
    }

    void
    set_contact_intervals(const std::vector<ContactInterval<dim>> &intervals)
    {
      if (contacts)
        contacts->set_intervals(intervals);
    }

    /// Collective. Return the states as tables, see make_tables().
    std::vector<DistributedTable>
    tables() const;

    /// Collective. Continue from tables() of simulations with the same
    /// parameters. Later steps are bitwise equal on the same number of
    /// processes.
    void
    set_from_tables(const TablesFile &content);

    /// Collective. See Simulation::begin_with().
    void
    begin_with(const TablesFile &content)
    {
      for (const auto &part : parts)
        part->begin_with(content);
    }

    /// Return all bodies. The list is valid until the next step.
    BodyList<dim>
    bodies() const;

    /// The bodies of all stages. Bodies of later stages are made as if they
    /// were added now. Materials that stages assign have bodies without points.
    struct AllBodies
    {
      std::vector<Body<dim>>    later, of_materials;
      std::list<BodyParameters> parameters; // of later bodies and of_materials
      BodyList<dim>             list;
    };

    /// Collective. Before the first step. See make_later_bodies().
    AllBodies
    bodies_of_all_stages();

    /// Collective. Compute contact in the current states: loads of surfaces.
    void
    find_contact()
    {
      if (contacts)
        contacts->act();
    }

    /// Return the rigid bodies of State::rigid_bodies.
    const std::vector<RigidBody<dim>> &
    rigid_bodies() const;

    /// Collective. Return sums and extremes over all parts, with the contacts
    /// of find_contact().
    Statistics<dim>
    statistics();

    bool
    rows_are_late() const
    {
      return first().rows_are_late();
    }

    /// Collective. See Simulation::finish(); contacts are found before it.
    void
    finish();

    /// Collective. See Simulation::show_finished().
    void
    show_finished(const std::function<void()> &show);

    /// Collective. Request that the next step sums up the row of the current
    /// state of all parts, see Simulation. @p watch and @p show also receive
    /// the number of the part.
    void
    ask_for_row(const std::function<void(const unsigned int part,
                                         const double       weight,
                                         const bool is_kicked)>    &watch = {},
                const std::function<void(const unsigned int part)> &show  = {});

    /// Collective. Return the row that the last step has summed up.
    Statistics<dim>
    late_statistics() const;

    /// Return warnings since the last call, with the body if there are several.
    std::vector<std::string>
    take_warnings();

    /// Return the reasons for shortening the last step, and remove them.
    std::vector<std::string>
    take_cuts();

    /// Return the records of Newton's method in the last step, and remove them.
    std::vector<NewtonRecord>
    take_newton();

    /// Return StepLog::seconds, added up over the parts.
    std::map<std::string, double>
    part_times() const;

    std::size_t
    points_memory() const;

    /// Return the sum of @p value(part), or of a number of the states.
    template <typename Value>
    auto
    sum(const Value &value) const
    {
      auto result = value(first());
      for (unsigned int k = 1; k < parts.size(); ++k)
        result += value(part(k));
      return result;
    }

    template <typename T, typename Base>
    T
    sum(T Base::*number) const
    {
      return sum([&](const auto &part) { return part.state().*number; });
    }

  private:
    /// Return the prefix of the names of a part's tables.
    std::string
    prefix(const unsigned int part) const;

    std::vector<Simulation<dim> *>
    pointers() const;

    /// Sort the loads of all parts in the order of the columns.
    void
    sort_loads(Statistics<dim> &row) const;

    const MPI_Comm comm;
    const double   runout_above;
    // The parts must not move in memory, since their members refer to them.
    std::vector<std::unique_ptr<Simulation<dim>>> parts;
    std::unique_ptr<BodyContacts<dim>>            contacts;
    std::vector<std::string>                      load_names;
  };
} // namespace greville
