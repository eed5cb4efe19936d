// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_geometry_constrained_point_h
#define greville_source_geometry_constrained_point_h

#include <greville/geometry/level_set.h>

namespace greville
{
  namespace internal
  {
    /**
     * A level set at a point, with its derivatives.
     */
    template <int dim>
    struct Derivatives
    {
      double                          value;
      dealii::Tensor<1, dim>          gradient;
      dealii::SymmetricTensor<2, dim> hessian;
    };

    /**
     * Those of formulas are differences, with steps that begin at a hundredth
     * of @p length and shrink until the gradient has nine digits.
     */
    template <int dim>
    Derivatives<dim>
    derivatives(const LevelSet<dim>      &level_set,
                const dealii::Point<dim> &y,
                const double              length,
                const bool                with_hessian);



    /**
     * The points in which up to dim level sets are zero.
     */
    template <int dim>
    class ConstrainedPoint
    {
    public:
      ConstrainedPoint(const std::array<const LevelSet<dim> *, dim> &level_sets,
                       const unsigned int                            n,
                       const double                                  length)
        : level_sets(level_sets)
        , n(n)
        , length(length)
      {}

      /**
       * Move @p y to a point nearby that all level sets have in common, by
       * Newton's method with steps of least length. Returns whether there is
       * one.
       */
      bool
      restore(dealii::Point<dim> &y) const;

      /**
       * Move @p y to a local minimum of the distance from @p x under the
       * constraints, by Newton's method in the tangential space: all steps go
       * to points where the level sets are zero, and come closer. Returns
       * whether there is one.
       */
      bool
      approach(const dealii::Point<dim> &x, dealii::Point<dim> &y) const;

    private:
      /**
       * The combination of gradients with these products with the gradients,
       * and its coefficients; false where they are linearly dependent.
       */
      bool
      combine(const std::array<dealii::Tensor<1, dim>, dim> &gradients,
              const std::array<double, dim>                 &products,
              std::array<double, dim>                       &coefficients,
              dealii::Tensor<1, dim>                        &sum) const;

      std::array<const LevelSet<dim> *, dim> level_sets;
      unsigned int                           n;
      double                                 length;
    };
  } // namespace internal
} // namespace greville

#endif
