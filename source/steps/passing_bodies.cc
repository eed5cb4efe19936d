// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/overlap_of_bodies.h>
#include <greville/steps/passing_bodies.h>

#include <algorithm>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int steps_between_looks = 10;

    // The motion between two tests, as a fraction of the cell size.
    constexpr double way_between_tests = 0.25;



    bool
    have_contact(const SimulationParameters &parameters,
                 const std::string          &a,
                 const std::string          &b)
    {
      for (const auto &[name, contact] : parameters.contacts)
        {
          const auto sides = contact.sides();
          const auto has = [&](const unsigned int side, const std::string &x) {
            return contains(sides[side], x);
          };
          if ((has(0, a) && has(1, b)) || (has(0, b) && has(1, a)))
            return true;
        }
      return false;
    }
  } // namespace



  template <int dim>
  PassingBodies<dim>::PassingBodies(
    const SimulationParameters           &parameters,
    const std::vector<Simulation<dim> *> &parts,
    const std::vector<RigidBody<dim>>    &rigid_bodies,
    const MPI_Comm                        comm)
    : parts(parts)
    , rigid_bodies(rigid_bodies)
    , comm(comm)
  {
    const auto add_pair =
      [&](const std::string &a, const std::string &b, const int rigid) {
        Pair &pair = pairs.emplace_back();
        pair.names = {{a, b}};
        pair.rigid = rigid;
        pair.way   = std::numeric_limits<double>::infinity();
      };
    // Exclude bodies on one grid: they stick together if they meet.
    std::vector<std::vector<std::string>> names;
    for (const Simulation<dim> *part : parts)
      names.push_back(part->parameters.general.bodies);
    for (unsigned int k = 0; k < parts.size(); ++k)
      for (const std::string &a : names[k])
        {
          for (unsigned int l = k + 1; l < parts.size(); ++l)
            for (const std::string &b : names[l])
              if (!have_contact(parameters, a, b))
                add_pair(a, b, -1);
          for (unsigned int r = 0; r < rigid_bodies.size(); ++r)
            if (!have_contact(parameters, a, rigid_bodies[r].name()))
              add_pair(a, rigid_bodies[r].name(), r);
        }
  }



  template <int dim>
  std::vector<typename PassingBodies<dim>::Motion>
  PassingBodies<dim>::motions() const
  {
    constexpr double    none = std::numeric_limits<double>::lowest();
    std::vector<Motion> result;
    std::vector<double> all;
    for (Simulation<dim> *part : parts)
      for (const Body<dim> &body : part->current.bodies)
        {
          double largest[2 * dim + 1];
          std::fill(std::begin(largest), std::end(largest), none);
          body.points.for_each([&](const ConstPointRef<dim> p) {
            double square = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              {
                largest[d]       = std::max(largest[d], -p.position(d));
                largest[dim + d] = std::max(largest[dim + d], p.position(d));
                square += p.velocity(d) * p.velocity(d);
              }
            largest[2 * dim] = std::max(largest[2 * dim], square);
          });
          all.insert(all.end(), std::begin(largest), std::end(largest));
          result.push_back({&body, part, {}});
        }
    Utilities::MPI::max(all, comm, all);
    auto next = all.begin();
    for (Motion &motion : result)
      {
        motion.largest.assign(next, next + 2 * dim + 1);
        motion.largest.back() = std::sqrt(std::max(motion.largest.back(), 0.));
        next += 2 * dim + 1;
      }
    return result;
  }



  template <int dim>
  std::string
  PassingBodies<dim>::find_overlap(const Pair   &pair,
                                   const Motion &first,
                                   const Motion *second)
  {
    if (second)
      {
        for (unsigned int d = 0; d < 2 * dim; ++d)
          if (first.largest[d] + second->largest[(d + dim) % (2 * dim)] < 0.)
            return "";
        const Sides<dim>   sides{{{first.body}, {second->body}}};
        const Overlap<dim> overlap =
          overlap_of_bodies<dim>(sides,
                                 {first.part->space().lattice(),
                                  second->part->space().lattice()},
                                 comm);
        return overlap.excess > 2. * half_of_cell_as_excess
                 ? overlap_text(sides, overlap)
                 : "";
      }
    const RigidBody<dim>    &rigid = rigid_bodies[pair.rigid];
    const RigidPosition<dim> now =
      parts.front()->current.rigid_bodies[pair.rigid].now;
    const auto       &points = first.body->points;
    const Inside<dim> is_inside =
      mirrored<dim>([&](const Point<dim> &x) { return rigid.contains(x, now); },
                    points.layout().is_axisymmetric());
    std::string problem;
    points.for_each([&](const unsigned int cell, const ConstPointRef<dim> p) {
      if (!problem.empty() ||
          !is_deep<dim>(is_inside,
                        p.position(),
                        half_of_cell * smallest_edge(points.space().box(cell))))
        return;
      problem = inside_text(*first.body,
                            p.position(),
                            "'Rigid body " + rigid.name() + "'");
    });
    return first_of_all(problem, comm);
  }



  template <int dim>
  void
  PassingBodies<dim>::check()
  {
    const State<dim> &state = parts.front()->current;
    if (pairs.empty() || (!parts.front()->is_implicit() &&
                          state.n_steps % steps_between_looks != 0))
      return;
    const std::vector<Motion> all     = motions();
    const auto                find_by = [&](const std::string &name) {
      const auto found =
        std::find_if(all.begin(), all.end(), [&](const Motion &motion) {
          return motion.body->name == name;
        });
      return found == all.end() ? nullptr : &*found;
    };
    for (Pair &pair : pairs)
      {
        const Motion *first = find_by(pair.names[0]);
        const Motion *second =
          pair.rigid < 0 ? find_by(pair.names[1]) : nullptr;
        // Bodies may be removed in a stage.
        if (pair.is_warned_of || !first || (pair.rigid < 0 && !second))
          continue;
        double speed = first->largest.back();
        if (second)
          speed += second->largest.back();
        else
          {
            const RigidPosition<dim> &now = state.rigid_bodies[pair.rigid].now;
            Point<dim>                lower, upper;
            for (unsigned int d = 0; d < dim; ++d)
              {
                lower[d] = -first->largest[d];
                upper[d] = first->largest[dim + d];
              }
            if (lower[0] <= upper[0])
              pair.way +=
                rigid_bodies[pair.rigid].way(pair.last,
                                             now,
                                             BoundingBox<dim>({lower, upper}));
            pair.last = now;
          }
        pair.way += speed * (state.time - pair.time);
        pair.time = state.time;
        if (!parts.front()->is_implicit() &&
            pair.way < way_between_tests * first->part->grid().cell_size())
          continue;
        pair.way               = 0.;
        const std::string text = find_overlap(pair, *first, second);
        if (text.empty())
          continue;
        pair.is_warned_of = true;
        parts.front()->log.warnings.push_back(
          "Step " + std::to_string(state.n_steps) + ": " + text +
          " by more than half of a cell. The two pass through one another: no "
          "'Contact' names both.");
      }
  }



  GREVILLE_INSTANTIATE_CLASS(PassingBodies);
} // namespace greville
