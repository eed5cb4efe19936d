// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks spectral decompositions, and elastic laws against derivatives of their
// energy, closed forms, rotations, closed cycles and linear limits.

#include "materials.h"

namespace
{
  // The principal values of a symmetric tensor, ascending, by Jacobi's cyclic
  // rotations in long double.
  Principal
  exact_values(const SymmetricTensor2 &A)
  {
    long double a[3][3];
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        a[i][j] = A[i][j];
    for (unsigned int k = 0; k < 30; ++k)
      {
        const unsigned int p = k % 3 == 2 ? 1 : 0, q = k % 3 == 0 ? 1 : 2,
                           r  = 3 - p - q;
        const long double apq = a[p][q], theta = (a[q][q] - a[p][p]) / 2;
        const long double root = std::sqrt(theta * theta + apq * apq);
        if (apq == 0)
          continue;
        const long double t = apq / (theta + std::copysign(root, theta)),
                          c = 1 / std::sqrt(1 + t * t), s = t * c, x = a[r][p],
                          y = a[r][q];
        a[p][p] -= t * apq;
        a[q][q] += t * apq;
        a[p][q] = a[q][p] = 0;
        a[r][p] = a[p][r] = c * x - s * y;
        a[r][q] = a[q][r] = s * x + c * y;
      }
    Principal values{{double(a[0][0]), double(a[1][1]), double(a[2][2])}};
    std::sort(values.begin(), values.end());
    return values;
  }



