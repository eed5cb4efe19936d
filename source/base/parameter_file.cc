// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>

#include <algorithm>
#include <boost/property_tree/json_parser.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The squares of larger numbers overflow, those of smaller ones vanish.
    constexpr double largest_number = 1e100, smallest_number = 1e-100;



    bool
    is_in_range(const double number)
    {
      return number == 0. || (std::abs(number) <= largest_number &&
                              std::abs(number) >= smallest_number);
    }



    std::ifstream
    open(const std::string &file)
    {
      AssertThrow(!file.empty(),
                  ExcMessage("The name of the parameter file is empty."));
      AssertThrow(!std::filesystem::is_directory(file),
                  ExcMessage("<" + file +
                             "> is a folder, not a parameter file."));
      AssertThrow(std::filesystem::exists(file),
                  ExcMessage("There is no parameter file <" + file + ">."));
      errno = 0;
      std::ifstream stream(file);
      AssertThrow(stream,
                  ExcMessage("The parameter file <" + file +
                             "> cannot be read: " + std::strerror(errno) +
                             "."));
      return stream;
    }



    /**
     * Whether @p line begins with the word @p key in small or capital letters,
     * which is cut off then.
     */
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
    read_lines(const std::string          &file,
               std::vector<std::string>   &sections,
               std::vector<ParameterLine> &result,
               std::set<std::string>      &all_sections,
               const unsigned int          n_includes)
    {
      std::ifstream stream = open(file);
      std::string   text, line;
      unsigned int  number = 0, first = 0;
      const auto    depth = sections.size();
      std::string   place;
      while (std::getline(stream, text))
        {
          ++number;
          text = text.substr(0, text.find('#'));
          std::replace(text.begin(), text.end(), '\t', ' ');
          text = Utilities::trim(text);
          if (line.empty())
            first = number;
          const bool goes_on = !text.empty() && text.back() == '\\';
          if (goes_on)
            text.pop_back();
          line += text;
          if (goes_on)
            continue;
          std::string words;
          words.swap(line);
          if (words.empty())
            continue;
          const std::string whole = words;
          place = "Line " + std::to_string(first) + " of <" + file + ">";
          const auto path = [&]() {
            std::string name;
            for (const std::string &section : sections)
              name += (name.empty() ? "" : "/") + section;
            return name;
          };
          if (take_word(words, "subsection"))
            {
              AssertThrow(!words.empty(),
                          ExcMessage(place +
                                     ": 'subsection' is without a name."));
              sections.push_back(words);
              all_sections.insert(path());
              // A section is known by its lines: one without any, too.
              result.push_back({path(), "", "", place});
            }
          else if (words == "end" || words == "END")
            {
              AssertThrow(sections.size() > depth,
                          ExcMessage(place + ": this 'end' ends no section."));
              sections.pop_back();
            }
          else if (take_word(words, "include"))
            {
              AssertThrow(n_includes < 20,
                          ExcMessage(place + ": files include each other."));
              read_lines(words, sections, result, all_sections, n_includes + 1);
            }
          else
            {
              const bool is_set = take_word(words, "set");
              const auto equal  = words.find('=');
              AssertThrow(is_set && equal != std::string::npos,
                          ExcMessage(
                            place + ": <" + whole +
                            "> is none of 'subsection NAME', 'set NAME = "
                            "VALUE' and 'end'."));
              result.push_back({path(),
                                Utilities::trim(words.substr(0, equal)),
                                Utilities::trim(words.substr(equal + 1)),
                                place});
            }
        }
      AssertThrow(line.empty(),
                  ExcMessage("The last line of <" + file +
                             "> ends with a backslash."));
      AssertThrow(sections.size() == depth,
                  ExcMessage("The section '" + sections.back() + "' of <" +
                             file + "> has no 'end'."));
    }
  } // namespace



  std::vector<ParameterLine>
  read_parameter_lines(const std::string              &file,
                       const std::string              &own_section,
                       const std::vector<std::string> &other_sections,
                       const std::string              &other)
  {
    std::vector<ParameterLine> result;
    std::vector<std::string>   sections;
    std::set<std::string>      all_sections;
    read_lines(file, sections, result, all_sections, 0);
    for (const std::string &section : other_sections)
      AssertThrow(all_sections.count(section) == 0 ||
                    all_sections.count(own_section) > 0,
                  ExcMessage("<" + file + "> is a file for the program " +
                             other + ": it has the section '" + section +
                             "', and no section '" + own_section + "'."));
    return result;
  }



  namespace
  {
    /**
     * Entries of a section by name, with the description of their pattern.
     */
    using Entries = std::map<std::string, std::string>;



    void
    collect(const boost::property_tree::ptree &tree,
            const std::string                 &section,
            std::map<std::string, Entries>    &result)
    {
      Entries &entries = result[section];
      for (const auto &child : tree)
        if (child.second.find("value") != child.second.not_found())
          entries[demangle(child.first)] =
            child.second.get<std::string>("pattern_description", "");
        else
          collect(child.second,
                  (section.empty() ? "" : section + "/") +
                    demangle(child.first),
                  result);
    }



    /**
     * The bounds of "[Double 0...1 (inclusive)]" as words.
     */
    std::string
    in_range(const std::string &description, const std::size_t begin)
    {
      const auto dots = description.find("...", begin);
      if (dots == std::string::npos)
        return "";
      const std::string low = description.substr(begin, dots - begin);
      const std::string high =
        description.substr(dots + 3,
                           description.find_first_of(" ]", dots) - dots - 3);
      const bool has_low = low.find("MAX") == std::string::npos &&
                           low.find("-2147483648") == std::string::npos;
      const bool has_high = high.find("MAX") == std::string::npos &&
                            high.find("2147483647") == std::string::npos &&
                            high.find("4294967295") == std::string::npos;
      if (has_low && has_high)
        return " between " + low + " and " + high;
      if (has_low)
        return std::stod(low) > 0. && std::stod(low) < 1e-200
                 ? " above zero"
                 : " of " + low + " or more";
      return has_high ? " of " + high + " or less" : "";
    }



    /**
     * deal.II's description of a pattern in words.
     */
    std::string
    in_words(const std::string &description)
    {
      const auto begins = [&](const std::string &word) {
        return description.compare(0, word.size(), word) == 0;
      };
      if (begins("[Selection "))
        return "one of " +
               Utilities::trim(description.substr(11, description.size() - 12));
      if (begins("[Double"))
        return "a number" + in_range(description, 8);
      if (begins("[Integer range "))
        return "a whole number" + in_range(description, 15);
      if (begins("[Integer"))
        return "a whole number";
      if (begins("[Bool"))
        return "true or false";
      if (begins("[List of <"))
        {
          const auto end = description.rfind("> of length ");
          const auto length =
            in_range(description, std::min(end, description.size()) + 12);
          return "a list, separated by commas, each entry " +
                 in_words(description.substr(10, end - 10)) +
                 (length.empty() ? "" : ", of a length" + length);
        }
      return description;
    }



    std::vector<std::string>
    words_of(const std::string &description)
    {
      const auto begin = description.find("[Selection ");
      if (begin == std::string::npos)
        return {};
      const auto end = description.find(']', begin);
      return Utilities::split_string_list(
        Utilities::trim(description.substr(begin + 11, end - begin - 11)), '|');
    }



    std::vector<std::string>
    names_of(const Entries &entries)
    {
      std::vector<std::string> names;
      for (const auto &entry : entries)
        names.push_back(entry.first);
      return names;
    }



    void
    check_line(const ParameterLine                  &line,
               const std::map<std::string, Entries> &sections)
    {
      const auto section = sections.find(line.section);
      if (section == sections.end())
        {
          std::vector<std::string> known;
          for (const auto &other : sections)
            known.push_back(other.first);
          AssertThrow(false,
                      ExcMessage(line.place + ": there is no section '" +
                                 line.section + "'." +
                                 did_you_mean(line.section, known)));
        }
      if (line.name.empty())
        return;
      const auto entry = section->second.find(line.name);
      if (entry == section->second.end())
        {
          std::string hint = did_you_mean(line.name, names_of(section->second));
          // Sections of sections come last.
          for (const bool is_inner : {false, true})
            for (const auto &other : sections)
              if (hint.empty() && other.second.count(line.name) > 0 &&
                  is_inner == (other.first.find('/') != std::string::npos))
                hint = " It belongs to the section '" + other.first + "'.";
          AssertThrow(false,
                      ExcMessage(
                        line.place +
                        (line.section.empty()
                           ? ": outside of all sections"
                           : ": in the section '" + line.section + "'") +
                        " there is no parameter '" + line.name + "'." + hint));
        }
      const std::string &description = entry->second;
      const std::string what = line.place + ": the parameter '" + line.section +
                               "/" + line.name + "' is <" + line.value + ">; ";
      // Blanks in a word are no letters: ParameterHandler takes them off.
      const auto pattern = Patterns::pattern_factory(description);
      if (!pattern->match(line.value))
        {
          std::string hint;
          for (const std::string &word :
               Utilities::split_string_list(line.value, ','))
            if (hint.empty())
              hint = did_you_mean(word, words_of(description));
          AssertThrow(false,
                      ExcMessage(what + "it has to be " +
                                 in_words(description) + "." + hint));
        }
      if (description.find("[Double") != std::string::npos)
        for (const std::string &word :
             Utilities::split_string_list(line.value, ','))
          AssertThrow(word.empty() ||
                        is_in_range(Utilities::string_to_double(word)),
                      ExcMessage(what + "numbers are zero, or between 1e-100 "
                                        "and 1e100 in size."));
    }
  } // namespace



  void
  check_parameter_lines(const ParameterHandler           &prm,
                        const std::vector<ParameterLine> &lines)
  {
    std::stringstream json;
    prm.print_parameters(json, ParameterHandler::JSON);
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(json, tree);
    std::map<std::string, Entries> sections;
    collect(tree, "", sections);
    for (const ParameterLine &line : lines)
      check_line(line, sections);
  }



  void
  check_word(const std::string &value,
             const std::string &parameter,
             const std::string &allowed)
  {
    const auto list = Utilities::split_string_list(allowed, '|');
    AssertThrow(std::count(list.begin(), list.end(), value) > 0,
                ExcMessage("The parameter '" + parameter + "' is <" + value +
                           ">; it has to be one of " + allowed + "." +
                           did_you_mean(value, list)));
  }



  void
  parse_parameter_file(ParameterHandler                 &prm,
                       const std::string                &file,
                       const std::vector<ParameterLine> &lines)
  {
    check_parameter_lines(prm, lines);
    prm.parse_input(file);
  }
} // namespace greville
