// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/base/parameters.h>
#include <greville/spline/cell_hierarchy.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /// A function that returns whether a box is closer to the surface of a body
  /// or a rigid body than a distance, m. It may err by a fifth of the box's
  /// diagonal.
  template <int dim>
  using IsNearSurface = std::function<bool(const CellBox<dim> &, const double)>;



  /// The reason for which the cells of a region are refined.
  enum class Indicator
  {
    none, // all of them are
    plastic_strain,
    stress_jump
  };

  inline const Choices<Indicator> indicators = {
    {Indicator::none, "none"},
    {Indicator::plastic_strain, "plastic strain"},
    {Indicator::stress_jump, "stress jump"}};



  /// A region in which cells are refined.
  struct RefinementParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Return whether cells are refined at a time, s.
    bool
    acts_at(const double time) const
    {
      return (from.empty() || time >= from[0]) &&
             (until.empty() || time < until[0]);
    }

    bool
    has_indicator() const
    {
      return indicator != Indicator::none;
    }

    std::string  shape;
    unsigned int levels       = 1;
    Indicator    indicator    = Indicator::none;
    double       refine_above = 0.01;
    double       distance     = 0.; // to surfaces, m; 0: any
    /// One time, s, or none.
    std::vector<double> from, until;
  };



  struct GridParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::vector<double>       lower = {0., 0.};
    std::vector<double>       upper = {1., 1.};
    std::vector<unsigned int> cells = {16, 16};
    /// The edges of cells in each direction, or a text "fine(...) ..." from
    /// which they follow; empty for equal cells.
    std::array<std::string, 3> knots;
    unsigned int               degree   = 2;
    std::string                geometry = "plane strain";
    bool                       per_body = false;
    std::vector<std::string>   refinement;
    unsigned int               adapt_every    = 0;
    unsigned int               adapt_at_start = 0;
    unsigned int               most_cells     = 0;
    /// The regions that 'refinement' names.
    std::map<std::string, RefinementParameters> regions;
    /// Not set by files: positions of cells (CellHierarchy) that are halved at
    /// the start as well, see adapt_at_start().
    std::vector<std::uint64_t> marked_at_start;

    bool
    has_changing_cells() const
    {
      return adapt_every > 0 || adapt_at_start > 0;
    }

    bool
    is_refined() const
    {
      return !regions.empty();
    }

    /// Return the largest number of times that a cell is halved.
    unsigned int
    n_levels() const
    {
      unsigned int n = 0;
      for (const auto &region : regions)
        n = std::max(n, region.second.levels);
      return n;
    }

    /// Return whether cells are refined near surfaces.
    bool
    has_distances() const
    {
      return std::any_of(regions.begin(),
                         regions.end(),
                         [](const auto &region) {
                           return region.second.distance > 0.;
                         });
    }

    /// Return the levels of a refined grid for a mesh at a time, s, which the
    /// regions without an indicator require; null for a grid without
    /// refinement. Without @p is_near, no cell is near a surface. Throws
    /// dealii::ExcMessage for invalid shapes.
    template <int dim>
    std::shared_ptr<const CellHierarchy<dim>>
    hierarchy(const double time, const IsNearSurface<dim> &is_near = {}) const;

    /// Return the edges of the cells of a direction; none for equal cells.
    /// Throws dealii::ExcMessage for a text that is no list of edges.
    std::vector<double>
    edges(const unsigned int d) const;

    void
    set_edges(const unsigned int d, const std::vector<double> &edges);

    /// Return whether all cells are equal.
    bool
    is_uniform() const
    {
      return knots[0].empty() && knots[1].empty() && knots[2].empty();
    }

    /// Throw dealii::ExcMessage for corners and cells of another dimension, and
    /// corners in the wrong order.
    void
    check(const unsigned int dim) const;

    /// Set the number of cells and the edges from a text "fine(...) ...", also
    /// in @p prm.
    void
    complete(const unsigned int dim, dealii::ParameterHandler &prm);

    /// Return whether x is the distance from an axis, and quantities are per
    /// radian.
    bool
    is_axisymmetric() const
    {
      return geometry == "axisymmetric";
    }

    /// Return whether the grid begins at the axis.
    bool
    has_axis() const
    {
      return is_axisymmetric() && lower[0] == 0.;
    }
  };



  /// The grid of a body: empty or zero values are taken from GridParameters.
  struct BodyGridParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    bool
    is_given() const
    {
      return !lower.empty() || !upper.empty() || !cells.empty() || degree > 0;
    }

    std::vector<double>       lower;
    std::vector<double>       upper;
    std::vector<unsigned int> cells;
    unsigned int              degree = 0;
  };
} // namespace greville
