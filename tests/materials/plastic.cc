// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks elastoplastic laws: thousands of return mappings against the yield
// surface and the flow rule, region by region; rotations, energies, elastic and
// limit states.

#include "materials.h"

namespace
{
  const double           E = 3e6, nu = 0.25;
  const double           K = E / (3 * (1 - 2 * nu)), G = E / (2 * (1 + nu));
  const double           degree = numbers::PI / 180.;
  const SymmetricTensor2 one    = unit_symmetric_tensor<3>();

  // Logarithm of a symmetric positive tensor less one, by deal.II's spectra.
  SymmetricTensor2
  logarithm(const SymmetricTensor2 &b)
  {
    SymmetricTensor2 result;
    for (const auto &pair :
         eigenvectors(b, SymmetricTensorEigenvectorMethod::jacobi))
      result += std::log(pair.first) *
                symmetrize(outer_product(pair.second, pair.second));
    return result;
  }



  // The results of one step.
  struct Return
  {
    SymmetricTensor2 trial, tau; // Kirchhoff stress
    SymmetricTensor2 flow;       // increment of plastic strain
    double           alpha, growth, opened;
    double
    p() const
    {
      return trace(tau) / 3;
    }
    double
    q() const // sqrt(J2)
    {
      return deviator(tau).norm() / std::sqrt(2.);
    }
  };



  // Many steps of random size and direction from random states; @p look sees
  // those with plastic flow.
  void
  visit(const Material                            &material,
        const double                               size,
        const std::function<void(const Return &)> &look)
  {
    Random        random;
    double        sum = 0, state = 0, heat = 0, softened = 0;
    unsigned int  n_plastic = 0;
    MaterialPoint point     = rest(material);
    const bool    opens     = material.state_names().size() == 9;
    for (unsigned int k = 0; k < 6000; ++k)
      {
        if (k % 5 == 0 || k % 7 == 0)
          point = rest(material);
        const bool       plane = k / 5 % 2;
        SymmetricTensor2 e =
          size * std::exp(2 * random()) * symmetrize(random.matrix(1., plane));
        if (k % 3 == 0) // axisymmetric states, close to edges
          e[0][0] = e[1][1] * (1 + 1e-3 * random());
        if (k % 7 == 0) // almost isotropic extension
          e = 0.03 * deviator(e) + e.norm() * one;
        const Tensor2 f = one_tensor() +
                          random.matrix(k % 7 == 0 ? 1e-4 : 0.01, plane) +
                          Tensor2(e);
        const MaterialPoint before = point;
        SymmetricTensor2    b      = one;
        for (unsigned int i = 0; i < 6; ++i)
          b.access_raw_entry(i) += before.state[i];
        step(material, point, f);

        Return           r;
        SymmetricTensor2 trial = 0.5 * logarithm(rotated(f, b));
        // An open crack closes first, without stress.
        const double closed =
          opens ? std::min(before.state[8], std::max(-trace(trial), 0.)) : 0.;
        trial += closed / 3 * one;
        r.trial  = K * trace(trial) * one + 2 * G * deviator(trial);
        r.tau    = point.J * point.stress;
        r.alpha  = point.state[6];
        r.growth = point.state[6] - before.state[6];
        r.opened = opens ? point.state[8] - before.state[8] + closed : 0.;
        SymmetricTensor2 elastic = one;
        for (unsigned int i = 0; i < 6; ++i)
          elastic.access_raw_entry(i) += point.state[i];
        elastic = 0.5 * logarithm(elastic);
        r.flow  = trial - elastic;
        // State and stress belong together, and the flow to the strain.
        state             = std::max(state,
                         (K * trace(elastic) * one + 2 * G * deviator(elastic) -
                          r.tau)
                             .norm() /
                           (G * trial.norm()));
        sum               = std::max(sum,
                       std::abs(deviator(r.flow).norm() * std::sqrt(2. / 3.) -
                                r.growth) /
                         trial.norm());
        const double work = point.state[7] - before.state[7];
        heat =
          std::max(heat,
                   std::abs(work - r.tau * r.flow) / (G * (trial * trial)));
        softened = std::max(softened, -work / (G * (trial * trial)));
        if (r.flow.norm() > 1e-10 * trial.norm())
          {
            ++n_plastic;
            look(r);
          }
        else
          state =
            std::max(state, (r.trial - r.tau).norm() / (G * trial.norm()));
      }
    check("  plastic steps out of 6000: more than 2000", n_plastic > 2000);
    check("  stress = elastic law of the state", state, 1e-12);
    check("  equivalent plastic strain", sum, 1e-12);
    check("  plastic work", heat, 1e-12);
    check("  plastic work is not negative", softened, 1e-15);
  }



