// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/materials/element_test.h>
#include <greville/materials/hencky.h>
#include <greville/materials/parameter_checks.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int x = 0, z = 2;



    enum class Test
    {
      isotropic,
      oedometer,
      drained,
      undrained,
      shear
    };



    /// Return the tests; programs may ask for their names before main().
    const Choices<Test> &
    tests()
    {
      static const Choices<Test> list = {{Test::isotropic, "isotropic"},
                                         {Test::oedometer, "oedometer"},
                                         {Test::drained, "triaxial-drained"},
                                         {Test::undrained,
                                          "triaxial-undrained"},
                                         {Test::shear, "simple-shear"}};
      return list;
    }



    /// The deformation from the start of a test: logarithmic strains (positive
    /// in extension) and the shear S_xz.
    struct Stretch
    {
      double lateral = 0., axial = 0., shear = 0.;

      double
      volume() const
      {
        return 2. * lateral + axial;
      }

      Tensor<2, 3>
      tensor() const
      {
        Tensor<2, 3> S;
        S[0][0] = S[1][1] = std::exp(lateral);
        S[z][z]           = std::exp(axial);
        S[x][z]           = shear;
        return S;
      }
    };



    class ElementTest
    {
    public:
      ElementTest(const Material              &material,
                  const std::string           &section,
                  const Test                   test,
                  const ElementTestParameters &parameters)
        : material(material)
        , section(section)
        , test(test)
        , is_shear(test == Test::shear)
        , kept(is_shear ? z : x)
        , parameters(parameters)
        , names(material.state_names())
      {
        const auto &start = parameters.initial_stress;
        check_parameter(start.size() == 1 || start.size() == 2,
                        ElementTestParameters::section,
                        "Initial stress",
                        start.size(),
                        "one number or two");
        SymmetricTensor<2, 3> stress;
        stress[0][0] = stress[1][1] = -start.back();
        stress[z][z]                = -start.front();
        point.strength_reduction    = material.strength_reduction(0.);
        material.initialize(point, stress);
        F_start      = point.F;
        stress_start = stress;
      }

      ElementTestTable
      run()
      {
        ElementTestTable table;
        table.names = Utilities::split_string_list(
          "strain_axial, strain_volumetric, strain_shear, p, q, void_ratio, "
          "pore_pressure, stress_axial, stress_shear");
        for (const std::string &name : names)
          if (name != "void_ratio")
            table.names.push_back(name);
        table.rows.push_back(row());
        double last = 0.;
        for (const double end : parameters.strains)
          {
            for (unsigned int n = 1; n <= parameters.steps; ++n)
              {
                const double share = double(n) / parameters.steps;
                go_to(share < 1. ? last + share * (end - last) : end,
                      std::abs(end - last) / parameters.steps);
                table.rows.push_back(row());
              }
            last = end;
          }
        return table;
      }

    private:
      /// Return the deformation for the controlled strain and the unknown.
      Stretch
      stretch_of(const double strain, const double unknown) const
      {
        switch (test)
          {
            case Test::isotropic:
              return {-strain / 3., -strain / 3., 0.};
            case Test::drained:
              return {unknown, -strain, 0.};
            case Test::undrained:
              return {strain / 2., -strain, 0.};
            case Test::shear:
              return {0., unknown, strain};
            case Test::oedometer:
              break;
          }
        return {0., -strain, 0.};
      }

      /// Return the point at the beginning of a step that ends with @p next, as
      /// the argument of Material::update().
      MaterialPoint
      begin_step(const Stretch &next, const double dt) const
      {
        MaterialPoint      result = point;
        const Tensor<2, 3> S      = next.tensor();
        result.increment          = S * invert(stretch.tensor());
        result.F                  = S * F_start;
        result.J                  = determinant(result.F);
        result.dt                 = dt;
        result.strength_reduction = material.strength_reduction(time + dt);
        result.time               = time + dt;
        return result;
      }

      MaterialPoint
      update(MaterialPoint result) const
      {
        material.update(ArrayView<MaterialPoint>(&result, 1));
        return result;
      }

      /// Return the difference of the prescribed stress from its initial value.
      double
      residual(const MaterialPoint &at) const
      {
        return at.stress[kept][kept] - stress_start[kept][kept];
      }

      /// Return the derivative of residual() by the unknown.
      double
      slope(const MaterialPoint &begun) const
      {
        MaterialTangent D;
        material.tangents(ArrayView<const MaterialPoint>(&begun, 1),
                          ArrayView<MaterialTangent>(&D, 1),
                          3);
        return is_shear ? D[z][z][z][z] : D[x][x][0][0] + D[x][x][1][1];
      }

      void
      go_to(const double strain, const double change)
      {
        const double  dt      = change / parameters.strain_rate;
        double        unknown = is_shear ? stretch.axial : stretch.lateral;
        MaterialPoint begun   = begin_step(stretch_of(strain, unknown), dt);
        MaterialPoint ended   = update(begun);
        bool          is_done = !is_shear && test != Test::drained;
        for (unsigned int i = 0; i < most_iterations && !is_done; ++i)
          {
            const double r = residual(ended);
            // Round-off of stresses, and the effect of rounded strains on them.
            const double tolerance =
              1e-12 * (ended.stress.norm() + stress_start.norm()) +
              1e-15 * std::abs(ended.wave_modulus);
            is_done = std::abs(r) <= tolerance;
            if (is_done)
              break;
            const double full = -r / slope(begun);
            // Shorten the step if it does not reduce the residual.
            double factor    = 1.;
            bool   is_nearer = false;
            for (unsigned int k = 0; k < 40 && !is_nearer; ++k, factor *= 0.5)
              {
                const double        next = unknown + factor * full;
                const MaterialPoint trial_begun =
                  begin_step(stretch_of(strain, next), dt);
                const MaterialPoint trial = update(trial_begun);
                is_nearer = std::abs(residual(trial)) < std::abs(r);
                if (is_nearer)
                  {
                    unknown = next;
                    begun   = trial_begun;
                    ended   = trial;
                  }
              }
            if (!is_nearer)
              {
                // Either the residual is round-off, or there is no solution.
                is_done = std::abs(r) <= 1e3 * tolerance;
                break;
              }
          }
        Require(std::isfinite(ended.stress.norm()),
                where(strain) + " gives a stress that is not finite.");
        Require(is_done,
                where(strain) + " has not converged: the " +
                  (is_shear ? "axial" : "lateral") + " stress is " +
                  text_of(-residual(ended) - stress_start[kept][kept]) +
                  " Pa and has to be " + text_of(-stress_start[kept][kept]) +
                  " Pa, positive in compression. Increase 'Element test/Steps' "
                  "for smaller steps.");
        point   = ended;
        stretch = stretch_of(strain, unknown);
        time += dt;
      }

      std::string
      where(const double strain) const
      {
        return "The element test '" + word_of(test, tests()) + "' of '" +
               section + "': the step to the strain " + text_of(strain);
      }

      std::vector<double>
      row() const
      {
        const SymmetricTensor<2, 3> &sigma = point.stress;
        const double axial = -sigma[z][z], lateral = -sigma[x][x];
        const auto   own =
          std::find(names.begin(), names.end(), "void_ratio") - names.begin();
        std::vector<double> result = {
          -stretch.axial,
          -stretch.volume(),
          is_shear ? stretch.shear
                   : -2. / 3. * (stretch.axial - stretch.lateral),
          -trace(sigma) / 3.,
          is_shear ? std::sqrt(1.5) * deviator(sigma).norm() : axial - lateral,
          std::size_t(own) < names.size()
            ? point.state[own]
            : (1. + parameters.void_ratio) * std::exp(stretch.volume()) - 1.,
          test == Test::undrained ? -stress_start[x][x] - lateral : 0.,
          axial,
          sigma[x][z]};
        for (std::size_t k = 0; k < names.size(); ++k)
          if (std::ptrdiff_t(k) != own)
            result.push_back(point.state[k]);
        // Replace -0 by 0.
        for (double &value : result)
          value += 0.;
        return result;
      }

      static constexpr unsigned int most_iterations = 50;

      const Material                &material;
      const std::string              section;
      const Test                     test;
      const bool                     is_shear;
      const unsigned int             kept; // direction of the prescribed stress
      const ElementTestParameters   &parameters;
      const std::vector<std::string> names;

      MaterialPoint         point;
      Stretch               stretch;
      Tensor<2, 3>          F_start;
      SymmetricTensor<2, 3> stress_start;
      double                time = 0.;
    };
  } // namespace



  void
  ElementTestParameters::declare(ParameterHandler &prm)
  {
    using namespace Patterns;
    add_parameter(prm, "Initial stress", initial_stress, List(Double(), 1, 2))(
      "Axial and lateral stress at the start of an element test, positive in "
      "compression; one number: both. Unit: Pa.");
    add_parameter(prm, "Strain", strains, List(Double(), 1))(
      "Values of the controlled strain at which it reverses, and at which the "
      "test ends: the logarithmic axial strain, volumetric strain (isotropic) "
      "or shear; positive in compression. Unit: none.");
    add_parameter(prm, "Steps", steps, Integer(1))(
      "Number of steps from one of the values of 'Strain' to the next. Unit: "
      "none.");
    add_parameter(prm, "Strain rate", strain_rate, positive())(
      "Rate of the controlled strain, for laws that depend on the rate or on "
      "time. Unit: 1 / s.");
    add_parameter(prm, "Void ratio", void_ratio, Double(0.))(
      "Initial void ratio, for laws that have none of their own. Unit: none.");
  }



  std::vector<double>
  ElementTestTable::column(const std::string &name) const
  {
    const auto k = std::find(names.begin(), names.end(), name) - names.begin();
    AssertThrow(k < std::ptrdiff_t(names.size()),
                ExcIndexRange(k, 0, std::ptrdiff_t(names.size())));
    std::vector<double> result;
    for (const auto &row : rows)
      result.push_back(row[k]);
    return result;
  }



  std::string
  element_test_names()
  {
    return words_of(tests());
  }



  ElementTestTable
  run_element_test(const Material              &material,
                   const std::string           &section,
                   const std::string           &test,
                   const ElementTestParameters &parameters)
  {
    check_word(test, "--element-test", element_test_names());
    return ElementTest(material, section, value_of(test, tests()), parameters)
      .run();
  }
} // namespace greville
