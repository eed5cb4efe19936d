// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/contact/combine_by_key.h>
#include <greville/steps/stress_jumps.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Projects the stresses of all points, a row of dim components at a time,
    /// with the mass matrix of the points and without walls.
    template <int dim>
    class StressProjection
    {
    public:
      static constexpr unsigned int n = PointLayout<dim>::n_stress;
      using Stress                    = std::array<double, n>;

      StressProjection(State<dim>                 &state,
                       Discretization<dim>        &discretization,
                       const SimulationParameters &parameters)
        : state(state)
        , discretization(discretization)
        , walls(WallParameters())
        , mass(
            make_grid_mass<dim>(discretization.hierarchy(), parameters, walls))
      {
        for (const Body<dim> &body : state.bodies)
          points.push_back(&body.points);
        discretization.initialize(sums);
        discretization.initialize(spline);
      }

      /// Collective. Return the projection at each point.
      std::vector<Stress>
      at_points()
      {
        std::vector<Stress> result;
        for (unsigned int first = 0; first < n; first += dim)
          {
            exchange_velocities();
            for_all([&](const unsigned int, const PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                p.velocity(d) = p.stress(first + d);
            });
            try
              {
                project();
              }
            catch (...)
              {
                exchange_velocities();
                throw;
              }
            result.resize(velocities.size());
            std::size_t k = 0;
            for_all([&](const unsigned int, const PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                result[k][first + d] = p.velocity(d);
              ++k;
            });
            exchange_velocities();
          }
        return result;
      }

    private:
      template <typename Action>
      void
      for_all(const Action &action)
      {
        for (Body<dim> &body : state.bodies)
          body.points.for_each(action);
      }

      /// Keep the velocities of all points, or restore them.
      void
      exchange_velocities()
      {
        const bool  is_empty = velocities.empty();
        std::size_t k        = 0;
        for_all([&](const unsigned int, const PointRef<dim> p) {
          if (is_empty)
            velocities.push_back(p.velocity());
          else
            for (unsigned int d = 0; d < dim; ++d)
              p.velocity(d) = velocities[k][d];
          ++k;
        });
        if (!is_empty)
          velocities.clear();
      }

      /// Replace the velocities of points by the values of a spline.
      void
      project()
      {
        PointTransfer<dim> &transfer = discretization.transfer();
        VectorType          lumped;
        discretization.space().initialize_vector(lumped);
        transfer.points_to_grid(points,
                                &lumped,
                                &sums,
                                nullptr,
                                is_assembled ? nullptr : mass->filled_parts(),
                                false);
        mass->condense_levels(lumped, sums, {}, transfer);
        if (!is_assembled)
          mass->update(lumped, points, {}, transfer);
        is_assembled = true;
        for (VectorType &component : spline)
          component = 0.;
        mass->solve({&spline}, {&sums});
        mass->distribute_levels(spline);
        PointUpdate<dim> update;
        update.acceleration = update.velocity = &spline;
        update.flip                           = 0.;
        update_points(state.bodies, transfer, update, state.time);
      }

      State<dim>                              &state;
      Discretization<dim>                     &discretization;
      const Walls<dim>                         walls;
      std::unique_ptr<GridMass<dim>>           mass;
      std::vector<const MaterialPoints<dim> *> points;
      std::vector<Tensor<1, dim>>              velocities;
      VectorField<dim>                         sums, spline;
      bool                                     is_assembled = false;
    };



    /// Shear components occur twice in the norm.
    template <typename Stress>
    double
    norm_square(const Stress &stress)
    {
      double result = 0.;
      for (unsigned int i = 0; i < stress.size(); ++i)
        result += (i < 3 ? 1. : 2.) * stress[i] * stress[i];
      return result;
    }



    /// Return the id of the point of which a part of a divided point is a part.
    template <int dim>
    double
    parent_id(const double id)
    {
      constexpr double base  = 1. + (1u << dim);
      double           place = PointLayout<dim>::id_of_parts;
      while (id >= place * base)
        place *= base;
      return std::fmod(id, place);
    }



    /// Averages over the parts of all points that have been divided, and of
    /// their parts that have been divided again, on all processes.
    template <int dim>
    class MeansOverParts
    {
    public:
      /// Two stresses and their volume.
      static constexpr unsigned int n = PointLayout<dim>::n_stress;
      using Values                    = std::array<double, 2 * n + 1>;

      explicit MeansOverParts(const State<dim> &state)
        : state(state)
      {}

      /// Call @p action(key, k, volume) for each part of this process and each
      /// point that it has been a part of, the latest first; k is its number
      /// among all points.
      template <typename Action>
      void
      for_each(const Action &action) const
      {
        std::size_t k = 0;
        for (std::uint64_t b = 0; b < state.bodies.size(); ++b)
          state.bodies[b].points.for_each([&](const ConstPointRef<dim> p) {
            for (double id = p.id(); id >= PointLayout<dim>::id_of_parts;)
              {
                id = parent_id<dim>(id);
                // Doubles count to 2^53.
                action((b << 53) + std::uint64_t(id), k, p.volume());
              }
            ++k;
          });
      }

      /// Collective. Average the result of @p values(k), which is called in the
      /// order of for_each().
      template <typename Function>
      void
      average(const Function &values, const MPI_Comm comm)
      {
        for_each([&](const std::uint64_t key,
                     const std::size_t   k,
                     const double        volume) {
          const Values own = values(key, k);
          Values      &sum = means[key];
          for (unsigned int i = 0; i < 2 * n; ++i)
            sum[i] += volume * own[i];
          sum.back() += volume;
        });
        combine_by_key(
          means,
          [](Values &sum, const Values &more) {
            for (unsigned int i = 0; i < sum.size(); ++i)
              sum[i] += more[i];
          },
          comm);
        for (auto &[key, mean] : means)
          for (unsigned int i = 0; i < 2 * n; ++i)
            mean[i] /= mean.back();
      }

      const Values &
      operator[](const std::uint64_t key) const
      {
        return means.at(key);
      }

    private:
      const State<dim>                         &state;
      std::unordered_map<std::uint64_t, Values> means;
    };
  } // namespace



  template <int dim>
  StressJumps
  stress_jumps(State<dim>                 &state,
               Discretization<dim>        &discretization,
               const SimulationParameters &parameters)
  {
    constexpr unsigned int n    = PointLayout<dim>::n_stress;
    const MPI_Comm         comm = discretization.communicator();
    using Means                 = MeansOverParts<dim>;
    using Values                = typename Means::Values;
    using Stress                = std::array<double, n>;

    // Stresses and the spline at points.
    std::vector<Values> of_points;
    const auto          projected =
      StressProjection<dim>(state, discretization, parameters).at_points();
    StressJumps result;
    for (const Body<dim> &body : state.bodies)
      body.points.for_each([&](const ConstPointRef<dim> p) {
        Values values{};
        Stress jump;
        for (unsigned int i = 0; i < n; ++i)
          {
            values[i]     = p.stress(i);
            values[n + i] = projected[of_points.size()][i];
            jump[i]       = values[i] - values[n + i];
          }
        of_points.push_back(values);
        result.of_points.push_back(std::sqrt(norm_square(jump)));
      });
    result.developed = result.of_points;

    Means means(state);
    means.average([&](const std::uint64_t,
                      const std::size_t k) { return of_points[k]; },
                  comm);
    // From parts to the points that have been divided: the differences of
    // stresses and spline between one and the next.
    std::vector<const Values *> last(of_points.size());
    const auto                  for_each_difference = [&](const auto &action) {
      for (std::size_t k = 0; k < of_points.size(); ++k)
        last[k] = &of_points[k];
      means.for_each(
        [&](const std::uint64_t key, const std::size_t k, const double) {
          const Values &mean = means[key];
          Stress        own, spline;
          for (unsigned int i = 0; i < n; ++i)
            {
              own[i]    = (*last[k])[i] - mean[i];
              spline[i] = (*last[k])[n + i] - mean[n + i];
            }
          action(key, k, own, spline);
          last[k] = &mean;
        });
    };
    // In the order of for_each().
    std::vector<Values> differences;
    for_each_difference([&](const std::uint64_t,
                            const std::size_t,
                            const Stress &own,
                            const Stress &spline) {
      differences.push_back({{norm_square(own), norm_square(spline)}});
    });
    std::size_t next = 0;
    Means       squares(state);
    squares.average([&](const std::uint64_t,
                        const std::size_t) { return differences[next++]; },
                    comm);
    std::vector<Stress> jumps(of_points.size(), Stress{});
    for_each_difference([&](const std::uint64_t key,
                            const std::size_t   k,
                            const Stress       &own,
                            const Stress       &spline) {
      const double square = squares[key][0], of_spline = squares[key][1],
                   share =
                     square < of_spline ? std::sqrt(square / of_spline) : 1.;
      for (unsigned int i = 0; i < n; ++i)
        jumps[k][i] += share * (own[i] - spline[i]);
    });
    for (std::size_t k = 0; k < of_points.size(); ++k)
      if (last[k] != &of_points[k])
        {
          for (unsigned int i = 0; i < n; ++i)
            jumps[k][i] += (*last[k])[i] - (*last[k])[n + i];
          result.developed[k] = std::sqrt(norm_square(jumps[k]));
        }
    return result;
  }



  GREVILLE_INSTANTIATE(stress_jumps);
} // namespace greville
