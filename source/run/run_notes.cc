// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/output.h>
#include <greville/run/run_notes.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    const auto newton_columns = Utilities::split_string_list(
      "step, part, time, dt, iteration, residual, relative, fraction, "
      "linear_iterations, converged");



    /// The unit of columns whose name is one of these prefixes, alone or
    /// followed by a digit or an underscore. Without prefixes: all others of a
    /// file.
    struct ColumnUnits
    {
      const char *file, *unit, *unit_2d, *begins;
    };

    constexpr ColumnUnits units[] = {
      {"statistics.csv", "s", "s", "time dt"},
      {"statistics.csv", "kg", "kg / m", "mass"},
      {"statistics.csv", "kg m / s", "kg / s", "momentum"},
      {"statistics.csv", "kg m^2 / s", "kg m / s", "angular_momentum"},
      {"statistics.csv",
       "J",
       "J / m",
       "kinetic strain dissipation gravitational total work"},
      {"statistics.csv", "m", "m", "center front height rigid"},
      {"statistics.csv", "m / s", "m / s", "largest_speed"},
      {"statistics.csv", "N", "N / m", "load contact reaction"},
      {"statistics.csv", "m^3", "m^2", "water"},
      {"statistics.csv",
       "1",
       "1",
       "iterations active points fragments redone stage factor largest_load "
       "imbalance partitions cells adaptations divided"},
      {"probes.csv", "s", "s", "time"},
      {"probes.csv", "Pa", "Pa", "stress pore_pressure"},
      {"probes.csv", "m", "m", "x y z"},
      {"probes.csv", "m / s", "m / s", "vx vy vz"},
      {"newton.csv", "s", "s", "time dt"},
      {"newton.csv", "N", "N / m", "residual"},
      {"newton.csv", "1", "1", ""},
      {"points", "m / s", "m / s", "velocity"},
      {"points", "m", "m", "displacement reference size"},
      {"points", "Pa", "Pa", "stress pressure pore_pressure von_mises modulus"},
      {"points", "kg / m^3", "kg / m^3", "density"},
      {"points", "kg", "kg / m", "mass"},
      {"points", "m^3", "m^2", "volume"},
      {"points", "J / m^3", "J / m^3", "dissipation energy"},
      {"points",
       "1",
       "1",
       "plastic_strain opening strain b stran F J body id process level"},
      {"grid", "m / s", "m / s", "velocity"},
      {"grid", "m / s^2", "m / s^2", "acceleration"},
      {"grid", "N", "N / m", "force"},
      {"grid", "kg", "kg / m", "mass"},
      {"grid", "1", "1", "cell_class"},
      {"surface", "m / s", "m / s", "velocity"},
      {"surface", "m", "m", "displacement gap"},
      {"surface", "Pa", "Pa", "load pressure shear"},
      {"surface", "m^2", "m", "area"},
      {"surface", "1", "1", "surface_load state body"},
      {"rigid", "m / s", "m / s", "velocity"},
      {"rigid", "m", "m", "displacement"}};



    /// The unit of columns with this beginning and ending, a name between them,
    /// and possibly a component after them.
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
    is_one_of(const std::string &column, const std::string &begins)
    {
      const auto list = Utilities::split_string_list(begins, ' ');
      return list.empty() ||
             std::any_of(list.begin(), list.end(), [&](const auto &begin) {
               const char next = column[std::min(begin.size(), column.size())];
               return boost::algorithm::starts_with(column, begin) &&
                      (next == 0 || next == '_' ||
                       (next >= '0' && next <= '9'));
             });
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
          boost::algorithm::starts_with(column, candidate.begin) &&
          (boost::algorithm::ends_with(column, candidate.end) ||
           boost::algorithm::ends_with(column.substr(0, column.size() - 2),
                                       candidate.end)))
        return in_dim(candidate.unit, candidate.unit_2d);
    for (const ColumnUnits &candidate : units)
      if (file == candidate.file && is_one_of(column, candidate.begins))
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
    run_on_first(comm, [&]() {
      for (const char *name : {"messages.log", "newton.csv"})
        {
          const std::string file = directory + "/" + name;
          std::error_code   error;
          std::filesystem::remove(file, error);
          Require(!error,
                  "Cannot remove <" + file + ">: " + error.message() + ".");
        }
    });
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
  RunNotes::note(const std::string &text, const std::string &kind)
  {
    out << kind << ": " << text << std::endl;
    append(kind, text);
  }



  void
  RunNotes::write(const std::vector<NewtonRecord> &records)
  {
    const std::string file = directory + "/newton.csv";
    if (!records.empty() && !newton_is_open)
      {
        std::uint64_t n_bytes = 0;
        if (last_step >= 0)
          run_on_first(comm, [&]() {
            std::ifstream in(file);
            for (std::string line; std::getline(in, line);)
              {
                std::istringstream words(line);
                int                step = 0;
                if (n_bytes > 0 && (!(words >> step) || step > last_step))
                  break;
                n_bytes += line.size() + 1;
              }
          });
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
        Utilities::split_string_list(
          "velocity, displacement, load, area_vector, area, surface_load, "
          "body, gap, pressure, shear, state"));
    add("rigid", {"velocity", "displacement"});
    run_on_first(comm, [&]() {
      const std::string folder = directory + "/" + FieldOutput<2>::file_folder;
      create_folder(folder, "Output/Directory");
      write_atomically(folder + "/units.csv", text.str());
    });
  }
} // namespace greville
