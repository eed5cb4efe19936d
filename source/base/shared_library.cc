// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>

#include <greville/base/errors.h>
#include <greville/base/shared_library.h>

#include <boost/algorithm/string/join.hpp>
#include <dlfcn.h>
#include <filesystem>
#include <set>

namespace greville
{
  using namespace dealii;

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
    void *const                  function =
      function_of_library(file, {"register_in_greville"}, parameter);
    if (loaded.insert(std::filesystem::canonical(file).string()).second)
      reinterpret_cast<void (*)()>(function)();
  }
} // namespace greville
