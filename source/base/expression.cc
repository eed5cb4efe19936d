#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/expression.h>

#include <algorithm>
#include <muParser.h>

namespace greville
{
  using namespace dealii;

  class Expression::Parser
  {
  public:
    mu::Parser          parser;
    std::vector<double> values;
  };



  namespace
  {
    std::string
    list_of(const std::vector<std::string> &names)
    {
      std::string result;
      for (const std::string &name : names)
        result += (result.empty() ? "" : ", ") + name;
      return result;
    }
  } // namespace



  Expression::Expression(const std::string              &text,
                         const std::string              &parameter,
                         const std::vector<std::string> &variables,
                         const std::vector<Function>    &functions)
    : parser(std::make_unique<Parser>())
  {
    parser->values.assign(variables.size(), 0.);
    try
      {
        parser->parser.DefineConst("pi", numbers::PI);
        for (unsigned int i = 0; i < variables.size(); ++i)
          parser->parser.DefineVar(variables[i], &parser->values[i]);
        for (const Function &function : functions)
          parser->parser.DefineFun(function.name, function.function);
        parser->parser.SetExpr(text);
        parser->parser.Eval();
      }
    catch (const mu::ParserError &error)
      {
        AssertThrow(false,
                    ExcMessage("The expression <" + text +
                               "> of the parameter '" + parameter +
                               "' is no function of " + list_of(variables) +
                               ": " + error.GetMsg()));
      }
    catch (const ExceptionBase &error)
      {
        AssertThrow(false,
                    ExcMessage("The expression <" + text +
                               "> of the parameter '" + parameter +
                               "': " + message_of(error) + "."));
      }
  }

  Expression::Expression(Expression &&) noexcept = default;

  Expression &
  Expression::operator=(Expression &&) noexcept = default;

  Expression::~Expression() = default;



  double
  Expression::operator()(const ArrayView<const double> &values) const
  {
    AssertDimension(values.size(), parser->values.size());
    std::copy(values.begin(), values.end(), parser->values.begin());
    return parser->parser.Eval();
  }



  std::vector<Expression>
  make_expressions(const std::string              &text,
                   const std::string              &parameter,
                   const std::vector<std::string> &variables,
                   const unsigned int              n)
  {
    const auto parts = Utilities::split_string_list(text, ';');
    AssertThrow(parts.size() == n,
                ExcMessage("The parameter '" + parameter + "' takes " +
                           std::to_string(n) +
                           " expressions separated by semicolons, not <" +
                           text + ">."));
    std::vector<Expression> result;
    for (const std::string &part : parts)
      result.emplace_back(part, parameter, variables);
    return result;
  }
} // namespace greville
