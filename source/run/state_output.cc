// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/state_output.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::vector<SurfaceNumbers>
    numbers_of_surfaces(const State<dim>           &state,
                        const SimulationParameters &parameters)
    {
      const auto place = [](const std::vector<std::string> &names,
                            const std::string              &name) {
        return unsigned(std::find(names.begin(), names.end(), name) -
                        names.begin());
      };
      const GeneralParameters    &general = parameters.general;
      std::vector<SurfaceNumbers> numbers;
      for (const Surface<dim> &surface : state.surfaces)
        numbers.push_back(
          {!surface.contact.empty()
             ? unsigned(general.surface_loads.size()) +
                 place(general.contacts, surface.contact)
             : place(general.surface_loads, surface.name),
           place(general.bodies, state.bodies[surface.body].name)});
      return numbers;
    }



    /// Return the region at which half spaces are cut: two cells beyond the
    /// grids.
    template <int dim>
    BoundingBox<dim>
    region_of_rigid_bodies(const CoupledSimulations<dim> &simulations,
                           const GridParameters          &grid)
    {
      std::vector<Point<dim>> corners(2);
      for (unsigned int d = 0; d < dim; ++d)
        {
          corners[0][d] = grid.lower[d];
          corners[1][d] = grid.upper[d];
          const double h =
            (corners[1][d] - corners[0][d]) / double(grid.cells[d]);
          for (unsigned int k = 0; k < simulations.n_parts(); ++k)
            {
              const SplineSpace<dim> &space = simulations.part(k).space();
              corners[0][d] = std::min(corners[0][d], space.lower_corner()[d]);
              corners[1][d] = std::max(corners[1][d], space.upper_corner()[d]);
            }
          corners[0][d] -= 2. * h;
          corners[1][d] += 2. * h;
        }
      return BoundingBox<dim>({corners[0], corners[1]});
    }
  } // namespace



  template <int dim>
  std::string
  name_of_part(const CoupledSimulations<dim> &simulations,
               const unsigned int             part)
  {
    return simulations.n_parts() > 1
             ? simulations.part(part).state().bodies[0].name
             : "";
  }



  template <int dim>
  unsigned int
  first_body_of_part(const CoupledSimulations<dim> &simulations,
                     const unsigned int             part)
  {
    unsigned int first = 0;
    for (unsigned int k = 0; k < part; ++k)
      first += simulations.part(k).state().bodies.size();
    return first;
  }



  template <int dim>
  void
  write_bodies(FieldOutput<dim>           &output,
               CoupledSimulations<dim>    &simulations,
               const unsigned int          part,
               const SimulationParameters &parameters,
               const MPI_Comm              comm)
  {
    const State<dim>   &state     = simulations.part(part).state();
    const bool          has_jumps = parameters.output.has_stress_jumps();
    std::vector<double> jumps;
    if (has_jumps)
      jumps = simulations.part(part).stress_jumps();
    output.write_points(state.time,
                        simulations.bodies(),
                        comm,
                        first_body_of_part(simulations, part),
                        state.bodies.size(),
                        has_jumps ? &jumps : nullptr);
    output.write_surfaces(state.time,
                          state.surfaces,
                          numbers_of_surfaces(state, parameters),
                          comm,
                          name_of_part(simulations, part));
    if (simulations.rigid_bodies().empty() || part > 0)
      return;
    const BoundingBox<dim> region =
      region_of_rigid_bodies(simulations, parameters.grid);
    for (unsigned int k = 0; k < simulations.rigid_bodies().size(); ++k)
      output.write_rigid_body(state.time,
                              simulations.rigid_bodies()[k],
                              state.rigid_bodies[k].now,
                              region,
                              comm);
  }



  GREVILLE_INSTANTIATE(name_of_part);

  GREVILLE_INSTANTIATE(first_body_of_part);

  GREVILLE_INSTANTIATE(write_bodies);
} // namespace greville
