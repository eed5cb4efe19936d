// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/memory.h>
#include <greville/base/parameters.h>
#include <greville/base/simd.h>
#include <greville/benchmark/mass_benchmark.h>
#include <greville/benchmark/operators.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <numeric>
#include <sstream>

namespace greville
{
  using namespace dealii;

  MassBenchmark::MassBenchmark()
    : out(std::cout, Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
  {}



  void
  MassBenchmark::declare(ParameterHandler &prm)
  {
    declare_section(prm, "Benchmark", parameters);
    declare_section(prm, "Problem", problem_parameters);
    declare_section(prm, "Solver", solver_parameters);
    declare_section(prm, "p-multigrid", multigrid_parameters);
    declare_section(prm, "Smoother", smoother_parameters);
  }



  namespace
  {
    /**
     * Collective. What the first process writes is known to have failed to all.
     */
    void
    write_on_first(const std::function<void()> &write)
    {
      run_on_all(
        [&]() {
          if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
            write();
        },
        MPI_COMM_WORLD);
    }



    /**
     * The entries of a list, or the one value where the list is empty.
     */
    std::vector<std::string>
    list_or(const std::vector<std::string> &list, const std::string &value)
    {
      return list.empty() ? std::vector<std::string>{value} : list;
    }
  } // namespace



  void
  MassBenchmark::run(const std::string &file)
  {
    ParameterHandler prm;
    declare(prm);
    parse_parameter_file(
      prm,
      file,
      read_parameter_lines(file, "Benchmark", {"Simulation"}, "greville"));
    const std::filesystem::path path(file);
    check_parameters(path.parent_path().string());

    output_directory = parameters.output_directory.empty()
                         ? "output/" + path.stem().string()
                         : parameters.output_directory;
    // The copy lies elsewhere: its files have absolute names.
    std::ostringstream used;
    {
      std::string absolute;
      for (const std::string &entry : parameters.published)
        {
          const std::size_t colon = entry.find(':');
          absolute +=
            (absolute.empty() ? "" : ", ") + entry.substr(0, colon + 1) +
            std::filesystem::absolute(path.parent_path() /
                                      Utilities::trim(entry.substr(colon + 1)))
              .string();
        }
      prm.enter_subsection("Benchmark");
      prm.set("Published iterations", absolute);
      prm.set("Output directory", output_directory);
      prm.leave_subsection();
      prm.print_parameters(used, ParameterHandler::Text);
    }
    write_on_first([&]() {
      create_folder(output_directory, "Benchmark/Output directory");
      write_atomically(output_directory + "/parameters.prm", used.str());
    });
    print_header(file);

    const auto cells = cells_of_dimensions();
    for (unsigned int k = 0; k < parameters.dimensions.size(); ++k)
      if (parameters.dimensions[k] == 2)
        run_dimension<2>(cells[k]);
      else
        run_dimension<3>(cells[k]);
    progress.finish();

    if (parameters.throughput)
      bandwidth = measure_bandwidth(MPI_COMM_WORLD);
    write_on_first([&]() { write_results(); });
    bool has_result = false;
    for (const SolveRecord &record : records)
      has_result = has_result || !record.has_failed;
    AssertThrow(has_result,
                ExcMessage("All solves have failed; the first one: " +
                           records.front().variant() + ", " +
                           std::to_string(records.front().cells) +
                           " cells, p = " + std::to_string(records.front().p) +
                           " " + records.front().result.reason + "."));
  }



  void
  MassBenchmark::print_header(const std::string &file) const
  {
    out << "Greville mass_benchmark: "
        << std::filesystem::path(file).filename().string() << "\n  density "
        << problem_parameters.density << ", acceleration "
        << problem_parameters.acceleration << ", tolerance "
        << solver_parameters.tolerance;
    if (!problem_parameters.bodies.empty())
      {
        out << "\n  material points, jitter " << problem_parameters.jitter;
        if (problem_parameters.extend)
          out << ", extended B-splines, filling threshold "
              << problem_parameters.filling_threshold;
      }
    out << "\n  processes " << Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)
        << ", results in " << output_directory << '\n';
    if (parameters.print_times)
      out << "  " << simd_width << " doubles per SIMD vector, deal.II "
          << DEAL_II_PACKAGE_VERSION << '\n';
    out << '\n';

    // The hierarchy of the largest order, with its sizes.
    const unsigned int p =
      *std::max_element(parameters.orders.begin(), parameters.orders.end());
    const auto orders = OrderHierarchy<2>::orders(
      p, list_or(parameters.coarsenings, multigrid_parameters.coarsening)[0]);
    const auto cells = cells_of_dimensions();
    out << "  level  order  unknowns\n";
    for (unsigned int l = orders.size(); l-- > 0;)
      {
        out << std::setw(7) << l << std::setw(7) << orders[l] << " ";
        for (unsigned int k = 0; k < cells.size(); ++k)
          for (const unsigned int n : cells[k])
            {
              unsigned long size = 1;
              for (unsigned int d = 0; d < parameters.dimensions[k]; ++d)
                size *= n * problem_parameters.cell_ratio[d] + orders[l];
              out << ' ' << size;
            }
        out << '\n';
      }
  }



