// SPDX-License-Identifier: LGPL-2.1-or-later

// Begins and resumes a SimulationRun, and writes its checkpoints.

#include <greville/base/signals.h>
#include <greville/run/begin_run.h>

#include <cmath>
#include <csignal>
#include <filesystem>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Names of the tables that a run adds to the state of its simulations.
    constexpr const char *run_name        = "run",
                         *intervals_name  = "contacts of the run",
                         *statistics_name = "/statistics.csv",
                         *probes_name     = "/probes.csv";

    const auto run_columns = Utilities::split_string_list(
      "bytes_of_statistics, bytes_of_probes, largest_front, largest_front_99, "
      "row_and_fields_due, ends, has_ramp_result, ramp_from, ramp_to, "
      "failed_at");



    template <int dim>
    DistributedTable
    table_of(const std::vector<ContactInterval<dim>> &intervals,
             const bool                               is_first)
    {
      DistributedTable table{intervals_name, {"time", "largest_force"}, {}};
      for (unsigned int d = 0; d < dim; ++d)
        table.columns.push_back(std::string("impulse_") + "xyz"[d]);
      for (unsigned int k = 0; is_first && k < intervals.size(); ++k)
        {
          table.values.insert(table.values.end(),
                              {intervals[k].time, intervals[k].largest_force});
          for (unsigned int d = 0; d < dim; ++d)
            table.values.push_back(intervals[k].impulse[d]);
        }
      return table;
    }



    template <int dim>
    std::vector<ContactInterval<dim>>
    intervals_of(const std::vector<double> &values)
    {
      std::vector<ContactInterval<dim>> intervals(values.size() / (2 + dim));
      const double                     *value = values.data();
      for (ContactInterval<dim> &interval : intervals)
        {
          interval.time          = *value++;
          interval.largest_force = *value++;
          for (unsigned int d = 0; d < dim; ++d)
            interval.impulse[d] = *value++;
        }
      return intervals;
    }



    /// Throw if a run with these parameters cannot resume from a checkpoint
    /// with other parameters.
    void
    check_changes(const TablesFile           &checkpoint,
                  const SimulationParameters &parameters)
    {
      const std::string changes =
        describe_changes(checkpoint.text("parameters"), parameters.used());
      Require(
        changes.empty(),
        "these parameters have changed: " + changes +
          ". A resumed run may only change 'Output', 'Checkpoints', 'Load "
          "balance', 'Time/End', 'Time/Maximum steps', 'Time/Largest "
          "displacement' and 'Time/End when'; with --from a new run begins "
          "from its end");
    }



    /// Throw if 'End' of a stage has changed that is finished at the
    /// checkpoint, or if the @p stage of the checkpoint would end before its @p
    /// time.
    void
    check_stages(const TablesFile           &checkpoint,
                 const SimulationParameters &parameters,
                 const unsigned int          stage,
                 const double                time)
    {
      std::map<std::string, double> ends;
      for (const ParameterLine &line :
           parameter_lines_of(checkpoint.text("parameters"), "parameters"))
        if (line.name == "End")
          ends[line.section] = Utilities::string_to_double(line.value);
      for (unsigned int k = 0; k < parameters.stages.size() && k <= stage; ++k)
        {
          const std::string section =
            "Stage " + parameters.stages[k].name + "/Time";
          const double end  = parameters.stages[k].time.end;
          const bool   fits = k < stage ? end == ends[section]
                                        : end >= time - 1e-12 * std::abs(time) ||
                                          k + 1 == parameters.stages.size();
          Require(fits,
                  "the parameter '" + section + "/End' is " + text_of(end) +
                    " s, but the run is at t = " + text_of(time) +
                    " s in stage " + std::to_string(stage + 1) + " (" +
                    parameters.stages[stage].name +
                    "): past stages keep their 'End', and other stages have to "
                    "end later");
        }
    }
  } // namespace



  template <int dim>
  void
  begin_with(CoupledSimulations<dim>    &simulations,
             const Checkpoint           &checkpoint,
             const SimulationParameters &parameters)
  {
    try
      {
        check_points_fit(checkpoint.content.text("parameters"),
                         parameters.used());
        simulations.begin_with(checkpoint.content);
      }
    catch (const std::exception &error)
      {
        Require(false,
                "This run cannot begin with <" + checkpoint.file +
                  ">: " + without_stop(message_of(error)) + ".");
      }
  }



  template <int dim>
  void
  resume_from(CoupledSimulations<dim>     &simulations,
              const Checkpoint            &checkpoint,
              const SimulationParameters  &parameters,
              const std::function<void()> &resume_files)
  {
    const TablesFile &content = checkpoint.content;
    try
      {
        check_changes(content, parameters);
        simulations.set_from_tables(content);
        const State<dim> &state = simulations.first().state();
        check_stages(content, parameters, state.stage, state.time);
        if (resume_files)
          resume_files();
      }
    catch (const std::exception &error)
      {
        Require(false,
                "The run cannot resume from <" + checkpoint.file +
                  ">: " + message_of(error));
      }
  }



  template <int dim>
  void
  SimulationRun<dim>::begin_run(const RunOptions &options)
  {
    if (options.resumes)
      {
        resume(read_checkpoint(directory, comm));
        if (options.prepare_folder)
          options.prepare_folder();
      }
    else
      {
        std::vector<std::string> warnings;
        if (!options.from.empty())
          {
            const Checkpoint other = read_checkpoint(options.from, comm);
            for (const auto &refused : other.refused)
              warnings.push_back(refused.second);
            begin_with(simulations, other, parameters);
          }
        probes = Probes<dim>(parameters.output.probes,
                             parameters.output.fields,
                             simulations.bodies_of_all_stages().list,
                             comm);
        // This may move the files of the other run.
        if (options.prepare_folder)
          options.prepare_folder();
        notes.begin();
        for (const std::string &warning : warnings)
          notes.note(warning, "Warning");
        statistics_file.open(directory + statistics_name,
                             columns_of(parameters),
                             14,
                             comm);
        probes.open(directory + probes_name);
        next_fields = next_statistics = common().time;
      }
    std::vector<std::string> fields;
    for (const OutputField<dim> &field :
         point_fields(parameters.output.fields, simulations.bodies(), 0))
      if (field.is_vector)
        fields.push_back(field.name);
      else
        fields.insert(fields.end(),
                      field.components.begin(),
                      field.components.end());
    std::map<std::string, std::string> history;
    for (const Body<dim> &body : simulations.bodies())
      for (const std::string &name : body.material->state_names())
        if (!body.material->state_unit(name).empty())
          history[name] = body.material->state_unit(name);
    notes.write_units(dim,
                      parameters.grid.is_axisymmetric(),
                      columns_of(parameters),
                      probes.columns(),
                      fields,
                      history);
    for (const Body<dim> &body : simulations.bodies())
      n_points += body.n_points;
    first_step = common().n_steps;
    first_time = common().time;
    last_stage = common().stage;
  }



  template <int dim>
  void
  SimulationRun<dim>::resume(const Checkpoint &checkpoint)
  {
    for (const auto &refused : checkpoint.refused)
      {
        notes.note(refused.second + " It is renamed to <" + refused.first +
                     ".refused>.",
                   "Warning");
        run_on_first(comm, [&]() {
          std::filesystem::rename(refused.first, refused.first + ".refused");
        });
      }
    const TablesFile &content = checkpoint.content;
    resume_from(simulations, checkpoint, parameters, [&]() {
      const auto numbers = content.table(run_name).gather(comm);
      Require(numbers.size() == run_columns.size(),
              "its table of the run has other columns");
      largest_runout    = numbers[2];
      largest_runout_99 = numbers[3];
      if (!parameters.contacts.empty())
        simulations.set_contact_intervals(
          intervals_of<dim>(content.table(intervals_name).gather(comm)));
      const auto warn_if_new = [&](const std::string &file,
                                   const bool         is_there) {
        if (!is_there)
          notes.note("There is no file <" + file +
                       ">, which the run has written before. A new file "
                       "begins with the next row, without the earlier rows.",
                     "Warning");
      };
      warn_if_new(directory + statistics_name,
                  statistics_file.resume(directory + statistics_name,
                                         columns_of(parameters),
                                         14,
                                         std::uint64_t(numbers[0]),
                                         comm));
      warn_if_new(directory + probes_name,
                  probes.resume(directory + probes_name,
                                std::uint64_t(numbers[1])));
      fields.resume(content.text("written"), comm);
      if (numbers[4] != 0.)
        ask_for_late(numbers[4] != 2., numbers[4] >= 2.);
      // An ended run continues if its criteria have changed.
      if (EndOfRun::criteria(content.text("parameters")) ==
          EndOfRun::criteria(parameters.used()))
        {
          ends = numbers[5] != 0.;
          if (numbers[6] != 0.)
            ramp_result = {numbers[7], numbers[8]};
          ramp.failed_at = numbers[9];
        }
    });
    is_resumed      = true;
    checkpoint_file = checkpoint.file;
    checkpoint_step = common().n_steps;
    notes.resume(common().n_steps);
    const double t = rounded_up_time();
    next_statistics =
      next_time(parameters.output.rows_every(parameters.end_of_run() -
                                             parameters.time.start),
                t);
    next_fields = next_time_of_fields(t);
    out << "Resuming from <" << checkpoint.file << ">, step "
        << common().n_steps << ", t = " << common().time << " s.\n\n";
  }



  template <int dim>
  typename SimulationRun<dim>::Mark
  SimulationRun<dim>::make_mark() const
  {
    return {common().n_steps,
            statistics_file.n_bytes(),
            probes.n_bytes(),
            largest_runout,
            largest_runout_99,
            late_row.has_value(),
            late_fields.has_value(),
            fields.record(),
            late_row ? late_row->intervals : simulations.contact_intervals()};
  }



  template <int dim>
  TablesFile
  SimulationRun<dim>::write_checkpoint(const Mark &at)
  {
    TablesFile content;
    content.texts = {{"parameters", parameters.used()}, {"written", at.fields}};
    content.tables = simulations.tables();

    DistributedTable run{run_name, run_columns, {}};
    statistics_file.sync();
    probes.sync();
    if (is_first)
      run.values = {double(at.bytes_of_statistics),
                    double(at.bytes_of_probes),
                    at.runout.value,
                    at.runout_99.value,
                    double(at.row_is_due + 2 * at.fields_are_due),
                    double(ends),
                    double(ramp_result.has_value()),
                    ramp_result.value_or(RampResult()).from,
                    ramp_result.value_or(RampResult()).to,
                    ramp.failed_at};
    content.tables.push_back(run);
    if (!parameters.contacts.empty())
      content.tables.push_back(table_of(at.intervals, is_first));
    checkpoint_file =
      greville::write_checkpoint(directory, common().n_steps, content, comm);
    checkpoint_step = common().n_steps;
    return content;
  }



  template <int dim>
  void
  SimulationRun<dim>::write_checkpoint()
  {
    // Assign `mark` only after the checkpoint has been written: if this throws,
    // the stored state and the mark still belong to the same step.
    Mark now = make_mark();
    if (before_last)
      {
        const std::string written =
          (before_last->fields_are_due ? *before_last : now).fields;
        if (before_last->row_is_due)
          now = *before_last;
        now.fields         = written;
        now.fields_are_due = before_last->fields_are_due;
      }
    simulations.set_from_tables(write_checkpoint(now));
    simulations.set_contact_intervals(now.intervals);
    if (late_row || late_fields)
      ask_for_late(late_row.has_value(), late_fields.has_value());
    mark            = now;
    last_checkpoint = std::chrono::steady_clock::now();
  }



  template <int dim>
  std::string
  SimulationRun<dim>::write_last_good_state()
  {
    const unsigned int step = common().n_steps;
    std::string        text, row;
    // A full disk must not hide the error of the step.
    try
      {
        // The grid fields belong to the failed step.
        std::string file   = fields.points_file(common().time);
        const bool  is_new = file.empty();
        // Rows of later steps may exist.
        const bool is_row_due = last_written_statistics < step;
        if (is_new || is_row_due)
          simulations.show_finished([&]() {
            if (is_new)
              {
                fields.write_points(common().time, simulations.bodies(), comm);
                file = fields.points_file(common().time);
              }
            text = "It is in <" + file + ">";
            if (is_row_due)
              write_statistics();
          });
        text = "It is in <" + file + ">";
        if (last_written_statistics == step)
          row = "the last row of <" + directory + statistics_name + ">";
        // The simulation keeps the state of each checkpoint.
        if (step > 0 && checkpoint_step != step && mark.n_steps == step)
          write_checkpoint(mark);
      }
    catch (const ErrorOnAll &error)
      {
        return text + (text.empty() ? "" : ". ") +
               "Not all of it has been written: " + message_of(error);
      }
    if (step == 0 || checkpoint_step != step)
      return text + (row.empty() ? "" : " and " + row) + ".";
    return text + (row.empty() ? "" : ", " + row) + " and <" + checkpoint_file +
           ">: --resume continues from there, and --from begins a new run "
           "with other parameters there.";
  }



  template <int dim>
  void
  SimulationRun<dim>::look_for_checkpoint(const bool is_last)
  {
    const CheckpointParameters &when = parameters.checkpoints;
    const int signal                 = is_last ? 0 : SignalCatcher::take(comm);
    bool      is_due                 = signal != 0;
    if (when.every_steps > 0 && common().n_steps % when.every_steps == 0)
      is_due = true;
    if (when.every_minutes > 0.)
      {
        const std::chrono::duration<double, std::ratio<60>> minutes =
          std::chrono::steady_clock::now() - last_checkpoint;
        const bool own = is_first && minutes.count() >= when.every_minutes;
        is_due = Utilities::MPI::max<unsigned int>(own, comm) == 1 || is_due;
      }
    if (is_last)
      is_due = when.every_steps > 0 || when.every_minutes > 0.;
    // The run continues if the disk is full for a while.
    std::string failure;
    if (is_due)
      try
        {
          write_checkpoint();
        }
      catch (const ErrorOnAll &error)
        {
          failure = without_stop(message_of(error));
          out << '\n';
          notes.note("no checkpoint has been written. " + failure + ".",
                     "Warning");
          last_checkpoint = std::chrono::steady_clock::now();
        }
    if (is_last || signal == 0 || signal == SIGUSR1)
      return;
    // A resumed run removes the rows after the checkpoint.
    simulations.finish();
    if (last_written_statistics != common().n_steps)
      write_statistics();
    if (last_written_fields != common().n_steps)
      write_fields();
    const RunSummary summary = summarize();
    out << '\n';
    print_summary(summary);
    write_summary(summary);
    std::string text = "Stopped by " + SignalCatcher::name(signal) +
                       " after step " + std::to_string(common().n_steps) +
                       ", t = " + text_of(common().time) + " s. ";
    if (!failure.empty())
      text += "No checkpoint of this step has been written: " + failure + ". ";
    if (failure.empty())
      text += "--resume continues from the checkpoint in <" + directory + ">.";
    else if (checkpoint_file.empty())
      text += "There is no earlier one either: the run has to start again.";
    else
      text += "--resume continues from <" + checkpoint_file + ">.";
    Require(false, text);
  }



  GREVILLE_INSTANTIATE(begin_with);
  GREVILLE_INSTANTIATE(resume_from);
  GREVILLE_INSTANTIATE_CLASS(SimulationRun);
} // namespace greville
