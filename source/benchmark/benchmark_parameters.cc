// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/benchmark/benchmark.h>

#include <cmath>
#include <filesystem>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  std::vector<BenchmarkParameters::Variants>
  BenchmarkParameters::variants()
  {
    return {{"Smoothers", smoother_names(), smoothers},
            {"Cycles", words_of(cycle_types), cycles},
            {"Restrictions", OrderTransfer<2>::restrictions(), restrictions},
            {"Prolongations", OrderTransfer<2>::prolongations(), prolongations},
            {"Coarsenings", words_of(greville::coarsenings), coarsenings}};
  }



  void
  BenchmarkParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Operators", operators, List(Anything(), 1))(
      "Operators to solve with: the mass, the Laplacian (laplace, on the box), "
      "the stiffness of a linear-elastic body (elasticity), and 4 / dt^2 times "
      "the mass plus the stiffness (mass and elasticity): " +
      operator_names() + ".");
    add_parameter(prm, "Poisson ratios", poissons_ratios, List(Double(), 1))(
      "Poisson's ratios of elasticity, greater than -1 and smaller than 0.5. "
      "Unit: none.");
    add_parameter(prm, "Courant numbers", courant_numbers, List(Double(), 1))(
      "Courant numbers dt sqrt((lambda + 2 G) / rho) / h of mass and "
      "elasticity, greater than 0, with the smallest side h of cells and the "
      "mean density. Unit: none.");
    add_parameter(prm, "Dimensions", dimensions, List(Integer(2, 3), 1))(
      "Dimensions to run, one after the other.");
    add_parameter(prm, "Orders", orders, List(Integer(1, 5), 1))(
      "Orders p of the splines, which are their degrees.");
    add_parameter(prm, "Cells", cells)(
      "Numbers of cells per direction (times 'Cell ratio'). Lists for several "
      "dimensions are separated by ';'. Unit: cells.");
    add_parameter(prm, "Solvers", solvers)(
      "Solvers of the mass: " + MassSolver<2>::names() +
      "; of the other operators: " + solvers_beside_mass() + ".");
    for (const Variants &list : variants())
      add_parameter(prm, list.name, list.values)(
        list.name + " to run each p-multigrid solver with: " + list.allowed +
        ". Empty: the one of p-multigrid.");
    add_parameter(prm, "Published iterations", published)(
      "Tables to compare with in the first of the dimensions: solver:FILE, "
      "relative to the parameter file; lines of FILE are cells,iterations at "
      "p1,p2,...");
    add_parameter(prm, "Repetitions", repetitions, Integer(1, 1000))(
      "Each solve runs so many times; the median of each time is reported. "
      "Unit: solves.");
    add_parameter(prm, "Operator throughput", throughput)(
      "Measure unknowns per second of the matrix-free and the assembled "
      "operator and of the tensor-product inverse, and the memory bandwidth.");
    add_parameter(prm, "Print times", print_times)(
      "Print the machine, the progress line and the tables of times, which "
      "differ from run to run and from machine to machine.");
    add_parameter(prm, "Output directory", output_directory)(
      "Folder of results. Empty: output/NAME for NAME.prm.");
  }



  std::vector<std::vector<unsigned int>>
  Benchmark::cells_of_dimensions() const
  {
    auto lists = Utilities::split_string_list(parameters.cells, ';');
    if (lists.size() == 1)
      lists.resize(parameters.dimensions.size(), lists[0]);
    Require(lists.size() == parameters.dimensions.size(),
            "The parameter 'Benchmark/Cells' has to hold one list, or one for "
            "each of the dimensions, separated by ';', but is <" +
              parameters.cells + ">.");
    std::vector<std::vector<unsigned int>> result;
    for (const std::string &list : lists)
      {
        result.emplace_back();
        for (const std::string &word : Utilities::split_string_list(list, ','))
          {
            Require(!word.empty() && word.size() < 8 &&
                      word.find_first_not_of("0123456789") ==
                        std::string::npos &&
                      std::stoul(word) > 0,
                    "The parameter 'Benchmark/Cells' has to hold whole numbers "
                    "of 1 or more, but has <" +
                      word + ">.");
            result.back().push_back(std::stoul(word));
          }
        Require(!result.back().empty(),
                "The parameter 'Benchmark/Cells' holds no number.");
      }
    return result;
  }



  void
  Benchmark::check_parameters(const std::string &directory)
  {
    Require(!parameters.solvers.empty(),
            "The parameter 'Benchmark/Solvers' is empty. It takes some of " +
              MassSolver<2>::names() + ".");
    for (const std::string &name : parameters.operators)
      {
        check_word(name, "Benchmark/Operators", operator_names());
        for (const std::string &solver : parameters.solvers)
          check_solver(solver, name, "Benchmark/Solvers");
        Require(name != "laplace" || problem_parameters.bodies.empty(),
                "The operator <laplace> of the parameter 'Benchmark/Operators' "
                "is for the box: 'Problem/Points' has to be empty, but is <" +
                  problem_parameters.bodies[0] + ">.");
      }
    for (const double nu : parameters.poissons_ratios)
      Require(nu > -1. && nu < 0.5,
              "The parameter 'Benchmark/Poisson ratios' has <" + text_of(nu) +
                ">; it has to be greater than -1 and smaller than 0.5.");
    for (const double C : parameters.courant_numbers)
      Require(C > 0. && std::isfinite(C),
              "The parameter 'Benchmark/Courant numbers' has <" + text_of(C) +
                ">; it has to be greater than 0.");
    check_different(parameters.operators, "Benchmark/Operators");
    check_different(parameters.poissons_ratios, "Benchmark/Poisson ratios");
    check_different(parameters.courant_numbers, "Benchmark/Courant numbers");
    check_different(parameters.solvers, "Benchmark/Solvers");
    check_different(parameters.dimensions, "Benchmark/Dimensions");
    check_different(parameters.orders, "Benchmark/Orders");
    for (const auto &list : cells_of_dimensions())
      check_different(list, "Benchmark/Cells");
    smoother_parameters.check();
    implicit.smoother.check();
    for (const auto &list : parameters.variants())
      {
        for (const std::string &name : list.values)
          check_word(name, "Benchmark/" + list.name, list.allowed);
        check_different(list.values, "Benchmark/" + list.name);
      }
    for (const unsigned int dim : parameters.dimensions)
      problem_parameters.check(dim);
    for (const std::string &entry : parameters.published)
      {
        const std::size_t colon = entry.find(':');
        Require(colon != std::string::npos,
                "The value <" + entry +
                  "> of the parameter 'Benchmark/Published iterations' does "
                  "not have the form solver:FILE.");
        const auto table = std::filesystem::path(directory) /
                           Utilities::trim(entry.substr(colon + 1));
        published.emplace_back(
          Utilities::trim(entry.substr(0, colon)),
          read_published_table(table.string(),
                               "Benchmark/Published iterations"));
      }
    for (const unsigned int dim : parameters.dimensions)
      for (const auto &expression :
           {std::make_pair(problem_parameters.density, "Problem/Density"),
            std::make_pair(problem_parameters.acceleration,
                           "Problem/Acceleration")})
        if (dim == 2)
          make_function<2>(expression.first, expression.second);
        else
          make_function<3>(expression.first, expression.second);
  }
} // namespace greville
