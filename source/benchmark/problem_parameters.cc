// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/benchmark/problem_parameters.h>
#include <greville/geometry/shape.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  ProblemParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Lower corner", lower, List(Double(), 2, 3))(
      "Corner of the box with the smallest coordinates; 2D takes the first "
      "two. Unit: m.");
    add_parameter(prm, "Upper corner", upper, List(Double(), 2, 3))(
      "Corner with the largest coordinates. Unit: m.");
    add_parameter(prm, "Cell ratio", cell_ratio, List(Integer(1), 2, 3))(
      "The box has this multiple of the number of cells in each direction. "
      "Unit: none.");
    add_parameter(prm, "Density", density)(
      "Density as an expression of x, y, z; not negative, zero in holes, as in "
      "if(x<0.5,1,0). Unit: kg/m^dim.");
    add_parameter(prm, "Acceleration", acceleration)(
      "The force is density times this expression of x, y, z, which is then "
      "the solution, up to its projection. Unit: m/s^2.");
    add_parameter(prm,
                  "Clamped walls",
                  clamped,
                  List(Selection("Left|Right|Bottom|Top|Back|Front"), 0))(
      "Walls at which the solution is zero, for operators with derivatives: "
      "Left, Right (x), Bottom, Top (y), Back, Front (z). Empty: all walls for "
      "laplace, and the floor (the lower wall in the last direction) for "
      "elasticity.");
    add_parameter(prm, "Points", bodies, List(Anything(), 0))(
      "Bodies of material points with this density, one after the other: box "
      "fills the grid, column stands on the floor (the lower wall in the last "
      "direction) away from all other walls, disk (2D) and ball (3D) are "
      "round, in the middle, and touch no wall; others have a name of "
      "'Shapes'. Empty: the box by Gauss quadrature, without points.");
    add_parameter(prm, "Shapes", shapes)(
      "Bodies of 'Points' by formulas, as for 'Shape' in a simulation: NAME: "
      "FORMULA, separated by ';'. Parts outside of the grid are cut off. Unit: "
      "m.");
    add_parameter(prm,
                  "Points per direction",
                  points_per_direction,
                  List(Integer(2, 4), 1))(
      "Material points per cell in each direction; several numbers one after "
      "the other. Unit: none.");
    add_parameter(prm, "Jitter", jitter, Double(0., 1.))(
      "Each material point is moved at random by at most this part of half the "
      "distance between points; 0: a lattice. Unit: none.");
    add_parameter(prm, "Filling threshold", filling_threshold, Double(0.))(
      "Fraction of a well-filled cell that material points fill. B-splines "
      "without a cell surrounded by well-filled cells are extended from "
      "B-splines with one; 0: all cells with points count. Unit: none.");
    add_parameter(prm, "Extension", extend)(
      "Extended B-splines for material points; without, the matrix of all "
      "functions with a point in their support.");
  }



  void
  ProblemParameters::check(const unsigned int dim) const
  {
    Require(lower.size() >= dim && upper.size() >= dim &&
              cell_ratio.size() >= dim,
            "'Problem/Lower corner', 'Problem/Upper corner' and 'Problem/Cell "
            "ratio' need " +
              std::to_string(dim) + " numbers in " + std::to_string(dim) +
              "D.");
    for (unsigned int d = 0; d < dim; ++d)
      Require(lower[d] < upper[d],
              "'Problem/Lower corner' has to be below 'Problem/Upper corner' "
              "in each direction.");
    const auto  of_shapes = formulas();
    std::string names     = dim == 2 ? "box|column|disk" : "box|column|ball";
    for (const auto &shape : of_shapes)
      {
        if (("|" + names + "|").find("|" + shape.first + "|") ==
            std::string::npos)
          names += "|" + shape.first;
        if (dim == 2)
          Shape<2>(shape.second, "Problem/Shapes");
        else
          Shape<3>(shape.second, "Problem/Shapes");
      }
    const auto known = Utilities::split_string_list(names, '|');
    for (const std::string &body : bodies)
      check_known(body,
                  "Problem/Points",
                  known,
                  names + " in " + std::to_string(dim) +
                    "D (see 'Benchmark/Dimensions')" +
                    (of_shapes.empty() ? ", or a name of 'Problem/Shapes'"
                                       : ""));
    const std::string walls =
      dim == 2 ? "Left|Right|Bottom|Top" : "Left|Right|Bottom|Top|Back|Front";
    for (const std::string &wall : clamped)
      check_word(wall, "Problem/Clamped walls", walls);
  }



  std::map<std::string, std::string>
  ProblemParameters::formulas() const
  {
    std::map<std::string, std::string> result;
    for (const std::string &entry : Utilities::split_string_list(shapes, ';'))
      {
        const std::size_t colon = entry.find(':');
        const std::string name  = Utilities::trim(entry.substr(0, colon));
        Require(colon != std::string::npos && !name.empty() &&
                  name.find_first_of(",|") == std::string::npos,
                "The entry <" + entry +
                  "> of the parameter 'Problem/Shapes' does not have the form "
                  "NAME: FORMULA.");
        Require(
          result.emplace(name, Utilities::trim(entry.substr(colon + 1))).second,
          "The parameter 'Problem/Shapes' has the name <" + name + "> twice.");
      }
    return result;
  }



  namespace
  {
    /// Return the formula of a shape whose surfaces cut cells, see Shape.
    template <int dim>
    std::string
    shape_of(const std::string &body, const SplineSpace<dim> &space)
    {
      const Point<dim>    &lower_corner = space.lower_corner();
      const Tensor<1, dim> size         = space.upper_corner() - lower_corner;
      std::ostringstream   formula;
      formula << std::setprecision(17);
      const auto at = [&](const unsigned int d, const double part) {
        return lower_corner[d] + part * size[d];
      };
      if (body == "disk" || body == "ball")
        {
          double width = size[0];
          formula << "ball(";
          for (unsigned int d = 0; d < dim; ++d)
            {
              formula << at(d, 0.5) << ", ";
              width = std::min(width, size[d]);
            }
          formula << 0.4 * width << ")";
        }
      else
        {
          formula << "box(";
          for (const bool upper : {false, true})
            for (unsigned int d = 0; d < dim; ++d)
              {
                double part = upper;
                if (body == "column")
                  part =
                    d + 1 < dim ? (upper ? 0.77 : 0.23) : (upper ? 0.67 : 0.);
                formula << (upper || d > 0 ? ", " : "") << at(d, part);
              }
          formula << ")";
        }
      return formula.str();
    }
  } // namespace



  template <int dim>
  PointPlacement
  ProblemParameters::placement(const std::string      &body,
                               const unsigned int      n,
                               const SplineSpace<dim> &space) const
  {
    const auto     of_shapes = formulas();
    const auto     formula   = of_shapes.find(body);
    PointPlacement result;
    result.clip  = formula != of_shapes.end();
    result.shape = result.clip ? formula->second : shape_of(body, space);
    result.points_per_direction = {n};
    result.jitter               = jitter;
    return result;
  }



  template PointPlacement
  ProblemParameters::placement<2>(const std::string &,
                                  const unsigned int,
                                  const SplineSpace<2> &) const;
  template PointPlacement
  ProblemParameters::placement<3>(const std::string &,
                                  const unsigned int,
                                  const SplineSpace<3> &) const;
} // namespace greville
