// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/numbers.h>

#include <greville/base/mixed_bits.h>
#include <greville/contact/averaged_contact.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int
    n_functions(const unsigned int dim)
    {
      return 1u << dim;
    }

    /**
     * The sums of a key over points, which are added up over processes.
     */
    template <int dim>
    struct KeySums
    {
      double         weight[2] = {0., 0.}; // w^A, w^B
      double         gap = 0., start_pressure = 0.;
      Tensor<1, dim> normal, slip, motion[2];

      template <typename Action>
      void
      for_each(const Action &action)
      {
        action(weight[0]);
        action(weight[1]);
        action(gap);
        action(start_pressure);
        for (unsigned int d = 0; d < dim; ++d)
          {
            action(normal[d]);
            action(slip[d]);
            action(motion[0][d]);
            action(motion[1][d]);
          }
      }
    };



    /**
     * What a key gives to its points.
     */
    template <int dim>
    struct KeyForce
    {
      Tensor<1, dim> force[2];    // per area, of both sides
      Tensor<1, dim> slip_change; // of the elastic slip
      double         is_active = 0.;
      // For a ContactTangent: its number, w_k over the weights of both sides,
      // and D_k.
      double         number    = 0.;
      double         shares[2] = {0., 0.};
      Tensor<2, dim> stiffness;
      double         pressure = 0.; // for KeyPressures
      // What sliding adds to D_k, not symmetric. Points by themselves, which
      // are for preconditioners, are without it.
      Tensor<2, dim> coupling;

      template <typename Action>
      void
      for_each(const bool with_tangent, const Action &action)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            action(force[0][d]);
            action(force[1][d]);
            action(slip_change[d]);
          }
        action(is_active);
        if (!with_tangent)
          return;
        action(number);
        action(shares[0]);
        action(shares[1]);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int e = 0; e < dim; ++e)
            action(stiffness[d][e]);
      }
    };



    /**
     * The sector of a normal: in 2D one of 60 degrees, in 3D around an axis.
     * Common directions (multiples of 15 degrees, diagonals) are not on the
     * border of two sectors.
     */
    template <int dim>
    unsigned int
    sector_of(const Tensor<1, dim> &n)
    {
      if constexpr (dim == 2)
        {
          constexpr double shift = 0.187; // rad
          const double     turns =
            (std::atan2(n[1], n[0]) + shift) / (2. * numbers::PI);
          return unsigned(std::floor((turns - std::floor(turns)) * 6.)) % 6;
        }
      else
        {
          // Axes turned by a rotation without symmetry.
          static const double axes[3][3] = {{0.9705, 0.1889, -0.1499},
                                            {-0.1639, 0.9727, 0.1644},
                                            {0.1769, -0.1350, 0.9749}};
          unsigned int        largest    = 0;
          double              values[3];
          for (unsigned int k = 0; k < 3; ++k)
            {
              values[k] =
                axes[k][0] * n[0] + axes[k][1] * n[1] + axes[k][2] * n[2];
              if (std::abs(values[k]) > std::abs(values[largest]))
                largest = k;
            }
          return 2 * largest + (values[largest] > 0.);
        }
    }



    /**
     * The keys of a point with the values of their hat functions.
     */
    template <int dim>
    struct Hats
    {
      std::array<std::uint64_t, n_functions(dim)> keys;
      std::array<double, n_functions(dim)>        values;

      Hats(const Point<dim>     &x,
           const Tensor<1, dim> &normal,
           const Point<dim>     &corner,
           const Tensor<1, dim> &h)
      {
        constexpr std::int64_t zero = 1 << 19; // of 20 bits
        std::int64_t           cell[dim];
        double                 xi[dim];
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double position = (x[d] - corner[d]) / h[d];
            cell[d]               = std::int64_t(std::floor(position));
            xi[d]                 = position - double(cell[d]);
          }
        const std::uint64_t sector = sector_of<dim>(normal);
        for (unsigned int k = 0; k < n_functions(dim); ++k)
          {
            std::uint64_t key = sector;
            values[k]         = 1.;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const unsigned int side = (k >> d) & 1;
                values[k] *= side ? xi[d] : 1. - xi[d];
                key = (key << 20) |
                      (std::uint64_t(cell[d] + side + zero) & ((1 << 20) - 1));
              }
            keys[k] = key;
          }
      }
    };



    /**
     * The force of a key of area @p weight.
     */
    template <int dim>
    KeyForce<dim>
    force_of_key(const ContactLaw   &law,
                 const KeySums<dim> &sums,
                 const double        dt,
                 const double        given_pressure,
                 const double        share,
                 double             &area)
    {
      KeyForce<dim> result;
      const double  w[2] = {sums.weight[0],
                           law.has_two_sides ? sums.weight[1] : sums.weight[0]};
      if (!(w[0] > 0. && w[1] > 0.) || !(sums.normal.norm() > 0.))
        return result;
      const double         all    = law.has_two_sides ? w[0] + w[1] : w[0];
      const double         weight = 2. * w[0] * w[1] / (w[0] + w[1]);
      const double         gap    = sums.gap / all;
      const Tensor<1, dim> n      = sums.normal / sums.normal.norm();
      const Tensor<1, dim> du   = sums.motion[0] / w[0] - sums.motion[1] / w[1];
      const double         rate = dt > 0. ? 1. / dt : 0.;
      const Tensor<2, dim> plane =
        Tensor<2, dim>(unit_symmetric_tensor<dim>()) - outer_product(n, n);
      // The gaps at both ends of the step.
      const double change = du * n / share;
      const double first = gap - share * change, last = first + change;
      const double least = share < 1. ? std::min(first, last) : gap;
      if (least >= law.touching && given_pressure == 0.)
        return result;
      double pressure =
        given_pressure - law.stiffness * gap - law.viscosity * rate * (du * n);
      double normal_stiffness = law.stiffness + law.viscosity * rate;
      if (share < 1. && first * last < 0. && given_pressure == 0.)
        {
          // The one that is inside, over the way of both.
          const double inside = std::abs(std::min(first, last) / change);
          pressure =
            0.5 * law.stiffness * inside * std::abs(std::min(first, last));
          normal_stiffness *=
            last < 0. ? 2. * inside * (1. - 0.5 * inside) : inside * inside;
        }
      pressure = std::max(0., pressure);
      if (least >= 0. && pressure == 0.)
        {
          // The derivative at this kink is that of what is about to press.
          if (gap >= law.touching)
            return result;
          result.shares[0] = weight / w[0];
          result.shares[1] = weight / w[1];
          result.stiffness = law.stiffness * outer_product(n, n);
          if (law.friction > 0.)
            result.stiffness += law.shear_stiffness * plane;
          return result;
        }
      const auto tangential = [&](const Tensor<1, dim> &vector) {
        return vector - (vector * n) * n;
      };
      const Tensor<1, dim> mean = sums.slip / all;
      const Tensor<1, dim> step = tangential(du);
      Tensor<1, dim>       slip = tangential(mean) + step;
      Tensor<1, dim>       shear =
        -law.shear_stiffness * slip - law.viscosity * rate * step;
      // Without pressure there is no friction, but 0 times infinity.
      const double most =
        pressure > 0. ? law.friction * pressure + law.adhesion : 0.;
      Tensor<2, dim> stiffness =
        (law.shear_stiffness + law.viscosity * rate) * plane;
      if (shear.norm() > most)
        {
          const Tensor<1, dim> direction = shear / shear.norm();
          stiffness -= (law.shear_stiffness + law.viscosity * rate) *
                       outer_product(direction, direction);
          stiffness *= most / shear.norm();
          shear *= most / shear.norm();
          if (pressure > 0.)
            result.coupling =
              law.friction * normal_stiffness * outer_product(direction, n);
          slip = -shear / law.shear_stiffness;
        }
      else if (most == 0.)
        stiffness = Tensor<2, dim>();
      if (pressure > 0.)
        stiffness += normal_stiffness * outer_product(n, n);
      const Tensor<1, dim> force = weight * (pressure * n + shear);
      result.force[0]            = force / w[0];
      result.force[1]            = -force / w[1];
      result.slip_change         = slip - mean;
      result.is_active           = 1.;
      result.pressure            = pressure;
      result.shares[0]           = weight / w[0];
      result.shares[1]           = weight / w[1];
      result.stiffness           = stiffness;
      if (pressure > 0.)
        area += weight;
      return result;
    }
  } // namespace



  template <int dim>
  AveragedContact<dim>::AveragedContact(const ContactLaw     &law,
                                        const Point<dim>     &corner,
                                        const Tensor<1, dim> &cell_size,
                                        const MPI_Comm        comm)
    : contact_law(law)
    , corner(corner)
    , cell_size(cell_size)
    , comm(comm)
  {}



  template <int dim>
  ContactResult<dim>
  AveragedContact<dim>::act(std::vector<ContactPoint<dim>> &points,
                            const double                    dt,
                            const Point<dim>               &about,
                            ContactTangent<dim>            *tangent,
                            KeyPressures                   *pressures,
                            const double                    share) const
  {
    const bool         has_two_sides = contact_law.has_two_sides;
    ContactResult<dim> result;
    result.gap = std::numeric_limits<double>::infinity();

    // Sums over the points of this process.
    std::unordered_map<std::uint64_t, KeySums<dim>> sums;
    for (ContactPoint<dim> &point : points)
      {
        point.force    = Tensor<1, dim>();
        point.new_slip = Tensor<1, dim>();
        if (!point.is_facing)
          continue;
        result.gap = std::min(result.gap, point.gap);
        const Tensor<1, dim> normal =
          (point.side == 0 ? 1. : -1.) * point.target_normal;
        const Hats<dim> hats(point.x - point.since_hats,
                             normal,
                             corner,
                             cell_size);
        for (unsigned int k = 0; k < n_functions(dim); ++k)
          {
            const double  w   = point.area * hats.values[k];
            KeySums<dim> &sum = sums[hats.keys[k]];
            sum.weight[point.side] += w;
            sum.gap += w * point.gap;
            sum.start_pressure += w * point.start_pressure;
            sum.normal += w * normal;
            sum.slip += w * point.slip;
            sum.motion[point.side] += w * point.motion;
            if (!has_two_sides)
              sum.motion[1] += w * point.target_motion;
          }
      }

    std::unordered_map<std::uint64_t, KeyForce<dim>> forces;
    // Of the keys of this process in the order of their numbers, from the first
    // one on.
    using TangentKey = typename ContactTangent<dim>::Key;
    std::vector<TangentKey> tangent_keys;
    std::uint64_t           first_number = 0;
    const bool              with_tangent = tangent != nullptr;
    if (pressures)
      {
        pressures->found.clear();
        if (pressures->is_first_round)
          pressures->given.clear();
      }
    const auto find_force = [&](const std::uint64_t name,
                                const KeySums<dim> &sum,
                                KeyForce<dim>      &force) {
      double given = 0.;
      if (pressures && pressures->is_first_round)
        {
          given = sum.start_pressure / (sum.weight[0] + sum.weight[1]);
          if (given > 0.)
            pressures->given[name] = given;
        }
      else if (pressures && pressures->given.count(name) > 0)
        given = pressures->given.at(name);
      force =
        force_of_key<dim>(contact_law, sum, dt, given, share, result.area);
      if (pressures && force.pressure > 0.)
        pressures->found[name] = force.pressure;
      if (!with_tangent)
        return;
      force.number = tangent_keys.size();
      TangentKey   key;
      const double w = force.shares[0] * sum.weight[0];
      for (unsigned int side = 0; side < 2; ++side)
        key.inverse_weights[side] =
          sum.weight[side] > 0. ? 1. / sum.weight[side] : 0.;
      key.stiffness = w * (force.stiffness + force.coupling);
      tangent_keys.push_back(key);
    };
    // Each key belongs to a process.
    const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
    if (n_processes == 1)
      for (const auto &[key, sum] : sums)
        find_force(key, sum, forces[key]);
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
          find_force(key, sum, forces[key]);
        if (with_tangent)
          {
            const std::uint64_t n_own = tangent_keys.size();
            const int           ierr =
              MPI_Exscan(&n_own, &first_number, 1, MPI_UINT64_T, MPI_SUM, comm);
            AssertThrowMPI(ierr);
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
        tangent->begin(std::move(tangent_keys), first_number, numbers, comm);
      }

    for (ContactPoint<dim> &point : points)
      {
        if (with_tangent)
          {
            point.stiffness = Tensor<2, dim>();
            tangent->add_point(point.side);
          }
        if (!point.is_facing)
          continue;
        const Tensor<1, dim> normal =
          (point.side == 0 ? 1. : -1.) * point.target_normal;
        const Hats<dim> hats(point.x - point.since_hats,
                             normal,
                             corner,
                             cell_size);
        double          active = 0.;
        Tensor<1, dim>  slip   = point.slip;
        for (unsigned int k = 0; k < n_functions(dim); ++k)
          {
            const KeyForce<dim> &key = forces.at(hats.keys[k]);
            point.force += point.area * hats.values[k] * key.force[point.side];
            slip += hats.values[k] * key.slip_change;
            active += hats.values[k] * key.is_active;
            if (!with_tangent || key.shares[0] == 0.)
              continue;
            const double weight = point.area * hats.values[k];
            point.stiffness += weight * key.shares[point.side] * key.stiffness;
            tangent->add_share(std::uint64_t(key.number), weight);
          }
        if (active > 0.)
          point.new_slip = slip;
        if (point.side == 0)
          {
            const Tensor<1, dim> arm = point.x - about;
            result.force += point.force;
            if constexpr (dim == 2)
              result.moment[0] +=
                arm[0] * point.force[1] - arm[1] * point.force[0];
            else
              result.moment += cross_product_3d(arm, point.force);
          }
      }
    std::vector<double> all = {result.area};
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



  template class AveragedContact<2>;
  template class AveragedContact<3>;
} // namespace greville
