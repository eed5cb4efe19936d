// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The accepted spurious energy, as a fraction of the largest energy or
    // work.
    constexpr double accepted_gain = 0.1;
  } // namespace



  template <int dim>
  std::vector<std::optional<double>>
  BodyContacts<dim>::given_energies(double &largest) const
  {
    // The work of each source in each part.
    std::vector<double>      works;
    std::vector<std::size_t> firsts;
    for (const Simulation<dim> *part : parts)
      {
        const State<dim> &state = part->current;
        firsts.push_back(works.size());
        for (unsigned int k = 0;
             k < EnergyBalance::surfaces + state.surfaces.size();
             ++k)
          works.push_back(state.energy.work(k, MPI_COMM_SELF));
      }
    Utilities::MPI::sum(works, comm, works);
    firsts.push_back(works.size());
    largest = 0.;
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        double of_part = parts[k]->current.energy.largest_with(EnergyTotals());
        for (std::size_t i = firsts[k]; i < firsts[k + 1]; ++i)
          of_part = std::max(of_part, std::abs(works[i]));
        largest += of_part;
      }

    std::vector<std::optional<double>> result;
    for (const Contact &contact : contacts)
      {
        result.emplace_back();
        if (contact.rigid >= 0)
          {
            const RigidPosition<dim> &now =
              parts.front()->current.rigid_bodies[contact.rigid].now;
            if (now.displacement.norm() + now.velocity.norm() +
                  now.spin.norm() >
                0.)
              continue;
          }
        double &given = result.back().emplace(0.);
        for (const auto &side : contact.sides)
          for (const Place &place : side)
            {
              const auto part =
                std::find(parts.begin(), parts.end(), place.part);
              given += works[firsts[part - parts.begin()] +
                             EnergyBalance::surfaces + place.surface];
            }
      }
    return result;
  }



  template <int dim>
  std::vector<std::pair<std::string, double>>
  BodyContacts<dim>::gains() const
  {
    double                                      largest;
    const auto                                  given = given_energies(largest);
    std::vector<std::pair<std::string, double>> result;
    for (unsigned int k = 0; k < contacts.size(); ++k)
      if (given[k])
        result.emplace_back(contacts[k].name,
                            largest > 0. ? *given[k] / largest : 0.);
    return result;
  }



  template <int dim>
  void
  BodyContacts<dim>::check_gains()
  {
    const SchemeParameters &scheme = parts.front()->stage_parameters().scheme;
    if (are_implicit || !scheme.looks_at_energy())
      return;
    double     largest;
    const auto given = given_energies(largest);
    for (unsigned int k = 0; k < contacts.size(); ++k)
      {
        if (!given[k])
          continue;
        Contact           &contact = contacts[k];
        const std::string &name    = contact.name;
        // A resumed run does not know the energy that was stored at its start.
        if (!contact.is_start_counted && parts.front()->current.n_steps > 1)
          contact.stored_energy += std::max(*given[k], 0.);
        contact.is_start_counted = true;
        const double gain = (*given[k] - contact.stored_energy) / largest;
        if (!(gain > std::max(accepted_gain, 2. * contact.warned_gain)))
          continue;
        contact.warned_gain = gain;
        const std::string message =
          "energy has come from nothing: the surfaces of 'Contact " + name +
          "' have given " + text_of(100. * gain) +
          " % of the largest energy or work of one source so far to the "
          "bodies, "
          "beyond what they have taken. Take a smaller 'Time/Safety' (or a "
          "shorter 'Time/Step'), a smaller 'Contact " +
          name + "/Penalty', or more 'Points per direction'";
        if (scheme.stops_at_energy_gain())
          fail_on_all(message + " ('Scheme/Energy gain' = warn continues)",
                      comm);
        parts.front()->log.warnings.push_back(
          "Step " + std::to_string(parts.front()->current.n_steps) + ": " +
          message + ".");
      }
  }



  template std::vector<std::optional<double>>
  BodyContacts<2>::given_energies(double &) const;
  template std::vector<std::optional<double>>
  BodyContacts<3>::given_energies(double &) const;
  template std::vector<std::pair<std::string, double>>
  BodyContacts<2>::gains() const;
  template std::vector<std::pair<std::string, double>>
  BodyContacts<3>::gains() const;
  template void
  BodyContacts<2>::check_gains();
  template void
  BodyContacts<3>::check_gains();
} // namespace greville
