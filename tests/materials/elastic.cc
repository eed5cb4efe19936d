// Spectral decompositions; the elastic laws against derivatives of their
// energy, closed forms, rotations, closed cycles, and their linear limits.

#include "materials.h"

namespace
{
  void
  test_spectra()
  {
    Random random;
    double error = 0, values = 0;
    for (unsigned int k = 0; k < 2000; ++k)
      {
        // Eigenvalues that are different, close, or equal.
        const double     d[] = {1., 1e-5, 1e-9, 1e-13, 1e-16, 0.};
        const double     a = d[k % 6], b = d[k / 6 % 6];
        SymmetricTensor2 A;
        A[0][0] = 0.3, A[1][1] = 0.3 + a, A[2][2] = 0.3 - 0.5 * b;
        const bool                  plane = k % 2 == 0;
        const auto                  B     = rotated(random.rotation(plane), A);
        const SpectralDecomposition spectrum(B);
        error =
          std::max(error,
                   (spectrum.assemble(spectrum.values) - B).norm() / A.norm());
        Principal exact{{A[0][0], A[1][1], A[2][2]}}, v = spectrum.values;
        std::sort(exact.begin(), exact.end());
        std::sort(v.begin(), v.end());
        for (unsigned int i = 0; i < 3; ++i)
          values = std::max(values, std::abs(v[i] - exact[i]) / A.norm());
      }
    check("spectral decomposition, tensors", error, 1e-14);
    check("  values", values, 1e-14);

    // Small strains keep their relative precision.
    Tensor2 F = one_tensor();
    F[0][0] += std::ldexp(1., -40); // exact in 1 + x
    const auto   e = left_cauchy_green_less_one(F);
    const double x = std::ldexp(1., -40);
    check("  a strain of 1e-12",
          std::abs(logarithmic_strains(SpectralDecomposition(e).values)[0] -
                   std::log1p(x)) /
            x,
          1e-15);
  }



  void
  test(const std::string &name)
  {
    print() << name << std::endl;
    const double E = 2.5e6, nu = 0.3;
    const auto   material =
      make(name, {"Youngs modulus = 2.5e6", "Poissons ratio = 0.3"});
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
    const bool hencky = name == "linear-elastic";
    for (const double x : {0.5, 0.9, 1.2, 2.})
      {
        MaterialPoint point = rest(*material);
        Tensor2       F     = one_tensor();
        F[1][1]             = x;
        step(*material, point, F);
        const double axial   = hencky
                                 ? M * std::log(x) / x
                                 : (lambda * std::log(x) + G * (x * x - 1)) / x;
        const double lateral = lambda * std::log(x) / x;
        uniaxial             = std::max({uniaxial,
                                         std::abs(point.stress[1][1] - axial) / M,
                                         std::abs(point.stress[0][0] - lateral) / M,
                                         std::abs(point.stress[2][2] - lateral) / M});

        point   = rest(*material);
        F       = one_tensor();
        F[0][2] = x;
        step(*material, point, F);
        // The largest stretch of simple shear: log((x + sqrt(x^2 + 4)) / 2).
        const double s  = std::asinh(x / 2) / std::sqrt(4 + x * x);
        const double xz = hencky ? 4 * G * s : G * x;
        const double xx = hencky ? 2 * G * x * s : G * x * x;
        const double zz = hencky ? -2 * G * x * s : 0;
        shear           = std::max({shear,
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

    // The modulus of waves along a bar: F dP / dF.
    Tensor2 F = one_tensor();
    double  P[2];
    for (const unsigned int i : {0, 1})
      {
        point   = rest(*material);
        F[0][0] = (hencky ? 0.7 : 1.3) + (i ? 1e-6 : -1e-6);
        step(*material, point, F);
        P[i] = first_piola_kirchhoff(point)[0][0];
      }
    check("  modulus of waves",
          std::abs(F[0][0] * (P[1] - P[0]) / 2e-6 / point.wave_modulus - 1),
          1e-5);

    std::vector<SymmetricTensor2> stresses;
    for (unsigned int k = 0; k < 50; ++k)
      stresses.push_back(symmetrize(random.matrix(3e5, k % 2)));
    for (const double p : {-1e7, -1e5, 5e5})
      stresses.push_back(p * unit_symmetric_tensor<3>());
    check_initialize(*material, stresses);
    print_message(
      [&]() { material->initialize(point, 1e7 * unit_symmetric_tensor<3>()); });
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  test_spectra();
  test("linear-elastic");
  test("neo-hookean");

  // The law of one-dimensional manufactured solutions.
  const auto material =
    make("neo-hookean", {"Youngs modulus = 100", "Poissons ratio = 0"});
  MaterialPoint point = rest(*material);
  Tensor2       F     = one_tensor();
  F[0][0]             = 1.4;
  step(*material, point, F);
  check("neo-hookean, nu = 0: P = E / 2 (F - 1 / F)",
        std::abs(first_piola_kirchhoff(point)[0][0] - 50 * (1.4 - 1 / 1.4)),
        1e-12);
}
