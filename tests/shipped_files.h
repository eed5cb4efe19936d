// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_tests_shipped_files_h
#define greville_tests_shipped_files_h

// The shipped parameter files and the templates of 'greville --new', made small
// enough to run in a fraction of a second: coarse grids, three steps, no
// sweeps.

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
  /// Whether it is one of greville_benchmark.
  bool is_benchmark = false;
  /// The whole file, and what makes it small: later lines win.
  std::string content, small;
};



inline std::string
section_text(const std::string &section, const std::vector<std::string> &lines)
{
  std::string result = "subsection " + section + "\n";
  for (const std::string &line : lines)
    result += "  set " + line + "\n";
  return result + "end\n";
}



/**
 * @p source is the folder of the tests of a part; results go to @p results.
 * Files beside the parameter files keep their names: write the text into
 * @p folder, which is made with links to them.
 */
inline std::vector<ShippedFile>
shipped_files(const std::string &source,
              const std::string &folder,
              const std::string &results)
{
  const std::map<std::string, std::string> cells = {
    {"axis_aligned_mms_2d", "4, 4"},
    {"axis_aligned_mms_3d", "3, 3, 3"},
    {"bearing", "10, 10"},
    {"block_into_water", "24, 20"},
    {"bouncing_ball_3d", "8, 8, 8"},
    {"breaking_bar", "20, 5"},
    {"cantilever_3d", "5, 2, 1"},
    {"cattaneo_mindlin", "24, 24"},
    {"channel_flow", "5, 5"},
    {"colliding_disks", "10, 10"},
    {"colliding_disks_1994", "10, 10"},
    {"colliding_disks_reconstructed", "10, 10"},
    {"cone_in_clay", "12, 24"},
    {"cone_penetration", "8, 8, 12"},
    {"cone_penetration_axisymmetric", "10, 15"},
    {"cone_penetration_undrained", "10, 18"},
    {"cooks_membrane", "17, 28"},
    {"cryer", "10, 10"},
    {"dam_break", "20, 10"},
    {"dam_failure", "42, 12"},
    {"drawdown_slope", "44, 14"},
    {"elastic_block_2d", "10, 10"},
    {"elastic_block_3d", "6, 6, 6"},
    {"embankment", "30, 10"},
    {"excavation", "40, 21"},
    {"factor_of_safety", "44, 13"},
    {"gear_pair_3d", "22, 14, 1"},
    {"granular_collapse", "24, 6"},
    {"granular_column", "28, 12"},
    {"granular_column_3d", "7, 3, 7"},
    {"hertz_cylinder", "16, 20"},
    {"hertz_sphere_3d", "5, 5, 5"},
    {"hydrostatic_column", "1, 6"},
    {"landslide_barrier", "28, 12, 11"},
    {"large_strain_consolidation", "2, 18"},
    {"mandel", "18, 8"},
    {"mms_1d", "10, 1"},
    {"mud_flow", "40, 20"},
    {"notched_plate", "20, 10"},
    {"pit_with_wall", "40, 21"},
    {"pressurized_ring", "12, 12"},
    {"quasi_static_cut", "8, 4"},
    {"retaining_wall_rough", "25, 10"},
    {"rigid_footing", "20, 10"},
    {"rolling_ball_3d", "8, 8, 4"},
    {"round_footing", "15, 10"},
    {"rubber_gears", "22, 14, 1"},
    {"rubber_gear_3d", "10, 10, 2"},
    {"saturated_column_collapse", "24, 8"},
    {"seepage_dam", "20, 26"},
    {"slope", "45, 12"},
    {"slope_failure", "35, 11"},
    {"soil_column", "1, 8"},
    {"step_traction", "17, 1"},
    {"taylor_bar", "6, 21"},
    {"taylor_bar_friction", "5, 5, 21"},
    {"terzaghi", "2, 18"},
    {"thick_cylinder", "20, 4"},
    {"thick_sphere", "12, 12"},
    {"twisting_beam_3d", "15, 12, 12"},
    {"twisting_cylinder_3d", "8, 8, 1"},
    {"twisting_disk", "8, 8"},
    {"undrained_footing", "16, 8"},
    {"vertical_cut", "14, 5"},
    {"vibrating_bar", "8, 1"},
    {"vibrating_bar_free", "8, 8"},
    {"vibrating_bar_large", "8, 1"},
    {"weak_layer", "30, 10"}};
  const std::filesystem::path root =
    std::filesystem::path(source).parent_path().parent_path();
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
            // Files of examples include others, and name what those read.
            file.content = std::regex_replace(content.str(),
                                              std::regex(R"(\.\./\.\./)"),
                                              root.string() + "/");
            if (file.is_benchmark)
              file.small = section_text("Benchmark",
                                        {"Cells = 4",
                                         "Orders = 2",
                                         "Repetitions = 1",
                                         "Print times = false",
                                         "Output directory = " + results});
            else
              {
                const auto found = cells.find(file.name);
                file.small       = section_text("Time", {"Maximum steps = 3"}) +
                             section_text("Sweep",
                                          {"Cells =",
                                           "Orders =",
                                           "Formulations =",
                                           "Masses =",
                                           "Quadratures ="}) +
                             section_text("Output",
                                          {"Print times = false",
                                           "Statistics every = 0",
                                           "Directory = " + results});
                if (found != cells.end())
                  file.small +=
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



/**
 * The parameter files of greville as they are, those of the reference among
 * them, with the settings that name what users compile: it is in the tree
 * @p build.
 */
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

#endif