  void
  common(const Material                             &material,
         const std::vector<SymmetricTensor2>        &allowed,
         const SymmetricTensor2                     &forbidden,
         const std::function<Tensor2(const double)> &path)
  {
    check_objectivity(material, 0.02);
    check_initialize(material, allowed);
    MaterialPoint point;
    print_message([&]() { material.initialize(point, forbidden); });
    check_order("  work - energy - heat",
                energy_error(material, path, 200),
                energy_error(material, path, 800) * 2,
                1.);

    // Before yield: linear elasticity.
    Random     random;
    const auto elastic =
      make("linear-elastic", {"Young modulus = 3e6", "Poisson ratio = 0.25"});
    MaterialPoint a, b;
    material.initialize(a, allowed[0]);
    elastic->initialize(b, allowed[0]);
    double error = 0;
    for (unsigned int k = 0; k < 20; ++k)
      {
        const Tensor2 f =
          random.rotation(k % 2) * (one_tensor() + random.matrix(1e-7, k % 2));
        step(material, a, f);
        step(*elastic, b, f);
        error = std::max(error, (a.stress - b.stress).norm() / b.stress.norm());
        error = std::max(
          error,
          std::abs(material.strain_energy(a) / elastic->strain_energy(b) - 1));
        error = std::max(error, std::abs(a.wave_modulus / b.wave_modulus - 1));
      }
    check("  elastic before yield", error, 1e-10);
  }



  SymmetricTensor2
  stress(const double xx, const double yy, const double zz, const double xy = 0)
  {
    SymmetricTensor2 s;
    s[0][0] = xx, s[1][1] = yy, s[2][2] = zz, s[0][1] = xy;
    return s;
  }



  void
  test_von_mises()
  {
    print() << "von-mises" << std::endl;
    const double sy = 2e4, H = 5e4;
    const auto   material = make("von-mises",
                               {"Young modulus = 3e6",
                                  "Poisson ratio = 0.25",
                                  "Yield stress = 2e4",
                                  "Hardening modulus = 5e4"});
    double       surface = 0, flow = 0;
    visit(*material, 0.01, [&](const Return &r) {
      const double q = std::sqrt(3.) * r.q();
      surface        = std::max(surface, std::abs(q / (sy + H * r.alpha) - 1));
      flow           = std::max(flow,
                      (r.flow - 1.5 * r.growth / q * deviator(r.tau)).norm() /
                        r.flow.norm());
    });
    check("  on the yield surface", surface, 1e-12);
    check("  flow rule", flow, 1e-6);
    common(*material,
           {stress(1e4, -5e3, 2e3, 3e3),
            stress(-1e6, -1e6, -1e6),
            sy / std::sqrt(3.) * stress(0, 0, 0, 1)},
           stress(3e4, 0, 0),
           [](const double s) {
             Tensor2 F = one_tensor();
             F[0][1]   = 0.1 * s, F[0][0] += 0.02 * s * s;
             return F;
           });

    // Simple shear in small strains, closed: 3 G (g / sqrt(3) - alpha) =
    // sigma_y + H alpha.
    MaterialPoint point = rest(*material);
    Tensor2       f     = one_tensor();
    f[0][1]             = 1e-5;
    for (unsigned int i = 0; i < 4000; ++i)
      step(*material, point, f);
    const double g     = 0.04;
    const double alpha = (std::sqrt(3.) * G * g - sy) / (3 * G + H);
    check("  simple shear",
          std::abs(point.stress[0][1] * std::sqrt(3.) / (sy + H * alpha) - 1),
          1e-3);
  }



