// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>

#include <greville/base/errors.h>
#include <greville/base/plugin.h>
#include <greville/base/shared_library.h>

#include <boost/algorithm/string/join.hpp>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * Throw if the plugin @p file was compiled for another build. The file is
     * read and not loaded: a plugin for Debug would load the other library of
     * deal.II, and the program would then abort at its end.
     */
    void
    check_build(const std::string &file, const std::string &parameter)
    {
      std::ifstream     stream(file, std::ios::binary);
      const std::string content{std::istreambuf_iterator<char>(stream), {}};
      // Other libraries are refused where they are loaded.
      if (content.find("register_in_greville") == std::string::npos)
        return;
      const std::string mark = GREVILLE_PLUGIN_MARK, build = GREVILLE_BUILD;
      const auto        found = content.find(mark);
      // The text ends with a zero.
      const std::string other =
        found == std::string::npos ? "" : content.c_str() + found + mark.size();
      AssertThrow(
        other == build,
        ExcMessage(
          "The parameter '" + parameter + "' is <" + file + ">, which " +
          (other.empty() ? "does not say for which build it was compiled. "
                           "Begin its function "
                           "with GREVILLE_PLUGIN (greville/base/plugin.h)"
                         : "was compiled for another build, <" + other + ">") +
          ". This program is <" + build +
          ">: compile the plugin with the headers and the compiler options of "
          "this program (-DCMAKE_BUILD_TYPE=" GREVILLE_BUILD_TYPE ")."));
    }
  } // namespace



  void *
  function_of_library(const std::string              &file,
                      const std::vector<std::string> &names,
                      const std::string              &parameter)
  {
    const std::string begin =
      "The parameter '" + parameter + "' is <" + file + ">, ";
    AssertThrow(std::filesystem::is_regular_file(file),
                ExcMessage(begin + "and there is no such file."));
    // Without a slash it would be looked for elsewhere.
    const std::string path    = std::filesystem::absolute(file).string();
    void *const       library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    AssertThrow(library != nullptr,
                ExcMessage(begin + "which cannot be loaded: " + dlerror() +
                           "."));
    for (const std::string &name : names)
      if (void *const function = dlsym(library, name.c_str()))
        return function;
    AssertThrow(false,
                ExcMessage(begin + "which has no function " +
                           boost::algorithm::join(names, " or ") + "."));
    return nullptr;
  }



  void
  load_plugin(const std::string &file, const std::string &parameter)
  {
    static std::set<std::string> loaded;
    if (std::filesystem::is_regular_file(file))
      check_build(file, parameter);
    void *const function =
      function_of_library(file, {"register_in_greville"}, parameter);
    if (loaded.insert(std::filesystem::canonical(file).string()).second)
      reinterpret_cast<void (*)()>(function)();
  }
} // namespace greville
