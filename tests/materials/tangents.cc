// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks tangents of all laws, and the default tangent of a law of the user,
// against extrapolated stress differences: random steps into each regime, in
// plane strain and in 3D, with repeated principal strains; symmetry.

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



  // Where steps end.
  const char *const regimes[] = {"elastic",
                                 "three different stresses",
                                 "smaller two equal",
                                 "larger two equal",
                                 "isotropic",
                                 "opening",
                                 "closing"};

  void
  count_regimes(const MaterialPoint         &before,
                const MaterialPoint         &after,
                std::array<unsigned int, 7> &n_visits)
  {
    const Principal stress = principal(after.stress);
    const double    gap    = 1e-9 * after.stress.norm();
    const bool      upper  = stress[0] - stress[1] < gap,
               lower       = stress[1] - stress[2] < gap;
    if (after.state[7] == before.state[7]) // no plastic work
      ++n_visits[0];
    else
      ++n_visits[upper && lower ? 4 : upper ? 3 : lower ? 2 : 1];
    if (after.state[8] != before.state[8])
      ++n_visits[after.state[8] > before.state[8] ? 5 : 6];
  }



  class Comparison
  {
  public:
    Comparison(const Material &material)
      : material(material)
      , modulus(material.moduli().bulk + 4. / 3. * material.moduli().shear)
    {}

    // Tangents at a point in a step of dimension dim.
    void
    add(const MaterialPoint &point, const unsigned int dim)
    {
      const double M =
        modulus + (point.dt > 0. ? material.moduli().viscosity / point.dt : 0.);
      const Reference exact = reference(material, point, dim);
      const double    size  = std::sqrt(exact.tangent.norm_square()) + 1e-3 * M;
      ++n_points;
      if (exact.kink > 3e-3 * size)
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
      error = std::max(error, norm(D - exact.tangent) / size);
      error_of_default =
        std::max(error_of_default, norm(simple - exact.tangent) / size);

      // The stiffness of soil grows with the pressure.
      MaterialPoint end = point;
      material.update(ArrayView<MaterialPoint>(&end, 1));
      const double  stiffness = std::max(M, end.wave_modulus);
      const Tensor2 sigma     = end.stress;
      largest_asymmetry =
        std::max(largest_asymmetry, asymmetry(D, sigma, dim) / stiffness);
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          {
            // The stress turns with a spin of the axes 0 and 1.
            double turned = D[i][j][0][1] - D[i][j][1][0];
            for (unsigned int k = 0; k < 3; ++k)
              turned -= (i == 0 && k == 1   ? sigma[k][j]
                         : i == 1 && k == 0 ? -sigma[k][j]
                                            : 0.) -
                        (k == 0 && j == 1   ? sigma[i][k]
                         : k == 1 && j == 0 ? -sigma[i][k]
                                            : 0.);
            spin = std::max(spin, std::abs(turned) / stiffness);
            for (unsigned int k = 0; k < 3 && dim == 2; ++k)
              other_columns = std::max({other_columns,
                                        std::abs(D[i][j][k][2]),
                                        std::abs(D[i][j][2][k])});
          }
    }

    void
    report(const bool symmetric, const bool objective) const
    {
      check("  points on kinks", n_kinks / double(n_points), 0.04);
      check("  tangent", error, 1e-7);
      check("  by differences", error_of_default, 1e-6);
      check("  other columns in plane strain", other_columns, 0.);
      check("  a spin turns the stress",
            objective ? spin <= 1e-14 : spin > 1e-6);
      check("  claim of symmetry",
            material.has_symmetric_tangent() == symmetric);
      check("  symmetry",
            symmetric ? largest_asymmetry <= 1e-13 : largest_asymmetry > 1e-5);
    }

  private:
    const Material &material;
    const double    modulus;
    double error = 0., error_of_default = 0., largest_asymmetry = 0., spin = 0.,
           other_columns  = 0.;
    unsigned int n_points = 0, n_kinks = 0;
  };



  // Random steps from random states, in extension and compression.
  void
  test(const std::string              &name,
       const std::vector<std::string> &settings,
       const double                    size,
       const bool                      symmetric)
  {
    const bool is_fluid = make(name)->shares_volume();
    print() << name;
    for (const std::string &setting : settings)
      print() << ", " << setting;
    print() << std::endl;
    const auto                  material = make(name, settings);
    Comparison                  comparison(*material);
    Random                      random;
    std::array<unsigned int, 7> n_visits{};
    unsigned int                n_torn = 0;
    MaterialPoint               point  = rest(*material);
    for (unsigned int k = 0; k < 4000; ++k)
      {
        if (k % 4 == 0)
          point = rest(*material);
        const bool       plane = k / 4 % 2;
        SymmetricTensor2 e =
          size * std::exp(2. * random()) * symmetrize(random.matrix(1., plane));
        if (k % 3 == 0) // repeated principal strains, or almost
          {
            e[0][0] = e[1][1];
            e[0][1] = (k % 2 ? 1e-9 : 0.) * e[1][1];
          }
        if (k % 7 == 0) // almost the same in all directions
          e = 0.03 * deviator(e) + e.norm() * one;
        e += (k % 8 < 4 ? -0.5 : 0.2) * size * one;
        Tensor2 f = one_tensor() + Tensor2(e);
        if (k % 3 != 0)
          f += random.matrix(k % 7 == 0 ? 1e-4 * size : size, plane);
        if (plane)
          f[2][2] = 1.;
        point.increment          = f;
        point.F                  = f * point.F;
        point.J                  = determinant(point.F);
        point.dt                 = 1e-2;
        point.strength_reduction = material->strength_reduction(0.);
        comparison.add(point, plane ? 2 : 3);
        n_torn += point.J > 1.;
        const MaterialPoint before = point;
        material->update(ArrayView<MaterialPoint>(&point, 1));
        count_regimes(before, point, n_visits);
      }
    comparison.report(symmetric, material->moduli().viscosity == 0.);
    if (is_fluid)
      check("  extension and compression", n_torn > 100 && n_torn < 3900);
    else if (material->state_names().size() > 0)
      for (unsigned int i = 0; i < 7; ++i)
        if (n_visits[i] >= 15)
          print() << "  " << regimes[i] << std::endl;
  }



  // Steps of no length and without deformation.
  void
  test_rest(const std::string              &name,
            const std::vector<std::string> &settings = {})
  {
    const auto                     material = make(name, settings);
    std::array<MaterialPoint, 6>   points;
    std::array<MaterialTangent, 6> D;
    for (unsigned int i = 0; i < 6; ++i)
      {
        material->initialize(points[i],
                             i < 3 ? SymmetricTensor2() : -10. * one);
        points[i].increment = one_tensor();
        points[i].dt        = i % 3 == 0 ? 0. : 1e-3;
        if (i % 3 == 2) // a tiny extension
          points[i].increment *= 1. + 1e-15;
      }
    material->tangents(ArrayView<const MaterialPoint>(points.data(), 6),
                       ArrayView<MaterialTangent>(D.data(), 6),
                       3);
    double sum = 0.;
    for (const MaterialTangent &tangent : D)
      sum += norm(tangent);
    check("at rest: " + name, std::isfinite(sum) && sum > 0.);
    // Hooke's law.
    if (name == "linear-elastic" || name == "von-mises")
      {
        const double K = material->moduli().bulk, G = material->moduli().shear;
        MaterialTangent hooke;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            {
              hooke[i][i][j][j] += K - 2. / 3. * G;
              hooke[i][j][i][j] += G;
              hooke[i][j][j][i] += G;
            }
        check("  Hooke's law", norm(D[0] - hooke) / norm(hooke), 1e-14);
      }
  }



  // A law of a program's own, which knows nothing of tangents: the neo-Hookean
  // one without Poisson's effect.
  class Sponge : public MaterialLaw<Sponge>
  {
  public:
    static constexpr const char *name = "sponge";

    void
    initialize(MaterialPoint &point, const SymmetricTensor2 &) const override
    {
      point.F = one_tensor();
    }

    void
    update_point(MaterialPoint &point) const
    {
      point.stress = 5e5 / point.J * left_cauchy_green_less_one(point.F);
    }

    double
    strain_energy(const MaterialPoint &) const override
    {
      return 0.;
    }

    Moduli
    moduli() const override
    {
      return {1e6 / 3., 5e5};
    }
  };



  void
  test_own_law()
  {
    add_material<Sponge>();
    const auto sponge = make("sponge");
    const auto library =
      make("neo-hookean", {"Young modulus = 1e6", "Poisson ratio = 0"});
    Random random;
    double error = 0.;
    for (unsigned int k = 0; k < 100; ++k)
      {
        MaterialPoint point = rest(*sponge);
        step(*sponge, point, one_tensor() + random.matrix(0.3, k % 2));
        MaterialTangent D[2];
        for (const unsigned int i : {0, 1})
          (i == 0 ? sponge : library)
            ->tangents(ArrayView<const MaterialPoint>(&point, 1),
                       ArrayView<MaterialTangent>(&D[i], 1),
                       k % 2 ? 2 : 3);
        error = std::max(error, norm(D[0] - D[1]) / norm(D[1]));
      }
    check("a law of a program's own", error, 1e-8);
  }
} // namespace



