// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/trial_contacts.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The search distance for the other side in a trial, in cells.
    constexpr double trial_reach = 1.;

    // Uzawa's method ends if pressures change by less than this fraction of the
    // largest one, or after this number of rounds.
    constexpr double       augmented_tolerance = 1e-3;
    constexpr unsigned int most_rounds         = 5;



    /// Return whether a key has begun, stopped or reversed sliding. The
    /// arguments are KeyMemory::sliding before and now.
    template <typename Directions>
    bool
    slides_otherwise(const Directions &before, const Directions &now)
    {
      for (const auto &[key, direction] : now)
        {
          const auto last = before.find(key);
          const bool did  = last != before.end() && last->second.norm() > 0.,
                     does = direction.norm() > 0.;
          if (did != does || (did && direction * last->second < 0.))
            return true;
        }
      return false;
    }
  } // namespace



  template <int dim>
  TrialContacts<dim>::TrialContacts(
    BodyContacts<dim>                       &contacts,
    const std::vector<ImplicitSteps<dim> *> &steps,
    const double                             dt)
    : contacts(contacts)
    , steps(steps)
    , dt(dt)
    , share(steps.front()->scheme.load_time)
    , weight(steps.front()->scheme.contact_weight())
    , surfaces(steps.size())
    , points(contacts.contacts.size())
    , results(contacts.contacts.size())
    , tangents(contacts.contacts.size())
    , forces(steps.size())
    , memories(contacts.contacts.size())
    , n_changes(contacts.contacts.size(), 0)
    , directions(steps.size())
    , products(steps.size())
    , displacements(contacts.contacts.size())
    , relative(contacts.contacts.size())
    , changes(contacts.contacts.size())
    , pore_pressures(contacts.contacts.size())
  {
    contacts.set_laws();
    for (Contact &contact : contacts.contacts)
      if (contact.given.is_by_material_points())
        contacts.renew_contactors(contact);
    contacts.commit();
    for (const auto &body : contacts.parts.front()->current.rigid_bodies)
      at_start.push_back(body.now);
    for (const auto &body : contacts.moved_bodies(share * dt))
      at_trial.push_back(body.now);
    for (const auto &body : contacts.moved_bodies(dt))
      at_end.push_back(body.now);

    const State<dim> &state = contacts.parts.front()->current;
    for (unsigned int k = 0; k < at_start.size(); ++k)
      if (contacts.rigid_bodies[k].is_free())
        {
          const RigidStep<dim> step = contacts.rigid_step(
            k, state.time + steps.front()->scheme.load_time * dt);
          free_bodies.push_back({k,
                                 RigidTrial<dim>(contacts.rigid_bodies[k],
                                                 at_start[k],
                                                 step.gravity,
                                                 steps.front()->scheme,
                                                 dt),
                                 {},
                                 {},
                                 FullMatrix<double>()});
        }

    for (unsigned int c = 0; c < contacts.contacts.size(); ++c)
      {
        std::size_t n = 0;
        for (unsigned int s = 0; s < 2; ++s)
          for (const Place &place : contacts.contacts[c].sides[s])
            {
              const unsigned int part = std::find(contacts.parts.begin(),
                                                  contacts.parts.end(),
                                                  place.part) -
                                        contacts.parts.begin();
              sides.push_back({c, s, part, place.surface, n, n});
              n += points_of(sides.back()).n_points();
              sides.back().end = n;
              surfaces[part].push_back(&points_of(sides.back()));
            }
        points[c].resize(n);
        for (const Side &side : sides)
          if (side.contact == c)
            {
              const MaterialPoints<dim> &of_side = points_of(side);
              ContactPoint<dim>         *point = points[c].data() + side.begin;
              of_side.for_each(
                [&](const unsigned int cell, const ConstPointRef<dim> p) {
                  point->cell_size =
                    contacts.contacts[c].cell_size_at(of_side.space(),
                                                      cell,
                                                      p.position());
                  ++point;
                });
            }
        displacements[c].resize(n);
        pore_pressures[c].resize(n, 0.);
      }
    for (unsigned int k = 0; k < steps.size(); ++k)
      for (VectorField<dim> *field : {&forces[k], &directions[k], &products[k]})
        for (VectorType &component : *field)
          steps[k]->system.space().initialize_vector(component);
  }



  template <int dim>
  const MaterialPoints<dim> &
  TrialContacts<dim>::points_of(const Side &side) const
  {
    return contacts.parts[side.part]->current.surfaces[side.surface].points;
  }



  template <int dim>
  bool
  TrialContacts<dim>::friction_depends_on_pores() const
  {
    return !is_symmetric() &&
           std::any_of(steps.begin(), steps.end(), [](const auto *part) {
             return part->water != nullptr;
           });
  }



  template <int dim>
  void
  TrialContacts<dim>::find_pore_pressures(const std::vector<VectorType> &blocks)
  {
    for (unsigned int part = 0; part < steps.size(); ++part)
      if (steps[part]->water)
        {
          const auto values =
            steps[part]->water->at_surfaces(blocks[steps.size() + part],
                                            surfaces[part]);
          auto of_side = values.begin();
          for (const Side &side : sides)
            if (side.part == part)
              {
                std::copy(of_side->begin(),
                          of_side->end(),
                          pore_pressures[side.contact].begin() + side.begin);
                ++of_side;
              }
        }
  }



  template <int dim>
  void
  TrialContacts<dim>::set_pore_pressures(const std::vector<VectorType> &blocks)
  {
    if (!friction_depends_on_pores())
      return;
    find_pore_pressures(blocks);
    for (unsigned int c = 0; c < points.size(); ++c)
      for (std::size_t s = 0; s < points[c].size(); ++s)
        points[c][s].pore_pressure = pore_pressures[c][s];
  }



  template <int dim>
  std::string
  TrialContacts<dim>::check_rigid_bodies() const
  {
    for (const Contact &contact : contacts.contacts)
      {
        if (contact.rigid < 0)
          continue;
        const double way = (at_end[contact.rigid].displacement -
                            at_start[contact.rigid].displacement)
                             .norm();
        if (way <= BodyContacts<dim>::longest_trial_motion * contact.smallest)
          continue;
        return "'Rigid body " + contacts.rigid_bodies[contact.rigid].name() +
               "' would move by " + text_of(way) +
               " m, more than half of a cell, so that it might pass "
               "through the other side of 'Contact " +
               contact.name + "'";
      }
    return "";
  }



  template <int dim>
  void
  TrialContacts<dim>::move_points(const unsigned int contact,
                                  const double       share_now)
  {
    for (const Side &side : sides)
      {
        if (side.contact != contact)
          continue;
        const auto             &layout = points_of(side).layout();
        const unsigned int      slip   = layout.first("slip");
        const unsigned int      load   = layout.first("load");
        const PointField *const radius = layout.find("radius");
        const bool augmented = contacts.contacts[contact].given.is_augmented();
        SurfaceMotion<dim>  motion;
        ContactPoint<dim>  *point      = points[contact].data() + side.begin;
        ImplicitSteps<dim> &integrator = *steps[side.part];
        motion.share                   = share_now;
        integrator.system.surfaces().move(
          points_of(side),
          integrator.displacement,
          motion,
          [&](const ConstPointRef<dim> p, const SurfaceState<dim> &state) {
            point->side = side.side;
            BodyContacts<dim>::set_place(*point, p, state, radius);
            // Areas are taken at the start of the step.
            const SurfaceState<dim> start  = surface_state<dim>(p, layout);
            const Tensor<1, dim>    normal = start.area_vector();
            if (start.is_axisymmetric)
              point->thickness = start.x[0];
            if (point->normal.norm_square() > 0.)
              point->area = p.mass() * normal.norm();
            point->motion           = state.x - p.position();
            point->offset_from_hats = point->motion;
            if (contacts.contacts[contact].rigid < 0 && normal.norm() > 0.)
              point->offset_from_hats -=
                0.5 * p[layout.first("gap")] * normal / normal.norm();
            point->slip = p.vector(slip);
            if (augmented)
              point->start_pressure =
                std::max(0., -(p.vector(load) * normal)) / normal.norm_square();
            ++point;
          });
      }
  }



  template <int dim>
  std::string
  TrialContacts<dim>::find_forces(const double share_now,
                                  const bool   with_stiffness)
  {
    const std::vector<RigidPosition<dim>> &positions =
      share_now == share ? at_trial : at_end;
    for (unsigned int c = 0; c < contacts.contacts.size(); ++c)
      {
        const Contact &contact = contacts.contacts[c];
        Point<dim>     about;
        move_points(c, share_now);
        if (contact.rigid >= 0)
          {
            const RigidPosition<dim> &now = positions[contact.rigid];
            about = current_position(now, now.reference);
            try
              {
                run_on_all(contacts.comm, [&]() {
                  contacts.rigid_bodies[contact.rigid].find_gaps(
                    points[c], trial_reach, now, at_start[contact.rigid]);
                });
              }
            catch (const ErrorOnAll &error)
              {
                return message_of(error);
              }
          }
        else
          contacts.search.find_gaps(points[c], trial_reach);
        const auto before = with_stiffness ? memories[c].sliding
                                           : decltype(memories[c].sliding)();
        results[c] =
          contact.average->act(points[c],
                               share_now * dt,
                               about,
                               with_stiffness ? &tangents[c] : nullptr,
                               &memories[c],
                               share_now);
        if (with_stiffness && slides_otherwise(before, memories[c].sliding))
          ++n_changes[c];
      }
    n_tangents += with_stiffness;
    return "";
  }



  template <int dim>
  std::string
  TrialContacts<dim>::describe_changes() const
  {
    // With a larger penalty, the contact is stiffer than the bodies.
    constexpr double   soft_penalty = 1.;
    std::ostringstream text;
    for (unsigned int c = 0; c < n_changes.size(); ++c)
      {
        const Contact &contact = contacts.contacts[c];
        const double   penalty =
          contact.average->law().stiffness * contact.smallest / contact.modulus;
        const unsigned int n = Utilities::MPI::max(n_changes[c], contacts.comm);
        if (2 * n >= n_tangents && n > 0 && penalty > 1.001 * soft_penalty)
          text << "; 'Contact " << contact.name
               << "' keeps changing between sticking and sliding: if that is "
                  "the reason, a smaller 'Contact "
               << contact.name << "/Penalty' than " << penalty << " helps";
      }
    return text.str();
  }



  template <int dim>
  std::string
  TrialContacts<dim>::evaluate(const bool with_stiffness)
  {
    const std::string problem = find_forces(share, with_stiffness);
    if (!problem.empty())
      return problem;
    std::vector<std::vector<Tensor<1, dim>>> of_points(steps.size());
    std::vector<std::vector<double>>         norms(steps.size());
    for (const Side &side : sides)
      for (std::size_t s = side.begin; s < side.end; ++s)
        {
          of_points[side.part].push_back(weight *
                                         points[side.contact][s].force);
          norms[side.part].push_back(weight * share *
                                     points[side.contact][s].stiffness.norm());
        }
    for (unsigned int k = 0; k < steps.size(); ++k)
      {
        steps[k]->system.surfaces().spread(surfaces[k],
                                           of_points[k],
                                           forces[k]);
        if (with_stiffness)
          steps[k]->system.surfaces().set_stiffness_of_points(surfaces[k],
                                                              norms[k]);
      }
    if (with_stiffness)
      find_rigid_tangents();
    return "";
  }



  template <int dim>
  bool
  TrialContacts<dim>::is_symmetric() const
  {
    return std::all_of(contacts.contacts.begin(),
                       contacts.contacts.end(),
                       [](const Contact &contact) {
                         const auto &friction = contact.average->law().friction;
                         return !friction || friction->is_symmetric();
                       });
  }



  template <int dim>
  void
  TrialContacts<dim>::add_product(std::vector<VectorType>       &dst,
                                  const std::vector<VectorType> &src)
  {
    // The velocity of a surface state is then the displacement times share.
    SurfaceMotion<dim> motion;
    motion.share  = 0.;
    motion.v_by_u = share;
    for (unsigned int k = 0; k < steps.size(); ++k)
      steps[k]->system.extend(directions[k], src[k]);
    for (const Side &side : sides)
      {
        Tensor<1, dim> *u = displacements[side.contact].data() + side.begin;
        steps[side.part]->system.surfaces().move(
          points_of(side),
          directions[side.part],
          motion,
          [&](const ConstPointRef<dim>, const SurfaceState<dim> &state) {
            *u++ = state.velocity;
          });
      }
    // Subtract the motion of the rigid bodies from the displacements.
    if (!free_bodies.empty())
      {
        const auto all = all_of(src.back());
        relative       = displacements;
        for (unsigned int b = 0; b < free_bodies.size(); ++b)
          for (unsigned int c = 0; c < tangents.size(); ++c)
            if (contacts.contacts[c].rigid == int(free_bodies[b].number))
              for (std::size_t s = 0; s < points[c].size(); ++s)
                relative[c][s] -=
                  share * free_bodies[b].trial.motion_at(
                            distance(free_bodies[b], points[c][s].x), all[b]);
      }
    const bool with_pores = friction_depends_on_pores();
    if (with_pores)
      find_pore_pressures(src);
    for (unsigned int c = 0; c < tangents.size(); ++c)
      tangents[c].multiply(free_bodies.empty() ? displacements[c] : relative[c],
                           changes[c],
                           with_pores ? &pore_pressures[c] : nullptr);
    if (!free_bodies.empty())
      {
        const auto                                    all = all_of(src.back());
        std::vector<typename RigidTrial<dim>::Vector> product;
        for (unsigned int b = 0; b < free_bodies.size(); ++b)
          product.push_back(free_bodies[b].trial.stiffness() * all[b] -
                            load_by_changes(free_bodies[b]));
        set_all(dst.back(), product);
      }
    std::vector<std::vector<Tensor<1, dim>>> of_points(steps.size());
    for (const Side &side : sides)
      for (std::size_t s = side.begin; s < side.end; ++s)
        of_points[side.part].push_back(-weight * changes[side.contact][s]);
    VectorType rows;
    for (unsigned int k = 0; k < steps.size(); ++k)
      {
        TangentSystem<dim> &system = steps[k]->system;
        system.surfaces().spread(surfaces[k], of_points[k], products[k]);
        system.initialize(rows);
        system.restrict(rows, products[k], nullptr);
        dst[k] += rows;
      }
  }



  template <int dim>
  bool
  TrialContacts<dim>::augment()
  {
    bool has_changed = false;
    for (unsigned int c = 0; c < memories.size() && n_rounds < most_rounds; ++c)
      {
        if (!contacts.contacts[c].given.is_augmented())
          continue;
        KeyMemory<dim> &of_keys    = memories[c];
        double          numbers[2] = {}; // largest pressure and change
        for (const auto &[key, pressure] : of_keys.found)
          {
            const auto   given = of_keys.given.find(key);
            const double before =
              given == of_keys.given.end() ? 0. : given->second;
            numbers[0] = std::max(numbers[0], pressure);
            numbers[1] = std::max(numbers[1], std::abs(pressure - before));
          }
        for (const auto &[key, pressure] : of_keys.given)
          if (of_keys.found.count(key) == 0)
            numbers[1] = std::max(numbers[1], pressure);
        Utilities::MPI::max(ArrayView<const double>(numbers, 2),
                            contacts.comm,
                            ArrayView<double>(numbers, 2));
        if (numbers[1] <= augmented_tolerance * numbers[0])
          continue;
        of_keys.given          = of_keys.found;
        of_keys.is_first_round = false;
        has_changed            = true;
      }
    ++n_rounds;
    return has_changed;
  }



  template <int dim>
  std::string
  TrialContacts<dim>::check_motion() const
  {
    std::string problem;
    for (unsigned int c = 0; c < points.size() && problem.empty(); ++c)
      {
        const Contact   &contact = contacts.contacts[c];
        constexpr double longest = BodyContacts<dim>::longest_trial_motion;
        for (const ContactPoint<dim> &point : points[c])
          if (point.motion.norm() > share * longest * point.cell_size &&
              problem.empty())
            problem = "a point of the surface at (" + text_of(point.x) +
                      ") m in 'Contact " + contact.name + "' would move by " +
                      text_of(point.motion.norm() / share) +
                      " m, more than half of a cell, so that surfaces "
                      "might pass through one another";
      }
    return first_of_all(problem, contacts.comm);
  }



  template <int dim>
  void
  TrialContacts<dim>::add_work() const
  {
    // Use the forces in the middle or at the end of the step; without inertia,
    // use the means of the forces at both ends.
    const double part_of_new = steps.front()->scheme.is_static ? 0.5 : 1.;
    for (const Side &side : sides)
      {
        const auto              &layout = points_of(side).layout();
        const unsigned int       load   = layout.first("load");
        const ContactPoint<dim> *point =
          points[side.contact].data() + side.begin;
        double work = 0.;
        points_of(side).for_each([&](const ConstPointRef<dim> p) {
          const Tensor<1, dim> force =
            part_of_new * point->force +
            (1. - part_of_new) * p.mass() * p.vector(load);
          work += force * point->motion / share;
          ++point;
        });
        contacts.parts[side.part]->current.energy.add_work(
          EnergyBalance::surfaces + side.surface, work);
      }
  }



  template <int dim>
  void
  TrialContacts<dim>::accept()
  {
    add_work();
    contacts.add_to_intervals(results, dt);
    if (share != 1.)
      fail_on_all(find_forces(1., false), contacts.comm);
    for (unsigned int c = 0; c < points.size(); ++c)
      contacts.give(contacts.contacts[c], points[c]);
    contacts.at_start     = contacts.now;
    contacts.now.contacts = results;
    for (const FreeBody &body : free_bodies)
      at_end[body.number] = body.trial.position(body.q, 1., &body.load);
    contacts.now.rigid_bodies = at_end;
    for (Simulation<dim> *part : contacts.parts)
      for (unsigned int k = 0; k < at_end.size(); ++k)
        {
          RigidBodyState<dim> &body = part->current.rigid_bodies[k];
          body.before               = body.now;
          body.now                  = at_end[k];
        }
  }



  GREVILLE_INSTANTIATE_CLASS(TrialContacts);
} // namespace greville
