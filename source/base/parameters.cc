// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/base/parameter_tree.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <boost/property_tree/ptree.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the outermost sections of parameter files, which begin and end at
    /// the beginning of a line.
    std::vector<std::string>
    outermost_sections(const std::string &files)
    {
      std::vector<std::string> result;
      bool                     is_inside = false;
      std::istringstream       lines(files);
      for (std::string line; std::getline(lines, line);)
        {
          if (line.compare(0, 11, "subsection ") == 0)
            {
              is_inside = true;
              result.emplace_back();
            }
          if (is_inside)
            result.back() += line + '\n';
          is_inside = is_inside && line != "end";
        }
      return result;
    }



    /// A section of the reference for one value of one of its parameters:
    /// "Material NAME of model bingham" has the section "Material NAME" with
    /// Model = bingham. The value is empty for other sections.
    struct Variant
    {
      explicit Variant(const std::string &name)
        : section(name)
      {
        std::smatch match;
        if (!std::regex_match(name,
                              match,
                              std::regex("(.*) of (model|kind) (.*)")))
          return;
        section   = match[1];
        parameter = match[2] == "model" ? "Model" : "Kind";
        value     = match[3];
      }

      std::string section, parameter, value;
    };



    /// Return the first of the outermost sections @p examples that has a
    /// section like the one that the reference calls "Body NAME/Grid", or
    /// "Material NAME of model bingham"; empty if there is none.
    std::string
    example_of(const std::string              &section,
               const std::vector<std::string> &examples)
    {
      const Variant    variant(section);
      const std::regex name(
        std::regex_replace(variant.section, std::regex("NAME"), "[^/]+"));
      for (const std::string &example : examples)
        for (const ParameterLine &line : parameter_lines_of(example, section))
          if (std::regex_match(line.section, name) &&
              (variant.value.empty() ||
               (line.name == variant.parameter && line.value == variant.value)))
            return example;
      return "";
    }



    /// Return whether the reference describes two parameters identically.
    bool
    are_equal(const boost::property_tree::ptree &a,
              const boost::property_tree::ptree &b)
    {
      for (const char *key :
           {"default_value", "pattern_description", "documentation"})
        if (a.get<std::string>(key, "") != b.get<std::string>(key, ""))
          return false;
      return true;
    }



    /// Move parameters that all variants of a section share to the section.
    void
    move_shared_parameters(boost::property_tree::ptree &tree)
    {
      std::map<std::string, std::vector<boost::property_tree::ptree *>>
        variants;
      for (auto &child : tree)
        {
          const Variant variant(child.first);
          if (!variant.value.empty())
            variants[variant.section].push_back(&child.second);
        }
      for (auto &child : tree)
        {
          const auto sections = variants.find(child.first);
          if (sections == variants.end())
            continue;
          const boost::property_tree::ptree first = *sections->second.front();
          for (const auto &entry : first)
            if (std::all_of(sections->second.begin(),
                            sections->second.end(),
                            [&](const auto *section) {
                              const auto found = section->find(entry.first);
                              return found != section->not_found() &&
                                     are_equal(found->second, entry.second);
                            }))
              {
                child.second.push_back(entry);
                for (auto *section : sections->second)
                  section->erase(entry.first);
              }
        }
    }



    /// For rows of a variant of a section, the first variant with these rows.
    using RowsOfVariants = std::map<std::string, std::string>;



    /// Remove from @p rows the rows that another variant of the @p section has.
    /// Return a sentence that says where they are.
    std::string
    take_repeated(std::vector<std::pair<std::string, std::string>> &rows,
                  const std::string                                &section,
                  RowsOfVariants                                   &printed)
    {
      const Variant                                   variant(section);
      std::map<std::string, std::vector<std::string>> repeated;
      for (auto row = rows.begin(); row != rows.end();)
        {
          const auto [first, is_new] =
            printed.emplace(variant.section + row->first + row->second,
                            variant.value);
          if (!is_new)
            repeated[first->second].push_back('`' + row->first + '`');
          row = is_new ? row + 1 : rows.erase(row);
        }
      std::string result;
      for (const auto &[value, names] : repeated)
        result += boost::algorithm::join(names, ", ") + ": see " +
                  variant.parameter + " = " + value + ".\n";
      return result;
    }



    void
    print_section(std::ostream                      &out,
                  const boost::property_tree::ptree &tree,
                  const std::string                 &section,
                  const std::vector<std::string>    &examples,
                  RowsOfVariants                    &printed)
    {
      const auto value_of = [](const boost::property_tree::ptree &entry,
                               const char                        *key) {
        return boost::algorithm::replace_all_copy(
          entry.get<std::string>(key, ""), "|", "\\|");
      };
      // Parameters with the same description share a row, for instance the
      // parameters of the sides of a grid.
      std::vector<std::pair<std::string, std::string>> rows;
      for (const auto &child : tree)
        if (child.second.find("value") != child.second.not_found())
          {
            // Doxygen cannot read an empty pair of backquotes.
            const std::string value = value_of(child.second, "default_value");
            const std::string text =
              (value.empty() ? " |" : " | `" + value + '`') + " | " +
              value_of(child.second, "pattern_description") + " | " +
              value_of(child.second, "documentation");
            const auto row =
              std::find_if(rows.begin(), rows.end(), [&](const auto &other) {
                return other.second == text;
              });
            if (row == rows.end())
              rows.emplace_back(child.first, text);
            else
              row->first += ", " + child.first;
          }
      if (!rows.empty())
        {
          const std::string example = example_of(section, examples);
          const std::string others  = Variant(section).value.empty()
                                        ? ""
                                        : take_repeated(rows, section, printed);
          out << "## " << (section.empty() ? "General" : section) << "\n\n"
              << (example.empty() ? "" : "```prm\n" + example + "```\n\n");
          if (!rows.empty())
            out << "| parameter | default | allowed | meaning |\n"
                << "| --- | --- | --- | --- |\n";
          for (const auto &[names, text] : rows)
            out << "| " << names << text << " |\n";
          out << (rows.empty() || others.empty() ? "" : "\n") << others << '\n';
        }
      for (const auto &child : tree)
        if (child.second.find("value") == child.second.not_found())
          print_section(out,
                        child.second,
                        (section.empty() ? "" : section + "/") + child.first,
                        examples,
                        printed);
    }
  } // namespace



  void
  print_parameter_reference(std::ostream           &out,
                            const std::string      &program,
                            const ParameterHandler &prm,
                            const std::string      &examples)
  {
    boost::property_tree::ptree tree = tree_of(prm);
    move_shared_parameters(tree);

    out << "# Parameters of " << program << "\n\n"
        << "Generated by `" << program << " --parameters`; a test compares "
        << "this page with the program.\n"
        << "A file has the form `subsection SECTION`, `set PARAMETER = VALUE`, "
        << "`end`, as the examples below have; text behind a `#` is a "
        << "comment.\n\n";
    RowsOfVariants printed;
    print_section(out, tree, "", outermost_sections(examples), printed);
  }



  template <int dim>
  std::unique_ptr<Function<dim>>
  make_function(const std::string &expression, const std::string &name)
  {
    try
      {
        std::size_t  n_read;
        const double value = std::stod(expression, &n_read);
        if (expression.find_first_not_of(" \t", n_read) == std::string::npos &&
            std::abs(value) < 1e100)
          return std::make_unique<Functions::ConstantFunction<dim>>(value);
      }
    catch (const std::exception &)
      {}
    return std::make_unique<ScalarFunctionFromFunctionObject<dim>>(
      [formula = Expression(expression, name, coordinate_names<dim>())](
        const Point<dim> &x) {
        return formula(ArrayView<const double>(&x[0], dim));
      });
  }



  void
  create_folder(const std::string &folder, const std::string &parameter)
  {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && !std::filesystem::is_directory(folder))
      error = std::make_error_code(std::errc::not_a_directory);
    if (!error && access(folder.c_str(), W_OK | X_OK) != 0)
      error = std::error_code(errno, std::generic_category());
    Require(!error,
            "Results cannot be written into the folder <" + folder +
              "> of the parameter '" + parameter + "': " + error.message() +
              ".");
  }



  std::string
  write_error(const std::string &file)
  {
    return "Cannot write <" + file + ">" +
           (errno != 0 ? std::string(": ") + std::strerror(errno) : "") + ".";
  }



  void
  write_atomically(const std::string &file, const std::string &content)
  {
    const std::string temporary = file + ".tmp";
    {
      errno = 0;
      std::ofstream out(temporary);
      out << content;
      out.close();
      Require(out, write_error(file));
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    Require(!error, "Cannot write <" + file + ">: " + error.message() + ".");
  }



  template decltype(make_function<2>) make_function<2>;
  template decltype(make_function<3>) make_function<3>;
} // namespace greville
