// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/memory.h>
#include <greville/base/simd.h>
#include <greville/benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace greville
{
  using namespace dealii;

  Benchmark::Benchmark(const std::string &program)
    : program(program)
    , out(std::cout, Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
  {
    add_paper_parts();
  }



  void
  Benchmark::declare(ParameterHandler &prm)
  {
    declare_section(prm, "Benchmark", parameters);
    declare_section(prm, "Problem", problem_parameters);
    declare_section(prm, "Solver", solver_parameters);
    declare_section(prm, "p-multigrid", multigrid_parameters);
    declare_section(prm, "Smoother", smoother_parameters);
    prm.enter_subsection("Implicit p-multigrid");
    declare_levels(prm, implicit.multigrid);
    prm.leave_subsection();
    declare_section(prm,
                    "Implicit p-multigrid",
                    implicit.multigrid,
                    "auto|" + smoother_names(),
                    PMultigridParameters::all_coarse_preconditioners());
    declare_section(prm, "Implicit smoother", implicit.smoother);
  }



  namespace
  {
    std::vector<std::string>
    list_or(const std::vector<std::string> &list, const std::string &value)
    {
      return list.empty() ? std::vector<std::string>{value} : list;
    }
  } // namespace



  std::string
  Benchmark::read(const std::string                  &file,
                  const std::vector<std::string>     &settings,
                  const ParameterHandler::OutputStyle style)
  {
    ParameterHandler prm;
    declare(prm);
    parse_parameter_lines(prm,
                          read_parameter_lines(file,
                                               "Benchmark",
                                               {"Simulation"},
                                               "greville",
                                               settings));
    const std::filesystem::path path(file);
    check_parameters(path.parent_path().string());

    output_directory = parameters.output_directory.empty()
                         ? "output/" + path.stem().string()
                         : parameters.output_directory;
    // The copy is in another folder, so its files need absolute names.
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
    set_parameter(prm, {"Benchmark"}, "Published iterations", absolute);
    set_parameter(prm, {"Benchmark"}, "Output directory", output_directory);
    std::ostringstream used;
    prm.print_parameters(used, style);
    return used.str();
  }



  void
  Benchmark::run(const std::string              &file,
                 const std::vector<std::string> &settings)
  {
    const std::string used = read(file, settings, ParameterHandler::PRM);
    run_on_first(MPI_COMM_WORLD, [&]() {
      create_folder(output_directory, "Benchmark/Output directory");
      write_atomically(output_directory + "/parameters.prm", used);
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
    run_on_first(MPI_COMM_WORLD, [&]() { write_results(); });
    bool has_result = false;
    for (const SolveRecord &record : records)
      has_result = has_result || !record.has_failed;
    Require(has_result,
            "All solves have failed; the first one: " +
              records.front().variant() + ", " +
              std::to_string(records.front().cells) +
              " cells, p = " + std::to_string(records.front().p) + " " +
              records.front().result.reason + ".");
  }



  void
  Benchmark::print_header(const std::string &file) const
  {
    out << "Greville " << program << ": "
        << std::filesystem::path(file).filename().string() << "\n  density "
        << problem_parameters.density << ", acceleration "
        << problem_parameters.acceleration << ", tolerance "
        << solver_parameters.tolerance;
    if (parameters.operators != BenchmarkParameters().operators)
      for (const std::string &name : parameters.operators)
        out << (&name == &parameters.operators[0] ? "\n  operators " : ", ")
            << name;
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
      out << "  " << native_simd_width << " doubles per SIMD vector, deal.II "
          << DEAL_II_PACKAGE_VERSION << '\n';
    out << '\n';

    // Print the hierarchy of the largest order, with its sizes.
    const unsigned int p =
      *std::max_element(parameters.orders.begin(), parameters.orders.end());
    const PMultigridParameters &multigrid = is_elastic(parameters.operators[0])
                                              ? implicit.multigrid
                                              : multigrid_parameters;
    const auto                  orders =
      OrderHierarchy<2>::orders(p,
                                parameters.coarsenings.empty()
                                  ? multigrid.coarsening
                                  : value_of(parameters.coarsenings[0],
                                             coarsenings));
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
  Benchmark::run_dimension(const std::vector<unsigned int> &cells)
  {
    // Number of solver variants, and of problems on a mesh.
    unsigned int n_variants = 0;
    for (const std::string &solver : parameters.solvers)
      {
        unsigned int n = 1;
        if (takes_cycle(solver))
          for (const auto &list : parameters.variants())
            n *= std::max<std::size_t>(1, list.values.size());
        else if (takes_smoother(solver))
          n = std::max<std::size_t>(1, parameters.smoothers.size());
        n_variants += n;
      }
    const auto        &bodies = problem_parameters.bodies;
    const auto        &counts = problem_parameters.points_per_direction;
    const unsigned int n_bodies =
      bodies.empty() ? 1 : bodies.size() * counts.size();
    unsigned int n_problems = 0;
    for (const std::string &name : parameters.operators)
      n_problems +=
        n_bodies * (is_elastic(name) ? parameters.poissons_ratios.size() : 1) *
        (name == "mass and elasticity" ? parameters.courant_numbers.size() : 1);
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
        for (const std::string &name : parameters.operators)
          {
            record.operator_name = name;
            run_operator<dim>(triangulation, record);
          }
      }
  }



  template <int dim>
  void
  Benchmark::run_operator(DistributedTriangulation<dim> &triangulation,
                          SolveRecord                    record)
  {
    if (record.operator_name == "laplace")
      {
        run_problem<dim>(*make_laplace_benchmark<dim>(problem_parameters,
                                                      solver_parameters,
                                                      triangulation),
                         record);
        return;
      }
    const bool                elastic    = is_elastic(record.operator_name);
    const bool                has_mass   = record.operator_name != "elasticity";
    const std::vector<double> one        = {0.};
    const std::vector<std::string>  box  = {""};
    const std::vector<unsigned int> none = {0};
    const auto                     &bodies = problem_parameters.bodies;
    for (const std::string &body : bodies.empty() ? box : bodies)
      for (const unsigned int count :
           bodies.empty() ? none : problem_parameters.points_per_direction)
        {
          record.body                 = body;
          record.points_per_direction = count;
          if (!elastic)
            run_problem<dim>(*make_mass_benchmark<dim>(problem_parameters,
                                                       solver_parameters,
                                                       body,
                                                       count,
                                                       triangulation),
                             record);
          else
            for (const double nu : parameters.poissons_ratios)
              for (const double C : has_mass ? parameters.courant_numbers : one)
                {
                  record.poissons_ratio = nu;
                  if (has_mass)
                    record.courant_number = C;
                  run_problem<dim>(
                    *make_elastic_benchmark<dim>(problem_parameters,
                                                 solver_parameters,
                                                 body,
                                                 count,
                                                 nu,
                                                 record.courant_number,
                                                 triangulation),
                    record);
                }
        }
  }



  namespace
  {
    /// Reset the high-water mark of the process's memory to its current use.
    /// Returns false if the system does not allow it.
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
  Benchmark::run_problem(BenchmarkProblem<dim> &problem,
                         const SolveRecord     &what)
  {
    PMultigridParameters &m   = multigrid_of(what.operator_name);
    const Coarsening      old = m.coarsening;
    const auto            words =
      list_or(parameters.coarsenings, word_of(old, coarsenings));
    for (const unsigned int p : parameters.orders)
      for (const std::string &word : words)
        {
          m.coarsening = value_of(word, coarsenings);
          problem.discretize(p, m.coarsening);
          const auto functions = problem.count_functions();
          const bool is_first  = word == words[0];

          SolveRecord record = what;
          record.p           = p;
          record.unknowns    = problem.n_unknowns();
          record.processes   = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
          record.stable      = functions.stable;
          record.extended    = functions.extended;
          record.lumped      = functions.lumped;
          for (const std::string &solver : parameters.solvers)
            // Only p-multigrid needs coarser levels.
            if (is_first || takes_cycle(solver))
              {
                record.solver = solver;
                run_solver<dim>(problem, record);
              }

          if (parameters.throughput && is_first)
            if (auto throughput = problem.throughput())
              {
                throughput->cells = what.cells;
                operator_records.push_back(*throughput);
              }
        }
    m.coarsening = old;
  }



  template <int dim>
  void
  Benchmark::run_solver(BenchmarkProblem<dim> &problem, const SolveRecord &what)
  {
    const auto run = [&](const SolveRecord &record) {
      records.push_back(solve<dim>(problem, record));
      // Write each record, so that it is kept if a later solve fails.
      run_on_first(MPI_COMM_WORLD, [&]() {
        write_atomically(output_directory + "/solves.csv", solves_csv(records));
      });
    };
    PMultigridParameters      &m      = multigrid_of(what.operator_name);
    const PMultigridParameters old    = m;
    SolveRecord                record = what;
    if (!takes_cycle(what.solver))
      {
        for (const std::string &smoother :
             takes_smoother(what.solver)
               ? list_or(parameters.smoothers, old.smoother)
               : std::vector<std::string>{""})
          {
            record.smoother = smoother;
            if (!smoother.empty())
              m.smoother = smoother;
            run(record);
          }
        m = old;
        return;
      }

    record.coarsening         = word_of(m.coarsening, coarsenings);
    record.names_prolongation = parameters.prolongations.size() > 1;
    record.names_coarsening   = parameters.coarsenings.size() > 1;
    for (const std::string &smoother :
         list_or(parameters.smoothers, old.smoother))
      for (const std::string &cycle :
           list_or(parameters.cycles, word_of(old.cycle, cycle_types)))
        for (const std::string &restriction :
             list_or(parameters.restrictions, old.restriction))
          for (const std::string &prolongation :
               list_or(parameters.prolongations, old.prolongation))
            {
              record.smoother = m.smoother = smoother;
              record.cycle                 = cycle;
              m.cycle                      = value_of(cycle, cycle_types);
              record.restriction = m.restriction = restriction;
              record.prolongation = m.prolongation = prolongation;
              run(record);
            }
    m = old;
  }



  template <int dim>
  SolveRecord
  Benchmark::solve(BenchmarkProblem<dim> &problem, SolveRecord record)
  {
    const MPI_Comm comm = MPI_COMM_WORLD;
    progress.show(record.variant() + ", " + std::to_string(record.cells) +
                  " cells, p = " + std::to_string(record.p));
    const SmootherParameters &smoother = is_elastic(record.operator_name)
                                           ? implicit.smoother
                                           : smoother_parameters;
    const auto                system   = problem.make_system(record.solver,
                                            multigrid_of(record.operator_name),
                                            smoother);

    const bool has_peak =
      Utilities::MPI::min(int(reset_peak_memory()), comm) == 1;
    bool                is_of_problem = false;
    std::vector<double> assembly, setup, solution;
    const auto timed = [&](std::vector<double> &times, const auto &action) {
      MPI_Barrier(comm);
      // CPU time, because other programs may run on the machine.
      const std::clock_t start = std::clock();
      action();
      times.push_back(
        Utilities::MPI::max(double(std::clock() - start) / CLOCKS_PER_SEC,
                            comm));
    };
    // Measure the bytes that the first call of an action leaves allocated, on
    // all processes.
    const auto measured = [&](std::optional<unsigned long> &bytes,
                              const unsigned int            repetition,
                              const auto                   &action) {
      const auto before = allocated_memory();
      action();
      const auto after = allocated_memory();
      if (before && after && repetition == 0)
        bytes = Utilities::MPI::sum(*after - std::min(*before, *after), comm);
    };
    for (unsigned int k = 0; k < parameters.repetitions; ++k)
      try
        {
          measured(record.operator_bytes, k, [&]() {
            timed(assembly, [&]() { system->assemble(); });
          });
          is_of_problem = true;
          system->make_right_hand_side();
          is_of_problem = false;
          measured(record.preconditioner_bytes, k, [&]() {
            timed(setup, [&]() { system->setup(); });
          });
          timed(solution, [&]() { record.result = system->solve(); });

          record.error = system->error();
          record.has_failed =
            record.result.iterations && !record.result.converged;
        }
      catch (const std::exception &error)
        {
          if (is_of_problem)
            throw;
          // If a solver cannot be set up, note the reason and continue with the
          // next one. All processes throw if one does.
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
    return record;
  }



  void
  Benchmark::write_results() const
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
