#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
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

  MassBenchmarkParameters::MassBenchmarkParameters()
    : ParameterAcceptor("Benchmark")
  {
    add_parameter("Dimensions",
                  dimensions,
                  "Dimensions to run, one after the other.",
                  prm,
                  Patterns::List(Patterns::Integer(2, 3), 1));
    add_parameter("Orders",
                  orders,
                  "Orders p of the splines.",
                  prm,
                  Patterns::List(Patterns::Integer(1, 5), 1));
    add_parameter("Cells",
                  cells,
                  "Numbers of cells per direction (times 'Cell ratio'). Lists "
                  "for several dimensions are separated by ';'. Unit: cells.");
    add_parameter("Solvers",
                  solvers,
                  "Solvers: " + MassSolver<2>::names() + ".");
    add_parameter("Smoothers",
                  smoothers,
                  "Smoothers to run each p-multigrid solver with: " +
                    smoother_names() + ". Empty: the one of p-multigrid.");
    add_parameter("Cycles",
                  cycles,
                  "Cycles to run each p-multigrid solver with: V|W|F. Empty: "
                  "the one of p-multigrid.");
    add_parameter("Restrictions",
                  restrictions,
                  "Restrictions to run each p-multigrid solver with: " +
                    OrderTransfer<2>::restrictions() +
                    ". Empty: the one of p-multigrid.");
    add_parameter("Published iterations",
                  published,
                  "Tables to compare with in the first of the dimensions: "
                  "solver:FILE, relative to the parameter file; lines of FILE "
                  "are cells,iterations at "
                  "p1,p2,...");
    add_parameter("Repetitions",
                  repetitions,
                  "Each solve runs so many times; the median of each time is "
                  "reported. Unit: solves.",
                  prm,
                  Patterns::Integer(1, 1000));
    add_parameter("Operator throughput",
                  throughput,
                  "Measure unknowns per second of the matrix-free and the "
                  "assembled operator and of the tensor-product inverse, and "
                  "the memory bandwidth.");
    add_parameter("Print times",
                  print_times,
                  "Print what differs from run to run and from machine to "
                  "machine: the machine, the progress line, the tables of "
                  "times.");
    add_parameter("Output directory",
                  output_directory,
                  "Where results go. Empty: output/NAME for NAME.prm.");
  }



  MassProblemParameters::MassProblemParameters()
    : ParameterAcceptor("Problem")
  {
    add_parameter("Lower corner",
                  lower,
                  "Corner of the box with the smallest coordinates; 2D takes "
                  "the first two. Unit: m.",
                  prm,
                  Patterns::List(Patterns::Double(), 2, 3));
    add_parameter("Upper corner",
                  upper,
                  "Corner with the largest coordinates. Unit: m.",
                  prm,
                  Patterns::List(Patterns::Double(), 2, 3));
    add_parameter("Cell ratio",
                  cell_ratio,
                  "The box has this multiple of the number of cells in each "
                  "direction. Unit: none.",
                  prm,
                  Patterns::List(Patterns::Integer(1), 2, 3));
    add_parameter("Density",
                  density,
                  "Density as an expression of x, y, z; not negative, zero in "
                  "holes, as in if(x<0.5,1,0). Unit: kg/m^dim.");
    add_parameter("Acceleration",
                  acceleration,
                  "The force is density times this expression of x, y, z, "
                  "which is then the solution, up to its projection. Unit: "
                  "m/s^2.");
  }



  MassBenchmark::MassBenchmark()
    : out(std::cout, Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
  {}



  void
  MassBenchmark::run(const std::string &file)
  {
    parse_parameter_file(file);
    const std::filesystem::path path(file);
    check_parameters(path.parent_path().string());

    output_directory = parameters.output_directory.empty()
                         ? "output/" + path.stem().string()
                         : parameters.output_directory;
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::filesystem::create_directories(output_directory);
        std::ostringstream used;
        ParameterAcceptor::prm.print_parameters(used, ParameterHandler::Text);
        write_atomically(output_directory + "/parameters.prm", used.str());
      }
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
    write_results();
  }



  namespace
  {
    /**
     * The entries of a list, or the one value where the list is empty.
     */
    std::vector<std::string>
    list_or(const std::vector<std::string> &list, const std::string &value)
    {
      return list.empty() ? std::vector<std::string>{value} : list;
    }



    void
    check_names(const std::vector<std::string> &names,
                const std::string              &parameter,
                const std::string              &allowed)
    {
      const auto list = Utilities::split_string_list(allowed, '|');
      for (const std::string &name : names)
        AssertThrow(std::count(list.begin(), list.end(), name) == 1,
                    ExcMessage("The value <" + name + "> of the parameter '" +
                               parameter + "' is none of " + allowed + "."));
    }
  } // namespace



  std::vector<std::vector<unsigned int>>
  MassBenchmark::cells_of_dimensions() const
  {
    auto lists = Utilities::split_string_list(parameters.cells, ';');
    if (lists.size() == 1)
      lists.resize(parameters.dimensions.size(), lists[0]);
    AssertThrow(lists.size() == parameters.dimensions.size(),
                ExcMessage("The parameter 'Cells' has to hold one list, or one "
                           "for each of the dimensions, separated by ';', but "
                           "is <" +
                           parameters.cells + ">."));
    std::vector<std::vector<unsigned int>> result;
    for (const std::string &list : lists)
      {
        result.emplace_back();
        for (const std::string &word : Utilities::split_string_list(list, ','))
          {
            AssertThrow(!word.empty() && word.size() < 8 &&
                          word.find_first_not_of("0123456789") ==
                            std::string::npos &&
                          std::stoul(word) > 0,
                        ExcMessage("The parameter 'Cells' has to hold whole "
                                   "numbers of 1 or more, but has <" +
                                   word + ">."));
            result.back().push_back(std::stoul(word));
          }
        AssertThrow(!result.back().empty(),
                    ExcMessage("The parameter 'Cells' holds no number."));
      }
    return result;
  }



  void
  MassBenchmark::check_parameters(const std::string &directory)
  {
    AssertThrow(!parameters.solvers.empty(),
                ExcMessage("The parameter 'Solvers' is empty. It takes some "
                           "of " +
                           MassSolver<2>::names() + "."));
    for (const std::string &solver : parameters.solvers)
      MassSolver<2>::check_name(solver);
    check_names(parameters.smoothers, "Smoothers", smoother_names());
    check_names(parameters.cycles, "Cycles", "V|W|F");
    check_names(parameters.restrictions,
                "Restrictions",
                OrderTransfer<2>::restrictions());
    for (const unsigned int dim : parameters.dimensions)
      {
        AssertThrow(problem.lower.size() >= dim &&
                      problem.upper.size() >= dim &&
                      problem.cell_ratio.size() >= dim,
                    ExcMessage("'Lower corner', 'Upper corner' and 'Cell "
                               "ratio' need " +
                               std::to_string(dim) + " numbers in " +
                               std::to_string(dim) + "D."));
        for (unsigned int d = 0; d < dim; ++d)
          AssertThrow(problem.lower[d] < problem.upper[d],
                      ExcMessage("'Lower corner' has to be below 'Upper "
                                 "corner' in each direction."));
      }
    for (const std::string &entry : parameters.published)
      {
        const std::size_t colon = entry.find(':');
        AssertThrow(colon != std::string::npos,
                    ExcMessage("The value <" + entry +
                               "> of the parameter 'Published iterations' has "
                               "not the form solver:FILE."));
        const auto table = std::filesystem::path(directory) /
                           Utilities::trim(entry.substr(colon + 1));
        published.emplace_back(Utilities::trim(entry.substr(0, colon)),
                               read_published_table(table.string()));
      }
    for (const unsigned int dim : parameters.dimensions)
      for (const auto &expression :
           {std::make_pair(problem.density, "Density"),
            std::make_pair(problem.acceleration, "Acceleration")})
        if (dim == 2)
          make_function<2>(expression.first, expression.second);
        else
          make_function<3>(expression.first, expression.second);
    cells_of_dimensions();
  }



  void
  MassBenchmark::print_header(const std::string &file) const
  {
    out << "Greville mass_benchmark: "
        << std::filesystem::path(file).filename().string() << "\n  density "
        << problem.density << ", acceleration " << problem.acceleration
        << ", tolerance " << solver_parameters.tolerance << "\n  processes "
        << Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) << ", results in "
        << output_directory << '\n';
    if (parameters.print_times)
      out << "  " << simd_width << " doubles per SIMD vector, deal.II "
          << DEAL_II_PACKAGE_VERSION << '\n';
    out << '\n';

    // The hierarchy of the largest order, with its sizes.
    const unsigned int p =
      *std::max_element(parameters.orders.begin(), parameters.orders.end());
    const auto orders =
      OrderHierarchy<2>::orders(p, multigrid_parameters.coarsening);
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
                size *= n * problem.cell_ratio[d] + orders[l];
              out << ' ' << size;
            }
        out << '\n';
      }
  }



  template <int dim>
  void
  MassBenchmark::run_dimension(const std::vector<unsigned int> &cells)
  {
    const auto density = make_function<dim>(problem.density, "Density");
    const auto acceleration =
      make_function<dim>(problem.acceleration, "Acceleration");

    unsigned int n_variants = 0;
    for (const std::string &solver : parameters.solvers)
      n_variants +=
        MassSolver<dim>::uses_multigrid(solver)
          ? std::max<std::size_t>(1, parameters.smoothers.size()) *
              std::max<std::size_t>(1, parameters.cycles.size()) *
              std::max<std::size_t>(1, parameters.restrictions.size())
          : 1;
    progress.finish();
    progress.start(n_variants * cells.size() * parameters.orders.size(),
                   out.is_active() && parameters.print_times);

    Point<dim> lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = problem.lower[d];
        upper[d] = problem.upper[d];
      }
    for (const unsigned int n : cells)
      {
        DistributedTriangulation<dim> triangulation(MPI_COMM_WORLD,
                                                    Triangulation<dim>::none,
                                                    mesh_settings<dim>);
        MultiIndex<dim>               n_cells;
        for (unsigned int d = 0; d < dim; ++d)
          n_cells[d] = n * problem.cell_ratio[d];
        create_box_mesh<dim>(triangulation, lower, upper, n_cells);
        for (const unsigned int p : parameters.orders)
          {
            const OrderHierarchy<dim> orders(triangulation,
                                             p,
                                             multigrid_parameters.coarsening);
            run_solvers<dim>(orders, *density, *acceleration, n);
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
  MassBenchmark::run_solvers(const OrderHierarchy<dim> &orders,
                             const Function<dim>       &density,
                             const Function<dim>       &acceleration,
                             const unsigned int         n_cells)
  {
    MassHierarchy<dim> mass(orders, density);
    for (const std::string &solver : parameters.solvers)
      {
        const PMultigridParameters &m = multigrid_parameters;
        const bool is_multigrid       = MassSolver<dim>::uses_multigrid(solver);
        const std::vector<std::string> none{""};
        for (const std::string &smoother :
             is_multigrid ? list_or(parameters.smoothers, m.smoother) : none)
          for (const std::string &cycle :
               is_multigrid ? list_or(parameters.cycles, m.cycle) : none)
            for (const std::string &restriction :
                 is_multigrid ? list_or(parameters.restrictions, m.restriction)
                              : none)
              {
                const std::string old_smoother    = m.smoother;
                const std::string old_cycle       = m.cycle;
                const std::string old_restriction = m.restriction;
                if (is_multigrid)
                  {
                    multigrid_parameters.smoother    = smoother;
                    multigrid_parameters.cycle       = cycle;
                    multigrid_parameters.restriction = restriction;
                  }
                records.push_back(
                  run_solver<dim>(solver, mass, orders, acceleration, n_cells));
                multigrid_parameters.smoother    = old_smoother;
                multigrid_parameters.cycle       = old_cycle;
                multigrid_parameters.restriction = old_restriction;

                // Nothing is lost if a later solve fails.
                if (out.is_active())
                  write_atomically(output_directory + "/solves.csv",
                                   solves_csv(records));
              }
      }

    if (parameters.throughput)
      {
        operator_records.push_back(measure_operators<dim>(mass.finest()));
        operator_records.back().cells = n_cells;
      }
  }



  template <int dim>
  SolveRecord
  MassBenchmark::run_solver(const std::string         &solver_name,
                            MassHierarchy<dim>        &mass,
                            const OrderHierarchy<dim> &orders,
                            const Function<dim>       &acceleration,
                            const unsigned int         n_cells)
  {
    const SplineSpace<dim> &space = orders.finest();
    const MPI_Comm          comm  = space.communicator();

    SolveRecord record;
    record.solver = solver_name;
    if (MassSolver<dim>::uses_multigrid(solver_name))
      {
        record.smoother    = multigrid_parameters.smoother;
        record.cycle       = multigrid_parameters.cycle;
        record.restriction = multigrid_parameters.restriction;
      }
    record.dim       = dim;
    record.cells     = n_cells;
    record.p         = space.degree();
    record.processes = Utilities::MPI::n_mpi_processes(comm);
    record.unknowns  = space.n_dofs();
    progress.show(record.variant() + ", " + std::to_string(n_cells) +
                  " cells, p = " + std::to_string(space.degree()));

    MassSolver<dim> solver(solver_name,
                           mass,
                           solver_parameters,
                           multigrid_parameters,
                           smoother_parameters);
    VectorType      x, b;
    space.initialize_vector(x);
    space.initialize_vector(b);

    const bool has_peak =
      Utilities::MPI::min(int(reset_peak_memory()), comm) == 1;
    std::vector<double> assembly, setup, solve;
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
          const auto &cross = mass.finest().mass().cross_mass();
          cross.integrate(b, acceleration);
          timed(setup, [&]() { solver.setup(); });
          timed(solve, [&]() { record.result = solver.solve(x, b); });

          const auto norms = cross.difference(x, acceleration);
          record.error =
            norms.second > 0 ? norms.first / norms.second : norms.first;
        }
      catch (const std::exception &error)
        {
          // A solver that cannot be set up says why and leaves the others
          // their turn. All processes throw what one throws.
          record.result           = SolveResult();
          record.result.reason    = message_of(error);
          record.result.reduction = 1.;
          record.error            = 1.;
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
    record.solve    = solve.empty() ? 0. : median(solve);
    mass.clear();
    return record;
  }



  void
  MassBenchmark::write_results() const
  {
    if (!out.is_active())
      return;
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
