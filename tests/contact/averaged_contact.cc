// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3

// Checks gaps between surfaces that are given only by points, and averaged
// contact:
// - the projection onto curved surfaces has a second-order error in the point
//   spacing, a thousandth of the sagitta, and is exact on planes and at their
//   ends;
// - a uniform overlap has the exact pressure on any grid, and momentum is
//   conserved to round-off if surfaces cut the grid and differ in spacing;
// - friction sticks, slides at mu times the pressure and reverses, with a law
//   of this program and with formulas of pressure and speed;
// - opposite faces of a plate do not touch one another.

#include <greville/contact/averaged_contact.h>
#include <greville/contact/overlap.h>
#include <greville/contact/surface_search.h>

#include <cmath>
#include <tests.h>

const MPI_Comm comm = MPI_COMM_WORLD;

// The points of which this process has its share.
template <int dim>
struct Points
{
  std::vector<ContactPoint<dim>> points;
  unsigned int                   n = 0;

  void
  add(const unsigned int    side,
      const Point<dim>     &x,
      const Tensor<1, dim> &normal,
      const double          area,
      const double          thickness = 1.)
  {
    if (n++ % Utilities::MPI::n_mpi_processes(comm) !=
        Utilities::MPI::this_mpi_process(comm))
      return;
    ContactPoint<dim> point;
    point.side      = side;
    point.x         = x;
    point.normal    = normal / normal.norm();
    point.area      = area * thickness;
    point.thickness = thickness;
    points.push_back(point);
  }
};



template <int dim>
double
largest(const Points<dim>                                           &all,
        const std::function<double(const ContactPoint<dim> &point)> &value)
{
  double result = 0.;
  for (const auto &point : all.points)
    result = std::max(result, value(point));
  return Utilities::MPI::max(result, comm);
}



// The error of the gap between two circles, or spheres, about one center, with
// the radius of one unit, in units; of the section of spheres in axisymmetry.
template <int dim>
double
error_of_gap(const unsigned int n,
             const double       unit            = 1.,
             const bool         is_axisymmetric = false)
{
  constexpr double gap = 0.01;
  Points<dim>      all;
  for (unsigned int side = 0; side < 2; ++side)
    {
      const double r       = (side == 0 ? 1. : 1. + gap) * unit,
                   sign    = side == 0 ? 1. : -1.;
      const unsigned int m = n + 3 * side;
      if (is_axisymmetric)
        for (unsigned int k = 0; k < m; ++k)
          {
            const double   angle = numbers::PI * ((k + 0.5) / m - 0.5);
            Tensor<1, dim> e;
            e[0] = std::cos(angle);
            e[1] = std::sin(angle);
            all.add(
              side, Point<dim>(r * e), sign * e, numbers::PI * r / m, r * e[0]);
          }
      else if constexpr (dim == 2)
        for (unsigned int k = 0; k < m; ++k)
          {
            const double         angle = 2. * numbers::PI * k / m;
            const Tensor<1, dim> e({std::cos(angle), std::sin(angle)});
            all.add(side,
                    Point<dim>(r * e),
                    sign * e,
                    2. * numbers::PI * r / m);
          }
      else
        // The spiral of Fibonacci has equal areas.
        for (unsigned int k = 0; k < m * m; ++k)
          {
            const double         z     = 1. - (2. * k + 1.) / (m * m);
            const double         angle = k * numbers::PI * (3. - std::sqrt(5.));
            const double         rho   = std::sqrt(1. - z * z);
            const Tensor<1, dim> e(
              {rho * std::cos(angle), rho * std::sin(angle), z});
            all.add(side,
                    Point<dim>(r * e),
                    sign * e,
                    4. * numbers::PI * r * r / (m * m));
          }
    }
  SurfaceSearch<dim>(is_axisymmetric, comm).find_gaps(all.points, 0.05 * unit);
  check("All points face the other circle.",
        largest<dim>(all, [](const auto &point) { return !point.is_facing; }) ==
          0.);
  return largest<dim>(all, [&](const auto &point) {
    return std::abs(point.gap / unit - gap);
  });
}



// Gaps do not depend on the unit of length.
template <int dim>
void
test_units(const unsigned int n, const bool is_axisymmetric)
{
  const double error = error_of_gap<dim>(n, 1., is_axisymmetric);
  for (const double unit : {1e-3, 1e3})
    check("Errors are the same in all units.",
          std::abs(error_of_gap<dim>(n, unit, is_axisymmetric) - error) <
            1e-12);
}



