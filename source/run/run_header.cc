// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/unit_of_sums.h>
#include <greville/run/run_header.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <iomanip>

namespace greville
{
  using namespace dealii;

  namespace
  {
    std::string
    text_of_levels(const GridParameters &grid)
    {
      const unsigned int n = grid.n_levels();
      return n == 0 ? ""
                    : ", halved up to " + std::to_string(n) +
                        (n == 1 ? " time" : " times");
    }



    // The largest imbalance without a note, as a fraction of the weight. Bodies
    // without stresses have 1.
    constexpr double largest_imbalance = 1.5;



    std::string
    cells_text(const std::vector<unsigned int> &cells)
    {
      std::string result;
      for (const unsigned int n : cells)
        result += (result.empty() ? "" : " x ") + std::to_string(n);
      return result;
    }



    template <int dim>
    void
    print_levels(std::ostream               &out,
                 const Simulation<dim>      &simulation,
                 const SimulationParameters &parameters)
    {
      const std::vector<SolverLevel> levels = simulation.solver_levels();
      if (!levels.empty())
        {
          out << "  level  order       unknowns   used\n";
          for (unsigned int l = levels.size(); l-- > 0;)
            out << std::setw(7) << l << std::setw(7) << levels[l].degree
                << std::setw(15) << levels[l].n_unknowns << "   "
                << levels[l].method << '\n';
          out << std::endl;
          return;
        }
      const auto &hierarchy = simulation.mass().hierarchy();
      const bool  all =
        simulation.mass().is_exact() && parameters.solver.has_cycle();
      out << "  level  order   coefficients   used\n";
      for (unsigned int l = hierarchy.n_levels(); l-- > 0;)
        if (all || l + 1 == hierarchy.n_levels())
          out << std::setw(7) << l << std::setw(7) << hierarchy[l].degree()
              << std::setw(15) << hierarchy[l].n_dofs() << "   "
              << (l == 0 && all && hierarchy.n_levels() > 1
                    ? "conjugate gradients"
                  : all ? parameters.multigrid.smoother
                        : simulation.mass().solver())
              << '\n';
      out << std::endl;
    }
  } // namespace



  template <int dim>
  void
  print_header(std::ostream                  &out,
               const CoupledSimulations<dim> &simulations,
               const SimulationParameters    &parameters,
               const MPI_Comm                 comm)
  {
    out << "Greville, " << dim << "D, " << Utilities::MPI::n_mpi_processes(comm)
        << " process(es)\n\n"
        << "  body             material         points\n";
    for (const Body<dim> &body : simulations.bodies())
      out << "  " << std::left << std::setw(16) << body.name << " "
          << std::setw(16) << body.parameters->material << std::right
          << std::setw(7)
          << (body.n_points == 0 ? "later" : std::to_string(body.n_points))
          << '\n';
    if (parameters.has_body_grids() || simulations.n_parts() > 1)
      {
        out << "\n  grid of          cells            order\n";
        for (unsigned int k = 0; k < simulations.n_parts(); ++k)
          {
            const Simulation<dim> &part = simulations.part(k);
            const GridParameters  &grid = part.stage_parameters().grid;
            out << "  " << std::left << std::setw(16) << part.bodies()[0].name
                << " " << std::setw(16) << cells_text(grid.cells) << std::right
                << std::setw(6) << grid.degree << '\n';
          }
        out << '\n';
      }
    else
      out << "\n  grid: " << cells_text(parameters.grid.cells) << " cells"
          << (parameters.grid.is_uniform() ? "" : " of different sizes")
          << text_of_levels(parameters.grid) << ", order "
          << parameters.grid.degree
          << (parameters.grid.is_axisymmetric() ? ", axisymmetric" : "")
          << '\n';
    for (const std::string &name : parameters.general.contacts)
      {
        const ContactParameters &contact = parameters.contacts.at(name);
        out << "  contact " << name << ": " << contact.bodies << ", "
            << (contact.is_rough()
                  ? "rough"
                  : "friction " + formula_text(contact.friction))
            << '\n';
      }
    if (parameters.scheme.is_total_lagrangian() &&
        simulations.bodies().size() > 1 && parameters.contacts.empty())
      out << "  Bodies do not interact in total Lagrangian steps.\n";
    for (unsigned int k = 0;
         k < simulations.n_parts() && !parameters.scheme.is_total_lagrangian();
         ++k)
      if (const auto &bodies = simulations.part(k).bodies(); bodies.size() > 1)
        {
          out << "  bodies that stick where they meet: ";
          for (const Body<dim> &body : bodies)
            out << (&body == &bodies.front() ? "" : ", ") << body.name;
          out << '\n';
        }
    print_stage(out, simulations, parameters);
  }



