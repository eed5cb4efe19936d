// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/base/parameter_tree.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/property_tree/ptree.hpp>
#include <cmath>
#include <cstdlib>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The squares of larger numbers overflow, the squares of smaller numbers
    // vanish.
    constexpr double largest_number = 1e100, smallest_number = 1e-100;



    bool
    is_in_range(const double number)
    {
      return number == 0. || (std::abs(number) <= largest_number &&
                              std::abs(number) >= smallest_number);
    }



    /// ParameterHandler's description of a parameter.
    struct Entry
    {
      std::string default_value, pattern, documentation;
    };

    using Entries = std::map<std::string, Entry>;



    std::map<std::string, Entries>
    sections_of(const ParameterHandler &prm)
    {
      std::map<std::string, Entries> sections = {{"", {}}};
      for_each_parameter(
        prm, [&](const auto &path, const auto &name, const auto &entry) {
          // Outer sections may have no parameters of their own.
          for (auto outer = path; !outer.empty(); outer.pop_back())
            sections[boost::algorithm::join(outer, "/")];
          sections[boost::algorithm::join(path, "/")][name] = {
            entry.get("default_value", ""),
            entry.get("pattern_description", ""),
            entry.get("documentation", "")};
        });
      return sections;
    }



    /// Describe the bounds of "[Double 0...1 (inclusive)]" in words.
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



    /// Describe deal.II's pattern in words.
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
      if (description == FormulaPattern::name)
        return "formulas";
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



    /// Return the advice for a line with this value, or for the section or the
    /// parameter of the line if the value is empty; empty if there is none.
    std::string
    advice_for(const ParameterLine                &line,
               const std::string                  &value,
               const std::vector<FormerParameter> &former)
    {
      const std::string name = line.section + "/" + line.name;
      for (const FormerParameter &entry : former)
        {
          const auto begin = name.find(entry.parameter);
          if (begin != std::string::npos &&
              (begin == 0 || name[begin - 1] == '/') && entry.value == value)
            return entry.advice;
        }
      return "";
    }



    void
    check_line(const ParameterLine                  &line,
               const std::map<std::string, Entries> &sections,
               const std::vector<FormerParameter>   &former)
    {
      const auto section = sections.find(line.section);
      if (section == sections.end())
        {
          const std::string advice = advice_for(line, "", former);
          Require(advice.empty(),
                  line.place + ": the section '" + line.section +
                    "' no longer exists. " + advice);
          Require(false,
                  line.place + ": there is no section '" + line.section + "'." +
                    did_you_mean(line.section, keys_of(sections)));
        }
      if (line.name.empty())
        return;
      const auto entry = section->second.find(line.name);
      if (entry == section->second.end())
        {
          const std::string advice = advice_for(line, "", former);
          Require(advice.empty(),
                  line.place + ": the parameter '" + line.section + "/" +
                    line.name + "' no longer exists. " + advice);
          std::string hint = did_you_mean(line.name, keys_of(section->second));
          // Subsections come last.
          for (const bool is_inner : {false, true})
            for (const auto &other : sections)
              if (hint.empty() && other.second.count(line.name) > 0 &&
                  is_inner == (other.first.find('/') != std::string::npos))
                hint = " It belongs to the section '" + other.first + "'.";
          Require(false,
                  line.place +
                    (line.section.empty()
                       ? ": outside of all sections"
                       : ": in the section '" + line.section + "'") +
                    " there is no parameter '" + line.name + "'." + hint);
        }
      const std::string &description = entry->second.pattern;
      const std::string what = line.place + ": the parameter '" + line.section +
                               "/" + line.name + "' is <" + line.value + ">; ";
      if (description == FormulaPattern::name)
        return;
      // Blanks around a word are ignored: ParameterHandler removes them.
      const auto pattern = Patterns::pattern_factory(description);
      if (!pattern->match(line.value))
        {
          std::string hint = advice_for(line, line.value, former);
          if (!hint.empty())
            hint = " " + hint;
          for (const std::string &word :
               Utilities::split_string_list(line.value, ','))
            if (hint.empty())
              hint = did_you_mean(word, words_of(description));
          Require(false,
                  what + "it has to be " + in_words(description) + "." + hint);
        }
      if (description.find("[Double") != std::string::npos)
        for (const std::string &word :
             Utilities::split_string_list(line.value, ','))
          // Utilities::string_to_double() throws at numbers below 2e-308.
          Require(word.empty() ||
                    is_in_range(std::strtod(word.c_str(), nullptr)),
                  what +
                    "numbers are zero, or between 1e-100 and 1e100 in size.");
    }
  } // namespace



  void
  check_word(const std::string &value,
             const std::string &parameter,
             const std::string &allowed)
  {
    check_known(value,
                parameter,
                Utilities::split_string_list(allowed, '|'),
                allowed);
  }



  void
  check_known(const std::string              &value,
              const std::string              &parameter,
              const std::vector<std::string> &known,
              const std::string              &allowed)
  {
    Require(contains(known, value),
            "The parameter '" + parameter + "' is <" + value +
              ">; it has to be one of " + allowed + "." +
              did_you_mean(value, known));
  }



  void
  set_parameter(ParameterHandler               &prm,
                const std::vector<std::string> &path,
                const std::string              &name,
                const std::string              &value)
  {
    for (const std::string &section : path)
      prm.enter_subsection(section);
    prm.set(name, value);
    for (unsigned int k = 0; k < path.size(); ++k)
      prm.leave_subsection();
  }



  void
  parse_parameter_lines(ParameterHandler                   &prm,
                        const std::vector<ParameterLine>   &lines,
                        const std::vector<FormerParameter> &former)
  {
    const auto sections = sections_of(prm);
    for (const ParameterLine &line : lines)
      check_line(line, sections, former);
    for (const ParameterLine &line : lines)
      if (!line.name.empty())
        set_parameter(prm, line.path, line.name, line.value);
  }



  std::vector<std::string>
  names_in_section(const ParameterHandler &prm, const std::string &section)
  {
    auto sections = sections_of(prm);
    return keys_of(sections[section]);
  }



  std::vector<std::string>
  words_of_parameter(const ParameterHandler &prm, const std::string &parameter)
  {
    const auto        slash   = parameter.rfind('/');
    const std::string pattern = sections_of(prm)
                                  .at(parameter.substr(0, slash))
                                  .at(parameter.substr(slash + 1))
                                  .pattern;
    std::vector<std::string> words;
    for (const std::string &word : words_of(pattern))
      if (!word.empty())
        words.push_back(word);
    return words;
  }



  namespace
  {
    /// Return " Did you mean <Contact NAME>?" for "contact" and "Contact base",
    /// otherwise the result of did_you_mean().
    std::string
    hint_for_section(const std::string              &section,
                     const std::vector<std::string> &known)
    {
      for (const std::string &name : known)
        if (boost::algorithm::ends_with(name, " NAME") &&
            boost::algorithm::istarts_with(section + " ",
                                           name.substr(0, name.size() - 4)))
          return " Did you mean <" + name + ">?";
      return did_you_mean(section, known);
    }
  } // namespace



  void
  describe_parameter(std::ostream           &out,
                     const ParameterHandler &prm,
                     const std::string      &what)
  {
    auto sections = sections_of(prm);
    sections.erase("");
    const auto section = sections.find(what);
    if (section != sections.end())
      {
        for (const auto &entry : section->second)
          out << entry.first << '\n';
        return;
      }
    const auto slash = what.rfind('/');
    const auto place =
      sections.find(what.substr(0, slash == std::string::npos ? 0 : slash));
    Require(place != sections.end(),
            "There is nothing to list under the name <" + what +
              ">: it is neither a section nor a parameter of the form "
              "SECTION/PARAMETER." +
              hint_for_section(what.substr(0, slash), keys_of(sections)));
    const std::string name  = what.substr(slash + 1);
    const auto        entry = place->second.find(name);
    Require(entry != place->second.end(),
            "In the section '" + place->first + "' there is no parameter '" +
              name + "'." + did_you_mean(name, keys_of(place->second)));
    out << what << '\n'
        << "  default: " << entry->second.default_value << '\n'
        << "  allowed: " << in_words(entry->second.pattern) << '\n'
        << "  " << entry->second.documentation << '\n';
  }
} // namespace greville