// Two squares of points, of which one overlaps the other by a part of a cell.
double
excess_of_overlap(const double depth, const double unit)
{
  constexpr double            spacing = 0.5;
  constexpr unsigned int      n       = 12;
  std::vector<VolumePoint<2>> points;
  for (unsigned int side = 0; side < 2; ++side)
    for (unsigned int k = 0; k < n * n; ++k)
      {
        VolumePoint<2> point;
        point.side   = side;
        point.volume = std::pow(spacing * unit, 2);
        point.x      = unit * Point<2>((k % n + 0.5) * spacing,
                                  (k / n + 0.5) * spacing +
                                    side * (n * spacing - depth));
        if (k % Utilities::MPI::n_mpi_processes(comm) ==
            Utilities::MPI::this_mpi_process(comm))
          points.push_back(point);
      }
  const Overlap<2> found =
    largest_overlap(points, Tensor<1, 2>({unit, unit}), comm);
  check("The overlap is where both are.",
        found.excess < 0.01 || depth > 1. ||
          std::abs(found.x[1] / unit - (n * spacing - 0.5 * depth)) < 1.);
  return found.excess;
}



void
test_overlap()
{
  for (const double unit : {1e-3, 1., 1e3})
    {
      check("Squares that touch do not overlap.",
            excess_of_overlap(0., unit) < 1e-12);
      const double half = excess_of_overlap(0.5, unit);
      check("Half a cell is found.", half > 0.25 && half < 0.45);
      check("One is all of the other.", excess_of_overlap(6., unit) > 0.99);
    }
}



// A plate of thickness d along x from 0 to 1, with its points at a slope, above
// another surface by @p gap.
template <int dim>
Points<dim>
plates(const double slope, const double gap, const unsigned int n)
{
  const Tensor<1, dim> t =
    dim == 2 ? Tensor<1, dim>({std::cos(slope), std::sin(slope)})
             : Tensor<1, dim>();
  Tensor<1, dim> normal;
  normal[0] = -t[1];
  normal[1] = t[0];
  Points<dim> all;
  for (unsigned int side = 0; side < 2; ++side)
    {
      const unsigned int m = n + 5 * side;
      for (unsigned int k = 0; k < m; ++k)
        all.add(side,
                Point<dim>((k + 0.5) / m * t + (1 - side) * gap * normal),
                side == 0 ? -normal : normal,
                1. / m);
    }
  return all;
}



// A law of this program: half of what Coulomb's has.
class HalvedFriction : public FrictionLaw
{
public:
  static std::unique_ptr<const FrictionLaw>
  make(const std::vector<double> &numbers)
  {
    AssertThrow(numbers.size() == 1, ExcMessage("it takes one number."));
    auto law = std::make_unique<HalvedFriction>();
    law->mu  = numbers[0];
    return law;
  }

  double
  strength(const double pressure, const double) const override
  {
    return 0.5 * mu * pressure;
  }

private:
  double mu = 0.;
};



void
test_friction_laws()
{
  const auto law = [](const std::string &text) {
    return make_friction_law(text, "Contact base/Friction");
  };
  check("A number is a coefficient.", law(" 0.3 ")->strength(2., 9.) == 0.6);
  check("Zero is symmetric, and so is rough.",
        law("0")->is_symmetric() && law("rough")->is_symmetric() &&
          !law("0.3")->is_symmetric());
  check("Rough surfaces have infinite strength.",
        std::isinf(law("rough")->strength(1., 0.)));
  const auto of_both = law("0.2 + 0.1 * exp(-v) + 1e-3 * p");
  check("A formula is one of p and v.",
        std::abs(of_both->strength(2., 1.) -
                 2. * (0.202 + 0.1 * std::exp(-1.))) < 1e-15);
  check("Negative coefficients count as zero.",
        law("0.1 - v")->strength(1., 0.2) == 0.);
  const auto slopes = of_both->slopes(2., 1.);
  check("Slopes are derivatives.",
        std::abs(slopes.by_pressure - 0.204 - 0.1 * std::exp(-1.)) < 1e-6 &&
          std::abs(slopes.by_speed + 0.2 * std::exp(-1.)) < 1e-6);
  for (const std::string wrong :
       {"-0.1", "nan", "0.1 * w", "1 / v", "rough(1)", "halved", "halved(1"})
    {
      std::string message;
      try
        {
          law(wrong);
        }
      catch (const std::exception &exception)
        {
          message = exception.what();
        }
      check("A wrong law names the parameter.",
            message.find("Contact base/Friction") != std::string::npos);
    }
}



