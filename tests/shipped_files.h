// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// The shipped parameter files and the templates of 'greville --new', reduced to
// run in a fraction of a second: coarse grids, three steps, no sweeps.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

struct ShippedFile
{
  std::string name;
  /// True for a file of greville_benchmark.
  bool is_benchmark = false;
  /// The whole file, and the lines that reduce it: later lines win.
  std::string content, overrides;
};



inline std::string
section_text(const std::string &section, const std::vector<std::string> &lines)
{
  std::string result = "subsection " + section + "\n";
  for (const std::string &line : lines)
    result += "  set " + line + "\n";
  return result + "end\n";
}



/// Return the shipped files. @p source is the test folder of a part, and
/// results go to @p results. Write the text into @p folder, which is created
/// with links to the files beside the parameter files.
inline std::vector<ShippedFile>
shipped_files(const std::string &source,
              const std::string &folder,
              const std::string &results)
{
  const std::filesystem::path root =
    std::filesystem::path(source).parent_path().parent_path();
  std::map<std::string, std::string> cells;
  std::ifstream                      table(root / "tests/small_cells.txt");
  for (std::string name, numbers;
       table >> name && std::getline(table, numbers);)
    cells[name] = numbers;
  std::vector<ShippedFile> result;
  std::filesystem::create_directories(folder);
  std::vector<std::filesystem::path> parts = {"prm/simulation",
                                              "prm/templates",
                                              "doc/user/examples",
                                              "prm/mass"};
  for (const auto &entry :
       std::filesystem::directory_iterator(root / "examples"))
    if (entry.is_directory())
      parts.push_back("examples" / entry.path().filename());
  for (const std::filesystem::path &part : parts)
    {
      const auto link = std::filesystem::path(folder) / "reference";
      std::filesystem::create_directories(link);
      if (std::filesystem::exists(root / part / "reference"))
        for (const auto &entry :
             std::filesystem::directory_iterator(root / part / "reference"))
          std::filesystem::copy(entry.path(),
                                link / entry.path().filename(),
                                std::filesystem::copy_options::update_existing);
      for (const auto &entry : std::filesystem::directory_iterator(root / part))
        if (entry.path().extension() == ".prm")
          {
            ShippedFile file;
            file.name         = entry.path().stem().string();
            file.is_benchmark = part == "prm/mass";
            std::ostringstream content;
            content << std::ifstream(entry.path()).rdbuf();
            // Files of examples include others, and name the files that these
            // read.
            file.content = std::regex_replace(content.str(),
                                              std::regex(R"(\.\./\.\./)"),
                                              root.string() + "/");
            if (file.is_benchmark)
              file.overrides = section_text("Benchmark",
                                            {"Cells = 4",
                                             "Orders = 2",
                                             "Repetitions = 1",
                                             "Print times = false",
                                             "Output directory = " + results});
            else
              {
                const auto found = cells.find(file.name);
                file.overrides =
                  section_text("Time", {"Maximum steps = 3"}) +
                  section_text(
                    "Sweep",
                    {"Cells =", "Orders =", "Formulations =", "Masses ="}) +
                  section_text("Output",
                               {"Statistics every = 0",
                                "Directory = " + results});
                if (found != cells.end())
                  file.overrides +=
                    section_text("Grid", {"Cells = " + found->second});
              }
            result.push_back(file);
          }
    }
  std::sort(result.begin(),
            result.end(),
            [](const ShippedFile &a, const ShippedFile &b) {
              return a.name < b.name;
            });
  return result;
}



/// Return the parameter files of greville without reduction, including the
/// files of the reference. Settings name the libraries that users compile, from
/// the tree @p build.
inline std::vector<std::pair<std::filesystem::path, std::vector<std::string>>>
whole_shipped_files(const std::string &source, const std::string &build)
{
  const std::filesystem::path root =
    std::filesystem::path(source).parent_path().parent_path();
  std::vector<std::filesystem::path> folders = {root / "prm/simulation",
                                                root /
                                                  "prm/simulation/sections",
                                                root / "prm/templates",
                                                root / "doc/user/examples"};
  for (const auto &entry :
       std::filesystem::directory_iterator(root / "examples"))
    if (entry.is_directory())
      folders.push_back(entry.path());
  std::vector<std::pair<std::filesystem::path, std::vector<std::string>>> files;
  for (const auto &folder : folders)
    for (const auto &entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".prm")
        {
          std::vector<std::string> settings;
          if (entry.path().filename() == "umat.prm")
            settings = {"Material sand/Library=" + build +
                        "/libraries/mohr_coulomb_cc.so"};
          if (entry.path().filename() == "plugin.prm")
            settings = {"Simulation/Additional shared libraries=" + build +
                        "/libraries/sponge.so"};
          files.emplace_back(entry.path(), settings);
        }
  std::sort(files.begin(), files.end());
  return files;
}
