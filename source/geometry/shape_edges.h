// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_geometry_shape_edges_h
#define greville_source_geometry_shape_edges_h

#include "constrained_point.h"

namespace greville
{
  namespace internal
  {
    /**
     * The nearest point of a plane or a quadric.
     */
    template <int dim>
    dealii::Point<dim>
    project(const LevelSet<dim> &level_set, const dealii::Point<dim> &x);



    /**
     * A curve in which two planes or quadrics meet.
     */
    struct Edge
    {
      enum Kind
      {
        line,
        circle,
        /// Known by samples.
        curve
      };
      Kind                        kind = line;
      std::array<unsigned int, 2> level_sets;
      /// A point of a line, the center of a circle.
      dealii::Point<3> center;
      /// Along a line, the axis of a circle.
      dealii::Tensor<1, 3> direction;
      /// In the plane of a circle.
      dealii::Tensor<1, 3> across;
      double               radius = 0.;

      /// One after the other; gaps end a branch.
      struct Sample
      {
        dealii::Point<3> x;
        bool             exists;
      };
      std::vector<Sample> samples;

      /**
       * Call @p visit for the samples that are local minima of a function of
       * samples.
       */
      template <typename Function, typename Visit>
      void
      visit_minima(const Function &function, const Visit &visit) const
      {
        const std::size_t n    = samples.size();
        const double      none = std::numeric_limits<double>::max();
        const auto        at   = [&](const std::size_t k) {
          return samples[k % n].exists ? function(samples[k % n].x) : none;
        };
        double before = n > 0 ? at(n - 1) : none, here = n > 0 ? at(0) : none;
        for (std::size_t k = 0; k < n; ++k)
          {
            const double after = at(k + 1);
            if (here != none && here <= before && here <= after)
              visit(samples[k].x);
            before = here;
            here   = after;
          }
      }
    };



    /**
     * All edges of level sets, of which formulas have none.
     */
    std::vector<Edge>
    find_edges(const std::vector<LevelSet<3>>  &level_sets,
               const std::vector<unsigned int> &numbers,
               const double                     length);

    /**
     * A point in which dim level sets meet.
     */
    template <int dim>
    struct Corner
    {
      dealii::Point<dim>            x;
      std::array<unsigned int, dim> level_sets;
    };

    /**
     * All corners of level sets, of which formulas have none.
     */
    std::vector<Corner<3>>
    find_corners(const std::vector<LevelSet<3>>  &level_sets,
                 const std::vector<unsigned int> &numbers,
                 const std::vector<Edge>         &edges,
                 const double                     length);

    std::vector<Corner<2>>
    find_corners(const std::vector<LevelSet<2>>  &level_sets,
                 const std::vector<unsigned int> &numbers,
                 const double                     length);
  } // namespace internal
} // namespace greville

#endif