  // A cone; the parameters of Mohr-Coulomb's surface in plane strain, at the
  // outer and at the inner edges.
  void
  test_drucker_prager(const std::string &cone,
                      const double       phi,
                      const double       psi,
                      const double       cut_off)
  {
    print() << "drucker-prager, " << cone << ", phi = " << phi
            << ", psi = " << psi << ", cut-off = " << cut_off << std::endl;
    const double c   = 5e3;
    const auto   fit = [&](const double degrees) {
      const double s = std::sin(degrees * degree);
      return cone == "outer" ? 6 * s / (std::sqrt(3.) * (3 - s))
               : cone == "inner"
                 ? 6 * s / (std::sqrt(3.) * (3 + s))
                 : 3 * std::tan(degrees * degree) /
                   std::sqrt(9 + 12 * std::pow(std::tan(degrees * degree), 2));
    };
    const double eta2 = fit(psi), sine = std::sin(phi * degree);
    const double eta =
      cone == "plane strain"
        ? sine / (std::sqrt(1 - eta2 * eta2 / 3) + eta2 * sine / 3)
        : fit(phi);
    const double apex = c / std::tan(phi * degree);
    const double p_t  = cut_off < 0 ? apex : cut_off;
    const auto   material =
      make("drucker-prager",
           {"Young modulus = 3e6",
            "Poisson ratio = 0.25",
            "Cohesion = 5e3",
            "Cone = " + cone,
            "Friction angle = " + std::to_string(phi),
            "Dilatancy angle = " + std::to_string(psi),
            "Tension cut-off = " + std::to_string(cut_off)});
    double       surface = 0, flow = 0, negative = 0, opening = 0;
    unsigned int on_cone = 0, on_cut_off = 0, on_both = 0;
    visit(*material, 0.01, [&](const Return &r) {
      const double scale = std::max(c, r.trial.norm());
      const double f1    = (r.q() + eta * (r.p() - apex)) / scale,
                   f2    = (r.p() - p_t) / scale;
      surface            = std::max({surface, f1, f2});
      // Koiter: multipliers of the cone (from the deviator) and the cut-off.
      const double cone_flow = std::sqrt(3.) * r.growth;
      const double cut_flow  = trace(r.flow) - eta2 * cone_flow;
      negative               = std::max(negative, -cut_flow / r.flow.norm());
      opening =
        std::max(opening, std::abs(cut_flow - r.opened) / r.flow.norm());
      if (r.q() > 1e-9 * scale)
        flow = std::max(flow,
                        (deviator(r.flow) -
                         0.5 * cone_flow / r.q() * deviator(r.tau))
                            .norm() /
                          r.flow.norm());
      const bool first = std::abs(f1) < 1e-12, second = std::abs(f2) < 1e-12;
      if (first && second)
        ++on_both;
      else if (first)
        {
          ++on_cone;
          flow = std::max(flow, std::abs(cut_flow) / r.flow.norm());
        }
      else if (second)
        {
          ++on_cut_off;
          flow = std::max(flow, r.growth / r.flow.norm());
        }
      else
        surface = 1;
    });
    check("  on the yield surface", surface, 1e-12);
    check("  flow rule", flow, 1e-6);
    check("  multipliers are not negative", negative, 1e-6);
    check("  the opening is the volume of the cut-off's flow", opening, 1e-6);
    check("  more than 300 returns to the cone", on_cone > 300);
    check(cut_off < 0 ? "  more than 300 to the apex"
                      : "  more than 300 to the corner",
          on_both > 300);
    check(cut_off < 0 ? "  none to a cut-off"
                      : "  more than 300 to the cut-off",
          cut_off < 0 ? on_cut_off == 0 : on_cut_off > 300);

    common(*material,
           {stress(1e3, -2e3, 0, 1e3), stress(-3e4, -2e4, -2e4, 3e3)},
           stress(-2e4, -2e5, -2e4),
           [](const double s) {
             Tensor2 F = one_tensor();
             F[0][1]   = 0.1 * s, F[0][0] -= 0.03 * s;
             return F;
           });

    // The largest stress that initialize() takes where cones and
    // Mohr-Coulomb agree: axial compression for outer, extension for inner.
    if (cone == "outer" || cone == "inner")
      {
        const double s = std::sin(phi * degree), side = -1e3;
        // s_1 - s_3 + (s_1 + s_3) sin(phi) = 2 c cos(phi)
        const double axial =
          cone == "outer"
            ? (side * (1 + s) - 2 * c * std::cos(phi * degree)) / (1 - s)
            : (side * (1 - s) + 2 * c * std::cos(phi * degree)) / (1 + s);
        const auto    stiff = make("drucker-prager",
                                {"Young modulus = 1e15",
                                    "Cohesion = 5e3",
                                    "Cone = " + cone,
                                    "Friction angle = " + std::to_string(phi)});
        MaterialPoint point;
        stiff->initialize(point, stress(side, side, axial * (1 - 1e-7)));
        try
          {
            stiff->initialize(point, stress(side, side, axial * (1 + 1e-7)));
            check("  edge of Mohr-Coulomb's surface", false);
          }
        catch (const ExcMessage &)
          {
            check("  edge of Mohr-Coulomb's surface", true);
          }
      }
    else if (phi == psi)
      {
        // Steady associated flow in plane strain has Mohr-Coulomb's strength.
        MaterialPoint point = rest(*material);
        const double  s     = std::sin(phi * degree);
        Tensor2       f     = one_tensor();
        f[0][0] += 1e-5 * (1 + s), f[1][1] -= 1e-5 * (1 - s);
        for (unsigned int i = 0; i < 10000; ++i)
          step(*material, point, f);
        const SymmetricTensor2 tau = point.J * point.stress;
        check("  limit state in plane strain",
              std::abs((tau[0][0] - tau[1][1] + s * (tau[0][0] + tau[1][1])) /
                         (2 * c * std::cos(phi * degree)) -
                       1),
              1e-6);
      }
  }



