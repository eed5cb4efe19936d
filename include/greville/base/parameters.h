// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_parameters_h
#define greville_base_parameters_h

#include <deal.II/base/function.h>
#include <deal.II/base/parameter_handler.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A line 'set NAME = VALUE' of a parameter file in its section.
   */
  struct ParameterLine
  {
    std::string section, name, value;
    /// "Line 7 of <FILE>".
    std::string place;
  };

  /**
   * The lines of a parameter file and of the files that it includes. Throws
   * dealii::ExcMessage where it cannot be read, with the line where it does not
   * have the form of a parameter file. A file with one of the sections of @p
   * other_sections but without the section @p own_section is one of the program
   * @p other.
   */
  std::vector<ParameterLine>
  read_parameter_lines(const std::string              &file,
                       const std::string              &own_section,
                       const std::vector<std::string> &other_sections,
                       const std::string              &other);

  /**
   * Throw dealii::ExcMessage with the line, the parameter, the value, what is
   * allowed and what may have been meant, where @p prm does not know a
   * parameter or does not allow its value.
   */
  void
  check_parameter_lines(const dealii::ParameterHandler   &prm,
                        const std::vector<ParameterLine> &lines);

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

  /**
   * Let @p parameters declare themselves in a section of @p prm. Their members
   * are the defaults, and take what is read into @p prm from then on: they have
   * to stay where they are until @p prm is gone.
   */
  template <typename Parameters>
  void
  declare_section(dealii::ParameterHandler &prm,
                  const std::string        &section,
                  Parameters               &parameters)
  {
    prm.enter_subsection(section);
    parameters.declare(prm);
    prm.leave_subsection();
  }

  /**
   * Read a parameter file into @p prm and what has been declared there. @p
   * lines are those of the file. Throws as check_parameter_lines().
   */
  void
  parse_parameter_file(dealii::ParameterHandler         &prm,
                       const std::string                &file,
                       const std::vector<ParameterLine> &lines);

  /**
   * The name that ParameterHandler writes as "Box_20size": "Box size".
   */
  std::string
  demangle(const std::string &name);

  /**
   * Write all parameters of @p prm as a page of Markdown: a table per section
   * with defaults, allowed values and meanings.
   */
  void
  print_parameter_reference(std::ostream                   &out,
                            const std::string              &program,
                            const dealii::ParameterHandler &prm);

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
