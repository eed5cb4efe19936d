// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3

// Checks the derivative of averaged contact:
// - it agrees with the contact forces for bodies that move without deformation,
//   with one and two sides, in stick and slip, and with pore pressure;
// - it is negative, conserves momentum, and is symmetric without sliding;
// - single points resist at least as much as their averages;
// - friction follows the effective pressure: none if water bears all, and none
//   without pressure;
// - the iterations of Uzawa's method close a gap between springs.

#include <greville/contact/averaged_contact.h>

#include <cmath>
#include <tests.h>

const MPI_Comm comm = MPI_COMM_WORLD;

template <int dim>
using Field = std::vector<Tensor<1, dim>>;



template <int dim>
double
product(const Field<dim> &a, const Field<dim> &b)
{
  double sum = 0.;
  for (std::size_t s = 0; s < a.size(); ++s)
    sum += a[s] * b[s];
  return Utilities::MPI::sum(sum, comm);
}



// Points of both sides on a plane with the normal n of side 1, of which this
// process has its share; those of side 0 lie deeper by @p depth.
template <int dim>
struct Case
{
  std::vector<ContactPoint<dim>> points;
  Field<dim>                     noise[2];
  Tensor<1, dim>                 normal, tangent;

  // Pores have pressures about @p pore.
  Case(const bool has_two_sides, const double depth, const double pore = 0.)
  {
    normal[0]  = -0.3;
    normal[1]  = 0.9;
    normal     = normal / normal.norm();
    tangent[0] = normal[1];
    tangent[1] = -normal[0];
    Tensor<1, dim> other;
    other[dim - 1] = dim == 3;
    unsigned int k = 0;
    for (unsigned int side = 0; side < (has_two_sides ? 2 : 1); ++side)
      {
        const unsigned int n = side == 0 ? 31 : 23, m = dim == 2 ? 1 : n / 3;
        for (unsigned int i = 0; i < n * m; ++i, ++k)
          {
            Tensor<1, dim> random[2];
            for (unsigned int r = 0; r < 2; ++r)
              for (unsigned int d = 0; d < dim; ++d)
                random[r][d] = std::sin(12.9898 * k + 78.233 * (2 * d + r));
            if (k % Utilities::MPI::n_mpi_processes(comm) !=
                Utilities::MPI::this_mpi_process(comm))
              continue;
            ContactPoint<dim> point;
            point.side          = side;
            point.x             = Point<dim>((i % n + 0.5) / n * tangent +
                                 (i / n + 0.5) / m * other);
            point.normal        = (side == 0 ? -1. : 1.) * normal;
            point.target_normal = (side == 0 ? 1. : -1.) * normal;
            point.area          = 1. / (n * m);
            point.gap           = -depth;
            point.is_facing     = true;
            point.pore_pressure = pore * (1. + 0.3 * random[0][0]);
            points.push_back(point);
            for (unsigned int r = 0; r < 2; ++r)
              noise[r].push_back(random[r]);
          }
      }
  }

  // The forces after motions of both sides as a whole.
  Field<dim>
  forces(const AveragedContact<dim>  &contact,
         const Tensor<1, dim>        &of_0,
         const Tensor<1, dim>        &of_1,
         ContactTangent<dim>         *derivative,
         Field<dim>                  &motions,
         std::vector<Tensor<2, dim>> *stiffness = nullptr,
         const double                 dt        = 0.) const
  {
    auto moved = points;
    motions.clear();
    for (auto &point : moved)
      {
        point.motion = point.side == 0 ? of_0 : of_1;
        point.gap += (of_0 - of_1) * normal;
        point.x += point.motion;
        point.offset_from_hats = point.motion;
        motions.push_back(point.motion);
      }
    contact.act(moved, dt, Point<dim>(), derivative);
    Field<dim> result;
    for (const auto &point : moved)
      {
        result.push_back(point.force);
        if (stiffness)
          stiffness->push_back(point.stiffness);
      }
    return result;
  }
};



