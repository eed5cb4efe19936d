// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1 2

// Checks a thick ring under inner pressure, with curved surfaces that cut the
// cells: the order of the displacement and of the stress at the inner wall, at
// small strain against Lame's solution and at large strain against the ordinary
// differential equation of a neo-Hookean ring. With TABLE=1 in the environment,
// it uses four meshes and prints the errors.
#include "simulation.h"

namespace
{
  constexpr double inner = 1., outer = 2.;   // m
  constexpr double lambda = 750., mu = 500.; // Pa

  /// At a radius: where it is now, and the Cauchy stresses along the radius and
  /// around the axis.
  struct Radial
  {
    double r, radial, hoop;
  };



  /// Lame's solution for small strains.
  struct LameRing
  {
    static constexpr const char *law = "linear-elastic";

    explicit LameRing(const double growth)
    {
      pressure = 1.;
      pressure = growth * inner / ((*this)(inner).r - inner);
    }

    Radial
    operator()(const double R) const
    {
      const double a2 = inner * inner, b2 = outer * outer;
      const double A = pressure * a2 / (b2 - a2);
      return {R + 0.5 * A * (R / (lambda + mu) + b2 / (mu * R)),
              A * (1. - b2 / (R * R)),
              A * (1. + b2 / (R * R))};
    }

    /// The stress of F.
    static SymmetricTensor<2, 2>
    stress(const Tensor<2, 2> &F)
    {
      const SymmetricTensor<2, 2> one = unit_symmetric_tensor<2>();
      const SymmetricTensor<2, 2> e   = symmetrize(F) - one;
      return lambda * trace(e) * one + 2. * mu * e;
    }

    double pressure;
  };



  /// Radial equilibrium dP_R / dR = (P_T - P_R) / R of a neo-Hookean ring in
  /// plane strain, whose inner radius grows by a share, by shooting: the slope
  /// dr / dR at the inner wall is that with which the outer one is free.
  struct NeoHookeanRing
  {
    static constexpr const char *law     = "neo-hookean";
    static constexpr int         n_steps = 4000;

    explicit NeoHookeanRing(const double growth)
    {
      double lower = 0.1, upper = 1.;
      for (unsigned int k = 0; k < 60; ++k)
        {
          const double middle = 0.5 * (lower + upper);
          integrate(1. + growth, middle);
          (nominal(slope.back(), place.back() / outer) < 0. ? lower : upper) =
            middle;
        }
      pressure = -(*this)(inner).radial;
    }

    /// By Runge and Kutta's method of order 4.
    void
    integrate(const double stretch, const double first_slope)
    {
      double r = stretch * inner, s = first_slope;
      place = {r};
      slope = {s};
      for (int k = 0; k < n_steps; ++k)
        {
          const double R  = inner + k * h;
          const double k1 = change(R, r, s);
          const double k2 = change(R + h / 2, r + h / 2 * s, s + h / 2 * k1);
          const double k3 =
            change(R + h / 2, r + h / 2 * (s + h / 2 * k1), s + h / 2 * k2);
          const double k4 = change(R + h, r + h * (s + h / 2 * k2), s + h * k3);
          r += h * (s + h / 6 * (k1 + k2 + k3));
          s += h / 6 * (k1 + 2. * k2 + 2. * k3 + k4);
          place.push_back(r);
          slope.push_back(s);
        }
    }

    /// The nominal stress along a direction with stretch @p a, where that
    /// across is @p b.
    static double
    nominal(const double a, const double b)
    {
      return (lambda * std::log(a * b) - mu) / a + mu * a;
    }

    /// d^2 r / dR^2.
    static double
    change(const double R, const double r, const double s)
    {
      const double q = r / R;
      const double by_s =
        (lambda - lambda * std::log(s * q) + mu) / (s * s) + mu;
      const double by_q = lambda / (s * q);
      return ((nominal(q, s) - nominal(s, q)) - by_q * (s - q)) / (R * by_s);
    }

    /// Between steps by Hermite's cubic polynomials.
    Radial
    operator()(const double R) const
    {
      const int    k = std::max(0, std::min(int((R - inner) / h), n_steps - 1));
      const double t = (R - inner) / h - k;
      const double a = (1. - t) * (1. - t) * (1. + 2. * t);
      const double b = t * (1. - t) * (1. - t), c = t * t * (t - 1.);
      const auto   value = [&](const std::vector<double> &f,
                             const double               begin,
                             const double               end) {
        return a * f[k] + (1. - a) * f[k + 1] + h * (b * begin + c * end);
      };
      const auto   at = [&](const int i) { return inner + i * h; };
      const double r  = value(place, slope[k], slope[k + 1]);
      const double s  = value(slope,
                             change(at(k), place[k], slope[k]),
                             change(at(k + 1), place[k + 1], slope[k + 1]));
      return {r, nominal(s, r / R) / (r / R), nominal(r / R, s) / s};
    }

