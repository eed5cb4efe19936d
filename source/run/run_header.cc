// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/run_header.h>

#include <iomanip>

namespace greville
{
  using namespace dealii;

  namespace
  {
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
      const bool  all       = simulation.grid().fields()[0].consistent &&
                       parameters.solver.has_cycle();
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
  print_header(std::ostream               &out,
               const Ensemble<dim>        &ensemble,
               const SimulationParameters &parameters,
               const MPI_Comm              comm)
  {
    out << "Greville, " << dim << "D, " << Utilities::MPI::n_mpi_processes(comm)
        << " process(es)\n\n"
        << "  body             material         points\n";
    for (const Body<dim> &body : ensemble.bodies())
      out << "  " << std::left << std::setw(16) << body.name << " "
          << std::setw(16) << body.parameters->material << std::right
          << std::setw(7) << body.n_points << '\n';
    if (parameters.has_body_grids() || ensemble.n_parts() > 1)
      {
        out << "\n  grid of          cells            order\n";
        for (unsigned int k = 0; k < ensemble.n_parts(); ++k)
          {
            const Simulation<dim> &part = ensemble.part(k);
            const GridParameters  &grid = part.stage_parameters().grid;
            out << "  " << std::left << std::setw(16) << part.bodies()[0].name
                << " " << std::setw(16) << cells_text(grid.cells) << std::right
                << std::setw(6) << grid.degree << '\n';
          }
        out << '\n';
      }
    else
      out << "\n  grid: " << cells_text(parameters.grid.cells)
          << " cells, order " << parameters.grid.degree << '\n';
    for (const std::string &name : parameters.general.contacts)
      {
        const ContactParameters &contact = parameters.contacts.at(name);
        out << "  contact " << name << ": " << contact.bodies << ", "
            << (contact.friction == "rough" ? "rough"
                                            : "friction " + contact.friction)
            << '\n';
      }
    if (parameters.scheme.is_total_lagrangian() &&
        ensemble.bodies().size() > 1 && parameters.contacts.empty())
      out << "  Bodies do not see one another in total Lagrangian steps.\n";
    for (unsigned int k = 0;
         k < ensemble.n_parts() && !parameters.scheme.is_total_lagrangian();
         ++k)
      if (const auto &bodies = ensemble.part(k).bodies(); bodies.size() > 1)
        {
          out << "  bodies that stick where they meet: ";
          for (const Body<dim> &body : bodies)
            out << (&body == &bodies.front() ? "" : ", ") << body.name;
          out << '\n';
        }
    print_stage(out, ensemble, parameters);
  }



  template <int dim>
  void
  print_stage(std::ostream               &out,
              const Ensemble<dim>        &ensemble,
              const SimulationParameters &parameters)
  {
    const SchemeParameters &scheme = ensemble.first().stage_parameters().scheme;
    const TimeParameters   &time   = ensemble.first().stage_parameters().time;
    if (!parameters.stages.empty())
      out << "  " << parameters.stage_text(ensemble.first().state().stage)
          << "t = " << time.start << " to " << time.end << " s\n";
    out << "  mass: " << scheme.mass;
    const std::string &solver = ensemble.first().mass().solver();
    if (solver != scheme.mass)
      out << " (" << solver << ")";
    out << ", " << scheme.stress_update << ", " << scheme.transfer
        << ", quadrature by " << scheme.quadrature << "\n\n";
    for (unsigned int k = 0; k < ensemble.n_parts(); ++k)
      {
        if (parameters.has_body_grids() || ensemble.n_parts() > 1)
          out << "  grid of " << ensemble.part(k).bodies()[0].name << ":\n";
        print_levels(out, ensemble.part(k), parameters);
      }
  }



  template decltype(print_header<2>) print_header<2>;
  template decltype(print_header<3>) print_header<3>;
  template decltype(print_stage<2>)  print_stage<2>;
  template decltype(print_stage<3>)  print_stage<3>;
} // namespace greville
