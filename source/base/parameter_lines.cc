// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/parameter_tree.h>
#include <greville/base/text_file.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    std::ifstream
    open(const std::string &file)
    {
      Require(!file.empty(), "The name of the parameter file is empty.");
      Require(!std::filesystem::is_directory(file),
              "<" + file + "> is a folder, not a parameter file.");
      Require(std::filesystem::exists(file),
              "There is no parameter file <" + file + ">.");
      errno = 0;
      std::ifstream stream =
        open_text_file(file, "Cannot read the parameter file <" + file + ">");
      Require(stream,
              "The parameter file <" + file +
                "> cannot be read: " + std::strerror(errno) + ".");
      return stream;
    }



    /// Return whether @p line begins with the word @p key in lower or upper
    /// case, and remove it.
    bool
    take_word(std::string &line, const std::string &key)
    {
      const std::string begin = line.substr(0, line.find(' '));
      std::string       capitals(key);
      std::transform(key.begin(), key.end(), capitals.begin(), ::toupper);
      if (begin != key && begin != capitals)
        return false;
      line = Utilities::trim(line.substr(key.size()));
      return true;
    }



    void
    read_lines(std::istream               &stream,
               const std::string          &file,
               std::vector<std::string>   &sections,
               std::vector<ParameterLine> &result,
               const unsigned int          n_includes)
    {
      std::string  text, line;
      unsigned int number = 0, first = 0;
      const auto   depth = sections.size();
      std::string  place;
      const auto add = [&](const std::string &name, const std::string &value) {
        const std::string section = boost::algorithm::join(sections, "/");
        result.push_back({section, name, value, place, sections, false});
      };
      while (read_text_line(stream, text, number))
        {
          text = text.substr(0, text.find('#'));
          std::replace(text.begin(), text.end(), '\t', ' ');
          text = Utilities::trim(text);
          if (line.empty())
            first = number;
          // Comments may contain any bytes.
          check_utf8(text,
                     "Line " + std::to_string(number) + " of <" + file + ">");
          const bool continues = !text.empty() && text.back() == '\\';
          if (continues)
            text.pop_back();
          line += text;
          if (continues)
            continue;
          std::string words;
          words.swap(line);
          if (words.empty())
            continue;
          const std::string whole = words;
          place = "Line " + std::to_string(first) + " of <" + file + ">";
          if (take_word(words, "subsection"))
            {
              Require(!words.empty(), place + ": 'subsection' has no name.");
              sections.push_back(words);
              // A section is known from its lines, so an empty one needs an
              // entry, too.
              add("", "");
            }
          else if (words == "end" || words == "END")
            {
              Require(sections.size() > depth,
                      place + ": this 'end' ends no section.");
              sections.pop_back();
            }
          else if (take_word(words, "include"))
            {
              Require(n_includes < 20, place + ": files include each other.");
              // The path is relative to the file, or to the folder of the run.
              const std::string beside =
                (std::filesystem::path(file).parent_path() / words).string();
              const std::string name =
                std::filesystem::exists(beside) ? beside : words;
              std::ifstream included = open(name);
              read_lines(included, name, sections, result, n_includes + 1);
            }
          else
            {
              const bool is_set = take_word(words, "set");
              const auto equal  = words.find('=');
              Require(is_set && equal != std::string::npos,
                      place + ": <" + whole +
                        "> is neither 'subsection NAME' nor 'set NAME = VALUE' "
                        "nor 'end'.");
              const std::string name = Utilities::trim(words.substr(0, equal));
              Require(!name.empty(),
                      place + ": the parameter of <" + whole +
                        "> has no name.");
              add(name, Utilities::trim(words.substr(equal + 1)));
            }
        }
      Require(line.empty(),
              "The last line of <" + file + "> ends with a backslash.");
      Require(sections.size() == depth,
              "The section '" + sections.back() + "' of <" + file +
                "> has no 'end'.");
    }

    /// Return a line from a setting of the command line. The section is one of
    /// @p lines, whose names may contain slashes, or is split at slashes.
    ParameterLine
    line_of(const std::string &setting, const std::vector<ParameterLine> &lines)
    {
      ParameterLine line;
      line.place      = "The option --set <" + setting + ">";
      line.is_setting = true;
      check_utf8(setting, "The option --set");
      const auto equal = setting.find('=');
      const auto slash = setting.substr(0, equal).rfind('/');
      Require(equal != std::string::npos && slash != std::string::npos,
              line.place + ": it takes the form \"SECTION/PARAMETER=VALUE\", "
                           "for instance \"Grid/Cells=40, 20\".");
      Require(setting.find_first_of("#\n") == std::string::npos,
              line.place + ": a value cannot contain '#' or a line break.");
      line.section = Utilities::trim(setting.substr(0, slash));
      line.name = Utilities::trim(setting.substr(slash + 1, equal - slash - 1));
      line.value = Utilities::trim(setting.substr(equal + 1));
      for (const ParameterLine &other : lines)
        if (other.section == line.section)
          line.path = other.path;
      if (line.path.empty())
        line.path = Utilities::split_string_list(line.section, '/');
      line.section = boost::algorithm::join(line.path, "/");
      Require(!line.section.empty() && !line.name.empty(),
              line.place +
                ": the name of the section or of the parameter is empty.");
      return line;
    }
  } // namespace



  std::vector<ParameterLine>
  parameter_lines_of(const std::string &text, const std::string &name)
  {
    std::vector<ParameterLine> result;
    std::vector<std::string>   sections;
    std::istringstream         stream(text);
    read_lines(stream, name, sections, result, 0);
    return result;
  }



  std::vector<ParameterLine>
  read_parameter_lines(const std::string              &file,
                       const std::string              &own_section,
                       const std::vector<std::string> &other_sections,
                       const std::string              &other,
                       const std::vector<std::string> &settings)
  {
    std::vector<ParameterLine> result;
    std::vector<std::string>   sections;
    std::ifstream              stream = open(file);
    if (is_parameter_tree(file))
      result = parameter_lines_of_tree(stream, file);
    else
      read_lines(stream, file, sections, result, 0);
    std::set<std::string> all_sections;
    for (const ParameterLine &line : result)
      all_sections.insert(line.section);
    for (const std::string &section : other_sections)
      Require(all_sections.count(section) == 0 ||
                all_sections.count(own_section) > 0,
              "<" + file + "> is a file for the program " + other +
                ": it has the section '" + section + "', but no section '" +
                own_section + "'.");
    for (const std::string &setting : settings)
      result.push_back(line_of(setting, result));
    return result;
  }
} // namespace greville
