// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1 2

// Checks bars that vibrate along their axis with strains of 20 %, fixed at both
// ends or at one, in total Lagrangian steps: the order p + 1 against a spectral
// solution of the wave equation with large strains. With TABLE=1 in the
// environment, it uses three meshes and prints the errors.
#include <deal.II/base/quadrature_lib.h>

#include "simulation.h"

namespace
{
  constexpr double length = 25., modulus = 100., speed = 2.;

  /// rho u_tt = (E ln(F) / F)_X with F = 1 + u_X and u_t = v0 sin(k X) at t =
  /// 0, held at X = 0 and maybe at the other end, too: one spectral element
  /// with polynomials in the points of Gauss and Lobatto, and the method of
  /// Runge and Kutta.
  class SpectralBar
  {
  public:
    static constexpr unsigned int n = 36, n_steps = 4000;

    SpectralBar(const bool one_end, const double end)
      : one_end(one_end)
      , factors(n, 1.)
    {
      const QGaussLobatto<1> quadrature(n);
      for (unsigned int i = 0; i < n; ++i)
        {
          nodes.push_back(length * quadrature.point(i)[0]);
          weights.push_back(length * quadrature.weight(i));
        }
      // Of Lagrange's polynomials; 4 / L is their capacity.
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          if (j != i)
            factors[i] /= (nodes[i] - nodes[j]) * 4. / length;
      for (unsigned int i = 0; i < n; ++i)
        {
          slopes.emplace_back(n, 0.);
          for (unsigned int j = 0; j < n; ++j)
            if (j != i)
              {
                slopes[i][j] = factors[j] / factors[i] / (nodes[i] - nodes[j]);
                slopes[i][i] -= slopes[i][j];
              }
        }
      const double        h = end / n_steps;
      std::vector<double> y(2 * n);
      for (unsigned int i = 0; i < n; ++i)
        y[n + i] = initial_speed(nodes[i]);
      if (!one_end)
        y[2 * n - 1] = 0.;
      for (unsigned int step = 0; step < n_steps; ++step)
        {
          const auto k1 = rate(y);
          const auto k2 = rate(sum(y, 0.5 * h, k1));
          const auto k3 = rate(sum(y, 0.5 * h, k2));
          const auto k4 = rate(sum(y, h, k3));
          for (unsigned int i = 0; i < y.size(); ++i)
            y[i] += h / 6. * (k1[i] + 2. * k2[i] + 2. * k3[i] + k4[i]);
        }
      values.assign(y.begin(), y.begin() + n);
    }

    double
    displacement(const double X) const
    {
      double above = 0., below = 0.;
      for (unsigned int i = 0; i < n; ++i)
        {
          if (X == nodes[i])
            return values[i];
          above += factors[i] / (X - nodes[i]) * values[i];
          below += factors[i] / (X - nodes[i]);
        }
      return above / below;
    }

  private:
    double
    initial_speed(const double X) const
    {
      return speed * std::sin(numbers::PI * X / (one_end ? 2. : 1.) / length);
    }

    static std::vector<double>
    sum(std::vector<double>        a,
        const double               factor,
        const std::vector<double> &b)
    {
      for (unsigned int i = 0; i < a.size(); ++i)
        a[i] += factor * b[i];
      return a;
    }

    std::vector<double>
    rate(const std::vector<double> &y) const
    {
      std::vector<double> result(2 * n);
      for (unsigned int q = 0; q < n; ++q)
        {
          double F = 1.;
          for (unsigned int i = 0; i < n; ++i)
            F += slopes[q][i] * y[i];
          const double P = weights[q] * modulus * std::log(F) / F;
          for (unsigned int i = 1; i < n; ++i)
            result[n + i] -= P * slopes[q][i] / weights[i];
        }
      if (!one_end)
        result[2 * n - 1] = 0.;
      for (unsigned int i = 1; i < n; ++i)
        result[i] = y[n + i];
      return result;
    }

    const bool                       one_end;
    std::vector<double>              nodes, weights, factors, values;
    std::vector<std::vector<double>> slopes;
  };



  double
  bar_error(const SpectralBar &exact,
            const bool         one_end,
            const double       end,
            const unsigned int n,
            const unsigned int p,
            const double       step)
  {
    const auto text = [](const double x) {
      std::ostringstream result;
      result << std::setprecision(16) << x;
      return result.str();
    };
    // The free end cuts a cell.
    const double h     = length / n;
    const double width = one_end ? length + 1.37 * h : length;
    Simulated<2> run(
      Text()
        .add("Simulation", {"Bodies = bar", "Materials = rubber"})
        .add("Grid",
             {"Upper corner = " + text(width) + ", " + text(h),
              "Cells = " + std::to_string(one_end ? n + 2 : n) + ", 1",
              "Order = " + std::to_string(p)})
        .add("Scheme", {"Formulation = total Lagrangian", "Mass = consistent"})
        .add("Time", {"End = " + text(end), "Step = " + text(step)})
        .add("Body bar",
             {"Material = rubber",
              "Shape = box(0, 0, " + text(length) + ", " + text(h) + ")",
              "Placement = fitted",
              "Points per direction = " + std::to_string(p + 1),
              "Velocity = " + text(speed) + " * sin(pi * x / " +
                text(one_end ? 2. * length : length) + "); 0"})
        .add("Material rubber",
             {"Model = linear-elastic",
              "Density = 1",
              "Young modulus = 100",
              "Poisson ratio = 0"})
        .add("Walls",
             {"Left = sliding",
              one_end ? "Right = free" : "Right = sliding",
              "Bottom = sliding",
              "Top = sliding"}));
    run.run();
    std::vector<double> sums(2);
    run->bodies()[0].points.for_each([&](const ConstPointRef<2> point) {
      const double u     = exact.displacement(point.reference(0));
      const double error = point.position(0) - point.reference(0) - u;
      sums[0] += point.volume0() * error * error;
      sums[1] += point.volume0() * u * u;
    });
    Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
    return std::sqrt(sums[0] / sums[1]);
  }



  void
  check_bar(const bool one_end, const double end)
  {
    const bool        table = std::getenv("TABLE");
    const SpectralBar exact(one_end, end);
    const std::string name = one_end ? "one end" : "both ends";
    for (const unsigned int p : {1, 2, 3, 4})
      {
        std::vector<double>       errors;
        std::vector<unsigned int> meshes = one_end
                                             ? std::vector<unsigned int>{4, 8}
                                             : std::vector<unsigned int>{8, 16};
        if (table)
          meshes.push_back(2 * meshes.back());
        for (const unsigned int n : meshes)
          errors.push_back(
            bar_error(exact,
                      one_end,
                      end,
                      n,
                      p,
                      end * (p < 3 ? 1e-3 : (table ? 5e-5 : 2e-4))));
        const double order = std::log2(errors[0] / errors[1]);
        check(name + ", p = " + std::to_string(p), order > p + 0.8);
        if (!table && order > p + 0.8)
          continue;
        print() << name << ", p = " << p << ":";
        for (unsigned int m = 0; m < errors.size(); ++m)
          {
            print() << " " << errors[m];
            if (m > 0)
              print() << " (" << std::log2(errors[m - 1] / errors[m]) << ")";
          }
        print() << std::endl;
      }
  }
} // namespace



void
test_main()
{
  check_bar(false, 1.25);
  check_bar(true, 2.5);
}
