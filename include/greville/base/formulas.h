// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_formulas_h
#define greville_base_formulas_h

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
   * Formulas of a parameter file with the same variables, read by muParser:
   * doc/user/formulas.md has the whole language. Assignments and commas outside
   * of the arguments of a function, which muParser allows, are refused.
   *
   * The named formulas that they use (NamedFormulas) are evaluated once per
   * place, and only if their variables have changed since the last place: a
   * named formula of t is evaluated once per step. Named formulas of variables
   * that are constant at each material point, such as its initial position,
   * can be precomputed.
   *
   * An object is not for several threads at a time.
   */
  class Formulas
  {
  public:
    /**
     * A function that formulas may call with any number of arguments besides
     * the ones of muParser.
     */
    struct Function
    {
      std::string name;
      double (*function)(const double *arguments, int n_arguments);
    };

    /**
     * The @p texts are formulas, each followed by the definitions that
     * NamedFormulas::attach() appends. Names that depend only on
     * @p constant_variables are those that can be precomputed.
     * Throws dealii::ExcMessage with the name of the @p parameter if a text is
     * no formula of @p variables.
     */
    Formulas(const std::vector<std::string> &texts,
             const std::string              &parameter,
             const std::vector<std::string> &variables,
             const std::vector<Function>    &functions          = {},
             const std::vector<std::string> &constant_variables = {});

    ~Formulas();

    /**
     * The value of formula number @p k for the @p values of the variables.
     * Throws dealii::ExcMessage, with the parameter and the values of the
     * variables, where it is not finite or above 1e100 in size.
     */
    double
    value(const unsigned int                     k,
          const dealii::ArrayView<const double> &values) const;

    /**
     * The values of all formulas. Throws as value().
     */
    void
    evaluate(const dealii::ArrayView<const double> &values,
             const dealii::ArrayView<double>       &results) const;

    /**
     * Likewise, with what precompute() has returned for this point.
     */
    void
    evaluate(const dealii::ArrayView<const double> &values,
             const dealii::ArrayView<const double> &precomputed,
             const dealii::ArrayView<double>       &results) const;

    /**
     * The number of values that precompute() returns.
     */
    unsigned int
    n_precomputed() const;

    /**
     * Return in @p precomputed the values of the names that depend only on
     * constant variables, if a formula or a name of other variables uses them.
     */
    void
    precompute(const dealii::ArrayView<const double> &values,
               const dealii::ArrayView<double>       &precomputed) const;

    /**
     * Return whether a formula, or a name that it uses, contains this variable.
     */
    bool
    depends_on(const std::string &variable) const;

    /**
     * The names of all functions and constants.
     */
    static std::vector<std::string>
    known_names();

  private:
    struct Formula;

    /**
     * Read the definitions behind a formula that it uses.
     */
    void
    define_names(const std::string &text);

    Formula
    read(const std::string              &text,
         const std::string              &its_parameter,
         const std::vector<std::string> &its_variables);

    double
    evaluate(const Formula &formula) const;

    /**
     * Evaluate formula number @p k, and throw where its value is none.
     */
    double
    checked_value(const unsigned int k) const;

    /**
     * Set the variables, and the names that depend on those that change;
     * @p precomputed may be null.
     */
    void
    set(const dealii::ArrayView<const double> &values,
        const double                          *precomputed) const;

    const std::string              parameter;
    const std::vector<std::string> variables;
    const std::vector<Function>    functions;
    const std::vector<std::string> constant_variables;

    std::vector<Formula> formulas;
    std::vector<Formula> names; // each after those that it uses

    // Of the variables and names; muParser has their addresses.
    mutable std::deque<double> numbers;
    // True if the names have values of earlier variables.
    mutable bool is_out_of_date = false;
  };



  /**
   * The words of a formula that can be names: those that begin with a letter or
   * an underscore.
   */
  std::vector<std::string>
  names_in_formula(const std::string &text);

  /**
   * The @p n formulas in @p text, which are separated by semicolons, each with
   * the definitions behind them (NamedFormulas::attach()). Throws
   * dealii::ExcMessage where there are not @p n of them.
   */
  std::vector<std::string>
  split_formulas(const std::string &text,
                 const std::string &parameter,
                 const unsigned int n);
} // namespace greville

#endif
