// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/begin_run.h>
#include <greville/run/run.h>

#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <iomanip>
#include <iostream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    void
    show(std::ostream           &out,
         const std::string      &title,
         const ElementTestTable &table)
    {
      const std::vector<double> q    = table.column("q");
      std::size_t               peak = 0;
      for (std::size_t k = 0; k < q.size(); ++k)
        if (std::abs(q[k]) > std::abs(q[peak]))
          peak = k;
      constexpr unsigned int n_columns = 7;
      out << title << "\n              ";
      for (unsigned int c = 0; c < n_columns; ++c)
        out << "  " << table.names[c];
      const std::pair<const char *, std::size_t> rows[] = {
        {"start", 0}, {"largest q", peak}, {"end", q.size() - 1}};
      for (const auto &[name, row] : rows)
        {
          out << "\n  " << std::left << std::setw(12) << name << std::right;
          for (unsigned int c = 0; c < n_columns; ++c)
            out << "  " << std::setw(table.names[c].size())
                << rounded(table.rows[row][c], 5);
        }
      out << '\n';
    }
  } // namespace



  void
  run_element_test_of_file(const std::string &file,
                           const std::string &test,
                           const std::string &name,
                           const MPI_Comm     comm,
                           const RunOptions  &options)
  {
    check_word(test, "--element-test", element_test_names());
    const SimulationParameters parameters(file, options.settings);
    const auto                 names = keys_of(parameters.materials);
    Require(
      !name.empty() || names.size() == 1,
      "--element-test needs --material NAME, because the file has several: " +
        boost::algorithm::join(names, ", ") + ".");
    const std::string chosen = name.empty() ? names[0] : name;
    const auto        found  = parameters.materials.find(chosen);
    Require(found != parameters.materials.end(),
            "--material: there is no material <" + chosen + "> in <" + file +
              ">, which has: " + boost::algorithm::join(names, ", ") + "." +
              did_you_mean(chosen, names));
    const ElementTestTable table = run_element_test(*found->second,
                                                    "Material " + chosen,
                                                    test,
                                                    parameters.element_test);

    const std::string directory = folder_of_run(parameters, file, options);
    RunFolder folder = take_folder(parameters, directory, options, comm);
    folder.make_room();
    CsvWriter writer;
    writer.open(directory + "/element_test.csv", table.names, 15, comm);
    for (const auto &row : table.rows)
      writer.write(row);
    writer.sync();
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      {
        show(std::cout, "Element test " + test + " of " + chosen, table);
        std::cout << "  results: " << directory
                  << "/element_test.csv (draw it: scripts/picture " << directory
                  << ")" << std::endl;
      }
  }
} // namespace greville
