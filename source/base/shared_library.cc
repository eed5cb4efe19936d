// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>

#include <greville/base/errors.h>
#include <greville/base/foreign_call.h>
#include <greville/base/plugin.h>
#include <greville/base/shared_library.h>

#include <boost/algorithm/string/join.hpp>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits.h>
#include <link.h>
#include <locale>
#include <set>
#include <vector>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The time limit of the initializers of a library and of the function of a
    // plugin, s.
    constexpr double longest_load = 30.;
    const char      *late         = "does not return within 30 s";



    /// A call of a library's initializers or a plugin's function, by the
    /// library of a @p parameter.
    class LibraryCall : public ForeignCall
    {
    public:
      LibraryCall(const std::string &file,
                  const std::string &parameter,
                  const char        *does)
        : ForeignCall(longest_load)
        , file(file)
        , parameter(parameter)
        , does(does)
      {
        remember_library(file);
      }

      ~LibraryCall() override
      {
        // The library may have set a locale, but results need decimal points.
        if (std::locale() != locale)
          std::locale::global(locale);
        std::setlocale(LC_ALL, c_locale.c_str());
      }

      void
      write_message(char             *buffer,
                    const std::size_t size,
                    const char       *what) const override
      {
        std::snprintf(buffer,
                      size,
                      "the library of '%s' %s while it %s (<%s>)",
                      parameter.c_str(),
                      what,
                      does,
                      file.c_str());
      }

      const char *
      text_of_limit() const override
      {
        return late;
      }

    private:
      const std::string file, parameter;
      const char       *does;
      const std::locale locale;
      const std::string c_locale = std::setlocale(LC_ALL, nullptr);
    };



    /// Call a function of a library, and throw ExcMessage for any exception.
    void
    act(const LibraryCall &call, const std::function<void()> &action)
    {
      const auto fail = [&](const std::string &what) {
        std::vector<char> text(what.size() + 2 * PATH_MAX);
        call.write_message(text.data(), text.size(), what.c_str());
        Require(false, std::string(text.data()) + ".");
      };
      try
        {
          action();
        }
      catch (const ExceptionBase &)
        {
          throw;
        }
      catch (const std::exception &error)
        {
          fail("has thrown <" + std::string(error.what()) + ">");
        }
      catch (...)
        {
          fail("has thrown an exception");
        }
    }



    bool
    is_file(const std::string &file)
    {
      std::error_code none;
      return std::filesystem::is_regular_file(file, none);
    }



    std::string
    content_of(const std::string &file)
    {
      std::ifstream stream(file, std::ios::binary);
      return {std::istreambuf_iterator<char>(stream), {}};
    }



    /// Throw if a segment of the library with this @p content ends beyond the
    /// end of the file, as in a partial copy: loading it would end the program
    /// by a signal.
    void
    check_is_whole(const std::string &content, const std::string &begin)
    {
      ElfW(Ehdr) header;
      // Other files are refused on loading.
      if (content.size() < sizeof(header) ||
          content.compare(0, SELFMAG, ELFMAG) != 0)
        return;
      std::memcpy(&header, content.data(), sizeof(header));
      if (header.e_phentsize != sizeof(ElfW(Phdr)))
        return;
      for (std::size_t k = 0; k < header.e_phnum; ++k)
        {
          ElfW(Phdr) segment          = {};
          const std::size_t at        = header.e_phoff + k * sizeof(segment);
          const bool        has_entry = header.e_phoff <= content.size() &&
                                 at + sizeof(segment) <= content.size();
          if (has_entry)
            std::memcpy(&segment, content.data() + at, sizeof(segment));
          Require(has_entry && segment.p_offset <= content.size() &&
                    segment.p_filesz <= content.size() - segment.p_offset,
                  begin + "which is truncated: it ends before its segments do. "
                          "Build or copy it again.");
        }
    }



    std::set<std::string>
    loaded_dealii()
    {
      std::set<std::string> names;
      dl_iterate_phdr(
        [](dl_phdr_info *info, std::size_t, void *result) {
          const std::string name =
            std::filesystem::path(info->dlpi_name).filename().string();
          if (name.find("libdeal") == 0)
            static_cast<std::set<std::string> *>(result)->insert(name);
          return 0;
        },
        &names);
      return names;
    }



    /// Throw if the library with this @p content is linked with another library
    /// of deal.II than the program: two of them in one program destroy each
    /// other's objects at its end. The names of libraries are in the string
    /// table, each between zeros.
    void
    check_dealii(const std::string &content, const std::string &begin)
    {
      const std::set<std::string> loaded = loaded_dealii();
      const std::string           mark("\0libdeal", 8);
      for (auto at = content.find(mark); at != std::string::npos;
           at      = content.find(mark, at + 1))
        {
               const std::string other = content.c_str() + at + 1;
               Require(
            other.find(".so") == std::string::npos || loaded.count(other) > 0,
            begin + "which is linked with <" + other + ">. This program has <" +
              boost::algorithm::join(loaded, ">, <") +
              ">: link the library with the deal.II and the build type of this "
                   "program (-DCMAKE_BUILD_TYPE=" GREVILLE_BUILD_TYPE ").");
        }
    }



    /// Throw if the plugin with this @p content was compiled for another build.
    void
    check_build(const std::string &content, const std::string &begin)
    {
      // Other libraries are refused on loading.
      if (content.find("register_in_greville") == std::string::npos)
        return;
      const std::string mark = GREVILLE_PLUGIN_MARK, build = GREVILLE_BUILD;
      const auto        found = content.find(mark);
      // The text ends with a zero.
      const std::string other =
        found == std::string::npos ? "" : content.c_str() + found + mark.size();
      Require(
        other == build,
        begin + "which " +
          (other.empty()
             ? "does not say for which build it was compiled. Begin its "
               "function with GREVILLE_PLUGIN (greville/base/plugin.h)"
             : "was compiled for another build, <" + other + ">") +
          ". This program is <" + build +
          ">: compile the plugin with the headers and the compiler options of "
          "this program (-DCMAKE_BUILD_TYPE=" GREVILLE_BUILD_TYPE ").");
    }



    std::string
    begin_of_message(const std::string &file, const std::string &parameter)
    {
      return "The parameter '" + parameter + "' is <" + file + ">, ";
    }
  } // namespace



  void *
  function_of_library(const std::string              &file,
                      const std::vector<std::string> &names,
                      const std::string              &parameter)
  {
    const std::string begin = begin_of_message(file, parameter);
    Require(is_file(file), begin + "but there is no such file.");
    // Check the file before loading it, since a library stays loaded.
    const std::string content = content_of(file);
    check_is_whole(content, begin);
    check_dealii(content, begin);
    // dlopen() would search a name without a slash in other folders.
    const std::string path   = std::filesystem::absolute(file).string();
    void             *result = nullptr;
    ForeignCall::catch_faults(longest_load);
    {
      const LibraryCall under_way(file, parameter, "is loaded");
      act(under_way, [&]() {
        void *const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        Require(library != nullptr,
                begin + "which cannot be loaded: " + dlerror() + ".");
        for (const std::string &name : names)
          if (result == nullptr)
            result = dlsym(library, name.c_str());
      });
    }
    Require(result != nullptr,
            begin + "which has no function " +
              boost::algorithm::join(names, " or ") + ".");
    return result;
  }



  void
  load_plugin(const std::string &file, const std::string &parameter)
  {
    static std::set<std::string> loaded;
    if (is_file(file))
      check_build(content_of(file), begin_of_message(file, parameter));
    void *const function =
      function_of_library(file, {"register_in_greville"}, parameter);
    if (!loaded.insert(std::filesystem::canonical(file).string()).second)
      return;
    const LibraryCall under_way(file, parameter, "registers its parts");
    act(under_way, reinterpret_cast<void (*)()>(function));
  }
} // namespace greville
