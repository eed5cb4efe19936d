// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/array_view.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace mu
{
  class Parser;
}

namespace greville
{
  /**
   * Formulas of a parameter file with common variables, parsed by muParser: see
   * doc/user/formulas.md for the language. Assignments and commas outside the
   * arguments of a function, which muParser allows, are rejected.
   *
   * Named formulas in them (NamedFormulas) are evaluated once per place, and
   * only if their variables have changed since the last place: a named formula
   * of t is evaluated once per step. Named formulas of variables that are
   * constant at each material point, such as its initial position, can be
   * precomputed.
   *
   * An object is not thread-safe.
   */
  class Formulas
  {
  public:
    /// A function that formulas may call with any number of arguments, in
    /// addition to muParser's functions.
    struct Function
    {
      std::string name;
      double (*function)(const double *arguments, int n_arguments);
    };

    /// The @p texts are formulas, each followed by the definitions that
    /// NamedFormulas::attach() appends. Names that depend only on
    /// @p constant_variables can be precomputed. Throws dealii::ExcMessage with
    /// the name of the @p parameter if a text is not a formula of @p variables.
    Formulas(const std::vector<std::string> &texts,
             const std::string              &parameter,
             const std::vector<std::string> &variables,
             const std::vector<Function>    &functions          = {},
             const std::vector<std::string> &constant_variables = {});

    ~Formulas();

    /// Return the value of formula number @p k for the @p values of the
    /// variables. Throws dealii::ExcMessage with the parameter and the
    /// variables if the value is not finite or its magnitude exceeds 1e100.
    double
    value(const unsigned int                     k,
          const dealii::ArrayView<const double> &values) const;

    /// Compute the values of all formulas. Throws like value().
    void
    evaluate(const dealii::ArrayView<const double> &values,
             const dealii::ArrayView<double>       &results) const;

    /// Compute the values with the result of precompute() for this point.
    void
    evaluate(const dealii::ArrayView<const double> &values,
             const dealii::ArrayView<const double> &precomputed,
             const dealii::ArrayView<double>       &results) const;

    unsigned int
    n_precomputed() const;

    /// Return in @p precomputed the values of names of constant variables, as
    /// far as formulas or names of other variables use them.
    void
    precompute(const dealii::ArrayView<const double> &values,
               const dealii::ArrayView<double>       &precomputed) const;

    /// Return whether a formula, or a name that it uses, contains this
    /// variable.
    bool
    depends_on(const std::string &variable) const;

    /// Return the names of all functions and constants.
    static std::vector<std::string>
    known_names();

  private:
    struct Formula;

    /// Parse the definitions that follow a formula.
    void
    define_names(const std::string &text);

    Formula
    read(const std::string              &text,
         const std::string              &its_parameter,
         const std::vector<std::string> &its_variables);

    double
    evaluate(const Formula &formula) const;

    /// Evaluate formula number @p k, and throw if its value is invalid.
    double
    checked_value(const unsigned int k) const;

    /// Set the variables, and the names that depend on changed variables;
    /// @p precomputed may be null.
    void
    set(const dealii::ArrayView<const double> &values,
        const double                          *precomputed) const;

    const std::string              parameter;
    const std::vector<std::string> variables;
    const std::vector<Function>    functions;
    const std::vector<std::string> constant_variables;

    std::vector<Formula> formulas;
    std::vector<Formula> names; // each after the names that it uses

    // The values of the variables and names; muParser stores their addresses.
    mutable std::deque<double> numbers;
    // True if the values of names belong to earlier values of variables.
    mutable bool is_out_of_date = false;
  };



  /// Return the words of a formula that can be names: words that begin with a
  /// letter or an underscore.
  std::vector<std::string>
  names_in_formula(const std::string &text);

  /// Return the @p n formulas in @p text, which are separated by semicolons,
  /// each followed by its definitions (NamedFormulas::attach()). Throws
  /// dealii::ExcMessage if their number is not @p n.
  std::vector<std::string>
  split_formulas(const std::string &text,
                 const std::string &parameter,
                 const unsigned int n);
} // namespace greville
