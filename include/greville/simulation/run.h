// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_run_h
#define greville_simulation_run_h

#include <greville/base/csv.h>
#include <greville/simulation/comparison.h>
#include <greville/simulation/output.h>
#include <greville/simulation/simulation.h>

#include <chrono>

namespace greville
{
  /**
   * What a run found.
   */
  struct RunSummary
  {
    double                  wall_time = 0.; // s
    double                  front     = 0.; // the largest, m
    ExactErrors             errors;
    std::optional<Distance> surface, series;
  };



  /**
   * Runs a Simulation to its end, and shows and writes what a parameter file
   * asks for:
   * - statistics.csv, probes.csv, points.pvd and grid.pvd with their files,
   *   summary.json;
   * - header, progress and summary on the first process's @p out.
   */
  template <int dim>
  class SimulationRun
  {
  public:
    /**
     * Collective. @p directory has to exist.
     */
    SimulationRun(const SimulationParameters &parameters,
                  const std::string          &directory,
                  std::ostream               &out,
                  const MPI_Comm              comm);

    /**
     * Collective. Throws what Simulation::step() throws, after the last good
     * state has been written.
     */
    RunSummary
    run();

  private:
    void
    print_header();

    /**
     * How the stage at hand goes on, and its solvers.
     */
    void
    print_stage();

    void
    print_progress(const bool is_last);

    void
    print_summary(const RunSummary &summary);

    void
    write_statistics();

    void
    write_fields();

    /**
     * What is due after a step.
     */
    void
    write_due(const bool is_last);

    /**
     * summary.json.
     */
    void
    write_summary(const RunSummary &summary);

    /**
     * Collective. Bytes of memory per point.
     */
    double
    bytes_per_point() const;

    const SimulationParameters parameters;
    const std::string          directory;
    std::ostream              &out;
    MPI_Comm                   comm;
    bool                       is_first;
    Simulation<dim>            simulation;
    ExactSolution<dim>         exact;
    MeasuredData<dim>          measured;
    FieldOutput<dim>           fields;
    Probes<dim>                probes;
    CsvWriter                  statistics_file;
    // Walls and components of the forces that are written.
    std::vector<std::pair<unsigned int, unsigned int>> reactions;
    double        next_fields, next_statistics;
    double        largest_front = -1e300;
    std::uint64_t n_points      = 0;

    std::chrono::steady_clock::time_point begin, last_shown;
    double                                last_shown_time = 0.;
    unsigned int                          last_stage      = 0;
    bool                                  is_terminal;
  };



  /**
   * Collective. Run what a parameter file describes: one simulation, or a sweep
   * over meshes, orders, mass solvers and quadratures, which ends with a table
   * and convergence.csv. Throws dealii::ExcMessage where file or run go wrong.
   */
  void
  run_simulations(const std::string &file, const MPI_Comm comm);
} // namespace greville

#endif
