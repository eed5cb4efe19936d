// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/conditional_ostream.h>

#include <greville/benchmark/benchmark_problem.h>
#include <greville/benchmark/report.h>
#include <greville/paper/paper_parts.h>
#include <greville/stiffness/tangent_system.h>

#include <string>

namespace greville
{
  struct BenchmarkParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// A list of variants of p-multigrid solvers, and the allowed values,
    /// separated by '|'.
    struct Variants
    {
      std::string               name;
      std::string               allowed;
      std::vector<std::string> &values;
    };

    std::vector<Variants>
    variants();

    std::vector<std::string>  operators       = {"mass"};
    std::vector<double>       poissons_ratios = {0.3};
    std::vector<double>       courant_numbers = {10.};
    std::vector<unsigned int> dimensions      = {2};
    std::vector<unsigned int> orders          = {1, 2, 3};
    std::string               cells           = "16, 32";
    std::vector<std::string>  solvers         = {"p-multigrid"};
    std::vector<std::string>  smoothers;
    std::vector<std::string>  cycles;
    std::vector<std::string>  restrictions;
    std::vector<std::string>  prolongations;
    std::vector<std::string>  coarsenings;
    std::vector<std::string>  published;
    unsigned int              repetitions = 1;
    bool                      throughput  = false;
    bool                      print_times = true;
    std::string               output_directory;
  };

  /// Solves linear systems A x = b on B-splines for sweeps over operators (see
  /// operator_names()), dimensions, orders, meshes, bodies and solvers, and
  /// reports iterations and times. For the mass operator, the system is M a =
  /// F, F_i = int rho f N_i dx or sum_p m_p f(x_p) N_i(x_p): its exact solution
  /// is the projection of the acceleration f onto the splines in the mass norm.
  class Benchmark
  {
  public:
    /// @p program is the name of the program in messages. Calls
    /// add_paper_parts().
    Benchmark(const std::string &program = "greville_benchmark");

    void
    declare(dealii::ParameterHandler &prm);

    /// Collective. Read @p file with the replacements in @p settings (see
    /// read_parameter_lines()), run, and write all used parameters, solves.csv
    /// and, if requested, comparison.csv and operators.csv to the output
    /// directory. Throws if the file is wrong.
    void
    run(const std::string &file, const std::vector<std::string> &settings = {});

    /// Read and check a file as run() does, and return the text of a file with
    /// all parameters, their values and meanings.
    std::string
    read(const std::string                          &file,
         const std::vector<std::string>             &settings,
         const dealii::ParameterHandler::OutputStyle style);

  private:
    template <int dim>
    void
    run_dimension(const std::vector<unsigned int> &cells);

    template <int dim>
    void
    run_operator(DistributedTriangulation<dim> &triangulation,
                 SolveRecord                    record);

    template <int dim>
    void
    run_problem(BenchmarkProblem<dim> &problem, const SolveRecord &record);

    /// Run all variants of a solver. @p record describes the system.
    template <int dim>
    void
    run_solver(BenchmarkProblem<dim> &problem, const SolveRecord &record);

    template <int dim>
    SolveRecord
    solve(BenchmarkProblem<dim> &problem, SolveRecord record);

    /// Return the p-multigrid parameters of an operator, before any sweep.
    PMultigridParameters &
    multigrid_of(const std::string &operator_name)
    {
      return is_elastic(operator_name) ? implicit.multigrid
                                       : multigrid_parameters;
    }

    /// Check what the parameter patterns cannot check, and read the published
    /// tables, whose names are relative to @p directory.
    void
    check_parameters(const std::string &directory);

    std::vector<std::vector<unsigned int>>
    cells_of_dimensions() const;

    void
    print_header(const std::string &file) const;

    void
    write_results() const;

    BenchmarkParameters        parameters;
    ProblemParameters          problem_parameters;
    MassSolverParameters       solver_parameters;
    PaperMultigridParameters   multigrid_parameters;
    PaperSmootherParameters    smoother_parameters;
    TangentParameters          implicit; // of elasticity
    const std::string          program;
    dealii::ConditionalOStream out;
    std::string                output_directory;

    std::vector<std::pair<std::string, PublishedTable>> published;
    std::vector<SolveRecord>                            records;
    std::vector<OperatorRecord>                         operator_records;
    double                                              bandwidth = 0.;
    ProgressLine                                        progress;
  };
} // namespace greville
