// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// Shared by the tests of simulations: parameter files as text.

#include <greville/run/comparison.h>
#include <greville/steps/simulation.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <tests.h>

/// Parameters that are built from sections: add("Grid", "Order = 2").
class Text
{
public:
  Text() = default;

  /// Construct from the text of a whole file.
  explicit Text(const std::string &content)
    : content(content)
  {}

  Text &
  add(const std::string &section, const std::vector<std::string> &lines)
  {
    content += "subsection " + section + "\n";
    for (const std::string &line : lines)
      content += "  set " + line + "\n";
    content += "end\n";
    return *this;
  }

  /// Later lines win.
  Text
  with(const std::string &section, const std::vector<std::string> &lines) const
  {
    Text result = *this;
    return result.add(section, lines);
  }

  SimulationParameters
  parse(const std::string &file = "case.prm") const
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::ofstream(file) << content;
    MPI_Barrier(MPI_COMM_WORLD);
    SimulationParameters result(file);
    MPI_Barrier(MPI_COMM_WORLD);
    return result;
  }

  std::string content;
};



/// A simulation with its parameters.
template <int dim>
struct Simulated
{
  explicit Simulated(const Text &text, const MPI_Comm comm = MPI_COMM_WORLD)
    : parameters(text.parse())
    , simulation(parameters, comm)
  {}

  /// Construct with parameters that files cannot set.
  Simulated(const Text                                        &text,
            const std::function<void(SimulationParameters &)> &change)
    : parameters(changed(text.parse(), change))
    , simulation(parameters, MPI_COMM_WORLD)
  {}

  Simulated &
  run()
  {
    while (!simulation.is_finished())
      simulation.step();
    return *this;
  }

  Simulation<dim> *
  operator->()
  {
    return &simulation;
  }

  Errors
  displacement_error()
  {
    return *exact_errors().displacement;
  }

  Errors
  stress_error()
  {
    return *exact_errors().stress;
  }

  ExactErrors
  exact_errors()
  {
    const double t = simulation.state().time;
    return ExactSolution<dim>(parameters.exact)
      .errors(simulation.bodies(), t, t, MPI_COMM_WORLD);
  }

  static SimulationParameters
  changed(SimulationParameters                               parameters,
          const std::function<void(SimulationParameters &)> &change)
  {
    change(parameters);
    return parameters;
  }

  SimulationParameters parameters;
  Simulation<dim>      simulation;
};



/// Return whether a 2D simulation is refused with a message that contains
/// @p wanted.
inline void
check_refused(const std::string &name,
              const Text        &text,
              const std::string &wanted)
{
  std::string message;
  try
    {
      Simulated<2> simulated(text);
    }
  catch (const std::exception &error)
    {
      message = message_of(error);
    }
  // All processes must have read the file before it is rewritten.
  MPI_Barrier(MPI_COMM_WORLD);
  check(name, message.find(wanted) != std::string::npos);
  if (message.find(wanted) == std::string::npos)
    print() << "<" << message << ">" << std::endl;
}



/// The same with a mass, and with a smooth floor unless the mass is lumped:
/// friction walls need lumped mass.
inline Text
with_mass(const Text &text, const std::string &mass)
{
  const Text result = text.with("Scheme", {"Mass = " + mass});
  return mass == "lumped" ? result
                          : result.with("Walls",
                                        {"Bottom = sliding",
                                         "Bottom friction = 0",
                                         "Right = sliding"});
}



/// A body of the unit density in a grid, at rest and without loads.
inline Text
block_2d(const std::string &shape, const unsigned int n = 8)
{
  return Text()
    .add("Simulation", {"Bodies = body", "Materials = solid"})
    .add("Scheme", {"Mass = lumped"})
    .add("Grid", {"Cells = " + std::to_string(n) + ", " + std::to_string(n)})
    .add("Body body", {"Material = solid", "Shape = " + shape})
    .add("Material solid",
         {"Model = linear-elastic",
          "Density = 1",
          "Young modulus = 100",
          "Poisson ratio = 0.3"});
}

inline Text
block_3d(const std::string &shape, const unsigned int n = 4)
{
  const std::string N = std::to_string(n);
  return block_2d(shape)
    .with("Simulation", {"Dimension = 3"})
    .with("Grid",
          {"Lower corner = 0, 0, 0",
           "Upper corner = 1, 1, 1",
           "Cells = " + N + ", " + N + ", " + N});
}