  void
  test_mohr_coulomb(const std::string &softening,
                    const double       c,
                    const double       c_r,
                    const double       phi,
                    const double       phi_r,
                    const double       psi)
  {
    print() << "mohr-coulomb, " << softening << ", c = " << c << " to " << c_r
            << ", phi = " << phi << " to " << phi_r << ", psi = " << psi
            << std::endl;
    const double limit = 0.08;
    const auto   material =
      make("mohr-coulomb",
           {"Young modulus = 3e6",
            "Poisson ratio = 0.25",
            "Cohesion = " + std::to_string(c),
            "Residual cohesion = " + std::to_string(c_r),
            "Friction angle = " + std::to_string(phi),
            "Residual friction angle = " + std::to_string(phi_r),
            "Dilatancy angle = " + std::to_string(psi),
            "Softening = " + softening,
            "Softening strain = 0.08"});
    const double m       = std::sin(psi * degree);
    double       surface = 0, flow = 0, negative = 0, opening = 0;
    unsigned int plane = 0, left = 0, right = 0, apex = 0, softened = 0;
    visit(*material, 0.01, [&](const Return &r) {
      const double part = softening == "linear"
                            ? std::max(1 - r.alpha / limit, 0.)
                            : std::exp(-r.alpha / limit);
      const double s    = std::sin((phi_r + (phi - phi_r) * part) * degree);
      const double C    = c_r + (c - c_r) * part;
      softened += part < 0.9;
      const Principal t = principal(r.tau), e = principal(r.flow);
      const double    scale = std::max(c, r.trial.norm());
      const auto      f     = [&](const unsigned int i, const unsigned int j) {
        return (t[i] - t[j] + (t[i] + t[j]) * s -
                2 * C * std::sqrt(1 - s * s)) /
               scale;
      };
      surface           = std::max(surface, std::abs(f(0, 2)));
      const double size = r.flow.norm();

      const bool first  = std::abs(t[0] - t[1]) < 1e-12 * scale,
                 second = std::abs(t[1] - t[2]) < 1e-12 * scale;
      // The flow is a sum of those of the planes that meet here.
      const auto largest = [&](const double a, const double b, const double c) {
        return std::max({std::abs(a), std::abs(b), std::abs(c)}) / size;
      };
      if (first && second)
        {
          // In the cone of all six: no component along its polar's rays.
          ++apex;
          // Dilatancy takes its part of the volume.
          opening = std::max({opening,
                              -r.opened / size,
                              (m > 0 ? r.opened - trace(r.flow)
                                     : std::abs(r.opened - trace(r.flow))) /
                                size});
          negative =
            std::max({negative,
                      (-(e[0] + e[1]) * (1 - m) - e[2] * (1 + m)) / size,
                      (-e[0] * (1 - m) - (e[1] + e[2]) * (1 + m)) / size});
        }
      else if (first)
        {
          ++left; // (a, b) of planes 13 and 23
          const double a = e[0] / (1 + m), b = e[1] / (1 + m);
          flow     = std::max(flow, largest(e[2] + (a + b) * (1 - m), 0, 0));
          negative = std::max({negative, -a / size, -b / size});
        }
      else if (second)
        {
          ++right; // planes 13 and 12
          const double a = -e[2] / (1 - m), b = -e[1] / (1 - m);
          flow     = std::max(flow, largest(e[0] - (a + b) * (1 + m), 0, 0));
          negative = std::max({negative, -a / size, -b / size});
        }
      else
        {
          ++plane;
          opening        = std::max(opening, std::abs(r.opened) / size);
          const double a = e[0] / (1 + m);
          flow           = std::max(flow, largest(e[1], e[2] + a * (1 - m), 0));
          negative       = std::max(negative, -a / size);
        }
    });
    check("  on the yield surface", surface, 1e-12);
    check("  flow rule", flow, 1e-6);
    check("  multipliers are not negative", negative, 1e-6);
    check("  the opening is a part of the volume", opening, 1e-9);
    check("  more than 100 returns to the plane", plane > 100);
    check("  to the left edge", left > 100);
    check("  to the right edge", right > 100);
    check(phi > 0 ? "  to the apex" : "  none to an apex",
          phi > 0 ? apex > 100 : apex == 0);
    if (c_r < c)
      check("  with less than 90 % of the softening left", softened > 100);

    common(*material,
           {stress(1e3, -2e3, 0, 1e3), stress(-1e4, -9e3, -9e3, 1e3)},
           stress(-2e4, -2e5, -2e4),
           [](const double s) {
             Tensor2 F = one_tensor();
             F[0][1]   = 0.1 * s, F[0][0] -= 0.03 * s;
             return F;
           });
  }


