// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/stage_bodies.h>
#include <greville/steps/state_tables.h>

#include <algorithm>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim, typename Position, typename All>
    void
    visit_position(const std::string &of, Position &position, const All &all)
    {
      const auto each = [&](const std::string &name, auto &numbers) {
        for (unsigned int d = 0; d < numbers.dimension; ++d)
          all(of + name + std::to_string(d), numbers[d]);
      };
      each("reference_", position.reference);
      each("displacement_", position.displacement);
      each("velocity_", position.velocity);
      each("spin_", position.spin);
      for (unsigned int d = 0; d < dim; ++d)
        each("rotation_" + std::to_string(d), position.rotation[d]);
    }



    /// Call @p all(name, number) for each number that all processes share, and
    /// @p sum(name, number) for each number that is a sum over processes.
    template <int dim, typename StateType, typename All, typename Sum>
    void
    visit_numbers(StateType &state, const All &all, const Sum &sum)
    {
      all("time", state.time);
      all("velocity_time", state.velocity_time);
      all("step", state.step);
      all("velocity_step", state.velocity_step);
      all("stage", state.stage);
      all("n_steps", state.n_steps);
      all("n_removed", state.n_removed);
      all("n_points", state.n_points);
      all("displacement", state.displacement);
      for (unsigned int b = 0; b < state.bodies.size(); ++b)
        all("n_points_" + std::to_string(b), state.bodies[b].n_points);
      sum("n_sent", state.n_sent);
      all("n_iterations", state.n_iterations);
      all("n_all_iterations", state.n_all_iterations);
      all("n_rejections", state.n_rejections);
      all("n_all_rejections", state.n_all_rejections);
      all("step_fraction", state.step_fraction);
      all("fastest", state.signals.fastest);
      all("wave", state.signals.wave);
      all("crossing_rate", state.signals.crossing_rate);
      all("first_signal", state.first_signal);
      all("critical_step", state.estimates.critical);
      all("next_estimate", state.estimates.next);
      all("steps_between_estimates", state.estimates.n_between);
      all("wave_at_estimate", state.estimates.wave);
      all("first_step", state.estimates.first_step);
      all("mode_is_known", state.field.mode.is_known);
      all("step_of_mode", state.field.mode.step);
      all("n_history", state.field.history.n);
      all("step_before", state.field.history.steps[0]);
      all("step_before_that", state.field.history.steps[1]);
      EnergyBalance::visit_numbers(state.energy,
                                   EnergyBalance::surfaces +
                                     state.surfaces.size(),
                                   all,
                                   sum);
      for (unsigned int w = 0; w < 2 * dim; ++w)
        for (unsigned int d = 0; d < dim; ++d)
          sum("reaction_" + std::to_string(w) + "_" + std::to_string(d),
              state.reactions[w][d]);
      sum("water_stored", state.water[0]);
      sum("water_outflow", state.water[1]);
      for (unsigned int k = 2; k < state.water.size(); ++k)
        sum("water_outflow_" + std::to_string(k - 2), state.water[k]);
      all("water_step", state.water_step);
      for (unsigned int k = 0; k < state.water_of_step.size(); ++k)
        sum("water_of_step_" + std::to_string(k), state.water_of_step[k]);
      for (unsigned int k = 0; k < state.rigid_bodies.size(); ++k)
        {
          const std::string of = "rigid_body_" + std::to_string(k) + "_";
          visit_position<dim>(of, state.rigid_bodies[k].now, all);
          visit_position<dim>(of + "before_",
                              state.rigid_bodies[k].before,
                              all);
        }
      all("n_partitions", state.n_partitions);
      all("imbalance", state.imbalance);
      if (state.partition && state.partition->cells)
        {
          all("n_adaptations", state.n_adaptations);
          all("n_divided", state.n_divided);
          all("is_limited", state.is_limited);
        }
      all("warned_gain", state.warned_gain);
      all("time_to_share", state.time_to_share);
    }



    template <typename StateType>
    auto
    fields_of(StateType &state)
    {
      auto &field = state.field;
      using Field = decltype(&field.velocity);
      return std::vector<std::pair<std::string, Field>>{
        {"velocity", &field.velocity},
        {"acceleration", &field.acceleration},
        {"mode", &field.mode.force},
        {"acceleration_before", &field.history.accelerations[0]},
        {"acceleration_before_that", &field.history.accelerations[1]}};
    }



    template <int dim>
    std::vector<std::string>
    columns_of(const PointLayout<dim> &layout)
    {
      std::vector<std::string> columns = layout.names();
      columns.insert(columns.begin(), "cell");
      return columns;
    }



    /// Return the points in an order from which insert() makes the same lists.
    template <int dim>
    DistributedTable
    table_of(const std::string &name, const MaterialPoints<dim> &points)
    {
      DistributedTable table{name, columns_of(points.layout()), {}};
      table.values.reserve(points.n_points() * table.columns.size());
      for (const unsigned int cell : points.cells())
        for_each_as_inserted(points, cell, [&](const ConstPointRef<dim> p) {
          table.values.push_back(double(points.space().owned_cells()[cell]));
          for (unsigned int i = 0; i < points.layout().size; ++i)
            table.values.push_back(p[i]);
        });
      return table;
    }



    template <int dim>
    std::string
    name_of(const Body<dim> &body)
    {
      return "body " + body.name;
    }



    template <int dim>
    std::string
    name_of(const Surface<dim> &surface)
    {
      return "surface " + surface.name;
    }



    /// Replace the points of a body or surface by the points of a file.
    template <int dim, typename Owner>
    void
    set_points(Owner               &owner,
               const TablesFile    &content,
               Discretization<dim> &discretization)
    {
      const DistributedTable &table  = content.table(name_of(owner));
      const PointLayout<dim>  layout = owner.points.layout();
      Require(table.columns == columns_of(layout),
              "the " + name_of(owner) +
                " has other numbers at its points there");
      const SplineSpace<dim> &space   = discretization.space();
      double                  n_cells = 1.;
      for (const unsigned int n : space.cells_per_direction())
        n_cells *= n;
      run_on_all(discretization.communicator(), [&]() {
        for (std::size_t k = 0; k < table.values.size();
             k += table.columns.size())
          {
            const double cell = table.values[k];
            Require(cell >= 0. && cell < n_cells,
                    "a point of the " + name_of(owner) + " is in the cell " +
                      text_of(cell) + ", but the grid has " + text_of(n_cells) +
                      " cells");
            const auto *levels = space.hierarchy();
            Require(!levels || levels->is_active(
                                 multi_index<dim>(std::uint64_t(cell),
                                                  space.cells_per_direction())),
                    "a point of the " + name_of(owner) +
                      " is in a cell that the levels of the grid do not have");
          }
      });
      owner.points.reinit(discretization.space(), layout);
      discretization.transport().insert(owner.points, table.values);
    }



    template <int dim>
    DistributedTable
    field_table(const std::string      &name,
                const VectorField<dim> &field,
                const SplineSpace<dim> &space)
    {
      DistributedTable table{name, {"function"}, {}};
      for (unsigned int d = 0; d < dim; ++d)
        table.columns.push_back(std::string(1, "xyz"[d]));
      if (field[0].size() == 0)
        return table;
      const auto &functions = space.owned_functions();
      for (unsigned int i = 0; i < functions.size(); ++i)
        {
          table.values.push_back(double(functions[i]));
          for (unsigned int d = 0; d < dim; ++d)
            table.values.push_back(field[d].local_element(i));
        }
      return table;
    }



    template <int dim>
    void
    set_field(VectorField<dim>          &field,
              const DistributedTable    &table,
              const Discretization<dim> &discretization)
    {
      const SplineSpace<dim> &space = discretization.space();
      const MPI_Comm          comm  = space.communicator();
      const std::size_t       n     = table.n_rows();
      if (Utilities::MPI::max<unsigned int>(n > 0, comm) == 0)
        {
          field = {};
          return;
        }
      discretization.initialize(field);
      constexpr unsigned int     width = 1 + dim;
      std::vector<std::uint64_t> positions;
      for (std::size_t k = 0; k < n; ++k)
        positions.push_back(std::uint64_t(table.values[k * width]));
      const auto numbers = space.global_numbers(positions);

      IndexSet rows(space.n_dofs());
      {
        auto sorted = numbers;
        std::sort(sorted.begin(), sorted.end());
        rows.add_indices(sorted.begin(), sorted.end());
        rows.compress();
      }
      const auto owners =
        Utilities::MPI::compute_index_owner(space.locally_owned_dofs(),
                                            rows,
                                            comm);
      std::map<unsigned int, std::vector<double>> to_send;
      for (std::size_t k = 0; k < n; ++k)
        {
          auto &message = to_send[owners[rows.index_within_set(numbers[k])]];
          message.push_back(double(numbers[k]));
          message.insert(message.end(),
                         table.values.begin() + k * width + 1,
                         table.values.begin() + (k + 1) * width);
        }
      const unsigned int process  = Utilities::MPI::this_mpi_process(comm);
      auto               own      = to_send.extract(process);
      auto               received = exchange_lists(comm, to_send);
      if (!own.empty())
        received[process].swap(own.mapped());
      for (const auto &message : received)
        for (std::size_t k = 0; k < message.second.size(); k += width)
          for (unsigned int d = 0; d < dim; ++d)
            field[d](types::global_dof_index(message.second[k])) =
              message.second[k + 1 + d];
    }
  } // namespace



  template <int dim>
  std::vector<DistributedTable>
  make_field_tables(const State<dim>       &state,
                    const SplineSpace<dim> &space,
                    const std::string      &prefix)
  {
    std::vector<DistributedTable> tables;
    for (const auto &[name, field] : fields_of(state))
      tables.push_back(field_table<dim>(prefix + name, *field, space));
    return tables;
  }



  template <int dim>
  void
  set_fields_from_tables(State<dim>          &state,
                         const TablesFile    &content,
                         Discretization<dim> &discretization,
                         const std::string   &prefix)
  {
    for (const auto &[name, field] : fields_of(state))
      set_field<dim>(*field, content.table(prefix + name), discretization);
  }



  template <int dim>
  std::vector<DistributedTable>
  make_tables(const State<dim>       &state,
              const SplineSpace<dim> &space,
              const std::string      &prefix)
  {
    const MPI_Comm comm     = space.communicator();
    const bool     is_first = Utilities::MPI::this_mpi_process(comm) == 0;

    DistributedTable numbers{prefix + "state", {}, {}};
    const auto       add = [&](const std::string &name, const double value) {
      numbers.columns.push_back(name);
      if (is_first)
        numbers.values.push_back(value);
    };
    visit_numbers<dim>(
      state,
      [&](const std::string &name, const auto value) {
        add(name, double(value));
      },
      [&](const std::string &name, const auto value) {
        add(name, double(Utilities::MPI::sum(value, comm)));
      });
    DistributedTable estimates{prefix + "step_estimates", {"step"}, {}};
    if (is_first)
      estimates.values = state.estimates.last;

    std::vector<DistributedTable> tables = {std::move(numbers),
                                            std::move(estimates)};
    tables.push_back({prefix + "partition", {"cell", "weight"}, {}});
    if (state.partition)
      tables.back().values = state.partition->rows;
    if (state.partition && state.partition->cells)
      for (const auto &[name, cells] :
           {std::make_pair("refined_cells", &state.partition->cells->all),
            std::make_pair("refined_at_surfaces",
                           &state.partition->cells->at_surfaces)})
        {
          tables.push_back({prefix + name, {"cell"}, {}});
          if (is_first)
            tables.back().values.assign(cells->begin(), cells->end());
        }
    for (DistributedTable &table : make_field_tables(state, space, prefix))
      tables.push_back(std::move(table));
    for (const Body<dim> &body : state.bodies)
      tables.push_back(table_of(name_of(body), body.points));
    for (const Surface<dim> &surface : state.surfaces)
      tables.push_back(table_of(name_of(surface), surface.points));
    return tables;
  }



  template <int dim>
  void
  set_from_tables(State<dim>                 &state,
                  const TablesFile           &content,
                  Discretization<dim>        &discretization,
                  const std::string          &prefix,
                  const SimulationParameters *stages)
  {
    const MPI_Comm comm     = discretization.communicator();
    const bool     is_first = Utilities::MPI::this_mpi_process(comm) == 0;

    const DistributedTable &numbers  = content.table(prefix + "state");
    const auto              values   = numbers.gather(comm);
    const auto              value_of = [&](const std::string &name) {
      const auto found =
        std::find(numbers.columns.begin(), numbers.columns.end(), name);
      Require(found != numbers.columns.end(), "there is no number " + name);
      return values[found - numbers.columns.begin()];
    };
    Require(values.size() == numbers.columns.size(),
            "the table state has not one row");
    visit_numbers<dim>(
      state,
      [&](const std::string &name, auto &value) {
        value = std::decay_t<decltype(value)>(value_of(name));
      },
      [&](const std::string &name, auto &value) {
        value = is_first ? std::decay_t<decltype(value)>(value_of(name)) : 0;
      });
    state.estimates.last =
      content.table(prefix + "step_estimates").gather(comm);

    std::shared_ptr<const RefinedCells> cells;
    if (discretization.partition()->cells)
      {
        const auto of_table = [&](const std::string &name) {
          const auto positions = content.table(prefix + name).gather(comm);
          return std::vector<std::uint64_t>(positions.begin(), positions.end());
        };
        cells = std::make_shared<const RefinedCells>(
          RefinedCells{of_table("refined_cells"),
                       of_table("refined_at_surfaces")});
      }
    if (discretization.repartition(std::make_shared<const Partition>(
          content.table(prefix + "partition").values, comm, cells)))
      discretization.reinit();
    state.partition = discretization.partition();
    set_fields_from_tables(state, content, discretization, prefix);
    if (stages)
      {
        SimulationParameters parameters = *stages;
        parameters.enter_stage(state.stage);
        for (Body<dim> &body : state.bodies)
          body.points.reinit(discretization.space(),
                             layout_of<dim>(body.name, parameters));
      }
    for (Body<dim> &body : state.bodies)
      set_points(body, content, discretization);
    for (Surface<dim> &surface : state.surfaces)
      set_points(surface, content, discretization);
    state.points_have_changed();
  }



  namespace
  {
    /// Return the rows of a table with the columns of another layout. Numbers
    /// of loads and schemes that the table does not have are zero: loads find
    /// their points again, APIC and Taylor begin without affine velocities, and
    /// generalized-alpha computes its first acceleration. Without a projected
    /// J, J takes its place.
    template <int dim>
    std::vector<double>
    rows_with(const PointLayout<dim> &layout,
              const DistributedTable &table,
              const std::string      &owner)
    {
      const auto               columns  = columns_of(layout);
      const unsigned int       n_needed = 1 + layout.n_fixed + layout.n_state;
      constexpr auto           none     = std::string::npos;
      std::vector<std::size_t> from;
      for (unsigned int i = 0; i < columns.size(); ++i)
        {
          auto found =
            std::find(table.columns.begin(), table.columns.end(), columns[i]);
          if (found == table.columns.end() && columns[i] == "projected_J")
            found = std::find(table.columns.begin(), table.columns.end(), "J");
          const bool is_found = found != table.columns.end();
          Require(is_found || columns[i].find("domain") == none,
                  "the " + owner +
                    " has points without domains there: 'Scheme/Functions' = "
                    "domains has to hold in both runs");
          Require(is_found ||
                    (i >= n_needed && columns[i].find("initial_F") == none),
                  "the " + owner + " has no number '" + columns[i] +
                    "' at its points there: its material or its initial state "
                    "differs");
          from.push_back(is_found ? found - table.columns.begin() : none);
        }
      std::vector<double> rows;
      rows.reserve(table.n_rows() * columns.size());
      for (std::size_t k = 0; k < table.values.size();
           k += table.columns.size())
        for (const std::size_t column : from)
          rows.push_back(column == none ? 0. : table.values[k + column]);
      return rows;
    }



    /// Replace the points of a body or surface by the points of another run, in
    /// the cells of this grid.
    template <int dim, typename Owner>
    void
    set_points_anew(Owner               &owner,
                    const TablesFile    &content,
                    Discretization<dim> &discretization)
    {
      const SplineSpace<dim> &space  = discretization.space();
      const PointLayout<dim>  layout = owner.points.layout();
      std::string             others;
      const std::string       name     = name_of(owner);
      const std::string       kind     = name.substr(0, name.find(' ') + 1);
      bool                    is_there = false;
      for (const DistributedTable &table : content.tables)
        {
          is_there = is_there || table.name == name;
          if (table.name.compare(0, kind.size(), kind) == 0)
            others += (others.empty() ? "" : ", ") + table.name;
        }
      Require(is_there,
              "it has no " + name + (others.empty() ? "" : ", but " + others));
      std::vector<double> rows = rows_with(layout, content.table(name), name);
      std::ostringstream  message;
      for (std::size_t k = 0; k < rows.size(); k += layout.size + 1)
        {
          const Point<dim> x =
            PointRef<dim>(&rows[k + 1]).basis_position(layout);
          for (unsigned int d = 0; d < dim && message.str().empty(); ++d)
            if (!(x[d] >= space.lower_corner()[d] &&
                  x[d] <= space.upper_corner()[d]))
              message << "the " << name_of(owner)
                      << " does not lie in the grid: a point of it is at (" << x
                      << ") m";
          if (message.str().empty())
            rows[k] = double(space.cell_position(x));
        }
      throw_on_all(message.str(), discretization.communicator());
      owner.points.reinit(owner.points.space(), layout);
      discretization.transport().insert(owner.points, rows);
    }
  } // namespace



  template <int dim>
  void
  set_points_from_tables(State<dim>          &state,
                         const TablesFile    &content,
                         Discretization<dim> &discretization)
  {
    for (Body<dim> &body : state.bodies)
      {
        // Bodies of later stages have no points.
        if (body.n_points == 0)
          continue;
        set_points_anew(body, content, discretization);
        body.n_points =
          Utilities::MPI::sum<std::uint64_t>(body.points.n_points(),
                                             discretization.communicator());
        Require(body.n_points > 0,
                "the " + name_of(body) +
                  " has no points there: it belongs to a later stage, or they "
                  "have left the grid. Leave it out of 'Simulation/Bodies', or "
                  "let a later stage begin with it");
      }
    for (Surface<dim> &surface : state.surfaces)
      if (state.bodies[surface.body].n_points > 0)
        set_points_anew(surface, content, discretization);
    state.n_points = 0;
    for (const Body<dim> &body : state.bodies)
      state.n_points += body.n_points;
    state.signals      = initial_signals(state.bodies, discretization.space());
    state.first_signal = state.signals.fastest;
    state.points_have_changed();
  }



  GREVILLE_INSTANTIATE(make_tables);
  GREVILLE_INSTANTIATE(make_field_tables);
  GREVILLE_INSTANTIATE(set_fields_from_tables);
  GREVILLE_INSTANTIATE(set_from_tables);

  GREVILLE_INSTANTIATE(set_points_from_tables);
} // namespace greville