  template <int dim>
  void
  print_stage(std::ostream                  &out,
              const CoupledSimulations<dim> &simulations,
              const SimulationParameters    &parameters)
  {
    const SchemeParameters &scheme =
      simulations.first().stage_parameters().scheme;
    const TimeParameters &time = simulations.first().stage_parameters().time;
    if (!parameters.stages.empty())
      {
        const unsigned int     k     = simulations.first().state().stage;
        const StageParameters &stage = parameters.stages[k];
        out << "  " << parameters.stage_text(k) << "t = " << time.start
            << " to " << time.end << " s\n";
        if (!stage.has_all_bodies())
          out << "  bodies: " << boost::algorithm::join(stage.bodies, ", ")
              << '\n';
        if (!stage.materials.empty())
          out << "  materials: "
              << boost::algorithm::join(stage.materials, ", ") << '\n';
      }
    out << "  mass: " << scheme.mass;
    const std::string &solver = simulations.first().mass().solver();
    if (solver != scheme.mass)
      out << " (" << solver << ")";
    out << ", " << scheme.stress_update << ", " << scheme.transfer << "\n\n";
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        if (parameters.has_body_grids() || simulations.n_parts() > 1)
          out << "  grid of " << simulations.part(k).bodies()[0].name << ":\n";
        print_levels(out, simulations.part(k), parameters);
      }
  }



  template <int dim>
  std::string
  print_imbalance(std::ostream               &out,
                  CoupledSimulations<dim>    &simulations,
                  const SimulationParameters &parameters,
                  const MPI_Comm              comm)
  {
    const auto has_stress = [](const auto &body) {
      return body.second.K0 >= 0. || !body.second.stress.empty();
    };
    const auto &first = simulations.first();
    if ((std::none_of(parameters.bodies.begin(),
                      parameters.bodies.end(),
                      has_stress) &&
         parameters.water.table.empty()) ||
        !parameters.contacts.empty() || first.grid().walls().have_friction() ||
        !parameters.water.free_surface_pressure.empty())
      return "";
    double force = 0., mass = 0.;
    for (unsigned int k = 0; k < simulations.n_parts(); ++k)
      {
        Simulation<dim> &part = simulations.part(k);
        VectorField<dim> sums = part.grid_force();
        for (unsigned int d = 0; d < dim; ++d)
          for (const unsigned int i :
               part.grid().walls().constrained_functions(part.space(), d))
            sums[d].local_element(i) = 0.;
        for (unsigned int i = 0; i < sums[0].locally_owned_size(); ++i)
          {
            double square = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              square += std::pow(sums[d].local_element(i), 2);
            force += std::sqrt(square);
          }
        for (const Body<dim> &body : part.state().bodies)
          body.points.for_each([&](ConstPointRef<dim> p) { mass += p.mass(); });
      }
    force = Utilities::MPI::sum(force, comm);
    const Loads<dim> loads(parameters);
    const double     weight = Utilities::MPI::sum(mass, comm) *
                          loads.gravity(first.state().time).norm();
    out << "  initial state: " << std::setprecision(3) << force << ' '
        << unit_of_sums("N", dim, parameters.grid) << " are not in balance";
    if (weight > 0.)
      out << ", " << 100. * force / weight << " % of the weight";
    out << "\n\n";
    if (weight == 0. || force < largest_imbalance * weight)
      return "";
    return "At the start " + rounded(force / weight, 3) +
           " times the weight of all bodies is not in balance, so that "
           "stresses "
           "or pore pressures do not fit the loads. Compare 'Water/Table', "
           "'Stress', 'K0' and 'Surface' of bodies with the level of the "
           "ground, in m and Pa; water above the ground is a load, 'Water/Free "
           "surface pressure' or 'Surface loads'.";
  }



  GREVILLE_INSTANTIATE(print_header);
  GREVILLE_INSTANTIATE(print_imbalance);
  GREVILLE_INSTANTIATE(print_stage);
} // namespace greville