  // The friction angle in degrees that biaxial compression of dense sand
  // mobilises: plane strain, the lateral stress is held.
  double
  biaxial_angle(const std::string &cone, const double phi, const double psi)
  {
    const auto   material = make("drucker-prager",
                               {"Young modulus = 1e8",
                                  "Poisson ratio = 0.3",
                                  "Cone = " + cone,
                                  "Friction angle = " + std::to_string(phi),
                                  "Dilatancy angle = " + std::to_string(psi)});
    const double lateral = -1e4, sine = std::sin(psi * degree),
                 growth = 2e-6 * (1 + sine) / (1 - sine);
    MaterialPoint point;
    material->initialize(point, lateral * one);
    for (unsigned int k = 0; k < 20000; ++k)
      {
        Tensor2      f     = one_tensor();
        const double error = point.stress[0][0] - lateral;
        f[1][1]            = 1 - 2e-6;
        f[0][0] = 1 + growth - 2e-9 * std::max(-3000., std::min(3000., error));
        step(*material, point, f);
      }
    const double s1 = -point.stress[1][1], s3 = -point.stress[0][0];
    return std::asin((s1 - s3) / (s1 + s3)) / degree;
  }



  void
  test_biaxial()
  {
    print() << "biaxial compression" << std::endl;
    double error = 0, associated = 0;
    for (const double phi : {19.8, 30., 40.})
      {
        for (const double part : {0., 0.5, 1.})
          error =
            std::max(error,
                     std::abs(biaxial_angle("plane strain", phi, part * phi) -
                              phi));
        associated =
          std::max(associated,
                   std::abs(biaxial_angle("plane strain associated", phi, phi) -
                            phi));
      }
    check("  plane strain has the friction angle of the material", error, 1e-3);
    check("  and so has the associated cone for psi = phi", associated, 1e-3);
    print() << "  associated cone with phi = 19.8, psi = 0: " << std::fixed
            << std::setprecision(2)
            << biaxial_angle("plane strain associated", 19.8, 0.) << " degrees"
            << std::defaultfloat << std::endl;
  }



