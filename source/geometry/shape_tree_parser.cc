// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/geometry/level_set.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  /// A parser that reads a formula from outside to inside: first operators, the
  /// weakest first, then functions.
  template <int dim>
  class ShapeTree<dim>::Parser
  {
  public:
    Parser(const std::string &parameter, std::vector<LevelSet<dim>> &level_sets)
      : parameter(parameter)
      , level_sets(level_sets)
    {}

    /// @p formula may be followed by definitions of names (NamedFormulas).
    Node
    parse_formula(const std::string &formula)
    {
      const auto lines = Utilities::split_string_list(formula, '\n');
      for (unsigned int k = 1; k < lines.size(); ++k)
        {
          const auto equal = lines[k].find('=');
          named[Utilities::trim(lines[k].substr(0, equal))] =
            lines[k].substr(equal + 1);
        }
      definitions = formula.substr(formula_text(formula).size());
      return parse(formula_text(formula));
    }

  private:
    Node
    parse(const std::string &given)
    {
      const std::string text = without_parentheses(given);
      // A name in its own definition has no meaning.
      if (auto definition = named.extract(text))
        {
          const Node node = parse(definition.mapped());
          named.insert(std::move(definition));
          return node;
        }
      for (const auto &operators : {std::vector<std::string>{"|", "||"},
                                    std::vector<std::string>{"&", "&&"}})
        {
          const auto found = last_operator(text, operators);
          if (found.first != std::string::npos)
            {
              Node node;
              node.kind = found.second[0] == '|' ? Node::any_of : Node::all_of;
              node.children = {parse(text.substr(0, found.first)),
                               parse(text.substr(found.first +
                                                 found.second.size()))};
              return node;
            }
        }
      const auto compared = last_operator(text, comparisons());
      if (compared.first != std::string::npos)
        {
          const std::string left = text.substr(0, compared.first);
          const std::string right =
            text.substr(compared.first + compared.second.size());
          if (compared.second[1] == '=' && compared.second[0] != '<' &&
              compared.second[0] != '>')
            refuse(text);
          if (last_operator(left, comparisons()).first != std::string::npos ||
              last_operator(left, {"?"}).first != std::string::npos ||
              last_operator(right, {"?"}).first != std::string::npos)
            refuse(text);
          return compared.second[0] == '<'
                   ? formula("(" + left + ") - (" + right + ")")
                   : formula("(" + right + ") - (" + left + ")");
        }
      return parse_call(text);
    }

    static const std::vector<std::string> &
    comparisons()
    {
      static const std::vector<std::string> result = {
        "<", "<=", ">", ">=", "==", "!="};
      return result;
    }

    [[noreturn]] void
    refuse(const std::string &text) const
    {
      Require(false,
              "The parameter '" + parameter +
                "' has to define a surface, which fitted points, contacts and "
                "rigid bodies need: it takes shapes, comparisons f < g, "
                "level_set(f) with f negative inside, and their combinations "
                "by union(), intersection(), difference(), & and |. <" +
                text + "> is only true or false: replace it by one of these.");
      std::abort();
    }

    /// Remove spaces and parentheses around the whole text.
    static std::string
    without_parentheses(const std::string &given)
    {
      std::string text = Utilities::trim(given);
      while (text.size() > 1 && text[0] == '(' &&
             closing(text, 0) + 1 == text.size())
        text = Utilities::trim(text.substr(1, text.size() - 2));
      return text;
    }

    /// Return the position of the parenthesis that closes the one at @p begin.
    static std::size_t
    closing(const std::string &text, const std::size_t begin)
    {
      int depth = 0;
      for (std::size_t i = begin; i < text.size(); ++i)
        {
          depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
          if (depth == 0)
            return i;
        }
      return text.size();
    }

    /// Return the last of some operators outside parentheses, with its
    /// position.
    static std::pair<std::size_t, std::string>
    last_operator(const std::string              &text,
                  const std::vector<std::string> &operators)
    {
      std::pair<std::size_t, std::string> result = {std::string::npos, ""};
      for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == '(')
          i = closing(text, i);
        else if (std::string("|&<>=!?").find(text[i]) != std::string::npos)
          {
            std::string word(1, text[i]);
            if (i + 1 < text.size() &&
                (text[i + 1] == '=' ||
                 (text[i + 1] == text[i] && (word == "|" || word == "&"))))
              word += text[i + 1];
            if (contains(operators, word))
              result = {i, word};
            i += word.size() - 1;
          }
      return result;
    }

    Node
    parse_call(const std::string &text)
    {
      const std::size_t open = text.find('(');
      if (open == std::string::npos || closing(text, open) + 1 != text.size())
        refuse(text);
      const std::string name  = Utilities::trim(text.substr(0, open));
      const std::string inner = text.substr(open + 1, text.size() - open - 2);
      std::vector<std::string> arguments;
      for (std::size_t begin = 0, i = 0; i <= inner.size(); ++i)
        if (i == inner.size() || inner[i] == ',')
          {
            arguments.push_back(inner.substr(begin, i - begin));
            begin = i + 1;
          }
        else if (inner[i] == '(')
          i = closing(inner, i);

      Node node;
      if (name == "level_set")
        return formula(inner);
      if (name == "union" || name == "intersection" || name == "difference")
        {
          node.kind = name == "union" ? Node::any_of : Node::all_of;
          for (const std::string &argument : arguments)
            {
              node.children.push_back(parse(argument));
              if (name == "difference" && node.children.size() > 1)
                node.children.back().inverted = !node.children.back().inverted;
            }
          return node;
        }
      if (name == "half_space")
        {
          const auto     n = numbers_of(arguments);
          Tensor<1, dim> normal;
          for (unsigned int d = 0; d < dim; ++d)
            normal[d] = n[d];
          return plane(normal, n[dim]);
        }
      if (name == "box")
        {
          const auto n = numbers_of(arguments);
          node.kind    = Node::all_of;
          for (unsigned int d = 0; d < dim; ++d)
            for (const int side : {-1, 1})
              {
                Tensor<1, dim> normal;
                normal[d] = side;
                node.children.push_back(
                  plane(normal, side * n[side < 0 ? d : dim + d]));
              }
          return node;
        }
      if (name == "ball")
        {
          const auto    n = numbers_of(arguments);
          LevelSet<dim> ball;
          ball.kind = LevelSet<dim>::quadric;
          for (unsigned int d = 0; d < dim; ++d)
            ball.center[d] = n[d];
          ball.metric = unit_symmetric_tensor<dim>();
          ball.radius = n[dim];
          return leaf(ball);
        }
      if (name == "cylinder" && dim == 3)
        {
          const auto     n = numbers_of(arguments);
          LevelSet<dim>  mantle;
          Tensor<1, dim> axis;
          mantle.kind = LevelSet<dim>::quadric;
          for (unsigned int d = 0; d < dim; ++d)
            {
              mantle.center[d] = n[d];
              axis[d]          = n[dim + d] - n[d];
            }
          const double length = axis.norm();
          axis /= length;
          mantle.metric = unit_symmetric_tensor<dim>() -
                          symmetrize(outer_product(axis, axis));
          mantle.radius      = n[2 * dim];
          node.kind          = Node::all_of;
          const double begin = axis * mantle.center;
          node.children      = {leaf(mantle),
                                plane(-axis, -begin),
                                plane(axis, begin + length)};
          return node;
        }
      refuse(text);
    }

    std::vector<double>
    numbers_of(const std::vector<std::string> &arguments) const
    {
      std::vector<double> result;
      for (const std::string &argument : arguments)
        {
          const Expression expression(argument + definitions,
                                      parameter,
                                      coordinate_names<dim>());
          Point<dim>       one, other;
          for (unsigned int d = 0; d < dim; ++d)
            {
              one[d]   = 0.31 + d;
              other[d] = 7.13 - 3.7 * d;
            }
          const auto at = [&](const Point<dim> &x) {
            return expression(ArrayView<const double>(&x[0], dim));
          };
          Require(
            at(one) == at(other),
            "The parameter '" + parameter +
              "' has to define a surface, which fitted points, contacts and "
              "rigid bodies need: it takes shapes made of numbers only; <" +
              argument + "> depends on the position.");
          result.push_back(at(one));
        }
      return result;
    }

    Node
    plane(const Tensor<1, dim> &normal, const double offset)
    {
      LevelSet<dim> result;
      const double  norm     = normal.norm();
      result.as_plane.normal = normal / norm;
      result.as_plane.offset = offset / norm;
      // Make normals along axes exact, and store planes once that differ only
      // in their side.
      bool is_inverted = false;
      for (unsigned int d = 0; d < dim; ++d)
        if (1. - std::abs(result.as_plane.normal[d]) < 1e-15)
          {
            is_inverted               = result.as_plane.normal[d] < 0.;
            result.as_plane.normal    = 0.;
            result.as_plane.normal[d] = 1.;
            if (is_inverted)
              result.as_plane.offset = -result.as_plane.offset;
          }
      for (const LevelSet<dim> &other : level_sets)
        if (other.kind == LevelSet<dim>::plane &&
            other.as_plane.normal == -result.as_plane.normal &&
            other.as_plane.offset == -result.as_plane.offset)
          {
            is_inverted     = !is_inverted;
            result.as_plane = other.as_plane;
          }
      Node node     = leaf(result);
      node.inverted = is_inverted;
      return node;
    }

    /// Return whether a formula consists of coordinates, names of other
    /// formulas, numbers and arithmetic operators.
    bool
    has_no_calls(const std::string &text) const
    {
      std::string word;
      for (const char c : text + ' ')
        {
          if (c == '?' || c == '%')
            return false;
          if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
            word += c;
          else
            {
              const bool has_letter =
                std::any_of(word.begin(), word.end(), [](const char letter) {
                  return std::isalpha(static_cast<unsigned char>(letter)) &&
                         letter != 'x' && letter != 'y' && letter != 'z';
                });
              if (has_letter && named.count(word) == 0)
                return false;
              word.clear();
            }
        }
      return true;
    }

    /// Read a formula that is negative inside. Linear formulas become planes.
    Node
    formula(const std::string &text)
    {
      LevelSet<dim> result;
      result.kind = LevelSet<dim>::formula;
      result.text = text + definitions;
      result.expression.emplace(result.text,
                                parameter,
                                coordinate_names<dim>());
      // A formula without functions and conditions is linear if it is linear at
      // some points.
      bool is_polynomial = has_no_calls(text);
      for (const auto &definition : named)
        is_polynomial = is_polynomial && has_no_calls(definition.second);
      if (is_polynomial)
        {
          Tensor<1, dim> normal;
          Point<dim>     base; // no special point, such as zero
          for (unsigned int d = 0; d < dim; ++d)
            base[d] = 0.37 + 0.16 * d;
          const double at_base = result.value(base);
          for (unsigned int d = 0; d < dim; ++d)
            normal[d] =
              result.value(base + Point<dim>::unit_vector(d)) - at_base;
          bool is_linear = normal.norm() > 0.;
          for (unsigned int k = 1; k < 10; ++k)
            {
              Point<dim> x;
              double     size = std::abs(at_base);
              for (unsigned int d = 0; d < dim; ++d)
                {
                  x[d] = base[d] + 3. * std::sin(7. * k + 2.3 * d);
                  size += std::abs(normal[d] * x[d]);
                }
              is_linear =
                is_linear && std::abs(result.value(x) - at_base -
                                      normal * (x - base)) < 1e-13 * size;
            }
          if (is_linear)
            return plane(normal, normal * base - at_base);
        }
      return leaf(result);
    }

    Node
    leaf(const LevelSet<dim> &level_set)
    {
      Node node;
      node.level_set =
        std::find(level_sets.begin(), level_sets.end(), level_set) -
        level_sets.begin();
      if (node.level_set == level_sets.size())
        level_sets.push_back(level_set);
      return node;
    }

    std::string                        parameter;
    std::vector<LevelSet<dim>>        &level_sets;
    std::map<std::string, std::string> named;
    std::string                        definitions; // these as text
  };



  template <int dim>
  ShapeTree<dim>::ShapeTree(const std::string &formula,
                            const std::string &parameter)
  {
    root = Parser(parameter, all_level_sets).parse_formula(formula);
  }



  template ShapeTree<2>::ShapeTree(const std::string &, const std::string &);
  template ShapeTree<3>::ShapeTree(const std::string &, const std::string &);
} // namespace greville
