// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_run_h
#define greville_simulation_run_h

#include <greville/simulation/comparison.h>
#include <greville/simulation/output.h>
#include <greville/simulation/simulation.h>

#include <chrono>
#include <fstream>

namespace greville
{
  /**
   * What a run was: the content of summary.json.
   */
  struct RunSummary
  {
    std::uint64_t                 n_points        = 0;
    std::uint64_t                 n_removed       = 0;
    std::uint64_t                 n_sent          = 0;
    unsigned int                  n_steps         = 0;
    double                        time            = 0.;
    double                        wall_time       = 0.;
    double                        critical        = 0.;
    double                        bytes_per_point = 0.;
    std::map<std::string, double> part_times;
    std::optional<Errors>         displacement, velocity, stress;
    std::optional<Distance>       surface, series;
    double                        front = 0.;

    double
    point_steps_per_second() const
    {
      return wall_time > 0. ? double(n_points) * n_steps / wall_time : 0.;
    }
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

    void
    print_progress(const bool is_last);

    void
    print_summary(const RunSummary &summary);

    void
    write_fields();

    void
    write_statistics();

    /**
     * What is due after a step.
     */
    void
    write_due(const bool is_last);

    void
    write_summary(const RunSummary &summary);

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
    std::ofstream              statistics_file;
    double                     next_fields = 0., next_statistics = 0.;
    double                     largest_front = -1e300;

    std::chrono::steady_clock::time_point begin, last_shown;
    double                                last_shown_time = 0.;
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