template <int dim>
void
test_derivative(const bool         has_two_sides,
                const double       slip,
                const std::string &friction = "0.3",
                const double       pore     = 0.)
{
  ContactLaw law;
  law.stiffness       = 1e4;
  law.shear_stiffness = 5e3;
  law.friction        = make_friction_law(friction, "Friction");
  law.has_two_sides   = has_two_sides;
  Tensor<1, dim> h;
  for (unsigned int d = 0; d < dim; ++d)
    h[d] = 0.13 + 0.01 * d;
  const AveragedContact<dim> contact(law,
                                     {Lattice<dim>(Point<dim>(), h)},
                                     comm);
  const Case<dim>            all(has_two_sides, 1e-3, pore);
  const Tensor<1, dim>       still;
  const Tensor<1, dim>       start       = slip * all.tangent;
  const double               step_length = friction == "0.3" ? 0. : 0.01;

  ContactTangent<dim>         tangent;
  Field<dim>                  motions, product_by_tangent;
  std::vector<Tensor<2, dim>> stiffness;
  all.forces(contact, start, still, &tangent, motions, &stiffness, step_length);

  const bool       slides = slip > 0.6e-3;
  constexpr double step   = 1e-7;
  for (unsigned int side = 0; side < (has_two_sides ? 2 : 1); ++side)
    for (const Tensor<1, dim> &direction : {all.normal, all.tangent})
      {
        const auto at = [&](const double amount) {
          Field<dim> unused;
          return all.forces(contact,
                            start + (side == 0 ? amount : 0.) * direction,
                            still + (side == 1 ? amount : 0.) * direction,
                            nullptr,
                            unused,
                            nullptr,
                            step_length);
        };
        const Field<dim> upper = at(step), lower = at(-step);
        Field<dim>       u;
        for (const auto &point : all.points)
          u.push_back(point.side == side ? direction : still);
        tangent.multiply(u, product_by_tangent);
        double error = 0., size = 0.;
        for (std::size_t s = 0; s < u.size(); ++s)
          {
            const Tensor<1, dim> exact = (upper[s] - lower[s]) / (2. * step);
            error = std::max(error, (exact - product_by_tangent[s]).norm());
            size  = std::max(size, exact.norm());
          }
        error = Utilities::MPI::max(error, comm);
        size  = Utilities::MPI::max(size, comm);
        check("The tangent is the derivative.",
              error <= 1e-6 * std::max(size, 1.));
        check("There is one, except along the direction of sliding.",
              friction != "0.3" ||
                (size > 1.) == !(slides && direction * all.tangent > 0.5));
      }

  const auto at = [&](const double amount) {
    Case<dim> changed = all;
    for (std::size_t s = 0; s < changed.points.size(); ++s)
      changed.points[s].pore_pressure += amount * all.noise[0][s][0];
    Field<dim> unused;
    return changed.forces(
      contact, start, still, nullptr, unused, nullptr, step_length);
  };
  const Field<dim>    upper = at(1e-3), lower = at(-1e-3);
  std::vector<double> dp;
  for (const Tensor<1, dim> &value : all.noise[0])
    dp.push_back(value[0]);
  tangent.multiply(Field<dim>(dp.size()), product_by_tangent, &dp);
  double error = 0., size = 0.;
  for (std::size_t s = 0; s < dp.size(); ++s)
    {
      const Tensor<1, dim> exact = (upper[s] - lower[s]) / 2e-3;
      error = std::max(error, (exact - product_by_tangent[s]).norm());
      size  = std::max(size, exact.norm());
    }
  error = Utilities::MPI::max(error, comm);
  size  = Utilities::MPI::max(size, comm);
  check("The tangent is the derivative by the pressure of pores.",
        error <= 1e-6 * size);
  check("There is one where surfaces slide.", (size > 0.) == slides);

  Field<dim> products[2];
  for (unsigned int r = 0; r < 2; ++r)
    tangent.multiply(all.noise[r], products[r]);
  const double mixed = product<dim>(all.noise[0], products[1]);
  const double own   = product<dim>(all.noise[0], products[0]);
  check("It is symmetric.",
        slides || std::abs(mixed - product<dim>(all.noise[1], products[0])) <
                    1e-12 * std::abs(own));
  check("It is negative.", slides || own < 0.);
  Tensor<1, dim> sum;
  for (const Tensor<1, dim> &force : products[0])
    sum += force;
  sum = Utilities::MPI::sum(sum, comm);
  check("It keeps momentum.",
        !has_two_sides || sum.norm() < 1e-12 * std::abs(own));
  for (unsigned int side = 0; side < (has_two_sides ? 2 : 1); ++side)
    {
      Field<dim> u = all.noise[0], of_average, of_points;
      for (std::size_t s = 0; s < u.size(); ++s)
        {
          if (all.points[s].side != side)
            u[s] = still;
          of_points.push_back(stiffness[s] * u[s]);
        }
      tangent.multiply(u, of_average);
      check("Points by themselves are as stiff as averages, or stiffer.",
            slides ||
              product<dim>(u, of_points) >= -product<dim>(u, of_average));
    }
}



