// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_water_terms_h
#define greville_points_water_terms_h

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>

namespace greville
{
  /**
   * What a material says of the water in it.
   */
  struct WaterConstants
  {
    /// Porosity over the bulk modulus of water, 1 / Pa.
    double storage = 0.;
    /// Hydraulic conductivity over the unit weight of water, m^2 / (Pa s), in
    /// the stress-free state where there is a solid part.
    double mobility = 0.;
    /// 1 - porosity where the conductivity follows the void ratio; 0: it is
    /// constant.
    double solid = 0.;
    /// Pa, see relative_conductivity().
    double suction = 0.;
  };



  /**
   * The law of Kozeny and Carman (@ref Carman1937 "1937"): e^3 / (1 + e) over
   * its value for J = 1, with the void ratio e of 1 + e = J / solid, and its
   * derivative by J. At least 1e-6, where hardly a pore is left.
   */
  std::array<double, 2>
  kozeny_carman(const double J, const double solid);

  /**
   * The conductivity at a pressure p (Pa) over that of full pores, and its
   * derivative: it falls smoothly from 1 at p = 0 to 1e-3 at p = -suction. 1
   * where the suction is 0. This lets water leave the soil above a free surface
   * (@ref Bathe1979 "Bathe and Khoshgoftaar, 1979"); the pores stay full.
   */
  std::array<double, 2>
  relative_conductivity(const double p, const double suction);



  /**
   * A point of the boundary at which the pressure or the flow is given.
   */
  template <int dim>
  struct DrainedPoint
  {
    enum class Kind
    {
      pressure,
      seepage, // p is at most the pressure, and water only leaves
      flux
    };

    Kind         kind = Kind::pressure;
    unsigned int cell;     // owned
    unsigned int boundary; // the number of the wall or the surface
    /// Where the basis functions are taken, m.
    dealii::Point<dim> x;
    /// The normal, outwards, times the area at the start of the step.
    dealii::Tensor<1, dim> area;
    /// From gradients with respect to x to those at the start of the step:
    /// 1, or the inverse of F in total Lagrangian steps.
    dealii::Tensor<2, dim> to_basis;
    /// Pa; of the kind flux the flow outwards, m / s.
    double value;
    /// See WaterConstants, and the volume at the start of the step over that of
    /// the stress-free state.
    double mobility = 0.;
    double solid    = 0.;
    double old_J    = 1.;
    /// Of Nitsche's method, over the size of a cell at the start, 1 / m.
    double penalty = 0.;
    /// The distance from the axis at the start, m; 0 without axisymmetry.
    double radius = 0.;
  };



  /**
   * What a point of a body, or of a drained boundary, gives to the sums of
   * WaterPoints, which has the equations, and the derivatives of that.
   */
  template <int dim>
  struct WaterTerms
  {
    /**
     * A term of the sums. Those of a cell follow one another.
     */
    struct Term
    {
      unsigned int           cell;
      dealii::Point<dim>     x;
      dealii::Tensor<2, dim> to_basis;
      // See WaterConstants; of points times the volume at the start.
      double mobility = 0., solid = 0., suction = 0.;
      // The volume at the start over that of the stress-free state.
      double old_J = 1.;
      // Of axisymmetric ones: the distance from the axis at the start, that to
      // which the change of the volume is relative, and that at the end.
      double radius = 0., radius_of_F = 0., end_radius = 0.;

      // At the end of a trial step: the volume relative to the start and its
      // change, what makes gradients there of those of the basis functions, and
      // the pressure.
      double                 J = 1., change = 0.;
      dealii::Tensor<2, dim> map;
      double                 p = 0.;
      dealii::Tensor<1, dim> gradient;
      // The sums of the absolute values of what change, p and gradient are the
      // sums of.
      double change_size = 0., p_size = 0., gradient_size = 0.;
    };

    struct Point : Term
    {
      double volume; // at the start
      // Times volumes: V0 phi / K_w, and V over the modulus of pressure waves.
      double storage, compliance;
      // Over the density, and the volume times div u of
      // WaterPoints::set_free_motion().
      double of_mass, of_surface = 0.;
      double old_p;
      // What the last steps say of the water that comes, see WaterPoints.
      double earlier = 0.;
    };

    struct Drained : Term
    {
      typename DrainedPoint<dim>::Kind kind;
      dealii::Tensor<1, dim>           area, end_area;
      double                           value, penalty;
      unsigned int                     boundary;
    };

    /**
     * That of a term at the end of the last trial step, and its derivatives by
     * the relative change of volume and by the pressure.
     */
    struct Mobility
    {
      double value, by_volume, by_pressure;
    };

    /**
     * What a term gives: to the force by gradients of N and, along r, by N; to
     * the rows by q and by gradients of q.
     */
    struct Sources
    {
      dealii::Tensor<2, dim> force;
      double                 radial = 0.;
      double                 value  = 0.;
      dealii::Tensor<1, dim> gradient;
      // See Term: round-off of value and gradient is relative to these.
      double value_size = 0., gradient_size = 0.;
    };

    /**
     * A direction at a term, with gradients at the end.
     */
    struct Change
    {
      dealii::Tensor<2, dim> h;         // of the displacement
      double                 hoop = 0.; // that along r over r
      double                 p    = 0.;
      dealii::Tensor<1, dim> gradient;
    };

    /// The area at the end, from the @p inverse of 1 + grad u.
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

    /// At the end of the last trial step, in a direction.
    Sources
    derivative(const Drained &term, const Change &change) const;

    static Mobility
    mobility(const Term &term);

    /// Times the area at the end; of seepage faces without its sign.
    double
    outflow(const Drained &term) const;

    /// Of the step, s, and of water per volume, N / m^3.
    double                 dt = 0.;
    dealii::Tensor<1, dim> weight;
    bool                   is_axisymmetric = false;
  };
} // namespace greville

#endif
