// SPDX-License-Identifier: LGPL-2.1-or-later

// The linear systems of implicit steps: mass and stiffness of the bodies of a
// simulation at rest, solved for a random load.
//
//   ninja -C build tangent_benchmark
//   build/tangent_benchmark FILE.prm [NAME VALUE]...
//
// prints unknowns, iterations, and seconds of the parts. Names: cells (in each
// direction), order, points (per direction and cell), mass (c in c M + K,
// 1/s^2; 0: quasi-static), tolerance, preconditioner (p-multigrid, gamg,
// boomeramg, icc, or a smoother alone), and of the cycle coarse, smoother,
// coarsening, prolongation, degree, range (see doc/simulation_parameters.md).
// scripts/stiffness_tables runs it over bodies, meshes and orders.

#include <deal.II/base/mpi.h>

#include <greville/base/parameters.h>
#include <greville/simulation/simulation.h>
#include <greville/stiffness/tangent_system.h>

#include <chrono>
#include <functional>
#include <iostream>
#include <map>

using namespace dealii;
using namespace greville;

namespace
{
  double
  seconds()
  {
    return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
  }



  template <int dim>
  void
  run(const SimulationParameters &parameters,
      const double                mass_factor,
      const double                tolerance,
      const TangentParameters    &tangent)
  {
    const MPI_Comm     comm = MPI_COMM_WORLD;
    Simulation<dim>    simulation(parameters, comm);
    const Walls<dim>   walls(parameters.walls);
    TangentSystem<dim> system(
      parameters.grid.degree,
      simulation.grid().triangulation(),
      [&](const SplineSpace<dim> &space) {
        return held_components_at_walls(space, walls);
      },
      tangent,
      parameters.scheme.filling,
      false);
    std::vector<TrialBody<dim>> bodies;
    for (const Body<dim> &body : simulation.state().bodies)
      bodies.push_back({&body.points, body.material, body.name, 1.});

    const double start = seconds();
    system.set_points(bodies);
    VectorField<dim> u, force;
    for (unsigned int c = 0; c < dim; ++c)
      {
        system.space().initialize_vector(u[c]);
        system.space().initialize_vector(force[c]);
      }
    const double at_points = seconds();
    system.evaluate(bodies, u, 1., StepStress::end, true, force);
    const double at_stiffness = seconds();
    system.set_operator(mass_factor, true);
    const double at_setup = seconds();

    VectorType x, b;
    system.initialize(x);
    system.initialize(b);
    const auto &functions = system.space().owned_functions();
    for (unsigned int i = 0; i < functions.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        b.local_element(i * dim + c) =
          std::sin(12.9898 * ((functions[i] + 1) % 104729) + c);
    system.extend(u, b);
    system.restrict(b, u, nullptr);
    const SolveResult result = system.solve(x, b, tolerance);
    const double      end    = seconds();
    unsigned int      n_unknowns =
      system.finest().extended().n_owned_unknowns() * dim;
    n_unknowns = Utilities::MPI::sum(n_unknowns, comm);
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      std::cout << "unknowns " << n_unknowns << " iterations "
                << *result.iterations << " reduction " << result.reduction
                << " seconds: points " << at_points - start << " stiffness "
                << at_stiffness - at_points << " setup "
                << at_setup - at_stiffness << " solve " << end - at_setup
                << " rate " << n_unknowns / (end - at_stiffness) << std::endl;
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc < 2 || argc % 2 != 0)
    {
      std::cerr << "usage: tangent_benchmark FILE.prm [NAME VALUE]...\n";
      return 1;
    }
  SimulationParameters  parameters(argv[1]);
  TangentParameters     tangent;
  PMultigridParameters &multigrid   = tangent.multigrid;
  SmootherParameters   &smoother    = tangent.smoother;
  double                mass_factor = 0., tolerance = 1e-8;

  using Set = std::function<void(const std::string &)>;
  const std::map<std::string, Set> names = {
    {"cells",
     [&](const std::string &v) {
       for (unsigned int &n : parameters.grid.cells)
         n = std::stoi(v);
     }},
    {"order",
     [&](const std::string &v) { parameters.grid.degree = std::stoi(v); }},
    {"points",
     [&](const std::string &v) {
       for (auto &body : parameters.bodies)
         body.second.points_per_direction = {unsigned(std::stoi(v))};
     }},
    {"mass", [&](const std::string &v) { mass_factor = std::stod(v); }},
    {"tolerance", [&](const std::string &v) { tolerance = std::stod(v); }},
    {"preconditioner",
     [&](const std::string &v) {
       tangent.preconditioner = "p-multigrid";
       if (v == "p-multigrid")
         return;
       // Once per iteration, without levels.
       tangent.preconditioner   = "smoother";
       multigrid.post_smoothing = 0;
       multigrid.smoother       = "petsc";
       if (v == "gamg")
         smoother.petsc_options = "-pc_type gamg";
       else if (v == "boomeramg")
         smoother.petsc_options = "-pc_type hypre -pc_hypre_type boomeramg "
                                  "-pc_hypre_boomeramg_strong_threshold 0.5";
       else if (v == "icc")
         smoother.petsc_options = "-pc_type bjacobi -sub_pc_type icc";
       else
         multigrid.smoother = v;
     }},
    {"coarse",
     [&](const std::string &v) { multigrid.coarse_preconditioner = v; }},
    {"smoother", [&](const std::string &v) { multigrid.smoother = v; }},
    {"coarsening", [&](const std::string &v) { multigrid.coarsening = v; }},
    {"prolongation", [&](const std::string &v) { multigrid.prolongation = v; }},
    {"degree",
     [&](const std::string &v) { smoother.chebyshev_degree = std::stoi(v); }},
    {"range",
     [&](const std::string &v) { smoother.chebyshev_range = std::stod(v); }}};
  tangent.preconditioner = "p-multigrid";
  tangent.max_iterations = 500;
  for (int i = 2; i + 1 < argc; i += 2)
    {
      const auto found = names.find(argv[i]);
      if (found == names.end())
        {
          std::cerr << "<" << argv[i] << "> is none of the names";
          for (const auto &name : names)
            std::cerr << ' ' << name.first;
          std::cerr << '\n';
          return 1;
        }
      found->second(argv[i + 1]);
    }
  if (parameters.general.dimension == 2)
    run<2>(parameters, mass_factor, tolerance, tangent);
  else
    run<3>(parameters, mass_factor, tolerance, tangent);
}
