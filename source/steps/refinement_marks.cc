// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/refinement_region.h>
#include <greville/steps/refinement_marks.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The part of the sum of squares of stress jumps in the marked cells.
    constexpr double share_of_jumps = 0.6;

    // A smaller part of the mean stress is no jump.
    constexpr double smallest_jump = 1e-3;

    // Cells join below this part of the value that halves cells.
    constexpr double part_that_keeps = 0.1;



    /// Return, for each owned cell, the largest plastic strain of its points.
    template <int dim>
    std::vector<double>
    plastic_strains(const State<dim> &state, const unsigned int n_cells)
    {
      std::vector<double> result(n_cells, 0.);
      for (const Body<dim> &body : state.bodies)
        if (const PointField *field =
              body.points.layout().find("plastic_strain"))
          body.points.for_each(
            [&](const unsigned int cell, const ConstPointRef<dim> p) {
              result[cell] = std::max(result[cell], p[field->first]);
            });
      return result;
    }



    /// Projects the stresses of all points, a row of dim components at a time,
    /// with the mass matrix of the points and without walls.
    template <int dim>
    class StressProjection
    {
    public:
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

      /// Collective. Add, for each owned cell, the squares of jumps, and return
      /// the sum of squares of all stresses of this process; both are weighted
      /// by volumes.
      double
      add_jumps(std::vector<double> &squares)
      {
        constexpr unsigned int n   = PointLayout<dim>::n_stress;
        double                 all = 0.;
        for (unsigned int first = 0; first < n; first += dim)
          {
            exchange_velocities();
            for_all([&](const unsigned int, const PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                p.velocity(d) = p.stress(first + d);
            });
            project();
            for_all([&](const unsigned int cell, const PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const double stress = p.stress(first + d);
                  // Shear components occur twice in the norm.
                  const double weight = p.volume() * (first + d < 3 ? 1. : 2.);
                  squares[cell] +=
                    weight * Utilities::fixed_power<2>(p.velocity(d) - stress);
                  all += weight * stress * stress;
                }
            });
            exchange_velocities();
          }
        return all;
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
        if (!is_assembled)
          mass->update(lumped, points, {}, transfer);
        is_assembled = true;
        for (VectorType &component : spline)
          component = 0.;
        mass->solve({&spline}, {&sums});
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



    /// Collective. Return, for each owned cell, its stress jump.
    template <int dim>
    std::vector<double>
    stress_jumps(State<dim>                 &state,
                 Discretization<dim>        &discretization,
                 const SimulationParameters &parameters)
    {
      const SplineSpace<dim> &space   = discretization.space();
      const unsigned int      n_cells = space.owned_cells().size();
      std::vector<double>     squares(n_cells, 0.), volumes(n_cells, 0.);
      std::vector<double>     sums(2, 0.);
      sums[0] = StressProjection<dim>(state, discretization, parameters)
                  .add_jumps(squares);
      for (const Body<dim> &body : state.bodies)
        body.points.for_each(
          [&](const unsigned int cell, const ConstPointRef<dim> p) {
            volumes[cell] += p.volume();
          });
      for (const double volume : volumes)
        sums[1] += volume;
      Utilities::MPI::sum(sums, space.communicator(), sums);
      const double negligible =
        smallest_jump * smallest_jump * sums[0] / sums[1];
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        if (!(squares[cell] > negligible * volumes[cell]))
          squares[cell] = 0.;
      return squares;
    }



    /// Collective. Return the value above which the sum of @p weights falls to
    /// a @p limit; the next smaller one of two candidates with @p below.
    double
    value_at(const std::vector<double> &values,
             const std::vector<double> &weights,
             const double               limit,
             const bool                 below,
             const MPI_Comm             comm)
    {
      double high = 0., low = 0.;
      for (const double value : values)
        high = std::max(high, value);
      high = Utilities::MPI::max(high, comm);
      // Values that differ less are equal up to round-off.
      while (high - low > 1e-6 * high)
        {
          const double middle = 0.5 * (low + high);
          double       sum    = 0.;
          for (unsigned int k = 0; k < values.size(); ++k)
            if (values[k] > middle)
              sum += weights[k];
          (Utilities::MPI::sum(sum, comm) > limit ? low : high) = middle;
        }
      return below ? low : high;
    }



    /// Marks the cells of a region by the values of its indicator.
    template <int dim>
    class RegionMarks
    {
    public:
      RegionMarks(const RefinementParameters &region,
                  const std::string          &name,
                  const SplineSpace<dim>     &space,
                  std::vector<double>       &&all_values,
                  const double                time,
                  const bool                  moves)
        : space(space)
        , levels(*space.lattice().hierarchy())
        , values(std::move(all_values))
      {
        const RefinementRegion<dim> shape(region, name, moves);
        run_on_all(space.communicator(), [&]() {
          for (unsigned int cell = 0; cell < values.size(); ++cell)
            {
              const CellBox<dim> box   = space.box(cell);
              const unsigned int level = levels.level(box.index);
              if (values[cell] > 0. && !shape.contains(level, box, time))
                values[cell] = 0.;
              may_halve.push_back(level < region.levels);
            }
        });
      }

      /// Collective. Return the value above which cells have a share of the
      /// sum of all values.
      double
      value_of_share(const double share) const
      {
        double sum = 0.;
        for (const double value : values)
          sum += value;
        const MPI_Comm comm = space.communicator();
        return value_at(
          values, values, share * Utilities::MPI::sum(sum, comm), true, comm);
      }

      /// Collective. Return the value above which there are at most @p n cells
      /// that may be halved.
      double
      value_of_number(const double n) const
      {
        const std::vector<double> weights(may_halve.begin(), may_halve.end());
        std::vector<double>       refinable = values;
        for (unsigned int cell = 0; cell < values.size(); ++cell)
          refinable[cell] *= weights[cell];
        return value_at(refinable, weights, n, false, space.communicator());
      }

      /// Append own cells above @p halves and their parents, with the rings
      /// around them, and the parents of own cells above @p keeps.
      void
      append(std::vector<std::uint64_t> &marks,
             const double                halves,
             const double                keeps) const
      {
        for (unsigned int cell = 0; cell < values.size(); ++cell)
          {
            const MultiIndex<dim> index   = space.box(cell).index;
            const bool            is_fine = levels.level(index) > 0;
            if (values[cell] > halves && may_halve[cell])
              append_ring(marks, index);
            if (values[cell] > halves && is_fine)
              append_ring(marks, levels.parent(index));
            else if (values[cell] > keeps && is_fine)
              marks.push_back(position(levels.parent(index)));
          }
      }

    private:
      std::uint64_t
      position(const MultiIndex<dim> &index) const
      {
        return lexicographic<dim>(index, space.cells_per_direction());
      }

      void
      append_ring(std::vector<std::uint64_t> &marks,
                  const MultiIndex<dim>      &center) const
      {
        const unsigned int n_rings = (space.degree() + 1) / 2,
                           level   = levels.level(center);
        MultiIndex<dim> extents;
        extents.fill(2 * n_rings + 1);
        for (unsigned int k = 0;
             k < Utilities::fixed_power<dim>(2 * n_rings + 1);
             ++k)
          {
            const auto      offset = multi_index<dim>(k, extents);
            MultiIndex<dim> index  = center;
            for (unsigned int d = 0; d < dim; ++d)
              index[d] += offset[d] - n_rings;
            if (levels.level(index) == level)
              marks.push_back(position(index));
          }
      }

      const SplineSpace<dim>   &space;
      const CellHierarchy<dim> &levels;
      std::vector<double>       values;    // by owned cell
      std::vector<bool>         may_halve; // by owned cell
    };



    /// Return how many cells may be marked, with the rings around them.
    template <int dim>
    double
    n_allowed_marks(const SplineSpace<dim> &space,
                    const unsigned int      most_cells)
    {
      const double n_cells =
        Utilities::MPI::sum(double(space.owned_cells().size()),
                            space.communicator());
      const unsigned int n_rings = (space.degree() + 1) / 2;
      return std::max(0., most_cells - n_cells) /
             (Utilities::fixed_power<dim>(2. * n_rings + 1.) *
              ((1u << dim) - 1.));
    }
  } // namespace



  template <int dim>
  RefinementMarks<dim>
  mark_cells(State<dim>                 &state,
             Discretization<dim>        &discretization,
             const SimulationParameters &parameters)
  {
    RefinementMarks<dim>       result;
    const SplineSpace<dim>    &space = discretization.space();
    std::vector<std::uint64_t> marks;
    for (const auto &[name, region] : parameters.grid.regions)
      if (region.has_indicator() && region.acts_at(state.time))
        {
          const bool             by_jumps = region.indicator == "stress jump";
          const RegionMarks<dim> of_region(
            region,
            name,
            space,
            by_jumps ? stress_jumps(state, discretization, parameters)
                     : plastic_strains(state, space.owned_cells().size()),
            state.time,
            parameters.grid.adapt_every > 0);
          double halves = by_jumps ? of_region.value_of_share(share_of_jumps)
                                   : region.refine_above;
          const double keeps =
            halves *
            (by_jumps ? part_that_keeps * part_that_keeps : part_that_keeps);
          if (parameters.grid.most_cells > 0)
            {
              const double limit = of_region.value_of_number(
                n_allowed_marks(space, parameters.grid.most_cells));
              result.is_limited = result.is_limited || limit > halves;
              halves            = std::max(halves, limit);
            }
          of_region.append(marks, halves, keeps);
        }
    for (const auto &of_process :
         Utilities::MPI::all_gather(space.communicator(), marks))
      for (const std::uint64_t position : of_process)
        result.cells.push_back(space.lattice().hierarchy()->index(position));
    return result;
  }



  GREVILLE_INSTANTIATE(mark_cells);
} // namespace greville
