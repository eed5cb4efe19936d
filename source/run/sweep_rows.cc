// SPDX-License-Identifier: LGPL-2.1-or-later

// The runs of a sweep.

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/run/sweep.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace greville
{
  using namespace dealii;

  std::string
  SweepRow::folder(const SweepParameters &sweep) const
  {
    const bool has_value = !name_of_value.empty();
    if (has_value && sweep.cells.empty() && sweep.degrees.empty() &&
        sweep.formulations.empty() && sweep.masses.empty())
      return name_of_value;
    const std::string &formulation = parameters.scheme.formulation;
    return (sweep.formulations.empty()
              ? ""
              : formulation.substr(0, formulation.find(' ')) + "_") +
           parameters.scheme.mass + "_p" +
           std::to_string(parameters.grid.degree) + "_" +
           std::to_string(cells) + (has_value ? "_" + name_of_value : "");
  }



  namespace
  {
    /**
     * The last word of a parameter and its value as the name of a folder.
     */
    std::string
    name_of_value(const std::string           &parameter,
                  const std::string           &value,
                  const std::vector<SweepRow> &rows)
    {
      std::string name =
        parameter.substr(parameter.rfind('/') + 1) + "_" + value.substr(0, 60);
      for (char &c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' &&
            c != '-' && c != '+')
          c = '_';
      const auto is_taken = [&](const std::string &text) {
        return std::any_of(rows.begin(), rows.end(), [&](const SweepRow &row) {
          return row.name_of_value == text && row.value != value;
        });
      };
      std::string result = name;
      for (unsigned int k = 2; is_taken(result); ++k)
        result = name + "_" + std::to_string(k);
      return result;
    }



    /**
     * The sections of stages that have the value of a section outside of them:
     * they have it from there.
     */
    std::vector<std::string>
    stages_like(const SimulationParameters &parameters,
                const std::string          &section,
                const std::string          &name)
    {
      std::map<std::string, std::string> values;
      for (const ParameterLine &line :
           parameter_lines_of(parameters.used(), "parameters"))
        if (line.name == name)
          values[line.section] = line.value;
      std::vector<std::string> result;
      for (const StageParameters &stage : parameters.stages)
        {
          const std::string own   = "Stage " + stage.name + "/" + section;
          const auto        found = values.find(own);
          if (found != values.end() && found->second == values[section])
            result.push_back(own);
        }
      return result;
    }
  } // namespace



  std::vector<SweepRow>
  make_sweep_rows(const SimulationParameters &parameters)
  {
    const SweepParameters &sweep  = parameters.sweep;
    const auto             or_one = [](const auto &list, const auto &one) {
      return list.empty() ? std::decay_t<decltype(list)>{one} : list;
    };
    const auto &scheme        = parameters.scheme;
    const auto  degrees       = or_one(sweep.degrees, parameters.grid.degree);
    const auto  masses        = or_one(sweep.masses, scheme.mass);
    const auto  formulations  = or_one(sweep.formulations, scheme.formulation);
    const auto &base          = parameters.grid.cells;
    const unsigned int most   = *std::max_element(base.begin(), base.end());
    const auto         cells  = or_one(sweep.cells, most);
    auto               values = sweep.list_of_values();
    if (values.empty())
      values.emplace_back();
    std::vector<SweepRow> rows;
    const auto            add = [&](const std::string &formulation,
                         const std::string &mass,
                         const unsigned int degree,
                         const unsigned int n,
                         const std::string &value) {
      SweepRow    row;
      std::string changes;
      const auto  set = [&](const std::string &section,
                           const std::string &name,
                           const std::string &value) {
        std::string end;
        for (const std::string &part :
             Utilities::split_string_list(section, '/'))
          {
            changes += "subsection " + part + "\n";
            end += "end\n";
          }
        changes += "set " + name + " = " + value + "\n" + end;
      };
      // Lists that are empty leave stages what they have.
      const auto set_scheme = [&](const std::string &section, const bool all) {
        if (all || !sweep.formulations.empty())
          set(section, "Formulation", formulation);
        if (all || !sweep.masses.empty())
          set(section, "Mass", mass);
      };
      set_scheme("Scheme", true);
      for (const StageParameters &stage : parameters.stages)
        set_scheme("Stage " + stage.name + "/Scheme", false);
      const auto scale = [&](const std::vector<unsigned int> &all,
                             const std::string               &section) {
        std::string text;
        for (const unsigned int cells : all)
          {
            const std::uint64_t product = std::uint64_t(cells) * n;
            AssertThrow(cells == 1 || (product % most == 0 &&
                                       product / most < (1ull << 31)),
                        ExcMessage(
                          "The parameter 'Sweep/Cells' has the entry " +
                          std::to_string(n) + ", with which '" + section +
                          "/Cells' cannot keep their ratio, or are too many."));
            text += (text.empty() ? "" : ", ") +
                    std::to_string(cells > 1 ? product / most : cells);
          }
        if (!all.empty())
          set(section, "Cells", text);
      };
      scale(parameters.grid.cells, "Grid");
      for (const auto &[name, grid] : parameters.body_grids)
        scale(grid.cells, "Body " + name + "/Grid");
      set("Grid", "Order", std::to_string(degree));
      for (const std::string list :
           {"Cells", "Orders", "Formulations", "Masses", "Parameter", "Values"})
        set("Sweep", list, "");
      if (!sweep.parameter.empty())
        {
          const auto        slash   = sweep.parameter.rfind('/');
          const std::string section = sweep.parameter.substr(0, slash);
          const std::string name = sweep.parameter.substr(slash + 1);
          set(section, name, value);
          for (const std::string &stage :
               stages_like(parameters, section, name))
            set(stage, name, value);
          row.value         = value;
          row.name_of_value = name_of_value(sweep.parameter, value, rows);
        }
      try
        {
          row.parameters = parameters.with(changes);
        }
      catch (const std::exception &error)
        {
          AssertThrow(sweep.parameter.empty(),
                      ExcMessage("The parameter 'Sweep/Parameter' is <" +
                                 sweep.parameter + ">, with the value <" +
                                 value + ">. " + message_of(error)));
          throw;
        }
      row.parameters.sweep = sweep;
      row.cells            = n;
      rows.push_back(row);
    };
    for (const std::string &formulation : formulations)
      for (const std::string &mass : masses)
        for (const unsigned int degree : degrees)
          for (const std::string &value : values)
            for (const unsigned int n : cells)
              add(formulation, mass, degree, n, value);
    return rows;
  }
} // namespace greville