void
test_pressure()
{
  constexpr double depth = 1e-3, friction = 0.3;
  ContactLaw       law;
  law.stiffness       = 1e4;
  law.shear_stiffness = 5e3;
  law.friction        = make_friction_law("halved(0.6)", "Friction");
  for (const double slope : {0., 0.3, 2.2})
    {
      Points<2> all = plates<2>(slope, -depth, 64);
      SurfaceSearch<2>(false, comm).find_gaps(all.points, 0.05);
      const Tensor<1, 2>       n({-std::sin(slope), std::cos(slope)});
      const Tensor<1, 2>       t({std::cos(slope), std::sin(slope)});
      const AveragedContact<2> contact(law,
                                       {Lattice<2>(Point<2>(-0.013, 0.007),
                                                   Tensor<1, 2>({0.11, 0.09}))},
                                       comm);
      check("The gap of planes is exact.",
            largest<2>(all, [&](const auto &point) {
              return point.is_facing ? std::abs(point.gap + depth) : 0.;
            }) < 1e-15);
      double missing = 0.;
      for (const auto &point : all.points)
        missing += point.is_facing ? 0. : point.area;
      check("Surfaces face one another up to their ends.",
            Utilities::MPI::sum(missing, comm) < 0.05);
      auto result = contact.act(all.points, 0., Point<2>());
      check("The pressure is the stiffness times the depth.",
            std::abs(result.force * n / (10. * result.area) - 1.) < 1e-12);
      check("There is no shear.", std::abs(result.force * t) < 1e-12);
      check("The area is that of a plate.", std::abs(result.area - 1.) < 0.03);
      const auto sum_of_forces = [&]() {
        Tensor<1, 2> sum;
        for (const auto &point : all.points)
          sum += point.force;
        return Utilities::MPI::sum(sum, comm);
      };
      check("Momentum is kept.", sum_of_forces().norm() < 1e-13);
      const double pressure = result.force * n / result.area;
      const auto   all_are  = [&](const ContactState state) {
        return largest<2>(all, [&](const auto &point) {
                 return point.is_facing && point.state != state;
               }) == 0.;
      };
      check("They stick.", all_are(ContactState::stick));

      // Slip by a tenth of what friction bears, ten times: then it slides.
      const double stick = friction * pressure / law.shear_stiffness;
      for (unsigned int k = 1; k <= 20; ++k)
        {
          for (auto &point : all.points)
            {
              point.motion = (point.side == 0 ? 0.1 * stick : 0.) * t;
              point.slip   = point.new_slip;
            }
          result = contact.act(all.points, 0., Point<2>());
          check("Friction grows with slip up to its limit.",
                std::abs(-result.force * t / result.area /
                           (friction * pressure) -
                         std::min(1., 0.1 * k)) < (k < 10 ? 1e-10 : 1e-3));
          check("Friction keeps momentum.", sum_of_forces().norm() < 1e-13);
          check("It slides beyond its limit.",
                k == 10 ||
                  all_are(k < 10 ? ContactState::stick : ContactState::slip));
        }
      // Back by twice what it bears: the other way.
      for (auto &point : all.points)
        {
          point.motion = (point.side == 0 ? -2. * stick : 0.) * t;
          point.slip   = point.new_slip;
        }
      result = contact.act(all.points, 0., Point<2>());
      check("Friction turns round.",
            std::abs(result.force * t / result.area / (friction * pressure) -
                     1.) < 1e-3);
      // Apart: no force, and the slip is forgotten.
      for (auto &point : all.points)
        point.gap = 1e-9;
      result = contact.act(all.points, 0., Point<2>());
      check("An open contact has no force.",
            result.force.norm() == 0. && result.area == 0. &&
              all_are(ContactState::open) &&
              largest<2>(all, [](const auto &point) {
                return point.new_slip.norm();
              }) == 0.);
    }
}



// Two plates that lie on both sides of a thin one, all within a cell.
void
test_thin_plate()
{
  ContactLaw law;
  law.stiffness = 1.;
  Points<2> all;
  for (unsigned int k = 0; k < 50; ++k)
    for (const int face : {-1, 1})
      {
        Tensor<1, 2> n;
        n[1] = face;
        all.add(0, Point<2>((k + 0.5) / 50., 0.01 * face), n, 0.02);
        all.add(1,
                Point<2>((k + 0.5) / 50., face == 1 ? 0.009 : -0.012),
                -n,
                0.02);
      }
  SurfaceSearch<2>(false, comm).find_gaps(all.points, 0.05);
  const AveragedContact<2> contact(
    law, {Lattice<2>(Point<2>(-0.03, -0.04), Tensor<1, 2>({0.1, 0.1}))}, comm);
  const auto result = contact.act(all.points, 0., Point<2>());
  check("The upper face is pressed, the lower one is free.",
        std::abs(result.force[1] + 1e-3 * result.area) < 1e-15);
}



void
test_main()
{
  add_friction_law("halved", HalvedFriction::make);
  test_friction_laws();
  for (const unsigned int n : {60, 120, 240})
    print() << "2D, " << n << " points: error of the gap "
            << error_of_gap<2>(n) * 1e4 << '\n';
  for (const unsigned int n : {40, 80})
    print() << "3D, " << n << " x " << n << " points: error of the gap "
            << error_of_gap<3>(n) * 1e4 << '\n';
  print() << "axisymmetric, 60 points: error of the gap "
          << error_of_gap<2>(60, 1., true) * 1e4 << '\n';
  test_units<2>(60, false);
  test_units<2>(60, true);
  test_units<3>(40, false);
  test_overlap();
  test_pressure();
  test_thin_plate();
}
