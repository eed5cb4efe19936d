// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/run/checkpoint.h>
#include <greville/run/end_of_run.h>
#include <greville/run/output.h>
#include <greville/run/probes.h>
#include <greville/run/run_notes.h>
#include <greville/run/run_options.h>
#include <greville/steps/coupled_simulations.h>

#include <chrono>

namespace greville
{
  /**
   * Runs CoupledSimulations to the end, and writes the output of a parameter
   * file:
   * - statistics.csv, probes.csv and summary.json; fields.pvd with its files,
   *   see FieldOutput; and the files of RunNotes;
   * - checkpoints, from which a run resumes as if it had not been interrupted;
   * - header, progress and summary on the first process's @p out.
   */
  template <int dim>
  class SimulationRun
  {
  public:
    /// Collective. @p directory must exist. Throws dealii::ExcMessage if
    /// parameters or the checkpoint to begin with are wrong.
    SimulationRun(const SimulationParameters &parameters,
                  const std::string          &directory,
                  std::ostream               &out,
                  const MPI_Comm              comm,
                  const RunOptions           &options = RunOptions());

    /// Collective. Run to the end. Rethrows errors of Simulation::step(), after
    /// the last good state has been written if the simulation has gone back to
    /// it. Throws dealii::ExcMessage after a signal, with a checkpoint and all
    /// results written.
    RunSummary
    run();

    static std::vector<std::string>
    columns_of(const SimulationParameters &parameters);

    static std::vector<std::string>
    columns_of(const SimulationParameters &parameters,
               const Probes<dim>          &probes);

  private:
    /// Perform run() without noting errors.
    RunSummary
    run_to_end();

    /// Take a step. If it fails in a ramp, go back and halve the bracket.
    /// Returns whether there is a new state to write.
    bool
    take_step();

    /// Return whether the current stage is a ramp whose steps can be repeated.
    bool
    is_in_ramp() const
    {
      return simulations.first().is_implicit() &&
             end_of_run.is_ramp(common().stage);
    }

    /// Return whether the current state ends the run.
    bool
    holds_now()
    {
      return simulations.exceeds_displacement() ||
             criterion_holds(common().stage, row_now());
    }

    /// Return whether 'End when' holds for a row, and note a comparison with
    /// NaN.
    bool
    criterion_holds(const unsigned int stage, const std::vector<double> &row);

    /// Return the values of the columns of statistics.csv and probes.csv.
    std::vector<double>
    row_now();

    /// End the run with the last equilibrium at this time, and write the states
    /// before and after failure to the folder 'failure'.
    void
    end_ramp(const double last_time);

    void
    begin_run(const RunOptions &options);

    void
    resume(const Checkpoint &checkpoint);

    /// The contents of the files when the simulation keeps a state.
    struct Mark
    {
      unsigned int  n_steps             = 0;
      std::uint64_t bytes_of_statistics = 0, bytes_of_probes = 0;
      Largest       runout, runout_99;
      bool          row_is_due = false, fields_are_due = false;
      std::string   fields;
      std::vector<ContactInterval<dim>> intervals;
    };

    Mark
    make_mark() const;

    /// Write a checkpoint of the current state, from which the files continue
    /// at a @p mark. Returns the content of the checkpoint.
    TablesFile
    write_checkpoint(const Mark &mark);

    /// Write a checkpoint, and continue exactly as a run that resumes from it.
    void
    write_checkpoint();

    /// Collective. After a failed step, write the state to which the simulation
    /// has gone back. Returns a sentence on it for the message.
    std::string
    write_last_good_state();

    /// Write a checkpoint if one is due or a signal requests it. Throws
    /// dealii::ExcMessage if the signal ends the run.
    void
    look_for_checkpoint(const bool is_last);

    void
    print_progress(const bool is_last);

    /// Print the iterations and the functions of the exact mass.
    void
    print_systems();

    void
    print_times(const double wall_time);

