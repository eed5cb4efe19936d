// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/benchmark/report.h>

#include <iomanip>
#include <iostream>
#include <set>
#include <sstream>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  std::string
  SolveRecord::variant() const
  {
    std::string text = std::to_string(dim) + "D, ";
    if (operator_name != "mass")
      text += operator_name + ", ";
    if (poissons_ratio)
      text += "nu = " + text_of(*poissons_ratio) + ", ";
    if (courant_number)
      text += "C = " + text_of(*courant_number) + ", ";
    if (!body.empty())
      text += body + " of " + std::to_string(points_per_direction) + "^" +
              std::to_string(dim) + " points per cell, ";
    text += solver;
    for (const std::string &part :
         {cycle,
          smoother,
          restriction,
          names_prolongation ? prolongation : std::string(),
          names_coarsening && !coarsening.empty() ? "coarsening " + coarsening
                                                  : std::string()})
      if (!part.empty())
        text += ", " + part;
    return text;
  }



  PublishedTable
  read_published_table(const std::string &file, const std::string &parameter)
  {
    PublishedTable            table;
    std::vector<unsigned int> orders;
    read_csv(file, parameter, [&](const CsvLine &line) {
      try
        {
          if (line.is_header)
            {
              AssertThrow(line.words.size() > 1, ExcInternalError());
              for (unsigned int k = 1; k < line.words.size(); ++k)
                orders.push_back(
                  Utilities::string_to_int(line.words[k].substr(1)));
              return;
            }
          AssertThrow(line.words.size() == orders.size() + 1,
                      ExcInternalError());
          const int cells = Utilities::string_to_int(line.words[0]);
          for (unsigned int k = 0; k < orders.size(); ++k)
            table[{cells, orders[k]}] =
              Utilities::string_to_int(line.words[k + 1]);
        }
      catch (const std::exception &)
        {
          Require(
            false,
            line.where +
              "neither 'elements,p1,p2,...' nor integers for these columns: <" +
              line.text + ">.");
        }
    });
    return table;
  }



  std::string
  solves_csv(const std::vector<SolveRecord> &records)
  {
    std::ostringstream out;
    out << "solver,smoother,cycle,restriction,dim,cells,p,processes,unknowns,"
           "iterations,converged,reduction,error,assembly_s,setup_s,solve_s,"
           "peak_bytes,prolongation,coarsening,body,points_per_direction,"
           "stable,extended,lumped,operator,poisson,courant,unknowns_per_s,"
           "operator_bytes,preconditioner_bytes\n"
        << std::setprecision(6);
    const auto optional = [&](const auto &value) {
      out << ',';
      if (value)
        out << *value;
    };
    for (const SolveRecord &r : records)
      {
        out << r.solver << ',' << r.smoother << ',' << r.cycle << ','
            << r.restriction << ',' << r.dim << ',' << r.cells << ',' << r.p
            << ',' << r.processes << ',' << r.unknowns;
        optional(r.result.iterations);
        out << ',' << r.result.converged << ',' << r.result.reduction;
        optional(r.error);
        out << ',' << r.assembly << ',' << r.setup << ',' << r.solve;
        optional(r.peak_bytes);
        out << ',' << r.prolongation << ',' << r.coarsening << ',' << r.body
            << ',';
        if (r.points_per_direction > 0)
          out << r.points_per_direction;
        for (const unsigned long n : {r.stable, r.extended, r.lumped})
          out << ',' << (r.stable > 0 ? std::to_string(n) : "");
        out << ',' << r.operator_name;
        optional(r.poissons_ratio);
        optional(r.courant_number);
        out << ',';
        if (r.result.converged && r.setup + r.solve > 0.)
          out << r.unknowns / (r.setup + r.solve);
        optional(r.operator_bytes);
        optional(r.preconditioner_bytes);
        out << '\n';
      }
    return out.str();
  }



  std::string
  operators_csv(const std::vector<OperatorRecord> &records,
                const double                       bandwidth)
  {
    std::ostringstream out;
    out << "dim,cells,p,processes,unknowns,matrix_free_dofs_per_s,"
           "assembled_dofs_per_s,tensor_product_dofs_per_s,"
           "tensor_product_bytes_sent,matrix_bytes,bandwidth_bytes_per_s\n"
        << std::setprecision(6);
    for (const OperatorRecord &r : records)
      out << r.dim << ',' << r.cells << ',' << r.p << ',' << r.processes << ','
          << r.unknowns << ',' << r.matrix_free << ',' << r.assembled << ','
          << r.tensor_product << ',' << r.bytes_sent << ',' << r.matrix_bytes
          << ',' << bandwidth << '\n';
    return out.str();
  }



  namespace
  {
    /// Return the records by variant, in the order of first occurrence.
    std::vector<std::pair<std::string, std::vector<const SolveRecord *>>>
    by_variant(const std::vector<SolveRecord> &records)
    {
      std::vector<std::pair<std::string, std::vector<const SolveRecord *>>>
        groups;
      for (const SolveRecord &record : records)
        {
          const std::string variant = record.variant();
          auto              group   = groups.begin();
          while (group != groups.end() && group->first != variant)
            ++group;
          if (group == groups.end())
            group = groups.insert(group, {variant, {}});
          group->second.push_back(&record);
        }
      return groups;
    }



    /// Print rows of cells and columns of orders, with @p text for each record.
    template <typename Text>
    void
    print_table(std::ostream                           &out,
                const std::vector<const SolveRecord *> &records,
                const unsigned int                      width,
                const Text                             &text)
    {
      std::set<unsigned int> orders, cells;
      for (const SolveRecord *record : records)
        {
          orders.insert(record->p);
          cells.insert(record->cells);
        }
      out << "     cells";
      for (const unsigned int p : orders)
        out << std::setw(width) << "p = " + std::to_string(p);
      out << '\n';
      for (const unsigned int n : cells)
        {
          out << std::setw(10) << n;
          for (const unsigned int p : orders)
            {
              std::string entry;
              for (const SolveRecord *record : records)
                if (record->p == p && record->cells == n)
                  entry = text(*record);
              out << std::setw(width) << entry;
            }
          out << '\n';
        }
    }



    std::string
    iterations_of(const SolveRecord &record)
    {
      const std::string count = record.result.iterations
                                  ? std::to_string(*record.result.iterations)
                                  : "-";
      return record.result.converged ? count : count + "!";
    }



    std::string
    seconds(const double time)
    {
      std::ostringstream text;
      text << std::scientific << std::setprecision(2) << time;
      return text.str();
    }
  } // namespace



  void
  print_iterations(std::ostream &out, const std::vector<SolveRecord> &records)
  {
    for (const auto &group : by_variant(records))
      {
        out << "\nIterations: " << group.first << '\n';
        print_table(out, group.second, 8, iterations_of);
        for (const SolveRecord *record : group.second)
          if (!record->result.converged)
            out << "  ! " << record->cells << " cells, p = " << record->p
                << ": " << record->result.reason << '\n';
      }
  }



  void
  print_times(std::ostream &out, const std::vector<SolveRecord> &records)
  {
    for (const auto &group : by_variant(records))
      {
        out << "\nTimes in seconds: " << group.first << '\n'
            << "     cells  p    unknowns   assembly      setup      solve"
               "        sum  ns/unknown\n";
        for (const SolveRecord *r : group.second)
          {
            const double sum = r->assembly + r->setup + r->solve;
            out << std::setw(10) << r->cells << std::setw(3) << r->p
                << std::setw(12) << r->unknowns << std::setw(11)
                << seconds(r->assembly) << std::setw(11) << seconds(r->setup)
                << std::setw(11) << seconds(r->solve) << std::setw(11)
                << seconds(sum) << std::setw(12) << std::fixed
                << std::setprecision(0) << 1e9 * sum / r->unknowns
                << std::defaultfloat << '\n';
          }
      }
  }



  void
  print_operators(std::ostream                      &out,
                  const std::vector<OperatorRecord> &records,
                  const double                       bandwidth)
  {
    out << std::fixed << std::setprecision(4)
        << "\nOperators in 10^9 unknowns per second; memory bandwidth (triad) "
        << std::setprecision(1) << bandwidth * 1e-9
        << " GB/s\n"
           "   dim  cells  p    unknowns  matrix-free  assembled  "
           "tensor-product inverse  bytes sent\n";
    for (const OperatorRecord &r : records)
      out << std::setw(5) << r.dim << "D" << std::setw(7) << r.cells
          << std::setw(3) << r.p << std::setw(12) << r.unknowns
          << std::setprecision(4) << std::setw(13) << r.matrix_free * 1e-9
          << std::setw(11) << r.assembled * 1e-9 << std::setw(24)
          << r.tensor_product * 1e-9 << std::setw(12) << r.bytes_sent << '\n';
    out << std::defaultfloat;
  }



  std::string
  compare_with_published(std::ostream                   &out,
                         const std::vector<SolveRecord> &records,
                         const std::string              &solver,
                         const PublishedTable           &published)
  {
    std::ostringstream       csv;
    std::vector<SolveRecord> chosen;
    for (const SolveRecord &record : records)
      if (record.solver == solver && record.dim == records.front().dim &&
          published.count({record.cells, record.p}) > 0)
        chosen.push_back(record);

    for (const auto &group : by_variant(chosen))
      {
        unsigned int n_more = 0;
        out << "\nMeasured beside (published) iterations: " << group.first
            << "\n  - fewer, + more than published\n";
        print_table(out, group.second, 13, [&](const SolveRecord &record) {
          const int reference = published.at({record.cells, record.p});
          const int measured =
            record.result.iterations ? int(*record.result.iterations) : -1;
          const bool is_more = !record.result.converged || measured > reference;
          n_more += is_more;
          csv << record.variant() << ',' << record.cells << ',' << record.p
              << ',' << measured << ',' << reference << ','
              << measured - reference << '\n';
          return iterations_of(record) + " (" + std::to_string(reference) +
                 ") " + (is_more ? "+" : (measured < reference ? "-" : " "));
        });
        out << "  entries with more iterations than published: " << n_more
            << " of " << group.second.size() << '\n';
      }
    return csv.str();
  }



  void
  ProgressLine::start(const unsigned int n_solves, const bool is_wanted)
  {
    n          = n_solves;
    done       = 0;
    is_visible = is_wanted && isatty(STDOUT_FILENO) == 1;
    timer.restart();
  }



  void
  ProgressLine::show(const std::string &what)
  {
    ++done;
    if (!is_visible)
      return;
    const double elapsed = timer.wall_time();
    std::cout << "\r\033[K[" << done << "/" << n << "] " << what;
    if (done > 1)
      std::cout << ", about "
                << std::ceil(elapsed / (done - 1) * (n - done + 1))
                << " s left";
    std::cout << std::flush;
  }
} // namespace greville
