// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/contact/friction_law.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Friction of surfaces that do not slide in contact.
    class RoughFriction : public FrictionLaw
    {
    public:
      static std::unique_ptr<const FrictionLaw>
      make(const std::vector<double> &numbers)
      {
        Require(numbers.empty(), "it takes no numbers.");
        return std::make_unique<RoughFriction>();
      }

      double
      strength(const double, const double) const override
      {
        return std::numeric_limits<double>::infinity();
      }

      bool
      is_symmetric() const override
      {
        return true;
      }
    };



    /// Friction with a coefficient that depends on pressure and speed.
    class FormulaFriction : public FrictionLaw
    {
    public:
      FormulaFriction(const std::string &text, const std::string &parameter)
        : mu(text, parameter, {"p", "v"})
      {
        const double first = coefficient(1., 0.);
        Require(
          first >= 0.,
          "The formula <" + text + "> of the parameter '" + parameter +
            "' is " + text_of(first) +
            " at p = 1, v = 0: a coefficient of friction is not negative.");
        // Find undefined values before the first contact.
        for (const double pressure : {0., 1., 1e6})
          for (const double speed : {0., 1e-3, 10.})
            strength(pressure, speed);
      }

      double
      strength(const double pressure, const double speed) const override
      {
        return pressure * std::max(0., coefficient(pressure, speed));
      }

    private:
      double
      coefficient(const double pressure, const double speed) const
      {
        return mu(std::array<double, 2>{{pressure, speed}});
      }

      Expression mu;
    };



    // The list of all named laws, one line each.
    std::map<std::string, MakeFrictionLaw> &
    laws()
    {
      static std::map<std::string, MakeFrictionLaw> list = {
        {"rough", RoughFriction::make}};
      return list;
    }
  } // namespace



  FrictionLaw::Slopes
  FrictionLaw::slopes(const double pressure, const double speed) const
  {
    const double dp    = 1e-5 * pressure;
    const double above = speed + 1e-5 * speed + 1e-9;
    const double below = std::max(0., speed - 1e-5 * speed);
    return {(strength(pressure + dp, speed) - strength(pressure - dp, speed)) /
              (2. * dp),
            (strength(pressure, above) - strength(pressure, below)) /
              (above - below)};
  }



  bool
  add_friction_law(const std::string &name, const MakeFrictionLaw &make)
  {
    laws()[name] = make;
    return true;
  }



  std::unique_ptr<const FrictionLaw>
  make_friction_law(const std::string &text, const std::string &parameter)
  {
    const std::string what =
      "The parameter '" + parameter + "' is <" + text + ">";
    const auto        open = text.find('(');
    const std::string name = Utilities::trim(text.substr(0, open));
    const auto        law  = laws().find(name);
    if (law == laws().end())
      {
        double mu = -1.;
        try
          {
            mu = Utilities::string_to_double(text);
          }
        catch (const std::exception &)
          {
            return std::make_unique<FormulaFriction>(text, parameter);
          }
        Require(mu >= 0. && std::isfinite(mu),
                what + "; it has to be rough, a nonnegative number, or a "
                       "formula of p and v.");
        return std::make_unique<CoulombFriction>(mu);
      }
    try
      {
        std::vector<double> numbers;
        if (open != std::string::npos)
          {
            Require(text.back() == ')', "there is no ')' at its end.");
            numbers = Utilities::string_to_double(Utilities::split_string_list(
              text.substr(open + 1, text.size() - open - 2), ','));
          }
        return law->second(numbers);
      }
    catch (const std::exception &exception)
      {
        Require(false,
                what + ", the law '" + name + "': " + message_of(exception));
      }
    return nullptr;
  }
} // namespace greville