    void
    print_summary(const RunSummary &summary);

    /// The values of a row besides the statistics at its time.
    struct Row
    {
      unsigned int        n_steps = 0;
      double              time    = 0.;
      std::vector<double> more;
      unsigned int        stage = 0;
      /// Contact intervals up to the row.
      std::vector<ContactInterval<dim>> intervals;
    };

    Row
    begin_row();

    std::vector<double>
    values_of(const Row &row, const Statistics<dim> &statistics) const;

    void
    write_row(const Row &row, const Statistics<dim> &statistics);

    /// Request the row, or the fields, at this time from the next step.
    void
    ask_for_late(const bool for_row, const bool for_fields);

    /// Write the requested row and fields that the last step has completed.
    void
    write_late();

    /// Write the row, or the fields, of the current state.
    void
    write_statistics();

    void
    write_fields();

    /// Keep the files of a part in memory.
    void
    hold_fields(const unsigned int part);

    /// Return whether 'Output/Fields' names a field.
    bool
    wants(const std::string &field) const
    {
      return contains(parameters.output.fields, field);
    }

    GridFields<dim>
    grid_fields(Simulation<dim> &part) const;

    /// Write the files that are due after a step.
    void
    write_due(const bool is_last);

    /// Return a time slightly after the time of the state, against round-off.
    double
    rounded_up_time() const;

    /// Return the first multiple of @p every, from the start of the run, after
    /// @p t.
    double
    next_time(const double every, const double t) const;

    double
    next_time_of_fields(const double t) const;

    RunSummary
    summarize();

    void
    write_summary(const RunSummary &summary);

    double
    bytes_per_point() const
    {
      return dealii::Utilities::MPI::sum(double(simulations.points_memory()),
                                         comm) /
             n_points;
    }

    double
    iterations_per_step()
    {
      return double(simulations.sum(&State<dim>::n_all_iterations)) /
             std::max(1u, common().n_steps);
    }

    /// Return a state. Its time, steps and stage are common to all parts.
    const State<dim> &
    common() const
    {
      return simulations.first().state();
    }

    const SimulationParameters parameters;
    const std::string          directory;
    std::ostream              &out;
    MPI_Comm                   comm;
    bool                       is_first;
    CoupledSimulations<dim>    simulations;
    ExactSolution<dim>         exact;
    FieldOutput<dim>           fields;
    Probes<dim>                probes;
    RunNotes                   notes;
    CsvWriter                  statistics_file;
    // Walls and components of the written forces.
    std::vector<std::pair<unsigned int, unsigned int>> reactions;
    std::vector<std::pair<unsigned int, std::string>>  outflows;
    EndOfRun                                           end_of_run;
    // Early end of the run.
    bool                          ends = false, has_noted_undefined = false;
    Ramp<std::vector<State<dim>>> ramp;
    std::optional<RampResult>     ramp_result;
    std::vector<double>           last_row;
    double                        next_fields = 0., next_statistics = 0.;
    // Row, and the step of fields, that the next step completes.
    std::optional<Row>          late_row;
    std::optional<unsigned int> late_fields;
    Largest                     largest_runout, largest_runout_99;
    std::uint64_t               n_points = 0;

    std::chrono::steady_clock::time_point begin, last_shown, last_checkpoint;
    double                                last_shown_time = 0.;
    unsigned int                          last_stage      = 0;
    // Steps of the last row and the last fields.
    unsigned int last_written_statistics = -1, last_written_fields = -1;
    // Contents of the files when a state was kept, at the last checkpoint, and
    // before the last row and fields, which a resumed run writes late.
    Mark                mark;
    std::optional<Mark> before_last;
    std::string         checkpoint_file;
    unsigned int        checkpoint_step = -1;
    bool                is_resumed      = false;
    unsigned int        first_step      = 0;
    double              first_time      = 0.;
    bool                is_terminal;
  };
} // namespace greville
