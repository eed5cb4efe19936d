// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/compatibility.h>
#include <greville/base/errors.h>
#include <greville/geometry/shape.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The point at which shapes are evaluated, since functions in formulas
    // receive only their arguments.
    thread_local const double *shape_point = nullptr;
    thread_local int           shape_dim   = 0;

    /// Throw for a wrong number of arguments; the formula adds its parameter.
    void
    check_arguments(const char *shape, const int given, const int wanted)
    {
      Require(given == wanted,
              std::string(shape) + "() takes " + std::to_string(wanted) +
                " numbers in " + std::to_string(shape_dim) + "D, not " +
                std::to_string(given));
    }

    double
    box(const double *arguments, const int n)
    {
      check_arguments("box", n, 2 * shape_dim);
      for (int d = 0; d < shape_dim; ++d)
        Require(arguments[d] <= arguments[shape_dim + d],
                "the upper corner of a box() has to be above the lower one");
      bool inside = true;
      for (int d = 0; d < shape_dim; ++d)
        inside = inside && shape_point[d] >= arguments[d] &&
                 shape_point[d] <= arguments[shape_dim + d];
      return inside;
    }

    double
    ball(const double *arguments, const int n)
    {
      check_arguments("ball", n, shape_dim + 1);
      Require(arguments[shape_dim] > 0.,
              "the radius of a ball() has to be positive");
      double square = 0.;
      for (int d = 0; d < shape_dim; ++d)
        square += std::pow(shape_point[d] - arguments[d], 2);
      return square <= std::pow(arguments[shape_dim], 2);
    }

    double
    cylinder(const double *arguments, const int n)
    {
      check_arguments("cylinder", n, 7);
      Require(shape_dim == 3, "cylinder() is a shape of 3D");
      Require(arguments[6] > 0.,
              "the radius of a cylinder() has to be positive");
      double along = 0., length = 0., square = 0.;
      for (int d = 0; d < 3; ++d)
        {
          const double axis     = arguments[3 + d] - arguments[d];
          const double distance = shape_point[d] - arguments[d];
          along += axis * distance;
          length += axis * axis;
          square += distance * distance;
        }
      Require(length > 0., "the ends of a cylinder() have to be different");
      return along >= 0. && along <= length &&
             square - along * along / length <= std::pow(arguments[6], 2);
    }

    double
    half_space(const double *arguments, const int n)
    {
      check_arguments("half_space", n, shape_dim + 1);
      double sum = 0., normal = 0.;
      for (int d = 0; d < shape_dim; ++d)
        {
          sum += arguments[d] * shape_point[d];
          normal += std::abs(arguments[d]);
        }
      Require(normal > 0., "the normal of a half_space() is zero");
      return sum <= arguments[shape_dim];
    }

    double
    level_set(const double *arguments, const int n)
    {
      Require(n == 1, "level_set() takes 1 formula, not " + std::to_string(n));
      return arguments[0] < 0.;
    }

    double
    union_of(const double *arguments, const int n)
    {
      return std::any_of(arguments, arguments + n, [](const double a) {
        return a != 0.;
      });
    }

    double
    intersection_of(const double *arguments, const int n)
    {
      return std::all_of(arguments, arguments + n, [](const double a) {
        return a != 0.;
      });
    }

    double
    difference_of(const double *arguments, const int n)
    {
      return n > 0 && arguments[0] != 0. &&
             union_of(arguments + 1, n - 1) == 0.;
    }

    const std::vector<Expression::Function> shape_functions = {
      {"box", &box},
      {"ball", &ball},
      {"cylinder", &cylinder},
      {"half_space", &half_space},
      {"level_set", &level_set},
      {"union", &union_of},
      {"intersection", &intersection_of},
      {"difference", &difference_of}};

    template <int dim>
    Expression
    make_shape(const std::string &formula,
               const std::string &parameter,
               const bool         moves)
    {
      Require(formula.find_first_not_of(" \t") != std::string::npos,
              "The parameter '" + parameter +
                "' is empty: it takes a formula like " +
                (dim == 2 ? "box(0, 0, 1, 2)." : "box(0, 0, 0, 1, 1, 2)."));
      const Point<dim> origin;
      shape_point = &origin[0];
      shape_dim   = dim;
      return Expression(formula,
                        parameter,
                        variables_of<dim>(moves ? "xt" : "x"),
                        shape_functions);
    }
  } // namespace



  std::string
  shape_names()
  {
    std::string names;
    for (const Expression::Function &shape : shape_functions)
      names += (names.empty() ? "" : "|") + shape.name;
    return names;
  }



  template <int dim>
  Shape<dim>::Shape(const std::string &formula,
                    const std::string &parameter,
                    const bool         moves)
    : expression(make_shape<dim>(formula, parameter, moves))
    , moves(moves)
  {}



  template <int dim>
  bool
  Shape<dim>::contains(const Point<dim> &x, const double t) const
  {
    shape_point = &x[0];
    shape_dim   = dim;
    std::array<double, dim + 1> arguments;
    std::copy_n(x.begin_raw(), dim, arguments.begin());
    arguments.back() = t;
    return expression(ArrayView<const double>(arguments.data(),
                                              moves ? dim + 1 : dim)) != 0.;
  }



  GREVILLE_INSTANTIATE_CLASS(Shape);
} // namespace greville
