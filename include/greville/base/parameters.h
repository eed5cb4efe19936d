#ifndef greville_base_parameters_h
#define greville_base_parameters_h

#include <deal.II/base/function.h>

#include <memory>
#include <ostream>
#include <string>

namespace greville
{
  /**
   * Read a parameter file into all objects of dealii::ParameterAcceptor that
   * exist. Throws with the line, the name, the value and what is allowed where
   * the file is wrong.
   */
  void
  parse_parameter_file(const std::string &file);

  /**
   * Write all parameters of these objects as a page of Markdown: a table per
   * section with defaults, allowed values and meanings.
   */
  void
  print_parameter_reference(std::ostream &out, const std::string &program);

  /**
   * A function of x, y (and z) from its expression; a constant where the
   * expression is a number. @p name is the parameter that an error message
   * names.
   */
  template <int dim>
  std::unique_ptr<dealii::Function<dim>>
  make_function(const std::string &expression, const std::string &name);

  /**
   * Write a file under another name first and rename it at the end, so that no
   * half-written file is ever seen. The folder has to exist.
   */
  void
  write_atomically(const std::string &file, const std::string &content);
} // namespace greville

#endif
