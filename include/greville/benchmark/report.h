// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/timer.h>

#include <greville/benchmark/operators.h>
#include <greville/paper/mass_solver.h>

#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /// One solve: a row of solves.csv. Times in seconds of wall clock (the
  /// slowest process), memory in bytes (all processes).
  struct SolveRecord
  {
    /// See operator_names().
    std::string   operator_name = "mass";
    std::string   solver, smoother, cycle, restriction;
    std::string   prolongation, coarsening;
    unsigned int  dim = 0, cells = 0, p = 0, processes = 0;
    unsigned long unknowns = 0;
    SolveResult   result;
    /// Error of the solution; empty if it is unknown.
    std::optional<double> error;
    /// True if the solver did not converge or could not be set up.
    bool                         has_failed = false;
    double                       assembly = 0., setup = 0., solve = 0.;
    std::optional<unsigned long> peak_bytes;
    /// Bytes allocated by assembly and set-up.
    std::optional<unsigned long> operator_bytes, preconditioner_bytes;
    /// Parameters of elasticity, without and with mass.
    std::optional<double> poissons_ratio, courant_number;

    /// Body of material points; empty without points.
    std::string  body;
    unsigned int points_per_direction = 0;
    /// Number of functions per class, for extended B-splines.
    unsigned long stable = 0, extended = 0, lumped = 0;

    /// True if prolongation or coarsening is part of the variant's name.
    bool names_prolongation = false, names_coarsening = false;

    /// Return the solver with its variant, the key of a table.
    std::string
    variant() const;
  };

  /// Published iterations of a solver, by (cells, p).
  using PublishedTable =
    std::map<std::pair<unsigned int, unsigned int>, unsigned int>;

  /// Read a file with lines "elements,p1,p2,..." and "cells,iterations,...";
  /// lines with # are comments. Throws with the name of the @p parameter and
  /// the line if the file cannot be read.
  PublishedTable
  read_published_table(const std::string &file, const std::string &parameter);

  std::string
  solves_csv(const std::vector<SolveRecord> &records);

  std::string
  operators_csv(const std::vector<OperatorRecord> &records,
                const double                       bandwidth);

  /// Print tables of iterations (rows: cells, columns: p) and of times for each
  /// variant. Failed solves are marked and explained.
  void
  print_iterations(std::ostream &out, const std::vector<SolveRecord> &records);

  void
  print_times(std::ostream &out, const std::vector<SolveRecord> &records);

  void
  print_operators(std::ostream                      &out,
                  const std::vector<OperatorRecord> &records,
                  const double                       bandwidth);

  /// Compare measured and published iterations of @p solver in the dimension of
  /// the first record. Prints text to @p out, and returns the lines of
  /// comparison.csv.
  std::string
  compare_with_published(std::ostream                   &out,
                         const std::vector<SolveRecord> &records,
                         const std::string              &solver,
                         const PublishedTable           &published);

  /// A line that is rewritten on a terminal: the current system, the number of
  /// solves done and in total, and the remaining time. Prints nothing if the
  /// output is no terminal.
  class ProgressLine
  {
  public:
    void
    start(const unsigned int n_solves, const bool is_wanted);

    void
    show(const std::string &what);

    void
    finish()
    {
      if (is_visible)
        std::cout << "\r\033[K" << std::flush;
    }

  private:
    unsigned int  n = 0, done = 0;
    bool          is_visible = false;
    dealii::Timer timer;
  };
} // namespace greville
