// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_geometry_closest_shape_h
#define greville_source_geometry_closest_shape_h

#include <greville/geometry/closest_surface.h>

#include "sectors.h"
#include "shape_edges.h"

namespace greville
{
  namespace internal
  {
    /**
     * A shape that can tell its inside from its outside at points, over boxes,
     * and around points of its surface.
     */
    template <int dim>
    class SidesOfShape
    {
    public:
      using Side = typename ShapeTree<dim>::Side;

      SidesOfShape(const std::string &formula, const std::string &parameter);

      bool
      is_inside(const dealii::Point<dim> &x) const;

      /**
       * Outside or unknown.
       */
      bool
      is_outside(const dealii::BoundingBox<dim> &box) const;

      /**
       * Whether @p y, where the first @p n of @p numbers are zero, is on the
       * surface: in one direction from it is the inside, in another one the
       * outside. The length is for differences of formulas. Adds the unit
       * normals of the level sets that separate both to @p normals, if given.
       */
      bool
      is_on_surface(const dealii::Point<dim>            &y,
                    const std::array<unsigned int, dim> &numbers,
                    const unsigned int                   n,
                    const double                         length,
                    dealii::Tensor<1, dim> *normals = nullptr) const;

      /**
       * A box around the shape; infinite where none is found.
       */
      dealii::BoundingBox<dim>
      box() const;

      const std::vector<LevelSet<dim>> &
      level_sets() const
      {
        return tree.level_sets();
      }

      std::array<const LevelSet<dim> *, dim>
      pointers(const std::array<unsigned int, dim> &chosen,
               const unsigned int                   n) const
      {
        std::array<const LevelSet<dim> *, dim> result{};
        for (unsigned int i = 0; i < n; ++i)
          result[i] = &level_sets()[chosen[i]];
        return result;
      }

      ShapeTree<dim> tree;
      /// Level sets without those that are others up to round-off.
      std::vector<unsigned int> numbers;
      bool                      has_formulas = false;
      /// Of the coordinates in the formula.
      double length = 0.;

    private:
      /**
       * Of the shape, where the sides of all @p numbers are set.
       */
      Side
      evaluate() const;

      /**
       * The parts of @p box that are not outside, up to boxes of @p depth
       * halvings, and their hull.
       */
      void
      add_to_hull(const dealii::BoundingBox<dim> &box,
                  const unsigned int              depth,
                  unsigned int                   &n_boxes,
                  dealii::Point<dim>             &lower,
                  dealii::Point<dim>             &upper) const;

      struct Copy
      {
        unsigned int number, original;
        bool         is_inverted;
      };
      std::vector<Copy>         copies;
      mutable std::vector<Side> sides;
      mutable std::vector<bool> active;
    };



    /**
     * The facets of ClosestSurface::facets().
     */
    template <int dim>
    ClosedSurface<dim>
    facets_of(const SidesOfShape<dim>        &shape,
              const double                    size,
              const dealii::BoundingBox<dim> &clip);
  } // namespace internal
} // namespace greville

#endif