  template <int dim>
  void
  MassBenchmark::run_dimension(const std::vector<unsigned int> &cells)
  {
    // Number of variants of solvers, and of problems on a mesh.
    unsigned int n_variants = 0;
    for (const std::string &solver : parameters.solvers)
      {
        unsigned int n = 1;
        if (MassSolver<dim>::uses_multigrid(solver))
          for (const auto &list : parameters.variants())
            n *= std::max<std::size_t>(1, list.values.size());
        n_variants += n;
      }
    const auto        &bodies = problem_parameters.bodies;
    const auto        &counts = problem_parameters.points_per_direction;
    const unsigned int n_problems =
      bodies.empty() ? 1 : bodies.size() * counts.size();
    progress.finish();
    progress.start(n_variants * n_problems * cells.size() *
                     parameters.orders.size(),
                   out.is_active() && parameters.print_times);

    Point<dim> lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = problem_parameters.lower[d];
        upper[d] = problem_parameters.upper[d];
      }
    for (const unsigned int n : cells)
      {
        DistributedTriangulation<dim> triangulation(MPI_COMM_WORLD,
                                                    Triangulation<dim>::none,
                                                    mesh_settings<dim>);
        double                        n_all = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          n_all *= double(n) * problem_parameters.cell_ratio[d];
        check_memory_of_cells(n_all,
                              dim,
                              "The parameters 'Benchmark/Cells' and "
                              "'Problem/Cell ratio'",
                              MPI_COMM_WORLD);
        MultiIndex<dim> n_cells;
        for (unsigned int d = 0; d < dim; ++d)
          n_cells[d] = n * problem_parameters.cell_ratio[d];
        create_box_mesh<dim>(triangulation, lower, upper, n_cells);
        SolveRecord record;
        record.dim   = dim;
        record.cells = n;
        if (bodies.empty())
          {
            const auto problem = make_density_problem<dim>(problem_parameters);
            run_problem<dim>(*problem, triangulation, record);
          }
        for (const std::string &body : bodies)
          for (const unsigned int count : counts)
            {
              const auto problem = make_point_problem<dim>(problem_parameters,
                                                           body,
                                                           count,
                                                           triangulation);
              record.body        = body;
              record.points_per_direction = count;
              run_problem<dim>(*problem, triangulation, record);
            }
      }
  }



  namespace
  {
    /**
     * Set the high-water mark of the process's memory back to what it holds.
     * False where the system does not allow it.
     */
    bool
    reset_peak_memory()
    {
      std::ofstream file("/proc/self/clear_refs");
      file << "5";
      file.close();
      return static_cast<bool>(file);
    }



    double
    median(std::vector<double> values)
    {
      std::sort(values.begin(), values.end());
      const std::size_t n = values.size();
      return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
    }
  } // namespace



  template <int dim>
  void
  MassBenchmark::run_problem(MassProblem<dim>              &problem,
                             DistributedTriangulation<dim> &triangulation,
                             const SolveRecord             &what)
  {
    PMultigridParameters &m   = multigrid_parameters;
    const std::string     old = m.coarsening;
    for (const unsigned int p : parameters.orders)
      for (const std::string &coarsening : list_or(parameters.coarsenings, old))
        {
          m.coarsening = coarsening;
          const OrderHierarchy<dim> orders(triangulation, p, coarsening);
          const SplineSpace<dim>   &space = orders.finest();
          const auto                mass  = problem.make_mass(orders);
          const typename Extension<dim>::Counts functions =
            problem.count_functions(space);
          const bool is_first =
            coarsening == list_or(parameters.coarsenings, old)[0];

          SolveRecord record = what;
          record.p           = p;
          record.unknowns    = space.n_dofs();
          record.processes =
            Utilities::MPI::n_mpi_processes(space.communicator());
          record.stable   = functions.stable;
          record.extended = functions.extended;
          record.lumped   = functions.lumped;
          for (const std::string &solver : parameters.solvers)
            // Only p-multigrid has more than the finest level.
            if (is_first || MassSolver<dim>::uses_multigrid(solver))
              run_solver<dim>(solver, problem, *mass, record);

          if (parameters.throughput && is_first)
            {
              operator_records.push_back(
                measure_operators<dim>(mass->finest()));
              operator_records.back().cells = what.cells;
            }
        }
    m.coarsening = old;
  }



  template <int dim>
  void
  MassBenchmark::run_solver(const std::string  &solver,
                            MassProblem<dim>   &problem,
                            MassHierarchy<dim> &mass,
                            const SolveRecord  &what)
  {
    const auto run = [&](const SolveRecord &record) {
      records.push_back(solve<dim>(problem, mass, record));
      // Nothing is lost if a later solve fails.
      write_on_first([&]() {
        write_atomically(output_directory + "/solves.csv", solves_csv(records));
      });
    };
    SolveRecord record = what;
    record.solver      = solver;
    if (!MassSolver<dim>::uses_multigrid(solver))
      {
        run(record);
        return;
      }

    PMultigridParameters            &m = multigrid_parameters;
    const std::array<std::string, 4> old{
      {m.smoother, m.cycle, m.restriction, m.prolongation}};
    for (const std::string &smoother : list_or(parameters.smoothers, old[0]))
      for (const std::string &cycle : list_or(parameters.cycles, old[1]))
        for (const std::string &restriction :
             list_or(parameters.restrictions, old[2]))
          for (const std::string &prolongation :
               list_or(parameters.prolongations, old[3]))
            {
              record.smoother = m.smoother = smoother;
              record.cycle = m.cycle = cycle;
              record.restriction = m.restriction = restriction;
              record.prolongation = m.prolongation = prolongation;
              record.coarsening                    = m.coarsening;
              record.names_prolongation = parameters.prolongations.size() > 1;
              record.names_coarsening   = parameters.coarsenings.size() > 1;
              run(record);
            }
    std::tie(m.smoother, m.cycle, m.restriction, m.prolongation) =
      std::tie(old[0], old[1], old[2], old[3]);
  }



  template <int dim>
  SolveRecord
  MassBenchmark::solve(MassProblem<dim>   &problem,
                       MassHierarchy<dim> &mass,
                       SolveRecord         record)
  {
    const SplineSpace<dim> &space = mass.finest().space();
    const MPI_Comm          comm  = space.communicator();
    progress.show(record.variant() + ", " + std::to_string(record.cells) +
                  " cells, p = " + std::to_string(space.degree()));

    MassSolver<dim> solver(record.solver,
                           mass,
                           solver_parameters,
                           multigrid_parameters,
                           smoother_parameters);
    VectorType      x, b;
    space.initialize_vector(x);
    space.initialize_vector(b);

    const bool has_peak =
      Utilities::MPI::min(int(reset_peak_memory()), comm) == 1;
    bool                is_of_problem = false;
    std::vector<double> assembly, setup, solution;
    const auto timed = [&](std::vector<double> &times, const auto &action) {
      MPI_Barrier(comm);
      Timer timer;
      action();
      times.push_back(Utilities::MPI::max(timer.wall_time(), comm));
    };
    for (unsigned int k = 0; k < parameters.repetitions; ++k)
      try
        {
          timed(assembly, [&]() { solver.assemble(); });
          is_of_problem = true;
          problem.right_hand_side(b, mass.finest());
          is_of_problem = false;
          timed(setup, [&]() { solver.setup(); });
          timed(solution, [&]() { record.result = solver.solve(x, b); });

          record.error = problem.error(x, mass.finest());
          record.has_failed =
            record.result.iterations && !record.result.converged;
        }
      catch (const std::exception &error)
        {
          if (is_of_problem)
            throw;
          // A solver that cannot be set up says why and leaves the others
          // their turn. All processes throw what one throws.
          record.result           = SolveResult();
          record.result.reason    = message_of(error);
          record.result.reduction = 1.;
          record.error            = 1.;
          record.has_failed       = true;
          break;
        }
    if (has_peak)
      {
        Utilities::System::MemoryStats memory;
        Utilities::System::get_memory_stats(memory);
        record.peak_bytes =
          1024 *
          Utilities::MPI::sum(static_cast<unsigned long>(memory.VmHWM), comm);
      }
    record.assembly = assembly.empty() ? 0. : median(assembly);
    record.setup    = setup.empty() ? 0. : median(setup);
    record.solve    = solution.empty() ? 0. : median(solution);
    for (const auto &level : mass.all_levels())
      level->clear();
    return record;
  }



  void
  MassBenchmark::write_results() const
  {
    std::ostream &stream = std::cout;
    print_iterations(stream, records);
    if (parameters.print_times)
      print_times(stream, records);

    if (!parameters.published.empty())
      {
        std::string csv = "variant,cells,p,measured,published,difference\n";
        for (const auto &table : published)
          csv +=
            compare_with_published(stream, records, table.first, table.second);
        write_atomically(output_directory + "/comparison.csv", csv);
      }
    if (parameters.throughput)
      {
        print_operators(stream, operator_records, bandwidth);
        write_atomically(output_directory + "/operators.csv",
                         operators_csv(operator_records, bandwidth));
      }
    stream << "\nWritten: " << output_directory << "/solves.csv\n";
  }
} // namespace greville
