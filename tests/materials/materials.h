// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// Shared by the tests of materials: materials from a text with parameters,
// steps of one point, random deformations.

#include <greville/base/eigenvectors.h>
#include <greville/base/parameters.h>
#include <greville/materials/hencky.h>
#include <greville/materials/material.h>

#include <random>
#include <tests.h>

using SymmetricTensor2 = SymmetricTensor<2, 3>;
using Tensor2          = Tensor<2, 3>;

inline const Tensor2 &
one_tensor()
{
  static const Tensor2 one = unit_symmetric_tensor<3>();
  return one;
}



// A material with lines "PARAMETER = VALUE" in its section, "Material".
inline std::unique_ptr<Material>
make(const std::string &name, const std::vector<std::string> &settings = {})
{
  auto             material = make_material(name, "Name");
  ParameterHandler prm;
  declare_section(prm, "Material", *material);
  std::string text = "subsection Material\n";
  for (const std::string &setting : settings)
    text += "set " + setting + "\n";
  prm.parse_input_from_string(text + "end\n");
  material->reinit("Material");
  return material;
}



// The stress-free state.
inline MaterialPoint
rest(const Material &material)
{
  MaterialPoint point;
  material.initialize(point, SymmetricTensor2());
  return point;
}



inline void
step(const Material &material,
     MaterialPoint  &point,
     const Tensor2  &f,
     const double    dt = 1.)
{
  point.increment = f;
  point.F         = f * point.F;
  point.J         = determinant(point.F);
  point.dt        = dt;
  material.update(ArrayView<MaterialPoint>(&point, 1));
}



// P = J sigma F^-T.
inline Tensor2
first_piola_kirchhoff(const MaterialPoint &point)
{
  return point.J * Tensor2(point.stress) * transpose(invert(point.F));
}



class Random
{
public:
  // Between -1 and 1.
  double
  operator()()
  {
    return 2. * (engine() / 4294967296.) - 1.;
  }

  // In the plane: without xz, yz, zx, zy.
  Tensor2
  matrix(const double size, const bool plane)
  {
    Tensor2 A;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        if (!plane || (i == 2) == (j == 2))
          A[i][j] = size * (*this)();
    return A;
  }

  Tensor2
  rotation(const bool plane)
  {
    Tensor<1, 3> axis;
    axis[2] = 1.;
    while (!plane && axis.norm() >= 1.)
      for (unsigned int d = 0; d < 3; ++d)
        axis[d] = (*this)();
    axis /= axis.norm();
    const double angle = 3. * (*this)();
    Tensor2      R     = std::cos(angle) * one_tensor() +
                (1. - std::cos(angle)) * outer_product(axis, axis);
    for (unsigned int d = 0; d < 3; ++d)
      {
        R[(d + 1) % 3][d] += axis[(d + 2) % 3] * std::sin(angle);
        R[d][(d + 1) % 3] -= axis[(d + 2) % 3] * std::sin(angle);
      }
    return R;
  }

private:
  std::mt19937 engine;
};



inline SymmetricTensor2
rotated(const Tensor2 &R, const SymmetricTensor2 &A)
{
  return symmetrize(R * Tensor2(A) * transpose(R));
}



// By deal.II's algorithm, in descending order.
inline Principal
principal(const SymmetricTensor2 &A)
{
  const auto pairs = eigenvectors(A, SymmetricTensorEigenvectorMethod::jacobi);
  return {{pairs[0].first, pairs[1].first, pairs[2].first}};
}



// A motion of several steps, superposed by rotations of any size that change
// from step to step: the stress turns with them.
inline void
check_objectivity(const Material &material, const double size)
{
  Random random;
  double error = 0;
  for (unsigned int k = 0; k < 100; ++k)
    {
      MaterialPoint a = rest(material), b = a;
      Tensor2       R = one_tensor();
      for (unsigned int n = 0; n < 5; ++n)
        {
          const Tensor2 f     = one_tensor() + random.matrix(size, k % 2 == 0);
          const Tensor2 R_new = random.rotation(k % 4 == 0);
          step(material, a, f);
          step(material, b, R_new * f * transpose(R));
          R     = R_new;
          error = std::max(error,
                           (b.stress - rotated(R, a.stress)).norm() /
                             std::max(a.stress.norm(), size * a.wave_modulus));
        }
    }
  check("  objectivity", error, 1e-12);
}



// Stress at the start is kept by a step without deformation.
inline void
check_initialize(const Material                      &material,
                 const std::vector<SymmetricTensor2> &stresses)
{
  double error = 0, volume = 0, wave = 0;
  for (const SymmetricTensor2 &stress : stresses)
    {
      MaterialPoint point;
      material.initialize(point, stress);
      volume = std::max(volume, std::abs(determinant(point.F) - point.J));
      error  = std::max(error, (point.stress - stress).norm() / stress.norm());
      const double modulus = point.wave_modulus;
      point.increment      = one_tensor();
      material.update(ArrayView<MaterialPoint>(&point, 1));
      error = std::max(error, (point.stress - stress).norm() / stress.norm());
      wave  = std::max(wave, std::abs(point.wave_modulus / modulus - 1.));
    }
  check("  initialize() keeps the stress", error, 1e-12);
  check("    and J = det F", volume, 1e-14);
  check("    and the modulus of waves", wave, 1e-12);
}



// By how much work (trapezoidal rule), stored and dissipated energy differ
// along a path of n steps, relative to the work; the path is F(s), 0 <= s <= 1.
inline double
energy_error(const Material                               &material,
             const std::function<Tensor2(const double s)> &path,
             const unsigned int                            n)
{
  MaterialPoint point = rest(material);
  const double  start = material.strain_energy(point);
  double        work  = 0;
  for (unsigned int i = 0; i < n; ++i)
    {
      const Tensor2 P = first_piola_kirchhoff(point), F = point.F;
      const Tensor2 f = path((i + 1.) / n) * invert(F);
      step(material, point, f, 1. / n);
      work +=
        0.5 * scalar_product(P + first_piola_kirchhoff(point), point.F - F);
    }
  return std::abs(work - (material.strain_energy(point) - start) -
                  material.dissipation(point)) /
         std::abs(work);
}



inline void
check_order(const std::string &what,
            const double       coarse,
            const double       fine,
            const double       lowest)
{
  const double order = std::log2(coarse / fine);
  check(what + " converges with order " + std::to_string(int(lowest)) +
          " or better",
        lowest - order,
        0.1);
}



// The message of an exception.
inline void
print_message(const std::function<void()> &action)
{
  try
    {
      action();
      print() << "accepted: FAILED" << std::endl;
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}
