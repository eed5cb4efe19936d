// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/loads/surface_load.h>
#include <greville/parameters/grid_parameters.h>
#include <greville/stiffness/tangent_system.h>

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

    bool
    is_rough() const
    {
      return friction == "rough";
    }

    /// Return whether the strength may depend on the pressure.
    bool
    depends_on_pressure() const
    {
      return friction != "0" && !is_rough();
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
