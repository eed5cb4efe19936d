// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks a strength that decreases in time: it acts like a law with the reduced
// parameters at a fixed point and at moving points. Also checks its tangent,
// and messages for formulas without a strength.

#include "materials.h"

namespace
{
  const double degree = numbers::PI / 180.;

  std::string
  text_of(const double value)
  {
    std::ostringstream text;
    text << std::setprecision(17) << value;
    return text.str();
  }



  // The parameters of a law of friction, with all angles and cohesions.
  std::vector<std::string>
  settings(const double c, const double phi, const double psi)
  {
    return {"Young modulus = 3e6",
            "Poisson ratio = 0.25",
            "Cohesion = " + text_of(c),
            "Friction angle = " + text_of(phi),
            "Dilatancy angle = " + text_of(psi)};
  }



  // Random steps in time, each also by a law that has its strength for good.
  void
  test_steps(const std::string &name, const std::vector<std::string> &more)
  {
    auto lines = settings(1e4, 30., 20.);
    lines.insert(lines.end(), more.begin(), more.end());
    lines.push_back("Strength reduction = 1 + t / 2");
    const auto material = make(name, lines);

    Random        random;
    double        error     = 0.;
    unsigned int  n_plastic = 0;
    MaterialPoint point     = rest(*material);
    for (unsigned int k = 0; k < 400; ++k)
      {
        const double t = 0.005 * (k + 1), r = material->strength_reduction(t);
        const double phi = std::atan(std::tan(30. * degree) / r) / degree;
        if (k % 5 == 0)
          point = rest(*material);
        point.increment = one_tensor() + random.matrix(5e-3, k % 2) +
                          (k % 3 == 0 ? -2e-3 : 1e-3) * one_tensor();
        point.F                  = point.increment * point.F;
        point.J                  = determinant(point.F);
        point.strength_reduction = r;

        auto reduced = settings(1e4 / r, phi, std::min(20., phi));
        reduced.insert(reduced.end(), more.begin(), more.end());
        MaterialPoint other      = point;
        other.strength_reduction = 1.;
        make(name, reduced)->update(ArrayView<MaterialPoint>(&other, 1));
        const double work = point.state[7];
        material->update(ArrayView<MaterialPoint>(&point, 1));
        n_plastic += point.state[7] > work;
        error = std::max(error, (point.stress - other.stress).norm() / 1e4);
        for (unsigned int i = 0; i < 9; ++i)
          error = std::max(error,
                           std::abs(point.state[i] - other.state[i]) /
                             (i == 7 ? 1e4 : 1.));
      }
    check(name + ": as with the reduced parameters", error, 1e-10);
    check("  plastic steps", n_plastic > 100);
  }



  // A point in pure shear and under pressure, which is held: what it bears
  // falls in time.
  void
  test_fixed_point(const std::string &name)
  {
    print() << name << std::endl;
    auto lines = settings(1e4, 30., 0.);
    lines.push_back("Strength reduction = if(t < 1, 1, t)");
    const auto    material = make(name, lines);
    MaterialPoint point    = rest(*material);
    Tensor2       f        = one_tensor();
    f[0][0]                = 1.005;
    f[1][1]                = 0.985;
    for (const double t : {0.5, 1., 1.25, 1.5, 2.})
      {
        point.strength_reduction = material->strength_reduction(t);
        const double heat        = material->dissipation(point);
        step(*material, point, f);
        f                      = one_tensor();
        const Principal stress = principal(point.stress);
        // Of Mohr-Coulomb's surface in these stresses.
        const double tau     = point.J * (stress[0] - stress[2]) / 2.,
                     p       = -point.J * (stress[0] + stress[2]) / 2.;
        const double tan_phi = std::tan(30. * degree) / std::max(t, 1.),
                     c       = 1e4 / std::max(t, 1.);
        const double bears =
          (c + p * tan_phi) / std::sqrt(1. + tan_phi * tan_phi);
        print() << "  t = " << t << ": " << tau / bears << " of " << bears / 1e3
                << " kPa" << std::endl;
        check("  heat",
              t <= 1. ? material->dissipation(point) >= heat
                      : material->dissipation(point) > heat);
      }
  }
} // namespace



void
test_main()
{
  for (const std::string cone :
       {"plane strain", "plane strain associated", "outer", "inner"})
    test_steps("drucker-prager", {"Cone = " + cone});
  test_steps("drucker-prager", {"Tension cut-off = 5e3"});
  test_steps("mohr-coulomb", {});
  test_fixed_point("drucker-prager");
  test_fixed_point("mohr-coulomb");

  check("no reduction", make("mohr-coulomb")->strength_reduction(7.) == 1.);
  for (const std::string formula : {"2 +", "1 + x", "-1", "1 / t"})
    print_message(
      [&]() { make("mohr-coulomb", {"Strength reduction = " + formula}); });
  for (const std::string name : {"drucker-prager", "mohr-coulomb"})
    print_message([&]() {
      make(name, {"Strength reduction = 1 - t / 2"})->strength_reduction(3.);
    });
}