void
test_main()
{
  const std::vector<std::string> elastic = {"Young modulus = 3e6",
                                            "Poisson ratio = 0.25"};
  const auto                     with    = [&](std::vector<std::string> more) {
    more.insert(more.begin(), elastic.begin(), elastic.end());
    return more;
  };
  test("linear-elastic", elastic, 0.03, true);
  test("neo-hookean", elastic, 0.03, true);
  test("decoupled-neo-hookean", elastic, 0.03, true);
  test("von-mises",
       with({"Yield stress = 2e4", "Hardening modulus = 5e4"}),
       0.01,
       true);
  test("von-mises", with({"Yield stress = 2e4"}), 0.01, true);

  const std::vector<std::string> cones[] = {
    {"Friction angle = 30", "Dilatancy angle = 10", "Cohesion = 1e4"},
    {"Friction angle = 20", "Dilatancy angle = 20", "Cohesion = 5e3"},
    {"Friction angle = 20", "Dilatancy angle = 20", "Cohesion = 0"},
    {"Friction angle = 0", "Dilatancy angle = 0", "Cohesion = 1e4"},
    {"Friction angle = 25",
     "Dilatancy angle = 5",
     "Cohesion = 1e4",
     "Tension cut-off = 6000",
     "Cone = outer"},
    {"Friction angle = 35",
     "Cohesion = 5e3",
     "Tension cut-off = 0",
     "Cone = inner"}};
  for (const auto &settings : cones)
    test("drucker-prager",
         with(settings),
         0.005,
         settings[2] == "Cohesion = 0" || settings[0] == "Friction angle = 0");

  const std::vector<std::string> pyramids[] = {
    {"Friction angle = 30", "Dilatancy angle = 10", "Cohesion = 5e3"},
    {"Friction angle = 30", "Dilatancy angle = 30", "Cohesion = 0"},
    {"Friction angle = 0", "Dilatancy angle = 0", "Cohesion = 8e3"},
    {"Friction angle = 35",
     "Residual friction angle = 25",
     "Dilatancy angle = 5",
     "Cohesion = 8e3",
     "Residual cohesion = 2e3"},
    {"Friction angle = 40",
     "Residual friction angle = 30",
     "Cohesion = 8e3",
     "Residual cohesion = 1e3",
     "Softening = exponential"},
    {"Friction angle = 40",
     "Residual friction angle = 30",
     "Dilatancy angle = 25",
     "Cohesion = 8e3",
     "Residual cohesion = 4e3",
     "Strength reduction = 1.4"}};
  for (const auto &settings : pyramids)
    test("mohr-coulomb",
         with(settings),
         0.005,
         settings[2] == "Cohesion = 0" || settings[0] == "Friction angle = 0");

  test("modified-cam-clay",
       {"Shear modulus = 1e6",
        "Swelling slope = 0.02",
        "Attraction = 1e4",
        "Overconsolidation ratio = 2"},
       0.01,
       false);
  test("modified-cam-clay",
       {"Shear modulus = 1e6", "Swelling slope = 0.02", "Attraction = 1e4"},
       0.01,
       false);
  for (const std::string psi : {"-0.1", "0.1"})
    test("nor-sand",
         {"Shear modulus = 1e6",
          "Swelling slope = 0.02",
          "Attraction = 1e4",
          "State parameter = " + psi},
         0.01,
         false);

  for (const std::string tension : {"true", "false"})
    {
      test("newtonian-fluid",
           {"Viscosity = 5",
            "Bulk viscosity = 2",
            "Allow tension = " + tension},
           0.01,
           false);
      test("bingham",
           {"Regularization = 0.2", "Allow tension = " + tension},
           0.01,
           false);
    }
  test("newtonian-fluid", {"Viscosity = 0"}, 0.01, true);

  for (const std::string name : {"linear-elastic",
                                 "neo-hookean",
                                 "decoupled-neo-hookean",
                                 "von-mises",
                                 "newtonian-fluid",
                                 "bingham"})
    test_rest(name);
  test_rest("modified-cam-clay");
  test_rest("nor-sand");
  for (const std::string name : {"drucker-prager", "mohr-coulomb"})
    for (const std::string cohesion : {"0", "1e3"})
      test_rest(name, {"Cohesion = " + cohesion});
  test_own_law();
}