    static SymmetricTensor<2, 2>
    stress(const Tensor<2, 2> &F)
    {
      const SymmetricTensor<2, 2> one = unit_symmetric_tensor<2>();
      const double                J   = determinant(F);
      return ((lambda * std::log(J) - mu) * one +
              mu * symmetrize(F * transpose(F))) /
             J;
    }

    double              h = (outer - inner) / n_steps;
    std::vector<double> place, slope;
    double              pressure;
  };



  /// The stress in the plane at an initial position.
  template <typename Ring>
  SymmetricTensor<2, 2>
  exact_stress(const Ring &ring, const Point<2> &X)
  {
    const Radial                exact  = ring(X.norm());
    const Tensor<1, 2>          e      = X / X.norm();
    const SymmetricTensor<2, 2> radial = symmetrize(outer_product(e, e));
    return exact.hoop * unit_symmetric_tensor<2>() +
           (exact.radial - exact.hoop) * radial;
  }



  /// Relative errors, root mean squares: of the displacement and stress of all
  /// points, and of the stress and the largest error of it at the inner wall,
  /// which feels a pressure or, with a @p penalty, has the exact displacement
  /// by springs of the stiffness penalty * (K + 4 G / 3) / h.
  using RingErrors = std::array<double, 4>;

  template <typename Ring>
  RingErrors
  ring_errors(const unsigned int n,
              const unsigned int p,
              const double       growth,
              const unsigned int n_steps,
              const double       penalty = 0.)
  {
    const Ring         ring(growth);
    const std::string  N = std::to_string(n);
    std::ostringstream pressure, imposed, stiffness, step;
    pressure.precision(16);
    pressure << "Pressure = t * " << ring.pressure;
    imposed.precision(16);
    imposed << "Displacement = " << growth << " * t * X; " << growth
            << " * t * Y";
    stiffness.precision(16);
    stiffness << "Stiffness = " << penalty * (lambda + 2. * mu) * n / 2.2;
    step.precision(16);
    step << "Step = " << 1. / n_steps;
    Simulated<2> run(
      Text()
        .add("Simulation",
             {"Bodies = ring", "Materials = solid", "Surface loads = pressure"})
        .add("Grid",
             {"Upper corner = 2.2, 2.2",
              "Cells = " + N + ", " + N,
              "Order = " + std::to_string(p)})
        .add("Scheme",
             {"Formulation = total Lagrangian", "Stress update = quasi-static"})
        .add("Walls", {"Left = sliding", "Bottom = sliding"})
        .add("Time", {"End = 1", step.str()})
        .add("Newton",
             {growth > 1e-3 ? "Tolerance = 1e-9" : "Tolerance = 1e-7"})
        .add("Scheme", {"Filling threshold = 0.3"})
        .add("Body ring",
             {"Material = solid",
              "Shape = difference(ball(0, 0, 2), ball(0, 0, 1))",
              "Clip at the grid = true",
              "Placement = fitted",
              "Points per direction = " + std::to_string(p + 1)})
        .add("Material solid",
             {std::string("Model = ") + Ring::law,
              "Density = 1",
              "Young modulus = 1300",
              "Poisson ratio = 0.3"})
        .add("Surface load pressure",
             {"Body = ring", "Where = ball(0, 0, 1.5)"})
        .add("Surface load pressure",
             penalty == 0.
               ? std::vector<std::string>{"Kind = pressure", pressure.str()}
               : std::vector<std::string>{"Kind = displacement",
                                          imposed.str(),
                                          stiffness.str()}));
    run.run();

    std::vector<double> sums(6);
    double              largest = 0.;
    for (const Body<2> &body : run->bodies())
      body.points.for_each([&](const ConstPointRef<2> point) {
        const Point<2>     X     = point.reference();
        const Tensor<1, 2> u     = (ring(X.norm()).r / X.norm() - 1.) * X;
        const auto         sigma = exact_stress(ring, X);
        const auto         error =
          SymmetricTensor<2, 2>(
            {point.stress(0), point.stress(1), point.stress(3)}) -
          sigma;
        sums[0] += point.volume0() * (point.position() - X - u).norm_square();
        sums[1] += point.volume0() * u.norm_square();
        sums[2] += point.volume0() * (error * error);
        sums[3] += point.volume0() * (sigma * sigma);
      });
    run->state().surfaces[0].points.for_each([&](const ConstPointRef<2> point) {
      const auto sigma = exact_stress(ring, point.reference());
      const auto error = Ring::stress(point.matrix(PointLayout<2>::F)) - sigma;
      sums[4] += point.mass() * (error * error);
      sums[5] += point.mass() * (sigma * sigma);
      largest = std::max(largest, error.norm() / sigma.norm());
    });
    Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
    return {{std::sqrt(sums[0] / sums[1]),
             std::sqrt(sums[2] / sums[3]),
             std::sqrt(sums[4] / sums[5]),
             max_all(largest)}};
  }