  // Uniaxial cycles of extension and compression back to the volume of the
  // start, which was under pressure: the stress is what it was.
  void
  test_opening(const std::string              &name,
               const std::vector<std::string> &settings)
  {
    std::vector<std::string> all = {"Young modulus = 0.84e6",
                                    "Friction angle = 19.8"};
    all.insert(all.end(), settings.begin(), settings.end());
    print() << name << ", cycles of extension";
    for (const std::string &setting : settings)
      print() << ", " << setting;
    print() << std::endl;
    const auto    material = make(name, all);
    MaterialPoint point;
    material->initialize(point, -2e3 * one);
    const double start  = point.J;
    double       stress = 0, open_stress = 0, opening = 0;
    Principal    heat{};
    for (unsigned int cycle = 0; cycle < 3; ++cycle)
      {
        double       J    = start;
        const double last = material->dissipation(point);
        for (unsigned int k = 1; k <= 200; ++k)
          {
            const double next =
              start * (1 + 0.05 * (k <= 100 ? k : 200. - k) / 100);
            Tensor2 f = one_tensor();
            f[1][1]   = next / J;
            step(*material, point, f);
            J = next;
            if (k == 100)
              {
                opening     = point.state[8];
                open_stress = std::max(open_stress, point.stress.norm());
              }
          }
        stress      = std::max(stress, std::abs(trace(point.stress) + 6e3));
        opening     = std::max(opening - 0.05, point.state[8]);
        heat[cycle] = material->dissipation(point) - last;
      }
    if (settings[1] == "Dilatancy angle = 0")
      {
        check("  mean stress back at the volume of the start, Pa",
              stress,
              1e-6);
        check("  heat of the third cycle, not more than of the second, J / m^3",
              heat[2] - heat[1],
              1e-9);
        check("  nor of the first", heat[2] - heat[0], 1e-9);
      }
    check("  nothing stays open", opening, 1e-15);
    if (settings[0] == "Cohesion = 0")
      check("  stress when open, Pa", open_stress, 1e-8);
  }
} // namespace



void
test_main()
{
  test_von_mises();
  test_drucker_prager("plane strain", 30, 10, -1);
  test_drucker_prager("plane strain", 20, 20, -1);
  test_drucker_prager("plane strain associated", 25, 5, 6e3);
  test_drucker_prager("outer", 30, 0, 4e3);
  test_drucker_prager("inner", 35, 15, 2e3);
  test_mohr_coulomb("linear", 5e3, 5e3, 30, 30, 10);
  test_mohr_coulomb("linear", 8e3, 2e3, 35, 25, 5);
  test_mohr_coulomb("exponential", 8e3, 1e3, 40, 30, 0);
  test_mohr_coulomb("linear", 8e3, 8e3, 0, 0, 0);
  test_biaxial();
  for (const std::string name : {"drucker-prager", "mohr-coulomb"})
    for (const std::string cohesion : {"0", "500"})
      for (const std::string psi : {"0", "5"})
        test_opening(name,
                     {"Cohesion = " + cohesion, "Dilatancy angle = " + psi});
}
