// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/loads/surface_load.h>
#include <greville/stiffness/tangent_system.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  struct GeneralParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string              name;
    unsigned int             dimension = 2;
    std::vector<std::string> bodies;
    std::vector<std::string> materials;
    std::vector<std::string> surface_loads;
    std::vector<std::string> rigid_bodies;
    std::vector<std::string> contacts;
    std::vector<std::string> stages;
    std::vector<std::string> shared_libraries;
    bool                     pore_water = false;
  };



  struct WaterParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Return the pressure under a column of water of height 1 on earth, Pa /
    /// m.
    double
    unit_weight() const
    {
      return 9.81 * density;
    }

    /// Return the suction of the capillary height, Pa.
    double
    suction() const
    {
      return unit_weight() * capillary_height;
    }

    double      density      = 1000.;
    double      bulk_modulus = 2.2e9; // 0: infinite
    std::string table;
    double      capillary_height = 0.; // 0: infinite
    std::string free_surface_pressure;
    /// BDF2 in place of backward Euler.
    bool is_second_order = false;
  };



  /// A region in which cells are refined.
  struct RefinementParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string  shape;
    unsigned int levels = 1;
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
    /// The regions that 'refinement' names.
    std::map<std::string, RefinementParameters> regions;

    bool
    is_refined() const
    {
      return !regions.empty();
    }

    /// Return how often cells are halved at most.
    unsigned int
    n_levels() const
    {
      unsigned int n = 0;
      for (const auto &region : regions)
        n = std::max(n, region.second.levels);
      return n;
    }

    /// Return the levels of a refined grid for a mesh; null for a grid without
    /// refinement. Throws dealii::ExcMessage for invalid shapes.
    template <int dim>
    std::shared_ptr<const CellHierarchy<dim>>
    hierarchy() const;

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

    /// Set the number of cells and the edges from a text "fine(...) ...".
    void
    complete(const unsigned int dim);

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



  /// The solver of the consistent mass, and of the pore pressure of explicit
  /// steps. A tolerance of 0 stands for SimulationParameters::mass_tolerance().
  struct ConsistentSolverParameters : SolverParameters
  {
    ConsistentSolverParameters()
    {
      tolerance = 0.;
    }

    void
    declare(dealii::ParameterHandler &prm);

    /// Return the tolerance for all systems except the mass of explicit steps.
    double
    tight_tolerance() const
    {
      return tolerance > 0. ? tolerance : SolverParameters().tolerance;
    }

    /// Return whether the preconditioner is a factorization, the cycle of
    /// p-multigrid, or the diagonal. Otherwise, it is the identity.
    bool
    has_factorization() const
    {
      return method == "cg-ic0";
    }

    bool
    has_cycle() const
    {
      return method == "cg-p-multigrid";
    }

    bool
    has_diagonal() const
    {
      return method == "cg-jacobi";
    }

    std::string method = "cg-ic0";
  };



  /// A load on the surface of a body with fitted points.
  struct SurfaceLoadParameters
  {
    /// Declare the common parameters, and then the parameters of this kind.
    void
    declare(dealii::ParameterHandler &prm);

    /// Throw dealii::ExcMessage if the kind of load lacks a parameter, or if
    /// the @p bodies do not support a load on the surface.
    void
    check(const std::string                           &section,
          const std::map<std::string, BodyParameters> &bodies) const;

    bool
    passes_water() const
    {
      return !pore_pressure.empty() || !flux.empty();
    }

    std::string body;
    std::string where;
    std::string kind_name = "traction";
    /// The parameters of this kind only; null in the reference of all kinds.
    std::shared_ptr<SurfaceLoadKind> kind;

    std::string pore_pressure;
    bool        seepage_face = false;
    std::string flux;
  };



  /// A rigid body. It moves as prescribed, or freely by gravity and contact
  /// forces.
  struct RigidBodyParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Throw dealii::ExcMessage if the parameters of the @p section contradict
    /// each other.
    void
    check(const std::string &section, const unsigned int dim) const;

    std::string         shape;
    std::string         shape_file;
    double              shape_file_unit = 1.;
    std::vector<double> reference_point;
    std::string         velocity;
    std::string         rotation;
    bool                is_free = false;
    double              density = 0.;
    double              mass    = 0.;
    std::vector<double> inertia;
  };



  /// Contact of two sides, each of which is a body, several bodies that stick
  /// to one another, or (the second one) a rigid body.
  struct ContactParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::array<std::vector<std::string>, 2>
    sides() const;

    /// Throw dealii::ExcMessage if the parameters of the @p section do not
    /// match the bodies.
    void
    check(const std::string                                &section,
          const std::map<std::string, BodyParameters>      &bodies,
          const std::map<std::string, RigidBodyParameters> &rigid) const;

    /// Return whether gaps are closed by iterations of the method of Uzawa.
    bool
    is_augmented() const
    {
      return method == "augmented";
    }

    /// Return whether contact acts on material points of the first side instead
    /// of points on its surface.
    bool
    is_by_material_points() const
    {
      return contactors == "material points";
    }

    std::string bodies;
    std::string contactors = "surface points";
    std::string friction   = "0";
    double      adhesion   = 0.;
    double      penalty    = 0.; // 0: that of the scheme
    std::string method     = "penalty";
    double      damping    = 0.;
  };
} // namespace greville