  template <typename Ring>
  void
  check_ring(const double growth, const unsigned int n_steps)
  {
    const bool                      table = std::getenv("TABLE");
    const std::vector<unsigned int> meshes =
      table ? std::vector<unsigned int>{12, 24, 48, 96}
            : std::vector<unsigned int>{24, 48};
    const std::vector<std::string> names = {"displacement",
                                            "stress",
                                            "stress at the wall",
                                            "largest error of it"};
    if (table)
      print() << Ring::law << ", pressure " << Ring(growth).pressure
              << std::endl;
    for (const unsigned int p : {1, 2, 3})
      {
        std::vector<RingErrors> errors;
        for (const unsigned int n : meshes)
          errors.push_back(ring_errors<Ring>(n, p, growth, n_steps));
        for (unsigned int k = 0; k < 4; ++k)
          {
            // The largest error is that of one cell, which the wall cuts
            // as it likes.
            const unsigned int i = table ? 2 : 1;
            const double order   = std::log2(errors[i - 1][k] / errors[i][k]);
            const double wanted =
              p + std::array<double, 4>{{0.8, -0.2, -0.2, -0.5}}[k];
            check(std::string(Ring::law) + ", p = " + std::to_string(p) +
                    ": order of the " + names[k],
                  order > wanted);
            if (!table && order > wanted)
              continue;
            print() << "p = " << p << ", " << names[k] << ":";
            for (unsigned int m = 0; m < meshes.size(); ++m)
              {
                print() << " " << errors[m][k];
                if (m > 0)
                  print() << " (" << std::log2(errors[m - 1][k] / errors[m][k])
                          << ")";
              }
            print() << std::endl;
          }
      }
  }



  /// An imposed displacement is missed by the traction over the stiffness of
  /// its springs: by the strain times h / penalty. The error is of order 1 with
  /// a fixed penalty, and of order p + 1 where it grows with h^-p.
  void
  check_penalty()
  {
    const auto errors =
      [](const unsigned int p, const double first, const double power) {
        std::vector<double> result;
        for (const unsigned int n : {24, 48})
          result.push_back(ring_errors<NeoHookeanRing>(
            n, p, 0.5, 5, first * std::pow(n / 12., power))[0]);
        if (std::getenv("TABLE"))
          print() << "imposed displacement, p = " << p << ", penalty " << first
                  << " (12 h)^-" << power << ": " << result[0] << " "
                  << result[1] << " (" << std::log2(result[0] / result[1])
                  << ")" << std::endl;
        return result;
      };
    const auto order = [](const std::vector<double> &e) {
      return std::log2(e[0] / e[1]);
    };
    for (const unsigned int p : {1, 2})
      {
        const std::string name =
          "imposed displacement, p = " + std::to_string(p) + ": ";
        const auto fixed = errors(p, 10., 0.);
        check(name + "order", std::abs(order(fixed) - 1.), 0.2);
        check(name + "order with a penalty that grows",
              order(errors(p, 10., p)) > p + 0.8);
        if (p == 2)
          check(name + "ten times the penalty",
                std::abs(errors(p, 100., 0.)[1] / fixed[1] - 0.1),
                0.01);
      }
  }
} // namespace



void
test_main()
{
  check("differential equation at small strain",
        std::abs(NeoHookeanRing(1e-6).pressure / LameRing(1e-6).pressure - 1.),
        1e-5);
  check_ring<LameRing>(1e-7, 1);
  check_ring<NeoHookeanRing>(0.5, 5);
  check_penalty();
}
