// SPDX-License-Identifier: LGPL-2.1-or-later

// Tangents of all laws, and the default for a law of a program's own, against
// extrapolated differences of stresses: random steps into each regime, in plane
// strain and in 3D, with repeated principal strains; symmetry.

#include "materials.h"

namespace
{
  const SymmetricTensor2 one = unit_symmetric_tensor<3>();

  // The stress after another end of a step: (1 + l) f for f.
  Tensor2
  stress_of(const Material &material, MaterialPoint point, const Tensor2 &l)
  {
    point.increment += l * point.increment;
    point.F += l * point.F;
    point.J *= determinant(one_tensor() + l);
    material.update(ArrayView<MaterialPoint>(&point, 1));
    return point.stress;
  }



  struct Reference
  {
    MaterialTangent tangent;
    // The largest change of a difference quotient with its side and size: large
    // on a kink.
    double kink = 0.;
  };



  // Central differences of two sizes, extrapolated.
  Reference
  reference(const Material      &material,
            const MaterialPoint &point,
            const unsigned int   dim)
  {
    const double  size  = std::ldexp(1., -19);
    const Tensor2 sigma = stress_of(material, point, Tensor2());
    Reference     result;
    for (unsigned int k = 0; k < dim; ++k)
      for (unsigned int l = 0; l < dim; ++l)
        {
          Tensor2 d[2][2];
          for (const unsigned int fine : {0, 1})
            for (const unsigned int back : {0, 1})
              {
                const double h = (back ? -1. : 1.) * size / (fine ? 2. : 1.);
                Tensor2      change;
                change[k][l] = h;
                d[fine][back] =
                  (stress_of(material, point, change) - sigma) / h;
              }
          const Tensor2 coarse = 0.5 * (d[0][0] + d[0][1]),
                        fine   = 0.5 * (d[1][0] + d[1][1]);
          const Tensor2 column = (4. * fine - coarse) / 3.;
          result.kink          = std::max({result.kink,
                                           (d[0][0] - d[0][1]).norm(),
                                           30. * (fine - coarse).norm()});
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              result.tangent[i][j][k][l] = column[i][j];
        }
    return result;
  }



  double
  norm(const MaterialTangent &D)
  {
    return std::sqrt(D.norm_square());
  }



  // The difference of D_ijkl + sigma_ij delta_kl - sigma_il delta_jk and its
  // transpose.
  double
  asymmetry(const MaterialTangent &D, const Tensor2 &sigma, unsigned int dim)
  {
    MaterialTangent A = D;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          {
            A[i][j][k][k] += sigma[i][j];
            A[i][k][k][j] -= sigma[i][j];
          }
    double square = 0.;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            square += Utilities::fixed_power<2>(A[i][j][k][l] - A[k][l][i][j]);
    return std::sqrt(square);
  }



  // What the points of a test have in common.
  struct Results
  {
    double       error = 0., error_of_default = 0., spin = 0., asymmetry = 0.;
    unsigned int n = 0, n_kinks = 0;

    void
    add(const Material &material, const MaterialPoint &point, unsigned int dim)
    {
      const Reference exact = reference(material, point, dim);
      const double    M =
        material.moduli().bulk + 4. / 3. * material.moduli().shear +
        (point.dt > 0. ? material.moduli().viscosity / point.dt : 0.);
      const double size = norm(exact.tangent);
      ++n;
      if (exact.kink > 0.02 * size + 1e-7 * M)
        {
          ++n_kinks;
          return;
        }
      MaterialTangent                      D, simple;
      const ArrayView<const MaterialPoint> points(&point, 1);
      material.tangents(points, ArrayView<MaterialTangent>(&D, 1), dim);
      material.Material::tangents(points,
                                  ArrayView<MaterialTangent>(&simple, 1),
                                  dim);
      // Rounding errors are those of the moduli.
      error = std::max(error, norm(D - exact.tangent) / (size + 1e-3 * M));
      error_of_default =
        std::max(error_of_default,
                 norm(simple - exact.tangent) / (size + 1e-3 * M));
      const Tensor2 sigma = stress_of(material, point, Tensor2());
      asymmetry           = std::max(asymmetry, ::asymmetry(D, sigma, dim) / M);
      // The columns beyond.
      for (unsigned int i = 0; i < 3 && dim == 2; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          for (unsigned int k = 0; k < 3; ++k)
            if (D[i][j][k][2] != 0. || D[i][j][2][k] != 0.)
              error = 1.;
    }
  };



  // Random steps from random states.
  void
  test(const std::string              &name,
       const std::vector<std::string> &settings,
       const double                    size,
       const bool                      symmetric,
       const double                    isotropic = 0.,
       const double                    dt        = 1.)
  {
    print() << name << std::endl;
    for (const std::string &setting : settings)
      print() << "  " << setting << std::endl;
    const auto    material = make(name, settings);
    Random        random;
    Results       results;
    MaterialPoint point = rest(*material);
    for (unsigned int k = 0; k < 1500; ++k)
      {
        if (k % 4 == 0)
          point = rest(*material);
        const bool       plane = k / 4 % 2;
        SymmetricTensor2 e =
          size * std::exp(2. * random()) * symmetrize(random.matrix(1., plane));
        if (k % 3 == 0) // repeated principal strains
          e[0][0] = e[1][1], e[0][1] = (k % 2 ? 1e-9 : 0.) * e[1][1];
        if (k % 7 == 0) // almost the same in all directions
          e = 0.03 * deviator(e) + e.norm() * one;
        e += isotropic * size * one;
        Tensor2 f = one_tensor() + Tensor2(e) +
                    random.matrix(k % 7 == 0 ? 1e-4 * size : size, plane);
        if (k % 3 == 0)
          f = one_tensor() + Tensor2(e);
        if (plane)
          f[2][2] = 1.;
        point.increment = f;
        point.F         = f * point.F;
        point.J         = determinant(point.F);
        point.dt        = dt;
        results.add(*material, point, plane ? 2 : 3);
        material->update(ArrayView<MaterialPoint>(&point, 1));
      }
    check("  points on kinks", results.n_kinks / double(results.n), 0.05);
    check("  tangent", results.error, 1e-6);
    check("  tangent by differences", results.error_of_default, 1e-6);
    check("  claim of symmetry",
          material->has_symmetric_tangent() == symmetric);
    check("  asymmetry",
          symmetric ? results.asymmetry <= 1e-7 : results.asymmetry >= 1e-5);
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const std::vector<std::string>   elastic = {"Youngs modulus = 3e6",
                                              "Poissons ratio = 0.25"};
  const auto                       with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), elastic.begin(), elastic.end());
    return more;
  };
  test("linear-elastic", elastic, 0.03, true);
  test("neo-hookean", elastic, 0.03, true);
  test("von-mises",
       with({"Yield stress = 2e4", "Hardening modulus = 5e4"}),
       0.01,
       true);
  test("newtonian-fluid", {"Viscosity = 5"}, 0.01, false, 0., 1e-2);
}
