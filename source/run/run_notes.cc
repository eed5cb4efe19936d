// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/run/output.h>
#include <greville/run/run_notes.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    const std::vector<std::string> newton_columns = {"step",
                                                     "part",
                                                     "time",
                                                     "dt",
                                                     "iteration",
                                                     "residual",
                                                     "relative",
                                                     "fraction",
                                                     "linear_iterations",
                                                     "converged"};



    /**
     * The unit of columns whose name is this prefix, alone or followed by a
     * digit or an underscore. The first match of a file counts.
     */
    struct ColumnUnit
    {
      const char *file, *begin, *unit, *unit_2d;
    };

    constexpr ColumnUnit units[] = {
      {"statistics.csv", "time", "s", "s"},
      {"statistics.csv", "dt", "s", "s"},
      {"statistics.csv", "mass", "kg", "kg / m"},
      {"statistics.csv", "momentum", "kg m / s", "kg / s"},
      {"statistics.csv", "angular_momentum", "kg m^2 / s", "kg m / s"},
      {"statistics.csv", "kinetic", "J", "J / m"},
      {"statistics.csv", "strain", "J", "J / m"},
      {"statistics.csv", "dissipation", "J", "J / m"},
      {"statistics.csv", "gravitational", "J", "J / m"},
      {"statistics.csv", "total", "J", "J / m"},
      {"statistics.csv", "work", "J", "J / m"},
      {"statistics.csv", "center", "m", "m"},
      {"statistics.csv", "front", "m", "m"},
      {"statistics.csv", "height", "m", "m"},
      {"statistics.csv", "largest_speed", "m / s", "m / s"},
      {"statistics.csv", "load", "N", "N / m"},
      {"statistics.csv", "contact", "N", "N / m"},
      {"statistics.csv", "rigid", "m", "m"},
      {"statistics.csv", "reaction", "N", "N / m"},
      {"statistics.csv", "water", "m^3", "m^2"},
      {"statistics.csv", "iterations", "1", "1"},
      {"statistics.csv", "active", "1", "1"},
      {"statistics.csv", "points", "1", "1"},
      {"statistics.csv", "fragments", "1", "1"},
      {"statistics.csv", "redone", "1", "1"},
      {"statistics.csv", "stage", "1", "1"},
      {"statistics.csv", "factor", "1", "1"},
      {"statistics.csv", "largest_load", "1", "1"},
      {"statistics.csv", "imbalance", "1", "1"},
      {"statistics.csv", "partitions", "1", "1"},
      {"probes.csv", "time", "s", "s"},
      {"probes.csv", "stress", "Pa", "Pa"},
      {"probes.csv", "pore_pressure", "Pa", "Pa"},
      {"probes.csv", "x", "m", "m"},
      {"probes.csv", "y", "m", "m"},
      {"probes.csv", "z", "m", "m"},
      {"probes.csv", "vx", "m / s", "m / s"},
      {"probes.csv", "vy", "m / s", "m / s"},
      {"probes.csv", "vz", "m / s", "m / s"},
      {"newton.csv", "time", "s", "s"},
      {"newton.csv", "dt", "s", "s"},
      {"newton.csv", "residual", "N", "N / m"},
      {"newton.csv", "", "1", "1"},
      {"points", "velocity", "m / s", "m / s"},
      {"points", "displacement", "m", "m"},
      {"points", "reference", "m", "m"},
      {"points", "size", "m", "m"},
      {"points", "stress", "Pa", "Pa"},
      {"points", "pressure", "Pa", "Pa"},
      {"points", "pore_pressure", "Pa", "Pa"},
      {"points", "von_mises", "Pa", "Pa"},
      {"points", "density", "kg / m^3", "kg / m^3"},
      {"points", "mass", "kg", "kg / m"},
      {"points", "volume", "m^3", "m^2"},
      {"points", "dissipation", "J / m^3", "J / m^3"},
      {"points", "plastic_strain", "1", "1"},
      {"points", "opening", "1", "1"},
      {"points", "strain", "1", "1"},
      {"points", "b", "1", "1"},
      {"points", "stran", "1", "1"},
      {"points", "energy", "J / m^3", "J / m^3"},
      {"points", "modulus", "Pa", "Pa"},
      {"points", "F", "1", "1"},
      {"points", "J", "1", "1"},
      {"points", "body", "1", "1"},
      {"points", "id", "1", "1"},
      {"points", "process", "1", "1"},
      {"grid", "velocity", "m / s", "m / s"},
      {"grid", "acceleration", "m / s^2", "m / s^2"},
      {"grid", "force", "N", "N / m"},
      {"grid", "mass", "kg", "kg / m"},
      {"grid", "cell_class", "1", "1"},
      {"surface", "velocity", "m / s", "m / s"},
      {"surface", "displacement", "m", "m"},
      {"surface", "load", "Pa", "Pa"},
      {"surface", "area", "m^2", "m"},
      {"surface", "surface_load", "1", "1"},
      {"surface", "gap", "m", "m"},
      {"surface", "pressure", "Pa", "Pa"},
      {"surface", "shear", "Pa", "Pa"},
      {"surface", "state", "1", "1"},
      {"surface", "body", "1", "1"},
      {"rigid", "velocity", "m / s", "m / s"},
      {"rigid", "displacement", "m", "m"}};



    /**
     * The unit of columns with this beginning and ending, a name between them,
     * and possibly a component after them.
     */
    struct EndOfColumn
    {
      const char *begin, *end, *unit, *unit_2d;
    };

    constexpr EndOfColumn units_of_ends[] = {
      {"contact_", "_moment", "N m", "N"},
      {"contact_", "_gap", "m", "m"},
      {"contact_", "_area", "m^2", "m"},
      {"rigid_", "_vx", "m / s", "m / s"},
      {"rigid_", "_vy", "m / s", "m / s"},
      {"rigid_", "_vz", "m / s", "m / s"}};



    bool
    ends_with(const std::string &column, const std::string &end)
    {
      return column.size() >= end.size() &&
             column.compare(column.size() - end.size(), end.size(), end) == 0;
    }



    bool
    is_one_of(const std::string &column, const std::string &begin)
    {
      if (column.compare(0, begin.size(), begin) != 0)
        return false;
      if (begin.empty() || column.size() == begin.size())
        return true;
      const char next = column[begin.size()];
      return next == '_' || (next >= '0' && next <= '9');
    }
  } // namespace



  std::string
  unit_of(const std::string &file,
          const std::string &column,
          const unsigned int dim,
          const bool         is_axisymmetric)
  {
    const auto in_dim = [&](const std::string &unit,
                            const std::string &unit_2d) {
      return dim == 3 || unit == unit_2d ? unit
             : is_axisymmetric           ? unit + " / rad"
                                         : unit_2d;
    };
    for (const EndOfColumn &candidate : units_of_ends)
      if (file == "statistics.csv" &&
          column.compare(0, std::strlen(candidate.begin), candidate.begin) ==
            0 &&
          (ends_with(column, candidate.end) ||
           ends_with(column.substr(0, column.size() - 2), candidate.end)))
        return in_dim(candidate.unit, candidate.unit_2d);
    for (const ColumnUnit &candidate : units)
      if (file == candidate.file && is_one_of(column, candidate.begin))
        return in_dim(candidate.unit, candidate.unit_2d);
    // Probes have the fields of points.
    return file == "probes.csv"
             ? unit_of("points", column, dim, is_axisymmetric)
             : "";
  }



  RunNotes::RunNotes(const std::string &directory,
                     std::ostream      &out,
                     const MPI_Comm     comm)
    : directory(directory)
    , out(out)
    , comm(comm)
  {}



  void
  RunNotes::begin()
  {
    run_on_first(
      [&]() {
        for (const char *name : {"messages.log", "newton.csv"})
          {
            const std::string file = directory + "/" + name;
            std::error_code   error;
            std::filesystem::remove(file, error);
            AssertThrow(!error,
                        ExcMessage("Cannot remove <" + file +
                                   ">: " + error.message() + "."));
          }
      },
      comm);
  }



  void
  RunNotes::resume(const unsigned int n_steps)
  {
    last_step = n_steps;
    append("Note",
           "The run continues after step " + std::to_string(n_steps) + ".");
  }



  void
  RunNotes::append(const std::string &kind, const std::string &text)
  {
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      std::ofstream(directory + "/messages.log", std::ios::app)
        << kind << ": " << line << '\n';
  }



  void
  RunNotes::warn(const std::string &warning)
  {
    out << "Warning: " << warning << std::endl;
    append("Warning", warning);
  }



  void
  RunNotes::note(const std::string &text)
  {
    out << "Note: " << text << std::endl;
    append("Note", text);
  }



  void
  RunNotes::note_error(const std::string &error)
  {
    append("Error", error);
  }



  void
  RunNotes::write(const std::vector<NewtonRecord> &records)
  {
    const std::string file = directory + "/newton.csv";
    if (!records.empty() && !newton_is_open)
      {
        std::uint64_t n_bytes = 0;
        if (last_step >= 0)
          run_on_first(
            [&]() {
              std::ifstream in(file);
              for (std::string line; std::getline(in, line);)
                {
                  std::istringstream words(line);
                  int                step = 0;
                  if (n_bytes > 0 && (!(words >> step) || step > last_step))
                    break;
                  n_bytes += line.size() + 1;
                }
            },
            comm);
        const bool has_rows = Utilities::MPI::max(double(n_bytes), comm) > 0.;
        if (has_rows)
          newton.resume(file, newton_columns, 8, n_bytes, comm);
        else
          newton.open(file, newton_columns, 8, comm);
        newton_is_open = true;
      }
    for (const NewtonRecord &record : records)
      for (unsigned int k = 0; k < record.result.iterations.size(); ++k)
        {
          const NewtonIteration &row = record.result.iterations[k];
          newton.write({double(record.step),
                        double(record.part),
                        record.time,
                        record.dt,
                        double(k),
                        row.residual,
                        row.relative,
                        row.step,
                        double(row.linear_iterations),
                        double(record.result.converged)});
        }
  }



  void
  RunNotes::write_units(const unsigned int              dim,
                        const bool                      is_axisymmetric,
                        const std::vector<std::string> &columns,
                        const std::vector<std::string> &probes,
                        const std::vector<std::string> &fields,
                        const std::map<std::string, std::string> &history)
  {
    std::ostringstream text;
    text << "file,column,unit\n";
    const auto add = [&](const std::string              &file,
                         const std::vector<std::string> &names) {
      for (const std::string &name : names)
        text << file << ',' << name << ','
             << (file == "points" && history.count(name) > 0
                   ? history.at(name)
                   : unit_of(file, name, dim, is_axisymmetric))
             << '\n';
    };
    add("statistics.csv", columns);
    add("probes.csv", probes);
    add("newton.csv", newton_columns);
    add("points", fields);
    add("grid", {"velocity", "mass", "acceleration", "force", "cell_class"});
    add("surface",
        {"velocity",
         "displacement",
         "load",
         "area_vector",
         "area",
         "surface_load",
         "body",
         "gap",
         "pressure",
         "shear",
         "state"});
    add("rigid", {"velocity", "displacement"});
    run_on_first(
      [&]() {
        const std::string folder =
          directory + "/" + FieldOutput<2>::file_folder;
        create_folder(folder, "Output/Directory");
        write_atomically(folder + "/units.csv", text.str());
      },
      comm);
  }
} // namespace greville
