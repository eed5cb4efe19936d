// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_parameters_h
#define greville_base_parameters_h

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
  /**
   * A line 'set NAME = VALUE' of a parameter file in its section, or a setting
   * of the command line.
   */
  struct ParameterLine
  {
    std::string section, name, value;
    /// "Line 7 of <FILE>".
    std::string place;
    /// The section from outside to inside.
    std::vector<std::string> path;
    /// Whether it comes from the command line, which has the last word.
    bool is_setting = false;
  };

  /**
   * The lines of a parameter file and of the files that it includes, and then
   * those of @p settings, each "SECTION/PARAMETER=VALUE" as it is given on the
   * command line. Throws dealii::ExcMessage where the file cannot be read, with
   * the line or the setting where it does not have the form of one. A file with
   * one of the sections of @p other_sections but without the section @p
   * own_section is one of the program @p other.
   */
  std::vector<ParameterLine>
  read_parameter_lines(const std::string              &file,
                       const std::string              &own_section,
                       const std::vector<std::string> &other_sections,
                       const std::string              &other,
                       const std::vector<std::string> &settings = {});

  /**
   * The lines of the @p text of a parameter file that is called @p name.
   */
  std::vector<ParameterLine>
  parameter_lines_of(const std::string &text, const std::string &name);

  /**
   * Throw dealii::ExcMessage with the line, the parameter, the value, what is
   * allowed and what may have been meant, where @p prm does not know a
   * parameter or does not allow its value.
   */
  void
  check_parameter_lines(const dealii::ParameterHandler   &prm,
                        const std::vector<ParameterLine> &lines);

  /**
   * The names of the parameters in an outer section.
   */
  std::vector<std::string>
  names_in_section(const dealii::ParameterHandler &prm,
                   const std::string              &section);

  /**
   * Throw dealii::ExcMessage if @p value is none of @p allowed, words that are
   * separated by '|'.
   */
  void
  check_word(const std::string &value,
             const std::string &parameter,
             const std::string &allowed);

  /**
   * Declare a parameter, whose default is the @p value, and which is read into
   * it:
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

  /**
   * The word of a @p value.
   */
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

  /**
   * Declare a parameter that takes one of the words of an enumeration, as
   * add_parameter() does.
   */
  template <typename Enumeration>
  auto
  add_choice(dealii::ParameterHandler   &prm,
             const std::string          &name,
             Enumeration                &value,
             const Choices<Enumeration> &choices)
  {
    return [&prm, name, &value, choices](const std::string &text) {
      std::string words;
      for (const auto &[choice, word] : choices)
        words += (words.empty() ? "" : "|") + word;
      prm.declare_entry(name,
                        word_of(value, choices),
                        dealii::Patterns::Selection(words),
                        text);
      prm.add_action(name, [&value, choices](const std::string &given) {
        for (const auto &[choice, word] : choices)
          if (word == given)
            value = choice;
      });
    };
  }

  /**
   * Let @p parameters declare themselves in a section of @p prm, by
   * declare(prm, arguments...). Their members
   * are the defaults, and take what is read into @p prm from then on: they have
   * to stay where they are until @p prm is gone.
   */
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

  /**
   * Set what @p lines say in @p prm, in which it has been declared. Throws as
   * check_parameter_lines().
   */
  void
  parse_parameter_lines(dealii::ParameterHandler         &prm,
                        const std::vector<ParameterLine> &lines);

  /**
   * Takes what a reference is about: a ParameterHandler in which all parameters
   * have been declared.
   */
  using UseParameters =
    std::function<void(const dealii::ParameterHandler &prm)>;

  /**
   * The words that a parameter, "Section/Parameter", may have as its value or
   * in its list of values. Empty where it takes others.
   */
  std::vector<std::string>
  words_of_parameter(const dealii::ParameterHandler &prm,
                     const std::string              &parameter);

  /**
   * Write what is known of @p what: the parameters of a section, or all of a
   * parameter, "Section/Parameter". Throws dealii::ExcMessage, with the nearest
   * name, where there is neither.
   */
  void
  describe_parameter(std::ostream                   &out,
                     const dealii::ParameterHandler &prm,
                     const std::string              &what);

  /**
   * The name that ParameterHandler writes as "Box_20size": "Box size".
   */
  std::string
  demangle(const std::string &name);

  /**
   * Write all parameters of @p prm as a page of Markdown: a table per section
   * with defaults, allowed values and meanings, and above it the first section
   * of the parameter files @p examples that is one like it.
   */
  void
  print_parameter_reference(std::ostream                   &out,
                            const std::string              &program,
                            const dealii::ParameterHandler &prm,
                            const std::string              &examples);

  /**
   * A function of x, y (and z) from its expression; a constant where the
   * expression is a number. @p name is the parameter that an error message
   * names.
   */
  template <int dim>
  std::unique_ptr<dealii::Function<dim>>
  make_function(const std::string &expression, const std::string &name);

  /**
   * Make a folder and those above it. Throws dealii::ExcMessage, which names
   * the @p parameter, where it cannot be made or nothing can be written there.
   */
  void
  create_folder(const std::string &folder, const std::string &parameter);

  /**
   * "Cannot write <FILE>: No space left on device." with the last error of the
   * system.
   */
  std::string
  write_error(const std::string &file);

  /**
   * Write a file under another name first and rename it at the end, so that no
   * half-written file is ever seen. The folder has to exist. Throws
   * dealii::ExcMessage with the file where that fails.
   */
  void
  write_atomically(const std::string &file, const std::string &content);
} // namespace greville

#endif
