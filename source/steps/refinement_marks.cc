// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/refinement_region.h>
#include <greville/steps/refinement_marks.h>
#include <greville/steps/stress_jumps.h>

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



    /// The values of an indicator by owned cell: all, and the ones for which
    /// cells are halved.
    struct Values
    {
      std::vector<double> all, halving;
    };



    /// Collective. Return, for each owned cell, the sums of the squares of
    /// stress_jumps(), weighted by volumes.
    template <int dim>
    Values
    squares_of_jumps(State<dim>                 &state,
                     Discretization<dim>        &discretization,
                     const SimulationParameters &parameters)
    {
      const SplineSpace<dim> &space   = discretization.space();
      const unsigned int      n_cells = space.owned_cells().size();
      Values                  squares;
      squares.all.resize(n_cells, 0.);
      squares.halving = squares.all;
      std::vector<double> volumes(n_cells, 0.), sums(2, 0.);
      const auto  jumps = stress_jumps(state, discretization, parameters);
      std::size_t k     = 0;
      for (const Body<dim> &body : state.bodies)
        body.points.for_each(
          [&](const unsigned int cell, const ConstPointRef<dim> p) {
            const double V = p.volume();
            volumes[cell] += V;
            squares.all[cell] +=
              V * Utilities::fixed_power<2>(jumps.of_points[k]);
            squares.halving[cell] +=
              V * Utilities::fixed_power<2>(jumps.developed[k]);
            ++k;
            sums[0] += V * (p.stress() * p.stress());
            sums[1] += V;
          });
      Utilities::MPI::sum(sums, space.communicator(), sums);
      const double negligible =
        smallest_jump * smallest_jump * sums[0] / sums[1];
      for (std::vector<double> *values : {&squares.all, &squares.halving})
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          if (!((*values)[cell] > negligible * volumes[cell]))
            (*values)[cell] = 0.;
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
                  const Values               &given,
                  const double                time,
                  const bool                  moves,
                  const IsNearSurface<dim>   &is_near)
        : space(space)
        , levels(*space.lattice().hierarchy())
        , values(given.all)
        , halving(given.halving)
      {
        const RefinementRegion<dim> shape(region, name, moves, is_near);
        run_on_all(space.communicator(), [&]() {
          for (unsigned int cell = 0; cell < values.size(); ++cell)
            {
              const CellBox<dim> box   = space.box(cell);
              const unsigned int level = levels.level(box.index);
              if (values[cell] > 0. && !shape.contains(level, box, time))
                values[cell] = halving[cell] = 0.;
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
        std::vector<double>       refinable = halving;
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
            if (halving[cell] > halves && may_halve[cell])
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
      std::vector<double>       values, halving; // see Values
      std::vector<bool>         may_halve;       // by owned cell
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
             const SimulationParameters &parameters,
             const IsNearSurface<dim>   &is_near)
  {
    RefinementMarks<dim>       result;
    const SplineSpace<dim>    &space = discretization.space();
    std::vector<std::uint64_t> marks;
    for (const auto &[name, region] : parameters.grid.regions)
      if (region.has_indicator() && region.acts_at(state.time))
        {
          const bool by_jumps = region.indicator == Indicator::stress_jump;
          Values     values;
          if (by_jumps)
            values = squares_of_jumps(state, discretization, parameters);
          else
            {
              values.all = plastic_strains(state, space.owned_cells().size());
              values.halving = values.all;
            }
          const RegionMarks<dim> of_region(region,
                                           name,
                                           space,
                                           values,
                                           state.time,
                                           parameters.grid.adapt_every > 0,
                                           is_near);
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
      result.cells.insert(result.cells.end(),
                          of_process.begin(),
                          of_process.end());
    return result;
  }



  GREVILLE_INSTANTIATE(mark_cells);
} // namespace greville
