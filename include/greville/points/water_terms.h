// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>

namespace greville
{
  /// Constants of the pore water in a material.
  struct WaterConstants
  {
    /// Porosity over the bulk modulus of water, 1 / Pa.
    double storage = 0.;
    /// Hydraulic conductivity over the unit weight of water, m^2 / (Pa s); with
    /// @p solid, in the stress-free state.
    double mobility = 0.;
    /// 1 - porosity if the conductivity follows the void ratio; 0 if it is
    /// constant.
    double solid = 0.;
    /// The suction, Pa, see relative_conductivity().
    double suction = 0.;
  };



  /// Return the law of Kozeny and Carman (@ref Carman1937 "1937") and its
  /// derivative by J: e^3 / (1 + e) over its value for J = 1, with the void
  /// ratio e from 1 + e = J / solid. The value is at least 1e-6, even if hardly
  /// any pores are left.
  std::array<double, 2>
  kozeny_carman(const double J, const double solid);

  /**
   * Return the conductivity at a pressure p (Pa) relative to saturation, and
   * its derivative. It decreases smoothly from 1 at p = 0 to 1e-3 at p =
   * -suction, and is 1 if the suction is 0. This lets water leave the soil
   * above a free surface (@ref Bathe1979 "Bathe and Khoshgoftaar, 1979"); the
   * pores remain saturated.
   */
  std::array<double, 2>
  relative_conductivity(const double p, const double suction);



  /// The contributions of points of bodies and of drained boundaries to the
  /// sums of WaterPoints, which states the equations, and their derivatives.
  template <int dim>
  struct WaterTerms
  {
    /// A term of the sums. Terms of a cell are consecutive.
    struct Term
    {
      unsigned int cell; // owned
      // The position at which basis functions are evaluated, m, and the map
      // from gradients with respect to x to gradients at the start of the step:
      // 1, or the inverse of F in total Lagrangian steps.
      dealii::Point<dim>     x;
      dealii::Tensor<2, dim> to_basis;
      // See WaterConstants; for points, times the volume at the start.
      double mobility = 0., solid = 0., suction = 0.;
      // The volume at the start over the stress-free volume.
      double old_J = 1.;
      // For axisymmetric terms: the distance from the axis at the start, m, the
      // distance to which the change of volume is relative, and the distance at
      // the end.
      double radius = 0., radius_of_F = 0., end_radius = 0.;

      // At the end of a trial step: the volume relative to the start and its
      // change, the map from gradients of the basis functions to gradients at
      // the end, and the pressure.
      double                 J = 1., change = 0.;
      dealii::Tensor<2, dim> map;
      double                 p = 0.;
      dealii::Tensor<1, dim> gradient;
      // The sums of the absolute values of the terms in change, p and gradient.
      double change_size = 0., p_size = 0., gradient_size = 0.;
    };

    struct Point : Term
    {
      double volume; // at the start
      // V0 phi / K_w, and V over the modulus of pressure waves.
      double storage, compliance;
      // The volume over the density, and the volume times div u of
      // WaterPoints::set_free_motion().
      double of_mass, of_surface = 0.;
      double old_p;
      // The contribution of previous steps to the inflow, see WaterPoints.
      double earlier = 0.;
    };

    /// A boundary point with a given pressure or flow.
    struct Drained : Term
    {
      enum class Kind
      {
        pressure,
        seepage, // p is at most the pressure, and water only leaves
        flux
      };

      Kind kind = Kind::pressure;
      /// The outward normal times the area at the start and end of the step.
      dealii::Tensor<1, dim> area, end_area;
      /// The pressure, Pa; for the kind flux, the outflow, m / s.
      double value;
      /// Nitsche's penalty over the cell size at the start, 1 / m.
      double       penalty = 0.;
      unsigned int boundary; // the number of the wall or the surface
    };

    /// The mobility of a term at the end of the last trial step, and its
    /// derivatives by the relative change of volume and by the pressure.
    struct Mobility
    {
      double value, by_volume, by_pressure;
    };

    /// The contribution of a term: to the force by gradients of N and, along r,
    /// by N; to the rows by q and by gradients of q.
    struct Sources
    {
      dealii::Tensor<2, dim> force;
      double                 radial = 0.;
      double                 value  = 0.;
      dealii::Tensor<1, dim> gradient;
      // Round-off of value and gradient is relative to these sizes, see Term.
      double value_size = 0., gradient_size = 0.;
    };

    /// A direction of differentiation at a term, with gradients at the end.
    struct Change
    {
      dealii::Tensor<2, dim> h;         // of the displacement
      double                 hoop = 0.; // u_r / r
      double                 p    = 0.;
      dealii::Tensor<1, dim> gradient;
    };

    /// Compute the area at the end, from the @p inverse of 1 + grad u.
    void
    finish(Drained &term, const dealii::Tensor<2, dim> &inverse) const
    {
      term.end_area = term.J * (transpose(inverse) * term.area);
    }

    void
    finish(Point &, const dealii::Tensor<2, dim> &) const
    {}

    Sources
    sources(const Point &term) const;
    Sources
    sources(const Drained &term) const;

    /// Return the derivative of the sources at the end of the last trial step.
    Sources
    derivative(const Drained &term, const Change &change) const;

    static Mobility
    mobility(const Term &term);

    /// Return the outflow times the area at the end; for seepage faces, also if
    /// it is negative.
    double
    outflow(const Drained &term) const;

    /// The length of the step, s, and the weight of water per volume, N / m^3.
    double                 dt = 0.;
    dealii::Tensor<1, dim> weight;
    bool                   is_axisymmetric = false;
  };
} // namespace greville
