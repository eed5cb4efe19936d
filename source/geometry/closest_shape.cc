// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>

#include "dual_contours.h"
#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The error of closest points, and the distance from them at which the
    // sides of the surface are checked, both relative to coordinates.
    constexpr double converged_distance = 1e-13, beside_surface = 1e-8;

    // The number of cells for dual_contours(), for pictures.
    template <int dim>
    constexpr unsigned int n_cells_of_contours = dim == 2 ? 128 : 40;



    template <int dim>
    struct Query
    {
      Point<dim>     x;
      double         within;
      double         size; // of coordinates
      Tensor<1, dim> cell; // for derivatives of formulas
    };



    /// A point at which the first n of some level sets are zero, or are to
    /// become zero.
    template <int dim>
    struct Candidate
    {
      Point<dim>                             point;
      double                                 distance = 0.;
      Tensor<1, dim>                         normal; // of the shape
      unsigned int                           n = 0;
      std::array<const LevelSet<dim> *, dim> level_sets;

      /// The unit normals of the level sets are a lower triangle times
      /// orthonormal vectors (Gram and Schmidt).
      std::array<Tensor<1, dim>, dim> basis, factor;
      std::array<double, dim>         offsets; // to the zeros, along normals

      /// Linearize the level sets. Returns false if the normals are linearly
      /// dependent.
      bool
      linearize(const Tensor<1, dim> &cell)
      {
        for (unsigned int i = 0; i < n; ++i)
          {
            basis[i]          = level_sets[i]->gradient(point, cell);
            const double norm = basis[i].norm();
            if (norm == 0.)
              return false;
            offsets[i] = -level_sets[i]->value(point) / norm;
            basis[i] /= norm;
            for (unsigned int k = 0; k < i; ++k)
              {
                factor[i][k] = basis[k] * basis[i];
                basis[i] -= factor[i][k] * basis[k];
              }
            factor[i][i] = basis[i].norm();
            if (factor[i][i] < 1e-6)
              return false;
            basis[i] /= factor[i][i];
          }
        return true;
      }

      /// Return the shortest vector with given products with the unit normals.
      Tensor<1, dim>
      across(std::array<double, dim> products) const
      {
        Tensor<1, dim> result;
        for (unsigned int i = 0; i < n; ++i)
          {
            for (unsigned int k = 0; k < i; ++k)
              products[i] -= factor[i][k] * products[k];
            products[i] /= factor[i][i];
            result += products[i] * basis[i];
          }
        return result;
      }

      /// Move to the closest point at which all level sets are zero. Returns
      /// false if it is not found or too far away.
      bool
      approach(const Query<dim> &query)
      {
        Tensor<1, dim> last_along, step;
        for (unsigned int k = 0; k < 50; ++k)
          {
            if (!linearize(query.cell))
              return false;
            // Newton's step to the level sets, and a step along them towards x,
            // whose length follows from its last change (Barzilai and Borwein).
            const Tensor<1, dim> newton = across(offsets);
            Tensor<1, dim>       along  = query.x - point;
            for (unsigned int i = 0; i < n; ++i)
              along -= (along * basis[i]) * basis[i];
            distance = query.x.distance(point);
            if (newton.norm() + along.norm() < converged_distance * query.size)
              return distance <= query.within;
            if (distance > 3. * query.within ||
                newton.norm() > 10. * query.within)
              return false;
            const Tensor<1, dim> change = last_along - along;
            const double product = change * step, square = change * change;
            step = newton;
            step += (product > 0.01 * square ? product / square : 1.) * along;
            step *= std::min(1., query.within / step.norm());
            point += step;
            last_along = along;
          }
        return false;
      }
    };



    template <int dim>
    class ClosestOfShape : public ClosestSurface<dim>
    {
    public:
      ClosestOfShape(const std::string &formula, const std::string &parameter)
        : formula(formula)
        , parameter(parameter)
        , tree(formula, parameter)
        , sides(tree.level_sets().size())
        , active(sides.size())
      {
        for (unsigned int d = 0; d < dim; ++d)
          ones[d] = 1.;
        for (const LevelSet<dim> &level_set : tree.level_sets())
          length = std::max(length,
                            std::abs(level_set.as_plane.offset) +
                              level_set.radius + level_set.center.norm());
      }

      std::optional<ClosestPoint<dim>>
      closest(const Point<dim> &x, const double within) const override
      {
        Query<dim> query;
        query.x      = x;
        query.size   = length + x.norm() + std::min(within, 1.);
        query.within = within + 1e-15 * query.size; // at it, too
        // Differences over smaller distances would be round-off.
        query.cell = std::max(std::min(within, 1.), 1e-4 * query.size) * ones;
        singles.clear();
        for (const LevelSet<dim> &level_set : tree.level_sets())
          {
            Candidate<dim> single;
            single.point         = x;
            single.level_sets[0] = &level_set;
            single.n             = 1;
            if (level_set.kind == LevelSet<dim>::plane)
              single.point -= level_set.value(x) * level_set.as_plane.normal;
            else if (level_set.kind == LevelSet<dim>::quadric)
              {
                auto out = level_set.metric * (x - level_set.center);
                single.point -= out;
                // At the center or on the axis, all directions are equivalent.
                for (unsigned int d = 0; d < dim && out.norm() == 0.; ++d)
                  out = level_set.metric * Point<dim>::unit_vector(d);
                single.point += level_set.radius / out.norm() * out;
              }
            if (level_set.kind != LevelSet<dim>::formula &&
                x.distance(single.point) > query.within)
              continue;
            if (single.approach(query))
              singles.push_back(single);
          }
        std::sort(singles.begin(), singles.end(), [](auto &a, auto &b) {
          return a.distance < b.distance;
        });
        Candidate<dim> best;
        best.distance       = query.within;
        unsigned int n_near = 0;
        for (; n_near < singles.size() && best.n == 0; ++n_near)
          if (is_on_surface(singles[n_near], query.size))
            best = singles[n_near];
        // Only level sets that are nearer can intersect at a nearer point.
        for (unsigned int i = 0; i < n_near; ++i)
          for (unsigned int j = 0; j < i; ++j)
            for (unsigned int k = dim == 3 ? 0 : j; k <= j; ++k)
              if (singles[i].distance < best.distance)
                {
                  Candidate<dim> common;
                  for (const unsigned int l : {i, j, k})
                    if (common.n < 2 || (dim == 3 && k < j)) // else a pair
                      common.level_sets[common.n++] = singles[l].level_sets[0];
                  for (const unsigned int l : {i, j, k})
                    {
                      common.point = singles[l].point;
                      if (common.approach(query) &&
                          common.distance < best.distance &&
                          is_on_surface(common, query.size))
                        best = common;
                    }
                }
        if (best.n == 0)
          return std::nullopt;

        ClosestPoint<dim> result;
        result.point    = best.point;
        result.distance = contains(x) ? -best.distance : best.distance;
        result.normal   = best.n == 1 || best.distance < 1e-12 * query.size
                            ? best.normal / best.normal.norm()
                            : (x - best.point) / result.distance;
        return result;
      }

      bool
      contains(const Point<dim> &x) const override
      {
        for (unsigned int k = 0; k < sides.size(); ++k)
          sides[k] = Side(tree.level_sets()[k].value(x) <= 0. ? -1 : 1);
        return tree.evaluate(sides, active) == ShapeTree<dim>::inside;
      }

      /// Return a box around the cells of a lattice that are not outside;
      /// infinite for formulas, and if the first lattice has such cells at its
      /// sides.
      BoundingBox<dim>
      box() const override
      {
        const Point<dim> infinite(std::numeric_limits<double>::infinity() *
                                  ones);
        const BoundingBox<dim> everything({-infinite, infinite});
        // Begin with a box much larger than the numbers in the formula.
        Point<dim> upper(64. * (length > 0. ? length : 1.) * ones);
        Point<dim> lower = -upper;
        for (unsigned int pass = 0; pass < 6; ++pass)
          {
            const Tensor<1, dim>           size = (upper - lower) / 16.;
            std::vector<CellLevelSet<dim>> level_sets;
            for (const LevelSet<dim> &level_set : tree.level_sets())
              if (level_set.kind == LevelSet<dim>::formula)
                return everything;
              else
                level_sets.emplace_back(level_set, lower, size);
            Point<dim> low = infinite, high = -infinite;
            for (unsigned int cell = 0; cell < (1u << (4 * dim)); ++cell)
              {
                Point<dim> corner;
                for (unsigned int d = 0; d < dim; ++d)
                  corner[d] = (cell >> (4 * d)) & 15;
                const BoundingBox<dim> part({corner, corner + ones});
                for (unsigned int k = 0; k < sides.size(); ++k)
                  sides[k] = Side(level_sets[k].sign(part));
                if (tree.evaluate(sides, active) != ShapeTree<dim>::outside)
                  for (unsigned int d = 0; d < dim; ++d)
                    {
                      low[d]  = std::min(low[d], corner[d]);
                      high[d] = std::max(high[d], corner[d] + 1.);
                    }
              }
            Require(low[0] <= high[0],
                    "The parameter '" + parameter + "' is <" + formula +
                      ">, which is empty: no point is inside.");
            for (unsigned int d = 0; d < dim; ++d)
              {
                if (pass == 0 && (low[d] == 0. || high[d] == 16.))
                  return everything;
                upper[d] = lower[d] + high[d] * size[d];
                lower[d] += low[d] * size[d];
              }
          }
        return BoundingBox<dim>({lower, upper});
      }

      ClosedSurface<dim>
      mesh(const BoundingBox<dim> &region) const override
      {
        const BoundingBox<dim> end = box();
        if (std::isfinite(end.lower_bound(0)))
          return contours(end);
        std::ostringstream text;
        text.precision(17);
        text << "intersection(" << formula << ", box(";
        for (unsigned int k = 0; k < 2 * dim; ++k)
          text << (k == 0 ? "" : ", ")
               << (k < dim ? region.lower_bound(k)
                           : region.upper_bound(k - dim));
        const ClosestOfShape part(text.str() + "))", parameter);
        // Repeat if the body is small in this box.
        Facet<dim> corners;
        for (const Facet<dim> &facet : part.contours(region))
          corners.insert(corners.end(), facet.begin(), facet.end());
        if (corners.empty())
          return {};
        BoundingBox<dim> around(corners);
        for (unsigned int d = 0; d < dim; ++d)
          around.extend(region.side_length(d) / n_cells_of_contours<dim>);
        return part.contours(around);
      }

    private:
      using Side = typename ShapeTree<dim>::Side;

      ClosedSurface<dim>
      contours(const BoundingBox<dim> &within) const
      {
        return internal::dual_contours<dim>(
          [&](const auto &x) { return contains(x); },
          *this,
          within,
          n_cells_of_contours<dim>);
      }

      /// Set the normal, and return whether both sides of the surface are in
      /// the sectors between the level sets.
      bool
      is_on_surface(Candidate<dim> &candidate, const double size) const
      {
        candidate.normal = 0.;
        bool found[2]    = {false, false};
        for (unsigned int s = 0; s < (1u << candidate.n); ++s)
          {
            std::array<double, dim> signs;
            for (unsigned int i = 0; i < dim; ++i)
              signs[i] = (s >> i) & 1 ? 1. : -1.;
            Tensor<1, dim> direction = candidate.across(signs);
            direction /= direction.norm();
            const bool is_inside =
              contains(candidate.point + beside_surface * size * direction);
            candidate.normal += (is_inside ? -1. : 1.) * direction;
            found[is_inside] = true;
          }
        return found[0] && found[1];
      }

      std::string    formula, parameter;
      ShapeTree<dim> tree;
      double         length = 0.; // largest length in the formula
      Tensor<1, dim> ones;

      // Memory for searches.
      mutable std::vector<Side>           sides;
      mutable std::vector<bool>           active;
      mutable std::vector<Candidate<dim>> singles;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const std::string &formula, const std::string &parameter)
  {
    // The tree relies on the correct numbers of arguments.
    const Shape<dim> checked(formula, parameter);
    return std::make_unique<ClosestOfShape<dim>>(formula, parameter);
  }



  template std::unique_ptr<ClosestSurface<2>>
  make_closest_surface(const std::string &, const std::string &);
  template std::unique_ptr<ClosestSurface<3>>
  make_closest_surface(const std::string &, const std::string &);
} // namespace greville
