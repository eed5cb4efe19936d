// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/function.h>
#include <deal.II/base/parameter_handler.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace greville
{
  /// A line 'set NAME = VALUE' of a parameter file in its section, or a setting
  /// of the command line.
  struct ParameterLine
  {
    std::string section, name, value;
    /// "Line 7 of <FILE>".
    std::string place;
    /// The section, from the outermost to the innermost.
    std::vector<std::string> path;
    /// True if the line comes from the command line, which overrides files.
    bool is_setting = false;
  };

  /// Return the lines of a parameter file and of the files that it includes,
  /// followed by @p settings, each "SECTION/PARAMETER=VALUE" as on the command
  /// line. Throws dealii::ExcMessage if the file cannot be read, and, with the
  /// line or the setting, if one is malformed. A file with one of the sections
  /// of @p other_sections but without the section @p own_section is reported as
  /// a file for the program @p other.
  std::vector<ParameterLine>
  read_parameter_lines(const std::string              &file,
                       const std::string              &own_section,
                       const std::vector<std::string> &other_sections,
                       const std::string              &other,
                       const std::vector<std::string> &settings = {});

  /// Return the lines of the @p text of a parameter file named @p name.
  std::vector<ParameterLine>
  parameter_lines_of(const std::string &text, const std::string &name);

  /// A section, a parameter, or a value of a parameter that only older files
  /// have, and the advice for it.
  struct FormerParameter
  {
    /// "SECTION/" or "SECTION/PARAMETER"; sections of a stage count, too.
    std::string parameter;
    /// Empty for the section or the parameter as a whole.
    std::string value;
    std::string advice;
  };

  std::vector<std::string>
  names_in_section(const dealii::ParameterHandler &prm,
                   const std::string              &section);

  /// Throw dealii::ExcMessage if @p value is none of @p allowed, words that are
  /// separated by '|'.
  void
  check_word(const std::string &value,
             const std::string &parameter,
             const std::string &allowed);

  /// Throw dealii::ExcMessage, with the nearest known name, if @p value is none
  /// of @p known. The message describes these names as @p allowed.
  void
  check_known(const std::string              &value,
              const std::string              &parameter,
              const std::vector<std::string> &known,
              const std::string              &allowed);

  /**
   * Declare a parameter whose default is @p value, and which is read into @p
   * value:
   *   add_parameter(prm, "Area", area, Patterns::Double(0.))("What it is.");
   */
  template <typename T>
  auto
  add_parameter(dealii::ParameterHandler            &prm,
                const std::string                   &name,
                T                                   &value,
                const dealii::Patterns::PatternBase &pattern =
                  *dealii::Patterns::Tools::Convert<T>::to_pattern())
  {
    return [&](const std::string &text) {
      prm.add_parameter(name, value, text, pattern);
    };
  }

  /// Values of an enumeration and their words in parameter files.
  template <typename Enumeration>
  using Choices = std::vector<std::pair<Enumeration, std::string>>;

  template <typename Enumeration>
  std::string
  word_of(const Enumeration value, const Choices<Enumeration> &choices)
  {
    for (const auto &[choice, word] : choices)
      if (choice == value)
        return word;
    AssertThrow(false, dealii::ExcInternalError());
    return "";
  }

  /// Return all words, separated by '|'.
  template <typename Enumeration>
  std::string
  words_of(const Choices<Enumeration> &choices)
  {
    std::string words;
    for (const auto &[choice, word] : choices)
      words += (words.empty() ? "" : "|") + word;
    return words;
  }

  /// Return the value of a word. Throws dealii::ExcMessage if there is none.
  template <typename Enumeration>
  Enumeration
  value_of(const std::string &given, const Choices<Enumeration> &choices)
  {
    for (const auto &[choice, word] : choices)
      if (word == given)
        return choice;
    AssertThrow(false,
                dealii::ExcMessage("<" + given + "> is none of " +
                                   words_of(choices) + "."));
    return choices.front().first;
  }

  /// Declare a parameter that takes one of the words of an enumeration, as
  /// add_parameter() does.
  template <typename Enumeration>
  auto
  add_choice(dealii::ParameterHandler   &prm,
             const std::string          &name,
             Enumeration                &value,
             const Choices<Enumeration> &choices)
  {
    return [&prm, name, &value, choices](const std::string &text) {
      prm.declare_entry(name,
                        word_of(value, choices),
                        dealii::Patterns::Selection(words_of(choices)),
                        text);
      prm.add_action(name, [&value, choices](const std::string &given) {
        value = value_of(given, choices);
      });
    };
  }

  /// Let @p parameters declare themselves in a section of @p prm by
  /// declare(prm, arguments...). Their members are the defaults, and later
  /// receive the values read by @p prm. They must not move while @p prm exists.
  template <typename Parameters, typename... Arguments>
  void
  declare_section(dealii::ParameterHandler &prm,
                  const std::string        &section,
                  Parameters               &parameters,
                  const Arguments &...arguments)
  {
    prm.enter_subsection(section);
    parameters.declare(prm, arguments...);
    prm.leave_subsection();
  }

  /// Set the values of @p lines in @p prm, in which they have been declared.
  /// Throws dealii::ExcMessage with the line, the parameter, the value, the
  /// allowed values and a suggestion if @p prm does not have a parameter or
  /// does not allow its value. For a @p former parameter, this is its advice.
  void
  parse_parameter_lines(dealii::ParameterHandler           &prm,
                        const std::vector<ParameterLine>   &lines,
                        const std::vector<FormerParameter> &former = {});

  /// Set a parameter in the section with this path.
  void
  set_parameter(dealii::ParameterHandler       &prm,
                const std::vector<std::string> &path,
                const std::string              &name,
                const std::string              &value);

  /// A function that uses a reference: a ParameterHandler in which all
  /// parameters have been declared.
  using UseParameters =
    std::function<void(const dealii::ParameterHandler &prm)>;

  /// Return the words that a parameter, "Section/Parameter", may have as its
  /// value or in its list of values; empty if other values are allowed.
  std::vector<std::string>
  words_of_parameter(const dealii::ParameterHandler &prm,
                     const std::string              &parameter);

  /// Describe @p what: the parameters of a section, or a parameter
  /// "Section/Parameter". Throws dealii::ExcMessage, with the nearest name, if
  /// there is neither.
  void
  describe_parameter(std::ostream                   &out,
                     const dealii::ParameterHandler &prm,
                     const std::string              &what);

  /// Write all parameters of @p prm as a page of Markdown: a table per section
  /// with defaults, allowed values and meanings, preceded by the first similar
  /// section in the parameter files @p examples.
  void
  print_parameter_reference(std::ostream                   &out,
                            const std::string              &program,
                            const dealii::ParameterHandler &prm,
                            const std::string              &examples);

  /// Return a function of x, y (and z) from its expression; a constant if the
  /// expression is a number. @p name is the parameter for error messages.
  template <int dim>
  std::unique_ptr<dealii::Function<dim>>
  make_function(const std::string &expression, const std::string &name);

  /// Make a folder and its parents. Throws dealii::ExcMessage with the name of
  /// the @p parameter if it cannot be made or is not writable.
  void
  create_folder(const std::string &folder, const std::string &parameter);

  /// Return "Cannot write <FILE>: No space left on device." with the system's
  /// last error.
  std::string
  write_error(const std::string &file);

  /// Write a file under a temporary name and rename it at the end, so that no
  /// half-written file is ever visible. The folder must exist. Throws
  /// dealii::ExcMessage with the file if this fails.
  void
  write_atomically(const std::string &file, const std::string &content);
} // namespace greville
