// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/grid_mass.h>

#include <optional>

namespace greville
{
  /// The row sums M_L of the mass matrix M of the points, or FMPM's series of K
  /// terms (see add_fmpm_terms()), for all functions with mass. Points of a
  /// contact surface are ahead of the points of their body. When they enter a
  /// cell first, functions there have hardly any mass or none. For contact
  /// surfaces, these functions are replaced by a constant extension of the
  /// nearest functions with mass, so that no part of a force is lost.
  ///
  /// In a refined grid, the row sums are those of truncated hierarchical
  /// B-splines. The functions of levels that are tied (LevelFunctions) have no
  /// mass of their own: condense_levels() adds theirs to other functions.
  /// Functions at cut cells are not extended.
  template <int dim>
  class LumpedMass : public GridMass<dim>
  {
  public:
    /// Collective. @p n_terms is K; K = 1 is M_L^-1.
    LumpedMass(const unsigned int         n_terms,
               const OrderHierarchy<dim> &orders,
               const Walls<dim>          &walls);

    std::string
    solver() const override
    {
      return n_terms == 1 ? "lumped" : "fmpm-" + std::to_string(n_terms);
    }

    bool
    is_exact() const override
    {
      return false;
    }

    bool
    is_diagonal() const override
    {
      return n_terms == 1;
    }

    void
    update(const VectorType                               &lumped,
           const std::vector<const MaterialPoints<dim> *> &bodies,
           const std::vector<const MaterialPoints<dim> *> &surfaces,
           const PointTransfer<dim>                       &transfer) override;

    /// Constrained coefficients enter the series with their values.
    void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {}) override;

    void
    constrained_rows(VectorField<dim>       &rows,
                     const VectorField<dim> &x,
                     const VectorField<dim> &b,
                     const unsigned int      k) const override;

    bool
    extends_surfaces() const override
    {
      return extended != nullptr;
    }

    void
    condense_levels(VectorField<dim> &rows) const override;

    void
    condense_levels(VectorType                                     &lumped,
                    VectorField<dim>                               &momentum,
                    const std::vector<const MaterialPoints<dim> *> &bodies,
                    PointTransfer<dim> &transfer) const override;

    void
    distribute_levels(VectorField<dim> &x) const override;

    void
    condense(VectorField<dim> &rows) const override;

    void
    distribute(VectorField<dim> &x) const override;

  private:
    /// The extension of functions for surfaces.
    struct Extended
    {
      CellFilling<dim>      filling;
      std::vector<double>   filled_part; // of owned cells
      Extension<dim>        extension;
      StencilMatrix<dim>    stencil;
      ExtendedUnknowns<dim> unknowns;
    };

    /// The joined levels of a refined grid.
    struct Levels
    {
      /// Collective.
      Levels(const SplineSpace<dim> &space);

      CellFilling<dim>                filling;
      Extension<dim>                  extension;
      StencilPlaces<dim>              places;
      ExtendedUnknowns<dim>           unknowns;
      std::vector<bool>               is_tied;         // by owned function
      std::vector<dealii::Point<dim>> greville_points; // likewise
      std::vector<bool>               has_tied; // functions, by owned cell
    };

    /// Collective. Make the extension if surfaces are in contact.
    void
    extend_to(const std::vector<const MaterialPoints<dim> *> &surfaces,
              const std::vector<const MaterialPoints<dim> *> &bodies,
              const PointTransfer<dim>                       &transfer);

    /// Call action(i) for the owned functions that walls constrain. They keep
    /// their loads and velocities.
    template <typename Action>
    void
    for_each_constrained(const unsigned int component, Action action) const;

    void
    update_constrained() override;

    void
    multiply_constrained_rows(
      VectorField<dim>            &rows,
      const VectorField<dim>      &x,
      const std::array<bool, dim> &components) const override;

    const unsigned int                      n_terms;
    typename CellFilling<dim>::Walls        friction_walls;
    std::unique_ptr<Levels>                 levels; // null: no refined grid
    std::unique_ptr<Extended>               extended;
    VectorField<dim>                        inverse; // of M_L, 0 if constrained
    std::vector<dealii::Tensor<1, dim>>     given;   // parts along directions
    std::optional<DensityWeights<dim>>      weights;
    std::unique_ptr<CrossMassOperator<dim>> product; // M, if K > 1
    std::vector<VectorField<dim>> products; // of the last solve(), if K > 1
  };
} // namespace greville