  void
  test_spectra()
  {
    Random random;
    double error = 0, values = 0, lanes = 0;
    for (unsigned int k = 0; k < 20000; ++k)
      {
        // Eigenvalues that are different, close, or equal; of any size.
        const double gaps[]  = {1., 1e-3, 1e-5, 1e-8, 1e-9, 1e-13, 1e-16, 0.};
        const double sizes[] = {1., 1e-12, 1e-4, 1e5, 1e20};
        std::array<SymmetricTensor2, n_lanes> tensors;
        std::array<Lanes, 6>                  entries;
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            const double     a = gaps[(k + lane) % 8], b = gaps[k / 8 % 8];
            const double     size = sizes[(k / 7 + lane) % 5];
            SymmetricTensor2 A;
            A[0][0] = size * (lane == 3 ? 0. : random());
            A[1][1] = A[0][0] + size * a * random();
            A[2][2] = A[k % 2][k % 2] + size * b * random();
            // Some without rotation, some by a tiny one.
            const Tensor2 R =
              k % 5 == 0   ? one_tensor()
              : k % 5 == 1 ? Tensor2(one_tensor() + random.matrix(1e-9, false))
                           : random.rotation(k % 2 == 0);
            tensors[lane] = rotated(R, A);
            for (unsigned int i = 0; i < 6; ++i)
              entries[i][lane] = tensors[lane].access_raw_entry(i);
          }
        const SpectralDecomposition<Lanes> spectra(entries);
        const auto again = spectra.assemble(spectra.values);
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            const SymmetricTensor2 &A     = tensors[lane];
            const double            norm  = std::max(A.norm(), 1e-300);
            const Principal         exact = exact_values(A);
            const Spectrum          spectrum(A);
            SymmetricTensor2        B;
            Principal               v;
            for (unsigned int i = 0; i < 6; ++i)
              B.access_raw_entry(i) = again[i][lane];
            for (unsigned int i = 0; i < 3; ++i)
              v[i] = spectra.values[i][lane];
            Principal u = spectrum.values;
            error       = std::max({error,
                                    (B - A).norm() / norm,
                                    (spectrum.tensor(u) - A).norm() / norm});
            std::sort(v.begin(), v.end());
            std::sort(u.begin(), u.end());
            for (unsigned int i = 0; i < 3; ++i)
              values = std::max({values,
                                 std::abs(v[i] - exact[i]) / norm,
                                 std::abs(u[i] - exact[i]) / norm});
          }
        // Directions are orthonormal: their squares sum up to one.
        const auto one = spectra.assemble(
          std::array<Lanes, 3>{{Lanes(1.), Lanes(1.), Lanes(1.)}});
        for (unsigned int i = 0; i < 6; ++i)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            lanes = std::max(lanes, std::abs(one[i][lane] - (i < 3)));
      }
    check("spectral decomposition, tensors", error, 1e-14);
    check("  values", values, 1e-14);
    check("  sum of the projections", lanes, 1e-14);

    // A tensor with entries that are NaN.
    SymmetricTensor2 bad;
    bad[0][1]         = std::nan("");
    bad[0][2]         = 1.;
    const Principal v = Spectrum(bad).values;
    check("  values of NaN", !std::isfinite(v[0] + v[1] + v[2]));

    // Logarithms and exponentials of tiny to huge numbers.
    double logarithm = 0, exponential = 0;
    for (unsigned int k = 0; k < 20000; ++k)
      {
        Lanes x, y;
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            const double size = k % 3 == 0 ? 0.39 : k % 3 == 1 ? 1.5 : 20.;
            y[lane] = size * random() * std::pow(10., -8 + 8 * random());
            x[lane] = std::max(double(y[lane]), -0.999);
          }
        const Lanes a = log_of_one_plus(x), b = exp_less_one(y);
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            logarithm =
              std::max(logarithm,
                       std::abs(a[lane] / std::log1p(double(x[lane])) - 1));
            exponential =
              std::max(exponential,
                       std::abs(b[lane] / std::expm1(double(y[lane])) - 1));
          }
      }
    check("  logarithms", logarithm, 2e-15);
    check("  exponentials", exponential, 2e-15);

    // Small strains keep their relative precision.
    Tensor2 F = one_tensor();
    F[0][0] += std::ldexp(1., -40); // exact in 1 + x
    const auto   e = left_cauchy_green_less_one(F);
    const double x = std::ldexp(1., -40);
    check("  a strain of 1e-12",
          std::abs(logarithmic_strains(Spectrum(e).values)[0] - std::log1p(x)) /
            x,
          1e-15);
  }



  void
  test(const std::string &name)
  {
    print() << name << std::endl;
    const double E = 2.5e6, nu = 0.3;
    const auto   material =
      make(name, {"Young modulus = 2.5e6", "Poisson ratio = 0.3"});
    const Moduli moduli = material->moduli();
    const double K = E / (3 * (1 - 2 * nu)), G = E / (2 * (1 + nu)),
                 M = K + 4. / 3. * G, lambda = K - 2. / 3. * G;
    check("  moduli",
          std::max(std::abs(moduli.bulk / K - 1),
                   std::abs(moduli.shear / G - 1)) +
            moduli.viscosity + moduli.bulk_viscosity,
          1e-14);

    // P = dW / dF by difference quotients.
    Random random;
    double derivative = 0;
    for (unsigned int k = 0; k < 200; ++k)
      {
        MaterialPoint point = rest(*material);
        step(*material,
             point,
             random.rotation(k % 2) *
               (one_tensor() + random.matrix(0.3, k % 2)));
        const Tensor2 P = first_piola_kirchhoff(point);
        const double  h = 1e-5;
        Tensor2       difference;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            for (const double sign : {-1., 1.})
              {
                MaterialPoint q = point;
                q.F[i][j] += sign * h;
                q.J = determinant(q.F);
                difference[i][j] += sign * material->strain_energy(q) / (2 * h);
              }
        derivative = std::max(derivative, (P - difference).norm() / P.norm());
      }
    check("  P = dW / dF", derivative, 1e-7);

    // Uniaxial strain and simple shear.
    double     uniaxial = 0, shear = 0;
    const bool hencky    = name == "linear-elastic";
    const bool decoupled = name == "decoupled-neo-hookean";
    for (const double x : {0.5, 0.9, 1.2, 2.})
      {
        MaterialPoint point = rest(*material);
        Tensor2       F     = one_tensor();
        F[1][1]             = x;
        step(*material, point, F);
        const double p       = K / 2 * (x - 1 / x);
        const double s_axial = 2. / 3. * G * (x * x - 1) / std::pow(x, 5. / 3.);
        const double axial   = hencky ? M * std::log(x) / x
                               : decoupled
                                 ? p + s_axial
                                 : (lambda * std::log(x) + G * (x * x - 1)) / x;
        const double lateral =
          decoupled ? p - s_axial / 2 : lambda * std::log(x) / x;
        uniaxial = std::max({uniaxial,
                             std::abs(point.stress[1][1] - axial) / M,
                             std::abs(point.stress[0][0] - lateral) / M,
                             std::abs(point.stress[2][2] - lateral) / M});

        point   = rest(*material);
        F       = one_tensor();
        F[0][2] = x;
        step(*material, point, F);
        // The largest stretch of simple shear: log((x + sqrt(x^2 + 4)) / 2).
        const double s    = std::asinh(x / 2) / std::sqrt(4 + x * x);
        const double xz   = hencky ? 4 * G * s : G * x;
        const double mean = decoupled ? G * x * x / 3 : 0;
        const double xx   = hencky ? 2 * G * x * s : G * x * x - mean;
        const double zz   = hencky ? -2 * G * x * s : -mean;
        shear             = std::max({shear,
                                      std::abs(point.stress[0][2] - xz) / M,
                                      std::abs(point.stress[0][0] - xx) / M,
                                      std::abs(point.stress[2][2] - zz) / M});
      }
    check("  uniaxial strain", uniaxial, 1e-14);
    check("  simple shear", shear, 1e-14);

    check_objectivity(*material, 0.1);

    // A closed cycle, and the work to a state.
    const Tensor2 A = random.matrix(0.3, false), B = random.matrix(0.3, false);
    const auto    cycle = [&](const double s) {
      return one_tensor() + std::sin(2 * numbers::PI * s) * A +
             (1 - std::cos(2 * numbers::PI * s)) * B;
    };
    MaterialPoint point = rest(*material);
    double        work = 0, largest = 0;
    for (unsigned int i = 0; i < 200; ++i)
      {
        const Tensor2 P = first_piola_kirchhoff(point), F = point.F;
        step(*material, point, cycle((i + 1) / 200.) * invert(F));
        work +=
          0.5 * scalar_product(P + first_piola_kirchhoff(point), point.F - F);
        largest = std::max(largest, material->strain_energy(point));
      }
    check("  work of a closed cycle", std::abs(work) / largest, 1e-3);
    const auto open = [&](const double s) { return cycle(0.4 * s); };
    check_order("  work - energy",
                energy_error(*material, open, 20),
                energy_error(*material, open, 40),
                2.);

    // The limit of small strains.
    double linear = 0;
    for (unsigned int k = 0; k < 20; ++k)
      {
        const auto e = symmetrize(random.matrix(1e-7, k % 2));
        point        = rest(*material);
        step(*material, point, one_tensor() + Tensor2(e));
        const auto sigma =
          K * trace(e) * unit_symmetric_tensor<3>() + 2 * G * deviator(e);
        linear = std::max(linear, (point.stress - sigma).norm() / sigma.norm());
      }
    check("  small strains", linear, 1e-6);

    // Its energy is that of linear elasticity, to the size of the strain.
    double quadratic = 0;
    for (const double size : {1e-4, 1e-7, 1e-10})
      for (unsigned int k = 0; k < 20; ++k)
        {
          point = rest(*material);
          step(*material, point, one_tensor() + random.matrix(size, k % 2));
          // The value of F after rounding.
          const auto   e = symmetrize(point.F - one_tensor());
          const double W =
            0.5 * K * trace(e) * trace(e) + G * deviator(e) * deviator(e);
          quadratic =
            std::max(quadratic,
                     std::abs(material->strain_energy(point) / W - 1.) /
                       (20. * size + 1e-16 / size));
        }
    check("  energy of small strains", quadratic, 1.);

    // The modulus of waves along a bar: F dP / dF.
    Tensor2 F = one_tensor();
    double  P[2];
    for (const unsigned int i : {0, 1})
      {
        point   = rest(*material);
        F[0][0] = (hencky || decoupled ? 0.7 : 1.3) + (i ? 1e-6 : -1e-6);
        step(*material, point, F);
        P[i] = first_piola_kirchhoff(point)[0][0];
      }
    check("  modulus of waves",
          std::abs(F[0][0] * (P[1] - P[0]) / 2e-6 / point.wave_modulus - 1),
          1e-5);

    // In strong tension it stays positive: waves keep a tenth of their speed.
    double slowest = 1.;
    for (const double J : {2., 4., 6., 8., 100.})
      {
        point = rest(*material);
        step(*material, point, std::cbrt(J) * one_tensor());
        slowest = std::min(slowest, J * point.wave_modulus / M);
        point   = rest(*material);
        F       = one_tensor();
        F[0][0] = J;
        step(*material, point, F);
        slowest = std::min(slowest, J * point.wave_modulus / M);
      }
    check("  modulus of waves in tension", 0.01 - slowest, 1e-15);

    std::vector<SymmetricTensor2> stresses;
    for (unsigned int k = 0; k < 50; ++k)
      stresses.push_back(symmetrize(random.matrix(3e5, k % 2)));
    for (const double p : {-1e7, -1e5, 5e5})
      stresses.push_back(p * unit_symmetric_tensor<3>());
    check_initialize(*material, stresses);
    // Each stress is one of the decoupled law.
    const double p = decoupled ? std::nan("") : 1e7;
    if (decoupled)
      check_initialize(*material, {1e7 * unit_symmetric_tensor<3>()});
    print_message(
      [&]() { material->initialize(point, p * unit_symmetric_tensor<3>()); });
  }
} // namespace



void
test_main()
{
  test_spectra();
  test("linear-elastic");
  test("neo-hookean");
  test("decoupled-neo-hookean");

  // The law of one-dimensional manufactured solutions.
  const auto material =
    make("neo-hookean", {"Young modulus = 100", "Poisson ratio = 0"});
  MaterialPoint point = rest(*material);
  Tensor2       F     = one_tensor();
  F[0][0]             = 1.4;
  step(*material, point, F);
  check("neo-hookean, nu = 0: P = E / 2 (F - 1 / F)",
        std::abs(first_piola_kirchhoff(point)[0][0] - 50 * (1.4 - 1 / 1.4)),
        1e-12);
}
