// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/function.h>
#include <deal.II/base/symmetric_tensor.h>

#include <greville/base/expression.h>
#include <greville/geometry/convex_part.h>

#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /// A smooth function that is negative on one side of a surface: a plane, a
  /// quadric (ball, cylinder without ends), or a formula.
  template <int dim>
  struct LevelSet
  {
    enum Kind
    {
      plane,
      quadric,
      formula
    };

    double
    value(const dealii::Point<dim> &x) const;

    /// Return the gradient; for formulas, by sixth-order differences over
    /// hundredths of @p size.
    dealii::Tensor<1, dim>
    gradient(const dealii::Point<dim>     &x,
             const dealii::Tensor<1, dim> &size) const;

    bool
    operator==(const LevelSet &other) const;

    Kind       kind = plane;
    Plane<dim> as_plane;
    /// Data of a quadric, (x - center) . metric (x - center) / (2 radius) -
    /// radius / 2.
    dealii::Point<dim>              center;
    dealii::SymmetricTensor<2, dim> metric;
    double                          radius = 0.;
    std::string                     text;
    std::optional<Expression>       expression;
  };



  /// A level set in the coordinates of a cell, which are in [0, 1]. Derivatives
  /// of formulas are sixth- and fourth-order differences.
  template <int dim>
  class CellLevelSet : public dealii::Function<dim>
  {
  public:
    CellLevelSet(const LevelSet<dim>          &level_set,
                 const dealii::Point<dim>     &corner,
                 const dealii::Tensor<1, dim> &size);

    double
    value(const dealii::Point<dim> &xi,
          const unsigned int        component = 0) const override;

    dealii::Tensor<1, dim>
    gradient(const dealii::Point<dim> &xi,
             const unsigned int        component = 0) const override;

    dealii::SymmetricTensor<2, dim>
    hessian(const dealii::Point<dim> &xi,
            const unsigned int        component = 0) const override;

    /// Return -1 or 1 if the function has one sign in a box, which may be flat.
    /// Return 0 if this is not known.
    int
    sign(const dealii::BoundingBox<dim> &box) const;

    /// Return the largest number f such that some derivative is at least f
    /// times the norm of the gradient at the center, everywhere in a box. It is
    /// not positive if each derivative may be zero.
    double
    flatness(const dealii::BoundingBox<dim> &box) const;

    /// Return the plane itself, or a plane that touches the surface near @p xi.
    Plane<dim>
    tangent_plane(const dealii::Point<dim> &xi) const;

    /// Return the direction of the normal of an axis-aligned plane, or dim.
    unsigned int
    axis() const;

    typename LevelSet<dim>::Kind
    kind() const
    {
      return level_set.kind;
    }

  private:
    dealii::Point<dim>
    position(const dealii::Point<dim> &xi) const;

    const LevelSet<dim>   &level_set;
    dealii::Point<dim>     corner;
    dealii::Tensor<1, dim> size;
    double                 scale = 1.;
  };



  /// A shape as unions and intersections of level sets and their complements,
  /// from the formula of a Shape. It may contain shapes, their combinations
  /// (also by & and |), comparisons f < g and level_set(f).
  template <int dim>
  class ShapeTree
  {
  public:
    /// The side of a level set or of the shape.
    enum Side : signed char
    {
      inside  = -1,
      unknown = 0,
      outside = 1
    };

    /// Throws dealii::ExcMessage with the name of the @p parameter if the
    /// formula is not made of level sets.
    ShapeTree(const std::string &formula, const std::string &parameter);

    /// Return the side of the shape from the sides of the level sets. If it is
    /// unknown, set @p active for the level sets on which it depends.
    Side
    evaluate(const std::vector<Side> &sides, std::vector<bool> &active) const;

    const std::vector<LevelSet<dim>> &
    level_sets() const
    {
      return all_level_sets;
    }

  private:
    struct Node
    {
      enum Kind
      {
        leaf,
        all_of,
        any_of
      };
      Kind              kind      = leaf;
      bool              inverted  = false;
      unsigned int      level_set = 0;
      std::vector<Node> children;
    };

    class Parser;

    Side
    evaluate(const Node              &node,
             const std::vector<Side> &sides,
             std::vector<bool>       *active) const;

    std::vector<LevelSet<dim>> all_level_sets;
    Node                       root;
  };
} // namespace greville
