// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/base/mixed_bits.h>

#include "hats.h"
#include "key_forces.h"
#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    template <int dim>
    Tensor<1, dim>
    oriented_normal(const ContactPoint<dim> &point)
    {
      return (point.side == 0 ? 1. : -1.) * point.target_normal;
    }



    /// Return the sums of keys over the points of this process. @p hats belong
    /// to the points that face the other side, in their order.
    template <int dim>
    std::unordered_map<std::uint64_t, KeySums<dim>>
    sums_of_keys(const std::vector<ContactPoint<dim>> &points,
                 const std::vector<Hats<dim>>         &hats,
                 const ContactLaw                     &law)
    {
      std::unordered_map<std::uint64_t, KeySums<dim>> sums;
      auto                                            next = hats.begin();
      for (const ContactPoint<dim> &point : points)
        {
          if (!point.is_facing)
            continue;
          const Tensor<1, dim> normal = oriented_normal(point);
          const Hats<dim>     &own    = *next++;
          for (unsigned int k = 0; k < Hats<dim>::n; ++k)
            {
              const double  w   = point.area * own.values[k];
              KeySums<dim> &sum = sums[own.keys[k]];
              sum.weight[point.side] += w;
              sum.start_pressure += w * point.start_pressure;
              sum.normal += w * normal;
              if (law.measures(point.side))
                {
                  sum.gap += w * point.gap;
                  sum.slip += w * point.slip;
                }
              if (law.has_pores_on(point.side))
                sum.pore_pressure += w * point.pore_pressure;
              sum.motion[point.side] += w * point.motion;
              if (!law.has_two_sides)
                sum.motion[1] += w * point.target_motion;
            }
        }
      return sums;
    }



    /// The contact law for the keys owned by this process: forces, pressures
    /// and tangents.
    template <int dim>
    class KeyLaw
    {
    public:
      using TangentKey = typename ContactTangent<dim>::Key;

      KeyLaw(const ContactLaw &law,
             const double      dt,
             const double      share,
             KeyMemory<dim>   *memory,
             const bool        with_tangent)
        : law(law)
        , dt(dt)
        , share(share)
        , memory(memory)
        , with_tangent(with_tangent)
      {
        if (!memory)
          return;
        memory->found.clear();
        if (memory->is_first_round)
          memory->given.clear();
      }

      KeyForce<dim>
      force(const std::uint64_t name, const KeySums<dim> &sum)
      {
        double given = 0.;
        if (memory && memory->is_first_round)
          {
            given = sum.start_pressure / (sum.weight[0] + sum.weight[1]);
            if (given > 0.)
              memory->given[name] = given;
          }
        else if (memory && memory->given.count(name) > 0)
          given = memory->given.at(name);
        KeyForce<dim> result =
          force_of_key<dim>(law, sum, dt, given, share, with_tangent, area);
        if (memory && result.pressure > 0.)
          memory->found[name] = result.pressure;
        if (!with_tangent)
          return result;
        if (memory)
          {
            Tensor<1, dim> &last = memory->sliding[name];
            if (last * result.direction < 0.)
              {
                result.stiffness        = result.sticking;
                result.coupling         = Tensor<2, dim>();
                result.direction        = Tensor<1, dim>();
                result.by_pore_pressure = Tensor<1, dim>();
              }
            last = result.direction;
          }
        result.number = tangent_keys.size();
        TangentKey   key;
        const double w = result.shares[0] * sum.weight[0];
        for (unsigned int side = 0; side < 2; ++side)
          key.inverse_weights[side] =
            sum.weight[side] > 0. ? 1. / sum.weight[side] : 0.;
        key.symmetric        = w * result.stiffness;
        key.stiffness        = key.symmetric + w * result.coupling;
        key.by_pore_pressure = w * result.by_pore_pressure;
        tangent_keys.push_back(key);
        return result;
      }

      double area = 0.; // under pressure
      /// Keys of the tangent, in the order of their numbers.
      std::vector<TangentKey> tangent_keys;

    private:
      const ContactLaw &law;
      const double      dt, share;
      KeyMemory<dim>   *memory;
      const bool        with_tangent;
    };



    /// Collective. Return the forces of the keys of this process' points. Each
    /// key has an owner, which adds up its sums.
    template <int dim>
    std::unordered_map<std::uint64_t, KeyForce<dim>>
    forces_of_keys(std::unordered_map<std::uint64_t, KeySums<dim>> sums,
                   KeyLaw<dim>                                    &law,
                   ContactTangent<dim>                            *tangent,
                   const MPI_Comm                                  comm)
    {
      std::unordered_map<std::uint64_t, KeyForce<dim>> forces;

      const bool         with_tangent = tangent != nullptr;
      std::uint64_t      first_number = 0;
      const unsigned int n_processes  = Utilities::MPI::n_mpi_processes(comm);
      if (n_processes == 1)
        for (const auto &[key, sum] : sums)
          forces[key] = law.force(key, sum);
      else
        {
          std::map<unsigned int, std::vector<std::uint64_t>> keys;
          std::map<unsigned int, std::vector<double>>        values;
          for (auto &[key, sum] : sums)
            {
              const unsigned int owner = mixed_bits(key) % n_processes;
              keys[owner].push_back(key);
              sum.for_each([&, owner = owner](const double value) {
                values[owner].push_back(value);
              });
            }
          const auto keys_here   = Utilities::MPI::some_to_some(comm, keys);
          const auto values_here = Utilities::MPI::some_to_some(comm, values);

          std::unordered_map<std::uint64_t, KeySums<dim>> owned;
          for (const auto &[process, of_process] : keys_here)
            {
              const double *value = values_here.at(process).data();
              for (const std::uint64_t key : of_process)
                owned[key].for_each([&](double &entry) { entry += *value++; });
            }
          for (const auto &[key, sum] : owned)
            forces[key] = law.force(key, sum);
          if (with_tangent)
            {
              first_number = sum_before(law.tangent_keys.size(), comm);
              for (auto &key : forces)
                key.second.number += double(first_number);
            }
          values.clear();
          for (const auto &[process, of_process] : keys_here)
            for (const std::uint64_t key : of_process)
              forces[key].for_each(with_tangent,
                                   [&, to = process](const double value) {
                                     values[to].push_back(value);
                                   });
          const auto answers = Utilities::MPI::some_to_some(comm, values);
          forces.clear();
          for (const auto &[process, of_process] : keys)
            {
              const double *value = answers.at(process).data();
              for (const std::uint64_t key : of_process)
                forces[key].for_each(with_tangent,
                                     [&](double &entry) { entry = *value++; });
            }
        }
      if (with_tangent)
        {
          std::vector<std::uint64_t> numbers;
          for (const auto &[key, force] : forces)
            numbers.push_back(std::uint64_t(force.number));
          tangent->begin(std::move(law.tangent_keys),
                         first_number,
                         numbers,
                         comm);
        }
      return forces;
    }



    /// Distribute the forces of keys to the points.
    template <int dim>
    void
    set_forces(std::vector<ContactPoint<dim>>                         &points,
               const std::vector<Hats<dim>>                           &hats,
               const std::unordered_map<std::uint64_t, KeyForce<dim>> &forces,
               const ContactLaw                                       &law,
               ContactTangent<dim>                                    *tangent)
    {
      auto next = hats.begin();
      for (ContactPoint<dim> &point : points)
        {
          point.force    = Tensor<1, dim>();
          point.new_slip = Tensor<1, dim>();
          point.state    = ContactState::open;
          if (tangent)
            {
              point.stiffness = Tensor<2, dim>();
              tangent->add_point(point.side, law.has_pores_on(point.side));
            }
          if (!point.is_facing)
            continue;
          const Hats<dim> &own    = *next++;
          double           active = 0., closed = 0., sliding = 0.;
          Tensor<1, dim>   slip = point.slip;
          for (unsigned int k = 0; k < Hats<dim>::n; ++k)
            {
              const KeyForce<dim> &key    = forces.at(own.keys[k]);
              const double         weight = point.area * own.values[k];
              point.force += weight * key.force[point.side];
              slip += own.values[k] * key.slip_change;
              active += own.values[k] * key.is_active;
              closed += key.state > 0. ? own.values[k] : 0.;
              sliding +=
                key.state == double(ContactState::slip) ? own.values[k] : 0.;
              if (!tangent || key.shares[0] == 0.)
                continue;
              point.stiffness +=
                weight * key.shares[point.side] * key.stiffness;
              tangent->add_share(std::uint64_t(key.number), weight);
            }
          if (active > 0.)
            point.new_slip = slip;
          if (closed > 0.)
            point.state =
              sliding > 0.5 * closed ? ContactState::slip : ContactState::stick;
        }
    }
  } // namespace



  template <int dim>
  AveragedContact<dim>::AveragedContact(
    const ContactLaw                &law,
    const std::vector<Lattice<dim>> &lattices,
    const MPI_Comm                   comm)
    : contact_law(law)
    , lattices(lattices)
    , comm(comm)
  {}



  template <int dim>
  ContactResult<dim>
  AveragedContact<dim>::act(std::vector<ContactPoint<dim>> &points,
                            const double                    dt,
                            const Point<dim>               &about,
                            ContactTangent<dim>            *tangent,
                            KeyMemory<dim>                 *memory,
                            const double                    share) const
  {
    ContactResult<dim> result;
    result.gap = std::numeric_limits<double>::infinity();
    std::vector<Hats<dim>> hats; // of the points that face the other side
    for (const ContactPoint<dim> &point : points)
      if (point.is_facing)
        {
          if (contact_law.measures(point.side))
            result.gap = std::min(result.gap, point.gap);
          const Point<dim>   x      = point.x - point.offset_from_hats;
          const unsigned int number = lattice_at(lattices, x);
          hats.emplace_back(x,
                            oriented_normal(point),
                            lattices[number],
                            number);
        }
    KeyLaw<dim> law(contact_law, dt, share, memory, tangent != nullptr);
    const auto  forces = forces_of_keys(sums_of_keys(points, hats, contact_law),
                                       law,
                                       tangent,
                                       comm);
    set_forces(points, hats, forces, contact_law, tangent);

    for (const ContactPoint<dim> &point : points)
      if (point.is_facing && point.side == 0)
        {
          const Tensor<1, dim> arm = point.x - about;
          result.force += point.force;
          if constexpr (dim == 2)
            result.moment[0] +=
              arm[0] * point.force[1] - arm[1] * point.force[0];
          else
            result.moment += cross_product_3d(arm, point.force);
        }
    std::vector<double> all = {law.area};
    for (unsigned int d = 0; d < dim; ++d)
      all.push_back(result.force[d]);
    for (unsigned int k = 0; k < result.moment.dimension; ++k)
      all.push_back(result.moment[k]);
    Utilities::MPI::sum(all, comm, all);
    result.area = all[0];
    for (unsigned int d = 0; d < dim; ++d)
      result.force[d] = all[1 + d];
    for (unsigned int k = 0; k < result.moment.dimension; ++k)
      result.moment[k] = all[1 + dim + k];
    result.gap = Utilities::MPI::min(result.gap, comm);
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(AveragedContact);
} // namespace greville
