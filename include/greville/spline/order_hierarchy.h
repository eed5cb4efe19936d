// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/parameters.h>
#include <greville/spline/spline_space.h>

namespace greville
{
  /// The orders of the levels of p-multigrid.
  enum class Coarsening
  {
    one_by_one, // p, p - 1, ..., 1
    by_two,     // p, p - 2, ..., 1; the last step may be by one
    direct,     // p, 1
    none,       // p alone
    lattice,    // p alone, on lattices that become coarser
    hp          // the same, with order 1 on the coarsest lattice
  };

  inline const Choices<Coarsening> coarsenings = {
    {Coarsening::one_by_one, "one by one"},
    {Coarsening::by_two, "by two"},
    {Coarsening::direct, "direct"},
    {Coarsening::none, "none"},
    {Coarsening::lattice, "lattice"},
    {Coarsening::hp, "hp"}};



  /// The levels of p-multigrid: spline spaces of decreasing order on one mesh
  /// (@ref Tielen2019 "Tielen, Moeller and Vuik, 2019"). As in deal.II, level 0
  /// is the coarsest. It has order 1 unless the hierarchy has a single level.
  template <int dim>
  class OrderHierarchy
  {
  public:
    OrderHierarchy() = default;

    OrderHierarchy(DistributedTriangulation<dim> &triangulation,
                   const unsigned int             degree,
                   const Coarsening coarsening = Coarsening::one_by_one)
    {
      reinit(triangulation, degree, coarsening);
    }

    /// Collective. The cells are the cells of the mesh or their parents, see
    /// SplineSpace.
    void
    reinit(DistributedTriangulation<dim> &triangulation,
           const unsigned int             degree,
           const Coarsening               coarsening,
           const bool                     on_parents = false)
    {
      spaces.clear();
      for (const unsigned int order : orders(degree, coarsening))
        spaces.emplace_back(triangulation, order, on_parents);
    }

    /// Return the orders from the coarsest to the finest level.
    static std::vector<unsigned int>
    orders(const unsigned int degree, const Coarsening coarsening);

    unsigned int
    n_levels() const
    {
      return spaces.size();
    }

    const SplineSpace<dim> &
    operator[](const unsigned int level) const
    {
      AssertThrow(level < spaces.size(),
                  dealii::ExcIndexRange(level, 0, spaces.size()));
      return spaces[level];
    }

    const SplineSpace<dim> &
    finest() const
    {
      return spaces.back();
    }

  private:
    std::vector<SplineSpace<dim>> spaces;
  };
} // namespace greville