// A side that slides over a rigid one, with water.
void
test_effective_pressure()
{
  ContactLaw law;
  law.stiffness       = 1e4;
  law.shear_stiffness = 5e3;
  law.friction        = make_friction_law("0.3", "Friction");
  law.has_two_sides   = false;
  const AveragedContact<2> contact(
    law, {Lattice<2>(Point<2>(), Tensor<1, 2>({0.13, 0.13}))}, comm);
  // The force, with the pressure 10 Pa for a depth of 1 mm.
  const auto force = [&](const Case<2> &all) {
    Field<2>     unused;
    Tensor<1, 2> sum;
    for (const Tensor<1, 2> &of_point :
         all.forces(contact, 0.01 * all.tangent, {}, nullptr, unused))
      sum += of_point;
    return Utilities::MPI::sum(sum, comm);
  };
  for (const double pore : {0., 4., -4.})
    {
      const Case<2> all(false, 1e-3, pore);
      double        water = 0.;
      for (const auto &point : all.points)
        water += point.area * point.pore_pressure;
      water                    = Utilities::MPI::sum(water, comm);
      const Tensor<1, 2> given = force(all);
      check("The pressure is the total one.",
            std::abs(given * all.normal - 10.) < 1e-12);
      check("Friction is that of the effective one.",
            std::abs(given * all.tangent + 0.3 * (10. - water)) < 1e-12);
    }
  const Case<2> bears_all(false, 1e-3, 100.);
  check("Where water bears all there is none.",
        std::abs(force(bears_all) * bears_all.tangent) < 1e-12);
  check("Suction holds nothing where nothing presses.",
        force(Case<2>(false, -1e-6, -100.)).norm() == 0.);
}



// A side on a spring above a rigid one.
void
test_rounds()
{
  ContactLaw law;
  law.stiffness     = 10.;
  law.has_two_sides = false;
  const AveragedContact<2> contact(
    law, {Lattice<2>(Point<2>(), Tensor<1, 2>({0.13, 0.13}))}, comm);
  const Case<2> all(false, 0.);
  KeyMemory<2>  memory;
  // The spring of stiffness 1 per area is pressed by 1: without a gap, p = 1.
  const double stiffness[3] = {10. / 11., 1. - 1. / 121., 1. - 1. / 1331.};
  for (unsigned int round = 0; round < 3; ++round)
    {
      double pressure = 0.;
      for (unsigned int k = 0; k < 200; ++k)
        {
          auto moved = all.points;
          for (auto &point : moved)
            point.gap = pressure - 1.; // of the spring
          const auto result =
            contact.act(moved, 0., Point<2>(), nullptr, &memory);
          pressure += 0.05 * (result.force.norm() / result.area - pressure);
        }
      check("A round divides the gap by eleven.",
            std::abs(pressure - stiffness[round]) < 1e-8);
      memory.given          = memory.found;
      memory.is_first_round = false;
    }
}



void
test_main()
{
  for (const bool has_two_sides : {false, true})
    for (const double slip : {0., 0.3e-3, 1e-3})
      {
        test_derivative<2>(has_two_sides, slip);
        test_derivative<3>(has_two_sides, slip);
        // The pressure is 10 Pa, and the speed up to 0.1 m / s.
        const std::string friction = "0.3 + 0.1 * exp(-v / 0.05) - 0.005 * p";
        test_derivative<2>(has_two_sides, slip, friction);
        test_derivative<3>(has_two_sides, slip, friction);
        test_derivative<2>(has_two_sides, slip, "0.3", 4.);
        test_derivative<3>(has_two_sides, slip, friction, 4.);
      }
  test_effective_pressure();
  test_rounds();
}
