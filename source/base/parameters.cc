// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/base/parameters.h>

#include <boost/property_tree/json_parser.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  std::string
  demangle(const std::string &name)
  {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i)
      if (name[i] == '_' && i + 2 < name.size() && std::isxdigit(name[i + 1]) &&
          std::isxdigit(name[i + 2]))
        {
          result += char(std::stoi(name.substr(i + 1, 2), nullptr, 16));
          i += 2;
        }
      else
        result += name[i];
    return result;
  }



  namespace
  {
    /**
     * Parameters that go by several names: the one of the reference first.
     */
    const std::vector<std::vector<std::string>> names_of_parameters = {
      {"Order", "Degree"},
      {"Orders", "Degrees"},
      {"Young modulus", "Young's modulus", "Youngs modulus"},
      {"Poisson ratio", "Poisson's ratio", "Poissons ratio"},
      {"Poisson ratios", "Poisson's ratios", "Poissons ratios"}};
  } // namespace



  void
  declare_other_names(ParameterHandler &prm, const std::string &name)
  {
    for (const auto &names : names_of_parameters)
      if (names[0] == name)
        for (unsigned int k = 1; k < names.size(); ++k)
          prm.declare_alias(name, names[k]);
  }



  std::string
  main_name(const std::string &name)
  {
    for (const auto &names : names_of_parameters)
      for (const std::string &other : names)
        if (other == name)
          return names[0];
    return name;
  }



  namespace
  {
    std::string
    escape_for_table(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        result += (c == '|' ? "\\|" : std::string(1, c));
      return result;
    }



    /**
     * Parameter files cut into their outermost sections, which begin and end at
     * the begin of a line.
     */
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



    /**
     * The first of the outermost sections @p examples that has a section like
     * the one that the reference calls "Body NAME/Grid", or "Material NAME of
     * model bingham". Empty where there is none.
     */
    std::string
    example_of(const std::string              &section,
               const std::vector<std::string> &examples)
    {
      const auto        of = section.find(" of model ");
      const std::string model =
        of == std::string::npos ? "" : section.substr(of + 10);
      const std::regex name(
        std::regex_replace(section.substr(0, of), std::regex("NAME"), "[^/]+"));
      for (const std::string &example : examples)
        for (const ParameterLine &line : parameter_lines_of(example, section))
          if (std::regex_match(line.section, name) &&
              (model.empty() || (line.name == "Model" && line.value == model)))
            return example;
      return "";
    }



    void
    print_section(std::ostream                      &out,
                  const boost::property_tree::ptree &tree,
                  const std::string                 &section,
                  const std::vector<std::string>    &examples)
    {
      const auto value_of = [](const boost::property_tree::ptree &entry,
                               const char                        *key) {
        return entry.get<std::string>(key, "");
      };
      const auto alias_of = [&](const boost::property_tree::ptree &entry) {
        const auto found = entry.find("alias");
        return found != entry.not_found() && found->second.empty()
                 ? demangle(found->second.data())
                 : "";
      };
      std::map<std::string, std::string> other_names;
      for (const auto &child : tree)
        {
          std::string &names = other_names[alias_of(child.second)];
          names += (names.empty() ? "" : ", ") + demangle(child.first);
        }
      bool has_entries = false;
      for (const auto &child : tree)
        if (child.second.find("value") != child.second.not_found())
          {
            if (!has_entries)
              {
                const std::string example = example_of(section, examples);
                out << "## " << (section.empty() ? "General" : section)
                    << "\n\n"
                    << (example.empty() ? "" : "```prm\n" + example + "```\n\n")
                    << "| parameter | default | allowed | meaning |\n"
                    << "| --- | --- | --- | --- |\n";
              }
            has_entries = true;
            out << "| " << demangle(child.first) << " | `"
                << escape_for_table(value_of(child.second, "default_value"))
                << "` | "
                << escape_for_table(
                     value_of(child.second, "pattern_description"))
                << " | "
                << escape_for_table(value_of(child.second, "documentation"));
            const auto others = other_names.find(demangle(child.first));
            if (others != other_names.end())
              out << " Also called: " << others->second << '.';
            out << " |\n";
          }
      if (has_entries)
        out << '\n';
      for (const auto &child : tree)
        if (child.second.find("value") == child.second.not_found() &&
            alias_of(child.second).empty())
          print_section(out,
                        child.second,
                        (section.empty() ? "" : section + "/") +
                          demangle(child.first),
                        examples);
    }
  } // namespace



  void
  print_parameter_reference(std::ostream           &out,
                            const std::string      &program,
                            const ParameterHandler &prm,
                            const std::string      &examples)
  {
    std::stringstream json;
    prm.print_parameters(json, ParameterHandler::JSON);
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(json, tree);

    out << "# Parameters of " << program << "\n\n"
        << "Generated by `" << program << " --parameters`; a test compares "
        << "this page with the program.\n"
        << "A file has the form `subsection SECTION`, `set PARAMETER = VALUE`, "
        << "`end`, as the examples below have; text behind a `#` is a "
        << "comment.\n\n";
    print_section(out, tree, "", outermost_sections(examples));
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
    AssertThrow(!error,
                ExcMessage("Results cannot be written into the folder <" +
                           folder + "> of the parameter '" + parameter +
                           "': " + error.message() + "."));
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
      AssertThrow(out, ExcMessage(write_error(file)));
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    AssertThrow(!error,
                ExcMessage("Cannot write <" + file + ">: " + error.message() +
                           "."));
  }



  template decltype(make_function<2>) make_function<2>;
  template decltype(make_function<3>) make_function<3>;
} // namespace greville
